"""A picture as SVG, laid out here: no other program is needed, and the same bytes everywhere."""

from collections import Counter
from collections.abc import Mapping
from types import MappingProxyType

from mars_asp.draw.colours import LINES
from mars_asp.draw.layered import Link
from mars_asp.draw.legend import ROW, draw_row, legend_items, legend_rows, legend_width
from mars_asp.draw.packing import draw_graph
from mars_asp.draw.picture import Picture
from mars_asp.draw.shapes import (
    FONT,
    box_size,
    draw_box,
    draw_label,
    draw_line,
    draw_markers,
    escaped,
    label_size,
    plain,
)

_MARGIN = 24.0
#: A legend makes a narrow picture wider, up to this.
_LEGEND_WIDTH = 560.0
_NOWHERE: Mapping[str, str] = MappingProxyType({})


def svg_text(picture: Picture, targets: Mapping[str, str] = _NOWHERE) -> str:
    """Return a picture as SVG; its text is escaped, and nothing in it is active.

    Boxes lead to `targets` by their names, for a page that the picture is part of.

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
    drawing = draw_graph(sizes, links)
    legend = legend_items(picture)
    inside = max(drawing.size[0], min(legend_width(legend), _LEGEND_WIDTH))
    rows = list(legend_rows(legend, inside))
    width, below = inside + 2 * _MARGIN, drawing.size[1] + 2 * _MARGIN
    height = below + len(rows) * ROW + _MARGIN / 2
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
    return "\n".join([*parts, "</g>", "</svg>"]) + "\n"
