"""Positions in texts as editors count them: from 0, with columns in UTF-16 units.

In contrast, a `Span` counts code points from 1, without the byte order mark.
"""

from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import NamedTuple

from mars_asp.diagnostic import FileText, Span
from mars_asp.language.parse import plain_lines
from mars_asp.language.text_edits import common_length

_MARK = "\ufeff"
#: A larger text is analysed, but answers about its locations would be too slow.
MOST_CHARACTERS = 1_000_000


class Position(NamedTuple):
    """A position between two characters of a text: line and UTF-16 column, from 0."""

    line: int
    character: int


class Range(NamedTuple):
    """A range of a text; `end` is the position after its last character."""

    start: Position
    end: Position

    def holds(self, position: Position) -> bool:
        """Whether a position is in the range, both ends included."""
        return self.start <= position <= self.end

    def meets(self, other: "Range") -> bool:
        """Whether the two ranges share a position, ends included."""
        return self.start <= other.end and other.start <= self.end


#: The location of findings without a line.
START = Range(Position(0, 0), Position(0, 0))


class Place(NamedTuple):
    """A range in a file."""

    path: str
    range: Range


class TextEdit(NamedTuple):
    """A range in a file and the text that replaces it."""

    place: Place
    text: str


class ChangedLines(NamedTuple):
    """The changed lines of an older text: from `first` to before `end`; later ones `moved_by`."""

    first: int
    end: int
    moved_by: int

    def moved(self, found: Range) -> Range | None:
        """Return a range of the older text as one in the newer text, None if its lines changed."""
        if found.end.line < self.first:
            return found
        if found.start.line < self.end:
            return None
        start, end = (Position(line + self.moved_by, column) for line, column in found)
        return Range(start, end)


@lru_cache(maxsize=4)
def changed_lines(before: str, now: str) -> ChangedLines:
    """Return the smallest block of lines whose replacement turns `before` into `now`."""
    old, new = plain_lines(before).split("\n"), plain_lines(now).split("\n")
    first = common_length(old, new)
    kept = common_length(old[first:][::-1], new[first:][::-1])
    return ChangedLines(first, len(old) - kept, len(new) - len(old))


@dataclass(frozen=True)
class Text:
    """The text of a file as an editor holds it."""

    path: str
    written: str

    @cached_property
    def plain(self) -> str:
        r"""Return the text as it is parsed: without byte order mark, every line end as `\n`."""
        return plain_lines(self.written)

    @cached_property
    def lines(self) -> list[str]:
        """Return the lines of the plain text, without their ends."""
        return self.plain.split("\n")

    def line_before(self, position: Position) -> str:
        """Return the text before a position in its line."""
        line, column = self.column(position)
        return self.lines[line - 1][: column - 1]

    def column(self, position: Position) -> tuple[int, int]:
        """Return line and column (from 1, code points) of a position, clamped to the text."""
        number = min(max(position.line, 0), len(self.lines) - 1)
        line = self.lines[number]
        units = max(position.character - self._marks(number + 1), 0)
        if position.line > number:
            units = 2 * len(line)
        if line.isascii():
            return number + 1, min(units, len(line)) + 1
        before = line.encode("utf-16-le", "surrogatepass")[: 2 * units]
        # Half of a surrogate pair cannot be decoded.
        return number + 1, len(before.decode("utf-16-le", "ignore")) + 1

    def position(self, line: int, column: int) -> Position:
        """Return the position of a line and column (from 1, code points), clamped to the text."""
        line, column = max(1, line), max(1, column)
        if line > len(self.lines):
            line, column = len(self.lines), len(self.lines[-1]) + 1
        text = self.lines[line - 1][: column - 1]
        units = len(text) if text.isascii() else len(text.encode("utf-16-le", "surrogatepass")) // 2
        return Position(line - 1, units + self._marks(line))

    def clamp(self, position: Position) -> Position:
        """Return a position, or the end of its line or of the text if it is after that."""
        return self.position(*self.column(position))

    @property
    def last_position(self) -> Position:
        """Return the position after the last character."""
        return self.position(len(self.lines), len(self.lines[-1]) + 1)

    def range(self, span: Span) -> Range:
        """Return the range of a location, from its first to after its last character."""
        start = self.position(span.line, span.column)
        if span.line == span.end_line and span.column == span.end_column:
            return Range(start, start)
        return Range(start, self.position(span.end_line, span.end_column))

    def place(self, span: Span) -> Place:
        """Return the file and range of a span of this text."""
        return Place(self.path, self.range(span))

    def within(self, line: int, begin: int, end: int) -> Range:
        """Return the range in a line from `begin` to `end`, offsets from 0 in code points."""
        if not self._is_ascii:
            return Range(self.position(line, begin + 1), self.position(line, end + 1))
        # Fast path: most texts are ASCII and have thousands of names.
        return Range(Position(line - 1, begin), Position(line - 1, end))

    def between(self, begin: int, end: int) -> Range:
        """Return the range of two offsets in the plain text."""
        start, stop = map(self._plain_text.position, (begin, end))
        return Range(self.position(*start), self.position(*stop))

    @cached_property
    def _plain_text(self) -> FileText:
        return FileText(self.path, self.plain)

    @cached_property
    def _is_ascii(self) -> bool:
        return self.written.isascii()

    def _marks(self, line: int) -> int:
        return int(line == 1 and self.written.startswith(_MARK))
