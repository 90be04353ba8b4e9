"""Modules that relationships bring together, and which of such islands are alike.

Two islands are alike when facts tell the same of them but for names and identifiers. What follows
for one of them follows for the other, unless the order of names or identifiers has to do with it.
"""

from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence, Set
from typing import NamedTuple, TypeAlias, TypeVar

from mars_asp.asp.solve.atoms import term_text
from mars_asp.model.declarations import (
    Configuration,
    Control,
    Data,
    Mount,
    Relationship,
    ends_of,
)
from mars_asp.reasoning.facts.parts import Parts

_Key = TypeVar("_Key", bound=Hashable)
_Value = TypeVar("_Value")


class Island(NamedTuple):
    """Modules and the identifiers of relationships between them, in the order of the file."""

    modules: tuple[str, ...]
    lines: tuple[int, ...]


class _Once(dict[_Key, _Value]):
    """What is found of each key, once."""

    def __init__(self, find: Callable[[_Key], _Value]) -> None:
        super().__init__()
        self._find = find

    def __missing__(self, key: _Key) -> _Value:
        found = self[key] = self._find(key)
        return found


#: A line, a module that no other names, the one beside it, and whether that comes second.
Leaf: TypeAlias = tuple[int, str, str, bool]


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
        #: A number for all that a line says besides the names of modules.
        self.saying: _Once[int, int] = _Once(lambda n: numbers[_said(n, self.line[n])])
        numbers: _Once[Hashable, int] = _Once(lambda _: len(numbers))
        self._leaves: dict[Sequence[int], tuple[Sequence[Leaf], Sequence[int]]] = {}
        self._kinds = frozenset(type(line) for _, line in self._lines)
        self._islands: dict[Set[type[Relationship]], Sequence[Island]] = {}

    def islands(self, kinds: Iterable[type[Relationship]]) -> Sequence[Island]:
        """Return the islands that relationships of some kinds make, in the order of the file."""
        there = self._kinds.intersection(kinds)
        if there not in self._islands:
            self._islands[there] = self._joined(tuple(there))
        return self._islands[there]

    def _joined(self, kinds: tuple[type[Relationship], ...]) -> Sequence[Island]:
        found: dict[str, list[int]] = {}
        for place, (number, line) in enumerate(self._lines):
            if isinstance(line, kinds):
                left, right = self.ends[number]
                one, other = found.get(left), found.get(right)
                if one is None or other is None:
                    places = one or other or []
                    found[left] = found[right] = places
                elif one is not other:
                    places, fewer = (one, other) if len(one) >= len(other) else (other, one)
                    places += fewer
                    for at in fewer:
                        for end in self.ends[self._lines[at][0]]:
                            found[end] = places
                else:
                    places = one
                places.append(place)
        each = {id(places): sorted(places) for places in found.values()}
        return [self._island(places) for places in sorted(each.values())]

    def _island(self, places: Sequence[int]) -> Island:
        lines = [self._lines[place][0] for place in places]
        modules = dict.fromkeys([end for number in lines for end in self.ends[number]])
        return Island(tuple(modules), tuple(lines))

    def leaves(self, island: Island) -> tuple[Sequence[Leaf], Sequence[int]]:
        """Return the lines of an island to modules that no other names, and the other lines."""
        known = self._leaves.get(island.lines)
        if known is not None:
            return known
        named = dict.fromkeys(island.modules, 0)
        for number in island.lines:
            for end in self.ends[number]:
                named[end] += 1
        leaves: list[Leaf] = []
        others: list[int] = []
        for number in island.lines:
            left, right = self.ends[number]
            if left == right or (named[left] > 1 and named[right] > 1):
                others.append(number)
            elif named[left] == 1:
                leaves.append((number, left, right, True))
            else:
                leaves.append((number, right, left, False))
        found = self._leaves[island.lines] = leaves, others
        return found

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


#: What a line says of a module that no other names: numbers for what is told of that module by
#: itself, for what the line says besides names, and for what is told of the module beside it; and
#: whether that comes second.
Saying: TypeAlias = tuple[int, int, int, bool]


class Forms:
    """What facts of some predicates tell of islands but for names and identifiers."""

    def __init__(self, map_: Map, parts: Parts, wanted: Set[str]) -> None:
        """Take the relationships, and who tells facts of the predicates."""
        self._map, self._ends = map_, map_.ends
        self._parts, self._wanted = parts, wanted
        #: Numbers for what is told of things: equal ones for what is equal.
        self._number: _Once[Hashable, int] = _Once(lambda _: len(self._number))
        #: What is told of a module by itself.
        self._kind: _Once[str, int] = _Once(self._told_alone)
        self._saying = map_.saying
        self._alone: dict[int, int] = {}
        self._seen: Mapping[Saying, Hashable] = {}
        self._leaf: _Once[Saying, int] = _Once(self._seen_of)
        self._untold = self._number[()]

    def see(self, seen: Mapping[Saying, Hashable]) -> None:
        """Take what is seen of some sayings: from now on those are alike of which it is equal."""
        self._seen = seen
        self._leaf.clear()

    def sayings(self, island: Island) -> list[Saying]:
        """Return the sayings of the leaves of an island, in their order."""
        kind, said = self._kind, self._saying
        return [
            (kind[leaf], said[number], kind[other], is_left)
            for number, leaf, other, is_left in self._map.leaves(island)[0]
        ]

    def key(self, island: Island, kinds: tuple[type[Relationship], ...]) -> Hashable:
        """Return what is equal for islands that count as one while answers are unique.

        `kinds` are those of the relationships. Of data lines rules compare those alone that relate
        the same two modules; lines of control are ordered by their identifiers.
        """
        return self.form(island) if kinds == (Data,) else self.order(island)

    def form(self, island: Island) -> Hashable:
        """Return what is told of an island but for names and identifiers; alike ones are equal."""
        if self._parts.has_muxes or self._takes_turns(island):
            return island
        leaves, inner = self._map.leaves(island)
        beside: dict[str, list[int]] = {}
        for (_, _, other, _), saying in zip(leaves, self.sayings(island), strict=True):
            beside.setdefault(other, []).append(self._leaf[saying])
        kinds = {
            module: self._number[(self._kind[module], *sorted(each))]
            for module, each in beside.items()
        }
        if not inner:
            return tuple(kinds.values())
        for number in inner:
            for module in self._ends[number]:
                kinds.setdefault(module, self._kind[module])
        return self._arranged(*self._canonical(kinds, inner), kinds)

    def _takes_turns(self, island: Island) -> bool:
        """Whether the order of lines may say which input of their client they mean."""
        if not self._parts.has_ports:
            return False
        clients = [self._ends[number][0] for number in island.lines]
        return len(set(clients)) < len(clients)

    def _arranged(
        self, modules: Sequence[str], lines: Sequence[int], kinds: Mapping[str, int]
    ) -> Hashable:
        """Return what is told of modules and lines in an order.

        The order of identifiers counts where several relate the same two modules.
        """
        place = {module: at for at, module in enumerate(modules)}
        told = []
        for number in lines:
            left, right = self._ends[number]
            told.append((place[left], place[right], self._saying[number]))
        return tuple(map(kinds.__getitem__, modules)), tuple(told)

    def order(self, island: Island) -> Hashable:
        """Return what is told of an island, and how its names and identifiers compare."""
        if self._parts.has_ports or self._parts.has_muxes:
            return island
        kinds = {module: self._kind[module] for module in island.modules}
        modules, lines = self._canonical(kinds, island.lines)
        # Of whom no fact tells anything by themselves, annotations have no identifier in any.
        described = [module for module in modules if kinds[module] != self._untold]
        numbers = [number for module in described for number in self._parts.annotations(module)]
        least, least_line = min(numbers, default=0), min(lines)
        return (
            self._arranged(modules, lines, kinds),
            *(_ranks(modules), _ranks(list(map(term_text, modules)))),
            *(tuple(number - least_line for number in lines), _ranks(list(map(str, lines)))),
            *(tuple(number - least for number in numbers), _ranks(list(map(str, numbers)))),
        )

    def _canonical(
        self, kinds: Mapping[str, int], numbers: Sequence[int]
    ) -> tuple[Sequence[str], Sequence[int]]:
        """Return modules and lines in an order that has little to do with names."""
        beside: dict[str, list[tuple[int, int, str]]] = {module: [] for module in kinds}
        for number in numbers:
            left, right = self._ends[number]
            said = self._saying[number]
            beside[left].append((said, 0, right))
            beside[right].append((said, 1, left))
        colour = {
            module: self._number[
                (kinds[module], *sorted([(said, side, kinds[o]) for said, side, o in others]))
            ]
            for module, others in beside.items()
        }
        modules = sorted(kinds, key=colour.__getitem__)
        place = {module: at for at, module in enumerate(modules)}

        def between(number: int) -> tuple[int, int, int]:
            left, right = self._ends[number]
            return place[left], place[right], number

        return modules, sorted(numbers, key=between)

    def _told_alone(self, name: str) -> int:
        kind = self._parts.kind(name)
        if kind not in self._alone:
            self._alone[kind] = self._number[self._parts.told_alone(name, self._wanted)]
        return self._alone[kind]

    def _seen_of(self, saying: Saying) -> int:
        leaf, said, _, is_left = saying
        return self._number[(leaf, self._seen.get(saying, said), is_left)]


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
