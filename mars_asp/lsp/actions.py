"""Quick fixes of findings: edits that an analysis has tried, and corrections of spelling."""

import re
from collections.abc import Iterable, Iterator
from typing import NamedTuple

from mars_asp.language.text_edits import LineEdit
from mars_asp.lsp.places import Place, Position, Range, Text, TextEdit
from mars_asp.lsp.robot import EditorFinding
from mars_asp.spelling import nearest

_MEANT = re.compile(r"did you mean `([^`\n]+)`\?")
#: Minimal similarity of a misspelling.
_ALIKE = 0.6
_LONGEST = 100


class QuickFix(NamedTuple):
    """A quick fix: its title and its edits.

    `removes` is the title or code of the finding; `is_sole` is whether it is the only repair.
    """

    title: str
    edits: tuple[TextEdit, ...]
    removes: str
    is_sole: bool = False


def actions_at(
    actions: Iterable[QuickFix], found: Iterable[EditorFinding]
) -> Iterator[tuple[EditorFinding, QuickFix]]:
    """Yield (finding, quick fix) for each action that removes one of the findings."""
    by_title: dict[str, list[QuickFix]] = {}
    for action in actions:
        by_title.setdefault(action.removes, []).append(action)
    for finding in found:
        for action in by_title.get(finding.title or "", ()):
            yield finding, action


def fix_actions(found: Iterable[EditorFinding]) -> Iterator[tuple[EditorFinding, QuickFix]]:
    """Yield the safe fixes of findings, as of `rules lint --fix`, each with its finding."""
    for finding in found:
        if finding.fixes:
            written = " and ".join(f"`{each.text}`" for each in finding.fixes if each.text)
            title = f"Write {written}" if written else "Leave it out"
            yield finding, QuickFix(title, finding.fixes, finding.code, True)


def spelling_actions(
    text: Text, found: Iterable[EditorFinding]
) -> Iterator[tuple[EditorFinding, QuickFix]]:
    """Yield corrections of misspelt words at findings, each with its finding."""
    for finding in found:
        match = _MEANT.search(finding.help or "")
        if match is None or finding.fixes or finding.place.path != text.path:
            continue
        line, column = text.column(finding.place.range.start)
        last, end = text.column(finding.place.range.end)
        word = text.lines[line - 1][column - 1 : end - 1] if line == last else ""
        # The advice may be about another word of the line.
        is_word = 0 < len(word) <= _LONGEST and word != match[1]
        if is_word and nearest(word, [match[1]], _ALIKE) is not None:
            edit = TextEdit(finding.place, match[1])
            yield finding, QuickFix(f"Write `{match[1]}`", (edit,), finding.code, True)


def line_edits(texts: dict[str, Text], lines: Iterable[LineEdit]) -> Iterator[TextEdit]:
    """Yield edits of lines as edits of ranges; `texts` has the text of each path."""
    for each in lines:
        text = texts[each.path]
        if each.old is None:
            yield _inserted(text, each)
            continue
        start, end = text.position(each.line, 1), text.position(each.line, len(each.old) + 1)
        if each.new is None and each.line < len(text.lines):
            # Delete the line with its line end.
            end = Position(each.line, 0)
        yield TextEdit(Place(each.path, Range(start, end)), each.new or "")


def _inserted(text: Text, edit: LineEdit) -> TextEdit:
    """Return the edit that inserts lines; it adds a missing line end before them."""
    new = edit.new or ""
    if edit.where == "before":
        start = text.position(edit.line, 1)
        return TextEdit(Place(edit.path, Range(start, start)), f"{new}\n")
    if edit.line < len(text.lines):
        start = Position(edit.line, 0)
        return TextEdit(Place(edit.path, Range(start, start)), f"{new}\n")
    start = text.position(edit.line, 1 << 30)
    return TextEdit(Place(edit.path, Range(start, start)), f"\n{new}")
