"""A picture as SVG, laid out here: no other program is needed, and the same bytes everywhere."""

from collections import Counter
from collections.abc import Mapping
from math import inf
from types import MappingProxyType

from mars_asp.draw.colours import LINES, QUIET
from mars_asp.draw.layered import Drawing, Link, Size, TooLargeError
from mars_asp.draw.legend import ROW, draw_row, legend_items, legend_rows, legend_width
from mars_asp.draw.packing import draw_graph
from mars_asp.draw.picture import Picture
from mars_asp.draw.shapes import (
    FONT,
    NOTE,
    box_size,
    draw_box,
    draw_label,
    draw_line,
    draw_markers,
    draw_sentence,
    escaped,
    label_size,
    plain,
    text_width,
)

_MARGIN = 24.0
#: A legend makes a narrow picture wider, up to this.
_LEGEND_WIDTH = 560.0
_NOWHERE: Mapping[str, str] = MappingProxyType({})


def drawn_width(picture: Picture) -> float:
    """Return how wide a picture is drawn, in px; without end where it is too large to be drawn."""
    try:
        return _laid_out(picture)[1].size[0] + 2 * _MARGIN
    except TooLargeError:
        return inf


def svg_text(picture: Picture, targets: Mapping[str, str] = _NOWHERE) -> str:
    """Return a picture as SVG; its text is escaped, and nothing in it is active.

    Boxes lead to `targets` by their names, for a page that the picture is part of.

    Raises:
        TooLargeError: there would be too many lines beside too many boxes.
    """
    sizes, drawing = _laid_out(picture)
    legend = legend_items(picture)
    inside = max(drawing.size[0], min(legend_width(legend), _LEGEND_WIDTH))
    if picture.remark:
        inside = max(inside, text_width(picture.remark, NOTE))
    rows = list(legend_rows(legend, inside))
    width, below = inside + 2 * _MARGIN, drawing.size[1] + 2 * _MARGIN
    height = below + (len(rows) + bool(picture.remark)) * ROW + _MARGIN / 2
    corner = (width - drawing.size[0]) / 2
    # The parts of an image are not announced, so links could not be found there.
    role = "group" if targets else "img"
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{plain(width)}" height="{plain(height)}" '
        f'viewBox="0 0 {plain(width)} {plain(height)}" font-family="{FONT}" role="{role}">',
        f"<title>{escaped(picture.title)}</title>",
        "<defs>",
        *draw_markers(),
        "</defs>",
        '<rect width="100%" height="100%" fill="#ffffff"/>',
        f'<g class="picture" transform="translate({plain(corner)} {plain(_MARGIN)})">',
    ]
    routed = list(zip(picture.lines, drawing.routes, strict=True))
    # Mounts lie lowest, for they are the widest; labels lie above all lines.
    for kind in LINES:
        parts += [draw_line(line, route) for line, route in routed if line.kind == kind]
    parts += [draw_label(line, route.label) for line, route in routed if route.label is not None]
    for box, centre, size in zip(picture.boxes, drawing.centres, sizes, strict=True):
        target = targets.get(box.name)
        if target is not None:
            parts.append(f'<a href="{escaped(target)}" aria-label="{escaped(box.name)}">')
        parts += draw_box(box, centre, size)
        if target is not None:
            parts.append("</a>")
    parts += ["</g>", '<g class="legend">']
    for index, row in enumerate(rows):
        parts += draw_row(row, (_MARGIN, below + index * ROW))
    if picture.remark:
        at = _MARGIN, below + len(rows) * ROW + ROW / 2
        parts.append(draw_sentence(picture.remark, at, NOTE, QUIET))
    return "\n".join([*parts, "</g>", "</svg>"]) + "\n"


def _laid_out(picture: Picture) -> tuple[list[Size], Drawing]:
    """Return the sizes of boxes, and where these and the lines are drawn.

    Raises:
        TooLargeError: there would be too many lines beside too many boxes.
    """
    loops = Counter(line.tail for line in picture.lines if line.tail == line.head)
    leaving = Counter(line.tail for line in picture.lines)
    reaching = Counter(line.head for line in picture.lines)
    sizes = [
        box_size(box, max(leaving[index], reaching[index]), loops[index])
        for index, box in enumerate(picture.boxes)
    ]
    links = [Link(line.tail, line.head, label_size(line.label)) for line in picture.lines]
    return sizes, draw_graph(sizes, links)
