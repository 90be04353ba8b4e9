"""Nodes, muxes and relays that exchange topics: what launch files and graph dumps have alike."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import chain

from mars_asp.annotations.types import representation
from mars_asp.diagnostic import Span
from mars_asp.model.declarations import Engine, Hold, Inner

#: Messages that tell somebody to move; a joystick's are none, as no base obeys them.
COMMANDS = frozenset(
    {"Twist", "TwistStamped", "AckermannDrive", "AckermannDriveStamped", "JointTrajectory"}
)
#: What dumps write where a type is not known.
_NO_TYPES = frozenset({"", "*", "any", "unknown", "unknown type"})


@dataclass(frozen=True, slots=True)
class Endpoint:
    """An end of a topic at a node.

    `topic` is its full name, all renaming done; `type` is the message's as it is written, if it is
    known; `span` is what an owner would change; `hz` is how often it is published, if that is
    known; `optional` is whether a node that hears it works as well without, `measured` whether it
    is no command, whatever its type.
    """

    topic: str
    type: str | None
    span: Span
    hz: Fraction | None = None
    optional: bool = False
    measured: bool = False


@dataclass(frozen=True, slots=True)
class Node:
    """A node by its full name; `guard` is the place that makes it a guard, if it is one.

    `relays` is whether it publishes what it hears, whatever the type of that; `unread` whether it
    may have topics besides.
    """

    name: str
    span: Span
    published: tuple[Endpoint, ...] = ()
    subscribed: tuple[Endpoint, ...] = ()
    guard: Span | None = None
    relays: bool = False
    unread: bool = False


@dataclass(frozen=True, slots=True)
class MuxInput:
    """A topic that a mux listens to, with the name that the mux has for it."""

    name: str
    topic: str
    span: Span
    priority: int
    hold_ms: Hold | None


@dataclass(frozen=True, slots=True)
class Mux:
    """A node that hands on, of several topics, the one with the highest priority to `output`.

    `numbers` and `inner` are those of a cascade that became one mux, as `Muxed` has them.
    """

    name: str
    engine: Engine
    span: Span
    output: str
    inputs: tuple[MuxInput, ...]
    numbers: tuple[tuple[int, int], ...] = ()
    inner: tuple[Inner, ...] = ()


@dataclass(frozen=True, slots=True)
class Relay:
    """A node that hands on all of one topic to another, or with `hz` at most so many a second."""

    name: str
    span: Span
    source: str
    target: str
    hz: Fraction | None = None


@dataclass(frozen=True, slots=True)
class Graph:
    """Nodes, muxes, relays and how they are wired; neither muxes nor relays are among the nodes.

    `observed` is whether it is all of a robot that ran, so that what nobody hears is loose;
    elsewhere the base may hear it that is no node.
    """

    path: str
    nodes: tuple[Node, ...]
    muxes: tuple[Mux, ...] = ()
    observed: bool = False
    relays: tuple[Relay, ...] = ()


def joined(graphs: Sequence[Graph]) -> Graph:
    """Return several graphs, at least one, as that of one robot: nodes of one name are one."""
    nodes: dict[str, Node] = {}
    for node in chain.from_iterable(graph.nodes for graph in graphs):
        known = nodes.get(node.name)
        nodes[node.name] = node if known is None else _united(known, node)
    muxes = {mux.name: mux for mux in chain.from_iterable(graph.muxes for graph in graphs)}
    relays = {each.name: each for each in chain.from_iterable(graph.relays for graph in graphs)}
    glue = muxes.keys() | relays.keys()
    kept = tuple(node for node in nodes.values() if node.name not in glue)
    observed = any(graph.observed for graph in graphs)
    return Graph(
        graphs[0].path, kept, tuple(muxes.values()), observed, relays=tuple(relays.values())
    )


def _united(first: Node, second: Node) -> Node:
    """Return what two sources of knowledge say of one node; the first one's places stay."""
    return replace(
        first,
        published=each_once((*first.published, *second.published)),
        subscribed=each_once((*first.subscribed, *second.subscribed)),
        guard=first.guard or second.guard,
        unread=first.unread or second.unread,
    )


def each_once(ends: Iterable[Endpoint]) -> tuple[Endpoint, ...]:
    """Return ends with each topic once: its first place, and the first type and rate known."""
    found: dict[str, Endpoint] = {}
    for end in ends:
        known = found.setdefault(end.topic, end)
        if known is not end:
            type_ = end.type if represented(known.type) is None else known.type
            found[end.topic] = replace(known, type=type_, hz=known.hz or end.hz)
    return tuple(found.values())


def represented(written: str | None) -> str | None:
    """Return the representation of a message's type, `None` where it is not known."""
    if written is None or written.strip().lower() in _NO_TYPES:
        return None
    # ROS 1 names C++ templates `Image_`.
    return representation(written.strip().rstrip("_")) or None


def is_command(written: str | None) -> bool:
    """Whether a message of a type tells somebody to move."""
    known = represented(written)
    return known is not None and known.rpartition("::")[2] in COMMANDS


def typed(nodes: Sequence[Node]) -> tuple[Node, ...]:
    """Return nodes with the types of what is relayed, as far as another node knows them."""
    relays = [node for node in nodes if node.relays]
    types: dict[str, str] = {}
    for node in nodes if relays else ():
        for end in (*node.published, *node.subscribed):
            if end.type is not None and represented(end.type) is not None:
                types.setdefault(end.topic, end.type)
    # A chain of relays hands a type on by one relay each time.
    for _ in relays:
        known = len(types)
        for node in relays:
            ends = (*node.published, *node.subscribed)
            for kind in [types[end.topic] for end in ends if end.topic in types][:1]:
                types |= {end.topic: kind for end in ends if end.topic not in types}
        if len(types) == known:
            break

    def with_types(ends: Iterable[Endpoint]) -> tuple[Endpoint, ...]:
        return tuple(replace(end, type=types.get(end.topic, end.type)) for end in ends)

    return tuple(
        replace(node, published=with_types(node.published), subscribed=with_types(node.subscribed))
        if node.relays
        else node
        for node in nodes
    )
