"""The order of vertices within ranks, with few crossings."""

from bisect import bisect_right, insort
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from operator import itemgetter

_SWEEPS, _PATIENCE = 24, 6
#: Swapping neighbours costs the square of their links; beyond this many vertices it is left out,
#: and one beginning is enough.
_MOST_SWAPPED = 4000


def order_layers(
    layers: list[list[int]],
    arcs: Sequence[tuple[int, int]],
    ranks: Sequence[Mapping[int, int]] = (),
) -> None:
    """Order the vertices of each layer, in place, so that arcs between layers cross rarely.

    Arcs lead from one layer to the next. Barycentres and swaps of neighbours, down and up, as in
    Gansner et al., "A technique for drawing directed graphs" (1993), from the order in which a
    search meets the vertices from the first layer, or from the last; the best order is kept.
    Vertices of a layer that have `ranks` in one mapping stay in the order of these.
    """
    below: dict[int, list[int]] = defaultdict(list)
    above: dict[int, list[int]] = defaultdict(list)
    for upper, lower in arcs:
        below[upper].append(lower)
        above[lower].append(upper)
    kept = list(_in_layers(layers, ranks))
    tried: list[tuple[int, list[list[int]]]] = []
    ways = list(product((below, above), (False, True)))
    for begin, turning in ways if sum(map(len, layers)) <= _MOST_SWAPPED else ways[:1]:
        start = [list(layer) for layer in (layers if begin is below else layers[::-1])]
        _initial_order(start, begin)
        start = start if begin is below else start[::-1]
        tried.append((_sweep(start, below, above, turning, kept), start))
        if not tried[-1][0]:
            break
    layers[:] = min(tried, key=itemgetter(0))[1]


def _sweep(
    layers: list[list[int]],
    below: Mapping[int, list[int]],
    above: Mapping[int, list[int]],
    turning: bool,
    kept: Sequence[tuple[int, Mapping[int, int]]],
) -> int:
    """Reorder the layers, in place, to reduce crossings; return the number of crossings left.

    If `turning`, vertices with equal values change places in every other round. `kept` are the
    layers with ranked vertices.
    """
    _keep(layers, kept)
    place = {vertex: index for layer in layers for index, vertex in enumerate(layer)}
    swapping = len(place) <= _MOST_SWAPPED
    best = [list(layer) for layer in layers]
    fewest = _crossings(layers, below, place)
    found = 0
    for sweep in range(_SWEEPS):
        if not fewest or sweep > found + _PATIENCE:
            break
        down = sweep % 2 == 0
        near = above if down else below
        for layer in layers[1:] if down else layers[-2::-1]:
            if turning and sweep % 4 > 1:
                layer.reverse()
            _sort(layer, near, place)
        if swapping:
            for layer in layers:
                _swap(layer, below, above, place)
        place.update(_keep(layers, kept))
        crossings = _crossings(layers, below, place)
        if crossings < fewest:
            best, fewest, found = [list(layer) for layer in layers], crossings, sweep
    layers[:] = best
    return fewest


def _initial_order(layers: list[list[int]], below: Mapping[int, list[int]]) -> None:
    """Sort the vertices of each layer, in place, by a depth-first search from the first layer."""
    met: dict[int, int] = {}
    for layer in list(layers):
        for vertex in layer:
            stack = [vertex]
            while stack:
                other = stack.pop()
                if other not in met:
                    met[other] = len(met)
                    stack += reversed(below.get(other, []))
    for layer in layers:
        layer.sort(key=met.__getitem__)


def _in_layers(
    layers: Sequence[Sequence[int]], ranks: Sequence[Mapping[int, int]]
) -> Iterator[tuple[int, Mapping[int, int]]]:
    """Yield index and ranks of each layer in which a mapping ranks several vertices."""
    layer_of = {vertex: index for index, layer in enumerate(layers) for vertex in layer}
    for rank in ranks:
        within: dict[int, dict[int, int]] = defaultdict(dict)
        for vertex, number in rank.items():
            within[layer_of[vertex]][vertex] = number
        yield from ((index, each) for index, each in within.items() if len(each) > 1)


def _keep(
    layers: Sequence[list[int]], kept: Sequence[tuple[int, Mapping[int, int]]]
) -> Mapping[int, int]:
    """Sort the ranked vertices of layers, in place; return new positions in the sorted layers."""
    for number, rank in kept:
        layer = layers[number]
        slots = [index for index, vertex in enumerate(layer) if vertex in rank]
        ordered = sorted((layer[index] for index in slots), key=rank.__getitem__)
        for index, vertex in zip(slots, ordered, strict=True):
            layer[index] = vertex
    changed = {number for number, _ in kept}
    return {v: index for number in changed for index, v in enumerate(layers[number])}


def _sort(layer: list[int], near: Mapping[int, list[int]], place: dict[int, int]) -> None:
    def barycentre(vertex: int) -> float:
        others = near.get(vertex)
        if not others:
            return float(place[vertex])
        return sum(place[other] for other in others) / len(others)

    layer.sort(key=barycentre)
    for index, vertex in enumerate(layer):
        place[vertex] = index


def _swap(
    layer: list[int],
    below: Mapping[int, list[int]],
    above: Mapping[int, list[int]],
    place: dict[int, int],
) -> None:
    """Swap neighbours in a layer, in place, while this reduces crossings; update `place`."""
    ends = [
        {vertex: [place[other] for other in near.get(vertex, ())] for vertex in layer}
        for near in (below, above)
    ]
    due = list(range(len(layer) - 1))
    while due:
        moved: list[int] = []
        for index in due:
            if moved and moved[-1] == index - 1:
                continue  # what came from there has its turn in the next round
            u, v = layer[index : index + 2]
            pairs = ((a, b) for side in ends for a in side[u] for b in side[v])
            if sum((a > b) - (a < b) for a, b in pairs) > 0:
                layer[index : index + 2] = [v, u]
                place[u], place[v] = index + 1, index
                moved.append(index)
        # The layers on both sides stand still, so only new neighbours can be out of order.
        near_moved = {other for index in moved for other in (index - 1, index + 1)}
        due = sorted(near_moved.intersection(range(len(layer) - 1)))


def _crossings(
    layers: Sequence[Sequence[int]], below: Mapping[int, list[int]], place: Mapping[int, int]
) -> int:
    total = 0
    for layer in layers:
        seen: list[int] = []
        for vertex in layer:
            ends = sorted(place[other] for other in below.get(vertex, ()))
            total += sum(len(seen) - bisect_right(seen, end) for end in ends)
            for end in ends:
                insort(seen, end)
    return total
