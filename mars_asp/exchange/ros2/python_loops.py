"""Loops and declarations in sources in Python that need no running: what their names stand for."""

import ast
from collections.abc import Callable, Iterator, Sequence
from itertools import product

#: A loop or a part of a comprehension: its target, and what it goes over.
Loop = tuple[ast.expr, ast.expr]
#: What a name or attribute stands for.
Held = Callable[[ast.expr], "ast.expr | None"]
_MOST_ROUNDS = 64
_DEEPEST = 8


def calls_in(node: ast.AST) -> Iterator[tuple[ast.Call, tuple[Loop, ...]]]:
    """Yield the calls in a part of a program, each with the loops around it, outermost first."""
    waiting: list[tuple[ast.AST, tuple[Loop, ...]]] = [(node, ())]
    while waiting:
        each, loops = waiting.pop()
        if isinstance(each, ast.Call):
            yield each, loops
        within = loops
        if isinstance(each, ast.For):
            within = (*loops, (each.target, each.iter))
        elif isinstance(each, ast.ListComp | ast.SetComp | ast.GeneratorExp | ast.DictComp):
            within = (*loops, *((part.target, part.iter) for part in each.generators))
        waiting += ((child, within) for child in ast.iter_child_nodes(each))


def rounds(loops: Sequence[Loop], held: Held) -> Iterator[dict[str, ast.expr]]:
    """Yield what the targets of loops stand for in each round, as far as that is written out."""
    known = []
    for target, over in loops:
        items = _items(over, held, 0)
        if items is not None:
            known.append([_bound(target, item) for item in items[:_MOST_ROUNDS]])
    for _, bindings in zip(range(_MOST_ROUNDS), product(*known), strict=False):
        yield {name: value for binding in bindings for name, value in binding.items()}


def _bound(target: ast.expr, item: ast.expr) -> dict[str, ast.expr]:
    match target, item:
        case ast.Name(id=name), _:
            return {name: item}
        case ast.Tuple(elts=targets), ast.Tuple(elts=items) | ast.List(elts=items):
            pairs = zip(targets, items, strict=False)
            return {name: value for pair in pairs for name, value in _bound(*pair).items()}
        case _:
            return {}


def _items(over: ast.expr, held: Held, depth: int) -> list[ast.expr] | None:
    """Return what a loop goes over, if it is written out."""
    if depth > _DEEPEST:
        return None
    match over:
        case ast.List(elts=items) | ast.Tuple(elts=items) | ast.Set(elts=items):
            return items
        case ast.Dict(keys=keys):
            return [key for key in keys if key is not None]
        case ast.Call(func=ast.Name(id="range"), args=[*limits]):
            return _range(limits)
        case ast.Call(func=ast.Name(id="enumerate"), args=[inner]):
            numbered = _items(inner, held, depth + 1)
            if numbered is None:
                return None
            return [_pair(ast.Constant(number), item) for number, item in enumerate(numbered)]
        case ast.Call(func=ast.Name(id="zip"), args=[*inner]):
            columns = [_items(each, held, depth + 1) for each in inner]
            if any(column is None for column in columns):
                return None
            return [_pair(*row) for row in zip(*filter(None, columns), strict=False)]
        case ast.Call(func=ast.Attribute(value=inner, attr="items" | "keys" | "values" as part)):
            written = held(inner) if isinstance(inner, ast.Name | ast.Attribute) else inner
            if not isinstance(written, ast.Dict):
                return None
            pairs = [(k, v) for k, v in zip(written.keys, written.values, strict=True) if k]
            return [
                _pair(k, v) if part == "items" else k if part == "keys" else v for k, v in pairs
            ]
        case ast.Name() | ast.Attribute():
            written = held(over)
            return None if written is None else _items(written, held, depth + 1)
        case _:
            return None


def _range(limits: Sequence[ast.expr]) -> list[ast.expr] | None:
    numbers = [each.value for each in limits if isinstance(each, ast.Constant)]
    whole = [number for number in numbers if isinstance(number, int)]
    if len(whole) < len(limits) or not 1 <= len(whole) <= 2:
        return None
    return [ast.Constant(number) for number in range(*whole)[:_MOST_ROUNDS]]


def _pair(*items: ast.expr) -> ast.Tuple:
    return ast.Tuple(list(items), ast.Load())


def declared(call: ast.Call, name: str) -> Iterator[tuple[ast.expr, ast.expr]]:
    """Yield the parameters that a call of a name declares, each with its default."""
    named = {each.arg: each.value for each in call.keywords if each.arg}
    if name == "declare_parameter":
        given = named.get("name") or next(iter(call.args), None)
        value = named.get("value") or (call.args[1] if len(call.args) > 1 else None)
        if given is not None and value is not None:
            yield given, value
    elif name == "declare_parameters":
        listed = named.get("parameters") or (call.args[1] if len(call.args) > 1 else None)
        space = named.get("namespace") or next(iter(call.args), None)
        prefix = space.value if isinstance(space, ast.Constant) else ""
        for each in listed.elts if isinstance(listed, ast.List | ast.Tuple) else ():
            match each:
                case ast.Tuple(elts=[ast.Constant(value=str() as key), default, *_]):
                    yield ast.Constant(f"{prefix!s}.{key}" if prefix else key), default
