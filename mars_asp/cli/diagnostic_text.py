"""Diagnostics as text and as JSON, and their output on standard error."""

import argparse
import os
import sys
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import TYPE_CHECKING, NamedTuple

from mars_asp.cli.encode import encoded
from mars_asp.cli.lines import line_json, line_text, whole_line
from mars_asp.cli.wrapping import cells, columns, wrapped
from mars_asp.diagnostic import SKIPPED, Diagnostic, MarsError, Span, brief, whole_file
from mars_asp.output import counted, visible

if TYPE_CHECKING:
    from mars_asp.language.text_edits import LineEdit
    from mars_asp.reasoning.analysis import Analysis

_CODES = {"error": "31", "warning": "33", "note": "36", "dim": "2", "strong": "1"}
#: The indents of continuation lines, and of the lines that belong to a message.
_FURTHER, _INSIDE = "  ", "    "
#: The text shows at most so many further locations; JSON has all.
_MOST_PLACES = 10
#: Notes on skipped parts of a file show fewer locations.
_MOST_UNREAD = 2
#: A longer line is quoted only near the location, from so many characters before it.
_LONGEST, _BEFORE = 400, 40
_TAB = 4


class Suggestion(NamedTuple):
    """The only repair of a finding: its message, edited lines, and new warnings."""

    message: str
    edits: "tuple[LineEdit, ...]"
    warnings: tuple[str, ...] = ()


_NO_SUGGESTIONS: Mapping[Diagnostic, Suggestion] = MappingProxyType({})


def paint(text: str, style: str, coloured: bool) -> str:
    """Return a text with terminal colours of a style, or unchanged unless `coloured`."""
    return f"\x1b[{_CODES[style]}m{text}\x1b[0m" if coloured else text


def colours(arguments: argparse.Namespace, stream: object) -> bool:
    """Whether a stream is coloured: by `--color`, else by the environment, else on a terminal.

    `NO_COLOR` and `FORCE_COLOR` count where they are not empty (no-color.org, force-color.org).
    """
    if arguments.color != "auto":
        return bool(arguments.color == "always")
    if os.environ.get("NO_COLOR"):
        return False
    if os.environ.get("FORCE_COLOR"):
        return True
    isatty = getattr(stream, "isatty", None)
    return os.environ.get("TERM") != "dumb" and bool(isatty and isatty())


def report_error(error: MarsError, arguments: argparse.Namespace) -> None:
    """Print all errors that a stage raised."""
    report(error.diagnostics, arguments)


def report_unrealisable(path: str, analysis: "Analysis", arguments: argparse.Namespace) -> None:
    """Print that no specification realises the configuration at `path`, and its errors."""
    from mars_asp.reasoning.questions.unrealised import unrealised

    message = unrealised(analysis)
    if arguments.format == "json":
        help_text = "`mars-asp check` shows how to resolve it"
        place = whole_file(path)
        report([Diagnostic("unrealisable", "error", message, place, help=help_text)], arguments)
    else:
        for text in wrapped(visible(f"mars-asp: {message}"), columns(sys.stderr), further=_FURTHER):
            print(text, file=sys.stderr)


def report(
    diagnostics: Iterable[Diagnostic],
    arguments: argparse.Namespace,
    suggestions: Mapping[Diagnostic, Suggestion] = _NO_SUGGESTIONS,
) -> None:
    """Print diagnostics in the order of the argument, with repairs; `--quiet` omits notes.

    In the format JSON each diagnostic is a JSON object on a line.
    """
    for whole in diagnostics:
        diagnostic = brief(whole)
        for_programs = arguments.format in ("json", "jsonl")
        # Programs must learn of skipped parts of a file even with `--quiet`.
        result = for_programs and diagnostic.code in SKIPPED
        if arguments.quiet and diagnostic.severity == "note" and not result:
            continue
        if for_programs:
            found = diagnostic_json(diagnostic, suggestions.get(whole))
            print(encoded(found), file=sys.stderr)
        else:
            width = columns(sys.stderr)
            print(
                diagnostic_text(diagnostic, colours(arguments, sys.stderr), width), file=sys.stderr
            )
            for line in suggestion_lines(suggestions.get(whole), width):
                print(line, file=sys.stderr)


def suggestion_lines(suggestion: Suggestion | None, width: int) -> Iterator[str]:
    """Yield the lines that show the repair of a finding, none for None."""
    if suggestion is not None:
        yield from wrapped(visible(suggestion.message), width, f"{_INSIDE}fix: ", f"{_INSIDE}     ")
        for edit in suggestion.edits:
            yield from line_text(edit)
        for warning in suggestion.warnings:
            yield from wrapped(
                visible(warning), width, f"{_INSIDE}   then warns: ", f"{_INSIDE}     "
            )


def diagnostic_json(
    diagnostic: Diagnostic, suggestion: Suggestion | None = None
) -> dict[str, object]:
    """Return a diagnostic with the keys of the command line's contract."""
    span = diagnostic.span
    return {
        "code": diagnostic.code,
        "kind": diagnostic.kind,
        "severity": diagnostic.severity,
        "message": diagnostic.message,
        "path": span.path,
        "line": span.line or None,
        "column": span.column or None,
        "help": diagnostic.help,
        "end_line": span.end_line or None,
        "end_column": span.end_column or None,
        "effect": diagnostic.effect,
        "launch_files": list(diagnostic.launch_files),
        "labels": [
            {
                "path": at.path,
                "line": at.line or None,
                "column": at.column or None,
                "message": text,
            }
            for at, text in diagnostic.labels
        ],
        "fix": None
        if suggestion is None
        else {
            "message": suggestion.message,
            "lines": [line_json(edit) for edit in suggestion.edits],
            "warnings": list(suggestion.warnings),
        },
    }


def concise_text(diagnostic: Diagnostic, coloured: bool = False) -> str:
    """Return `path:line:column: severity: message [name]`; the name is the kind, else the code.

    Without a line it is `mars-asp: severity: path: message`, and the path is not repeated.
    An error of the input has its help in parentheses: it may be all that a log shows.
    """
    if diagnostic.kind is None and diagnostic.severity == "error" and diagnostic.help:
        message = f"{diagnostic.message} ({diagnostic.help})"
        diagnostic = replace(diagnostic, message=message)
    return f"{_place_and_severity(diagnostic, coloured)} {_named_message(diagnostic, coloured)}"


def diagnostic_text(
    diagnostic: Diagnostic, coloured: bool = False, width: int = 80, *, whole_head: bool = False
) -> str:
    """Return the concise text of a diagnostic, and the lines with its details.

    The details are the quoted line with a caret at the location, further locations with labels,
    the effect and the help. `width` bounds lines, except quoted ones, long words and whole heads.
    """
    message = _named_message(diagnostic, coloured)
    return "\n".join(finding_lines(diagnostic, message, coloured, width, whole_head=whole_head))


def _named_message(diagnostic: Diagnostic, coloured: bool) -> str:
    message = diagnostic.message
    if not diagnostic.span.line:
        message = ": ".join(filter(None, (diagnostic.named_location, message)))
        if diagnostic.severity == "error":
            return visible(message)
    name = paint(f"[{visible(diagnostic.kind or diagnostic.code)}]", "dim", coloured)
    return f"{visible(message)} {name}"


def _place_and_severity(diagnostic: Diagnostic, coloured: bool) -> str:
    place = visible(diagnostic.span.location) if diagnostic.span.line else "mars-asp"
    return f"{place}: {paint(diagnostic.severity, diagnostic.severity, coloured)}:"


def finding_lines(
    diagnostic: Diagnostic,
    message: str,
    coloured: bool = False,
    width: int = 80,
    *,
    whole_head: bool = False,
) -> Iterator[str]:
    """Yield the lines of a diagnostic with `message` in place of its own message.

    With `whole_head` the head is one line, however long it is.
    """
    head = _place_and_severity(diagnostic, coloured)
    if whole_head:
        yield f"{head} {message}"
    else:
        lines = wrapped(message, width, f"{head} ", _FURTHER)
        # Programs look for the head as one, so there is no break within it.
        if cells(lines[0]) > width:
            lines = [head, *wrapped(message, width, _FURTHER, _FURTHER)]
        yield from lines
    yield from _quotation(diagnostic, coloured, width)
    if diagnostic.effect:
        yield from wrapped(visible(diagnostic.effect), width, _INSIDE, _INSIDE)
    if diagnostic.help:
        first, further = f"{_INSIDE}help: ", f"{_INSIDE}      "
        yield from wrapped(visible(diagnostic.help), width, first, further)


# ---- Quoted lines --------------------------------------------------------------------------------


class _QuotedLine(NamedTuple):
    """A line to show; `before` is the width before the marked range, `marked` that of the range."""

    text: str
    before: int
    marked: int


def _quotation(diagnostic: Diagnostic, coloured: bool, width: int) -> Iterator[str]:
    """Yield the quoted lines of a diagnostic, each with marks under its location."""
    most = _MOST_UNREAD if diagnostic.code in SKIPPED else _MOST_PLACES
    places = [(diagnostic.span, ""), *diagnostic.labels[:most]]
    shown = [_quote_line(diagnostic.span, diagnostic.excerpt)]
    shown += [_quote_line(span) for span, _ in places[1:]]
    numbers = [span.line for (span, _), line in zip(places, shown, strict=True) if line]
    margin = len(str(max(numbers, default=0)))
    last = (diagnostic.span.path, 0)
    marked: Span | None = None  # the location with the last marks
    for (span, label), line in zip(places, shown, strict=True):
        is_first = span is diagnostic.span
        if line is None:
            if not is_first:
                at = visible(span.location)
                yield from wrapped(f"{at}: {visible(label)}".rstrip(": "), width, _INSIDE, _INSIDE)
            continue
        if span.path != last[0]:
            yield paint(f"{_INSIDE}{visible(span.location)}:", "dim", coloured)
        if (span.path, span.line) != last:
            gutter = paint(f"{_INSIDE}{span.line:>{margin}} |", "dim", coloured)
            yield f"{gutter} {line.text}".rstrip()
        last = (span.path, span.line)
        line, marked = line._replace(marked=0) if span == marked else line, span  # noqa: PLW2901
        yield from _mark(
            line, visible(label), margin, diagnostic.severity, is_first, coloured, width
        )
    more = len(diagnostic.labels) - most
    if more > 0:
        yield f"{_INSIDE}and {counted(more, 'more place')}"


def _mark(
    line: _QuotedLine,
    label: str,
    margin: int,
    severity: str,
    is_first: bool,
    coloured: bool,
    width: int,
) -> Iterator[str]:
    """Yield the marks under a quoted line (`^` if `is_first`, else `-`), with the label."""
    style = severity if is_first else "note"
    gutter = paint(f"{_INSIDE}{' ' * margin} |", "dim", coloured)
    marks = paint(("^" if is_first else "-") * line.marked, style, coloured)
    row = f"{gutter} {' ' * line.before}{marks}"
    rows = [row] if line.marked else []
    if not label:
        yield from rows
    elif cells(row) + 1 + cells(label) <= width:
        yield f"{row} {paint(label, style, coloured)}"
    else:
        yield from rows
        for text in wrapped(label, width - len(_INSIDE) - margin - 3):
            yield f"{gutter} {paint(text, style, coloured)}"


def _quote_line(span: Span, excerpt: str | None = None) -> _QuotedLine | None:
    """Return the line at a location as shown, or None if it is empty or cannot be read."""
    line = (whole_line(span) if excerpt is None else excerpt).rstrip("\r\n")
    if not line.strip():
        return None
    begin = min(span.column - 1, len(line))
    end = span.end_column - 1 if span.end_line == span.line else len(line.rstrip())
    end = min(max(end, begin + 1), max(len(line), begin + 1))
    before, after = "", ""
    if len(line) > _LONGEST:
        start = max(0, begin - _BEFORE)
        stop = start + _LONGEST // 2
        before, after = "... " * (start > 0), " ..." * (stop < len(line))
        line, begin, end = line[start:stop], begin - start, min(end, stop) - start
    to_mark = f"{before}{line[:begin]}".expandtabs(_TAB)
    to_end = f"{before}{line[:end]}".expandtabs(_TAB)
    whole = f"{before}{line}{after}".expandtabs(_TAB)
    begins = cells(visible(to_mark))
    return _QuotedLine(visible(whole), begins, max(1, cells(visible(to_end)) - begins))
