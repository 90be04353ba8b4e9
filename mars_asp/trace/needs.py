"""Which atoms every derivation of another one needs, so that no derivation of them can rest on it.

An atom needs itself, and what all of its firings need: the greatest solution of

    needs(a) = {a} + the atoms in needs(f) for every firing f of a
    needs(f) = the atoms in needs(p) for some premise p of f

It is how dominators of a flow graph are found from their equations (Allen and Cocke 1972), for
firings instead of edges. Only atoms that lead to each other matter, and only where a firing has a
premise of greater height than its head: what is lower was derived without the head. Sets are
numbers, one bit for each atom of a component.
"""

import heapq
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import partial

from mars_asp.term import Term
from mars_asp.trace.firings import Firing, Group, is_reached

#: What is not known yet needs everything.
_EVERYTHING = -1


class Needs:
    """Answers whether an atom can be derived without another one."""

    def __init__(self, firings: Iterable[Firing], heights: Mapping[Term, int]) -> None:
        """Find what atoms need; `heights` are those of least derivations.

        No firing has a head that is given.
        """
        self._heights = heights
        self._firings: dict[Term, list[Firing]] = {}
        for firing in firings:
            self._firings.setdefault(firing.head, []).append(firing)
        self._bits: dict[Term, int] = {}
        self._needed: dict[Term, int] = {}
        for component in self._components():
            self._solve(component)

    def firings_of(self, atom: Term) -> list[Firing]:
        """Return the firings of a derived atom of which the premises stand without it."""
        stands = partial(self.stands_without, atom)
        return [
            firing
            for firing in self._firings[atom]
            if all(map(stands, firing.premises))
            and all(
                is_reached(group, (e for e in group.elements if all(map(stands, e.premises))))
                for group in firing.groups
            )
        ]

    def stands_without(self, atom: Term, premise: Term) -> bool:
        """Say whether a premise can be derived without a derived atom, or is no derived one."""
        if premise not in self._heights:
            return premise not in self._firings
        if self._heights[premise] <= self._heights[atom]:
            return premise != atom
        return not self._needed.get(premise, 0) & self._bits.get(atom, 0)

    def _components(self) -> Iterator[list[Term]]:
        """Yield the atoms that lead to each other, by height, where that can matter."""
        edges = [
            (head, premise)
            for head in self._heights
            for firing in self._firings[head]
            for premise in _premises(firing)
            if premise in self._heights
        ]
        rising = [(a, b) for a, b in edges if self._heights[b] > self._heights[a]]
        if not rising:
            return
        import networkx  # noqa: PLC0415 -- slow to import, and only derivations that circle need it

        graph = networkx.DiGraph(edges)
        heads = {head for head, _ in rising}
        for component in networkx.strongly_connected_components(graph):
            if len(component) > 1 and heads & component:
                yield sorted(component, key=self._heights.__getitem__)

    def _solve(self, component: Sequence[Term]) -> None:
        self._bits |= {atom: 1 << place for place, atom in enumerate(component)}
        self._needed |= dict.fromkeys(component, _EVERYTHING)
        places = {atom: place for place, atom in enumerate(component)}
        users: dict[Term, set[int]] = {atom: set() for atom in component}
        for atom in component:
            for firing in self._firings[atom]:
                for premise in users.keys() & set(_premises(firing)):
                    users[premise].add(places[atom])
        # From the lowest up, so that mostly what a firing rests on is known when its turn comes.
        waiting = list(range(len(component)))
        queued = set(waiting)
        while waiting:
            place = heapq.heappop(waiting)
            queued.discard(place)
            atom = component[place]
            needed = self._bits[atom] | self._common(self._firings[atom])
            if needed == self._needed[atom]:
                continue
            self._needed[atom] = needed
            for user in users[atom] - queued:
                queued.add(user)
                heapq.heappush(waiting, user)

    def _common(self, firings: Iterable[Firing]) -> int:
        """Return what all of some firings need."""
        common = _EVERYTHING
        for firing in firings:
            common &= self._any(firing.premises) | self._grouped(firing.groups)
        return common

    def _any(self, premises: Iterable[Term]) -> int:
        """Return what one of some premises needs."""
        found = 0
        for premise in premises:
            known = premise in self._heights or premise not in self._firings
            found |= self._needed.get(premise, 0) if known else _EVERYTHING
        return found

    def _grouped(self, groups: Iterable[Group]) -> int:
        """Return what groups need: without which not enough of their elements are left."""
        found = 0
        for group in groups:
            parts = [(element, self._any(element.premises)) for element in group.elements]
            if is_reached(group, (element for element, needed in parts if not needed)):
                continue
            known = [(element, needed) for element, needed in parts if needed != _EVERYTHING]
            if not is_reached(group, (element for element, _ in known)):
                return _EVERYTHING
            for bit in _bits_of(needed for _, needed in known):
                if not is_reached(group, (e for e, needed in known if not needed & bit)):
                    found |= bit
        return found


def _premises(firing: Firing) -> Iterator[Term]:
    yield from firing.premises
    for group in firing.groups:
        for element in group.elements:
            yield from element.premises


def _bits_of(numbers: Iterable[int]) -> Iterator[int]:
    left = 0
    for number in numbers:
        left |= number
    while left:
        yield left & -left
        left &= left - 1
