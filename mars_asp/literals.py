"""Rules as a demand reads them: one atom that is forced, what it is forced by, and no tree.

To walk a tree of clingo takes a thousand times as long as to read what was made of it, so that is
kept from one command to the next.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple, TypeAlias

from clingo import ast

from mars_asp import pack
from mars_asp.kept import made_of
from mars_asp.pack import unsigned
from mars_asp.rulebook import Rule
from mars_asp.trace import pattern, scope
from mars_asp.trace.pattern import pattern_is_open
from mars_asp.trace.scope import variables_of

#: A predicate: its name, with `-` before if it is classically negated, and its arity.
Signature: TypeAlias = tuple[str, int]
_TYPE = ast.ASTType


class Term(NamedTuple):
    """A term as it is written, and its `variables` if it only takes values apart: a pattern."""

    text: str
    is_pattern: bool
    is_variable: bool
    is_constant: bool
    variables: frozenset[str]

    @property
    def pattern(self) -> str:
        """Return the term, or any value where it says more than a pattern does."""
        return self.text if self.is_pattern else "_"


class Literal(NamedTuple):
    """A predicate with its terms, and whether only its true instances matter.

    So it is with positive literals, but not behind a condition: `p(X) : q(X)` fails where there is
    a `q(X)` without a `p(X)`.
    """

    signature: Signature
    terms: tuple[Term, ...]
    binds: bool


@dataclass(frozen=True, slots=True)
class Plain:
    """A rule that forces one atom.

    `body` are the positive literals that stand by themselves; `parts` the other literals, those of
    each condition or element of an aggregate together; `written` the texts of head and body.
    """

    head: Literal
    body: tuple[Literal, ...]
    parts: tuple[tuple[Literal, ...], ...]
    written: tuple[str, ...]

    def text(self, more: Iterable[str]) -> str:
        """Return the rule with more literals before its own."""
        head, *body = self.written
        literals = "; ".join((*more, *body))
        return f"{head} :- {literals}." if literals else f"{head}."


def plain_rules(rules: Iterable[Rule]) -> tuple[Plain, ...] | None:
    """Return rules without their pools; `None` where one has a choice or what is not known here."""
    rule_of = {rule.text: rule for rule in rules}
    files = map(Path, (__file__, pack.__file__, pattern.__file__, scope.__file__, ast.__file__))
    found: list[Plain] = []
    for each in made_of("literals", files, rule_of, lambda text: _plain(rule_of[text])).values():
        if each is None:
            return None
        found += each
    return tuple(found)


def _plain(rule: Rule) -> tuple[Plain, ...] | None:
    statements = rule.ast.unpool()
    if not all(map(_is_plain, statements)):
        return None
    return tuple(
        Plain(
            _literal(statement.head),
            tuple(_positive(statement.body)),
            tuple(_parts(statement.body)),
            (str(statement.head), *map(str, statement.body)),
        )
        for statement in statements
    )


def _is_plain(statement: ast.AST) -> bool:
    """Say whether a rule forces one atom, by literals that are known here."""
    head = statement.head
    return (
        _is_symbolic(head)
        and head.sign == ast.Sign.NoSign
        and all(
            literal.ast_type == _TYPE.ConditionalLiteral
            or (literal.ast_type == _TYPE.Literal and literal.atom.ast_type != _TYPE.TheoryAtom)
            for literal in statement.body
        )
    )


def _positive(body: Iterable[ast.AST]) -> Iterator[Literal]:
    return (_literal(x) for x in body if _is_symbolic(x) and x.sign == ast.Sign.NoSign)


def _parts(body: Iterable[ast.AST]) -> Iterator[tuple[Literal, ...]]:
    """Yield what a body reads besides positive literals that stand by themselves."""
    for literal in body:
        if literal.ast_type == _TYPE.ConditionalLiteral:
            then = (each._replace(binds=False) for each in _literals((literal.literal,)))
            yield (*_literals(literal.condition), *then)
        elif literal.atom.ast_type == _TYPE.BodyAggregate:
            yield from (tuple(_literals(e.condition)) for e in literal.atom.elements)
        elif literal.atom.ast_type == _TYPE.Aggregate:
            yield from (tuple(_literals((*e.condition, e.literal))) for e in literal.atom.elements)
        elif literal.sign != ast.Sign.NoSign:
            yield tuple(_literals((literal,)))


def _literals(literals: Iterable[ast.AST]) -> Iterator[Literal]:
    return map(_literal, filter(_is_symbolic, literals))


def _is_symbolic(literal: ast.AST) -> bool:
    return literal.ast_type == _TYPE.Literal and literal.atom.ast_type == _TYPE.SymbolicAtom


def _literal(literal: ast.AST) -> Literal:
    sign, symbol = unsigned(literal.atom.symbol)
    terms = tuple(map(_term, symbol.arguments))
    return Literal((sign + symbol.name, len(terms)), terms, literal.sign == ast.Sign.NoSign)


def _term(term: ast.AST) -> Term:
    is_pattern = _is_pattern(term)
    variables = frozenset(variables_of((term,)) if is_pattern else ())
    closed = is_pattern and not pattern_is_open(term)
    is_variable = closed and term.ast_type == _TYPE.Variable
    return Term(str(term), is_pattern, is_variable, closed and not variables, variables)


def _is_pattern(term: ast.AST) -> bool:
    """Say whether a term only takes values apart."""
    if term.ast_type == _TYPE.Function:
        return not term.external and all(map(_is_pattern, term.arguments))
    return term.ast_type in (_TYPE.Variable, _TYPE.SymbolicTerm)
