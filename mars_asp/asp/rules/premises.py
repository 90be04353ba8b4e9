"""The premises that each rule of a text cannot fire without, as read by the build.

Reading the premises of a text takes longer than grounding its rules, so they are unknown for texts
that no build has read. Those of a single rule are always known.
"""

import re
from collections.abc import Callable, Sequence
from pathlib import Path

from mars_asp.asp.cache import digest, memoized
from mars_asp.asp.fragments import Fragment, Premises, blank
from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.statements import FILES, Place, pieces, statements

#: The sorts of statements that make no atoms possible except those in the heads of rules.
_SILENT = ("rule", "comment", "constant", "declaration", "shown", "cost")
_MAKERS = (Path(__file__), *FILES)
_BLANKS = re.compile(r"[ \t]+\n")
#: The statement at the begin of a file has no text.
_SILENT_TOO = re.compile(r"$|#\s*project\b")


def premises_of(text: str) -> Premises | None:
    """Return the stored premises of the rules of a text, or None if the tables lack it.

    The build makes the tables of the built-in rules.
    """
    return _known(text, lambda: None)


def read_premises(text: str) -> Premises | None:
    """Return the premises of the rules of a text, which a build keeps.

    The result is None if other statements than rules make atoms possible.
    """
    return _known(text, lambda: _read_text(text))


def fragment_of(rule: Rule) -> Fragment:
    """Return a rule as a fragment of a program, with its location and premises."""
    return Fragment(rule.text, rule.span.path, rule.span, premises_of_rule(rule))


def premises_of_rule(rule: Rule, text: str | None = None, gives: str | None = None) -> Premises:
    """Return the premises of a rule, or of a `text` with its body and the head `gives`."""
    needs, own = memoized("needs", _MAKERS, [rule.text], _of_rule)[rule.text]
    heads = own if gives is None else frozenset({gives})
    return Premises(("", ""), (rule.text if text is None else text,), (needs,), (heads,))


def _known(text: str, make: Callable[[], Premises | None]) -> Premises | None:
    key = digest(text.encode())
    return memoized("premises", _MAKERS, [key], lambda _: make())[key]


def _read_text(text: str) -> Premises | None:
    lines = text.split("\n")
    rest, rules, read = [""], [], (1, 1)
    for piece in pieces(text):
        if piece.sort not in _SILENT and _SILENT_TOO.match(piece.text) is None:
            return None
        if piece.sort in ("rule", "comment"):
            rest[-1] += _between(lines, read, piece.begin)
            read = piece.end
        if piece.sort == "rule":
            rules.append(piece.text)
            rest.append("")
        elif piece.sort == "comment":
            rest[-1] += blank(piece.text)
    rest[-1] += _between(lines, read, (len(lines), len(lines[-1]) + 1))
    found = [_of_rule(rule) for rule in rules]
    needs, gives = tuple(each for each, _ in found), tuple(each for _, each in found)
    between = tuple(_BLANKS.sub("\n", each) for each in rest)
    return Premises(between, tuple(rules), needs, gives)


def _between(lines: Sequence[str], begin: Place, end: Place) -> str:
    """Return the text from `begin` to `end`, "" if `begin` is not before `end`."""
    if begin >= end:
        return ""
    (first, left), (last, right) = begin, end
    found = list(lines[first - 1 : last])
    found[-1] = found[-1][: right - 1]
    found[0] = found[0][left - 1 :]
    return "\n".join(found)


def _of_rule(text: str) -> tuple[frozenset[str], frozenset[str]]:
    variants = statements(text)
    needs = ({each.signature.name for each in one.body.positive} for one in variants)
    gives = (each.name for one in variants for each in one.derives)
    return frozenset[str].intersection(*map(frozenset, needs)), frozenset(gives)
