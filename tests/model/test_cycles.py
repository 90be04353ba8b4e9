"""Knots are held against all simple cycles, which networkx counts one by one."""

import random

import networkx
import pytest

from mars_asp.model.cycles import Edge, knots
from tests.support.processes import takes_at_most


def edges_of(seed: int) -> list[Edge]:
    rng = random.Random(seed)
    names = "ABCDEFG"[: rng.randint(1, 7)]
    count = rng.randint(0, 2 * len(names))
    return [(rng.choice(names), rng.choice(names), number) for number in range(count)]


@pytest.mark.parametrize("seed", range(30))
def test_a_knot_shows_its_least_cycle(seed: int) -> None:
    edges = edges_of(seed)
    graph = networkx.DiGraph((start, end) for start, end, _ in edges)
    cycles = [tuple(cycle) for cycle in networkx.simple_cycles(graph)]
    found = knots(edges)
    assert {name for knot in found for name in knot.nodes} == {n for c in cycles for n in c}
    for knot in found:
        inside = [cycle for cycle in cycles if set(cycle) <= set(knot.nodes)]
        least = min(map(len, inside))
        # Each cycle from its least name on.
        turned = [
            cycle[at:] + cycle[:at]
            for cycle in inside
            if len(cycle) == least
            for at in [cycle.index(min(cycle))]
        ]
        assert tuple(start for start, _, _ in knot.walk) == min(turned)
        for start, end, number in knot.walk:
            assert number == min(n for a, b, n in edges if (a, b) == (start, end))
        ends = [end for _, end, _ in knot.walk]
        assert ends == [start for start, _, _ in (*knot.walk[1:], knot.walk[0])]


@pytest.mark.parametrize("seed", range(20))
def test_the_order_of_edges_does_not_matter(seed: int) -> None:
    edges = edges_of(seed)
    shuffled = edges[:]
    random.Random(seed).shuffle(shuffled)
    assert knots(shuffled) == knots(edges)


def test_a_module_that_leads_to_itself_is_a_knot() -> None:
    (knot,) = knots([("A", "A", 4), ("A", "B", 1)])
    assert knot == (("A",), (("A", "A", 4),))


def test_a_ring_of_many_nodes_is_walked_in_a_second() -> None:
    count = 30_000
    edges = [(f"{n:05}", f"{(n + 1) % count:05}", n) for n in range(count)]
    with takes_at_most(5):
        [knot] = knots([*edges, ("00002", "00000", count)])
    assert [start for start, _, _ in knot.walk] == ["00000", "00001", "00002"]
