"""Mutants of rule files: small changes of syntax trees, which cases must notice."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from hashlib import sha256
from itertools import accumulate
from typing import TypeAlias

import clingo

from mars_asp.asp.cases.probes import is_safe
from mars_asp.asp.rules.statements import parsed, term_of
from mars_asp.asp.rules.trees import (
    COMPARISONS,
    FUNCTIONS,
    Kind,
    Sign,
    SyntaxNode,
    extent_of,
    plain,
)

#: A changed node, and a description of the change.
_Variant: TypeAlias = tuple[SyntaxNode, str]

_FLIPPED = {
    "<": ("<=", ">"),
    "<=": ("<", ">="),
    ">": (">=", "<"),
    ">=": (">", "<="),
    "=": ("!=",),
    "!=": ("=",),
}
_SWAPPED = {"min": "max", "max": "min"}
_MINIMIZE, _MINIMIZED = "#minimize { ", " }."
_TUPLES = (Kind.BodyAggregateElement, Kind.Minimize)
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

    tree: SyntaxNode
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
        minimised = old.tree.ast_type == Kind.Minimize
        after = mutant.after
        new = after.removeprefix(_MINIMIZE).removesuffix(_MINIMIZED) if minimised else after
        changed = new.encode() + b"\n" * lines
        return (self.content[: old.begin] + changed + self.content[old.end :]).decode()


def rule_file(path: str, stage: str, content: bytes) -> MutatedFile:
    """Return a file of rules with the statements that can be mutated."""
    starts = [0]
    starts += accumulate(len(line) + 1 for line in content.split(b"\n"))
    # Columns count bytes in clingo.
    trees = map(plain, parsed(content.decode("latin-1").encode("ascii", "replace").decode()))
    statements: list[MutatedStatement] = []
    for tree in trees:
        if tree.ast_type in (Kind.Rule, Kind.Minimize):
            line, column, end_line, end = extent_of(tree)
            places = (starts[line - 1] + column - 1, starts[end_line - 1] + end - 1)
            statements.append(MutatedStatement(tree, line, *places))
    return MutatedFile(path, stage, content, tuple(statements))


def written(tree: SyntaxNode) -> str:
    """Return a statement as text; minimise statements have one fixed form."""
    if tree.ast_type != Kind.Minimize:
        return str(tree)
    terms = ",".join([f"{tree.weight}@{tree.priority}", *map(str, tree.terms)])
    return f"{_MINIMIZE}{terms}: {', '.join(map(str, tree.body))}{_MINIMIZED}"


def rule_mutants(file: MutatedFile) -> Iterator[Mutant]:
    """Yield the mutants of a file, without texts that do not parse or are unsafe."""
    costs = (each.tree for each in file.statements if each.tree.ast_type == Kind.Minimize)
    levels = sorted({level for level in map(_level, costs) if level is not None})
    for place, statement in enumerate(file.statements):
        before = statement.text
        seen = {before}
        variants = [*_variants(statement.tree, False), *_of_cost(statement.tree, levels)]
        changes = [("delete", ""), *((change, written(tree)) for tree, change in variants)]
        for change, after in changes:
            if after not in seen and _is_safe(after):
                seen.add(after)
                yield Mutant(file.path, statement.line, change, before, after, place)


def _level(tree: SyntaxNode) -> int | None:
    """Return the level of a minimise statement, or None if it is a variable."""
    try:
        return clingo.parse_term(str(tree.priority), lambda *_: None).number
    except RuntimeError:
        return None


def _of_cost(tree: SyntaxNode, levels: Sequence[int]) -> Iterator[_Variant]:
    """Yield the variants of a minimise statement: another level, weight or direction."""
    if tree.ast_type != Kind.Minimize:
        return
    level = _level(tree)
    if level is not None:
        place = levels.index(level)
        for other in (*levels[max(0, place - 1) : place], *levels[place + 1 : place + 2]):
            yield tree.updated(priority=term_of(str(other))), f"level {level} -> {other}"
    negated = term_of("-X").updated(argument=tree.weight)
    yield tree.updated(weight=negated), "#minimize -> #maximize"
    if tree.weight.ast_type != Kind.SymbolicTerm:
        yield tree.updated(weight=term_of("1")), f"weight {tree.weight} -> 1"


def _variants(node: SyntaxNode, in_body: bool) -> Iterator[_Variant]:
    """Yield each variant of a tree with one change; `in_body` is whether it is in a body."""
    yield from _own(node, in_body)
    for key, child in node.parts:
        below = in_body or key in _CONDITIONS
        if key == "priority":
            continue
        if isinstance(child, SyntaxNode):
            for tree, change in _variants(child, below):
                yield node.updated(**{key: tree}), change
        else:
            yield from _of_sequence(node, key, list(child), below)


def _of_sequence(
    node: SyntaxNode, key: str, nodes: list[SyntaxNode], in_body: bool
) -> Iterator[_Variant]:
    for index, element in enumerate(nodes):
        rest = nodes[:index] + nodes[index + 1 :]
        if key in _CONDITIONS and node.ast_type != Kind.Comparison:
            yield node.updated(**{key: rest}), f"drop `{element}`"
        elif (
            key == "terms" and (rest or node.ast_type == Kind.Minimize) and node.ast_type in _TUPLES
        ):
            yield node.updated(**{key: rest}), f"drop `{element}` of the tuple"
        elif key == "elements" and rest:
            yield node.updated(**{key: rest}), f"drop `{element}`"
        for tree, change in _variants(element, in_body):
            yield node.updated(**{key: [*nodes[:index], tree, *nodes[index + 1 :]]}), change


def _own(node: SyntaxNode, in_body: bool) -> Iterator[_Variant]:
    if node.ast_type == Kind.Literal and in_body:
        yield from _negated(node)
    elif node.ast_type == Kind.Guard:
        others = _FLIPPED[COMPARISONS[node.comparison]]
        # A number one greater or smaller is tried by changing the number.
        for sign in others[1:] if _is_number(node.term) and len(others) > 1 else others:
            new = node.updated(comparison=COMPARISONS.index(sign))
            yield new, f"flip `{_guard(node)}` -> `{_guard(new)}`"
    elif _is_number(node):
        for number in (node.symbol.number + 1, node.symbol.number - 1):
            if -(1 << 31) <= number < 1 << 31:
                new = node.updated(symbol=clingo.Number(number))
                yield new, f"constant {node} -> {new}"
    elif node.ast_type == Kind.BodyAggregate and FUNCTIONS[node.function] in _SWAPPED:
        other = FUNCTIONS.index(_SWAPPED[FUNCTIONS[node.function]])
        yield node.updated(function=other), "swap #min and #max"


def _is_number(node: SyntaxNode) -> bool:
    return node.ast_type == Kind.SymbolicTerm and node.symbol.type == clingo.SymbolType.Number


def _negated(literal: SyntaxNode) -> Iterator[_Variant]:
    if literal.atom.ast_type in (Kind.Comparison, Kind.BooleanConstant):
        return
    other = Sign.Negation if literal.sign == Sign.NoSign else Sign.NoSign
    new = literal.updated(sign=int(other))
    yield new, f"`{literal}` -> `{new}`"


def _guard(guard: SyntaxNode) -> str:
    return f"{COMPARISONS[guard.comparison]} {guard.term}"
