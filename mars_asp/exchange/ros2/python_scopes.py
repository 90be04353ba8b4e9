"""Where variables of sources in Python get their values, and which of these may hold at a place.

A function has names of its own, and sees those of the functions around it and of the module. An
assignment holds until the next one that is reached whenever it is, and not in the other branch of a
condition.
"""

import ast
from bisect import bisect_right
from collections.abc import Iterator, Sequence
from itertools import zip_longest
from typing import Any, NamedTuple

from mars_asp.exchange.ros2.python_files import dotted_name

#: A loop or a part of a comprehension: its target, and what it goes over.
SourceLoop = tuple[ast.expr, ast.expr]
_ASSIGNING = frozenset({
    ast.Assign, ast.AnnAssign, ast.AugAssign, ast.NamedExpr, ast.For, ast.AsyncFor,
    ast.comprehension, ast.withitem, ast.ExceptHandler, ast.FunctionDef, ast.AsyncFunctionDef,
    ast.Lambda, ast.Global, ast.Nonlocal,
})  # fmt: skip
#: Nodes without a call or assignment in them.
_LEAVES = (ast.Name, ast.Constant, ast.expr_context, ast.operator, ast.cmpop, ast.boolop)
_COMPREHENSIONS = (ast.ListComp, ast.SetComp, ast.GeneratorExp, ast.DictComp)
#: Nodes whose parts have places of their own.
_DIVIDING = frozenset({
    ast.If, ast.IfExp, ast.For, ast.AsyncFor, ast.While, ast.Try, ast.match_case, ast.FunctionDef,
    ast.AsyncFunctionDef, ast.Lambda, ast.ClassDef, *_COMPREHENSIONS,
})  # fmt: skip
#: Of assignments to one name in one function the last so many count.
_MOST_ASSIGNED = 32
#: In place of the number of a branch.
_LOOP, _SOMETIMES = -1, -2
#: A value that only a run knows, and that of the target of a loop in each round.
UNKNOWN_VALUE: ast.expr = ast.Constant(...)
OF_LOOP: ast.expr = ast.Constant(b"loop")


class CodePlace(NamedTuple):
    """A place in a program: its line and column `at`, and the code around it.

    `scopes` are the functions and classes around it, outermost first. `blocks` are the branches and
    loops within the innermost scope, each an id and the number of the branch. `tests` are the
    conditions that hold or fail there.
    """

    scopes: tuple[ast.AST, ...] = ()
    blocks: tuple[tuple[int, int], ...] = ()
    loops: tuple[SourceLoop, ...] = ()
    tests: tuple[tuple[ast.expr, bool], ...] = ()
    at: tuple[int, int] = (0, 0)

    @property
    def functions(self) -> list[ast.AST]:
        """The functions and classes around the place, without comprehensions."""
        return [scope for scope in self.scopes if not isinstance(scope, _COMPREHENSIONS)]


class Assignment(NamedTuple):
    """A value of a variable, and the place of the assignment.

    `parameter` is the function of which the variable is a parameter, or None.
    """

    value: ast.expr
    place: CodePlace
    parameter: ast.AST | None = None


class Scopes:
    """The calls in a part of a program, and the assignments of its variables."""

    def __init__(self, part: ast.AST) -> None:
        """Collect the calls and assignments of a part of a program."""
        self.calls: list[tuple[ast.Call, CodePlace]] = []
        #: The variables that keep the results of calls, by these.
        self.keepers: dict[ast.Call, str] = {}
        self.functions: list[ast.FunctionDef | ast.AsyncFunctionDef] = []
        self._assigned: dict[tuple[ast.AST | None, str], list[Assignment]] = {}
        #: The functions that assign an attribute.
        self._assigning: dict[str, dict[ast.AST | None, None]] = {}
        self._outer: dict[ast.AST | None, set[str]] = {}
        waiting = [(part, CodePlace())]
        while waiting:
            node, place = waiting.pop()
            if isinstance(node, ast.Call):
                at = node.lineno, node.col_offset
                self.calls.append((node, CodePlace(*place[:4], at)))
            elif type(node) in _ASSIGNING:
                self._assign(node, place)
            if type(node) in _DIVIDING:
                waiting += _children(node, place)
            else:
                parts = ast.iter_child_nodes(node)
                waiting += [(each, place) for each in parts if not isinstance(each, _LEAVES)]
        for each in self._assigned.values():
            each.sort(key=_end_of)

    def _assign(self, node: Any, place: CodePlace) -> None:
        """Collect the values that a statement assigns, and its `global` and `nonlocal` names."""
        if isinstance(node, ast.Global | ast.Nonlocal):
            if place.scopes:
                self._outer.setdefault(place.scopes[-1], set()).update(node.names)
            return
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            self.functions.append(node)
        first = node.context_expr if isinstance(node, ast.withitem) else node
        if not isinstance(first, ast.comprehension):
            place = place._replace(at=(first.lineno, first.col_offset))
        # Each round of a loop assigns its target.
        if isinstance(node, ast.For | ast.AsyncFor):
            place = _block(node.body, place, _LOOP)
        for name, value, function in _assigned_by(node):
            self._keep(name, value, function, place)
            if isinstance(value, ast.Call):
                self.keepers[value] = name

    def _keep(self, name: str, value: ast.expr, function: ast.AST | None, place: CodePlace) -> None:
        """Add a value of a variable, which holds from the end of its statement."""
        if function is not None:
            place = CodePlace((*place.scopes, function), at=place.at)
        elif value not in (UNKNOWN_VALUE, OF_LOOP):
            end = value.end_lineno or 0, value.end_col_offset or 0
            place = place._replace(at=end)
        scope = place.scopes[-1] if place.scopes else None
        self._assigned.setdefault((scope, name), []).append(Assignment(value, place, function))
        if "." in name:
            self._assigning.setdefault(name, {})[scope] = None

    def values(self, name: str, place: CodePlace) -> Sequence[Assignment]:
        """Return the assignments that a variable may have at a place; none if not assigned here."""
        if "." in name:
            return self._of_attribute(name, place)
        for depth in range(len(place.scopes), -1, -1):
            scope = place.scopes[depth - 1] if depth else None
            is_own = depth == len(place.scopes)
            # Methods do not see the names of their class.
            is_hidden = isinstance(scope, ast.ClassDef) and not is_own
            every = self._assigned.get((scope, name))
            if every and not is_hidden and name not in self._outer.get(scope, ()):
                before = every[: bisect_right(every, place.at, key=_end_of)] if is_own else every
                reaching = _reaching(before or every, place.blocks if is_own else ())
                if is_own and _may_come_round(every, reaching, place):
                    reaching.append(Assignment(UNKNOWN_VALUE, place))
                return reaching
        return ()

    def _of_attribute(self, name: str, place: CodePlace) -> Sequence[Assignment]:
        """Return the assignments of an attribute, which all functions share."""
        own = place.scopes[-1] if place.scopes else None
        every = self._assigned.get((own, name), [])
        before = every[: bisect_right(every, place.at, key=_end_of)]
        reaching = _reaching(before, place.blocks)
        if _covers([each.place.blocks for each in reaching], place.blocks):
            return reaching
        # Of the values that another function assigns, the last holds where it ends.
        scopes = [*self._assigning.get(name, ())][:_MOST_ASSIGNED]
        ends = (_reaching(self._assigned[scope, name], ()) for scope in scopes)
        return [last for group in ends for last in group]


def _end_of(assignment: Assignment) -> tuple[int, int]:
    return assignment.place.at


def _assigned_by(node: ast.AST) -> Iterator[tuple[str, ast.expr, ast.AST | None]]:
    """Yield the variables that a statement assigns, or a function's parameters, with values."""
    match node:
        case ast.Assign(targets=targets, value=value):
            yield from (pair for target in targets for pair in _pairs(target, value))
        case (
            ast.AnnAssign(target=target, value=ast.expr() as value)
            | ast.NamedExpr(target=target, value=value)
        ):
            yield from _pairs(target, value)
        case ast.AugAssign(target=target, op=op, value=value):
            # The variable within the new value has the value before.
            before = ast.copy_location(_loaded(target), target)
            summed = ast.copy_location(ast.BinOp(before, op, value), target)
            yield from _pairs(target, summed)
        case ast.For() | ast.AsyncFor() | ast.comprehension():
            yield from _pairs(node.target, OF_LOOP)
        case ast.withitem(optional_vars=ast.expr() as target):
            yield from _pairs(target, UNKNOWN_VALUE)
        case ast.ExceptHandler(name=str() as name):
            yield name, UNKNOWN_VALUE, None
        case ast.FunctionDef(args=args) | ast.AsyncFunctionDef(args=args) | ast.Lambda(args=args):
            for each in (*args.posonlyargs, *args.args, *args.kwonlyargs):
                yield each.arg, UNKNOWN_VALUE, node
            for rest in filter(None, (args.vararg, args.kwarg)):
                yield rest.arg, UNKNOWN_VALUE, node


def _loaded(target: ast.expr) -> ast.expr:
    if isinstance(target, ast.Name):
        return ast.Name(target.id, ast.Load())
    if isinstance(target, ast.Attribute):
        return ast.Attribute(target.value, target.attr, ast.Load())
    return UNKNOWN_VALUE


def _pairs(target: ast.expr, value: ast.expr) -> Iterator[tuple[str, ast.expr, ast.AST | None]]:
    match target, value:
        case ast.Tuple(elts=targets) | ast.List(elts=targets), _:
            same = isinstance(value, ast.Tuple | ast.List) and len(value.elts) == len(targets)
            values = value.elts if isinstance(value, ast.Tuple | ast.List) and same else ()
            unknown = value if value is OF_LOOP else UNKNOWN_VALUE
            for each, part in zip_longest(targets, values, fillvalue=unknown):
                yield from _pairs(each, part)
        case ast.Starred(value=inner), _:
            yield from _pairs(inner, UNKNOWN_VALUE)
        case _:
            name = dotted_name(target)
            if name:
                yield name, value, None


def _children(node: Any, place: CodePlace) -> Iterator[tuple[ast.AST, CodePlace]]:
    """Yield the child nodes that have a place of their own, with it."""
    match node:
        case ast.If(test=test) | ast.IfExp(test=test):
            yield test, place
            for branch, part in enumerate((node.body, node.orelse)):
                inner = place._replace(
                    blocks=(*place.blocks, (id(node), branch)),
                    tests=(*place.tests, (test, branch == 0)),
                )
                yield from ((each, inner) for each in (part if isinstance(part, list) else [part]))
        case ast.For() | ast.AsyncFor() | ast.While():
            around = _block(node.body, place, _LOOP)
            if isinstance(node, ast.While):
                yield node.test, place
            else:
                yield node.iter, place
                around = around._replace(loops=(*place.loops, (node.target, node.iter)))
            yield from ((each, around) for each in node.body)
            yield from ((each, place) for each in node.orelse)
        case ast.Try(body=body, handlers=handlers, orelse=orelse, finalbody=last):
            for statements in (body, orelse):
                yield from ((each, _block(statements, place)) for each in statements)
            yield from ((each, _block(each.body, place)) for each in handlers)
            yield from ((each, place) for each in last)
        case ast.match_case(body=body):
            yield from ((each, _block(body, place)) for each in ast.iter_child_nodes(node))
        case _:
            # What a function is called with is of the place where it is called.
            loops = [(part.target, part.iter) for part in getattr(node, "generators", ())]
            own = CodePlace((*place.scopes, node), (), (*place.loops, *loops), place.tests)
            yield from ((each, own) for each in ast.iter_child_nodes(node))


def _block(statements: Sequence[ast.AST], place: CodePlace, sort: int = _SOMETIMES) -> CodePlace:
    """Return the place inside a block of statements that may be skipped; `sort` is its branch."""
    return place._replace(blocks=(*place.blocks, (id(statements), sort)))


def _reaching(
    assigned: Sequence[Assignment], blocks: tuple[tuple[int, int], ...]
) -> list[Assignment]:
    """Return the assignments, last first, that may hold at a later place in `blocks`."""
    found: list[Assignment] = []
    for each in reversed(assigned[-_MOST_ASSIGNED:]):
        pairs = zip(each.place.blocks, blocks, strict=False)
        fork = next(((own, other) for own, other in pairs if own != other), None)
        # The other branch of a condition does not count.
        if fork is None or fork[0][0] != fork[1][0]:
            found.append(each)
            if _covers([later.place.blocks for later in found], blocks):
                return found
    if len(assigned) > _MOST_ASSIGNED:
        found.append(Assignment(UNKNOWN_VALUE, assigned[0].place))
    return found


def _may_come_round(
    every: Sequence[Assignment], reaching: Sequence[Assignment], place: CodePlace
) -> bool:
    """Whether an earlier round of a loop may give a value that is not in `reaching`."""
    loops = {block for block in place.blocks if block[1] == _LOOP}
    # A round that assigns it anew in any case has none of another.
    loops -= {block for each in reaching[-1:] for block in each.place.blocks}
    others = [each for each in every[-_MOST_ASSIGNED:] if each not in reaching] if loops else []
    return any(not loops.isdisjoint(each.place.blocks) for each in others)


def _covers(
    assigned: Sequence[tuple[tuple[int, int], ...]], blocks: tuple[tuple[int, int], ...]
) -> bool:
    """Whether some assignment is certainly executed before a later place in `blocks`."""
    return any(_is_certain(assigned, blocks[:size]) for size in range(len(blocks) + 1))


def _is_certain(
    assigned: Sequence[tuple[tuple[int, int], ...]], outer: tuple[tuple[int, int], ...]
) -> bool:
    """Whether `outer` assigns in any case: itself, or in both branches of a condition in it."""
    if outer in assigned:
        return True
    within = [each for each in assigned if each[: len(outer)] == outer]
    branches = {each[len(outer)] for each in within}
    return any(
        branch == 0 and (number, 1) in branches
        and all(_is_certain(within, (*outer, (number, side))) for side in (0, 1))
        for number, branch in branches
    )  # fmt: skip
