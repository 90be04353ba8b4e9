"""Mutants of Python modules, made through `ast`."""

import ast
import copy
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from types import CodeType
from typing import TypeAlias

from mars_asp.asp.cases.mutants import Mutant
from tests.support.documents import ROOT

_FLIPPED: dict[type[ast.cmpop], tuple[type[ast.cmpop], ...]] = {
    ast.Lt: (ast.LtE, ast.Gt),
    ast.LtE: (ast.Lt, ast.GtE),
    ast.Gt: (ast.GtE, ast.Lt),
    ast.GtE: (ast.Gt, ast.LtE),
    ast.Eq: (ast.NotEq,),
    ast.NotEq: (ast.Eq,),
    ast.In: (ast.NotIn,),
    ast.NotIn: (ast.In,),
    ast.Is: (ast.IsNot,),
    ast.IsNot: (ast.Is,),
}
_SWAPPED = {"min": "max", "max": "min"}
_BODIES = ("body", "orelse", "finalbody", "handlers", "cases")
#: Integers beyond are ids and limits of machines, not counts.
_SMALL = 1000


@dataclass(frozen=True)
class _Slot:
    """The position of a node: in a field of its parent, in a list at `index`."""

    parent: ast.AST
    field: str
    index: int | None

    def get(self) -> ast.AST:
        held = getattr(self.parent, self.field)
        found: ast.AST = held if self.index is None else held[self.index]
        return found

    def put(self, node: ast.AST) -> None:
        if self.index is None:
            setattr(self.parent, self.field, node)
        else:
            getattr(self.parent, self.field)[self.index] = node


#: The new node of a slot, and the text of the change.
_Change: TypeAlias = tuple[ast.AST, str]


def python_mutants(path: str) -> Iterator[Mutant]:
    """Yield the mutants of a module, given by its path in the repository."""
    for mutant, _ in _mutated(path):
        yield mutant


def compiled_mutants(path: str) -> Iterator[tuple[Mutant, CodeType, CodeType | None]]:
    """Yield the mutants of a module, compiled, its lines where they were.

    The last element is the changed statement alone, if it is at the top level of the module and
    neither a function nor a class; otherwise None.
    """
    for mutant, tree in _mutated(path):
        ast.fix_missing_locations(tree)
        (around,) = (s for s in tree.body if s.lineno <= mutant.line <= (s.end_lineno or s.lineno))
        alone = None
        if not isinstance(around, ast.FunctionDef | ast.ClassDef):
            alone = compile(ast.Module([around], []), path, "exec")
        yield mutant, compile(tree, path, "exec"), alone


def noting_module(path: str, noted: str) -> CodeType:
    """Return a module that calls `noted` with the line of each statement that it is about to run.

    Only statements in functions are noted.
    """
    tree = ast.parse((ROOT / path).read_text(encoding="utf-8"))
    for node in list(ast.walk(tree)):
        if isinstance(node, ast.Module | ast.ClassDef):
            continue
        for field in _BODIES:
            held = getattr(node, field, None)
            if isinstance(held, list) and held and isinstance(held[0], ast.stmt):
                setattr(node, field, [each for s in held for each in (_note(s, noted), s)])
    return compile(ast.fix_missing_locations(tree), path, "exec")


def _note(statement: ast.stmt, noted: str) -> ast.stmt:
    call = ast.Call(ast.Name(noted, ast.Load()), [ast.Constant(statement.lineno)], [])
    return ast.copy_location(ast.Expr(call), statement)


def _mutated(path: str) -> Iterator[tuple[Mutant, ast.Module]]:
    """Yield each mutant while the tree that comes with it is changed."""
    tree = ast.parse((ROOT / path).read_text(encoding="utf-8"))
    seen: Counter[tuple[str, str]] = Counter()
    for place, (scope, around, slot) in enumerate(list(_slots(tree, "", None))):
        old, before = slot.get(), f"{scope}: {_header(around.get())}"
        line: int = getattr(around.get(), "lineno", 1)
        for new, change in list(_changes(old, slot)):
            slot.put(new)
            after = "" if isinstance(new, ast.Pass) else f"{scope}: {_header(around.get())}"
            if after != before:
                seen[before, after] += 1
                number = seen[before, after]
                which = before if number == 1 else f"{before}  # {number}"
                yield Mutant(path, line, change, which, after, place), tree
            slot.put(old)


def _slots(
    node: ast.AST, scope: str, statement: _Slot | None
) -> Iterator[tuple[str, _Slot, _Slot]]:
    """Yield every slot below a node, with the function it is in and the statement around it."""
    for field, value in ast.iter_fields(node):
        if field in ("annotation", "returns", "decorator_list"):
            continue
        children = list(enumerate(value)) if isinstance(value, list) else [(None, value)]
        for index, child in children:
            if not isinstance(child, ast.AST):
                continue
            slot = _Slot(node, field, index)
            around = slot if isinstance(child, ast.stmt) or statement is None else statement
            inner = scope
            if isinstance(child, ast.FunctionDef | ast.ClassDef | ast.AsyncFunctionDef):
                inner = f"{scope}.{child.name}".lstrip(".")
            yield inner, around, slot
            yield from _slots(child, inner, around)


def _changes(node: ast.AST, slot: _Slot) -> Iterator[_Change]:
    if isinstance(node, ast.Compare):
        for index, sign in enumerate(node.ops):
            for other in _FLIPPED[type(sign)]:
                ops = [*node.ops[:index], other(), *node.ops[index + 1 :]]
                yield ast.Compare(node.left, ops, node.comparators), "flip a comparison"
    elif isinstance(node, ast.BoolOp):
        for index, value in enumerate(node.values):
            rest = node.values[:index] + node.values[index + 1 :]
            new = rest[0] if len(rest) == 1 else ast.BoolOp(node.op, rest)
            yield new, f"drop `{ast.unparse(value)}`"
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not):
        yield node.operand, "drop `not`"
    elif isinstance(node, ast.Name) and node.id in _SWAPPED and isinstance(node.ctx, ast.Load):
        yield ast.Name(_SWAPPED[node.id], node.ctx), "swap min and max"
    elif isinstance(node, ast.Constant) and type(node.value) is int and node.value <= _SMALL:
        yield ast.Constant(node.value + 1), f"constant {node.value} -> {node.value + 1}"
    elif isinstance(node, ast.comprehension):
        for index, condition in enumerate(node.ifs):
            rest = node.ifs[:index] + node.ifs[index + 1 :]
            loop = ast.comprehension(node.target, node.iter, rest, node.is_async)
            yield loop, f"drop `if {ast.unparse(condition)}`"
    elif isinstance(node, ast.stmt) and isinstance(slot.parent, ast.If | ast.For | ast.While):
        if not isinstance(node, ast.Pass):
            yield ast.Pass(), "drop the statement"


def _header(node: ast.AST) -> str:
    """Return a statement as text, of one that holds others its first lines alone."""
    if not any(hasattr(node, field) for field in _BODIES) or isinstance(node, ast.expr):
        return ast.unparse(node)
    alone = copy.copy(node)
    for field in _BODIES:
        if hasattr(alone, field):
            setattr(alone, field, [])
    if isinstance(alone, ast.Try):
        return "try"
    return ast.unparse(alone)
