"""What rules see of single parts, so that who sees no difference between two need not ask of both.

Parts are told apart here by the names and identifiers that some given facts have; all other facts
belong to every part.
"""

from collections.abc import Iterable, Iterator, Sequence, Set
from typing import NamedTuple

from mars_asp.asp.rules.statements import Literal, Statement
from mars_asp.asp.signature import Signature
from mars_asp.asp.slice.linked import Positions, is_apart, shapes_of, tells
from mars_asp.asp.slice.shapes import OWN

#: What a sight has in the place of a value that is not looked at.
UNSEEN = "_"


class Sight(NamedTuple):
    """How a literal sees atoms: those with its constants; `None` where it sees what there is."""

    signature: Signature
    terms: tuple[str | None, ...]


class Seen(NamedTuple):
    """A sight of atoms that are about one part each.

    The argument `at` says of which, by a name or identifier; so do those at `names`, or they say
    what belongs to the same island of parts.
    """

    sight: Sight
    at: int
    names: tuple[int, ...]


def sights(statements: Iterable[Statement]) -> frozenset[Sight]:
    """Return how statements see what they read.

    A value without a name is looked at only where each instance counts.
    """
    scopes = (
        scope
        for each in statements
        for scope in (each.body, *each.inner, *(head.condition for head in each.heads))
    )
    return frozenset(
        _sight(literal, literal == scope.counted) for scope in scopes for literal in scope.literals
    )


def _sight(literal: Literal, is_counted: bool) -> Sight:
    unseen = None if is_counted else UNSEEN
    terms = (unseen if term.text == UNSEEN else term.constant for term in literal.terms)
    return Sight(literal.signature, tuple(terms))


def seen_apart(
    base: Sequence[Statement], looking: Iterable[Sight], islands: Positions, parts: Positions
) -> tuple[Seen, ...] | None:
    """Return what is seen of single parts, by statements of the base about none of them, too.

    `None` where what the base derives of a part may depend on others. `parts` says which arguments
    of given facts tell parts apart, `islands` which bring together what they name.
    """
    ordered = [*_in_order(base, parts.keys())]
    own = shapes_of(ordered, parts)
    derived = _derived(ordered)
    telling = frozenset(signature for signature in own if tells(own, signature))
    about = [each for each in ordered if each.derives <= telling]
    others = [each for each in ordered if not each.derives <= telling]
    # What rests on parts, and is about none of them, is another where other parts are there.
    resting = telling
    while more := _derived(x for x in others if not resting.isdisjoint(x.reads)) - resting:
        resting = resting | more
    mixed = resting - telling
    if not all(is_apart(each, own, derived) and mixed.isdisjoint(each.reads) for each in about):
        return None
    seen = [sight for sight in {*looking, *sights(others)} if sight.signature in telling]
    if not all(OWN in own[sight.signature] for sight in seen):
        return None
    names = shapes_of(ordered, islands)
    return tuple(
        Seen(
            sight,
            own[sight.signature].index(OWN),
            tuple(at for at, shape in enumerate(names[sight.signature]) if shape == OWN),
        )
        for sight in sorted(seen, key=str)
    )


def _in_order(statements: Sequence[Statement], given: Set[Signature]) -> Iterator[Statement]:
    """Yield statements after those that derive what they read, as far as there is an order.

    Of what is not known to be derived shapes promise most, and that misleads those who come first.
    """
    there, left = set(given), list(statements)
    while left:
        ready = [x for x in left if all(each.signature in there for each in x.body.positive)]
        ready = ready or left
        yield from ready
        there |= _derived(ready)
        left = [each for each in left if each not in ready]


def _derived(statements: Iterable[Statement]) -> frozenset[Signature]:
    return frozenset().union(*(each.derives for each in statements))
