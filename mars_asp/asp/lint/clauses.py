"""Rules in their written form: literals, comparisons and aggregates with terms and locations."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Literal, NamedTuple, TypeAlias

from clingo import SymbolType

from mars_asp.asp.lint.found import Fix, LintFinding, found
from mars_asp.asp.rules.checks import placed
from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.statements import places, sign_and_function, variants
from mars_asp.asp.rules.trees import (
    COMPARISONS,
    OPERATIONS,
    Kind,
    SyntaxNode,
    elements_of,
    guards_of,
    names_of,
)
from mars_asp.asp.signature import Signature
from mars_asp.diagnostic import Span

OPPOSITE = {">": "<=", "<": ">=", "<=": ">", ">=": "<", "!=": "=", "=": "!="}
TURNED = {">": "<", "<": ">", "<=": ">=", ">=": "<=", "!=": "!=", "=": "="}
_FUNCTIONS = ("count", "sum", "sum+", "min", "max")
#: The operations that are computed, by their signs.
_COMPUTED = {"+": int.__add__, "-": int.__sub__, "*": int.__mul__}

#: The kinds of heads: one atom, some of several atoms, one of several, or none.
Sort: TypeAlias = Literal["rule", "choice", "disjunction", "constraint", "other"]
_SORTS: Mapping[Kind, Sort] = {
    Kind.Aggregate: "choice",
    Kind.HeadAggregate: "choice",
    Kind.Disjunction: "disjunction",
}


class ClauseAtom(NamedTuple):
    """A literal of a predicate; `sign` is the number of its negations by `not`, 0 to 2.

    `named` are its arguments that are variables: positions from 0, and names.
    """

    signature: Signature
    terms: tuple[SyntaxNode, ...]
    sign: int
    node: SyntaxNode
    named: tuple[tuple[int, str], ...]

    @property
    def text(self) -> str:
        """Return the atom as it is written, without `not`."""
        inside = ",".join(map(str, self.terms))
        minus = "" if self.signature.positive else "-"
        return f"{minus}{self.signature.name}({inside})" if self.terms else self.signature.name


class Comparison(NamedTuple):
    """Two terms compared; `not X < Y` is `X >= Y`."""

    left: SyntaxNode
    sign: str
    right: SyntaxNode
    node: SyntaxNode

    @property
    def text(self) -> str:
        """Return the comparison as clingo would write it."""
        return f"{self.left!s} {self.sign} {self.right!s}"

    @property
    def sides(self) -> tuple[tuple[SyntaxNode, str, SyntaxNode], ...]:
        """Return the comparison as it is and mirrored (`X < Y` and `Y > X`)."""
        return (
            (self.left, self.sign, self.right),
            (self.right, TURNED[self.sign], self.left),
        )

    @property
    def equal(self) -> tuple[tuple[SyntaxNode, SyntaxNode], ...]:
        """Return (left, right) and (right, left) if the comparison is an equation, else none."""
        return tuple((one, other) for one, sign, other in self.sides if sign == "=")


class ClauseScope(NamedTuple):
    """Literals that hold together; of the atoms, those `positive` are not negated."""

    atoms: tuple[ClauseAtom, ...] = ()
    comparisons: tuple[Comparison, ...] = ()
    #: Other literals, such as `#false`.
    others: tuple[SyntaxNode, ...] = ()
    positive: tuple[ClauseAtom, ...] = ()


class Element(NamedTuple):
    """An element of an aggregate: the terms of its tuple, and its condition as a scope."""

    terms: tuple[SyntaxNode, ...]
    scope: ClauseScope
    node: SyntaxNode


class Aggregate(NamedTuple):
    """An aggregate in a body: `function` is `set` for `{ ... }`; guards are written to its left."""

    function: str
    guards: tuple[tuple[str, SyntaxNode], ...]
    elements: tuple[Element, ...]
    sign: int
    node: SyntaxNode


class Conditional(NamedTuple):
    """A literal that has to hold for all instances of its condition."""

    literal: ClauseScope
    condition: ClauseScope


@dataclass(frozen=True)
class Clause:
    """A rule without pools: each choice of members of its pools gives one clause."""

    rule: Rule
    node: SyntaxNode
    sort: Sort
    heads: tuple[tuple[ClauseAtom, ClauseScope], ...]
    body: ClauseScope
    aggregates: tuple[Aggregate, ...]
    conditionals: tuple[Conditional, ...]

    @cached_property
    def bound(self) -> frozenset[str]:
        """Return the global variables of the rule."""
        heads = (atom for atom, condition in self.heads if not condition.atoms)
        found = [term for atom in (*self.body.atoms, *heads) for term in atom.terms]
        found += (one for each in self.body.comparisons for one, _, _ in each.sides)
        found += (guard for aggregate in self.aggregates for _, guard in aggregate.guards)
        return names_of(found)

    @cached_property
    def kinds(self) -> frozenset[tuple[object, ...]]:
        """Return the keys (`kind_of`) of the literals of the body."""
        return frozenset(map(kind_of, self.node.body))

    @property
    def scopes(self) -> Iterator[ClauseScope]:
        """Yield the literals of the body alone, and together with each element and condition."""
        yield self.body
        for inner in self.inner:
            yield joined(self.body, inner)

    @cached_property
    def inner(self) -> tuple[ClauseScope, ...]:
        """Return the literals of elements and conditions."""
        return (
            *(element.scope for each in self.aggregates for element in each.elements),
            *(each.condition for each in self.conditionals),
            *(condition for _, condition in self.heads if condition.atoms),
        )

    @cached_property
    def read(self) -> tuple[ClauseAtom, ...]:
        """Return all atoms except heads."""
        inner = (*self.inner, *(each.literal for each in self.conditionals))
        return (*self.body.atoms, *(atom for scope in inner for atom in scope.atoms))

    def finding(
        self,
        code: str,
        message: str,
        node: SyntaxNode,
        advice: str,
        fixes: tuple[Fix, ...] = (),
        labels: tuple[tuple[Span, str], ...] = (),
    ) -> LintFinding:
        """Return a finding about a node of the rule; `advice` is its help."""
        return found(code, message, self.place(node), self.rule, advice, fixes, labels)

    def place(self, node: SyntaxNode) -> Span:
        """Return the location of a node, or of the metadata line that lists its rule."""
        if self.rule.listed is not None:
            return self.rule.listed
        return placed(self.rule.span, places(self.rule.text)(node))

    def span(self, node: SyntaxNode) -> Span | None:
        """Return the span of a node in its file, or None for a rule made from metadata."""
        if self.rule.listed is not None:
            return None
        where = places(self.rule.text)
        begin, end = (placed(self.rule.span, where(node, end)) for end in (False, True))
        return Span(begin.path, begin.line, begin.column, end.line, end.column)


def joined(one: ClauseScope, other: ClauseScope) -> ClauseScope:
    """Return the literals of both scopes."""
    return ClauseScope(
        one.atoms + other.atoms,
        one.comparisons + other.comparisons,
        one.others + other.others,
        one.positive + other.positive,
    )


def clauses_of(rules: Iterable[Rule]) -> dict[int, tuple[Clause, ...]]:
    """Return the clauses of each rule, by its number."""
    return dict(enumerate(map(_clauses, rules)))


@lru_cache(maxsize=10_000)
def _clauses(rule: Rule) -> tuple[Clause, ...]:
    """Return the clauses of a rule; cached, as built-in rules are beside each pack."""
    return tuple(_clause(rule, node) for node in variants(rule.text))


# ---- Terms ---------------------------------------------------------------------------------------


def name_of(term: SyntaxNode) -> str | None:
    """Return the name of a variable, or None for `_` and other terms."""
    if term.ast_type is Kind.Variable and term.name != "_":
        name: str = term.name
        return name
    return None


def is_constant(term: SyntaxNode) -> bool:
    """Whether a term is a single value."""
    kind = term.ast_type
    return kind is Kind.SymbolicTerm or (
        kind is Kind.Function and not term.external and all(map(is_constant, term.arguments))
    )


def number_of(term: SyntaxNode) -> int | None:
    """Return the number that a term evaluates to, or None."""
    if term.ast_type is Kind.SymbolicTerm and term.symbol.type == SymbolType.Number:
        number: int = term.symbol.number
        return number
    if term.ast_type is Kind.UnaryOperation and str(term).startswith("-"):
        inside = number_of(term.argument)
        return None if inside is None else -inside
    if (sign := operation_of(term)) in _COMPUTED:
        left, right = number_of(term.left), number_of(term.right)
        return None if left is None or right is None else _COMPUTED[sign](left, right)
    return None


def operation_of(term: SyntaxNode) -> str | None:
    """Return the sign of a binary operation, or None for other terms."""
    kind = term.ast_type
    return OPERATIONS[term.operator_type] if kind is Kind.BinaryOperation else None


def kind_of(literal: SyntaxNode) -> tuple[object, ...]:
    """Return a key that two literals share if they may match: sign, name and arity."""
    if literal.ast_type is Kind.Literal and literal.atom.ast_type is Kind.SymbolicAtom:
        symbol = literal.atom.symbol
        if symbol.ast_type is Kind.Function:
            return literal.sign, symbol.name, len(symbol.arguments)
    return (literal.ast_type,)


# ---- Reading -------------------------------------------------------------------------------------


def _clause(rule: Rule, node: SyntaxNode) -> Clause:
    sort, heads = _heads(node.head)
    plain, aggregates, conditionals = [], [], []
    for literal in node.body:
        kind = literal.ast_type
        if kind is Kind.ConditionalLiteral:
            scope = _scope([literal.literal])
            conditionals.append(Conditional(scope, _scope(literal.condition)))
        elif kind is Kind.Literal and literal.atom.ast_type in (Kind.BodyAggregate, Kind.Aggregate):
            aggregates.append(_aggregate(literal))
        else:
            plain.append(literal)
    return Clause(
        rule, node, sort, tuple(heads), _scope(plain), tuple(aggregates), tuple(conditionals)
    )


def _heads(head: SyntaxNode) -> tuple[Sort, list[tuple[ClauseAtom, ClauseScope]]]:
    found = [
        (_clause_atom(literal), _scope(condition))
        for (*_, literal), condition in elements_of(head)
        if literal.atom.ast_type is Kind.SymbolicAtom
    ]
    if head.ast_type is not Kind.Literal:
        return _SORTS.get(head.ast_type, "other"), found
    if found:
        return ("rule" if head.sign == 0 else "other"), found
    return ("constraint" if str(head) == "#false" else "other"), found


def _aggregate(literal: SyntaxNode) -> Aggregate:
    atom = literal.atom
    guards = [(COMPARISONS[each.comparison], each.term) for each in guards_of(atom)]
    # Clingo writes a single guard to the left, and keeps the sign of a right one.
    guards[1:] = [(TURNED[sign], term) for sign, term in guards[1:]]
    elements = zip(atom.elements, elements_of(atom), strict=True)
    if atom.ast_type is Kind.BodyAggregate:
        function = _FUNCTIONS[atom.function]
        found = [Element(terms, _scope(inner), each) for each, (terms, inner) in elements]
    else:
        function = "set"
        found = [Element((), _scope((*inner, *own)), each) for each, (own, inner) in elements]
    return Aggregate(function, tuple(guards), tuple(found), literal.sign, literal)


def _scope(literals: Iterable[SyntaxNode]) -> ClauseScope:
    atoms: list[ClauseAtom] = []
    comparisons: list[Comparison] = []
    others: list[SyntaxNode] = []
    for literal in literals:
        kind = literal.atom.ast_type if literal.ast_type is Kind.Literal else None
        if kind is Kind.SymbolicAtom:
            atoms.append(_clause_atom(literal))
        elif kind is Kind.Comparison:
            comparisons += _comparisons(literal)
        else:
            others.append(literal)
    positive = tuple([atom for atom in atoms if atom.sign == 0])
    return ClauseScope(tuple(atoms), tuple(comparisons), tuple(others), positive)


def _clause_atom(literal: SyntaxNode) -> ClauseAtom:
    minus, symbol = sign_and_function(literal.atom.symbol)
    terms = symbol.arguments
    named = [(at, name) for at, term in enumerate(terms) if (name := name_of(term)) is not None]
    signature = Signature(symbol.name, len(terms), not minus)
    return ClauseAtom(signature, terms, literal.sign, literal, tuple(named))


def _comparisons(literal: SyntaxNode) -> Iterator[Comparison]:
    left = literal.atom.term
    guards = literal.atom.guards
    if literal.sign == 1 and len(guards) > 1:
        return
    for guard in guards:
        sign = COMPARISONS[guard.comparison]
        yield Comparison(left, OPPOSITE[sign] if literal.sign == 1 else sign, guard.term, literal)
        left = guard.term
