"""Where in a term the constant stands that says whose it is.

Modules and relationships have constants of their own: names and identifiers. A shape says of the
values of an argument or a variable that each holds such a constant, and where: in itself, or in
some arguments of a function, by its name and arity. So `inherited("M")` and `"M"` have the shape

    {LEAF: {}, ("inherited", 1): {0: {LEAF: {}}}}

An empty shape promises nothing; `UNKNOWN` is that of what no rule was seen to derive yet.
"""

from collections.abc import Mapping, Sequence
from typing import NamedTuple, TypeAlias

from clingo import ast

#: A function by its name and arity, or what is no function.
Functor: TypeAlias = tuple[str, int]
Shape: TypeAlias = Mapping[Functor, Mapping[int, "Shape"]]

LEAF: Functor = ("", -1)
OWN: Shape = {LEAF: {}}
NOTHING: Shape = {}
UNKNOWN: Shape = {("", -2): {}}
#: Terms that are nested deeper promise nothing, so that recursion ends.
_DEEPEST = 8


class Function(NamedTuple):
    """A function or tuple in a rule."""

    functor: Functor
    arguments: "tuple[Pattern, ...]"


#: A term in a rule: a variable's name, a function, or what promises nothing, such as a sum.
Pattern: TypeAlias = "str | Function | None"


def pattern_of(term: ast.AST) -> Pattern:
    """Return a term of clingo's syntax tree as a pattern."""
    if term.ast_type == ast.ASTType.Variable:
        return None if term.name == "_" else str(term.name)
    if term.ast_type == ast.ASTType.Function and term.arguments and not term.external:
        arguments = tuple(map(pattern_of, term.arguments))
        return Function((term.name, len(arguments)), arguments)
    return None


def either(one: Shape, other: Shape) -> Shape:
    """Return the shape of values of which each has one of two shapes."""
    if one is UNKNOWN or other is UNKNOWN:
        return other if one is UNKNOWN else one
    if not one or not other:
        return NOTHING
    found = {**one, **other}
    for functor in one.keys() & other.keys() - {LEAF}:
        left, right = one[functor], other[functor]
        inside = {at: either(left[at], right[at]) for at in left.keys() & right.keys()}
        found[functor] = {at: shape for at, shape in inside.items() if shape}
        if not found[functor]:
            return NOTHING
    return found


def both(one: Shape, other: Shape) -> Shape:
    """Return the shape of values that have two shapes."""
    if one is UNKNOWN or other is UNKNOWN:
        return other if one is UNKNOWN else one
    common = one.keys() & other.keys()
    if not common:
        return one or other
    return {
        functor: {
            at: both(one[functor].get(at, UNKNOWN), other[functor].get(at, UNKNOWN))
            for at in one[functor].keys() | other[functor].keys()
        }
        for functor in common
    }


def share(one: Shape, other: Shape) -> bool:
    """Say whether a value of both shapes has its constant at one place for both of them."""
    if one is UNKNOWN or other is UNKNOWN:
        return True
    if not one or not other:
        return False
    return all(
        functor == LEAF
        or any(
            share(one[functor][at], other[functor][at])
            for at in one[functor].keys() & other[functor].keys()
        )
        for functor in one.keys() & other.keys()
    )


def take_apart(pattern: Pattern, shape: Shape) -> dict[str, Shape]:
    """Return what a shape promises of the variables in a pattern."""
    if isinstance(pattern, str):
        return {pattern: shape} if shape else {}
    found: dict[str, Shape] = {}
    if pattern is not None:
        unknown = dict.fromkeys(range(len(pattern.arguments)), UNKNOWN)
        inside = unknown if shape is UNKNOWN else shape.get(pattern.functor, {})
        for at, inner in inside.items():
            for name, known in take_apart(pattern.arguments[at], inner).items():
                found[name] = both(found.get(name, UNKNOWN), known)
    return found


def put_together(pattern: Pattern, shapes: Mapping[str, Shape], depth: int = _DEEPEST) -> Shape:
    """Return the shape of a pattern by those of its variables."""
    if isinstance(pattern, str):
        return _cut(shapes.get(pattern, NOTHING), depth)
    if pattern is None or not depth:
        return NOTHING
    arguments: Sequence[Pattern] = pattern.arguments
    inside = {at: put_together(inner, shapes, depth - 1) for at, inner in enumerate(arguments)}
    told = {at: shape for at, shape in inside.items() if shape}
    return {pattern.functor: told} if told else NOTHING


def _cut(shape: Shape, depth: int) -> Shape:
    """Return what a shape promises of what is not nested too deep."""
    if shape is UNKNOWN:
        return shape
    found: dict[Functor, Mapping[int, Shape]] = {}
    for functor, inside in shape.items():
        told = {at: _cut(inner, depth - 1) for at, inner in inside.items()} if depth else {}
        found[functor] = {at: inner for at, inner in told.items() if inner}
        if functor != LEAF and not found[functor]:
            return NOTHING
    return found
