"""Facts found by an identifier or a module's name, and made only when somebody looks for them.

They are the facts of `reasoning.facts.compile`, as a question about a few modules of many needs
them.
"""

from bisect import bisect_right
from collections.abc import Callable, Iterable, Mapping, Sequence, Set
from functools import cached_property
from itertools import accumulate
from typing import TypeAlias

from mars_asp.asp.solve.atoms import Fact, Term
from mars_asp.model.declarations import Configuration, Module, Name, ends_of
from mars_asp.reasoning.facts.compile import ANNOTATIONS, FRAMES, RELATIONSHIPS, Compiler
from mars_asp.reasoning.facts.identifiers import annotations_of

#: Given predicates, by name and arity, and the positions from 0 of the arguments by which their
#: facts are found: identifiers, and names of modules.
_SINGLY: Mapping[tuple[str, int], tuple[int, ...]] = {
    ("module", 1): (0,),
    ("node", 2): (0,),
    ("place", 4): (0,),
    ("uses_data_from", 3): (0, 1, 2),
    ("required_mode", 2): (0,),
    ("required_rate", 2): (0,),
    ("is_controlled_by", 3): (0, 1, 2),
    ("priority", 2): (0,),
    ("stated_priority", 1): (0,),
    ("hold", 2): (0,),
    ("allocation", 2): (0,),
    ("is_mounted_on", 5): (0, 1, 3),
    ("described", 1): (0,),
    ("class", 2): (0,),
    ("native", 3): (0, 1),
    ("converts", 5): (0, 1),
    ("commands", 3): (0, 1),
    ("unknown_input", 3): (0, 1),
    ("input", 4): (0, 1),
    ("ambiguous_name", 4): (0, 1),
    ("delivers", 2): (0, 1),
    ("output", 3): (0, 1),
    ("offered_mode", 3): (0,),
    ("offered_rate", 2): (0,),
}
#: Those of which all facts are made together, so that any argument finds them.
_TOGETHER = {
    "architecture": 1,
    "period": 1,
    "in_words": 3,
    "resembles": 2,
    "closed_walk": 6,
    "entangled": 3,
    "spelt": 3,
    "rooted": 3,
    "appears": 5,
    "appears_in_part": 5,
    "lever_arm": 4,
    "combines": 5,
    "support": 4,
    "shares": 5,
    "circuit": 5,
}
#: All given predicates, and the positions of the arguments by which their facts are found.
KEYS: Mapping[tuple[str, int], Sequence[int]] = {
    **_SINGLY,
    **{(name, arity): range(arity) for name, arity in _TOGETHER.items()},
}
#: The positions of what a fact connects: modules, relationships and annotations of one part of a
#: configuration. A converter is for whoever needs it.
CONNECTED: Mapping[tuple[str, int], tuple[int, ...]] = {
    signature: () if signature == ("converts", 5) else _SINGLY.get(signature, ())
    for signature in KEYS
}

_Group: TypeAlias = dict[tuple[Term, ...], list[Fact]]


class Lookup:
    """The facts of some predicates, found by `KEYS`."""

    def __init__(
        self,
        configuration: Configuration,
        modules: Mapping[str, Module],
        wanted: Set[str],
        frame_facts: Callable[[], Iterable[Fact]] = tuple,
    ) -> None:
        """Look for facts of the predicates `wanted`; nothing is made yet.

        `frame_facts` gives what mounts do to motions, when it is asked for.
        """
        self._configuration = configuration
        self._compiler = Compiler(configuration, modules, wanted)
        self._frame_facts = frame_facts
        self._told: dict[int | Name | str, Sequence[Fact]] = {}
        #: By (name, positions, value), facts by the values at these positions.
        self._groups: dict[tuple[object, ...], _Group] = {}

    @property
    def facts(self) -> tuple[Fact, ...]:
        """Return all facts that were made."""
        return tuple(self._compiler.facts)

    def find(
        self, name: str, positions: tuple[int, ...], values: tuple[Term, ...]
    ) -> Sequence[Fact]:
        """Return the facts of a predicate with values at positions, one of which is of its `KEYS`.

        They are looked for by one value and grouped by all, so that each fact is seen once only.
        """
        by: tuple[object, ...] = (name, positions)
        key, value = 0, None
        if name not in _TOGETHER:
            keys = next(keys for (known, _), keys in _SINGLY.items() if known == name)
            key, value = next(
                pair for pair in zip(positions, values, strict=True) if pair[0] in keys
            )
            by = (name, positions, value)
        group = self._groups.get(by)
        if group is None:
            group = self._groups[by] = {}
            for thing in self._things(name, value):
                for fact in self._facts_of(thing):
                    told = fact.atom.arguments
                    if fact.atom.name == name and (value is None or told[key] == value):
                        group.setdefault(tuple(told[place] for place in positions), []).append(fact)
        return group.get(values, ())

    def _facts_of(self, thing: int | Name | str) -> Sequence[Fact]:
        if thing not in self._told:
            first = len(self._compiler.facts)
            self._tell(thing)
            self._told[thing] = self._compiler.facts[first:]
        return self._told[thing]

    def _things(self, name: str, value: "Term | None") -> Sequence[int | Name | str]:
        """Return what tells facts: identifiers of relationships, names, and described modules.

        What is told together stands for itself, by what no module is called.
        """
        if value is None:
            return (f"{name}/",)
        if isinstance(value, int):
            if value > len(self._configuration.relationships):
                return self._annotated_by(value) if name in ANNOTATIONS else ()
            return (value,) if name in RELATIONSHIPS and value > 0 else ()
        if not isinstance(value, str):
            return ()
        if name in ("module", "node", "place"):
            return self._names.get(value, ())
        if name in RELATIONSHIPS:
            return self._ends.get(value, ())
        return (value,) if value in self._compiler.described else ()

    def _tell(self, thing: int | Name | str) -> None:
        compiler = self._compiler
        if isinstance(thing, int):
            compiler.relationship(*compiler.numbered[thing - 1])
        elif isinstance(thing, Name):
            compiler.module(thing)
        elif thing.endswith("/"):
            self._tell_together(thing.removesuffix("/"))
        else:
            module = compiler.described[thing]
            compiler.description(module)
            for number, annotation in enumerate(annotations_of(module), self._first[thing]):
                compiler.annotation(number, module, annotation)

    def _tell_together(self, name: str) -> None:
        """Tell all facts of one predicate."""
        compiler = self._compiler
        if name in FRAMES:
            compiler.facts += (fact for fact in self._frames if fact.atom.name == name)
            return
        wanted, compiler.wanted = compiler.wanted, {name}
        compiler.tell()
        compiler.wanted = wanted

    @cached_property
    def _frames(self) -> Sequence[Fact]:
        return tuple(self._frame_facts())

    @cached_property
    def _names(self) -> Mapping[str, Sequence[Name]]:
        found: dict[str, list[Name]] = {}
        for name in self._configuration.modules:
            found.setdefault(name.text, []).append(name)
        return found

    @cached_property
    def _ends(self) -> Mapping[str, Sequence[int]]:
        """Return the identifiers of the relationships of each module."""
        found: dict[str, list[int]] = {}
        for number, relationship in self._compiler.numbered:
            left, right = ends_of(relationship)
            found.setdefault(left, []).append(number)
            if right != left:
                found.setdefault(right, []).append(number)
        return found

    @cached_property
    def _first(self) -> Mapping[str, int]:
        """Return the identifiers of the first annotations of described modules, in their order."""
        described = self._compiler.described
        counts = (len(annotations_of(module)) for module in described.values())
        first = len(self._configuration.relationships) + 1
        return dict(zip(described, accumulate(counts, initial=first), strict=False))

    def _annotated_by(self, number: int) -> Sequence[str]:
        """Return the module of an annotation; those without any share a number with the next."""
        names, firsts = self._owners
        place = bisect_right(firsts, number) - 1
        return (names[place],) if place >= 0 else ()

    @cached_property
    def _owners(self) -> tuple[Sequence[str], Sequence[int]]:
        return tuple(self._first), tuple(self._first.values())
