"""The expectations of a file of cases: its comment lines, and the blocks that they belong to."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import clingo

from mars_asp.diagnostic import Diagnostic, Span
from mars_asp.spelling import nearest

#: The kinds that are written as words, as `%has: ...`; others are signs, as `%= ...`.
_WORDS = ("only", "has", "not", "case")
_LINE = re.compile(
    r"%(?:(?P<sign>[=>~])|(?P<word>[a-z]+):(?=[ \t\r]|$))[ \t]*(?P<rest>.*?)[ \t\r]*$"
)
_CONTINUED = re.compile(r"%\+(.*?)[ \t\r]*$")
#: A line with atoms that looks like a continuation.
_STRAY = re.compile(r"%\+[ \t]+[-_a-z]")
#: An open value; strings match as well, because they can contain `_`.
ANYTHING = re.compile(r'("(?:[^"\\]|\\.)*")|(?<![A-Za-z0-9_\'])_(?![A-Za-z0-9_\'])')
#: The code of errors in cases.
CODE = "case"
#: Represents any value.
ANY = clingo.Function("_any")


@dataclass(frozen=True, slots=True)
class ExpectedAtom:
    """An atom of an expectation in its written form, with its location."""

    text: str
    span: Span

    @property
    def pattern(self) -> clingo.Symbol:
        """Return the atom as a term in which `_any` is any value.

        Raises:
            RuntimeError: the text cannot be read as a term.
        """
        return clingo.parse_term(ANYTHING.sub(lambda match: match[1] or "_any", self.text))


@dataclass(frozen=True, slots=True)
class Expectation:
    """One expectation: `kind` is its sign or word, `last` its last line."""

    kind: str
    atoms: tuple[ExpectedAtom, ...]
    span: Span
    last: int

    @property
    def text(self) -> str:
        """Return the text after the sign or word."""
        return " ".join(each.text for each in self.atoms)


@dataclass(frozen=True, slots=True)
class Block:
    """One case of a file: its title, its expectations, and the text with other cases blanked."""

    title: str | None
    text: str
    span: Span
    expectations: tuple[Expectation, ...]

    def of(self, *kinds: str) -> tuple[Expectation, ...]:
        """Return the expectations of some kinds."""
        return tuple(each for each in self.expectations if each.kind in kinds)


def blocks_of(text: str, shown: str, problems: list[Diagnostic]) -> tuple[Block, ...]:
    """Return the cases of a file; add expectations that cannot be read to `problems`."""
    lines = text.split("\n")
    found = list(_read_expectations(lines, shown, problems))
    begins = [each for each in found if each.kind == "case"]
    expected = [each for each in found if each.kind != "case"]
    if not begins:
        return (Block(None, text, Span(shown, 1, 1, 1, 1), tuple(expected)),)
    common = begins[0].span.line
    early = [each for each in expected if each.span.line < common]
    problems += (
        Diagnostic(
            CODE,
            "error",
            "what is expected is of no case",
            each.span,
            help="write it below a line `%case: TITLE`, or leave these lines out",
        )
        for each in early
    )
    ends = [*(each.span.line for each in begins[1:]), len(lines) + 1]
    return tuple(
        Block(
            begin.text,
            "\n".join(
                line if number < common or begin.span.line <= number < end else ""
                for number, line in enumerate(lines, 1)
            ),
            begin.span,
            tuple(each for each in expected if begin.span.line < each.span.line < end),
        )
        for begin, end in zip(begins, ends, strict=True)
    )


def _read_expectations(
    lines: Sequence[str], shown: str, problems: list[Diagnostic]
) -> Iterator[Expectation]:
    number = 0
    while number < len(lines):
        match = _LINE.match(lines[number])
        number += 1
        if match is None and _STRAY.match(lines[number - 1]):
            span = Span(shown, number, 1, number, 3)
            message, advice = "`%+` continues nothing", "write it directly below a line `%= ...`"
            problems.append(Diagnostic(CODE, "error", message, span, help=advice))
        if match is None:
            continue
        first, kind = number, match["sign"] or match["word"]
        span = Span(shown, first, 1, first, len(match[0].rstrip()) + 1)
        if match["word"] and kind not in _WORDS:
            near = nearest(kind, _WORDS)
            if near:
                message, advice = f"`%{kind}:` is not an expectation", f"did you mean `%{near}:`?"
                problems.append(Diagnostic(CODE, "error", message, span, help=advice))
            continue
        if kind in (">", "~", "case"):
            yield Expectation(kind, (ExpectedAtom(match["rest"], span),), span, first)
            continue
        declared = list(_atoms(match["rest"], shown, first, match.start("rest")))
        while number < len(lines) and (more := _CONTINUED.match(lines[number])) is not None:
            number += 1
            declared += _atoms(more[1], shown, number, more.start(1))
        if kind != "=":
            problems += _unread(kind, declared, span)
        yield Expectation(kind, tuple(declared), span, number)


def _unread(kind: str, atoms: Sequence[ExpectedAtom], span: Span) -> Iterator[Diagnostic]:
    if not atoms:
        advice = f'write them, as in `%{kind}: seen(_,3) blind("A")`'
        yield Diagnostic(CODE, "error", f"`%{kind}:` names no atoms", span, help=advice)
    for each in atoms:
        try:
            kind_of = each.pattern.type
        except RuntimeError:
            kind_of = clingo.SymbolType.Infimum
        if kind_of != clingo.SymbolType.Function or not each.pattern.name:
            message, advice = f"expected an atom, found `{each.text}`", 'as in `seen("A",_)`'
            yield Diagnostic(CODE, "error", message, each.span, help=advice)


def _atoms(text: str, shown: str, line: int, before: int) -> Iterator[ExpectedAtom]:
    """Yield the atoms of a line, separated by blanks; `before` characters precede the text."""
    depth, begin, at = 0, 0, 0
    while at <= len(text):
        character = text[at : at + 1]
        if character == '"':
            string = re.compile(r'"(?:[^"\\]|\\.)*"?').match(text, at)
            at = len(text) if string is None else string.end()
            continue
        depth += (character == "(") - (character == ")")
        if not character or (character in " \t" and not depth):
            if begin < at:
                place = Span(shown, line, before + begin + 1, line, before + at + 1)
                yield ExpectedAtom(text[begin:at], place)
            begin = at + 1
        at += 1
