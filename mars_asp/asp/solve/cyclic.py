"""Nodes of a graph that depend on each other."""

from collections.abc import Hashable, Iterable, Mapping
from typing import TypeVar

_Node = TypeVar("_Node", bound=Hashable)


def cyclic_components(edges: Iterable[tuple[_Node, _Node]]) -> Mapping[_Node, int]:
    """Return the component number of each node that is on a cycle."""
    import networkx  # noqa: PLC0415 -- slow to import, and few commands need it

    graph = networkx.DiGraph(edges)
    return {
        node: number
        for number, component in enumerate(networkx.strongly_connected_components(graph))
        for node in component
        if len(component) > 1 or graph.has_edge(node, node)
    }
