r"""Edits of a text: replaced ranges and inserted lines, reported by lines of the original.

>>> draft = Draft("robot.mars", "@modules A, Sonr\n")
>>> draft.put(12, 16, "Sonar")
>>> draft.lines()[0].new
'@modules A, Sonar'
"""

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Literal, TypeAlias

from mars_asp.diagnostic import FileText, Span

Where: TypeAlias = Literal["before", "behind"]
#: A line and its end; the last one may have none.
_LINE = re.compile(r"(?=.)([^\r\n]*)(\r\n|\r|\n|\Z)", re.DOTALL)
#: A line with at most a comment.
_NO_STATEMENT = re.compile(r"\s*(?:(?://|#).*)?")


@dataclass(frozen=True, slots=True)
class LineEdit:
    """A line of a file that is replaced, deleted or inserted.

    `old` is the whole original line, or None for inserted lines: then `new` may contain several
    lines, and they are inserted on the side `where` of line `line`. `new` is `None` for a deleted
    line. Lines and columns are those of the original text.
    """

    path: str
    line: int
    column: int
    old: str | None
    new: str | None
    where: Where | None = None


class ConflictError(Exception):
    """Two edits replace overlapping ranges of a text."""


class Draft(FileText):
    """A text and its edits; offsets are those of the original text."""

    def __init__(self, path: str, text: str) -> None:
        """Begin without edits; `text` is the content of the file at `path`."""
        super().__init__(path, text)
        self._stretches: dict[tuple[int, int], str] = {}
        self._deleted: set[int] = set()
        self._inserted: dict[tuple[int, Where], list[str]] = {}
        self._insertions: set[tuple[int, Where, tuple[str, ...]]] = set()

    @property
    def last(self) -> int:
        """Return the number of the last line of the original text, from 1."""
        return self.text.removesuffix("\n").count("\n") + 1

    def line_at(self, offset: int) -> int:
        """Return the number of the line that contains an offset."""
        return self.position(offset)[0]

    def blanks(self, line: int) -> str:
        """Return the indentation of a line."""
        text = self.line(line)
        return text[: len(text) - len(text.lstrip())]

    def begin(self, span: Span) -> int:
        """Return the offset at which a span begins."""
        return self.offset(span.line, span.column)

    def put(self, begin: int, end: int, text: str) -> None:
        """Replace a range by a text; a second replacement of the same range replaces the first."""
        self._stretches[begin, end] = text

    def delete(self, line: int) -> None:
        """Mark the line with this number, from 1, as deleted."""
        self._deleted.add(line)

    def insert(self, line: int, where: Where, lines: Iterable[str]) -> None:
        """Insert lines before or after a line, following lines inserted there earlier.

        Equal lines are inserted once, because each inclusion of a file repeats its edits.
        """
        added = tuple(lines)
        if (line, where, added) not in self._insertions:
            self._insertions.add((line, where, added))
            self._inserted.setdefault((line, where), []).extend(added)

    def lines(self) -> tuple[LineEdit, ...]:
        """Return the edits line by line, at most one for each line and each side of a line.

        A line with nothing left but a comment is deleted.

        Raises:
            ConflictError: two ranges overlap.
        """
        edits: dict[int, LineEdit] = {}
        after: dict[int, list[str]] = {}
        for number, pieces in self._pieces().items():
            old = self.line(number)
            new, last = "", 0
            for begin, end, text in pieces:
                if begin < last:
                    raise ConflictError
                new, last = new + old[last:begin] + text, end
            new += old[last:]
            first, *others = new.split("\n")
            after[number] = others
            gone = _NO_STATEMENT.fullmatch(first) and not _NO_STATEMENT.fullmatch(old)
            if first != old:
                kept = None if gone else first.rstrip()
                edits[number] = LineEdit(self.path, number, pieces[0][0] + 1, old, kept)
        for number in self._deleted:
            edits[number] = LineEdit(self.path, number, 1, self.line(number), None)
        for number, others in after.items():
            if others:
                self._inserted.setdefault((number, "behind"), [])[:0] = others
        sides = "before", None, "behind"
        edited = self._with_inserted(edits)
        return tuple(sorted(edited, key=lambda edit: (edit.line, sides.index(edit.where))))

    def _pieces(self) -> dict[int, list[tuple[int, int, str]]]:
        """Return for each line its replacements (begin, end, text), with columns from 0."""
        pieces: dict[int, list[tuple[int, int, str]]] = {}
        for (begin, end), text in sorted(self._stretches.items()):
            first = self.line_at(begin)
            for number in range(first, self.line_at(end) + 1):
                start = self.offset(number, 1)
                piece = max(begin - start, 0), end - start, text if number == first else ""
                pieces.setdefault(number, []).append(piece)
        return pieces

    def _with_inserted(self, edits: dict[int, LineEdit]) -> list[LineEdit]:
        """Return edits in order with insertions; one at a deleted line replaces this line."""
        whole = []
        for (number, where), lines in self._inserted.items():
            edit = edits.get(number)
            added = lines
            side: Where = where
            if edit is not None and edit.new is None:
                edits[number] = replace(edit, new=lines[0])
                added, side = lines[1:], "behind"
            if added:
                whole.append(LineEdit(self.path, number, 1, None, "\n".join(added), side))
        return [*edits.values(), *whole]


def apply_lines(text: str, edits: Iterable[LineEdit]) -> str:
    """Return the edited text, with its byte order mark and its line ends.

    Raises:
        ConflictError: an edit does not match the line that it replaces.
    """
    mark = "\ufeff" if text.startswith("\ufeff") else ""
    lines = [(line[1], line[2]) for line in _LINE.finditer(text[len(mark) :])]
    usual = next((end for _, end in lines if end), "\n")
    inserted: dict[tuple[int, Where], str] = {}
    replaced: dict[int, str | None] = {}
    for edit in edits:
        if edit.old is None and edit.new is not None:
            inserted[edit.line, edit.where or "behind"] = edit.new
        elif edit.line > len(lines) or lines[edit.line - 1][0] != edit.old:
            raise ConflictError
        else:
            replaced[edit.line] = edit.new
    # Before a line inserted at the end, the last line needs a line end.
    if lines and not lines[-1][1] and (len(lines), "behind") in inserted:
        lines[-1] = (lines[-1][0], usual)
    written = [mark]
    for number, (line, end) in enumerate(lines or [("", "")], 1):
        new = replaced.get(number, line)
        above, below = inserted.get((number, "before")), inserted.get((number, "behind"))
        written += [f"{each}{usual}" for each in above.split("\n")] if above is not None else []
        written += [f"{new}{end}"] if new is not None else []
        written += [f"{each}{usual}" for each in below.split("\n")] if below is not None else []
    return "".join(written)


def edited_bytes(raw: bytes, edits: Iterable[LineEdit]) -> bytes:
    """Return the edited bytes of a file, with its encoding.

    Raises:
        ConflictError: an edit does not match the line that it replaces.
    """
    codec = _codec(raw)
    return apply_lines(raw.decode(codec), edits).encode(codec)


def _codec(raw: bytes) -> str:
    """Return the encoding of a file, in which a byte order mark is a character."""
    if raw.startswith(b"\xff\xfe"):
        return "utf-16-le"
    if raw.startswith(b"\xfe\xff"):
        return "utf-16-be"
    try:
        raw.decode()
    except UnicodeDecodeError:
        return "latin-1"
    return "utf-8"


def common_length(one: Sequence[str], other: Sequence[str]) -> int:
    """Return the length of the common prefix of two texts, or of two lists of lines."""
    pairs = zip(one, other, strict=False)
    return next((at for at, (a, b) in enumerate(pairs) if a != b), min(len(one), len(other)))
