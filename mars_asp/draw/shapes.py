"""The shapes of SVG pictures: text, boxes and lines. Text is escaped, and nothing is active."""

import html
import unicodedata
from collections.abc import Iterator, Sequence, Set
from math import hypot

from mars_asp.draw.colours import FINDINGS, INK, LINES, QUIET, box_colours
from mars_asp.draw.layered import LOOP, PORT, Point, Route, Size
from mars_asp.draw.picture import Box, Line, LineKind, NumberedFinding, gravest

FONT = "'DejaVu Sans', Verdana, 'Liberation Sans', 'Noto Sans', Arial, Helvetica, sans-serif"
NAME, NOTE, LABEL = 13.0, 10.5, 10.5
#: From one line of a label to the next.
_LEADING = 13.0
#: Longer text would make boxes and gaps too wide to see anything else; titles show it whole.
_MOST_CHARACTERS = 48
#: A box is not made wider for more lines than these.
_MOST_SPREAD = 40
#: Of the letter at the end of a reset.
_RADIUS = 7.5
#: A box shows no more numbers of findings; its attribute has all.
_MOST_NUMBERS = 5
#: Characters beside control characters that XML does not allow.
_NOT_XML = str.maketrans(dict.fromkeys("\ufffe\uffff", "\ufffd"))
_NARROW, _WIDE = frozenset("ijlIft.,:;'|!()[] "), frozenset("mwMW@%")
_DOTTED = 'stroke-dasharray="2 3"'
_STROKES: dict[LineKind, str] = {
    "mount": 'stroke-width="3.2" stroke-linecap="round"',
    "data": 'stroke-width="1.6" marker-end="url(#data)"',
    "control": 'stroke-width="1.6" stroke-dasharray="7 4" marker-end="url(#control)"',
    "reset": f'stroke-width="1.6" {_DOTTED}',
    "lock": f'stroke-width="1.6" {_DOTTED} marker-end="url(#lock)"',
    "limit": f'stroke-width="1.6" {_DOTTED} marker-end="url(#limit)"',
}


def text_width(text: str, size: float) -> float:
    """Return the approximate width of a text in px, in a wide sans-serif font."""
    return size * sum(map(_character_width, text))


def _character_width(character: str) -> float:
    if character in _NARROW:
        return 0.4
    if character in _WIDE:
        return 0.95
    if unicodedata.east_asian_width(character) in "WF":
        return 1.05
    return 0.72 if character.isupper() else 0.64


def escaped(text: str) -> str:
    """Return a text escaped for XML."""
    return html.escape(text.translate(_NOT_XML))


def plain(number: float) -> str:
    """Return a number rounded to tenths, in its shortest form."""
    return f"{round(number * 10) / 10 + 0.0:.1f}".removesuffix(".0")


def box_size(box: Box, lines: int, loops: int) -> Size:
    """Return the size of a box that fits its text, `lines` at one side, and `loops` to itself."""
    badge = badge_width(box.findings)
    if box.alone:
        return text_width(_short(box.name), NOTE) + 16 + badge, 22.0
    wide = max(text_width(_short(box.name), NAME), text_width(_short(box.note), NOTE)) + badge
    if box.node == "gate_node":
        width = max(44.0, wide + 14)
        return width, width
    spread = (min(lines, _MOST_SPREAD) + 1) * PORT
    return max(64.0, wide + 26, spread), max(46.0 if box.note else 34.0, loops * LOOP)


def label_size(line: Line) -> Size | None:
    """Return the size of a line's label with its findings, None if it has neither."""
    if not line.label and not line.findings:
        return None
    lines = line.label.split("\n")
    wide = max(text_width(_short(each), LABEL) for each in lines)
    return wide + 10 + badge_width(line.findings), len(lines) * _LEADING + 3.5


def badge_width(findings: Sequence[NumberedFinding]) -> float:
    """Return the width of a badge with the numbers of findings, and its margin."""
    return text_width(_numbers(findings), LABEL) + 14 if findings else 0.0


def draw_markers(kinds: Set[LineKind]) -> Iterator[str]:
    """Yield SVG definitions of the arrow heads of data, control and other kinds of lines."""
    for kind in ("data", "control", *sorted(kinds - {"data", "control", "mount", "reset"})):
        yield (
            f'<marker id="{kind}" viewBox="0 0 10 10" refX="9.5" refY="5" markerWidth="9" '
            f'markerHeight="9" markerUnits="userSpaceOnUse" orient="auto">'
            f'<path d="M0 0.8L10 5L0 9.2z" fill="{LINES[kind]}"/></marker>'
        )


def draw_box(box: Box, centre: Point, size: Size) -> Iterator[str]:
    """Yield SVG of a box with its name and note."""
    x, y = centre
    whole = f"{box.name}: {box.note}" if box.note else box.name
    if box.alone:
        whole += f", without lines: {box.alone}"
    yield f"<g {_classes(box.node or 'module', box.findings)}><title>{escaped(whole)}</title>"
    yield draw_outline(box, (x - size[0] / 2, y - size[1] / 2), size)
    x += badge_width(box.findings) / 2
    if box.alone:
        yield draw_text(box.name, (x, y), NOTE, QUIET, "middle")
    elif box.node == "gate_node":
        yield draw_text(box.note, (x, y - 6), NAME, INK, "middle")
        yield draw_text(box.name, (x, y + 9), NOTE, QUIET, "middle")
    else:
        yield draw_text(box.name, (x, y - 7.5 if box.note else y), NAME, INK, "middle")
        if box.note:
            yield draw_text(box.note, (x, y + 8.7), NOTE, QUIET, "middle")
    if box.findings:
        yield draw_badge(box.findings, (centre[0] - size[0] / 2 + 7, y))
    yield "</g>"


def _classes(kind: str, findings: Sequence[NumberedFinding]) -> str:
    """Return the SVG attributes of a box or line of a kind, with its findings."""
    if not findings:
        return f'class="{kind}"'
    numbers = " ".join(str(each.number) for each in findings)
    return f'class="{kind} finding {gravest(findings)}" data-finding="{numbers}"'


def _numbers(findings: Sequence[NumberedFinding]) -> str:
    """Return the numbers of findings as text, shortened if too long."""
    shown = [str(each.number) for each in findings[:_MOST_NUMBERS]]
    return ", ".join([*shown, *(["…"] if len(findings) > _MOST_NUMBERS else [])])


def draw_badge(findings: Sequence[NumberedFinding], left: Point) -> str:
    """Return SVG of a badge with the numbers of findings: dark for errors, else light."""
    severity = gravest(findings)
    colour, _ = FINDINGS[severity]
    radius, fill, ink = (2, colour, "#ffffff") if severity == "error" else (8, "#ffffff", colour)
    width = badge_width(findings) - 6
    style = f'rx="{radius}" fill="{fill}" stroke="{colour}" stroke-width="1.5"'
    return _rectangle((left[0], left[1] - 8), (width, 16.0), style) + draw_text(
        _numbers(findings), (left[0] + width / 2, left[1]), LABEL, ink, "middle"
    )


def draw_outline(box: Box, corner: Point, size: Size) -> str:
    """Return SVG of an empty box: square corners for a module, round ends for a node."""
    fill, stroke = box_colours(box)
    radius = 3.0 if box.node is None else size[1] / 2
    if box.findings:
        stroke = f'{FINDINGS[gravest(box.findings)][0]}" stroke-width="3'
    return _rectangle(corner, size, f'rx="{plain(radius)}" fill="{fill}" stroke="{stroke}"')


def draw_line(line: Line, route: Route) -> str:
    """Return SVG of a line with its label; a mount ends in a disc, others in an arrow head."""
    (x, y), *rest = route.points
    curves = "".join(
        f"C{_pair(a)} {_pair(b)} {_pair(c)}"
        for a, b, c in zip(rest[::3], rest[1::3], rest[2::3], strict=True)
    )
    colour = LINES[line.kind]
    way = f'<path d="M{_pair((x, y))}{curves}" fill="none" stroke='
    strokes = _STROKES[line.kind]
    if line.sign is not None:
        strokes = f'stroke-width="1.6" {_DOTTED} marker-end="url(#{line.kind})"'
    path = f'{way}"{colour}" {strokes}/>'
    if line.findings:
        halo = FINDINGS[gravest(line.findings)][1]
        path = f'{way}"{halo}" stroke-width="9" stroke-linecap="round"/>{path}'
    if line.kind == "mount":
        x, y = route.points[-1]
        path += f'<circle cx="{plain(x)}" cy="{plain(y)}" r="5" fill="{colour}"/>'
    if line.kind == "reset":
        at = _before_end(route.points)
        circle = f'<circle cx="{plain(at[0])}" cy="{plain(at[1])}" r="{plain(_RADIUS)}"'
        path += f'{circle} fill="#ffffff" stroke="{colour}"/>'
        path += draw_text("R", at, LABEL, colour, "middle")
    label = "" if route.label is None else _label(line, route.label)
    classes = _classes(line.kind, line.findings)
    return f"<g {classes}><title>{escaped(line.text)}</title>{path}{label}</g>"


def _before_end(points: Sequence[Point]) -> Point:
    """Return the centre of a letter that touches the end of a line."""
    x, y = points[-1]
    u, v = next((point for point in reversed(points) if point != (x, y)), (x, y + 1))
    share = _RADIUS / (hypot(u - x, v - y) or 1.0)
    return x + (u - x) * share, y + (v - y) * share


def _label(line: Line, at: Point) -> str:
    """Return SVG of a line's label, which hides the line below it."""
    width, height = label_size(line) or (0.0, 0.0)
    left, badge = at[0] - width / 2, badge_width(line.findings)
    label = _rectangle((left, at[1] - height / 2), (width, height), 'fill="#ffffff"')
    lines = line.label.split("\n") if line.label else []
    for index, text in enumerate(lines):
        middle = at[0] + badge / 2, at[1] + (index - (len(lines) - 1) / 2) * _LEADING
        label += draw_text(text, middle, LABEL, LINES[line.kind], "middle")
    return label + (draw_badge(line.findings, (left + 3, at[1])) if badge else "")


def draw_text(text: str, at: Point, size: float, colour: str, anchor: str = "start") -> str:
    """Return SVG of a text, vertically centred at a point; `anchor` is as in SVG."""
    return draw_sentence(_short(text), at, size, colour, anchor)


def draw_sentence(text: str, at: Point, size: float, colour: str, anchor: str = "start") -> str:
    """Return SVG of a text, never shortened."""
    return (
        f'<text x="{plain(at[0])}" y="{plain(at[1] + size * 0.36)}" font-size="{plain(size)}" '
        f'text-anchor="{anchor}" fill="{colour}">{escaped(text)}</text>'
    )


def _short(text: str) -> str:
    return text if len(text) <= _MOST_CHARACTERS else f"{text[: _MOST_CHARACTERS - 1]}…"


def _rectangle(corner: Point, size: Size, style: str) -> str:
    return (
        f'<rect x="{plain(corner[0])}" y="{plain(corner[1])}" width="{plain(size[0])}" '
        f'height="{plain(size[1])}" {style}/>'
    )


def _pair(point: Point) -> str:
    return f"{plain(point[0])} {plain(point[1])}"
