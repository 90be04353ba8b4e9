"""The firings of an atom whose premises can be derived without the atom.

Only an atom that depends on itself can have others. Its component is the set of atoms that depend
on each other: all that a component needs besides is derived without it. So what can be derived
without an atom is found by deriving its component once more, from the rest, without the atom.
"""

from collections.abc import Hashable, Iterable, Mapping, Set
from functools import cached_property, partial

from mars_asp.asp.solve.cyclic import cyclic_components
from mars_asp.asp.solve.term_ids import TermId
from mars_asp.asp.trace.firings import Counted, Firing
from mars_asp.asp.trace.heights import Uses, is_reached


class Derivable:
    """Decides whether an atom can be derived without another one."""

    def __init__(self, firings: Iterable[Firing], heights: Mapping[TermId, int]) -> None:
        """Prepare; `heights` are those of minimal derivations.

        No firing may have a fact of the input as its head.
        """
        self._heights = heights
        self._firings: dict[TermId, list[Firing]] = {}
        for firing in firings:
            self._firings.setdefault(firing.head, []).append(firing)
        self._known: dict[TermId, Set[TermId]] = {}

    def firings_of(self, atom: TermId) -> list[Firing]:
        """Return the firings of a derived atom whose premises can be derived without the atom."""
        firings = self._firings[atom]
        if len(firings) == 1:
            return firings
        stands = partial(self.stands_without, atom)
        groups = dict.fromkeys(group for firing in firings for group in firing.groups)
        reached = {
            group
            for group in groups
            if is_reached(
                group, (e for e in group.counted.elements if all(map(stands, e.premises)))
            )
        }
        return [
            firing
            for firing in firings
            if all(map(stands, firing.premises)) and reached.issuperset(firing.groups)
        ]

    def stands_without(self, atom: TermId, premise: TermId) -> bool:
        """Whether a premise is not derived at all, or can be derived without the derived `atom`."""
        if premise not in self._heights:
            return premise not in self._firings
        # An atom of lower height was derived without this one.
        if self._heights[premise] <= self._heights[atom]:
            return premise != atom
        component = self._component_of.get(atom)
        if component is None or self._component_of.get(premise) != component:
            return True
        return premise in self._without(atom)

    def _without(self, atom: TermId) -> Set[TermId]:
        """Return the atoms of the component of an atom that can be derived without it."""
        if atom not in self._known:
            component = self._component_of[atom]
            uses = Uses(
                [
                    firing
                    for head, firings in self._firings.items()
                    if self._component_of.get(head) == component or head not in self._heights
                    for firing in firings
                ]
            )
            found: set[TermId] = set()
            ready = uses.ready
            while ready:
                new = {firing.head for firing in ready} - found - {atom}
                found |= new
                ready = [firing for each in new for firing in uses.reached(each)]
            self._known[atom] = found
        return self._known[atom]

    @cached_property
    def _component_of(self) -> Mapping[Hashable, int]:
        """Return the number of the component of each atom that depends on itself."""
        edges: list[tuple[Hashable, Hashable]] = []
        counted: set[Counted] = set()
        for head, firings in self._firings.items():
            for firing in firings:
                edges += ((head, premise) for premise in firing.premises)
                edges += ((head, group.counted) for group in firing.groups)
                counted.update(group.counted for group in firing.groups)
        for each in counted:
            edges += ((each, p) for element in each.elements for p in element.premises)
        return cyclic_components(edges)
