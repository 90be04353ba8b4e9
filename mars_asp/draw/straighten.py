"""Positions along ranks: links as straight as the order and the least distances allow."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import accumulate, pairwise

_SPREADING, _ALIGNING = 24, 24
_NEXT_TO_NOTHING = 1e-6


@dataclass(frozen=True, slots=True)
class Pull:
    """The preferred position of a vertex: `offset` from vertex `to` in an adjacent layer."""

    to: int
    offset: float
    weight: float
    below: bool


def straighten(
    layers: Sequence[Sequence[int]],
    distances: Sequence[Sequence[float]],
    pulls: Mapping[int, Sequence[Pull]],
    count: int,
) -> list[float]:
    """Return the position of each of `count` vertices.

    `distances` are the minimal ones between neighbours of a layer. First each layer moves to the
    mean of its pulls, which spreads the drawing; then vertices that are aligned already move as one
    block to the median of the pulls of the block, which makes lines straight.
    """
    xs = [0.0] * count
    for layer, least in zip(layers, distances, strict=True):
        for vertex, x in zip(layer, accumulate(least, initial=0.0), strict=True):
            xs[vertex] = x
    for step in range(_SPREADING):
        # Early rounds look one way, so that a whole drawing can move; later ones both ways.
        one_way = step < _SPREADING // 2
        up = step % 2 == 1
        order = range(len(layers) - 1, -1, -1) if up else range(len(layers))
        for index in order:
            layer = layers[index]
            targets = [_mean(vertex, pulls, xs, one_way, up) for vertex in layer]
            for vertex, x in zip(layer, _fit(targets, distances[index]), strict=True):
                xs[vertex] = x
    _align(xs, layers, distances, pulls)
    return xs


def _mean(
    vertex: int, pulls: Mapping[int, Sequence[Pull]], xs: Sequence[float], one_way: bool, up: bool
) -> tuple[float, float]:
    """Return the mean position that a vertex's pulls prefer, and their weight.

    If `one_way`, only pulls from below (`up`) or from above count.
    """
    found = [pull for pull in pulls.get(vertex, ()) if not one_way or pull.below == up]
    if not found:
        return xs[vertex], 0.1
    weight = sum(pull.weight for pull in found)
    return sum((xs[pull.to] + pull.offset) * pull.weight for pull in found) / weight, weight


def _fit(targets: Sequence[tuple[float, float]], least: Sequence[float]) -> list[float]:
    """Return positions near their targets, where neighbours keep the minimal distances `least`.

    Pooling adjacent violators (Barlow et al., "Statistical inference under order restrictions",
    1972) finds the minimal sum of weighted squares.
    """
    shifts = list(accumulate(least, initial=0.0))
    pools: list[tuple[float, float, int]] = []
    for (wanted, weight), shift in zip(targets, shifts, strict=True):
        pool = (wanted - shift, weight, 1)
        while pools and pools[-1][0] >= pool[0]:
            x, before, size = pools.pop()
            total = before + pool[1]
            pool = ((x * before + pool[0] * pool[1]) / total, total, size + pool[2])
        pools.append(pool)
    flat = [x for x, _, size in pools for _ in range(size)]
    return [x + shift for x, shift in zip(flat, shifts, strict=True)]


def _align(
    xs: list[float],
    layers: Sequence[Sequence[int]],
    distances: Sequence[Sequence[float]],
    pulls: Mapping[int, Sequence[Pull]],
) -> None:
    """Move blocks of aligned vertices, in place, to the medians of their pulls, as far as possible.

    No move increases the weighted sum of the sideways lengths of lines, and a block that reaches a
    median becomes a part of a larger block. Rounds of single vertices and of long lines come
    between, because a part of a block may have a better position.
    """
    left = {
        v: (u, least)
        for layer, row in zip(layers, distances, strict=True)
        for (u, v), least in zip(pairwise(layer), row, strict=True)
    }
    right = {u: (v, least) for v, (u, least) in left.items()}
    heaviest = max((pull.weight for found in pulls.values() for pull in found), default=0.0)
    still = 0
    for step in range(_ALIGNING):
        still += 1
        for block in _blocks(xs, layers, pulls, (2 * heaviest, heaviest, 0.0)[step % 3]):
            inside = set(block)
            wanted = [
                (xs[pull.to] + pull.offset - xs[vertex], pull.weight)
                for vertex in block
                for pull in pulls.get(vertex, ())
                if pull.to not in inside
            ]
            least = [
                xs[other] + distance - xs[vertex]
                for vertex in block
                for other, distance in (left.get(vertex, (vertex, 0.0)),)
                if other not in inside
            ]
            most = [
                xs[other] - distance - xs[vertex]
                for vertex in block
                for other, distance in (right.get(vertex, (vertex, 0.0)),)
                if other not in inside
            ]
            shift = max([_nearest_median(wanted), *least]) if wanted else 0.0
            shift = min([shift, *most])
            if abs(shift) > _NEXT_TO_NOTHING:
                still = 0
                for vertex in block:
                    xs[vertex] += shift
        if still == 3:
            return


def _blocks(
    xs: Sequence[float],
    layers: Sequence[Sequence[int]],
    pulls: Mapping[int, Sequence[Pull]],
    least: float,
) -> Iterator[list[int]]:
    """Yield blocks of vertices that pulls with at least the weight `least` align at present."""
    seen = [False] * len(xs)
    for layer in layers:
        for first in layer:
            block = [] if seen[first] else [first]
            seen[first] = True
            for vertex in block:
                for pull in pulls.get(vertex, ()):
                    aside = abs(xs[pull.to] + pull.offset - xs[vertex])
                    if not seen[pull.to] and pull.weight >= least and aside <= _NEXT_TO_NOTHING:
                        seen[pull.to] = True
                        block.append(pull.to)
            if block:
                yield block


def _nearest_median(wanted: Sequence[tuple[float, float]]) -> float:
    """Return the weighted median of (position, weight) pairs; of several, the nearest to 0."""
    half = sum(weight for _, weight in wanted) / 2
    passed = 0.0
    low: float | None = None
    for x, weight in sorted(wanted):
        if low is not None:
            return min(low, x, key=abs)
        passed += weight
        if passed > half:
            return x
        if passed == half:
            low = x
    return 0.0 if low is None else low
