"""Connected parts of a graph, drawn each for itself and packed side by side."""

from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import sqrt

from mars_asp.draw.layered import Drawing, LayeredEdge, Point, Route, Size, draw_layered

#: The distance in px between parts.
APART = 44.0


def draw_graph(sizes: Sequence[Size], links: Sequence[LayeredEdge]) -> Drawing:
    """Return the layout of boxes and links, connected components side by side.

    Raises:
        TooLargeError: a component is too large.
    """
    parts = list(_connected(len(sizes), links))
    drawings = []
    for boxes, inside in parts:
        number = {box: index for index, box in enumerate(boxes)}
        own = [links[index] for index in inside]
        own = [replace(link, tail=number[link.tail], head=number[link.head]) for link in own]
        drawings.append(draw_layered([sizes[box] for box in boxes], own))
    corners, size = _pack([drawing.size for drawing in drawings])
    centres: dict[int, Point] = {}
    routes: dict[int, Route] = {}
    for (boxes, inside), drawing, corner in zip(parts, drawings, corners, strict=True):
        for box, at in zip(boxes, drawing.centres, strict=True):
            centres[box] = _moved(at, corner)
        for index, route in zip(inside, drawing.routes, strict=True):
            label = None if route.label is None else _moved(route.label, corner)
            routes[index] = Route(tuple(_moved(at, corner) for at in route.points), label)
    return Drawing(
        size,
        tuple(centres[box] for box in range(len(sizes))),
        tuple(routes[index] for index in range(len(links))),
    )


def _moved(point: Point, by: Point) -> Point:
    return point[0] + by[0], point[1] + by[1]


def _connected(count: int, links: Sequence[LayeredEdge]) -> Iterator[tuple[list[int], list[int]]]:
    """Yield the box and link indices of each connected component, by its first box."""
    near = defaultdict(set)
    for link in links:
        near[link.tail].add(link.head)
        near[link.head].add(link.tail)
    part_of = [-1] * count
    for first in range(count):
        stack = [first] if part_of[first] < 0 else []
        while stack:
            box = stack.pop()
            if part_of[box] < 0:
                part_of[box] = first
                stack += near[box]
    boxes, inside = defaultdict(list), defaultdict(list)
    for box, part in enumerate(part_of):
        boxes[part].append(box)
    for index, link in enumerate(links):
        inside[part_of[link.tail]].append(index)
    for part, members in boxes.items():
        yield members, inside[part]


def _pack(sizes: Sequence[Size]) -> tuple[list[Point], Size]:
    """Return the corners of rectangles packed in rows, the tallest first, and the total size."""
    area = sum((width + APART) * (height + APART) for width, height in sizes)
    most = max([1.3 * sqrt(area), *(width for width, _ in sizes)])
    corners: dict[int, Point] = {}
    x = y = tall = wide = 0.0
    for index in sorted(range(len(sizes)), key=lambda i: -sizes[i][1]):
        width, height = sizes[index]
        if x and x + width > most:
            x, y, tall = 0.0, y + tall + APART, 0.0
        corners[index] = (x, y)
        wide = max(wide, x + width)
        x, tall = x + width + APART, max(tall, height)
    return [corners[index] for index in range(len(sizes))], (wide, y + tall)
