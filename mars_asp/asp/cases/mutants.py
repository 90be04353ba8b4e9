"""Mutants of rule files: small changes of syntax trees, which cases must notice."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from hashlib import sha256
from typing import TypeAlias

import clingo
from clingo import ast

from mars_asp.asp.cases.probes import is_safe
from mars_asp.asp.rules.trees import COMPARISONS

_TYPE = ast.ASTType
_SIGN = ast.Sign
_IS = ast.ComparisonOperator
#: A changed node, and a description of the change.
_Variant: TypeAlias = tuple[ast.AST, str]

_FLIPPED = {
    _IS.LessThan: (_IS.LessEqual, _IS.GreaterThan),
    _IS.LessEqual: (_IS.LessThan, _IS.GreaterEqual),
    _IS.GreaterThan: (_IS.GreaterEqual, _IS.LessThan),
    _IS.GreaterEqual: (_IS.GreaterThan, _IS.LessEqual),
    _IS.Equal: (_IS.NotEqual,),
    _IS.NotEqual: (_IS.Equal,),
}
_SWAPPED = {
    int(ast.AggregateFunction.Min): ast.AggregateFunction.Max,
    int(ast.AggregateFunction.Max): ast.AggregateFunction.Min,
}
_MINIMIZE, _MINIMIZED = "#minimize { ", " }."
_TUPLES = (_TYPE.BodyAggregateElement, _TYPE.Minimize)
_CONDITIONS = ("body", "condition")
_is_safe = cache(is_safe)


@dataclass(frozen=True, slots=True)
class Mutant:
    """One change of one statement; `before` and `after` are statements in clingo's formatting.

    Attributes:
        path: the file, as it is shown.
        line: the first line of the statement, from 1.
        change: the description of the change, such as "drop `not p(X)`".
        place: the index of the statement in the file's list of statements.
    """

    path: str
    line: int
    change: str
    before: str
    after: str
    place: int

    @property
    def key(self) -> tuple[str, str, str]:
        """Return the key of the mutant, which stays the same if other statements change."""
        return self.path, self.before, self.after

    def __str__(self) -> str:
        return f"{self.path}:{self.line}: {self.change}\n  - {self.before}\n  + {self.after}"


@dataclass(frozen=True, slots=True)
class MutantVerdict:
    """The detection of a mutant: the name of its killer, or None if it survives."""

    mutant: Mutant
    killer: str | None


def drawn(mutants: Iterable[Mutant], number: int, seed: int) -> list[Mutant]:
    """Return `number` random mutants; if mutants are added or removed, most of the choice stays."""
    return sorted(mutants, key=lambda m: sha256(f"{seed} {m.key}".encode()).digest())[:number]


@dataclass(frozen=True)
class MutatedStatement:
    """One statement of a rule file: its tree and the bytes of the file that it takes."""

    tree: ast.AST
    line: int
    begin: int
    end: int

    @property
    def text(self) -> str:
        """Return the statement in clingo's formatting."""
        return written(self.tree)


@dataclass(frozen=True)
class MutatedFile:
    """A rule file as bytes, with the statements that can be mutated."""

    path: str
    stage: str
    content: bytes
    statements: tuple[MutatedStatement, ...]

    def mutated(self, mutant: Mutant) -> str:
        """Return the text of the file with one statement replaced, and all lines in their place."""
        old = self.statements[mutant.place]
        lines = self.content[old.begin : old.end].count(b"\n")
        # The tree of a minimise statement has the span of the element within the braces.
        minimised = old.tree.ast_type == _TYPE.Minimize
        after = mutant.after
        new = after.removeprefix(_MINIMIZE).removesuffix(_MINIMIZED) if minimised else after
        changed = new.encode() + b"\n" * lines
        return (self.content[: old.begin] + changed + self.content[old.end :]).decode()


def rule_file(path: str, stage: str, content: bytes) -> MutatedFile:
    """Return a file of rules with the statements that can be mutated."""
    starts = [0]
    for line in content.split(b"\n"):
        starts.append(starts[-1] + len(line) + 1)
    trees: list[ast.AST] = []
    # Columns count bytes in clingo.
    ast.parse_string(content.decode("latin-1").encode("ascii", "replace").decode(), trees.append)
    statements = tuple(
        MutatedStatement(
            tree,
            tree.location.begin.line,
            starts[tree.location.begin.line - 1] + tree.location.begin.column - 1,
            starts[tree.location.end.line - 1] + tree.location.end.column - 1,
        )
        for tree in trees
        if tree.ast_type in (_TYPE.Rule, _TYPE.Minimize)
    )
    return MutatedFile(path, stage, content, statements)


def written(tree: ast.AST) -> str:
    """Return a statement as text; minimise statements have one fixed form."""
    if tree.ast_type != _TYPE.Minimize:
        return str(tree)
    terms = ",".join([f"{tree.weight}@{tree.priority}", *map(str, tree.terms)])
    return f"{_MINIMIZE}{terms}: {', '.join(map(str, tree.body))}{_MINIMIZED}"


def rule_mutants(file: MutatedFile) -> Iterator[Mutant]:
    """Yield the mutants of a file, without texts that do not parse or are unsafe."""
    levels = sorted({_level(s.tree) for s in file.statements if s.tree.ast_type == _TYPE.Minimize})
    for place, statement in enumerate(file.statements):
        before = statement.text
        seen = {before}
        variants = [*_variants(statement.tree, False), *_of_cost(statement.tree, levels)]
        changes = [("delete", ""), *((change, written(tree)) for tree, change in variants)]
        for change, after in changes:
            if after not in seen and _is_safe(after):
                seen.add(after)
                yield Mutant(file.path, statement.line, change, before, after, place)


def _level(tree: ast.AST) -> int:
    number: int = tree.priority.symbol.number
    return number


def _of_cost(tree: ast.AST, levels: Sequence[int]) -> Iterator[_Variant]:
    """Yield the variants of a minimise statement: another level, weight or direction."""
    if tree.ast_type != _TYPE.Minimize:
        return
    place = levels.index(_level(tree))
    for other in (*levels[max(0, place - 1) : place], *levels[place + 1 : place + 2]):
        symbol = ast.SymbolicTerm(tree.location, clingo.Number(other))
        yield tree.update(priority=symbol), f"level {levels[place]} -> {other}"
    negated = ast.UnaryOperation(tree.location, ast.UnaryOperator.Minus, tree.weight)
    yield tree.update(weight=negated), "#minimize -> #maximize"
    if tree.weight.ast_type != _TYPE.SymbolicTerm:
        one = ast.SymbolicTerm(tree.location, clingo.Number(1))
        yield tree.update(weight=one), f"weight {tree.weight} -> 1"


def _variants(node: ast.AST, in_body: bool) -> Iterator[_Variant]:
    """Yield each variant of a tree with one change; `in_body` is whether it is in a body."""
    yield from _own(node, in_body)
    for key in node.child_keys:
        if key in ("location", "priority"):
            continue
        child = getattr(node, key)
        below = in_body or key in _CONDITIONS
        if isinstance(child, ast.AST):
            for tree, change in _variants(child, below):
                yield node.update(**{key: tree}), change
        elif child is not None:
            yield from _of_sequence(node, key, list(child), below)


def _of_sequence(
    node: ast.AST, key: str, nodes: list[ast.AST], in_body: bool
) -> Iterator[_Variant]:
    for index, element in enumerate(nodes):
        rest = nodes[:index] + nodes[index + 1 :]
        if key in _CONDITIONS and node.ast_type != _TYPE.Comparison:
            yield node.update(**{key: rest}), f"drop `{element}`"
        elif (
            key == "terms"
            and (rest or node.ast_type == _TYPE.Minimize)
            and node.ast_type in _TUPLES
        ):
            yield node.update(**{key: rest}), f"drop `{element}` of the tuple"
        elif key == "elements" and rest:
            yield node.update(**{key: rest}), f"drop `{element}`"
        for tree, change in _variants(element, in_body):
            yield node.update(**{key: [*nodes[:index], tree, *nodes[index + 1 :]]}), change


def _own(node: ast.AST, in_body: bool) -> Iterator[_Variant]:
    if node.ast_type == _TYPE.Literal and in_body:
        yield from _negated(node)
    elif node.ast_type == _TYPE.Guard:
        others = _FLIPPED[ast.ComparisonOperator(node.comparison)]
        # A number one greater or smaller is tried by changing the number.
        for other in others[1:] if _is_number(node.term) and len(others) > 1 else others:
            new = node.update(comparison=int(other))
            yield new, f"flip `{_guard(node)}` -> `{_guard(new)}`"
    elif _is_number(node):
        for number in (node.symbol.number + 1, node.symbol.number - 1):
            if -(1 << 31) <= number < 1 << 31:
                new = node.update(symbol=clingo.Number(number))
                yield new, f"constant {node} -> {new}"
    elif node.ast_type == _TYPE.BodyAggregate and node.function in _SWAPPED:
        yield node.update(function=int(_SWAPPED[node.function])), "swap #min and #max"


def _is_number(node: ast.AST) -> bool:
    return node.ast_type == _TYPE.SymbolicTerm and node.symbol.type == clingo.SymbolType.Number


def _negated(literal: ast.AST) -> Iterator[_Variant]:
    if literal.atom.ast_type in (_TYPE.Comparison, _TYPE.BooleanConstant):
        return
    other = _SIGN.Negation if literal.sign == _SIGN.NoSign else _SIGN.NoSign
    new = literal.update(sign=int(other))
    yield new, f"`{literal}` -> `{new}`"


def _guard(guard: ast.AST) -> str:
    return f"{COMPARISONS[guard.comparison]} {guard.term}"
