"""A finding of lint: a diagnostic, its rule, and its fixes."""

from collections.abc import Iterable
from itertools import accumulate
from typing import NamedTuple

from mars_asp.asp.rules.rule import Rule
from mars_asp.diagnostic import Diagnostic, Span


class Fix(NamedTuple):
    """A span of a file, and the text that replaces it."""

    span: Span
    text: str


def titled(fixes: Iterable[Fix]) -> str:
    """Return the title of fixes: `write` and their texts, or `leave it out` without texts."""
    written = " and ".join(f"`{each.text}`" for each in fixes if each.text)
    return f"write {written}" if written else "leave it out"


class LintFinding(NamedTuple):
    """A diagnostic about a rule, or about a file without a rule."""

    diagnostic: Diagnostic
    rule: Rule | None
    fixes: tuple[Fix, ...] = ()


def found(
    code: str,
    message: str,
    place: Span,
    rule: Rule | None,
    advice: str,
    fixes: tuple[Fix, ...] = (),
    labels: tuple[tuple[Span, str], ...] = (),
) -> LintFinding:
    """Return a finding with a diagnostic; `advice` is its help, `fixes` are safe changes."""
    return LintFinding(Diagnostic(code, "warning", message, place, labels, advice), rule, fixes)


def fixed(text: str, path: str, lints: Iterable[LintFinding]) -> tuple[str, int]:
    """Return the text of a file after the fixes of findings, and the number of fixed findings.

    If two fixes overlap, the first is applied.
    """
    lines = text.split("\n")
    starts = [0, *accumulate(len(line) + 1 for line in lines)]
    taken: list[tuple[int, int, str]] = []
    count = 0
    for each in lints:
        wanted = [
            (starts[at.line - 1] + at.column - 1, starts[at.end_line - 1] + at.end_column - 1, new)
            for at, new in each.fixes
            if at.path == path
        ]
        free = all(end <= b or e <= begin for begin, end, _ in wanted for b, e, _ in taken)
        if wanted and free:
            taken += wanted
            count += 1
    for begin, end, new in sorted(taken, reverse=True):
        text = f"{text[:begin]}{new}{text[end:]}"
    return text, count
