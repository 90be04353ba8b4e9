"""Modules that relationships bring together, and which of such islands are alike.

Two islands are alike when facts tell the same of them but for names and identifiers. What follows
for one of them follows for the other, unless the order of names or identifiers has to do with it.
"""

from collections.abc import Hashable, Iterable, Mapping, Sequence, Set
from typing import NamedTuple

from mars_asp.asp.solve.atoms import term_text
from mars_asp.asp.solve.disjoint_sets import DisjointSets
from mars_asp.model.declarations import (
    Configuration,
    Control,
    Data,
    Mount,
    Relationship,
    ends_of,
)
from mars_asp.reasoning.facts.parts import Parts


class Island(NamedTuple):
    """Modules and the identifiers of relationships between them, in the order of the file."""

    modules: tuple[str, ...]
    lines: tuple[int, ...]


class Map:
    """The relationships of a configuration, and the islands that those of some kinds make."""

    def __init__(
        self, configuration: Configuration, lines: Iterable[tuple[int, Relationship]]
    ) -> None:
        """Take the relationships of a configuration with their identifiers."""
        #: The relationships by their identifiers.
        self.line: Mapping[int, Relationship] = dict(lines)
        #: The modules that each relates.
        self.ends = {number: ends_of(line) for number, line in self.line.items()}
        number_of = {id(line): number for number, line in self.line.items()}
        self._lines = [(number_of[id(line)], line) for line in configuration.relationships]

    def islands(self, kinds: tuple[type[Relationship], ...]) -> list[Island]:
        """Return the islands that relationships of some kinds make, in the order of the file."""
        sets: DisjointSets[str] = DisjointSets()
        lines = [number for number, line in self._lines if isinstance(line, kinds)]
        for number in lines:
            sets.join(self.ends[number])
        found: dict[str, tuple[dict[str, None], list[int]]] = {}
        for number in lines:
            left, right = self.ends[number]
            modules, numbers = found.setdefault(sets.find(left), ({}, []))
            modules[left] = modules[right] = None
            numbers.append(number)
        return [Island(tuple(modules), tuple(numbers)) for modules, numbers in found.values()]

    def stretches(self) -> list[Island]:
        """Return runs of lines that hold whole islands, as short as can be.

        What is named in one has no number that depends on later ones.
        """
        place_of = {number: place for place, (number, _) in enumerate(self._lines)}
        found: list[tuple[list[str], list[int]]] = []
        behind = -1
        for each in self.islands((Data, Control, Mount)):
            if place_of[each.lines[0]] > behind:
                found.append(([], []))
            modules, lines = found[-1]
            modules += each.modules
            lines += each.lines
            behind = max(behind, place_of[each.lines[-1]])
        return [
            Island(tuple(modules), tuple(sorted(lines, key=place_of.__getitem__)))
            for modules, lines in found
        ]


class Forms:
    """What facts of some predicates tell of islands but for names and identifiers."""

    def __init__(self, map_: Map, parts: Parts, wanted: Set[str]) -> None:
        """Take the relationships, and who tells facts of the predicates."""
        self._line, self._ends, self._parts, self._wanted = map_.line, map_.ends, parts, wanted
        self._known: dict[Hashable, int] = {}
        self._kinds: dict[int, int] = {}
        self._kind_of: dict[str, int] = {}
        self._said: dict[int, int] = {}

    def form(self, island: Island) -> Hashable:
        """Return what is told of an island but for names and identifiers; alike ones are equal.

        The order of identifiers counts where several relate the same two modules.
        """
        if self._parts.has_muxes:
            return island
        modules, lines = self._canonical(island)
        place = {module: at for at, module in enumerate(modules)}
        told = []
        for number in lines:
            left, right = self._ends[number]
            told.append((place[left], place[right], self._saying(number)))
        return tuple(map(self._kind, modules)), tuple(told)

    def order(self, island: Island) -> Hashable:
        """Return how the names and identifiers of an island compare, in the order of its form."""
        modules, lines = self._canonical(island)
        if self._parts.has_ports:
            return island
        numbers = [number for module in modules for number in self._parts.annotations(module)]
        least, least_line = min(numbers, default=0), min(lines)
        return (
            *(_ranks(modules), _ranks(list(map(term_text, modules)))),
            *(tuple(number - least_line for number in lines), _ranks(list(map(str, lines)))),
            *(tuple(number - least for number in numbers), _ranks(list(map(str, numbers)))),
        )

    def _canonical(self, island: Island) -> tuple[Sequence[str], Sequence[int]]:
        """Return modules and lines in an order that has little to do with names."""
        beside: dict[str, list[tuple[int, int, str]]] = {module: [] for module in island.modules}
        for number in island.lines:
            left, right = self._ends[number]
            said = self._saying(number)
            beside[left].append((said, 0, right))
            beside[right].append((said, 1, left))
        colour = {module: self._kind(module) for module in island.modules}
        colour = {
            module: self._number(
                (colour[module], *sorted([(said, side, colour[o]) for said, side, o in others]))
            )
            for module, others in beside.items()
        }
        modules = sorted(island.modules, key=colour.__getitem__)
        place = {module: at for at, module in enumerate(modules)}

        def between(number: int) -> tuple[int, int, int]:
            left, right = self._ends[number]
            return place[left], place[right], number

        return modules, sorted(island.lines, key=between)

    def _number(self, told: Hashable) -> int:
        return self._known.setdefault(told, len(self._known))

    def _kind(self, name: str) -> int:
        """Return a number for what is told of a module by itself."""
        known = self._kind_of.get(name)
        if known is None:
            kind = self._parts.kind(name)
            if kind not in self._kinds:
                self._kinds[kind] = self._number(self._parts.told_alone(name, self._wanted))
            known = self._kind_of[name] = self._kinds[kind]
        return known

    def _saying(self, number: int) -> int:
        """Return a number for all that a line says besides the names of modules."""
        known = self._said.get(number)
        if known is None:
            known = self._said[number] = self._number(_said(number, self._line[number]))
        return known


def _said(number: int, line: Relationship) -> Hashable:
    match line:
        case Data(_, _, _, mode, hz, client_port, source_port):
            wanted = mode and (mode.name, mode.arguments, mode.of)
            return wanted, hz and hz.as_integer_ratio(), client_port, source_port
        case Control(_, _, _, priority, hold, allocation, listed):
            return "control", priority, hold, allocation, listed
        case Mount():
            # What mounts do to motions is computed of all of them.
            return "mount", number


def _ranks(values: Sequence[str]) -> tuple[int, ...]:
    return tuple(sorted(range(len(values)), key=values.__getitem__))
