"""What rules, constraints and costs read and derive, as far as it tells whose they are."""

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import NamedTuple, TypeAlias

from clingo import ast

from mars_asp.apart.shapes import Function, Pattern, pattern_of
from mars_asp.pack import unsigned

#: A predicate: its name, with `-` before if it is classically negated, and its arity.
Signature: TypeAlias = tuple[str, int]
_TYPE = ast.ASTType
_SILENT = (_TYPE.Program, _TYPE.ShowSignature, _TYPE.Defined, _TYPE.Comment)


class Literal(NamedTuple):
    """A predicate with its terms."""

    signature: Signature
    terms: tuple[Pattern, ...]


@dataclass(frozen=True, slots=True)
class Scope:
    """Literals that share their variables: the positive ones, which bind them, and the others."""

    positive: tuple[Literal, ...]
    others: tuple[Literal, ...] = ()


@dataclass(frozen=True, slots=True)
class Cost:
    """The tuple of a cost; equal tuples of one `level`, a priority and a length, count once.

    Of each term `constants` has the text if it is constant.
    """

    terms: tuple[Pattern, ...]
    constants: tuple[str | None, ...]
    level: str


@dataclass(frozen=True, slots=True)
class Statement:
    """A rule, constraint or cost.

    `inner` are the elements of aggregates and conditions in its body; each of `heads` has the
    condition under which it is offered; `assigned` are terms of the body that have the value that
    one of the elements, by its number, has in a term.
    """

    text: str
    heads: tuple[tuple[Literal, Scope], ...]
    body: Scope
    inner: tuple[Scope, ...]
    assigned: tuple[tuple[Pattern, tuple[tuple[int, Pattern], ...]], ...] = ()
    offers: bool = False
    cost: Cost | None = None

    @property
    def derives(self) -> frozenset[Signature]:
        """Return the predicates of its head."""
        return frozenset(literal.signature for literal, _ in self.heads)

    @property
    def reads(self) -> frozenset[Signature]:
        """Return the predicates of its body and conditions."""
        conditions = (condition for _, condition in self.heads)
        scopes = (self.body, *self.inner, *conditions)
        return frozenset(x.signature for scope in scopes for x in (*scope.positive, *scope.others))


class Program(NamedTuple):
    """Statements, and the predicates that tell answers apart."""

    statements: tuple[Statement, ...]
    projected: frozenset[Signature]


def program_of(text: str) -> Program | None:
    """Return what a text says; `None` where a statement is of a sort that is not known here."""
    parsed: list[ast.AST] = []
    ast.parse_string(text, parsed.append)
    found: list[Statement] = []
    projected = []
    for each in parsed:
        if each.ast_type == _TYPE.ProjectSignature:
            projected.append((each.name if each.positive else f"-{each.name}", each.arity))
        elif each.ast_type in (_TYPE.Rule, _TYPE.Minimize):
            statements = [_statement(statement) for statement in each.unpool()]
            if None in statements:
                return None
            found += (statement for statement in statements if statement is not None)
        elif each.ast_type not in _SILENT:
            return None
    return Program(tuple(found), frozenset(projected))


def _statement(statement: ast.AST) -> Statement | None:
    reader = _Reader()
    if not all(map(reader.read, statement.body)):
        return None
    body = Scope(tuple(reader.positive), tuple(reader.others))
    text, rest = str(statement), (tuple(reader.inner), tuple(reader.assigned))
    if statement.ast_type == _TYPE.Minimize:
        terms = tuple(map(pattern_of, statement.terms))
        constants = (t if t.ast_type == _TYPE.SymbolicTerm else None for t in statement.terms)
        told = tuple(None if constant is None else str(constant) for constant in constants)
        cost = Cost(terms, told, f"{statement.priority}/{len(terms)}")
        return Statement(text, (), body, *rest, cost=cost)
    head = statement.head
    if head.ast_type == _TYPE.Aggregate:
        offered = [(element.literal, _scope(element.condition)) for element in head.elements]
    elif head.ast_type == _TYPE.Literal:
        offered = [(head, Scope(()))]
    else:
        return None
    heads = []
    for literal, condition in offered:
        if literal.atom.ast_type == _TYPE.BooleanConstant:
            continue
        if condition is None or not _is_atom(literal):
            return None
        heads.append((_literal(literal), condition))
    offers = head.ast_type != _TYPE.Literal
    return Statement(text, tuple(heads), body, *rest, offers)


@dataclass
class _Reader:
    """Reads a body, literal by literal."""

    positive: list[Literal] = field(default_factory=list)
    others: list[Literal] = field(default_factory=list)
    inner: list[Scope] = field(default_factory=list)
    assigned: list[tuple[Pattern, tuple[tuple[int, Pattern], ...]]] = field(default_factory=list)

    def read(self, literal: ast.AST) -> bool:
        """Read a literal; say whether it is of a known sort."""
        if literal.ast_type == _TYPE.ConditionalLiteral:
            condition = _scope(literal.condition)
            if condition is None or not _is_plain(literal.literal):
                return False
            then = (_literal(literal.literal),) if _is_atom(literal.literal) else ()
            self.inner.append(Scope(condition.positive, (*condition.others, *then)))
            return True
        if literal.atom.ast_type == _TYPE.BodyAggregate:
            return self._read_aggregate(literal)
        if literal.atom.ast_type == _TYPE.Aggregate:
            scopes = [_scope((*e.condition, e.literal)) for e in literal.atom.elements]
            self.inner += [scope for scope in scopes if scope is not None]
            return None not in scopes
        scope = _scope((literal,))
        if scope is None:
            return False
        self.positive += scope.positive
        self.others += scope.others
        return True

    def _read_aggregate(self, literal: ast.AST) -> bool:
        elements = []
        for element in literal.atom.elements:
            scope = _scope(element.condition)
            if scope is None:
                return False
            first = pattern_of(element.terms[0]) if element.terms else None
            elements.append((len(self.inner), first))
            self.inner.append(scope)
        guard = literal.atom.left_guard
        ends = (ast.AggregateFunction.Min, ast.AggregateFunction.Max)
        if literal.sign == ast.Sign.NoSign and guard is not None and literal.atom.function in ends:
            # Of no elements the value is no function, so a function is that of an element.
            pattern = pattern_of(guard.term)
            if guard.comparison == ast.ComparisonOperator.Equal and isinstance(pattern, Function):
                self.assigned.append((pattern, tuple(elements)))
        return True


def _scope(literals: Iterable[ast.AST]) -> Scope | None:
    literals = tuple(literals)
    if not all(map(_is_plain, literals)):
        return None
    atoms = tuple(filter(_is_atom, literals))
    positive = tuple(_literal(x) for x in atoms if x.sign == ast.Sign.NoSign)
    return Scope(positive, tuple(_literal(x) for x in atoms if x.sign != ast.Sign.NoSign))


def _is_plain(literal: ast.AST) -> bool:
    return literal.ast_type == _TYPE.Literal and literal.atom.ast_type in (
        _TYPE.SymbolicAtom,
        _TYPE.Comparison,
        _TYPE.BooleanConstant,
    )


def _is_atom(literal: ast.AST) -> bool:
    return bool(literal.atom.ast_type == _TYPE.SymbolicAtom)


def _literal(literal: ast.AST) -> Literal:
    sign, symbol = unsigned(literal.atom.symbol)
    terms = tuple(map(pattern_of, symbol.arguments))
    return Literal((f"{sign}{symbol.name}", len(terms)), terms)
