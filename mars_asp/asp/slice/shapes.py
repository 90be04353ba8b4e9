"""Where in a term the constant stands that says whose it is.

Things have constants of their own: names and identifiers. A shape says of the
values of an argument or a variable that each holds such a constant, and where: in itself, or in
some arguments of a function, by its name and arity. So `inherited("M")` and `"M"` have the shape

    {LEAF: {}, ("inherited", 1): {0: {LEAF: {}}}}

An empty shape promises nothing; `UNKNOWN` is that of what no rule was seen to derive yet.
"""

from collections.abc import Mapping, Sequence
from typing import TypeAlias

from mars_asp.asp.rules.statements import Functor, Structure

Shape: TypeAlias = Mapping[Functor, Mapping[int, "Shape"]]

#: Stands for what is no function.
LEAF: Functor = ("", -1)
OWN: Shape = {LEAF: {}}
NOTHING: Shape = {}
UNKNOWN: Shape = {("", -2): {}}
#: Terms that are nested deeper promise nothing, so that recursion ends.
_DEEPEST = 8


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
    """Whether a value of both shapes has its constant at one place for both of them."""
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


def take_apart(structure: Structure, shape: Shape) -> dict[str, Shape]:
    """Return what a shape promises of the variables in a structure."""
    if isinstance(structure, str):
        return {structure: shape} if shape else {}
    found: dict[str, Shape] = {}
    if structure is not None:
        unknown = dict.fromkeys(range(len(structure.arguments)), UNKNOWN)
        inside = unknown if shape is UNKNOWN else shape.get(structure.functor, {})
        for at, inner in inside.items():
            for name, known in take_apart(structure.arguments[at], inner).items():
                found[name] = both(found.get(name, UNKNOWN), known)
    return found


def put_together(structure: Structure, shapes: Mapping[str, Shape], depth: int = _DEEPEST) -> Shape:
    """Return the shape of a structure by those of its variables."""
    if isinstance(structure, str):
        return _cut(shapes.get(structure, NOTHING), depth)
    if structure is None or not depth:
        return NOTHING
    arguments: Sequence[Structure] = structure.arguments
    inside = {at: put_together(inner, shapes, depth - 1) for at, inner in enumerate(arguments)}
    told = {at: shape for at, shape in inside.items() if shape}
    return {structure.functor: told} if told else NOTHING


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
