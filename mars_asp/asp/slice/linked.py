"""What rules promise of the arguments of atoms, and which literals are thereby about one part."""

from collections.abc import Mapping, Sequence, Set
from typing import NamedTuple, TypeAlias

from mars_asp.asp.rules.statements import Function, Literal, Scope, Statement
from mars_asp.asp.signature import Signature
from mars_asp.asp.slice import shapes
from mars_asp.asp.slice.shapes import NOTHING, OWN, UNKNOWN, Shape

#: Positions from 0 of the arguments that hold names and identifiers, by predicate.
Positions: TypeAlias = Mapping[Signature, tuple[int, ...]]
#: The shapes of the arguments of each predicate.
Shapes: TypeAlias = Mapping[Signature, tuple[Shape, ...]]


class Group(NamedTuple):
    """Literals that are about one part, by their numbers, and the shapes of their variables."""

    members: frozenset[int]
    shapes: Mapping[str, Shape]


def shapes_of(statements: Sequence[Statement], given: Positions) -> Shapes:
    """Return the shapes of the arguments of each predicate, the strongest that all rules keep.

    A predicate is there only if something can derive it; whatever depends on nothing else is
    seen after as many rounds as rules build on each other.
    """
    derived = (signature for statement in statements for signature in statement.derives)
    own = {signature: (UNKNOWN,) * signature.arity for signature in derived}
    for signature, positions in given.items():
        places = range(signature.arity)
        own[signature] = tuple(OWN if at in positions else NOTHING for at in places)
    changed = True
    while changed:
        changed = False
        for statement in statements:
            for literal, condition in statement.heads:
                before = own[literal.signature]
                found = _told(statement, literal, condition, own)
                after = tuple(map(shapes.either, before, found))
                if after != before:
                    own[literal.signature] = after
                    changed = True
    return own


def _told(statement: Statement, head: Literal, condition: Scope, own: Shapes) -> tuple[Shape, ...]:
    """Return the shapes of a head's arguments that its rule promises, all by one part."""
    positive = (*statement.body.positive, *condition.positive)
    best: tuple[Shape, ...] = (NOTHING,) * len(head.terms)
    for group in groups_of(positive, own):
        known = {**_assigned(statement, group, own), **group.shapes}
        found = tuple(shapes.put_together(term.structure, known) for term in head.terms)
        if sum(map(bool, found)) > sum(map(bool, best)):
            best = found
    return best


def _assigned(statement: Statement, group: Group, own: Shapes) -> dict[str, Shape]:
    """Return the shapes of variables that have the value of an aggregate over a group's part."""
    found: dict[str, Shape] = {}
    for structure, elements in statement.assigned:
        # Of no elements the value is no function, so a function is that of an element.
        if not isinstance(structure, Function):
            continue
        shape = UNKNOWN
        for number, term in elements:
            positive = (*statement.body.positive, *statement.inner[number].positive)
            groups = (g for g in groups_of(positive, own) if group.members <= g.members)
            known = next((g.shapes for g in groups), {})
            shape = shapes.either(shape, shapes.put_together(term, known))
        found.update(shapes.take_apart(structure, shape))
    return found


def groups_of(literals: Sequence[Literal], own: Shapes) -> list[Group]:
    """Return the literals that tell parts apart, those together that are linked by variables."""
    groups: list[Group] = []
    for number, literal in enumerate(literals):
        if not tells(own, literal.signature):
            continue
        members, known = frozenset({number}), bound(literal, own)
        apart = []
        for group in groups:
            if linked(known, group.shapes):
                members |= group.members
                known = _merged(known, group.shapes)
            else:
                apart.append(group)
        groups = [*apart, Group(members, known)]
    return groups


def bound(literal: Literal, own: Shapes) -> Mapping[str, Shape]:
    """Return what the variables of a literal hold, if it is true."""
    found: Mapping[str, Shape] = {}
    for term, shape in zip(literal.terms, own[literal.signature], strict=True):
        found = _merged(found, shapes.take_apart(term.structure, shape))
    return found


def _merged(one: Mapping[str, Shape], other: Mapping[str, Shape]) -> Mapping[str, Shape]:
    names = one.keys() | other.keys()
    return {name: shapes.both(one.get(name, UNKNOWN), other.get(name, UNKNOWN)) for name in names}


def tells(own: Shapes, signature: Signature) -> bool:
    """Whether the atoms of a predicate belong to one part each."""
    return any(own.get(signature, ()))


def linked(one: Mapping[str, Shape], other: Mapping[str, Shape]) -> bool:
    """Whether variables with these shapes are about one part, as one of them is in both."""
    common = one.keys() & other.keys()
    return any(shapes.share(one[name], other[name]) for name in common)


def is_apart(statement: Statement, own: Shapes, derived: Set[Signature]) -> bool:
    """Whether each instance of a statement is about one part, or the same for all."""
    scopes = (Scope(()), *statement.inner, *(condition for _, condition in statement.heads))
    if not all(_is_about_one(statement.body, inner, own) for inner in scopes):
        return False
    main = groups_of(statement.body.positive, own)
    if not main and any(tells(own, literal.signature) for s in scopes for literal in s.positive):
        return False
    if all(tells(own, signature) for signature in statement.derives):
        return True
    # What belongs to all parts is the same in each only if no choice has to do with it.
    negated = any(literal.signature in derived for literal in statement.body.others)
    return not (main or statement.offers or negated or statement.inner)


def _is_about_one(body: Scope, inner: Scope, own: Shapes) -> bool:
    """Whether all literals of a body and of an element in it are about one part."""
    found = groups_of((*body.positive, *inner.positive), own)
    others = [x for x in (*body.others, *inner.others) if tells(own, x.signature)]
    if not found:
        return not others
    return len(found) == 1 and all(linked(bound(x, own), found[0].shapes) for x in others)
