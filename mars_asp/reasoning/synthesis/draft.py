"""A specification under construction: its named nodes, and its lines in their order."""

from dataclasses import dataclass, replace

from mars_asp.asp.solve.term_ids import TermId, as_symbol, text
from mars_asp.model.declarations import (
    Conversion,
    Data,
    Relationship,
    Service,
    node_names,
)
from mars_asp.model.ports import free_positions, inputs
from mars_asp.reasoning.facts.ends import ends_in
from mars_asp.reasoning.facts.identifiers import numbered, numbered_annotations
from mars_asp.reasoning.project import Project
from mars_asp.reasoning.synthesis.derived import SpecifiedAtoms


@dataclass(frozen=True, slots=True)
class IntroducedNode:
    """An introduced node: its name, its kind, and the text of its term in the rules.

    `stands_for` is the module that an InheritanceNode represents; a DataTransformer has a
    `conversion`.
    """

    name: str
    kind: str
    term: str
    conversion: Conversion | None = None
    stands_for: str | None = None


class SpecificationDraft:
    """Collects nodes and lines in the order in which they are printed."""

    def __init__(self, project: Project) -> None:
        """Index the relationships and annotations of the configuration."""
        configuration, modules = project.configuration, project.modules
        self.span = configuration.span
        self._names = node_names(configuration.kinds)
        self.relationships = configuration.relationships
        places = {id(r): place for place, r in enumerate(configuration.relationships)}
        #: The index of each relationship in the file, by its identifier.
        self.place = {number: places[id(r)] for number, r in numbered(self.relationships)}
        described = project.described
        self.ends = ends_in(configuration, described)
        self.rates = project.rates
        self.services: dict[int, tuple[str, Service]] = {
            number: (module.name, annotation)
            for number, module, annotation in numbered_annotations(configuration, described)
            if isinstance(annotation, Service)
        }
        self.lines: list[Relationship] = []
        #: The index of the relationship that a line to a client realises, by the line's `id`.
        self.place_of: dict[int, int] = {}
        self.described = described.keys()
        #: Described modules whose lines need not name the input.
        self.with_one_input = {
            name for name, module in described.items() if len(inputs(module)) == 1
        }
        #: The nodes in the order in which they were named.
        self.nodes: dict[TermId, IntroducedNode] = {}
        declared = {module.name for module in configuration.declared}
        self._taken = {name.text for name in configuration.modules} | set(modules) | declared
        self._next: dict[str, int] = {}

    def name(self, term: TermId, derived: SpecifiedAtoms) -> str:
        """Return the name of a module or node; a new node gets its name here."""
        if term not in self.nodes:
            kind = derived.kinds.get(term)
            if kind is None:
                return derived.string(term)
            name = self._free_name(kind)
            conversion = self._conversion(term, name, derived)
            stands_for = derived.stands_for.get(term)
            self.nodes[term] = IntroducedNode(name, kind, text(term), conversion, stands_for)
        return self.nodes[term].name

    def places(self, derived: SpecifiedAtoms) -> dict[TermId, int]:
        """Return for each line the index of the first relationship that it represents."""
        found: dict[TermId, int] = {}
        for line, relationship in derived.rows("written_at", 2):
            place = self.place[as_symbol(relationship).number]
            if found.setdefault(line, place) > place:
                found[line] = place
        return found

    def name_positions(self) -> None:
        """Name the inputs of undescribed clients whose lines have changed their order."""
        lines: dict[str, list[Data]] = {}
        for line in self.lines:
            if isinstance(line, Data) and line.client not in self.described:
                if id(line) in self.place_of:
                    lines.setdefault(line.client, []).append(line)
        named: dict[int, Data] = {}
        for each in lines.values():
            unnamed = [line for line in each if line.client_port is None]
            ordered = sorted(unnamed, key=lambda line: self.place_of[id(line)])
            if unnamed == ordered:
                continue
            free = free_positions(line.client_port for line in each)
            for line, number in zip(ordered, free, strict=False):
                named[id(line)] = replace(line, client_port=f"input{number}")
        self.lines = [named.get(id(line), line) for line in self.lines]

    def _conversion(self, node: TermId, name: str, derived: SpecifiedAtoms) -> Conversion | None:
        """Return the conversion of a transformer as annotated, or None for another node."""
        if node not in derived.converts:
            return None
        source, target = derived.converts[node]
        annotation = derived.annotations.get(node)
        if annotation is None:
            return Conversion(name, None, source, target, self.span)
        converter, service = self.services[annotation]
        given = next((i for i in service.inputs if i is not None), "")
        return Conversion(name, converter, given, service.output or target, self.span)

    def _free_name(self, kind: str) -> str:
        """Return the next unused name for a node of a kind."""
        word = self._names.get(kind) or "".join(map(str.capitalize, kind.split("_")))
        while True:
            number = self._next.get(kind, 1)
            self._next[kind] = number + 1
            plain = kind == "arbitration_node" and number == 1
            name = word + ("" if plain else str(number))
            if name not in self._taken:
                return name
