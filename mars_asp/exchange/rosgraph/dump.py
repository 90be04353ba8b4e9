"""The nodes and topics of a dump, collected step by step."""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from fractions import Fraction

from mars_asp.diagnostic import Diagnostic, Span, beginning
from mars_asp.exchange import ports
from mars_asp.exchange.unread import Unread
from mars_asp.exchange.yaml_document import Items, Node, Pairs, Scalar
from mars_asp.model.graph import Endpoint, Graph, GraphNode


def match_span(path: str, number: int, match: re.Match[str], group: int | str = 1) -> Span:
    """Return the location of a group of a match; the match is in line `number`."""
    return Span(path, number, match.start(group) + 1, number, match.end(group) + 1)


@dataclass(slots=True)
class _Ends:
    """The location of a node, and its publications and subscriptions."""

    span: Span
    published: list[Endpoint] = field(default_factory=list)
    subscribed: list[Endpoint] = field(default_factory=list)


@dataclass(slots=True)
class Dump:
    """Collects nodes with their publications and subscriptions, skipped contents and errors."""

    nodes: dict[str, _Ends] = field(default_factory=dict)
    ends: int = 0
    unread: list[Unread] = field(default_factory=list)
    problems: list[Diagnostic] = field(default_factory=list)

    def node(self, name: str, span: Span) -> None:
        """Add a node, unless it has been added before."""
        if name not in self.nodes:
            self.nodes[name] = _Ends(span)
            self._check_name(name, span)

    def end(
        self,
        node: str,
        topic: str,
        out: bool,
        type_: str | None,
        span: Span,
        hz: Fraction | None = None,
    ) -> None:
        """Add a publication of a node if `out`, else a subscription.

        Raises:
            MarsError: the dump has too many ends of topics.
        """
        self.node(node, span)
        if self.ends == ports.MOST:
            raise ports.too_many(span)
        self.ends += 1
        self._check_name(topic, span)
        own = self.nodes[node]
        (own.published if out else own.subscribed).append(Endpoint(topic, type_, span, hz))

    def _check_name(self, name: str, span: Span) -> None:
        if not ports.is_writable(name):
            self.wrong(span, f"`{name[:40]}` cannot be a name", "write a name of one visible line")

    def skip(self, sort: str, name: str, span: Span) -> None:
        """Add an entry of a sort and name to `unread`, the skipped contents."""
        self.unread.append(Unread(sort, name, span))

    def wrong(self, span: Span, message: str, help_text: str) -> None:
        """Add an error with a message and help to `problems`."""
        self.problems.append(Diagnostic("rosgraph", "error", message, span, help=help_text))

    def maps(self, node: Node | None, what: str) -> Iterator[Pairs]:
        """Yield the maps of a list, which may be missing or empty; note other entries as errors."""
        if isinstance(node, Scalar) and node.text in ("", "~", "null", "UNDEFINED"):
            return
        if not isinstance(node, Items | None):
            self.wrong(beginning(node.span), f"`{what}` is not a list", f"write a list of {what}")
        for each in node.nodes if isinstance(node, Items) else ():
            if isinstance(each, Pairs):
                yield each
            else:
                message = f"an entry of `{what}` is not a map"
                self.wrong(beginning(each.span), message, "write `- KEY: VALUE`")

    def graph(self, path: str) -> Graph:
        """Return the graph of all nodes, marked as observed in a run."""
        nodes = tuple(
            GraphNode(name, each.span, tuple(each.published), tuple(each.subscribed))
            for name, each in self.nodes.items()
        )
        return Graph(path, nodes, observed=True)
