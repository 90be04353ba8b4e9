"""A specification while it is written: nodes get names, lines get their order."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

from clingo import Symbol

from mars_asp.asp.signature import Signature
from mars_asp.model.declarations import (
    NODE_NAMES,
    Configuration,
    Conversion,
    Module,
    NodeKind,
    Relationship,
    Service,
)
from mars_asp.model.described import described_modules
from mars_asp.reasoning.facts.identifiers import numbered, numbered_annotations

#: The predicate of `rules/resolve` that has one atom for each node of a kind.
NODE_PREDICATES: Mapping[NodeKind, Signature] = {
    "data_splitter": Signature("splitter", 2),
    "data_transformer": Signature("transformer", 2),
    "arbitration_node": Signature("arbiter", 1),
    "control_splitter": Signature("control_splitter", 1),
    "inheritance_node": Signature("inheritance_node", 1),
}


@dataclass(frozen=True, slots=True)
class Node:
    """An introduced module: its name, its kind and the term by which the rules know it.

    An InheritanceNode stands for a module, a DataTransformer does a conversion.
    """

    name: str
    kind: NodeKind
    term: str
    conversion: Conversion | None = None
    stands_for: str | None = None


class Draft:
    """Collects nodes and lines in the order in which they are printed."""

    def __init__(self, configuration: Configuration, modules: Mapping[str, Module]) -> None:
        """Index what the configuration says."""
        self.span = configuration.span
        self.architecture = configuration.architecture
        self.relationships = dict(numbered(configuration.relationships))
        places = {id(r): place for place, r in enumerate(configuration.relationships)}
        #: The place of each relationship in the file, by its identifier.
        self.place = {number: places[id(r)] for number, r in self.relationships.items()}
        self.number = {place: number for number, place in self.place.items()}
        described = described_modules(configuration, modules)
        self.services: dict[int, tuple[str, Service]] = {
            number: (module.name, annotation)
            for number, module, annotation in numbered_annotations(configuration, described)
            if isinstance(annotation, Service)
        }
        self.nodes: dict[str, Node] = {}
        self.lines: list[Relationship] = []
        self._atoms: dict[str, list[Symbol]] = {}
        declared = {module.name for module in configuration.declared}
        self._names = {name.text for name in configuration.modules} | set(modules) | declared
        self._next: dict[NodeKind, int] = {}

    def tell(self, atoms: Iterable[Symbol]) -> None:
        """Index the true atoms of an answer set, for what is written from now on."""
        self._atoms = {}
        for atom in atoms:
            self._atoms.setdefault(atom.name, []).append(atom)

    def atoms(self, name: str) -> tuple[Symbol, ...]:
        """Return the true atoms with a name."""
        return tuple(self._atoms.get(name, ()))

    def rows(self, name: str, arity: int) -> list[Sequence[Symbol]]:
        """Return the arguments of the true atoms of a predicate."""
        found = (atom.arguments for atom in self.atoms(name))
        return [arguments for arguments in found if len(arguments) == arity]

    def node(
        self,
        kind: NodeKind,
        term: str,
        conversion: Conversion | None = None,
        stands_for: str | None = None,
    ) -> str:
        """Return the name of a node, introducing it where it is new."""
        if term not in self.nodes:
            name = self._free_name(kind)
            if conversion is not None:
                conversion = replace(conversion, transformer=name)
            self.nodes[term] = Node(name, kind, term, conversion, stands_for)
        return self.nodes[term].name

    def pass_over(self, kind: NodeKind, count: int, name: str) -> bool:
        """Count nodes that are not written here, unless one of them would have a name."""
        before = self._next.get(kind, 1)
        if name not in [self._free_name(kind) for _ in range(count)]:
            return True
        self._next[kind] = before
        return False

    def _free_name(self, kind: NodeKind) -> str:
        """Return the next name of a kind that no module has."""
        while True:
            number = self._next.get(kind, 1)
            self._next[kind] = number + 1
            plain = kind == "arbitration_node" and number == 1
            name = NODE_NAMES[kind] + ("" if plain else str(number))
            if name not in self._names:
                return name
