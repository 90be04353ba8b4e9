"""Questions of the language server, answered in this process."""

import argparse
import io
import json
from collections.abc import Mapping
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path
from typing import Any, TypeAlias
from unittest.mock import patch

from mars_asp.cli import run_here
from mars_asp.cli.arguments import parser_of
from mars_asp.cli.lsp_answers import answer
from mars_asp.lsp.questions import Question, Sort
from mars_asp.lsp.robot import EditorFinding

#: A finding: path, start and end (line and UTF-16 unit, from 0), severity, code, message, help
#: and effect.
Finding: TypeAlias = tuple[
    str, tuple[int, int], tuple[int, int], str, str, str, str | None, str | None
]


def options(*words: str) -> argparse.Namespace:
    """Return the options of a server."""
    _, parser = parser_of("lsp")
    return parser.parse_intermixed_args(words)


def editor_answer(
    sort: Sort, path: Path, texts: Mapping[str, str] | None = None, about: str = ""
) -> Any:
    """Return the answer of the editor's worker to a question about a file."""
    return answer(Question(sort, str(path), texts or {}, about), options())


def printed(*words: str) -> list[Finding]:
    """Return the diagnostics that a verb prints, in the units of editors; no repairs are sought."""
    output, errors = io.StringIO(), io.StringIO()
    with (
        redirect_stderr(errors),
        redirect_stdout(output),
        patch("mars_asp.cli.check._sole_repairs", lambda *_: ()),
    ):
        run_here([*words, "--format", "json"])
    if words[0] == "check":
        document = json.loads(output.getvalue())
        found = [*document["findings"], *document["notes"]]
    else:
        lines = errors.getvalue().splitlines()
        found = [json.loads(line) for line in lines if line.startswith("{")]
    return sorted(_finding(each) for each in found if Path(each["path"]).is_file())


def _finding(found: Mapping[str, Any]) -> Finding:
    path = str(Path(found["path"]).resolve())
    places = [
        _units(path, found[line], found[column])
        for line, column in (("line", "column"), ("end_line", "end_column"))
    ]
    result = (found[key] for key in ("severity", "code", "message", "help", "effect"))
    return path, places[0], places[1], *result


def _units(path: str, line: int | None, column: int | None) -> tuple[int, int]:
    """Return a place in UTF-16 units, counted in the bytes of a file; its start without a line."""
    if line is None or column is None:
        return 0, 0
    raw = Path(path).read_bytes()
    encoding = "utf-16" if raw.startswith((b"\xff\xfe", b"\xfe\xff")) else "utf-8-sig"
    try:
        text = raw.decode(encoding)
    except UnicodeDecodeError:
        text = raw.decode("latin-1")
    lines = text.replace("\r\n", "\n").replace("\r", "\n").split("\n")
    if line > len(lines):
        line, column = len(lines), len(lines[-1]) + 1
    before = lines[line - 1][: column - 1]
    # Editors do not count a byte order mark as a character.
    return line - 1, sum(2 if ord(each) > 0xFFFF else 1 for each in before)


def editor_findings(found: tuple[EditorFinding, ...]) -> list[Finding]:
    """Return the findings of a worker, sorted, as tuples like those of `printed`."""
    return sorted(
        (
            str(Path(each.place.path).resolve()),
            (each.place.range.start.line, each.place.range.start.character),
            (each.place.range.end.line, each.place.range.end.character),
            each.severity,
            each.code,
            each.message,
            each.help,
            each.effect,
        )
        for each in found
    )
