"""The support that groups of elements add to steps, computed once for many steps."""

from collections.abc import Callable, Iterable, Mapping
from itertools import takewhile
from typing import TypeAlias

from mars_asp.asp.solve.term_ids import TermId, as_symbol
from mars_asp.asp.trace.firings import AggregateElement, AggregateGroup, Counted, Firing, Terms

#: Premises, and the atoms whose absence a step rests on.
Support: TypeAlias = tuple[Terms, Terms]


class CountedBelow:
    """The atoms that support aggregates in steps, from elements of lower height only."""

    def __init__(self, heights: Mapping[TermId, int]) -> None:
        """Begin with the heights of atoms; other atoms have height 0."""
        self._heights = heights
        #: The elements of each group with their heights, the lowest first.
        self._ordered: dict[Counted, list[tuple[int, AggregateElement]]] = {}
        self._known: dict[tuple[Counted, int], Support] = {}

    def of(self, height: int, group: AggregateGroup) -> Support:
        """Return the support from the elements of a group whose height is below `height`."""
        key = (group.counted, height)
        if key not in self._known:
            low = takewhile(lambda pair: pair[0] < height, self._by_height(group))
            elements = [element for _, element in low]
            self._known[key] = support_of(elements, lambda atom: self._height(atom) < height)
        return self._known[key]

    def _by_height(self, group: AggregateGroup) -> list[tuple[int, AggregateElement]]:
        if group.counted not in self._ordered:
            heights = [
                max(map(self._height, e.premises), default=0) for e in group.counted.elements
            ]
            pairs = list(zip(heights, group.counted.elements, strict=True))
            self._ordered[group.counted] = sorted(pairs, key=lambda pair: pair[0])
        return self._ordered[group.counted]

    def _height(self, atom: TermId) -> int:
        return self._heights.get(atom, 0)


class CountedWithout:
    """The atoms that support aggregates in derivations of one atom."""

    def __init__(self, stands: Callable[[TermId], bool]) -> None:
        """Begin; `stands` returns whether an atom can be derived without the derived one."""
        self._stands = stands
        self._known: dict[Counted, Support] = {}
        self._held: dict[
            tuple[AggregateGroup, ...], tuple[frozenset[TermId], frozenset[TermId]]
        ] = {}

    def of(self, group: AggregateGroup) -> Support:
        """Return the support from the elements of a group that can be derived without the atom."""
        if group.counted not in self._known:
            self._known[group.counted] = support_of(group.counted.elements, self._stands)
        return self._known[group.counted]

    def of_all(
        self, groups: tuple[AggregateGroup, ...]
    ) -> tuple[frozenset[TermId], frozenset[TermId]]:
        """Return the premises of several groups, and the atoms on whose absence the groups rest."""
        if groups not in self._held:
            added = [self.of(group) for group in groups]
            inside = frozenset(atom for premises, _ in added for atom in premises)
            self._held[groups] = inside, frozenset(atom for _, lacking in added for atom in lacking)
        return self._held[groups]


def support_of(elements: Iterable[AggregateElement], counts: Callable[[TermId], bool]) -> Support:
    """Return the sorted premises and absent atoms of the elements that count.

    An element counts if `counts` is true of all its premises.
    """
    inside: set[TermId] = set()
    lacking: set[TermId] = set()
    for element in elements:
        if all(map(counts, element.premises)):
            inside.update(element.premises)
            inside.update(filter(counts, element.conditions))
            lacking.update(element.absent)
    return tuple(sorted(inside, key=as_symbol)), tuple(sorted(lacking, key=as_symbol))


def support(firing: Firing, added: Callable[[AggregateGroup], Support]) -> Support:
    """Return the premises and absent atoms of a firing, those of its groups included.

    `added` returns those of a group. All elements that count are included, so that a trace is
    complete; no atom is among its own reasons.
    """
    if not firing.groups:
        return firing.premises, firing.absent
    premises, absent = dict.fromkeys(firing.premises), dict.fromkeys(firing.absent)
    for group in firing.groups:
        inside, lacking = added(group)
        premises |= dict.fromkeys(inside)
        absent |= dict.fromkeys(lacking)
    return tuple(premises), tuple(absent)
