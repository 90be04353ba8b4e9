"""Cycles in directed graphs."""

from collections.abc import Iterable
from graphlib import CycleError, TopologicalSorter
from typing import NamedTuple, TypeAlias

Edge: TypeAlias = tuple[str, str, int]


class Knot(NamedTuple):
    """A strongly connected component: its nodes, sorted, and the edges of a shortest cycle."""

    nodes: tuple[str, ...]
    walk: tuple[Edge, ...]


def knots(edges: Iterable[Edge]) -> tuple[Knot, ...]:
    """Return the strongly connected components that contain a cycle.

    An edge is (start, end, identifier). A cycle begins at its first node by name; of equally short
    ones the first by name is taken. In components of more than `_EXACT` nodes only a short cycle is
    found, to keep the time linear.
    """
    best: dict[tuple[str, str], int] = {}
    for start, end, number in edges:
        best[start, end] = min(number, best.get((start, end), number))
    successors: dict[str, list[str]] = {}
    for start, end in sorted(best):
        successors.setdefault(start, []).append(end)
    try:
        TopologicalSorter(successors).prepare()
        return ()
    except CycleError:
        pass
    import networkx  # noqa: PLC0415 -- slow to import, and only a configuration with cycles needs it

    graph = networkx.DiGraph(list(best))
    parts = sorted(sorted(part) for part in networkx.strongly_connected_components(graph))
    found = []
    for part in parts:
        cycle = _shortest_cycle(part, successors)
        if cycle:
            steps = zip(cycle, (*cycle[1:], cycle[0]), strict=True)
            walk = tuple((start, end, best[start, end]) for start, end in steps)
            found.append(Knot(tuple(part), walk))
    return tuple(found)


_EXACT = 400


def _shortest_cycle(part: list[str], successors: dict[str, list[str]]) -> tuple[str, ...]:
    """Return the shortest of the cycles found by searches from nodes, () without any.

    In a large component, searches begin only at the first nodes.
    """
    inside = set(part)
    best: tuple[str, ...] = ()
    # Each search may walk the whole part: the larger it is, the fewer there are.
    for root in part[: max(1, _EXACT * _EXACT // max(_EXACT, len(part)))]:
        found = _way_back(root, inside, successors, len(best))
        if found and (not best or len(found) < len(best)):
            best = found
    return best


def _way_back(
    root: str, inside: set[str], successors: dict[str, list[str]], bound: int
) -> tuple[str, ...]:
    came: dict[str, str] = {}
    level, length = [root], 1
    while level and (not bound or length < bound):
        following = []
        for node in level:
            for end in successors.get(node, ()):
                if end == root:
                    path = [node]
                    while path[-1] != root:
                        path.append(came[path[-1]])
                    return tuple(reversed(path))
                if end in inside and end not in came:
                    came[end] = node
                    following.append(end)
        level, length = following, length + 1
    return ()
