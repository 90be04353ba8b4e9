"""Detect the format of a text by its content."""

import re
from collections.abc import Mapping
from typing import NamedTuple

from mars_asp.model.declarations import FOREIGN

#: The formats of robots that commands accept in place of a `.mars` file.
FORMATS = ("mars", *FOREIGN)
#: Foreign files show their format in so many characters; the limit keeps the search fast.
_HEAD = 256 * 1024


class _Sign(NamedTuple):
    """A pattern that identifies a format; each match contains one of `words`, to search fast."""

    pattern: str
    words: tuple[str, ...]

    def is_in(self, text: str) -> bool:
        """Whether a text contains a match of the pattern."""
        has_word = any(word in text for word in self.words)
        return has_word and re.search(self.pattern, text) is not None


_OURS = _Sign(
    r"(?m)^[ \t]*@(?:configuration|specification|modules|module_start)\b",
    ("@configuration", "@specification", "@modules", "@module_start"),
)
#: A key that begins the parameters of a mux, dotted or not.
_MUX = _Sign(
    r"(?m)(?:^|[{,])[ \t{\"']{0,40}(?:- {1,8})?(?:topics|locks|subscribers|ros__parameters)"
    r"(?:\.[^\s:]{1,200})?[\"']?[ \t]{0,8}:",
    ("topics", "locks", "subscribers", "ros__parameters"),
)


def key_pattern(names: str) -> str:
    """Return a pattern for a key of YAML or JSON, at any depth."""
    begin = r"(?m)(?:^|[{,])[ \t]{0,200}(?:-[ \t]{1,8}){0,8}"
    return rf"{begin}[\"']?(?:{names})[\"']?[ \t]{{0,8}}:"


#: The contents that XML allows before the root of a document.
_PROLOG = r"\A\ufeff?(?:\s++|<\?[^>]*+>|<!--(?:[^-]|-(?!->))*+-->)*+"


def _root(name: str) -> str:
    """Return a pattern for an XML document up to the name of its root element.

    It allows a document type: readers refuse these, but the reader of the right format has to.
    """
    root = rf"<{name}[\s/>]"
    return rf"{_PROLOG}(?:<!DOCTYPE\b(?:[^<]|<(?!{name}[\s/>]))*+)?{root}"


#: The sign of a launch file: in Python a function, in XML its root, in YAML its first key.
_LAUNCH = _Sign(
    rf"(?m)^def generate_launch_description\b|^launch:|{_root('launch')}",
    ("def generate_launch_description", "launch:", "<launch"),
)
#: The beginning of a document of URDF, expanded or not.
_URDF = _root("robot")
_NODES = _Sign(r"(?m)(?:^|^\{\s{0,200})[\"']?nodes[\"']?[ \t]{0,8}:", ("nodes",))
_ID = _Sign(key_pattern("id"), ("id",))
_DOT = (
    r"(?i)(?:\s++|//[^\n]*+|/\*(?:[^*]|\*(?!/))*+\*/|\#[^\n]*+)*+"
    r"(?:strict\s{1,40})?(?:di)?graph\b[^{;=:\n]{0,200}\s{0,40}\{"
)
#: The other kinds of dumps of a graph, each by its signs.
_DUMPS: Mapping[str, tuple[_Sign, ...]] = {
    "topic_info": (
        _Sign(r"(?m)^[ \t]{0,40}(?:Publisher|Subscri(?:ber|ption)) count:", (" count:",)),
    ),
    "node_info": (
        _Sign(
            r"(?m)^[ \t]{1,40}(?:Publishers|Subscribers):[ \t]*$", ("Publishers:", "Subscribers:")
        ),
    ),
    "rosdiscover": (
        _Sign(key_pattern("fullname"), ("fullname",)),
        _Sign(key_pattern("pubs|subs"), ("pubs", "subs")),
    ),
    "caret": (_NODES, _Sign(key_pattern("node_name"), ("node_name",))),
}


def dump_of(text: str) -> str | None:
    """Return the kind of graph dump that a text is, such as `caret`, or None if it is none."""
    head = text[:_HEAD]
    if re.match(_DOT, head):
        return "dot"
    return next(
        (kind for kind, signs in _DUMPS.items() if all(sign.is_in(head) for sign in signs)), None
    )


def is_launch(text: str) -> bool:
    """Whether a text is a launch file of ROS, in Python, XML or YAML."""
    return _LAUNCH.is_in(text[:_HEAD])


def recognised(text: str) -> str:
    """Return the format of a text; `mars` if it has the signs of no foreign format."""
    if _OURS.is_in(text):
        return "mars"
    if is_launch(text):
        return "ros2"
    if re.match(_URDF, text[:_HEAD]):
        return "urdf"
    if dump_of(text) is not None:
        return "rosgraph"
    head = text[:_HEAD]
    if _NODES.is_in(head) and _ID.is_in(head):
        return "dora"
    return "twist_mux" if _MUX.is_in(head) else "mars"
