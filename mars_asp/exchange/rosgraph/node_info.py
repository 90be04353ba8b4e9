"""Read the output of `ros2 node info`, of any number of nodes one below the other."""

import re
from itertools import pairwise

from mars_asp.diagnostic import Span
from mars_asp.exchange.rosgraph.dump import Dump, match_span

_SECTION = re.compile(r"[ \t]*(\w+(?: \w+)?):[ \t]*")
_NODE = re.compile(r"[ \t]*(/[^\s:]*)[ \t]*")
_ENTRY = re.compile(r"[ \t]*(?P<name>/[^\s:]+)[ \t]*:[ \t]*(?P<types>[^\n]*?)[ \t]*")
_OUT = {"Publishers": True, "Subscribers": False}
_CALLS = {
    # Up to ROS 2 Dashing.
    "Services": "services",
    "Service Servers": "services",
    "Service Clients": "services",
    "Action Servers": "actions",
    "Action Clients": "actions",
}
#: The command itself, if it was copied with its output.
_PROMPT = re.compile(r"[^\n]*\bros2[ \t]+node[ \t]+(?:info|list)\b")
_HELP = "give what `ros2 node info /NODE` prints, each node below the one before"


def read_node_info(text: str, path: str) -> Dump:
    """Return the graph of nodes and topics in the output of `ros2 node info`."""
    dump = Dump()
    node = section = None
    lines = [(number, line) for number, line in enumerate(text.split("\n"), 1) if line.strip()]
    for (number, line), (_, following) in pairwise((*lines, (0, ""))):
        head, named, entry = (p.fullmatch(line) for p in (_SECTION, _NODE, _ENTRY))
        if head and head[1] in (*_OUT, *_CALLS):
            section = head[1]
            if node is None:
                message = f"`{section}` of a node without a name"
                dump.wrong(match_span(path, number, head), message, _HELP)
                node = ""
        elif named and (under := _SECTION.fullmatch(following)) and under[1] in (*_OUT, *_CALLS):
            node, section = named[1], None
            dump.node(node, match_span(path, number, named))
        elif entry and section is not None and node is not None:
            types = entry["types"].split(",")
            # With several types, the type of this node is unknown.
            type_ = types[0] if len(types) == 1 else None
            span = match_span(path, number, entry)
            if section in _CALLS:
                dump.skip(_CALLS[section], entry["name"], span)
            elif node:
                dump.end(node, entry["name"], _OUT[section], type_, span)
        elif not _PROMPT.match(line):
            begin = len(line) - len(line.lstrip()) + 1
            dump.skip("lines", line.strip()[:40], Span(path, number, begin, number, len(line) + 1))
    return dump
