"""Which format a text is in, told by what it says."""

import re
from collections.abc import Mapping

from mars_asp.model.declarations import FOREIGN

#: The formats of robots that can stand where a `.mars` file does.
FORMATS = ("mars", *FOREIGN)
#: Others' files show what they are in so many characters, and none takes long to be looked at.
_HEAD = 256 * 1024
_OURS = r"(?m)^[ \t]*@(?:configuration|specification|modules|module_start)\b"
#: A key that begins the parameters of a mux, dotted or not.
_MUX = (
    r"(?m)(?:^|[{,])[ \t{\"']{0,40}(?:- {1,8})?(?:topics|locks|subscribers|ros__parameters)"
    r"(?:\.[^\s:]{1,200})?[\"']?[ \t]{0,8}:"
)


def key_pattern(names: str) -> str:
    """Return what finds a key of YAML or JSON, at whichever depth."""
    begin = r"(?m)(?:^|[{,])[ \t]{0,200}(?:-[ \t]{1,8}){0,8}"
    return rf"{begin}[\"']?(?:{names})[\"']?[ \t]{{0,8}}:"


#: What may stand before the root of a document in XML.
_PROLOG = r"\A\ufeff?(?:\s++|<\?[^>]*+>|<!--(?:[^-]|-(?!->))*+-->)*+"


def _root(name: str) -> str:
    """Return what matches a document up to its root, also behind a document type.

    Readers refuse document types, but what is refused is known by its root, too.
    """
    root = rf"<{name}[\s/>]"
    return rf"{_PROLOG}(?:<!DOCTYPE\b(?:[^<]|<(?!{name}[\s/>]))*+)?{root}"


#: What a launch file says: in Python a function, in XML its root, in YAML its first key.
_LAUNCH = rf"(?m)^def generate_launch_description\b|^launch:|{_root('launch')}"
#: What begins a document of URDF, expanded or not.
_URDF = _root("robot")
_NODES = r"(?m)(?:^|^\{\s{0,200})[\"']?nodes[\"']?[ \t]{0,8}:"
_ID = key_pattern("id")
#: The kinds of dumps of a graph, each by what it alone says.
_DUMPS: Mapping[str, tuple[str, ...]] = {
    "dot": (
        r"(?i)\A(?:\s++|//[^\n]*+|/\*(?:[^*]|\*(?!/))*+\*/|\#[^\n]*+)*+"
        r"(?:strict\s{1,40})?(?:di)?graph\b[^{;=:\n]{0,200}\s{0,40}\{",
    ),
    "topic_info": (r"(?m)^[ \t]{0,40}(?:Publisher|Subscri(?:ber|ption)) count:",),
    "node_info": (r"(?m)^[ \t]{1,40}(?:Publishers|Subscribers):[ \t]*$",),
    "rosdiscover": (key_pattern("fullname"), key_pattern("pubs|subs")),
    "caret": (_NODES, key_pattern("node_name")),
}


def dump_of(text: str) -> str | None:
    """Return which kind of dump of a graph a text is; `None` where it is none."""
    head = text[:_HEAD]
    return next(
        (kind for kind, signs in _DUMPS.items() if all(re.search(sign, head) for sign in signs)),
        None,
    )


def is_launch(text: str) -> bool:
    """Whether a text is a launch file."""
    return re.search(_LAUNCH, text[:_HEAD]) is not None


def recognised(text: str) -> str:
    """Return the format that a text is in, `mars` where it is no other that is known."""
    if re.search(_OURS, text):
        return "mars"
    if is_launch(text):
        return "ros2"
    if re.match(_URDF, text[:_HEAD]):
        return "urdf"
    if dump_of(text) is not None:
        return "rosgraph"
    head = text[:_HEAD]
    if re.search(_NODES, head) and re.search(_ID, head):
        return "dora"
    return "twist_mux" if re.search(_MUX, head) else "mars"
