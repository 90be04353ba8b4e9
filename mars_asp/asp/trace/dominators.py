"""The atoms that every derivation of an atom needs.

An atom needs itself, and all that each of its firings needs: the greatest solution of

    needs(a) = {a} + the atoms in needs(f) for every firing f of a
    needs(f) = the atoms in needs(p) for some premise p of f, or in needs(g) for some group g
    needs(g) = the atoms without which not enough elements of g are left

These are the equations of dominators in a flow graph (Allen and Cocke 1972), with firings instead
of edges. They are solved only for strongly connected components in which some firing has a premise
of greater height than its head: an atom of lower height was derived without the head. Sets are
integers with one bit for each atom of a component.
"""

import heapq
from collections import defaultdict
from collections.abc import Hashable, Iterable, Iterator, Mapping, Sequence
from functools import partial
from typing import TypeAlias

from mars_asp.asp.solve.cyclic import cyclic_components
from mars_asp.asp.solve.term_ids import TermId
from mars_asp.asp.trace.firings import AggregateElement, AggregateGroup, Counted, Firing
from mars_asp.asp.trace.heights import is_reached

#: An atom, or a group that firings of several atoms share.
_Node: TypeAlias = TermId | AggregateGroup

#: The value of an unsolved node: the greatest solution is searched from above.
_EVERYTHING = -1


class Needs:
    """Decides whether an atom can be derived without another one."""

    def __init__(self, firings: Iterable[Firing], heights: Mapping[TermId, int]) -> None:
        """Compute the needs of all atoms in cycles; `heights` are those of minimal derivations.

        No firing may have a fact of the input as its head.
        """
        self._heights = heights
        self._firings: dict[TermId, list[Firing]] = {}
        for firing in firings:
            self._firings.setdefault(firing.head, []).append(firing)
        self._component_of: dict[TermId, _Component] = {}
        for atoms in self._components():
            component = _Component(atoms, self._firings, heights)
            self._component_of |= dict.fromkeys(atoms, component)

    def firings_of(self, atom: TermId) -> list[Firing]:
        """Return the firings of a derived atom whose premises can be derived without the atom."""
        firings = self._firings[atom]
        if len(firings) == 1:
            return firings
        holds = partial(self.holds_without, atom)
        groups = dict.fromkeys(group for firing in firings for group in firing.groups)
        reached = {
            group
            for group in groups
            if is_reached(group, (e for e in group.counted.elements if all(map(holds, e.premises))))
        }
        return [
            firing
            for firing in firings
            if all(map(holds, firing.premises)) and reached.issuperset(firing.groups)
        ]

    def holds_without(self, atom: TermId, premise: TermId) -> bool:
        """Whether a premise is not derived at all, or can be derived without the derived `atom`."""
        if premise not in self._heights:
            return premise not in self._firings
        if self._heights[premise] <= self._heights[atom]:
            return premise != atom
        component = self._component_of.get(atom)
        return component is None or not component.needs(premise, atom)

    def _components(self) -> Iterator[list[TermId]]:
        """Yield the cyclic components with a firing that rises in height, their atoms by height."""
        edges: list[tuple[Hashable, Hashable]] = []
        rising: set[TermId] = set()
        highest: dict[Counted, int] = {}

        def lead(source: Hashable, premises: Iterable[TermId]) -> int:
            derived = [premise for premise in premises if premise in self._heights]
            edges.extend((source, premise) for premise in derived)
            return max((self._heights[premise] for premise in derived), default=0)

        for head, height in self._heights.items():
            for firing in self._firings[head]:
                most = lead(head, firing.premises)
                for group in firing.groups:
                    counted = group.counted
                    edges.append((head, counted))
                    if counted not in highest:
                        highest[counted] = max(
                            (lead(counted, element.premises) for element in counted.elements),
                            default=0,
                        )
                    most = max(most, highest[counted])
                if most > height:
                    rising.add(head)
        if not rising:
            return
        components: defaultdict[int, list[TermId]] = defaultdict(list)
        component_of = cyclic_components(edges)
        for atom in self._heights.keys() & component_of.keys():
            components[component_of[atom]].append(atom)
        for atoms in components.values():
            if len(atoms) > 1 and not rising.isdisjoint(atoms):
                yield sorted(atoms, key=self._heights.__getitem__)


class _Component:
    """The atoms of a strongly connected component, and the atoms that each of them needs."""

    def __init__(
        self,
        atoms: Sequence[TermId],
        firings: Mapping[TermId, Sequence[Firing]],
        heights: Mapping[TermId, int],
    ) -> None:
        """Compute the needs of `atoms`, which are sorted by height."""
        self._firings = firings
        self._heights = heights
        self._bits = {atom: 1 << place for place, atom in enumerate(atoms)}
        self._needed: dict[_Node, int] = dict.fromkeys(atoms, _EVERYTHING)
        users: dict[_Node, set[_Node]] = {atom: set() for atom in atoms}
        nodes: list[_Node] = []
        for atom in atoms:
            for firing in firings[atom]:
                for group in firing.groups:
                    if group not in users:
                        users[group] = set()
                        nodes.append(group)
                        for element in group.counted.elements:
                            for premise in self._bits.keys() & set(element.premises):
                                users[premise].add(group)
                    users[group].add(atom)
                for premise in self._bits.keys() & set(firing.premises):
                    users[premise].add(atom)
            nodes.append(atom)
        self._solve(nodes, users)

    def needs(self, premise: TermId, atom: TermId) -> bool:
        """Whether `premise` cannot be derived without `atom`, an atom of the component."""
        return bool(self._needed.get(premise, 0) & self._bits[atom])

    def _solve(self, nodes: Sequence[_Node], users: Mapping[_Node, Iterable[_Node]]) -> None:
        """Update nodes until no value changes.

        Nodes are updated in rounds, by height, so that the premises of a firing are mostly known. A
        node that changes after the turn of its user marks this user for the next round.
        """
        places = {node: place for place, node in enumerate(nodes)}
        waiting = [(0, place) for place in range(len(nodes))]
        queued = set(nodes)
        while waiting:
            turn, place = heapq.heappop(waiting)
            node = nodes[place]
            queued.discard(node)
            needed = (
                self._of_group(node) if isinstance(node, AggregateGroup) else self._of_atom(node)
            )
            if needed == self._needed.get(node):
                continue
            self._needed[node] = needed
            for user in users[node]:
                if user not in queued:
                    queued.add(user)
                    after = places[user] <= place
                    heapq.heappush(waiting, (turn + after, places[user]))

    def _of_atom(self, atom: TermId) -> int:
        """Return as bits an atom and the atoms needed by all of its firings."""
        common = _EVERYTHING
        for firing in self._firings[atom]:
            needed = self._any(firing.premises)
            for group in firing.groups:
                needed |= self._needed[group]
            common &= needed
        return self._bits[atom] | common

    def _any(self, premises: Iterable[TermId]) -> int:
        """Return as bits the atoms that some premise needs."""
        found = 0
        for premise in premises:
            known = premise in self._heights or premise not in self._firings
            found |= self._needed.get(premise, 0) if known else _EVERYTHING
        return found

    def _of_group(self, group: AggregateGroup) -> int:
        """Return as bits the atoms without which a group has too few elements."""
        parts = [(e, self._any(e.premises)) for e in group.counted.elements]
        if is_reached(group, (element for element, needed in parts if not needed)):
            return 0
        known = [(element, needed) for element, needed in parts if needed != _EVERYTHING]
        # An atom that the group needs is needed by some element of every sufficient subset.
        enough: list[int] = []

        def noted() -> Iterator[AggregateElement]:
            for element, needed in known:
                enough.append(needed)
                yield element

        if not is_reached(group, noted()):
            return _EVERYTHING
        found = 0
        for bit in _bits_of(enough):
            if not is_reached(group, (e for e, needed in known if not needed & bit)):
                found |= bit
        return found


def _bits_of(numbers: Iterable[int]) -> Iterator[int]:
    left = 0
    for number in numbers:
        left |= number
    while left:
        yield left & -left
        left &= left - 1
