"""A layered drawing of a directed graph: boxes in ranks, links that go down through gaps.

The stages are those of Sugiyama, Tagawa and Toda, "Methods for visual understanding of hierarchical
system structures" (1981). Links are split at every rank, and labels are vertices of ranks of their
own between the boxes, so nothing can cover anything else. The same graph gives the same drawing.
"""

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import accumulate, pairwise
from typing import NamedTuple, TypeAlias

from mars_asp.draw.order import order_layers
from mars_asp.draw.picture import LinkEnd
from mars_asp.draw.ranks import rank_boxes
from mars_asp.draw.straighten import Pull, straighten

Point: TypeAlias = tuple[float, float]
Size: TypeAlias = tuple[float, float]

#: Least distances in px between neighbours of a rank, and beside a line.
NEAR, LINES = 26.0, 16.0
#: A link leaves a box at a port of its own, this far from the next.
PORT = 18.0
#: A link leaves and reaches boxes and labels straight for this long.
STUB = 9.0
#: The height for bends between ranks; where links go far to the side it grows.
BEND, MOST_BEND, BEND_SLOPE = 14.0, 60.0, 0.08
#: The height for each link from a box to itself, which leaves the right side of the box.
LOOP, _LOOP_WIDTH = 21.0, 34.0
#: The distance from a box, and from each other, of links that end at its side or foot.
_BESIDE = 22.0
#: Each takes about a third of a millisecond.
_MOST_PIECES = 60_000


@dataclass(frozen=True, slots=True)
class LayeredEdge:
    """A link between two boxes, by their indices, with the size of its label if it has one.

    Links with a `rank` arrive at their head in this order, from left to right. `end` is the part
    of the head at which a link ends; at the top only if it leads down.
    """

    tail: int
    head: int
    label: Size | None = None
    rank: int | None = None
    end: LinkEnd = "top"


@dataclass(frozen=True, slots=True)
class Route:
    """The path of a link: the points of joined cubic Bézier curves, and its label's centre."""

    points: tuple[Point, ...]
    label: Point | None


@dataclass(frozen=True, slots=True)
class Drawing:
    """The size of a drawing, the centre of each box and the route of each link, all in px."""

    size: Size
    centres: tuple[Point, ...]
    routes: tuple[Route, ...]


class TooLargeError(Exception):
    """Links would pass more boxes than can be drawn in a reasonable time."""


@dataclass(frozen=True, slots=True)
class _Layers:
    """The vertices of the drawing by layer: boxes, and one for each layer that a link crosses.

    The latter are the higher indices. `chains` has the vertices of each link from top to bottom,
    and `named` the vertex of the link that is its label, or None.
    """

    layers: list[list[int]]
    sizes: list[Size]
    chains: list[list[int]]
    named: list[int | None]


def draw_layered(sizes: Sequence[Size], links: Sequence[LayeredEdge]) -> Drawing:
    """Return the layout of boxes of the given `sizes` and of the links between them.

    A box is at least as high as `LOOP` for each of its links to itself.

    Raises:
        TooLargeError: the links have too many pieces.
    """
    between = [index for index, link in enumerate(links) if link.tail != link.head]
    split = _split(sizes, links, between)
    layers, chains = split.layers, split.chains
    ranks: dict[int, dict[int, int]] = defaultdict(dict)
    for index, chain in zip(between, chains, strict=True):
        rank = links[index].rank
        if rank is not None and chain[-1] == links[index].head:
            ranks[chain[-1]] |= dict.fromkeys(chain[:-1], rank)
    pairs = [pair for chain in chains for pair in pairwise(chain)]
    order_layers(layers, pairs, [each for each in ranks.values() if len(set(each.values())) > 1])
    place = {vertex: index for layer in layers for index, vertex in enumerate(layer)}
    widths = [width for width, _ in split.sizes]
    turned = [links[index].head == chain[0] for index, chain in zip(between, chains, strict=True)]
    passing = _passing(links, between, chains, turned, place)
    loops = _loops(links)
    feet = [box for box, own in loops.items() if any(links[i].end == "foot" for i in own)]
    ports = _port_offsets(chains, passing, turned, place, widths, feet)
    foot_of = {box: port[2] for box, port in zip(feet, ports[len(chains) :], strict=True)}
    ports = ports[: len(chains)]
    pulls: dict[int, list[Pull]] = defaultdict(list)
    for chain, (leaving, arriving, _) in zip(chains, ports, strict=True):
        last = len(chain) - 2
        for step, (u, v) in enumerate(pairwise(chain)):
            offset = (leaving if step == 0 else 0.0) - (arriving if step == last else 0.0)
            # Long links are to be straight (weights of Gansner et al., "A technique for drawing
            # directed graphs", 1993).
            weight = 1.0 if last == 0 else 2.0 if step in (0, last) else 8.0
            pulls[v].append(Pull(u, offset, weight, False))
            pulls[u].append(Pull(v, -offset, weight, True))
    aside = _widths_with_loops(sizes, links)
    for index, each in passing.items():
        box = links[between[index]].head
        aside[box] = max(aside[box], sizes[box][0] + 2 * _BESIDE * each.order)
    spaces = [*aside, *widths[len(aside) :]]
    distances = [
        [_distance(u, v, spaces, len(sizes)) for u, v in pairwise(layer)] for layer in layers
    ]
    xs = straighten(layers, distances, pulls, len(widths))
    left = min((x - space / 2 for x, space in zip(xs, spaces, strict=True)), default=0.0)
    right = max((x + space / 2 for x, space in zip(xs, spaces, strict=True)), default=0.0)
    xs = [x - left for x in xs]
    bands = _bands(split, xs)
    centres = [(x, (bands[v][0] + bands[v][1]) / 2) for v, x in enumerate(xs)]
    routes: dict[int, Route] = {}
    for step, (index, chain, port) in enumerate(zip(between, chains, ports, strict=True)):
        points = _way(chain, port, centres, split.sizes, bands)
        points = points[::-1] if turned[step] else points
        named, head = split.named[step], links[index].head
        label = None if named is None else centres[named]
        if step in passing:
            turn = _last_part(passing[step], points[-2], port[2], centres[head], sizes[head])
            routes[index] = Route((*_curve(points[:-1]), *turn), label)
        else:
            routes[index] = Route(_curve(points), label)
    for box, own in loops.items():
        routes.update(_loop_routes(own, links, centres[box], sizes[box], foot_of.get(box, 0.0)))
    return Drawing(
        (right - left, max((bottom for _, bottom in bands), default=0.0)),
        tuple(centres[: len(sizes)]),
        tuple(routes[index] for index in range(len(links))),
    )


def _split(sizes: Sequence[Size], links: Sequence[LayeredEdge], between: Sequence[int]) -> _Layers:
    """Return the layers of boxes and labels, with each link split into a vertex per layer.

    `between` are the indices of links between different boxes.
    """
    arcs = [(links[index].tail, links[index].head) for index in between]
    ranks, downward = rank_boxes(len(sizes), arcs)
    # A label is directly above the target of its link, or below the target of an upward link.
    gaps = [
        ranks[lower] - 1 if arc == (upper, lower) else ranks[upper]
        for arc, (upper, lower) in zip(arcs, downward, strict=True)
    ]
    labelled = {gap for gap, index in zip(gaps, between, strict=True) if links[index].label}
    layer_of, label_layer, count = [], {}, 0
    for rank in range(max(ranks, default=-1) + 1):
        layer_of.append(count)
        label_layer[rank] = count + 1
        count += 2 if rank in labelled else 1
    layers: list[list[int]] = [[] for _ in range(count)]
    for box, rank in enumerate(ranks):
        layers[layer_of[rank]].append(box)
    found = _Layers(layers, list(sizes), [], [])
    if sum(layer_of[ranks[v]] - layer_of[ranks[u]] for u, v in downward) > _MOST_PIECES:
        raise TooLargeError
    for index, gap, (upper, lower) in zip(between, gaps, downward, strict=True):
        label = links[index].label
        chain, named = [upper], None
        for layer in range(layer_of[ranks[upper]] + 1, layer_of[ranks[lower]]):
            chain.append(len(found.sizes))
            layers[layer].append(len(found.sizes))
            if label and layer == label_layer[gap]:
                named = len(found.sizes)
            found.sizes.append(label if label and layer == label_layer[gap] else (0.0, 0.0))
        found.chains.append([*chain, lower])
        found.named.append(named)
    return found


def _widths_with_loops(sizes: Sequence[Size], links: Sequence[LayeredEdge]) -> list[float]:
    """Return the width of each box, including its links to itself."""
    widths = [width for width, _ in sizes]
    for link in links:
        if link.tail == link.head:
            label = (link.label or (0.0, 0.0))[0]
            widths[link.tail] = max(
                widths[link.tail], sizes[link.tail][0] + 2 * (_LOOP_WIDTH + label)
            )
    return widths


def _distance(u: int, v: int, widths: Sequence[float], boxes: int) -> float:
    """Return the minimal distance of the centres of `u` and `v`; the first `boxes` are boxes."""
    thin = not (widths[u] and widths[v]) and max(u, v) >= boxes
    return (widths[u] + widths[v]) / 2 + (LINES if thin else NEAR)


class _Passing(NamedTuple):
    """A link beside its head: to the right (1) or left (-1), and its order outwards from 1.

    `share` is the height at which it ends, from the top of the side (0) to its bottom (1); a link
    to the foot has none.
    """

    side: int
    order: int
    share: float | None


def _passing(
    links: Sequence[LayeredEdge],
    between: Sequence[int],
    chains: Sequence[Sequence[int]],
    turned: Sequence[bool],
    place: Mapping[int, int],
) -> dict[int, _Passing]:
    """Return the links that pass their head: to its side, or down and up to its foot."""
    beside: dict[tuple[int, bool], list[int]] = defaultdict(list)
    places: dict[tuple[int, bool], list[int]] = defaultdict(list)
    for step, (index, chain) in enumerate(zip(between, chains, strict=True)):
        places[chain[0], True].append(place[chain[1]])
        places[chain[-1], False].append(place[chain[-2]])
        end = links[index].end
        if end == "side" or (end == "foot" and not turned[step]):
            beside[links[index].head, turned[step]].append(step)
    # Links from a box to itself are at its right side.
    looped = {link.head for link in links if link.head == link.tail}
    found: dict[int, _Passing] = {}
    for (head, from_below), steps in beside.items():
        near = 1 if from_below else -2
        others = list(places[head, from_below])
        for step in steps:
            others.remove(place[chains[step][near]])
        sides: dict[int, list[tuple[bool, int, int]]] = {1: [], -1: []}
        for step in steps:
            at = place[chains[step][near]]
            right = 2 * sum(other < at for other in others) >= len(others)
            side = 1 if right and head not in looped else -1
            sides[side].append((links[between[step]].end == "foot", side * at, step))
        for side, ordered in sides.items():
            for order, (at_foot, _, step) in enumerate(sorted(ordered), 1):
                share = order / (len(ordered) + 1)
                # Those from below end in the lower half, and those from above in the upper one.
                both = (head, not from_below) in beside
                share = share / 2 if both else share
                share = 1 - share if from_below else share
                found[step] = _Passing(side, order, None if at_foot else share)
    return found


def _port_offsets(
    chains: Sequence[Sequence[int]],
    passing: Mapping[int, _Passing],
    turned: Sequence[bool],
    place: Mapping[int, int],
    widths: Sequence[float],
    feet: Sequence[int],
) -> list[tuple[float, float, float]]:
    """Return for each link its offsets from the centres of the boxes at its two ends.

    The third is where a link that passes its head turns up to the foot. Those of the boxes `feet`,
    which links from themselves reach at the foot, follow.
    """
    below: dict[int, list[tuple[float, int, int]]] = defaultdict(list)
    above: dict[int, list[tuple[float, int, int]]] = defaultdict(list)
    found = [[0.0, 0.0, 0.0] for _ in (*chains, *feet)]
    for index, box in enumerate(feet, len(chains)):
        below[box].append((len(place), index, 2))
    for index, chain in enumerate(chains):
        beside = passing.get(index)
        if beside is None or not turned[index]:
            below[chain[0]].append((place[chain[1]], index, 0))
        if beside is None or turned[index]:
            above[chain[-1]].append((place[chain[-2]], index, 1))
        if beside is not None:
            head = chain[0 if turned[index] else -1]
            out = beside.side * (widths[head] / 2 + _BESIDE * beside.order - _BESIDE / 4)
            found[index][0 if turned[index] else 1] = out
            if beside.share is None:
                # The outer ones turn up further inside.
                below[head].append((beside.side * (len(place) - beside.order), index, 2))
    for boxes in (below, above):
        for box, ends in boxes.items():
            step = min(PORT, (widths[box] - PORT) / len(ends))
            for order, (_, index, port) in enumerate(sorted(ends)):
                found[index][port] = (order - (len(ends) - 1) / 2) * step
    return [(leaving, arriving, foot) for leaving, arriving, foot in found]


def _last_part(
    passing: _Passing, start: Point, foot: float, centre: Point, size: Size
) -> tuple[Point, ...]:
    """Return the curves from a point beside a box to its side, or on down and up to its foot."""
    (x, _), (u, v), (width, height) = start, centre, size
    if passing.share is not None:
        bend = x, v + (passing.share - 0.5) * height
        return bend, bend, (u + passing.side * width / 2, bend[1])
    low = v + height / 2
    deep = low + (2 + passing.order / 2) * STUB
    at = u + foot
    return (x, low), (x, low), (x, low), (x, deep), (at, deep), (at, low)


def _bands(split: _Layers, xs: Sequence[float]) -> list[tuple[float, float]]:
    """Return the top and bottom of the layer of each vertex, at x positions `xs`."""
    layers = split.layers
    layer_of = {vertex: index for index, layer in enumerate(layers) for vertex in layer}
    aside = [0.0] * len(layers)
    for chain in split.chains:
        for u, v in pairwise(chain):
            aside[layer_of[v]] = max(aside[layer_of[v]], abs(xs[u] - xs[v]))
    tall = [max(split.sizes[vertex][1] for vertex in layer) for layer in layers]
    gaps = [0.0, *(2 * STUB + min(MOST_BEND, BEND + BEND_SLOPE * far) for far in aside[1:])]
    bottoms = list(accumulate(gap + height for gap, height in zip(gaps, tall, strict=True)))
    bands = [(bottom - height, bottom) for bottom, height in zip(bottoms, tall, strict=True)]
    return [bands[layer_of[vertex]] for vertex in range(len(xs))]


def _way(
    chain: Sequence[int],
    port: tuple[float, float, float],
    centres: Sequence[Point],
    sizes: Sequence[Size],
    bands: Sequence[tuple[float, float]],
) -> list[Point]:
    """Return the points of a link from top to bottom; it is vertical within layers."""
    (x, y), (u, v) = centres[chain[0]], centres[chain[-1]]
    x, u = x + port[0], u + port[1]
    points = [(x, y + sizes[chain[0]][1] / 2), (x, bands[chain[0]][1] + STUB)]
    for vertex in chain[1:-1]:
        top, bottom = bands[vertex]
        at = centres[vertex][0]
        points += [(at, top - STUB), (at, bottom + STUB)]
    return [*points, (u, bands[chain[-1]][0] - STUB), (u, v - sizes[chain[-1]][1] / 2)]


def _curve(points: Sequence[Point]) -> tuple[Point, ...]:
    """Return the points of Bézier curves through `points`, vertical at each of them."""
    found = [points[0]]
    for (x, y), (u, v) in pairwise(points):
        if (x, y) != (u, v):
            found += [(x, (y + v) / 2), (u, (y + v) / 2), (u, v)]
    return tuple(found)


def _loops(links: Sequence[LayeredEdge]) -> dict[int, list[int]]:
    """Return the links from each box to itself, those to its foot last."""
    found: dict[int, list[int]] = defaultdict(list)
    for at_foot in (False, True):
        for index, link in enumerate(links):
            if link.tail == link.head and (link.end == "foot") is at_foot:
                found[link.tail].append(index)
    return found


def _loop_routes(
    own: Sequence[int], links: Sequence[LayeredEdge], centre: Point, size: Size, foot: float
) -> Iterator[tuple[int, Route]]:
    """Yield the route of each link from a box to itself, from top to bottom.

    Those to the foot, at the offset `foot` from the centre, are each inside the one above it.
    """
    (x, y), (width, height) = centre, size
    outer = sum(links[index].end != "foot" for index in own)
    for row, index in enumerate(own):
        at = x + width / 2, y + LOOP * (row - (len(own) - 1) / 2)
        if row < outer:
            yield index, _loop(at, links[index].label)
        else:
            share = (len(own) - row) / (len(own) - outer)
            yield index, _loop_to_foot(at, links[index].label, (x + foot, y + height / 2), share)


def _loop(at: Point, label: Size | None) -> Route:
    """Return the route of a link from a box to itself, at a point of its right side."""
    x, y = at
    far = x + _LOOP_WIDTH
    points = ((x, y - 7), (far, y - 7), (far, y + 7), (x, y + 7))
    return Route(points, (far + label[0] / 2 - 2, y) if label else None)


def _loop_to_foot(at: Point, label: Size | None, foot: Point, share: float) -> Route:
    """Return the route of a link from a point of a box's right side to its foot.

    `share` of the width for such links is used.
    """
    (x, y), (u, low) = at, foot
    far, deep = x + share * (_LOOP_WIDTH - 4), low + (1 + 1.5 * share) * STUB
    points = (at, (far, y), (far, y), (far, low), (far, deep), (u, deep), foot)
    return Route(points, (x + _LOOP_WIDTH + label[0] / 2 - 2, y) if label else None)
