"""Which format a text is in, told by what it says."""

import re
from collections.abc import Mapping

from mars_asp.model.declarations import FOREIGN

#: The formats of robots that can stand where a `.mars` file does.
FORMATS = ("mars", *FOREIGN)
#: Others' files show what they are in so many characters, and none takes long to be looked at.
_HEAD = 256 * 1024
_OURS = re.compile(r"^[ \t]*@(?:configuration|specification|modules|module_start)\b", re.MULTILINE)
#: A key that begins the parameters of a mux, dotted or not.
_MUX = re.compile(
    r"(?:^|[{,])[ \t{\"']{0,40}(?:- {1,8})?(?:topics|locks|subscribers|ros__parameters)"
    r"(?:\.[^\s:]{1,200})?[\"']?[ \t]{0,8}:",
    re.MULTILINE,
)


def _key(names: str) -> re.Pattern[str]:
    """Return what finds a key of YAML or JSON, at whichever depth."""
    return re.compile(
        rf"(?:^|[{{,])[ \t]{{0,200}}(?:-[ \t]{{1,8}}){{0,8}}[\"']?(?:{names})[\"']?[ \t]{{0,8}}:",
        re.MULTILINE,
    )


#: What may stand before the root of a document in XML.
_PROLOG = r"\A\ufeff?(?:\s++|<\?[^>]*+>|<!--(?:[^-]|-(?!->))*+-->)*+"


def _root(name: str) -> str:
    """Return what matches a document up to its root, also behind a document type.

    Readers refuse document types, but what is refused is known by its root, too.
    """
    root = rf"<{name}[\s/>]"
    return rf"{_PROLOG}(?:<!DOCTYPE\b(?:[^<]|<(?!{name}[\s/>]))*+)?{root}"


#: What a launch file says: in Python a function, in XML its root, in YAML its first key.
_LAUNCH = re.compile(
    rf"^def generate_launch_description\b|^launch:|{_root('launch')}", re.MULTILINE
)
#: What begins a document of URDF, expanded or not.
_URDF = re.compile(_root("robot"))
_NODES = re.compile(r"(?:^|^\{\s{0,200})[\"']?nodes[\"']?[ \t]{0,8}:", re.MULTILINE)
_ID = _key("id")
#: The kinds of dumps of a graph, each by what it alone says.
_DUMPS: Mapping[str, tuple[re.Pattern[str], ...]] = {
    "dot": (
        re.compile(
            r"\A(?:\s++|//[^\n]*+|/\*(?:[^*]|\*(?!/))*+\*/|\#[^\n]*+)*+"
            r"(?:strict\s{1,40})?(?:di)?graph\b[^{;=:\n]{0,200}\s{0,40}\{",
            re.IGNORECASE,
        ),
    ),
    "topic_info": (
        re.compile(r"^[ \t]{0,40}(?:Publisher|Subscri(?:ber|ption)) count:", re.MULTILINE),
    ),
    "node_info": (re.compile(r"^[ \t]{1,40}(?:Publishers|Subscribers):[ \t]*$", re.MULTILINE),),
    "rosdiscover": (_key("fullname"), _key("pubs|subs")),
    "caret": (_NODES, _key("node_name")),
}


def dump_of(text: str) -> str | None:
    """Return which kind of dump of a graph a text is; `None` where it is none."""
    head = text[:_HEAD]
    return next(
        (kind for kind, signs in _DUMPS.items() if all(sign.search(head) for sign in signs)), None
    )


def is_launch(text: str) -> bool:
    """Whether a text is a launch file."""
    return _LAUNCH.search(text[:_HEAD]) is not None


def recognised(text: str) -> str:
    """Return the format that a text is in, `mars` where it is no other that is known."""
    if _OURS.search(text):
        return "mars"
    if is_launch(text):
        return "ros2"
    if _URDF.match(text[:_HEAD]):
        return "urdf"
    if dump_of(text) is not None:
        return "rosgraph"
    head = text[:_HEAD]
    if _NODES.search(head) and _ID.search(head):
        return "dora"
    return "twist_mux" if _MUX.search(head) else "mars"
