"""A graph of nodes and topics, as dumps tell it, each part with its place."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from fractions import Fraction
from typing import NamedTuple

from mars_asp.annotations.types import representation
from mars_asp.diagnostic import Diagnostic, Span
from mars_asp.exchange import ports
from mars_asp.exchange.unread import Unread

#: What dumps write where they do not know a type.
_NO_TYPES = frozenset({"", "any", "*", "unknown type", "unknown"})
#: Topics that each node has, or that say nothing of who works for whom.
_HOUSEKEEPING = frozenset(
    "rosout rosout_agg clock parameter_events tf tf_static diagnostics diagnostics_agg".split()
)


class End(NamedTuple):
    """That a node publishes a topic, if `out`, or else subscribes to it.

    `type` is a representation's name, `hz` a rate; `None` is what the dump does not say.
    """

    node: str
    topic: str
    out: bool
    type: str | None
    span: Span
    hz: Fraction | None = None


@dataclass(slots=True)
class Graph:
    """Nodes with their places, the ends of topics, and what was not read."""

    nodes: dict[str, Span] = field(default_factory=dict)
    ends: list[End] = field(default_factory=list)
    unread: list[Unread] = field(default_factory=list)
    problems: list[Diagnostic] = field(default_factory=list)

    def node(self, name: str, span: Span) -> None:
        """Add a node, unless it is there."""
        self.nodes.setdefault(name, span)

    def end(
        self,
        node: str,
        topic: str,
        out: bool,
        written_type: str | None,
        span: Span,
        hz: Fraction | None = None,
    ) -> None:
        """Add an end of a topic, or note that such topics are not read.

        Raises:
            MarsError: there are more than any robot has.
        """
        sort = _left_out(topic)
        if len(self.ends) == ports.MOST:
            raise ports.too_many(span)
        if sort is None:
            self.ends.append(End(node, topic, out, type_of(written_type), span, hz))
        else:
            self.skip(sort, topic, span)

    def skip(self, sort: str, name: str, span: Span) -> None:
        """Note something that is not read."""
        self.unread.append(Unread(sort, name, span))

    def wrong(self, span: Span, message: str, help_text: str) -> None:
        """Note an error."""
        self.problems.append(Diagnostic("rosgraph", "error", message, span, help=help_text))


def _left_out(topic: str) -> str | None:
    """Return what sort of topic one is that is not read; `None` of all others."""
    *parts, last = topic.split("/")
    if last in _HOUSEKEEPING:
        return "housekeeping topics"
    if "_action" in parts or last == "action_topics":
        return "topics of actions"
    if any(part == "debug" or part.startswith("debug_") for part in (*parts, last)):
        return "debug topics"
    return None


def type_of(written: str | None) -> str | None:
    """Return the representation of a type as dumps write it; `None` where there is none."""
    text = (written or "").strip()
    if text.lower() in _NO_TYPES:
        return None
    # ROS 1 names C++ templates `Image_`.
    return representation(text.rstrip("_")) or None


def united(graphs: Iterable[Graph]) -> Graph:
    """Return several dumps of one robot as one; what one of them does not know another may say."""
    whole = Graph()
    ends: dict[tuple[str, str, bool], End] = {}
    for graph in graphs:
        for name, span in graph.nodes.items():
            whole.node(name, span)
        for end in graph.ends:
            key = end.node, end.topic, end.out
            known = ends.get(key)
            ends[key] = end if known is None else _completed(known, end)
        whole.unread += graph.unread
        whole.problems += graph.problems
    whole.ends = list(ends.values())
    whole.unread = list(_each_once(whole.unread))
    return whole


def _completed(known: End, other: End) -> End:
    return known._replace(
        type=other.type if known.type is None else known.type,
        hz=other.hz if known.hz is None else known.hz,
    )


def _each_once(unread: Iterable[Unread]) -> Iterator[Unread]:
    """Yield what was not read, each thing at its first place alone."""
    seen: set[tuple[str, str]] = set()
    for each in unread:
        if (each.sort, each.name) not in seen:
            seen.add((each.sort, each.name))
            yield each
