"""Read the output of `ros2 topic info -v`: the publishers and subscribers of a topic.

The output does not contain the name of the topic, which is taken from the line above (for example
the copied command) or from the name of the file.
"""

import re
from pathlib import PurePath

from mars_asp.diagnostic import Span, point
from mars_asp.exchange.rosgraph.dump import Dump, match_span

_FIELD = re.compile(r"[ \t]*(?P<key>[A-Za-z][\w ()]*?)[ \t]*:[ \t]*(?P<value>[^\n]*?)[ \t]*")
_TOPIC = re.compile(r"(?<![\w./~])(/\w+(?:/\w+)*)(?![\w./])")
#: The command, in which the topic may lack its slash.
_COMMAND = re.compile(r"\bros2\s+topic\s+info\s+(?:-\S+\s+)*/?(\w+(?:/\w+)*)")
_STEM = re.compile(r"\w+")
_UNKNOWN = re.compile(r"_(?:NODE_NAME|NODE_NAMESPACE)_UNKNOWN_|_CREATED_BY_BARE_DDS_APP_")
_OUT = {"PUBLISHER": True, "SUBSCRIPTION": False}
_COUNTS = {"Publisher count": True, "Subscription count": False, "Subscriber count": False}
_VERBOSE = "give what `ros2 topic info -v /TOPIC` prints: without -v it names no nodes"
_NAME_IT = (
    "write the topic on the line above, as in `$ ros2 topic info -v /TOPIC`,"
    " or name the file after it: `TOPIC.txt`"
)


def read_topic_info(text: str, path: str) -> Dump:
    """Return the graph in the output of `ros2 topic info -v`, of one topic or several."""
    reader = _TopicInfoReader(
        path, sum(line.lstrip().startswith("Type:") for line in text.split("\n"))
    )
    for number, line in enumerate(text.split("\n"), 1):
        if line.strip():
            reader.take(number, line)
    reader.finish_topic()
    return reader.dump


class _TopicInfoReader:
    """Collects publishers and subscribers, line by line."""

    def __init__(self, path: str, topics: int) -> None:
        self.dump = Dump()
        self.path = path
        self.topics = topics
        #: The line above the next `Type:`.
        self.above = ""
        self.topic: str | None = None
        self.type: str | None = None
        #: Whether publishers follow, the counts of the output, and the number of named nodes.
        self.out = True
        self.promised: dict[bool, tuple[int, Span]] = {}
        self.named_nodes = 0
        self.node: tuple[str, Span] | None = None
        self.space = "/"

    def take(self, number: int, line: str) -> None:
        """Process a line that is not empty; `number` is its number."""
        field = _FIELD.fullmatch(line)
        key = field["key"] if field else ""
        value = field["value"] if field else ""
        span = (
            match_span(self.path, number, field, "value") if field else point(self.path, number, 1)
        )
        match key:
            case "Type":
                self.begin_topic(value, span)
            case "Publisher count" | "Subscription count" | "Subscriber count":
                self.finish_node()
                self.out = _COUNTS[key]
                if value.isdecimal():
                    self.promised[self.out] = int(value[:9]), span
            case "Node name":
                self.finish_node()
                self.node = value, span
            case "Node namespace":
                self.space = value
            case "Endpoint type":
                self.out = _OUT.get(value.partition(" ")[0], self.out)
            case "QoS profile":
                if self.node is not None:
                    self.dump.skip("QoS profiles", self.full_name(), self.node[1])
            case _:
                self.above = line

    def begin_topic(self, type_: str, span: Span) -> None:
        """Begin a topic of a message type, named by the line above or by the file."""
        self.finish_topic()
        command = _COMMAND.search(self.above)
        named = _TOPIC.findall(self.above) if command is None else [f"/{command[1]}"]
        self.above = ""
        self.type = None if type_.startswith("[") else type_
        self.topic = named[-1] if named else self.topic_of_file(span)

    def topic_of_file(self, span: Span) -> str | None:
        """Return the topic named by the file; add an error and return None if it is not."""
        stem = PurePath(self.path).stem
        if self.topics == 1 and _STEM.fullmatch(stem):
            return "/" + stem.strip("_").replace("__", "/")
        self.dump.wrong(span, "the topic that this is about is not named", _NAME_IT)
        return None

    def finish_topic(self) -> None:
        """Finish the topic; note an error if its nodes are counted, but not named."""
        self.finish_node()
        most = max(self.promised.values(), default=(0, point(self.path, 1, 1)))
        if self.topic is not None and most[0] > 0 and not self.named_nodes:
            message = f"the nodes at `{self.topic}` are counted, but not named"
            self.dump.wrong(most[1], message, _VERBOSE)
        self.promised, self.named_nodes, self.out = {}, 0, True

    def finish_node(self) -> None:
        """Add the last publisher or subscriber to the graph."""
        if self.node is None:
            return
        name, span = self.node
        self.named_nodes += 1
        if _UNKNOWN.search(name + self.space) or not name:
            self.dump.skip("endpoints of unknown nodes", name or "?", span)
        elif self.topic is not None:
            self.dump.node(self.full_name(), span)
            self.dump.end(self.full_name(), self.topic, self.out, self.type, span)
        self.node, self.space = None, "/"

    def full_name(self) -> str:
        """Return the full name of the current node."""
        name = self.node[0] if self.node else ""
        return name if name.startswith("/") else f"{self.space.rstrip('/')}/{name}"
