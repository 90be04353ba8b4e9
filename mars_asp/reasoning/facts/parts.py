"""The facts about a few modules of many, as those about all have them."""

from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence, Set
from fractions import Fraction
from functools import cached_property
from itertools import accumulate
from operator import attrgetter

from mars_asp.asp.signature import Signature
from mars_asp.asp.solve.atoms import Fact, Term
from mars_asp.model.declarations import Configuration, Module, Mount, Name, Relationship
from mars_asp.reasoning.facts.compile import (
    ANNOTATIONS,
    FRAMES,
    MODULES,
    RELATIONSHIPS,
    Compiler,
)
from mars_asp.reasoning.facts.identifiers import annotations_of
from mars_asp.reasoning.facts.vocabulary import Vocabulary

#: Predicates of which each fact is told of one thing; of others, all facts are told together.
_OF_THINGS = MODULES | RELATIONSHIPS | ANNOTATIONS
#: What is told of services and of functions.
_OF_SERVICE = attrgetter(
    *("kind", "function", "output", "inputs", "modes", "commands", "cost", "port", "parameters"),
    "hz",
)
_OF_FUNCTION = attrgetter("name", "min", "max", "rate")


class Parts:
    """Tells the facts about parts of a configuration that no relationship leads out of."""

    def __init__(
        self,
        configuration: Configuration,
        modules: Mapping[str, Module],
        vocabulary: Vocabulary,
        everywhere: Mapping[Signature, Sequence[int]],
        frame_facts: Callable[[], Iterable[Fact]],
        wanted: Set[str],
    ) -> None:
        """Take a configuration.

        Of the predicates `everywhere` each part has one fact, of another or its own, for all that
        are equal in some arguments. `frame_facts` gives what mounts do to motions. No facts are
        asked for but of the predicates `wanted`.
        """
        self._compiler = Compiler(configuration, modules, None)
        #: The arguments of given predicates that a fact brings together.
        self.connected = vocabulary.connected
        self._everywhere = {each.name: positions for each, positions in everywhere.items()}
        #: The names of predicates whose facts are about no part, or told everywhere.
        self._of_all = self._everywhere.keys() | {
            each.name for each, connected in vocabulary.connected.items() if not connected
        }
        self._frame_facts = frame_facts
        self._wanted = wanted
        #: What `kind` returned, by names of modules, by what modules hold, and by what is told.
        self._kinds: dict[str, int] = {}
        self._known: dict[Hashable, int] = {}
        self._numbers: dict[Hashable, int] = {}

    @property
    def described(self) -> Mapping[str, Module]:
        """Return the modules that rules are told of."""
        return self._compiler.described

    def facts(self, modules: Set[str], lines: Set[int], wanted: Set[str]) -> tuple[Fact, ...]:
        """Return the facts of predicates `wanted` about modules and the lines between them.

        `lines` are identifiers of relationships. Facts come in the order of those about all.
        """
        things = self.things(modules, lines)
        found: list[Fact] = []
        for name in self._together(wanted):
            told, about = self._told[name], self._about[name]
            if about is None:
                found += told
                continue
            own = {place for thing in about.keys() & things for place in about[thing]}
            found += map(told.__getitem__, sorted(own.union(self._of_every_part.get(name, ()))))
        return (*found, *self._of_things(modules, lines, wanted & _OF_THINGS - self._of_all))

    def _of_things(
        self, modules: Set[str], lines: Iterable[int], wanted: Set[str]
    ) -> Sequence[Fact]:
        """Return what is told of modules and lines, one by one."""
        compiler, described = self._compiler, self._described_among(modules)
        compiler.wanted = wanted
        for _, name in sorted(each for m in modules for each in self._names.get(m, ())):
            compiler.module(name)
        for number in sorted(lines):
            compiler.relationship(*compiler.numbered[number - 1])
        for each in described:
            compiler.description(compiler.described[each])
        for each in described:
            module = compiler.described[each]
            numbered = zip(self.annotations(each), annotations_of(module), strict=True)
            for number, annotation in numbered:
                compiler.annotation(number, module, annotation)
        told = compiler.facts[:]
        compiler.facts.clear()
        return told

    def _described_among(self, modules: Set[str]) -> Sequence[str]:
        """Return those of some modules that are described, in the order of their identifiers."""
        return sorted(name for name in modules if name in self._first)

    def things(self, modules: Iterable[str], lines: Iterable[int]) -> Set[Term]:
        """Return the names and identifiers of what modules and lines are, and what they have."""
        found: set[Term] = {*modules, *lines}
        for name in modules:
            found.update(self.annotations(name))
            found.update(self._ports.get(name, ()))
        return found

    def given(self, names: Set[str]) -> Set[str]:
        """Return the given predicates of some."""
        return {each.name for each in self.connected if each.name in names}

    def absent(self, wanted: Set[str]) -> Set[str]:
        """Return the given predicates of some that are told of all together and have no fact."""
        given = self.given(wanted) - _OF_THINGS
        return given - self._told.keys()

    def _together(self, wanted: Set[str]) -> Sequence[str]:
        """Return those of some predicates whose facts are about all, or told of all together."""
        return sorted((wanted & self._of_all | wanted - _OF_THINGS) & self._told.keys())

    @cached_property
    def _told(self) -> Mapping[str, Sequence[Fact]]:
        """Return the facts that are about all, or told of all together, by their predicates."""
        compiler, wanted = self._compiler, self._wanted
        compiler.wanted = wanted & self._of_all | wanted - _OF_THINGS
        if not any(isinstance(line, Mount) for _, line in compiler.numbered):
            compiler.wanted -= {"is_mounted_on"}
        compiler.tell()
        frames = self._frame_facts() if compiler.wanted & FRAMES else ()
        found: dict[str, list[Fact]] = {}
        for fact in (*compiler.facts, *frames):
            if fact.atom.name in compiler.wanted:
                found.setdefault(fact.atom.name, []).append(fact)
        compiler.facts.clear()
        return found

    @cached_property
    def _about(self) -> Mapping[str, Mapping[Term, Sequence[int]] | None]:
        """Return which of the facts that are told together are about each thing, by its name.

        `None` where they are about no part.
        """
        found: dict[str, Mapping[Term, Sequence[int]] | None] = {}
        for name, told in self._told.items():
            connected = self.connected[Signature(name, len(told[0].atom.arguments))]
            about: dict[Term, list[int]] = {}
            for place, fact in enumerate(told if connected else ()):
                for at in connected:
                    about.setdefault(fact.atom.arguments[at], []).append(place)
            found[name] = about if connected else None
        return found

    @cached_property
    def _of_every_part(self) -> Mapping[str, Sequence[int]]:
        """Return which facts every part has, by predicates: the first of those that look alike."""
        found: dict[str, Sequence[int]] = {}
        for name in self._everywhere.keys() & self._told.keys():
            looked, first = self._everywhere[name], dict[Hashable, int]()
            for place, fact in enumerate(self._told[name]):
                first.setdefault(tuple(fact.atom.arguments[at] for at in looked), place)
            found[name] = tuple(first.values())
        return found

    def annotations(self, name: str) -> range:
        """Return the identifiers of the annotations of a module."""
        first = self._first.get(name, 0)
        return range(first, first + len(annotations_of(self.described[name])) if first else 0)

    @property
    def numbered(self) -> Sequence[tuple[int, Relationship]]:
        """Return the relationships with their identifiers."""
        return self._compiler.numbered

    def kind(self, name: str) -> int:
        """Return what is equal for modules of which all is told alike but names and identifiers."""
        known = self._kinds.get(name)
        if known is None:
            module, is_named = self.described.get(name), name in self._names
            if module is None:
                known = self._number((is_named, self._node_kind(name)))
            else:
                # Modules read once have in common what was read, and identity tells that faster.
                same = is_named, *map(id, _held(module))
                known = self._known.get(same)
                if known is None:
                    known = self._known[same] = self._number((is_named, _compared(module)))
            self._kinds[name] = known
        return known

    def _number(self, told: Hashable) -> int:
        return self._numbers.setdefault(told, len(self._numbers))

    def _node_kind(self, name: str) -> str | None:
        configuration = self._compiler.configuration
        return configuration.node_kind(name) if configuration.kind == "specification" else None

    def told_alone(self, name: str, wanted: Set[str]) -> Hashable:
        """Return the facts of predicates `wanted` about a module alone, without identifiers.

        Where lines name ports, or modules have several outputs, that is all that is told of it.
        """
        if self.has_ports:
            return self.kind(name)
        told = self._of_things({name}, (), wanted & _OF_THINGS - {"place"})
        numbers = {number: at for at, number in enumerate(self.annotations(name))}
        found: list[Hashable] = []
        for fact in told:
            values = fact.atom.arguments
            connected = self.connected[Signature(fact.atom.name, len(values))]
            plain: list[Hashable] = list(values)
            for at in connected:
                value = values[at]
                plain[at] = numbers.get(value, 0) if isinstance(value, int) else None
            found.append((fact.atom.name, *plain))
        return tuple(found)

    @cached_property
    def has_ports(self) -> bool:
        """Whether lines name ports, or modules have several outputs."""
        ends = self._compiler.ends
        return bool(ends.outputs or ends.entries)

    @property
    def has_muxes(self) -> bool:
        """Whether a robot that is not ours has muxes, or nodes that could not be read."""
        configuration = self._compiler.configuration
        return bool(configuration.muxes or configuration.opaque)

    @cached_property
    def _ports(self) -> Mapping[str, Sequence[str]]:
        """Return the names of outputs and inputs that rules are told of, by their modules."""
        found: dict[str, list[str]] = {}
        ends = self._compiler.ends
        modules = {text: each.module for text, each in ends.outputs.items()}
        modules |= {text: each.module for text, each in ends.entries.items()}
        for text, module in modules.items():
            found.setdefault(module, []).append(text)
        return found

    @cached_property
    def _names(self) -> Mapping[str, Sequence[tuple[int, Name]]]:
        """Return where the configuration names each module, with the places in its list."""
        found: dict[str, list[tuple[int, Name]]] = {}
        for place, name in enumerate(self._compiler.configuration.modules):
            found.setdefault(name.text, []).append((place, name))
        return found

    @cached_property
    def _first(self) -> Mapping[str, int]:
        """Return the identifiers of the first annotations of described modules, in their order."""
        described = self._compiler.described
        counts = (len(annotations_of(module)) for module in described.values())
        first = len(self._compiler.configuration.relationships) + 1
        return dict(zip(described, accumulate(counts, initial=first), strict=False))


def _held(module: Module) -> Sequence[object]:
    """Return what rules are told of a module, besides whether and where it is named."""
    services, functions = module.services, module.functions
    found: list[object] = [len(services), module.guard is not None]
    for service in services:
        found += _OF_SERVICE(service)
    for function in functions:
        found += _OF_FUNCTION(function)
    return found


def _compared(module: Module) -> Hashable:
    """Return what modules hold, to be compared: to hash fractions takes long."""
    return tuple(x.as_integer_ratio() if isinstance(x, Fraction) else x for x in _held(module))
