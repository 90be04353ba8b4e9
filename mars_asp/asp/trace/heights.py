"""The minimal heights of derived atoms.

Heights are found by Knuth's generalisation (1977) of Dijkstra's algorithm: an atom has the height
of its lowest firing plus one, and a firing counts only when all its premises have a height, so no
atom can support itself. An aggregate is reached when its function over the elements reaches a
bound, as for `#count` and `#sum` from below.
"""

from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence

import clingo

from mars_asp.asp.solve.term_ids import TermId
from mars_asp.asp.trace.firings import (
    AggregateElement,
    AggregateGroup,
    Counted,
    Firing,
    firing_order,
    number_of,
    weight_of,
)


class _Tally:
    """The value of an aggregate over the elements derived so far, and firings that wait for it."""

    def __init__(self, counted: Counted) -> None:
        self._function = counted.function
        self._counted: set[TermId] = set()
        self._total = 0
        self._end: clingo.Symbol | None = None
        needs_all = counted.function == "all"
        self._every = len({e.tuple for e in counted.elements}) if needs_all else 0
        self._waiting: dict[AggregateGroup, list[_Waiting]] = {}
        #: The groups that wait; the easiest to reach is the last.
        self._order: list[AggregateGroup] = []

    def add(self, element: AggregateElement) -> None:
        """Count an element."""
        if element.tuple in self._counted:
            return
        self._counted.add(element.tuple)
        if self._function in ("all", "none", "count"):
            self._total += 1
            return
        weight = weight_of(element.tuple)
        self._total += max(0, number_of(weight))
        pick = min if self._function == "min" else max
        self._end = weight if self._end is None else pick(self._end, weight)

    def reaches(self, group: AggregateGroup) -> bool:
        """Whether the elements counted so far suffice for the bound of a group."""
        bound, strict = group.bound, group.strict
        if self._function == "none":
            return True
        if self._function == "all":
            return len(self._counted) == self._every
        if self._function == "min":
            end = clingo.Supremum if self._end is None else self._end
            return end < bound or (end == bound and not strict)
        value = clingo.Number(self._total)
        if self._function == "max":
            value = clingo.Infimum if self._end is None else self._end
        return value > bound or (value == bound and not strict)

    def wait(self, group: AggregateGroup, waiting: "_Waiting") -> None:
        """Add a firing that waits until a group is reached."""
        if group not in self._waiting:
            self._waiting[group] = []
            self._order.clear()
        self._waiting[group].append(waiting)

    def release(self) -> "Iterator[_Waiting]":
        """Yield the firings that wait for a bound the value now reaches, once for each bound."""
        if self._waiting and not self._order:
            self._order = sorted(self._waiting, key=_difficulty, reverse=self._function != "min")
        while self._order and self.reaches(self._order[-1]):
            yield from self._waiting.pop(self._order.pop())


def _difficulty(group: AggregateGroup) -> tuple[clingo.Symbol, bool]:
    """Return a sort key: groups with larger bounds are later, which are harder except for `min`."""
    return group.bound, group.strict != (group.counted.function == "min")


class _Waiting:
    """A firing with the number (`open`) of its premises and groups that are not reached yet."""

    __slots__ = ("firing", "open")

    def __init__(self, firing: Firing, open_premises: int) -> None:
        self.firing = firing
        self.open = open_premises


class _Part:
    """An element of an aggregate, and the number (`open`) of its premises not reached yet."""

    __slots__ = ("element", "open", "tally")

    def __init__(self, tally: _Tally, element: AggregateElement, open_premises: int) -> None:
        self.tally = tally
        self.element = element
        self.open = open_premises


class _Uses:
    """The firings and elements that use each atom, with the premises that they still lack."""

    def __init__(self, firings: Sequence[Firing]) -> None:
        self._heads = {firing.head for firing in firings}
        self._users: defaultdict[TermId, list[_Waiting | _Part]] = defaultdict(list)
        self._tallies: dict[Counted, _Tally] = {}
        #: The firings that wait for nothing.
        self.ready = [firing for firing in firings if not self._waits(firing)]

    def _waits(self, firing: Firing) -> bool:
        inside = [atom for atom in firing.premises if atom in self._heads]
        if not inside and not firing.groups:
            return False
        waiting = _Waiting(firing, len(inside))
        for premise in inside:
            self._users[premise].append(waiting)
        for group in firing.groups:
            tally = self._tally(group.counted)
            if not tally.reaches(group):
                tally.wait(group, waiting)
                waiting.open += 1
        return waiting.open > 0

    def _tally(self, counted: Counted) -> _Tally:
        if counted not in self._tallies:
            tally = self._tallies[counted] = _Tally(counted)
            for element in counted.elements:
                inside = [atom for atom in element.premises if atom in self._heads]
                part = _Part(tally, element, len(inside))
                for premise in inside:
                    self._users[premise].append(part)
                if not inside:
                    tally.add(element)
        return self._tallies[counted]

    def reached(self, atom: TermId) -> Iterator[Firing]:
        """Yield the firings that can fire after an atom is derived, which they lacked last."""
        for user in self._users.pop(atom, ()):
            user.open -= 1
            if user.open:
                continue
            if isinstance(user, _Waiting):
                yield user.firing
                continue
            user.tally.add(user.element)
            for waiting in user.tally.release():
                waiting.open -= 1
                if not waiting.open:
                    yield waiting.firing


def least_heights(firings: Sequence[Firing]) -> tuple[dict[TermId, Firing], dict[TermId, int]]:
    """Return for each derived atom its firing of minimal height, and its height.

    Atoms without a firing are given and have no height.

    Ties go to the first rule, then to the first bindings and premises, so that the result is
    independent of the order of grounding.
    """
    uses = _Uses(firings)
    best: dict[TermId, Firing] = {}
    heights: dict[TermId, int] = {}
    level = uses.ready
    height = 0
    while level:
        height += 1
        new: list[TermId] = []
        for firing in level:
            atom = firing.head
            if atom not in best:
                new.append(atom)
                best[atom], heights[atom] = firing, height
            elif heights[atom] == height and firing_order(firing) < firing_order(best[atom]):
                best[atom] = firing
        level = [firing for atom in new for firing in uses.reached(atom)]
    return best, heights


def is_reached(group: AggregateGroup, elements: Iterable[AggregateElement]) -> bool:
    """Whether `elements` suffice for a group; no more elements are read than necessary."""
    tally = _Tally(group.counted)
    look = 1
    for number, element in enumerate(elements, 1):
        tally.add(element)
        # A check costs as much as counting, so the intervals between checks double.
        if number == look:
            if tally.reaches(group):
                return True
            look *= 2
    return tally.reaches(group)
