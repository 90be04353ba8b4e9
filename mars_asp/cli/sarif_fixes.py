"""The one repair of a finding as the fixes of a SARIF result (3.55 of that standard)."""

from collections.abc import Callable, Mapping, Sequence
from itertools import takewhile
from typing import TYPE_CHECKING

from mars_asp.cli.diagnostic_text import Suggestion
from mars_asp.cli.lines import lines_of
from mars_asp.cli.results import plain_text

if TYPE_CHECKING:
    from mars_asp.language.text_edits import LineEdit


def sarif_fixes(
    suggestion: Suggestion, artifact: Callable[[str], Mapping[str, str]]
) -> dict[str, object]:
    """Return the property `fixes` of a result; `artifact` returns the location of a file.

    The result is empty if a line can no longer be read.
    """
    changes: dict[str, list[dict[str, object]]] = {}
    for edit in suggestion.edits:
        lines = lines_of(edit.path)
        if edit.line > len(lines):
            return {}
        changes.setdefault(edit.path, []).append(_replacement(edit, lines))
    warnings = (f"then warns: {warning}" for warning in suggestion.warnings)
    fix = {
        "description": {"text": plain_text(suggestion.message, *warnings)},
        "artifactChanges": [
            {"artifactLocation": artifact(path), "replacements": of} for path, of in changes.items()
        ],
    }
    return {"fixes": [fix]}


def _replacement(edit: "LineEdit", lines: Sequence[str]) -> dict[str, object]:
    """Return the deleted region, which may be empty, and the inserted content (3.57)."""
    number, old = edit.line, lines[edit.line - 1]
    if edit.old is None:
        column = 1 if edit.where == "before" else len(old) + 1
        text = f"{edit.new}\n" if edit.where == "before" else f"\n{edit.new}"
        return _put((number, column), (number, column), text)
    if edit.new is not None:
        # The smallest change, so that two fixes of a line do not overlap.
        before = _alike(old, edit.new)
        after = _alike(old[before:][::-1], edit.new[before:][::-1])
        new = edit.new[before : len(edit.new) - after]
        return _put((number, before + 1), (number, len(old) - after + 1), new)
    # A line is deleted with its end; the last line, with the end of the line before.
    if number < len(lines):
        return _put((number, 1), (number + 1, 1), None)
    begin = (number - 1, len(lines[number - 2]) + 1) if number > 1 else (1, 1)
    return _put(begin, (number, len(old) + 1), None)


def _alike(one: str, other: str) -> int:
    """Return the length of the common prefix of two texts."""
    return sum(1 for _ in takewhile(lambda pair: pair[0] == pair[1], zip(one, other, strict=False)))


def _put(begin: tuple[int, int], end: tuple[int, int], text: str | None) -> dict[str, object]:
    names = ("startLine", "startColumn", "endLine", "endColumn")
    region = dict(zip(names, (*begin, *end), strict=True))
    inserted = {} if text is None else {"insertedContent": {"text": text}}
    return {"deletedRegion": region, **inserted}
