"""The order in which premises are shown: by rank and location, never by the alphabet."""

from collections.abc import Hashable, Sequence
from typing import TypeAlias

from mars_asp.asp.trace.tree import Derived, Given, Trace
from mars_asp.diagnostic import Span

#: Whether there is no rank, the negated rank, whether there is no location, and the location.
_Key: TypeAlias = tuple[bool, int, bool, tuple[object, ...]]


class PremiseOrder:
    """Sorts premises of one predicate among themselves: by rank, then by location.

    Premises of different predicates keep the order of the rule's body.
    """

    def __init__(self) -> None:
        """Begin with no steps known; results are memoized for shared steps."""
        self._keys: dict[int, _Key] = {}
        self._counts: dict[int, bool] = {}

    def of(self, step: Derived) -> Sequence[Trace]:
        """Return the premises of a step in the order to be shown.

        A rule without aggregates and conditions has them in the order of its body.
        """
        premises, rule = step.premises, step.rule
        if len(premises) < 2:
            return premises
        counts = self._counts.get(id(rule))
        if counts is None:
            counts = self._counts[id(rule)] = any(each.inner for each in rule.statements)
        return self.among(premises) if counts else premises

    def among(self, premises: Sequence[Trace]) -> list[Trace]:
        """Return sorted premises of one step, or of steps folded into it."""
        alike: dict[Hashable, list[int]] = {}
        for at, premise in enumerate(premises):
            alike.setdefault(_predicate(premise), []).append(at)
        found = list(premises)
        if len(alike) == len(found):
            return found
        for places in alike.values():
            if len(places) > 1:
                ordered = sorted((premises[at] for at in places), key=self._premise_key)
                for at, premise in zip(places, ordered, strict=True):
                    found[at] = premise
        return found

    def lines(self, quoted: Sequence[Sequence[Given]]) -> Sequence[Sequence[Given]]:
        """Return groups of facts, one for each quoted line, sorted by their best ranks."""
        if len(quoted) < 2:
            return quoted
        return sorted(quoted, key=lambda givens: min(map(self._premise_key, givens)))

    def _premise_key(self, premise: Trace) -> _Key:
        key = self._keys.get(id(premise))
        if key is None:
            leaf = _first_leaf(premise)
            rank = None if leaf is None else leaf.rank
            place: Span | tuple[object, ...] = (leaf.span if leaf is not None else None) or ()
            key = self._keys[id(premise)] = (rank is None, -(rank or 0), not place, place)
        return key


def _predicate(premise: Trace) -> Hashable:
    if isinstance(premise, Derived):
        return premise.rule.heads
    return premise.atom.partition("(")[0]


def _first_leaf(premise: Trace) -> Given | None:
    """Return the first fact of a premise, followed through first premises, or None."""
    while isinstance(premise, Derived):
        first: Trace | None = None
        for each in premise.premises:
            if isinstance(each, Given):
                return each
            if first is None and isinstance(each, Derived):
                first = each
        if first is None:
            return None
        premise = first
    return premise if isinstance(premise, Given) else None
