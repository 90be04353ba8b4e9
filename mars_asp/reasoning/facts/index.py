"""Facts found by an identifier or a module's name, and made only when somebody looks for them.

They are the facts of `reasoning.facts.compile`, as a question about a few modules of many needs
them.
"""

from bisect import bisect_right
from collections.abc import Callable, Iterable, Mapping, Sequence, Set
from functools import cached_property
from itertools import accumulate
from typing import TypeAlias

from mars_asp.asp.solve.atoms import Atom, Fact, Term
from mars_asp.model.declarations import Configuration, Data, Module, Name, ends_of
from mars_asp.reasoning.facts.compile import (
    ANNOTATIONS,
    FRAMES,
    HEADING,
    PORTS,
    RELATIONSHIPS,
    Compiler,
)
from mars_asp.reasoning.facts.identifiers import annotations_of
from mars_asp.reasoning.facts.vocabulary import Vocabulary

_Group: TypeAlias = dict[tuple[Term, ...], list[Fact]]


class Lookup:
    """The facts of some predicates, found by the keys of their vocabulary."""

    def __init__(
        self,
        configuration: Configuration,
        modules: Mapping[str, Module],
        wanted: Set[str],
        vocabulary: Vocabulary,
        frame_facts: Callable[[], Iterable[Fact]] = tuple,
        attributes: Iterable[Fact] = (),
    ) -> None:
        """Look for facts of the predicates `wanted`; nothing is made yet.

        `frame_facts` gives what mounts do to motions, when it is asked for. `attributes` are made
        already, with their places.
        """
        self._configuration = configuration
        self._by_thing = vocabulary.by_thing
        self._compiler = Compiler(configuration, modules, wanted)
        self._frame_facts = frame_facts
        self._attributes: dict[str, list[Fact]] = {}
        for fact in attributes:
            stated = fact.atom
            if stated.name == "place" and isinstance(stated.arguments[0], Atom):
                stated = stated.arguments[0]
            self._attributes.setdefault(stated.name, []).append(fact)
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
        """Return the facts of a predicate with values at positions, one of which is of its keys.

        They are looked for by one value and grouped by all, so that each fact is seen once only.
        """
        by: tuple[object, ...] = (name, positions)
        key, value = 0, None
        # Attributes are few, and told together.
        keys = None if name in self._attributes else self._by_thing.get(name)
        if keys is not None:
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
        if value is None or name in PORTS | HEADING:
            return (f"{name}/",)
        if isinstance(value, Atom):
            return (f"{value.name}/",) if value.name in self._attributes else ()
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
        output = self._compiler.ends.outputs.get(value)
        owner = value if output is None else output.module
        return (owner,) if owner in self._compiler.described else ()

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
        """Add all facts of one predicate."""
        compiler = self._compiler
        if name in self._attributes:
            compiler.facts += self._attributes[name]
            return
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
            others = {right}
            if isinstance(relationship, Data):
                others.add(self._compiler.ends.source(relationship))
            for other in others - {left}:
                found.setdefault(other, []).append(number)
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
