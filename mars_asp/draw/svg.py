"""A diagram as SVG with a built-in layout, so that its bytes are the same on every system."""

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from math import inf
from types import MappingProxyType
from typing import NamedTuple, TypeAlias

from mars_asp.draw.colours import LINES, QUIET
from mars_asp.draw.layered import Drawing, LayeredEdge, Point, Size, TooLargeError
from mars_asp.draw.legend import (
    ROW,
    draw_findings,
    draw_row,
    finding_lines,
    finding_width,
    findings_height,
    legend_items,
    legend_rows,
    legend_width,
)
from mars_asp.draw.packing import APART, draw_graph
from mars_asp.draw.picture import Picture
from mars_asp.draw.shapes import (
    FONT,
    NOTE,
    box_size,
    draw_box,
    draw_line,
    draw_markers,
    draw_sentence,
    escaped,
    label_size,
    plain,
    text_width,
)

_MARGIN = 24.0
#: A legend makes a narrow picture wider, up to this, and boxes without lines do.
_LEGEND_WIDTH = 560.0
_NEAR = 10.0
_NOWHERE: Mapping[str | int, str] = MappingProxyType({})
Layout: TypeAlias = Callable[[Sequence[Size], Sequence[LayeredEdge]], Drawing]


class _Arrangement(NamedTuple):
    """The positions of boxes and lines, and captions for the boxes without lines."""

    sizes: Sequence[Size]
    drawing: Drawing
    captions: Sequence[tuple[str, Point]]


def drawn_width(picture: Picture) -> float:
    """Return the drawn width of a diagram in px, infinite if it is too large to be drawn."""
    try:
        return _laid_out(picture, draw_graph).drawing.size[0] + 2 * _MARGIN
    except TooLargeError:
        return inf


def svg_text(
    picture: Picture, targets: Mapping[str | int, str] = _NOWHERE, layout: Layout = draw_graph
) -> str:
    """Return a diagram as SVG, without any active content.

    In an HTML page that contains it, boxes link to the `targets` of their names, and lines to those
    of the numbers of their findings.

    Raises:
        TooLargeError: there would be too many lines beside too many boxes.
    """
    sizes, drawing, captions = _laid_out(picture, layout)
    legend = legend_items(picture)
    inside = max(drawing.size[0], min(legend_width(legend), _LEGEND_WIDTH))
    if picture.remark:
        inside = max(inside, text_width(picture.remark, NOTE))
    longest = max((finding_width(each) for each in picture.marks), default=0.0)
    inside = max(inside, min(longest, _LEGEND_WIDTH))
    rows = list(legend_rows(legend, inside))
    width, below = inside + 2 * _MARGIN, drawing.size[1] + 2 * _MARGIN
    findings = finding_lines(picture.marks, inside)
    legend_height = len(rows) * ROW + findings_height(findings)
    height = below + legend_height + bool(picture.remark) * ROW + _MARGIN * 0.8
    corner = (width - drawing.size[0]) / 2
    # The parts of an image are not announced, so links could not be found there.
    role = "group" if targets else "img"
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{plain(width)}" height="{plain(height)}" '
        f'viewBox="0 0 {plain(width)} {plain(height)}" font-family="{FONT}" role="{role}">',
        f"<title>{escaped(picture.title)}</title>",
        "<defs>",
        *draw_markers({line.kind for line in picture.lines}),
        "</defs>",
        '<rect width="100%" height="100%" fill="#ffffff"/>',
        f'<g class="picture" transform="translate({plain(corner)} {plain(_MARGIN)})">',
    ]
    routed = list(zip(picture.lines, drawing.routes, strict=True))
    # Mounts are drawn first, because they are the widest and would hide other lines.
    for kind in LINES:
        for line, route in routed:
            if line.kind == kind:
                found = (targets.get(each.number) for each in line.findings)
                target = next(filter(None, found), None)
                parts += _linked([draw_line(line, route)], line.text, target)
    for box, centre, size in zip(picture.boxes, drawing.centres, sizes, strict=True):
        parts += _linked(draw_box(box, centre, size), box.name, targets.get(box.name))
    parts += (draw_sentence(text, at, NOTE, QUIET) for text, at in captions)
    parts += ["</g>", '<g class="legend">']
    for index, row in enumerate(rows):
        parts += draw_row(row, (_MARGIN, below + index * ROW))
    parts += draw_findings(findings, (_MARGIN, below + len(rows) * ROW))
    if picture.remark:
        at = _MARGIN, below + legend_height + ROW / 2
        parts.append(draw_sentence(picture.remark, at, NOTE, QUIET))
    return "\n".join([*parts, "</g>", "</svg>"]) + "\n"


def _linked(parts: Iterable[str], name: str, target: str | None) -> Iterator[str]:
    """Yield SVG parts inside a link to `target`, unless this is None."""
    if target is not None:
        yield f'<a href="{escaped(target)}" aria-label="{escaped(name)}">'
    yield from parts
    if target is not None:
        yield "</a>"


def _laid_out(picture: Picture, layout: Layout) -> _Arrangement:
    """Return the positions of boxes and lines; boxes without lines are at the bottom.

    Raises:
        TooLargeError: the diagram is too large.
    """
    loops = Counter(line.tail for line in picture.lines if line.tail == line.head)
    leaving = Counter(line.tail for line in picture.lines)
    reaching = Counter(line.head for line in picture.lines)
    sizes = [
        box_size(box, max(leaving[index], reaching[index]), loops[index])
        for index, box in enumerate(picture.boxes)
    ]
    joined = [index for index, box in enumerate(picture.boxes) if not box.alone]
    number = {index: place for place, index in enumerate(joined)}
    links = [
        LayeredEdge(number[line.tail], number[line.head], label_size(line), line.rank, line.end)
        for line in picture.lines
    ]
    drawing = layout([sizes[index] for index in joined], links)
    if len(joined) == len(sizes):
        return _Arrangement(sizes, drawing, ())
    centres = dict(zip(joined, drawing.centres, strict=True))
    wide, high = drawing.size
    most, top = max(wide, _LEGEND_WIDTH), high + (APART if joined else 0.0)
    captions: list[tuple[str, Point]] = []
    for reason in dict.fromkeys(box.alone for box in picture.boxes if box.alone):
        captions.append((f"Without lines: {reason}", (0.0, top + ROW / 2)))
        wide = max(wide, text_width(captions[-1][0], NOTE))
        x, top = 0.0, top + ROW
        for index, box in enumerate(picture.boxes):
            if box.alone == reason:
                width, height = sizes[index]
                if x and x + width > most:
                    x, top = 0.0, top + height + _NEAR
                centres[index] = x + width / 2, top + height / 2
                x += width + _NEAR
                wide, high = max(wide, x - _NEAR), top + height
        top = high + _NEAR
    return _Arrangement(
        sizes,
        Drawing((wide, high), tuple(centres[index] for index in range(len(sizes))), drawing.routes),
        captions,
    )
