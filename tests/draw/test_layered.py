"""Layered drawings of random graphs: nothing covers anything else, and nothing is left out."""

import math
import random
from collections import Counter
from collections.abc import Iterator
from itertools import combinations, pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mars_asp.draw.layered import (
    LOOP,
    Drawing,
    LayeredEdge,
    Point,
    Route,
    Size,
    TooLargeError,
    draw_layered,
)
from mars_asp.draw.packing import draw_graph
from mars_asp.draw.straighten import Pull, straighten
from tests.support.campaigns import examples


@st.composite
def graphs(draw: st.DrawFn) -> tuple[list[Size], list[LayeredEdge]]:
    sizes = st.tuples(st.sampled_from((64.0, 90.5, 210.0)), st.sampled_from((34.0, 46.0)))
    boxes = draw(st.lists(sizes, min_size=1, max_size=9))
    box = st.integers(0, len(boxes) - 1)
    ends = st.sampled_from(("top", "side", "foot"))
    labels = st.one_of(st.none(), st.just((70.0, 16.5)), st.just((180.0, 16.5)))
    links = draw(st.lists(st.builds(LayeredEdge, box, box, labels, end=ends), max_size=14))
    loops = Counter(link.tail for link in links if link.tail == link.head)
    return [(w, max(h, loops[i] * LOOP)) for i, (w, h) in enumerate(boxes)], links


Rectangle = tuple[float, float, float, float]


def around(centre: Point, size: Size) -> Rectangle:
    (x, y), (width, height) = centre, size
    return x - width / 2, y - height / 2, x + width / 2, y + height / 2


def overlap(a: Rectangle, b: Rectangle) -> bool:
    return a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]


def covers(rectangle: Rectangle, point: Point) -> bool:
    left, top, right, bottom = rectangle
    return left + 0.1 < point[0] < right - 0.1 and top + 0.1 < point[1] < bottom - 0.1


def along(route: Route) -> Iterator[Point]:
    """Yield points of joined cubic Bézier curves, no further apart than a label is high."""
    start, *rest = route.points
    for a, b, c in zip(rest[::3], rest[1::3], rest[2::3], strict=True):
        steps = max(8, math.ceil((abs(c[0] - start[0]) + abs(c[1] - start[1])) / 8))
        for step in range(steps + 1):
            t = step / steps
            weights = ((1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t * t * (1 - t), t**3)
            weighted = list(zip(weights, (start, a, b, c), strict=True))
            yield sum(w * x for w, (x, _) in weighted), sum(w * y for w, (_, y) in weighted)
        start = c


def rectangles(
    sizes: list[Size], links: list[LayeredEdge], drawing: Drawing
) -> tuple[list[Rectangle], dict[int, Rectangle]]:
    boxes = [around(at, size) for at, size in zip(drawing.centres, sizes, strict=True)]
    labels = {
        index: around(route.label, link.label)
        for index, (link, route) in enumerate(zip(links, drawing.routes, strict=True))
        if link.label is not None and route.label is not None
    }
    return boxes, labels


@settings(max_examples=examples(40, 150), deadline=None)
@given(graphs())
def test_boxes_and_labels_do_not_overlap(graph: tuple[list[Size], list[LayeredEdge]]) -> None:
    sizes, links = graph
    drawing = draw_graph(sizes, links)
    boxes, labels = rectangles(sizes, links, drawing)
    assert [i for i, link in enumerate(links) if link.label] == list(labels)
    assert not [pair for pair in combinations([*boxes, *labels.values()], 2) if overlap(*pair)]
    width, height = drawing.size
    assert all(
        a > -0.1 and b > -0.1 and c < width + 0.1 and d < height + 0.1 for a, b, c, d in boxes
    )


@settings(max_examples=examples(40, 150), deadline=None)
@given(graphs())
def test_no_line_passes_a_box_or_the_label_of_another(
    graph: tuple[list[Size], list[LayeredEdge]],
) -> None:
    sizes, links = graph
    drawing = draw_graph(sizes, links)
    boxes, labels = rectangles(sizes, links, drawing)
    for index, (link, route) in enumerate(zip(links, drawing.routes, strict=True)):
        others = [at for other, at in labels.items() if other != index]
        for point in along(route):
            assert not any(covers(box, point) for box in boxes), (link, point)
            assert not any(covers(label, point) for label in others), (link, point)


@settings(max_examples=examples(30, 100), deadline=None)
@given(graphs())
def test_lines_lead_from_the_edge_of_one_box_to_that_of_the_other(
    graph: tuple[list[Size], list[LayeredEdge]],
) -> None:
    sizes, links = graph
    drawing = draw_graph(sizes, links)
    for link, route in zip(links, drawing.routes, strict=True):
        for box, (x, y) in ((link.tail, route.points[0]), (link.head, route.points[-1])):
            left, top, right, bottom = around(drawing.centres[box], sizes[box])
            on_level = left - 0.1 <= x <= right + 0.1 and min(abs(y - top), abs(y - bottom)) < 0.1
            on_side = link.tail == link.head and abs(x - right) < 0.1 and top < y < bottom
            if link.end == "foot" and (x, y) == route.points[-1]:
                on_side = False
            if link.end == "side" and (x, y) == route.points[-1]:
                on_side = min(abs(x - left), abs(x - right)) < 0.1 and top < y < bottom
            assert on_level or on_side


@settings(max_examples=examples(20, 60), deadline=None)
@given(st.integers(2, 30), st.randoms(use_true_random=False))
def test_links_of_a_graph_without_cycles_go_down(count: int, random: random.Random) -> None:
    links = [LayeredEdge(random.randrange(head), head) for head in range(1, count)]
    drawing = draw_layered([(80.0, 34.0)] * count, links)
    ys = [y for _, y in drawing.centres]
    assert all(ys[link.tail] < ys[link.head] for link in links)


def test_a_link_from_a_box_to_itself_can_end_at_its_foot() -> None:
    links = [LayeredEdge(0, 0, end="foot"), LayeredEdge(0, 0), LayeredEdge(0, 1)]
    drawing = draw_layered([(80.0, 42.0), (80.0, 34.0)], links)
    (x, y), reset, down = drawing.centres[0], drawing.routes[0], drawing.routes[2]
    assert reset.points[0][0] == x + 40
    assert reset.points[-1][1] == y + 21
    assert down.points[0][0] < reset.points[-1][0] < x + 40


def test_a_tree_is_drawn_without_crossings() -> None:
    links = [LayeredEdge((head - 1) // 3, head) for head in range(1, 40)]
    drawing = draw_layered([(80.0, 34.0)] * 40, links)
    ends = [(drawing.centres[link.tail], drawing.centres[link.head]) for link in links]
    crossings = [
        pair
        for pair in combinations(ends, 2)
        if pair[0][0][1] == pair[1][0][1]
        and (pair[0][0][0] - pair[1][0][0]) * (pair[0][1][0] - pair[1][1][0]) < 0
    ]
    assert crossings == []


def test_a_long_line_is_straight() -> None:
    """A chain of boxes with a link that passes all of them."""
    links = [LayeredEdge(i, i + 1) for i in range(8)] + [LayeredEdge(0, 8)]
    route = draw_layered([(90.0, 34.0)] * 9, links).routes[-1]
    beside = [x for x, y in route.points[4:-4]]
    assert max(beside) - min(beside) < 0.1


@settings(max_examples=examples(20, 60), deadline=None)
@given(st.randoms(use_true_random=False))
def test_positions_keep_their_order_and_distance(random: random.Random) -> None:
    layers = [list(range(first, first + 5)) for first in range(0, 25, 5)]
    distances = [[random.uniform(10, 90) for _ in layer[1:]] for layer in layers]
    pulls: dict[int, list[Pull]] = {vertex: [] for vertex in range(25)}
    for upper, lower in pairwise(layers):
        for _ in range(6):
            u, v = random.choice(upper), random.choice(lower)
            offset, weight = random.uniform(-20, 20), random.choice((1.0, 2.0, 8.0))
            pulls[v].append(Pull(u, offset, weight, False))
            pulls[u].append(Pull(v, -offset, weight, True))
    xs = straighten(layers, distances, pulls, 25)
    for layer, least in zip(layers, distances, strict=True):
        for (u, v), distance in zip(pairwise(layer), least, strict=True):
            assert xs[v] - xs[u] >= distance - 1e-4


def test_slow_drawings_are_refused() -> None:
    chain = [LayeredEdge(i, i + 1) for i in range(400)]
    with pytest.raises(TooLargeError):
        draw_layered([(64.0, 34.0)] * 401, chain + [LayeredEdge(0, 400)] * 200)
