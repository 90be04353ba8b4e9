"""Excerpts of a diagram: lines of some kinds, boxes near a box, boxes that fit on a screen."""

from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from dataclasses import replace

from mars_asp.draw.picture import Line, LineKind, Picture
from mars_asp.output import counted

#: How wide most screens are, in px.
SCREEN = 1920
#: A picture of fewer boxes is drawn as it is.
_LARGE = 30
#: More boxes are not readable, and would take long to lay out.
_MOST_SHOWN = 300
#: How many boxes are tried first, and by which factor more of them.
_FIRST, _GROWTH = 4, 1.25
#: After so many pictures in a row that are too wide no larger one is tried.
_MOST_MISSES = 3


def of_kinds(picture: Picture, kinds: Collection[LineKind], name: str | None = None) -> Picture:
    """Return a diagram with only lines of some kinds, their boxes, and the named box."""
    lines = [line for line in picture.lines if line.kind in kinds]
    joined = {end for line in lines for end in (line.tail, line.head)}
    joined |= {number for number, box in enumerate(picture.boxes) if box.name == name}
    return _with(replace(picture, lines=tuple(lines)), sorted(joined))


def about(picture: Picture, name: str | None, depth: int, port: str | None = None) -> Picture:
    """Return a diagram of the boxes at most `depth` lines away from the named box.

    With a `port`, paths begin with lines of that port, and with a depth of 1 only these are drawn;
    without a name, they begin with the lines of all ports of that name, such as a topic. Boxes with
    omitted lines have a note with their number.
    """
    near = _neighbours(picture.lines, len(picture.boxes))
    every = range(len(picture.boxes))
    found = {number for number in every if name in (picture.boxes[number].name, None)}
    wire = [line for line in picture.lines if port is None or _has_port(line, found, port)]
    if name is None:
        found = {box for line in wire for box in (line.tail, line.head)}
    first = near if port is None else _neighbours(wire, len(picture.boxes))
    fringe = found
    # The boxes of a topic are one line apart already.
    for step in range(1 if name is None else 0, depth):
        fringe = {other for each in fringe for other in (near if step else first)[each]} - found
        if not fringe:
            break
        found = found | fringe
    return _noted(picture, sorted(found), wire if depth == 1 else picture.lines)


def _has_port(line: Line, boxes: Collection[int], port: str) -> bool:
    """Whether a line begins or ends at the port `port` of one of the boxes."""
    leaves = line.tail in boxes and line.outlet == port
    return leaves or (line.head in boxes and line.inlet == port)


def fitting(
    picture: Picture, width: Callable[[Picture], float], name: str | None = None
) -> Picture:
    """Return the excerpt of a large diagram that fits on a screen: the boxes near the named one.

    Without a name, it has the boxes near the busiest one. `width` is the drawn width in px.
    """
    count = len(picture.boxes)
    if count <= _LARGE or (count <= _MOST_SHOWN and width(picture) <= SCREEN):
        return picture
    order = list(_outwards(picture, name))
    shown, many, misses = _noted(picture, order[:1]), _FIRST, 0
    # More boxes may need less room, where they make another box go to another rank.
    while many <= min(count, _MOST_SHOWN) and misses < _MOST_MISSES:
        larger = _noted(picture, sorted(order[:many]))
        if width(larger) <= SCREEN:
            shown, misses = larger, 0
        else:
            misses += 1
        many = max(many + 1, int(many * _GROWTH))
    return shown


def left_out(whole: Picture, shown: Picture) -> str | None:
    """Return a sentence with the numbers of omitted boxes and lines, or None without any."""
    parts = [
        f"{len(of) - len(left)} of {len(of)} {what}"
        for of, left, what in (
            (whole.boxes, shown.boxes, "modules"),
            (whole.lines, shown.lines, "relationships"),
        )
        if len(left) < len(of)
    ]
    return f"left out: {' and '.join(parts)}" if parts else None


def _outwards(picture: Picture, name: str | None) -> Iterator[int]:
    """Yield the indices of all boxes: nearer to the named box first, then busier ones first.

    Unconnected boxes follow, beginning with the busiest one.
    """
    near = _neighbours(picture.lines, len(picture.boxes))
    busiest = sorted(range(len(near)), key=lambda box: (-len(near[box]), box))
    rank = {box: place for place, box in enumerate(busiest)}
    seen: set[int] = set()
    named = (number for number, box in enumerate(picture.boxes) if box.name == name)
    for start in (*named, *busiest):
        fringe = [] if start in seen else [start]
        seen |= {start}
        while fringe:
            yield from fringe
            further = {other for box in fringe for other in near[box]} - seen
            seen |= further
            fringe = sorted(further, key=rank.__getitem__)


def _neighbours(lines: Iterable[Line], boxes: int) -> Sequence[set[int]]:
    near: list[set[int]] = [set() for _ in range(boxes)]
    for line in lines:
        near[line.tail].add(line.head)
        near[line.head].add(line.tail)
    return near


def _noted(
    picture: Picture, boxes: Sequence[int], shown: Collection[Line] | None = None
) -> Picture:
    """Return a diagram of some boxes with the lines between them; notes count omitted lines.

    `shown` restricts the lines.
    """
    among = set(picture.lines if shown is None else shown)
    more = dict.fromkeys(boxes, 0)
    for line in picture.lines:
        if line not in among or not {line.tail, line.head} <= more.keys():
            for end in more.keys() & {line.tail, line.head}:
                more[end] += 1
    noted = list(picture.boxes)
    for box, number in more.items():
        if number:
            words = counted(number, "more line")
            note = f"{noted[box].note}; {words}" if noted[box].note else words
            noted[box] = replace(noted[box], note=note)
    lines = tuple(line for line in picture.lines if line in among)
    return _with(replace(picture, boxes=tuple(noted), lines=lines), boxes)


def _with(picture: Picture, boxes: Sequence[int]) -> Picture:
    """Return a diagram of some boxes, in this order, with the lines between them."""
    number = {box: place for place, box in enumerate(boxes)}
    lines = tuple(
        replace(line, tail=number[line.tail], head=number[line.head])
        for line in picture.lines
        if line.tail in number and line.head in number
    )
    return replace(picture, boxes=tuple(picture.boxes[box] for box in boxes), lines=lines)
