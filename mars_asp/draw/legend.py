"""The legend below a diagram: the meanings of its boxes and lines."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from mars_asp.draw.colours import INK, LINES, MEANINGS, QUIET, box_colours
from mars_asp.draw.layered import Point, Route
from mars_asp.draw.picture import EFFECTS, SIGNS, Box, Line, LineKind, NumberedFinding, Picture
from mars_asp.draw.shapes import (
    NOTE,
    draw_badge,
    draw_line,
    draw_outline,
    draw_sentence,
    draw_text,
    text_width,
)
from mars_asp.model.declarations import Sign

ROW = 26.0
_SAMPLE, _SPACE, _APART = 40.0, 12.0, 22.0
_LEADING = 16.0


@dataclass(frozen=True, slots=True)
class Item:
    """An entry of the legend: a sample and its meaning."""

    meaning: str
    sample: Box | Line

    @property
    def width(self) -> float:
        """The width in px, with the space after it."""
        return _SAMPLE + _SPACE + text_width(self.meaning, NOTE) + _APART


def legend_items(picture: Picture) -> list[Item]:
    """Return an entry for each appearance of boxes and kind of lines in a diagram."""
    items = []
    if any(box.node is None and not box.alone for box in picture.boxes):
        items.append(Item("module", Box("", "", None)))
    nodes = {
        box_colours(box): replace(box, findings=())
        for box in picture.boxes
        if box.node is not None and not box.alone
    }
    for box in sorted(nodes.values(), key=lambda box: box.node or "", reverse=True):
        # A node with a colour is of a pack, and its kind explains it best.
        kind = (box.node or "").replace("_", " ")
        items.append(Item(kind if box.colour else f"introduced for {box.carries}", box))
    present = {line.kind for line in picture.lines if line.sign is None}
    items += [_line_item(MEANINGS[kind], kind) for kind in LINES if kind in present]
    triggers = {(line.kind, line.sign) for line in picture.lines if line.sign is not None}
    return items + [
        _line_item(f"{EFFECTS[sign]} ({letter})", kind, sign)
        for kind in LINES
        for sign, letter in SIGNS.items()
        if (kind, sign) in triggers
    ]


def _line_item(meaning: str, kind: LineKind, sign: Sign | None = None) -> Item:
    return Item(meaning, Line(kind, 0, 0, "", meaning, sign=sign))


def legend_width(items: Sequence[Item]) -> float:
    """Return the width of entries side by side, in px."""
    return sum(item.width for item in items) - _APART


def legend_rows(items: Sequence[Item], width: float) -> Iterator[list[Item]]:
    """Yield entries in rows of at most `width`; a wider one has its own row."""
    row: list[Item] = []
    for item in items:
        if row and legend_width([*row, item]) > width:
            yield row
            row = []
        row.append(item)
    yield row


def draw_row(row: Sequence[Item], corner: Point) -> Iterator[str]:
    """Yield SVG of a row of entries, whose upper left corner is at a point."""
    x, y = corner[0], corner[1] + ROW / 2
    for item in row:
        if isinstance(item.sample, Box):
            yield draw_outline(item.sample, (x, y - 8), (_SAMPLE, 16.0))
        else:
            a, b = (x, y), (x + _SAMPLE, y)
            yield draw_line(item.sample, Route((a, a, b, b), None))
        yield draw_text(item.meaning, (x + _SAMPLE + _SPACE, y), NOTE, QUIET)
        x += item.width


def finding_width(finding: NumberedFinding) -> float:
    """Return the width of a finding in one line, with its number."""
    return _SAMPLE + _SPACE + text_width(f"{finding.severity}: {finding.text}", NOTE)


def finding_lines(
    findings: Sequence[NumberedFinding], width: float
) -> Sequence[tuple[tuple[NumberedFinding, ...], str]]:
    """Return findings wrapped to a width, each first line with its finding."""
    found: list[tuple[tuple[NumberedFinding, ...], str]] = []
    for finding in findings:
        numbered: tuple[NumberedFinding, ...] = (finding,)
        line = f"{finding.severity}:"
        for word in finding.text.split():
            if text_width(f"{line} {word}", NOTE) > width - _SAMPLE - _SPACE:
                found.append((numbered, line))
                numbered, line = (), word
            else:
                line = f"{line} {word}"
        found.append((numbered, line))
    return found


def draw_findings(
    lines: Sequence[tuple[tuple[NumberedFinding, ...], str]], corner: Point
) -> Iterator[str]:
    """Yield SVG of lines of findings, whose upper left corner is at a point."""
    x, y = corner
    for numbered, line in lines:
        y += _LEADING + (4 if numbered else 0)
        if numbered:
            yield draw_badge(numbered, (x, y))
        yield draw_sentence(line, (x + _SAMPLE + _SPACE, y), NOTE, INK)


def findings_height(lines: Sequence[tuple[tuple[NumberedFinding, ...], str]]) -> float:
    """Return the height of lines of findings, with the space after them."""
    return sum((_LEADING + (4 if numbered else 0) for numbered, _ in lines), 8.0 if lines else 0.0)
