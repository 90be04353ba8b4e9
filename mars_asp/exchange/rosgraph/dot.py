"""Graphs that rqt_graph and rosgraph save as DOT: nodes as ellipses, topics as boxes or on edges.

rqt_graph draws either nodes with topics on the edges between them, or nodes and topics; a topic's
tooltip or URL begins with `topic:`. Such files have no types. rqt_graph/dotcode.py, qt_dotgraph.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import pairwise

from mars_asp.diagnostic import Span, beginning, whole_file
from mars_asp.exchange.rosgraph.dot_tokens import DotToken, tokens, wrong
from mars_asp.exchange.rosgraph.dump import Dump
from mars_asp.exchange.yaml_document import MOST_BYTES_OF_DUMP, MOST_DEPTH

_BOXES = frozenset({"box", "box3d", "rect", "rectangle"})
_TOPIC_URL = ("topic:", "topic_3A")
#: The placeholder for the identifier of a node in its label.
_ITSELF = r"\N"
_BREAK = re.compile(r"\\[nlr]|\n")
_ESCAPED = re.compile(r"\\(.)", re.DOTALL)
_MOST_STATEMENTS = 200_000
_DEFAULTS = frozenset({"graph", "node", "edge"})


@dataclass(slots=True)
class _DotElement:
    """A node of the drawing: its identifier, its first location, and its attributes."""

    id: str
    span: Span
    attributes: dict[str, DotToken] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class _Edge:
    start: str
    end: str
    span: Span
    attributes: dict[str, DotToken]


def read_dot(text: str, path: str) -> Dump:
    """Return the graph of nodes and topics that a drawing shows.

    Raises:
        MarsError: the text is not DOT, has a label in HTML, or exceeds a limit of size.
    """
    if len(text) > MOST_BYTES_OF_DUMP:
        message = f"the file has more than {MOST_BYTES_OF_DUMP} characters, which no robot needs"
        raise wrong(whole_file(path), message, "give the file of the graph alone")
    drawing = _Drawing(text, path)
    drawing.read()
    dump = Dump()
    topics = set(_topics(drawing.elements))
    names = {each.id: _element_name(each) for each in drawing.elements.values()}
    for element in drawing.elements.values():
        if element.id not in topics:
            dump.node(names[element.id], element.span)
    for edge in drawing.edges:
        start, end = names[edge.start], names[edge.end]
        match edge.start in topics, edge.end in topics:
            case False, True:
                dump.end(start, end, True, None, edge.span)
            case True, False:
                dump.end(end, start, False, None, edge.span)
            case False, False:
                topic = _label(edge.attributes)
                if topic:
                    dump.end(start, topic, True, None, edge.span)
                    dump.end(end, topic, False, None, edge.span)
                else:
                    dump.skip("edges without a topic", f"{start} -> {end}", edge.span)
            case _:
                dump.skip("edges between topics", f"{start} -> {end}", edge.span)
    if not drawing.edges:
        dump.wrong(whole_file(path), "the graph has no edges", "save it with nodes and topics")
    return dump


def _topics(elements: dict[str, _DotElement]) -> Iterator[str]:
    """Yield the identifiers of topics: marked elements; without any, boxes among other shapes."""
    marked = [
        each.id
        for each in elements.values()
        if any(_value(each.attributes, key).startswith(_TOPIC_URL) for key in ("tooltip", "URL"))
    ]
    boxes = [each.id for each in elements.values() if _value(each.attributes, "shape") in _BOXES]
    yield from marked or (boxes if len(boxes) < len(elements) else ())


def _value(attributes: dict[str, DotToken], key: str) -> str:
    return attributes[key].text if key in attributes else ""


def _element_name(element: _DotElement) -> str:
    """Return the name of an element: its label, else its tooltip, else its identifier."""
    label = _label(element.attributes)
    if label:
        return label
    tooltip = _value(element.attributes, "tooltip").removeprefix("topic:")
    if tooltip:
        return tooltip
    # rqt_graph writes `/` as `__`.
    for prefix in ("n_", "t_"):
        if element.id.startswith(prefix):
            return element.id.removeprefix(prefix).replace("__", "/")
    return element.id


def _label(attributes: dict[str, DotToken]) -> str:
    """Return the first line of a label; further lines are statistics.

    Raises:
        MarsError: the label is in HTML.
    """
    label = attributes.get("label")
    if label is None or label.text == _ITSELF:
        return ""
    if label.sort == "html":
        begin = beginning(label.span)
        span = begin._replace(end_column=begin.column + 1)
        raise wrong(span, "a label in HTML, which is not read", "write it as plain text")
    return _ESCAPED.sub(r"\1", _BREAK.split(label.text)[0]).strip()


class _Drawing:
    """Reads a text in DOT; collects its elements and edges."""

    def __init__(self, text: str, path: str) -> None:
        self.source = path
        self.elements: dict[str, _DotElement] = {}
        self.edges: list[_Edge] = []
        self.rest = tokens(text, path)
        self.next = next(self.rest)

    def read(self) -> None:
        """Read the graph.

        Raises:
            MarsError: the text is not DOT, or exceeds a limit of size.
        """
        head = self.take()
        if head.text.lower() == "strict":
            head = self.take()
        if head.text.lower() not in ("graph", "digraph"):
            raise self.unexpected(head, "`digraph`")
        opening = self.take()
        if not opening.is_mark("{"):
            opening = self.take()
        if not opening.is_mark("{"):
            raise self.unexpected(opening, "`{`")
        depth = 1
        statements = 0
        while depth:
            depth += self.statement()
            statements += 1
            if statements == _MOST_STATEMENTS:
                message = f"the graph has more than {_MOST_STATEMENTS} statements"
                raise wrong(whole_file(self.source), message, "no robot needs so many")
            if depth > MOST_DEPTH:
                message = f"subgraphs are nested deeper than {MOST_DEPTH}"
                raise wrong(self.next.span, message, "no graph of a robot needs that")

    def take(self) -> DotToken:
        """Return the current token and go to the next one.

        Raises:
            MarsError: there is none.
        """
        token = self.next
        if token.sort == "end":
            message = "the text ends within the graph"
            raise wrong(token.span, message, "write `}` where the graph ends")
        self.next = next(self.rest)
        return token

    def statement(self) -> int:
        """Read a statement or a brace; return the change of depth: 1 at `{`, -1 at `}`, else 0."""
        token = self.take()
        if token.sort == "mark":
            if token.text in "{};,":
                return {"{": 1, "}": -1}.get(token.text, 0)
            raise self.unexpected(token, "a name")
        if token.sort == "word" and token.text.lower() == "subgraph":
            if self.next.sort not in ("mark", "end"):
                self.take()
            return 0
        if token.sort == "word" and token.text.lower() in _DEFAULTS and self.next.is_mark("["):
            self.attributes()
        elif self.next.is_mark("="):
            self.take()
            self.take()
        else:
            self.path(token)
        return 0

    def path(self, first: DotToken) -> None:
        """Read a node, or a chain of edges such as `a -> b -> c`."""
        ends = [first]
        self.port()
        while self.next.is_mark("->", "--"):
            arrow = self.take()
            if arrow.text == "--":
                message = "an edge without a direction does not show which node publishes"
                raise wrong(arrow.span, message, "write `->`")
            following = self.take()
            if following.sort == "mark" or following.text.lower() == "subgraph":
                raise self.unexpected(following, "the name of a node")
            ends.append(following)
            self.port()
        attributes = self.attributes()
        for end in ends:
            element = self.elements.setdefault(end.text, _DotElement(end.text, end.span))
            if len(ends) == 1:
                element.attributes |= attributes
        for start, end in pairwise(ends):
            span = Span(self.source, *start.span[1:3], *end.span[3:])
            self.edges.append(_Edge(start.text, end.text, span, attributes))

    def port(self) -> None:
        """Skip the port of a node at which an edge ends, if there is one."""
        while self.next.is_mark(":"):
            self.take()
            self.take()

    def attributes(self) -> dict[str, DotToken]:
        """Read lists of attributes, `[a=b, c=d]`."""
        found: dict[str, DotToken] = {}
        while self.next.is_mark("["):
            self.take()
            while not self.next.is_mark("]"):
                key = self.take()
                if key.sort == "mark":
                    if key.text in ";,":
                        continue
                    raise self.unexpected(key, "the name of an attribute")
                if self.next.is_mark("="):
                    self.take()
                    found[key.text] = self.value()
            self.take()
        return found

    def value(self) -> DotToken:
        """Read the value of an attribute, which may be strings joined by `+`."""
        token = self.take()
        if token.sort == "mark":
            raise self.unexpected(token, "a value")
        parts = [token]
        while self.next.is_mark("+"):
            self.take()
            parts.append(self.take())
        return token._replace(text="".join(part.text for part in parts))

    def unexpected(self, token: DotToken, wanted: str) -> Exception:
        """Return the error of a token at which only `wanted` is possible."""
        shown = token.text if len(token.text) <= 40 else f"{token.text[:37]}..."
        return wrong(token.span, f"expected {wanted}, found `{shown}`", "is this a graph in DOT?")
