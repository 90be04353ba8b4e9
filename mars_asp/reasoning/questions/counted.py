"""How many nodes islands of a configuration need, counted once of those that are alike.

The rules keep islands apart, so an island has as many nodes as one that is alike. Only where
several answers are optimal do names choose one of them: then islands are counted once if their
names also compare alike.
"""

from collections.abc import Iterable, Mapping, Sequence, Set
from typing import NamedTuple

import clingo

from mars_asp.asp.fragments import Fragment
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.rules.symbols import symbol_of
from mars_asp.asp.signature import Signature
from mars_asp.asp.slice.portions import Portion
from mars_asp.asp.solve.atoms import Fact
from mars_asp.asp.solve.components import Component
from mars_asp.asp.solve.optimum import Optimum
from mars_asp.asp.solve.term_ids import TermId, arguments, as_symbol, as_term, labelled
from mars_asp.model.declarations import Control, Data, Mount, Relationship
from mars_asp.reasoning.facts.parts import Parts
from mars_asp.reasoning.questions.behind import able_to_fire, names_read, portion_reads, still_read
from mars_asp.reasoning.questions.islands import Forms, Island, Map
from mars_asp.reasoning.questions.sayings import Reading, differences, grounded
from mars_asp.reasoning.synthesis.synthesise import UNRESOLVABLE, costs_of

#: So many islands are counted together at least.
_TOGETHER = 32
#: So many nodes of a kind an island may well have.
_MANY = 8
#: The predicates that bring modules together.
_RELATING: Mapping[str, type[Relationship]] = {
    "uses_data_from": Data,
    "is_controlled_by": Control,
    "is_mounted_on": Mount,
}


class Told(NamedTuple):
    """The islands of a configuration, and who tells facts about them."""

    parts: Parts
    map: Map

    def facts(self, islands: Iterable[Island], wanted: Set[str]) -> tuple[Fact, ...]:
        """Return the facts of some predicates about islands."""
        islands = tuple(islands)
        modules = {name for each in islands for name in each.modules}
        lines = {number for each in islands for number in each.lines}
        return self.parts.facts(modules, lines, wanted)


def is_realisable(told: Told, base: Rulebook) -> bool:
    """Whether no island has what nothing can resolve, as the rules of the base behind that say."""
    base = able_to_fire(base, told.parts.absent(names_read(base)))
    wanted = told.parts.given(names_read(base))
    kinds = _kinds(wanted)
    forms = Forms(told.map, told.parts, wanted)
    islands = {forms.key(each, kinds): each for each in told.map.islands(kinds)}
    grounding = grounded(told.facts(islands.values(), wanted), base)
    return not any(True for _ in grounding.symbols(UNRESOLVABLE.name, UNRESOLVABLE.arity))


class Counter:
    """Counts the nodes of some kinds in islands, in the order of the file."""

    def __init__(
        self,
        told: Told,
        base: Rulebook,
        counting: Portion,
        counted: Mapping[str, Signature],
        deadline: float | None,
        sought: tuple[str, int],
    ) -> None:
        """Take the rules that decide how many there are: a portion of the resolution, and its base.

        Each atom of the predicates `counted` is a node of a kind; `sought` is such a kind, and
        which node of it is looked for.
        """
        self._sought = sought
        self._told, self._counting, self._counted = told, counting, counted
        self._deadline = deadline
        self._optima: dict[Component, Optimum] = {}
        able = able_to_fire(base, told.parts.absent(names_read(base)))
        # What is read only by rules that cannot fire makes no difference.
        self._base = still_read(able, portion_reads(counting))
        read = names_read(self._base) | {each.name for each in portion_reads(counting)}
        self.wanted = told.parts.given(read)
        self.relating = _kinds(self.wanted)
        #: The islands, which have numbers from 0.
        self.islands = told.map.islands(self.relating)
        self.kinds = tuple(counted)
        self._counts: dict[object, Mapping[str, int]] = {}
        #: Forms of islands that have several optimal answers.
        self._several: set[object] = set()
        self._keys: dict[int, object] = {}
        self._orders: dict[int, object] = {}
        self._forms = Forms(told.map, told.parts, self.wanted)
        # Of the first nodes too few are counted to be worth it.
        if self.relating == (Data,) and sought[1] > _TOGETHER:
            reading = Reading(counting, self._base, self.wanted)
            self._forms.see(differences(told.map, told.parts, self._forms, self.islands, reading))

    def of(self, number: int) -> Mapping[str, int] | None:
        """Return how many nodes of each kind an island has; `None` where time does not suffice."""
        key = self._key(number)
        if key not in self._counts:
            if not self._count(self._next(number)):
                return None
            key = self._key(number)
        return self._counts[key]

    def _key(self, number: int) -> object:
        known = self._keys.get(number)
        if known is None:
            known = self._forms.key(self.islands[number], self.relating)
            self._keys[number] = known
        if known not in self._several:
            return known
        if number not in self._orders:
            self._orders[number] = self._forms.order(self.islands[number])
        return known, self._orders[number]

    def _next(self, first: int) -> Sequence[int]:
        """Return the numbers of the next islands that have to be counted.

        They are so many as the node that is sought may well be away, as nodes were found before,
        and some more: to count again takes longer than to count a few too many.
        """
        found: dict[object, int] = {}
        begun = [self._counts[self._key(number)][self._sought[0]] for number in range(first)]
        left = self._sought[1] - sum(begun)
        away = left * len(begun) // sum(begun) if any(begun) else left // _MANY
        behind = first + 1 + away * 9 // 8
        for number in range(first, len(self.islands)):
            if number > behind and len(found) >= _TOGETHER:
                break
            key = self._key(number)
            if key not in self._counts:
                found.setdefault(key, number)
        return tuple(found.values())

    def _count(self, numbers: Sequence[int]) -> bool:
        islands = [self.islands[number] for number in numbers]
        facts = self._told.facts(islands, self.wanted)
        grounding = grounded(facts, self._base)
        grounding.add([Fragment(self._counting.settled, "rules")])
        program = [Fragment(self._counting.choosing, "rules")]
        with costs_of(facts):
            resolution, ties = grounding.resolve_unnamed(program, self._deadline, self._optima)
        if resolution.count is None:
            return False
        owner = Owner(self._told, islands)
        counts = [dict.fromkeys(self._counted, 0) for _ in islands]
        true = grounding.facts.union(resolution.answer.decided)
        for kind, predicate in self._counted.items():
            for atom, literal, is_fact in labelled(grounding.control, *predicate):
                place = owner.of(atom)
                if place is not None and (is_fact or literal in true):
                    counts[place][kind] += 1
        open_ = {owner.of(next(grounding.telling(part))) for part in ties}
        for place, (number, count) in enumerate(zip(numbers, counts, strict=True)):
            if place in open_:
                self._several.add(self._keys[number])
            self._counts[self._key(number)] = count
        return True


class Owner:
    """Finds the island that a term is about, by its number among some."""

    def __init__(self, told: Told, islands: Sequence[Island]) -> None:
        """Take the islands."""
        self._number_of = {
            as_term(symbol_of(thing)): number
            for number, island in enumerate(islands)
            for thing in told.parts.things(island.modules, island.lines)
        }

    def called(self, term: TermId) -> int | None:
        """Return the number of the island of a name or identifier; `None` where it is another's."""
        return self._number_of.get(term)

    def of(self, atom: TermId) -> int | None:
        """Return the number of the island that an atom names; `None` where it names another.

        Numbers in it need not be identifiers, so the first name that is known decides.
        """
        waiting = [atom]
        for term in waiting:
            match as_symbol(term).type:
                case clingo.SymbolType.Function:
                    waiting += arguments(term)
                case clingo.SymbolType.String if term in self._number_of:
                    return self._number_of[term]
        return None


def _kinds(wanted: Set[str]) -> tuple[type[Relationship], ...]:
    """Return the kinds of relationships that some predicates tell."""
    return tuple(kind for name, kind in _RELATING.items() if name in wanted)
