"""Nodes, muxes and relays that exchange topics, shared by readers of launch files and dumps."""

from collections.abc import Iterable, Sequence
from dataclasses import replace
from itertools import chain

from mars_asp.annotations.types import representation
from mars_asp.model.graph import Endpoint, Graph, GraphNode

#: Message types that command a motion; `Joy` is not one of them, as no base obeys it.
COMMANDS = frozenset(
    {"Twist", "TwistStamped", "AckermannDrive", "AckermannDriveStamped", "JointTrajectory"}
)
#: Texts in dumps for an unknown type.
_NO_TYPES = frozenset({"", "*", "any", "unknown", "unknown type"})


def joined(graphs: Sequence[Graph]) -> Graph:
    """Return one graph of several (at least one) of a robot; nodes of one name are merged."""
    nodes: dict[str, GraphNode] = {}
    for node in chain.from_iterable(graph.nodes for graph in graphs):
        known = nodes.get(node.name)
        nodes[node.name] = node if known is None else united(known, node)
    muxes = {mux.name: mux for mux in chain.from_iterable(graph.muxes for graph in graphs)}
    relays = {each.name: each for each in chain.from_iterable(graph.relays for graph in graphs)}
    glue = muxes.keys() | relays.keys()
    kept = tuple(node for node in nodes.values() if node.name not in glue)
    observed = any(graph.observed for graph in graphs)
    return Graph(
        graphs[0].path, kept, tuple(muxes.values()), observed, relays=tuple(relays.values())
    )


def united(first: GraphNode, second: GraphNode) -> GraphNode:
    """Return the union of two descriptions of one node, with the locations of the first."""
    return replace(
        first,
        published=each_once((*first.published, *second.published)),
        subscribed=each_once((*first.subscribed, *second.subscribed)),
        guard=first.guard or second.guard,
        unread=first.unread or second.unread,
    )


def each_once(ends: Iterable[Endpoint]) -> tuple[Endpoint, ...]:
    """Return the first end of each topic, with type and rate of later ones if it has none."""
    found: dict[str, Endpoint] = {}
    for end in ends:
        known = found.setdefault(end.topic, end)
        if known is not end:
            type_ = end.type if represented(known.type) is None else known.type
            found[end.topic] = replace(known, type=type_, hz=known.hz or end.hz)
    return tuple(found.values())


def represented(written: str | None) -> str | None:
    """Return the representation of a message type, or None if the type is not known."""
    if written is None or written.strip().lower() in _NO_TYPES:
        return None
    # ROS 1 names C++ templates `Image_`.
    return representation(written.strip().rstrip("_")) or None


def is_command(written: str | None) -> bool:
    """Whether a message type commands a motion."""
    known = represented(written)
    return known is not None and known.rpartition("::")[2] in COMMANDS


def typed(nodes: Sequence[GraphNode]) -> tuple[GraphNode, ...]:
    """Return the nodes, where the topics of relays have the types that other nodes state."""
    relays = [node for node in nodes if node.relays]
    types: dict[str, str] = {}
    for node in nodes if relays else ():
        for end in (*node.published, *node.subscribed):
            if end.type is not None and represented(end.type) is not None:
                types.setdefault(end.topic, end.type)
    # In a chain of relays each round can forward a type by only one relay.
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
