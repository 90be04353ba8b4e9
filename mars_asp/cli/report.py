"""Diagnostics on standard error, as text or as one JSON object a line."""

import argparse
import sys
from collections.abc import Iterable

from mars_asp.cli.encode import encoded
from mars_asp.diagnostic import Diagnostic, MarsError
from mars_asp.output import visible

_CODES = {"error": "31", "warning": "33", "note": "36", "dim": "2", "strong": "1"}


def paint(text: str, style: str, coloured: bool) -> str:
    """Return a text in a style, where colours are wanted."""
    return f"\x1b[{_CODES[style]}m{text}\x1b[0m" if coloured else text


def report_error(error: MarsError, arguments: argparse.Namespace) -> None:
    """Print everything that a stage found wrong."""
    report(error.diagnostics, arguments)


def report(diagnostics: Iterable[Diagnostic], arguments: argparse.Namespace) -> None:
    """Print diagnostics in the order given; `--quiet` leaves out notes."""
    for diagnostic in diagnostics:
        if arguments.quiet and diagnostic.severity == "note":
            continue
        if arguments.format in ("json", "jsonl"):
            print(encoded(diagnostic_json(diagnostic)), file=sys.stderr)
        else:
            print(diagnostic_text(diagnostic, colours(arguments, sys.stderr)), file=sys.stderr)


def colours(arguments: argparse.Namespace, stream: object) -> bool:
    """Whether a stream is to be coloured."""
    if arguments.color != "auto":
        return bool(arguments.color == "always")
    isatty = getattr(stream, "isatty", None)
    return bool(isatty and isatty())


def diagnostic_json(diagnostic: Diagnostic) -> dict[str, object]:
    """Return a diagnostic with the keys of the command line's contract."""
    span = diagnostic.span
    return {
        "code": diagnostic.code,
        "severity": diagnostic.severity,
        "message": diagnostic.message,
        "path": span.path,
        "line": span.line,
        "column": span.column,
        "help": diagnostic.help,
    }


def diagnostic_text(diagnostic: Diagnostic, coloured: bool = False) -> str:
    """Return a diagnostic as `path:line:column: severity: message`, the line, a caret and help."""
    span = diagnostic.span
    severity = paint(diagnostic.severity, diagnostic.severity, coloured)
    place = visible(f"{span.path}:{span.line}:{span.column}")
    lines = [f"{place}: {severity}: {visible(diagnostic.message)} [{visible(diagnostic.code)}]"]
    if diagnostic.excerpt is not None:
        lines += _excerpt(diagnostic)
    for where, label in diagnostic.labels:
        lines.append(visible(f"    {where.path}:{where.line}:{where.column}: {label}"))
    if diagnostic.help:
        lines.append(f"    help: {visible(diagnostic.help)}")
    return "\n".join(lines)


def _excerpt(diagnostic: Diagnostic) -> list[str]:
    span = diagnostic.span
    text = visible((diagnostic.excerpt or "").replace("\t", " ").rstrip("\r\n"))
    if len(text) > 400:
        return []
    same_line = span.end_line == span.line
    width = max(1, span.end_column - span.column) if same_line else 1
    width = min(width, max(1, len(text) - span.column + 1))
    return [f"    {text}", "    " + " " * (span.column - 1) + "^" * width]
