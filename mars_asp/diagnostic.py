"""Findings and the stretches of files that they are about, as plain values."""

import re
from bisect import bisect_right
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal, NamedTuple, TypeAlias

Severity: TypeAlias = Literal["error", "warning", "note"]

#: The code of notes that list what was not read of a file.
NOT_READ = "not-read"
NOT_EXPORTED = "not-exported"
#: The codes of notes on skipped parts of a file.
SKIPPED = (NOT_READ, NOT_EXPORTED)
#: Longer than any name or path that a person reads, and how much of both ends tells it apart.
_LONG = re.compile(r"\S{301,}")
_KEPT = 100
#: The length of the text in the `repr` of an error.
_MOST_SHOWN = 150


class Span(NamedTuple):
    """A location: a range of characters in one file; spans sort by file, then by line and column.

    Lines and columns count from 1 in code points, without a byte order mark; the end column is
    the first one after the range. `path` is shown to users unchanged. Line and column are 0 for a
    whole file, a folder or an option of the command.

    >>> Span("robot.mars", 3, 1, 3, 9).location
    'robot.mars:3:1'
    """

    path: str
    line: int
    column: int
    end_line: int
    end_column: int

    def __str__(self) -> str:
        return self.location

    @property
    def location(self) -> str:
        """The location as `path:line:column`, or the path alone if it has no line."""
        return f"{self.path}:{self.line}:{self.column}" if self.line else self.path


def point(path: str, line: int, column: int) -> Span:
    """Return the empty span at a line and column."""
    return Span(path, line, column, line, column)


def beginning(span: Span) -> Span:
    """Return the empty span at the begin of a span."""
    return point(span.path, span.line, span.column)


def whole_file(path: str) -> Span:
    """Return the span of a whole file or folder, or of an option of the command."""
    return Span(path, 0, 0, 0, 0)


class FileText:
    r"""The text of a file, whose lines end with `\n`, and the locations in it."""

    def __init__(self, path: str, text: str) -> None:
        """Keep a text; its lines are indexed when a location is requested."""
        self.path, self.text = path, text

    @cached_property
    def _starts(self) -> list[int]:
        return [0, *(match.end() for match in re.finditer("\n", self.text))]

    def position(self, offset: int) -> tuple[int, int]:
        """Return the line and column, from 1, of an offset."""
        line = bisect_right(self._starts, offset)
        return line, offset - self._starts[line - 1] + 1

    def offset(self, line: int, column: int) -> int:
        """Return the offset of a line and column, from 1."""
        return self._starts[line - 1] + column - 1

    def span(self, begin: int, end: int) -> Span:
        """Return the span between two offsets."""
        return Span(self.path, *self.position(begin), *self.position(end))

    def line(self, number: int) -> str:
        """Return a line, counted from 1, without its end."""
        start = self._starts[number - 1]
        end = self.text.find("\n", start)
        return self.text[start : None if end < 0 else end]


@dataclass(frozen=True, slots=True)
class Diagnostic:
    """One message about a location: a finding, an error of the input, or a note.

    `code` is a rule id or a fixed id such as `syntax`; `message` is one lower-case clause with
    names in backticks and no full stop, stating a fact; `effect` is a sentence on the consequence
    in a run; `help` is the instruction to fix it; `labels` are related locations, each with a text,
    which may be empty; `excerpt` is the line of the file at `span`, empty if it adds nothing.
    `kind` is the kind of a finding, `launch_files` are the launch trees in which it holds.

    >>> try:
    ...     load("nope.mars")
    ... except MarsError as error:
    ...     print(error.diagnostics[0].code)
    unreadable
    """

    code: str
    severity: Severity
    message: str
    span: Span
    labels: tuple[tuple[Span, str], ...] = ()
    help: str | None = None
    excerpt: str | None = None
    effect: str | None = None
    kind: str | None = None
    launch_files: tuple[str, ...] = ()

    @property
    def named_location(self) -> str:
        """The location as text, "" if it has no line and the message names the path."""
        is_named = not self.span.line and f"`{self.span.path}`" in self.message
        return "" if is_named else self.span.location

    def __str__(self) -> str:
        """Return the location and the message, with the help in parentheses."""
        parts = filter(None, (self.named_location, self.message))
        return f"{': '.join(parts)}{f' ({self.help})' if self.help else ''}"


def brief(diagnostic: Diagnostic) -> Diagnostic:
    """Return a diagnostic in which very long words are shortened."""
    message, help_text, effect = (
        text and _LONG.sub(_cut, text)
        for text in (diagnostic.message, diagnostic.help, diagnostic.effect)
    )
    labels = tuple((span, _LONG.sub(_cut, text)) for span, text in diagnostic.labels)
    return replace(diagnostic, message=message or "", labels=labels, help=help_text, effect=effect)


def _cut(word: re.Match[str]) -> str:
    return f"{word[0][:_KEPT]}...{word[0][-_KEPT:]}"


def by_place(diagnostics: Iterable[Diagnostic]) -> tuple[Diagnostic, ...]:
    """Return diagnostics in the order of their locations."""
    return tuple(sorted(diagnostics, key=lambda d: (d.span, d.code, d.message)))


class MarsError(Exception):
    """Raised once per stage, with all errors of that stage, sorted by location.

    `status` is the exit status of the command: 2 for bad input, 1 for errors in its meaning.

    >>> try:
    ...     load("nope.mars")
    ... except MarsError as error:
    ...     print(error)
    nope.mars: no such file
    """

    status = 2

    def __init__(self, diagnostics: Iterable[Diagnostic]) -> None:
        """Sort and store the diagnostics."""
        self.diagnostics = by_place(diagnostics)
        super().__init__("\n".join(map(str, self.diagnostics)))

    def __repr__(self) -> str:
        """Return one line of at most 200 characters."""
        message = " ".join(str(self).split())
        shown = message if len(message) <= _MOST_SHOWN else f"{message[:_MOST_SHOWN]}..."
        return f"{type(self).__name__}({shown!r})"


def refusal(code: str, message: str, place: str, help_text: str | None = None) -> MarsError:
    """Return an error at `place`: an argument of the command, or a file as a whole."""
    return MarsError([Diagnostic(code, "error", message, whole_file(place), help=help_text)])
