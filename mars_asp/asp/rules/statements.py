"""Rules as all that reasons about them reads them: frozen values from clingo's own parse.

Nothing else reads the text or the tree of a rule; explanations alone write further rules from
trees. To walk a tree takes a thousand times as long as to read the values made of it, so those of
the built-in rules are made when the package is built.
"""

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Literal as Choice
from typing import NamedTuple, TypeAlias, TypeVar

import clingo
from clingo import SymbolType, ast

from mars_asp.asp.cache import memoized
from mars_asp.asp.rules import trees
from mars_asp.asp.rules.trees import (
    OPERATIONS,
    UNARY_OPERATIONS,
    WITH_ELEMENTS,
    SyntaxNode,
    atom_of,
    below,
    elements_of,
    extent_of,
    guards_of,
    names_in,
    plain,
)
from mars_asp.asp.signature import Signature

#: A line and a column in the text of a rule, both from 1; columns count characters.
Place: TypeAlias = tuple[int, int]

_TYPE = ast.ASTType
_EQUAL = ast.ComparisonOperator.Equal
_SILENT = (_TYPE.Program, _TYPE.ShowSignature, _TYPE.Defined, _TYPE.Comment)
_OPERANDS = (_TYPE.SymbolicTerm, _TYPE.BinaryOperation, _TYPE.UnaryOperation)
#: Terms with others inside, whose negation is not an operation.
_COMPOUND = (_TYPE.Function, _TYPE.Pool)
#: How clingo writes that a literal is not negated, negated once, or twice.
_SIGNS = ("", "not ", "not not ")
_NONE: frozenset[str] = frozenset()
#: The files whose changes can change the values of rules.
FILES = (Path(__file__), *trees.FILES)
#: A part of every operation, and of every number that does not fit into 32 bits.
_COMPUTING = re.compile(r"[-+*/\\&?^|~]|[0-9]{10}|0[a-z]")
#: A part of every text that minimises or maximises something.
_COST = re.compile(r"#\s*(?:min|max)[a-z]*mi[sz]e|:~")
_NOT_ASCII = re.compile(r"[^\x00-\x7f]")
#: The values of so many rules are kept.
_MOST = 20_000
#: What a file of rules is made of: `begin` has no text, it is where each file begins.
Sort: TypeAlias = Choice[
    "begin",
    "comment",
    "rule",
    "constant",
    "declaration",
    "shown",
    "term",
    "cost",
    "external",
    "other",
]
_SORTS: Mapping[object, Sort] = {
    _TYPE.Program: "begin",
    _TYPE.Comment: "comment",
    _TYPE.Rule: "rule",
    _TYPE.Definition: "constant",
    _TYPE.Defined: "declaration",
    _TYPE.ShowSignature: "shown",
    _TYPE.ShowTerm: "term",
    _TYPE.Minimize: "cost",
    _TYPE.External: "external",
}


class Pattern(NamedTuple):
    """A term in a rule, as clingo writes it.

    `is_plain` is whether it only takes values apart and computes nothing, `is_constant` whether it
    is one value.
    """

    text: str
    is_plain: bool
    is_constant: bool
    variables: frozenset[str]

    @property
    def constant(self) -> str | None:
        """Return the text of the term if it is one value, else None."""
        return self.text if self.is_constant else None


class Literal(NamedTuple):
    """A literal of a predicate; `binds` is whether only its true instances matter.

    This holds for positive literals, except before a condition: `p(X) : q(X)` fails for a true
    `q(X)` without `p(X)`.
    """

    signature: Signature
    terms: tuple[Pattern, ...]
    binds: bool
    place: Place

    @property
    def text(self) -> str:
        """Return the literal as clingo formats it, without `not`."""
        inside = ",".join([term.text for term in self.terms])
        return f"{self.signature.signed}({inside})" if inside else self.signature.signed


class Scope(NamedTuple):
    """Literals that share their variables: the positive ones, which bind them, and the others."""

    positive: tuple[Literal, ...]
    others: tuple[Literal, ...] = ()

    @property
    def literals(self) -> tuple[Literal, ...]:
        """Return all literals of the scope."""
        return (*self.positive, *self.others)


class Head(NamedTuple):
    """An atom that a head may derive, and the condition on it."""

    literal: Literal
    condition: Scope


@dataclass(frozen=True)
class Statement:
    """A rule, constraint or cost without pools.

    `written` are the texts of the head, or of the weight of a cost, and of each literal of the
    body; `place` is where the head begins. `inner` are the elements of aggregates and conditions in
    its body.

    `forces` is whether it forces one atom, `offers` whether it may leave its atoms out. `level` is
    the priority of a cost, None for rules and constraints.
    """

    written: tuple[str, ...]
    place: Place
    heads: tuple[Head, ...]
    body: Scope
    inner: tuple[Scope, ...]
    forces: bool
    offers: bool
    level: str | None

    @property
    def text(self) -> str:
        """Return the text of a rule or constraint as clingo writes it."""
        head, *body = self.written
        return f"{head} :- {'; '.join(body)}." if body else f"{head}."

    @property
    def head(self) -> Literal:
        """Return the literal of the only atom in the head."""
        return self.heads[0].literal

    @cached_property
    def derives(self) -> frozenset[Signature]:
        """Return the predicates of its head."""
        return frozenset(head.literal.signature for head in self.heads)

    @property
    def literals(self) -> tuple[Literal, ...]:
        """Return all literals that name a predicate."""
        return (*(head.literal for head in self.heads), *self.read)

    @property
    def read(self) -> tuple[Literal, ...]:
        """Return the literals of its body and conditions."""
        scopes = (self.body, *self.inner, *(head.condition for head in self.heads))
        return tuple(literal for scope in scopes for literal in scope.literals)

    @cached_property
    def reads(self) -> frozenset[Signature]:
        """Return the predicates of its body and conditions."""
        return frozenset(literal.signature for literal in self.read)


class Number(NamedTuple):
    """A number in a rule as written, even if it exceeds the range of clingo."""

    value: int
    place: Place


class Operation(NamedTuple):
    """A sum, a product or another operation in a rule."""

    sign: str
    operands: "tuple[Operand, ...]"
    text: str
    place: Place


#: What is computed with: numbers, operations, and anything else, such as a variable, as written.
Operand: TypeAlias = "Number | Operation | str"


class Constants(NamedTuple):
    """The names of constants and functions in a rule, and its strings."""

    names: frozenset[str]
    strings: frozenset[str]


class Piece(NamedTuple):
    """A comment, rule or other statement of a file: its text, and where it begins and ends."""

    sort: Sort
    text: str
    begin: Place
    end: Place


class ProgramPart(NamedTuple):
    """A part of a program, by its name and parameters."""

    name: str
    parameters: tuple[str, ...] = ()

    def __str__(self) -> str:
        """Return the part as `#program` names it."""
        inside = ",".join(self.parameters)
        return f"{self.name}({inside})" if inside else self.name


class RuleSyntaxError(Exception):
    """A text cannot be read as rules; `notes` are the messages of clingo."""

    def __init__(self, notes: Sequence[str]) -> None:
        """Keep the messages of clingo."""
        super().__init__(*notes)
        self.notes = notes


# ---- Texts ---------------------------------------------------------------------------------------


@lru_cache(maxsize=_MOST)
def statements(text: str) -> tuple[Statement, ...]:
    """Return the variants of a rule without pools."""
    return memoized("statements", FILES, [text], _statements)[text]


def statements_of(texts: Iterable[str]) -> dict[str, tuple[Statement, ...]]:
    """Return the variants of each of some rules without pools, by their texts."""
    return {text: statements(text) for text in texts}


def _statements(text: str) -> tuple[Statement, ...]:
    place = places(text)
    return tuple(_statement(node, place) for node in variants(text))


def constants_of(texts: Iterable[str]) -> dict[str, Constants]:
    """Return the constants and strings of each of some rules, by their texts."""
    return memoized("constants", FILES, texts, constants)


def constants(text: str) -> Constants:
    """Return the constants and strings of a rule."""
    names, strings = set(), set()
    for node in below(written(text)):
        if node.ast_type == _TYPE.Function:
            names.add(node.name)
        elif node.ast_type == _TYPE.SymbolicTerm:
            if node.symbol.type == SymbolType.Function:
                names.add(node.symbol.name)
            elif node.symbol.type == SymbolType.String:
                strings.add(node.symbol.string)
    return Constants(frozenset(names), frozenset(strings))


def bound_variables(text: str) -> frozenset[str]:
    """Return the variables outside of aggregates and negated literals of a rule's body."""
    found: set[str] = set()
    for literal in written(text).body:
        if literal.ast_type is not _TYPE.Literal or literal.sign != ast.Sign.NoSign:
            continue
        if literal.atom.ast_type in WITH_ELEMENTS:
            guards = guards_of(literal.atom)
            found.update(*(names_in(each.term) for each in guards if each.comparison == _EQUAL))
        else:
            found |= names_in(literal)
    return frozenset(found)


def refusals(text: str) -> list[str] | None:
    """Return clingo's messages about a text that it refuses, or None if it takes all rules.

    Nothing is grounded.
    """
    notes: list[str] = []
    control = clingo.Control(["--warn=none"], lambda _, note: notes.append(note))
    try:
        # Clingo's columns count bytes, and it cuts its messages between them.
        control.add("base", [], masked(text))
        control.ground([("nothing", [])])
    except RuntimeError:
        return notes
    return None


def argument_place(text: str, variant: int, at: int) -> Place:
    """Return the begin of argument `at` (from 0) in the head of a rule's variant."""
    return places(text)(variants(text)[variant].head.atom.symbol.arguments[at])


def masked(text: str) -> str:
    """Return a text in which each non-ASCII character is one byte, as clingo counts bytes."""
    return _NOT_ASCII.sub("`", text)


def pieces(text: str) -> Iterator[Piece]:
    """Yield the comments, rules and other statements of a text, in order.

    Raises:
        RuleSyntaxError: clingo cannot parse it, or a rule has another meaning by itself.
    """
    try:
        nodes = _file(masked(text))
    except RuntimeError:
        notes: list[str] = []
        with suppress(RuntimeError):
            parsed(masked(text), notes.append)
        raise RuleSyntaxError(notes) from None
    # Clingo ends lines at LF alone; comments and strings may contain other ends.
    lines = text.split("\n")
    for node in nodes:
        line, column, end_line, end = extent_of(node)
        written = lines[line - 1 : end_line]
        written[-1] = written[-1][: end - 1]
        written[0] = written[0][column - 1 :]
        piece = "\n".join(written)
        sort = _SORTS.get(node.ast_type, "other")
        if sort == "rule" and not _says(piece, node):
            place = f"<string>:{line}:{column}"
            raise RuleSyntaxError(
                [f"{place}: error: this rule cannot be separated from its neighbours"]
            )
        yield Piece(sort, piece, (line, column), (end_line, end))


def _says(piece: str, node: ast.AST) -> bool:
    """Whether a text, read alone, is exactly the rule `node`."""
    try:
        return bool(tree(masked(piece)) == node)
    except (RuntimeError, ValueError):
        return False


def _of_kind(text: str, mark: str, kind: ast.ASTType) -> Iterator[ast.AST]:
    """Yield clingo's trees of the statements of one kind, which all contain the text `mark`."""
    if mark in text:
        yield from (node for node in _file(text) if node.ast_type == kind)


def defined(text: str) -> set[Signature]:
    """Return the predicates that `#defined` statements of a text declare, without signs."""
    return {signature for signature, _ in defined_at(text)}


def defined_at(text: str) -> Iterator[tuple[Signature, Place]]:
    """Yield each predicate in a `#defined` statement with its location."""
    place = places(text)
    for each in _of_kind(text, "#defined", _TYPE.Defined):
        yield Signature(each.name, each.arity), place(each)


@lru_cache(maxsize=_MOST)
def shown(text: str) -> tuple[Signature, ...]:
    """Return the predicates in the `#show` statements of a text."""
    nodes = _of_kind(text, "#show", _TYPE.ShowSignature)
    return tuple(Signature(node.name, node.arity, bool(node.positive)) for node in nodes)


def costs(text: str) -> tuple[Statement, ...]:
    """Return each minimised or maximised element, and each weak constraint, of a text."""
    if _COST.search(text) is None:
        return ()
    place = places(text)
    nodes = _of_kind(text, "", _TYPE.Minimize)
    return tuple(_statement(plain(each), place) for node in nodes for each in node.unpool())


@lru_cache(maxsize=_MOST)
def read_by_costs(text: str) -> frozenset[Signature]:
    """Return the predicates, without signs, that the costs of a text read."""
    return frozenset(each.unsigned for statement in costs(text) for each in statement.reads)


def _named_constants(text: str) -> Iterator[SyntaxNode]:
    """Yield the nodes of constants such as `a` in a text, not numbers or strings."""
    for one in parsed(text):
        for node in below(plain(one)):
            if node.ast_type is _TYPE.SymbolicTerm and node.symbol.type == SymbolType.Function:
                yield node


def constant_names(text: str) -> frozenset[str]:
    """Return the names of the constants in a text, which `#const` would replace."""
    return frozenset(node.symbol.name for node in _named_constants(text))


def calls(text: str) -> tuple[tuple[Place, str], ...]:
    """Return place and name of each external function (`@f`) that a rule calls."""
    if "@" not in text:
        return ()
    place = places(text)
    found = (node for node in below(written(text)) if node.ast_type == _TYPE.Function)
    return tuple((place(node), node.name) for node in found if node.external)


def head_pool(text: str) -> Place | None:
    """Return the location of a pool in the head of a rule, or None without one."""
    found = (node for node in below(written(text).head) if node.ast_type == _TYPE.Pool)
    return next(map(places(text), found), None)


def renamed(text: str, names: Mapping[Signature, str]) -> str:
    """Return a text in which the predicates in `names` are renamed; all else stays as written."""
    found: list[tuple[Place, str, str]] = []
    for node in parsed(masked(text)):
        if node.ast_type in (_TYPE.ShowSignature, _TYPE.Defined):
            new = names.get(Signature(node.name, node.arity))
            if new is not None:
                found.append((_start_of(node), node.name, new))
        for each in below(plain(node)):
            if each.ast_type == _TYPE.SymbolicAtom:
                _, symbol = sign_and_function(each.symbol)
                variants = symbol.arguments if symbol.ast_type == _TYPE.Pool else (symbol,)
                for one in variants:
                    new = names.get(Signature(one.name, len(one.arguments)))
                    if new is not None:
                        found.append((_start_of(one), one.name, new))
    return _edited(text, found)


def _edited(text: str, edits: Iterable[tuple[Place, str, str]]) -> str:
    """Return a text with edits (place, old, new): the first `old` from the place on is replaced."""
    lines = text.split("\n")
    # From the end, so that earlier locations stay valid.
    for (line, column), old, new in sorted(set(edits), reverse=True):
        written = lines[line - 1]
        at = written.find(old, column - 1)
        lines[line - 1] = f"{written[:at]}{new}{written[at + len(old) :]}"
    return "\n".join(lines)


def _start_of(node: SyntaxNode | ast.AST) -> Place:
    line, column, _, _ = extent_of(node)
    return line, column


@lru_cache(maxsize=_MOST)
def rule_operands(text: str) -> tuple[Operand, ...]:
    """Return `operands` of a rule, memoized for several callers."""
    return operands(text)


def operands(text: str) -> tuple[Operand, ...]:
    """Return the numbers and operations of a text that are not inside another operation.

    Of one without any operation, small numbers are left out.
    """
    if not _may_compute(text):
        return ()
    reader = ArithmeticReader(text)
    read = (node for node in _file(text) if node.ast_type not in _SILENT)
    nodes = (node for node in read if reader.may_compute(node))
    return tuple(operand for node in nodes for operand in reader.outermost(plain(node)))


def definitions(text: str) -> dict[str, Operand]:
    """Return the values that the `#const` statements of a text give constants."""
    reader = ArithmeticReader(text)
    nodes = _of_kind(text, "#const", _TYPE.Definition)
    return {str(node.name): reader.operand(plain(node.value), []) for node in nodes}


def replaced(text: str) -> set[str]:
    """Return the names of the constants that the text defines by `#const`."""
    return {str(node.name) for node in _of_kind(text, "#const", _TYPE.Definition)}


def part_of(text: str) -> tuple[str, tuple[str, ...]]:
    """Return name and parameters of a `#program` statement."""
    node = parsed(text)[-1]
    return node.name, tuple(each.name for each in node.parameters)


def with_constants(text: str, values: Mapping[str, str]) -> str:
    """Return the text of a statement in which constants are replaced by terms."""
    place = places(text)
    # In brackets, `-k` of a negative number is neither a comment nor another operator.
    terms = {name: f"({term})" if term.startswith("-") else term for name, term in values.items()}
    return _edited(
        text,
        (
            (place(node), node.symbol.name, terms[node.symbol.name])
            for node in _named_constants(text)
            if not node.symbol.arguments and node.symbol.name in terms
        ),
    )


def external_of(text: str) -> Iterator[tuple[str, str, str]]:
    """Yield the atoms, the body and the value of each `#external` statement of a text."""
    for node in _of_kind(text, "#external", _TYPE.External):
        yield str(node.atom), "; ".join(map(str, node.body)), str(node.external_type)


def without_rules(text: str) -> str:
    """Return a text without its rules and comments."""
    silent = (_TYPE.Program, _TYPE.Comment, _TYPE.Rule)
    return "\n".join(str(node) for node in parsed(text) if node.ast_type not in silent)


# ---- Trees ---------------------------------------------------------------------------------------


def parsed(text: str, note: Callable[[str], None] | None = None) -> list[ast.AST]:
    """Return clingo's trees of a text; `note` receives its messages.

    Raises:
        RuntimeError: clingo cannot parse it.
    """
    found: list[ast.AST] = []

    def logger(_: object, message: str) -> None:
        if note is not None:
            note(message)

    if not text.isascii():
        # Clingo may cut its messages within a character, which its Python package cannot decode.
        ast.parse_string(masked(text), lambda _: None, logger=logger)
    ast.parse_string(text, found.append, logger=logger)
    return found


@lru_cache(maxsize=1)
def _file(text: str) -> tuple[ast.AST, ...]:
    """Return clingo's trees of a file, cached because several functions read it in turn."""
    return tuple(parsed(text))


@lru_cache(maxsize=_MOST)
def tree(text: str) -> ast.AST:
    """Return clingo's tree of the text of a rule, which may have comments beside it.

    Raises:
        RuntimeError: clingo cannot parse it.
        ValueError: it is more, or less, than a rule.
    """
    # First is where a file would begin.
    _, *found = parsed(text)
    (rule,) = found if len(found) == 1 else (n for n in found if n.ast_type != _TYPE.Comment)
    return rule


@lru_cache(maxsize=_MOST)
def written(text: str) -> SyntaxNode:
    """Return the tree of a rule as it is written, with its pools."""
    return plain(tree(text))


@lru_cache(maxsize=_MOST)
def variants(text: str) -> tuple[SyntaxNode, ...]:
    """Return the trees of the rules to which a rule with pools expands, else only its own tree."""
    node = written(text)
    # A pool needs a semicolon.
    if ";" not in text or all(each.ast_type != _TYPE.Pool for each in below(node)):
        return (node,)
    return tuple(map(plain, tree(text).unpool()))


def literal_of(text: str) -> SyntaxNode:
    """Return the tree of the text of a body's literal."""
    literal: SyntaxNode = written(f"x :- {text}.").body[0]
    return literal


def term_of(text: str) -> SyntaxNode:
    """Return the tree of the text of a term."""
    term: SyntaxNode = literal_of(f"{text} = 0").atom.term
    return term


_Tree = TypeVar("_Tree", ast.AST, SyntaxNode)


def sign_and_function(symbol: _Tree) -> tuple[str, _Tree]:
    """Return `-` or "" for classical negation, and the atom without it."""
    sign = ""
    while symbol.ast_type == _TYPE.UnaryOperation:
        sign, symbol = "" if sign else "-", symbol.argument
    return sign, symbol


def places(text: str) -> Callable[..., Place]:
    """Return a function from a node to the place of its begin (with `end`, its end) in a text.

    Places count characters, whereas clingo counts bytes.
    """
    lines = None if text.isascii() else [line.encode() for line in text.split("\n")]

    def place(node: SyntaxNode | ast.AST, end: bool = False) -> Place:
        line, column = extent_of(node)[2 * end :][:2]
        if lines is None:
            return line, column
        return line, len(lines[line - 1][: column - 1].decode(errors="ignore")) + 1

    return place


def _may_compute(text: str) -> bool:
    return _COMPUTING.search(text.replace(":-", "")) is not None


def _statement(node: SyntaxNode, place: Callable[[SyntaxNode], Place]) -> Statement:
    reader = _StatementReader(place)
    read = [(each, reader.literal(each) if _is_symbolic(each) else None) for each in node.body]
    heads, where, level, forces, offers = list[Head](), node, None, False, False
    if node.ast_type is _TYPE.Minimize:
        head, level = str(node.weight), str(node.priority)
    else:
        where, heads = node.head, list(reader.heads(node.head))
        forces = _is_symbolic(where) and where.sign == ast.Sign.NoSign
        offers = where.ast_type in (_TYPE.Aggregate, _TYPE.HeadAggregate)
        head = heads[0].literal.text if forces else str(where)
    body = (
        str(each) if found is None else f"{_SIGNS[each.sign]}{found.text}" for each, found in read
    )
    return Statement(
        (head, *body),
        place(where),
        tuple(heads),
        _scope(found for _, found in read if found is not None),
        tuple(scope for each in node.body for scope in reader.inner_scopes(atom_of(each))),
        forces,
        offers,
        level,
    )


class _StatementReader:
    """Reads the literals of a statement."""

    def __init__(self, place: Callable[[SyntaxNode], Place]) -> None:
        self._place = place

    def heads(self, head: SyntaxNode) -> Iterator[Head]:
        """Yield the atoms that a head may derive."""
        for (*_, literal), condition in elements_of(head):
            if _is_symbolic(literal):
                yield Head(self.literal(literal), self._scope(condition))

    def inner_scopes(self, atom: SyntaxNode) -> Iterator[Scope]:
        """Yield the literals of each element of an aggregate, or of a conditional literal."""
        for entries, condition in elements_of(atom):
            if atom.ast_type is _TYPE.ConditionalLiteral:
                scope = self._scope(condition)
                then = [self.literal(each) for each in entries if _is_symbolic(each)]
                others = (*scope.others, *(each._replace(binds=False) for each in then))
                yield Scope(scope.positive, others)
            else:
                # The terms of a tuple are not literals.
                yield self._scope((*condition, *entries))

    def _scope(self, literals: Iterable[SyntaxNode]) -> Scope:
        return _scope(self.literal(literal) for literal in literals if _is_symbolic(literal))

    def literal(self, literal: SyntaxNode) -> Literal:
        """Return a literal of clingo's syntax tree, an atom with its sign, as a `Literal`."""
        sign, symbol = sign_and_function(literal.atom.symbol)
        terms = tuple(map(_term, symbol.arguments))
        binds = literal.sign == ast.Sign.NoSign
        return Literal(
            Signature(symbol.name, len(terms), not sign), terms, binds, self._place(symbol)
        )


def _scope(literals: Iterable[Literal]) -> Scope:
    found = tuple(literals)
    positive = tuple(literal for literal in found if literal.binds)
    return Scope(positive, tuple(literal for literal in found if not literal.binds))


def _is_symbolic(literal: SyntaxNode) -> bool:
    return literal.ast_type == _TYPE.Literal and literal.atom.ast_type == _TYPE.SymbolicAtom


def _term(term: SyntaxNode) -> Pattern:
    kind = term.ast_type
    if kind == _TYPE.Variable:
        return _variable(term.name)
    if kind == _TYPE.SymbolicTerm:
        return Pattern(str(term), True, True, _NONE)
    if kind != _TYPE.Function or term.external:
        return Pattern(str(term), False, False, _NONE)
    inside = tuple(map(_term, term.arguments))
    listed = ",".join([each.text for each in inside])
    # A tuple of one has a comma, and a name without arguments no brackets.
    more = "," if len(inside) == 1 and not term.name else ""
    text = f"{term.name}({listed}{more})" if inside or not term.name else term.name
    is_plain = all(each.is_plain for each in inside)
    variables = _NONE.union(*(each.variables for each in inside)) if is_plain else _NONE
    is_constant = all(each.is_constant for each in inside)
    return Pattern(text, is_plain, is_constant, variables)


@lru_cache(maxsize=1024)
def _variable(name: str) -> Pattern:
    if name == "_":
        return Pattern(name, True, False, _NONE)
    return Pattern(name, True, False, frozenset((name,)))


class ArithmeticReader:
    """Reads the numbers and operations of a text."""

    def __init__(self, text: str) -> None:
        self._lines = text.encode().split(b"\n")
        #: Where a node of the tree begins.
        self.place = places(text)

    def may_compute(self, node: ast.AST) -> bool:
        """Whether the lines of a node contain any sign of arithmetic."""
        line, _, end, _ = extent_of(node)
        return _may_compute(b"\n".join(self._lines[line - 1 : end]).decode(errors="replace"))

    def outermost(self, node: SyntaxNode) -> Iterator[Number | Operation]:
        """Yield the numbers and operations of a tree that are not inside another operation."""
        rest = list(node.children)
        if node.ast_type in _OPERANDS:
            rest.clear()
            operand = self.operand(node, rest)
            if isinstance(operand, Number | Operation):
                yield operand
        for child in rest:
            yield from self.outermost(child)

    def operand(self, node: SyntaxNode, rest: list[SyntaxNode]) -> Operand:
        """Return a node as an operand; add nodes below terms to `rest`."""
        match node.ast_type:
            case _TYPE.SymbolicTerm if node.symbol.type == SymbolType.Number:
                return Number(self._number(node), self.place(node))
            case _TYPE.BinaryOperation:
                sign, inside = OPERATIONS[node.operator_type], [node.left, node.right]
            case _TYPE.UnaryOperation if node.argument.ast_type not in _COMPOUND:
                sign, inside = UNARY_OPERATIONS[node.operator_type], [node.argument]
            case _:
                rest += node.children
                return str(node)
        operands = tuple(self.operand(each, rest) for each in inside)
        return Operation(sign, operands, self._source_text(node), self.place(node))

    def _source_text(self, node: SyntaxNode) -> str:
        """Return a node's source text, as clingo changes numbers that do not fit."""
        line, column, end_line, end = extent_of(node)
        if line != end_line:
            return str(node)
        return str(self._lines[line - 1][column - 1 : end - 1], "utf-8")

    def _number(self, node: SyntaxNode) -> int:
        written = self._source_text(node)
        try:
            return int(written, 0)
        except ValueError:
            # Python reads no more than some thousand digits.
            return 10**20 if written.isdecimal() else int(node.symbol.number)
