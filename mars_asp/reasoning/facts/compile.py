"""Configurations and annotations as facts; `rules/vocabulary.lp` declares their predicates."""

from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from fractions import Fraction
from typing import NamedTuple, get_args

from mars_asp.annotations.representations import RepresentationNames, canonical_names
from mars_asp.asp.fragments import Fragment, fact_fragment
from mars_asp.asp.solve.atoms import Atom, Fact, Term
from mars_asp.diagnostic import Span, point
from mars_asp.model.declarations import (
    FOREIGN,
    FOREVER,
    GATING,
    NODE_NAMES,
    STRATEGIES,
    Allocation,
    Architecture,
    Configuration,
    Control,
    Data,
    Engine,
    Function,
    Gating,
    Limit,
    Lock,
    Mode,
    Module,
    Mount,
    Relationship,
    Reset,
    Service,
    Strategy,
    ends_of,
    ports_of,
)
from mars_asp.model.described import CLASSES, annotated_classes, described_modules
from mars_asp.model.ports import DELIVERING, outputs
from mars_asp.model.rates import as_written
from mars_asp.output import encodable
from mars_asp.reasoning.facts.closed_walks import KNOTS, closed_walks
from mars_asp.reasoning.facts.ends import Ends, ends_in
from mars_asp.reasoning.facts.identifiers import (
    ANY,
    NONE,
    PERIODIC,
    hold_term,
    mode_term,
    numbered,
    numbered_annotations,
)
from mars_asp.reasoning.facts.ports import (
    input_facts,
    loose_ends,
    named_inputs,
    output_facts,
    turns,
    unknown_ports,
)
from mars_asp.reasoning.facts.rates import Rates, rates_in, rounded_rates
from mars_asp.spelling import nearest, resemblances


class FactNaming(NamedTuple):
    """The names of ports and representations in facts, and the numbers that represent rates."""

    ends: Ends
    rates: Rates
    names: RepresentationNames


def configuration_facts(
    configuration: Configuration,
    modules: Mapping[str, Module] | None = None,
    wanted: Set[str] | None = None,
    naming: FactNaming | None = None,
) -> tuple[Fact, ...]:
    """Return the facts of a configuration and of the modules described for it, with locations.

    `modules` adds to the modules declared in the configuration. Only converters and the modules
    that the configuration names become facts. The function `numbered` numbers relationships;
    annotations have the integers that follow. `wanted` restricts the predicates. `naming` has the
    ports, rates and representations of another configuration, which are used instead.
    """
    facts = Compiler(configuration, modules or {}, naming).compile()
    return tuple(fact for fact in facts if wanted is None or fact.atom.name in wanted)


def representation_names(
    configuration: Configuration, modules: Mapping[str, Module]
) -> RepresentationNames:
    """Return the canonical names of the representations that occur in facts."""
    return _names(described_modules(configuration, modules))


def _names(described: Mapping[str, Module]) -> RepresentationNames:
    return canonical_names(sorted(set(representations(described.values()))))


#: The predicates of the effects of mounts on motions.
FRAMES = frozenset(
    "rooted appears appears_in_part lever_arm combines support shares circuit".split()
)


#: The location of facts that no line states.
NOWHERE = point("<imported>", 1, 1)
#: The constants that facts are made of: a rule pack that replaced one would read other facts.
CONSTANTS: frozenset[str] = frozenset(
    {*get_args(Architecture), *get_args(Allocation), *NODE_NAMES, *CLASSES, *KNOTS, *STRATEGIES}
    | {*get_args(Engine), *FOREIGN, FOREVER, ANY.name, NONE.name, "zero", "generic"}
    # Constants by which rule packs describe the kinds of nodes that they provide.
    | {"control", "data", "one", "several"}
)


class Compiler:
    """Collects the facts of one configuration."""

    def __init__(
        self,
        configuration: Configuration,
        modules: Mapping[str, Module],
        naming: FactNaming | None = None,
    ) -> None:
        self.configuration = configuration
        self.facts: list[Fact] = []
        #: All modules that `modules` and blocks of the configuration describe.
        self.known = configuration.with_declared(modules)
        #: The modules that become facts.
        self.described = described_modules(configuration, modules)
        self.numbered = numbered(configuration.relationships)
        self.is_specification = naming is not None
        self.naming = naming or FactNaming(
            ends_in(configuration, self.described),
            rates_in(configuration, self.described),
            _names(self.described),
        )
        strategies = any(isinstance(line, Strategy) for _, line in self.numbered)
        #: Whether numbers of controllers differ from the order of a list.
        self.states_numbers = configuration.architecture == "flat" or strategies
        #: The output names of modules with several, by module and `id` of the service.
        self.called = {
            (name, id(module.services[number])): self.naming.ends.output(name, port)
            for name, module in self.described.items()
            if len(module.services) > 1
            for port, number in outputs(module).items()
        }

    def compile(self) -> Sequence[Fact]:
        """Return the facts."""
        ends, lines, described = self.naming.ends, self.numbered, self.described
        self.heading()
        self.each_module()
        for number, relationship in lines:
            self.relationship(number, relationship)
        for module in described.values():
            self.description(module)
        annotations = list(numbered_annotations(self.configuration, described))
        for number, module, annotation in annotations:
            self.annotation(number, module, annotation)
        self.missing_files(1 + len(lines) + len(annotations))
        self.words()
        self.facts += output_facts(self.configuration, ends)
        self.facts += named_inputs(ends, lines)
        # No rule compares these facts of a specification with those of its configuration.
        if not self.is_specification:
            canonical, rates = self.naming.names.canonical, self.naming.rates
            self.facts += input_facts(self.configuration, described, ends)
            self.facts += turns(self.configuration, ends, lines)
            self.facts += loose_ends(self.configuration, described, ends, lines, canonical)
            self.facts += rounded_rates(self.configuration, ends, ends.services(described), rates)
            self.resemblances()
            self.truths()
            commanding = {
                name
                for name, module in described.items()
                if any(service.kind == "ControlOut" for service in module.services)
            }
            self.facts += closed_walks(lines, ends, commanding)
        return self.facts

    def heading(self) -> None:
        """Add the architecture, the existing muxes, and the nodes that could not be read."""
        configuration = self.configuration
        # No line of a foreign file states the architecture.
        span = configuration.span if configuration.format is None else NOWHERE
        self.add(span, "architecture", Atom(configuration.architecture))
        if configuration.origin is not None:
            self.add(NOWHERE, "imported", Atom(configuration.origin))
        if configuration.period_ms is not None:
            self.add(configuration.span, "period", configuration.period_ms)
        for mux in configuration.muxes:
            self.add(mux.span, "muxed", mux.module, Atom(mux.engine))
        for name in configuration.opaque:
            self.add(name.span, "opaque", name.text)

    def missing_files(self, first: int) -> None:
        """Add the missing files of nodes, with identifiers from `first` on."""
        for number, file in enumerate(self.configuration.missing, first):
            self.add(file.span, "absent_file", number, file.module, file.key, file.path)
            self.place(number, file.span)
            if file.builds:
                self.add(file.span, "builds", file.module)

    def each_module(self) -> None:
        """Add a fact for each module that the configuration names, with its location."""
        for name in self.configuration.modules:
            self.add(name.span, "module", name.text)
            self.place(name.text, name.span)
            if self.configuration.kind == "specification":
                kind = self.configuration.node_kind(name.text)
                if kind and name.text not in self.described:
                    self.add(name.span, "node", name.text, Atom(kind))

    def description(self, module: Module) -> None:
        """Add the classes of a described module and its guard."""
        self.add(module.named or module.span, "described", module.name)
        for module_class, span in annotated_classes(module).items():
            self.add(span, "class", module.name, Atom(module_class))
        if module.guard is not None:
            self.add(module.guard, "guard", module.name)

    def annotation(self, number: int, module: Module, annotation: Service | Function) -> None:
        """Add one annotation of a module; `number` is its identifier."""
        if isinstance(annotation, Service):
            self.service(number, module.name, annotation)
        else:
            self.add(annotation.span, "native", number, module.name, annotation.name)
        self.place(number, annotation.span)

    def add(self, span: Span, name: str, *arguments: Term) -> None:
        """Add a fact."""
        self.facts.append(Fact(Atom(name, arguments), span))

    def place(self, identifier: Term, span: Span) -> None:
        """Add the location of the statement or annotation with an identifier."""
        self.add(span, "place", identifier, encodable(span.path), span.line, span.column)

    def relationship(self, number: int, relationship: Relationship) -> None:
        """Add the facts of one relationship; `number` is its identifier."""
        span = relationship.span
        match relationship:
            case Data(client):
                source = self.naming.ends.source(relationship)
                self.add(span, "uses_data_from", number, client, source)
                if relationship.mode is not None:
                    self.add(span, "required_mode", number, mode_term(relationship.mode))
                    if relationship.hz is not None:
                        rate = self.naming.rates.millihertz(relationship.hz)
                        self.add(span, "required_rate", number, rate)
            case Control(controlled, controller):
                self.add(span, "is_controlled_by", number, controlled, controller)
                if relationship.priority is not None:
                    self.add(span, "priority", number, relationship.priority)
                    # In other cases a list of controllers can state the same order.
                    if self.states_numbers and not relationship.listed:
                        self.add(span, "stated_priority", number)
                if relationship.hold_ms is not None:
                    self.add(span, "hold", number, hold_term(relationship.hold_ms))
                if relationship.allocation is not None:
                    self.add(span, "allocation", number, Atom(relationship.allocation))
            case Mount(mounting, mounted):
                at, on = relationship.mounting_vertex or 0, relationship.mounted_vertex or 0
                self.add(span, "is_mounted_on", number, mounting, at, mounted, on)
            case _:
                self.side_line(number, relationship)
        self.place(number, span)

    def side_line(self, number: int, line: Gating | Reset | Lock | Limit | Strategy) -> None:
        """Add the facts of a gate, reset, lock, limit or strategy; `number` is its identifier."""
        span, taken = line.span, self.naming.ends.taken
        match line:
            case Gating(gated, trigger):
                ends = self.naming.ends.gated(line), taken(trigger, line.trigger_port)
                self.add(span, GATING[line.sign], number, *ends)
                self.add(span, "gated_module", number, gated)
                self.add(span, "closes_for", number, line.ms)
                if line.port is not None:
                    self.add(span, "names_gated_port", number)
            case Reset(module, source):
                self.add(span, "is_reset_by", number, module, taken(source, line.source_port))
            case Lock(controlled, source):
                source = taken(source, line.source_port)
                self.add(span, "is_locked_by", number, controlled, source)
                if line.priority is not None:
                    self.add(span, "lock_priority", number, line.priority)
            case Limit(controlled, source):
                source = taken(source, line.source_port)
                self.add(span, "is_limited_by", number, controlled, source)
            case Strategy(controlled):
                self.add(span, "is_arbitrated_by", number, controlled, Atom(line.strategy))
                if line.period_ms is not None:
                    self.add(span, "mean_period", number, line.period_ms)
                return
        if isinstance(line, Lock | Limit) and line.hold_ms is not None:
            self.add(span, "bound_hold", number, line.hold_ms)
        self.add(span, "taken_from", number, ends_of(line)[1])
        if ports_of(line)[1] is not None:
            self.add(span, "names_port", number)

    def truths(self) -> None:
        """Add the representations of truths, if there are locks or Gates, which heed them."""
        heeding = [r for r in self.configuration.relationships if isinstance(r, Lock | Gating)]
        if heeding:
            names = set(self.naming.names.canonical.values())
            for name in sorted(name for name in names if name.lower().endswith("bool")):
                self.add(heeding[0].span, "truth", name)

    def words(self) -> None:
        """Add the text of each mode together with its rate, once for each."""
        known = set()
        entries = set()
        for mode, hz, otherwise, span in self.written_modes():
            # Most are written alike, and a look-up is faster than making the term again.
            if (mode, mode.text, hz, otherwise) in known:
                continue
            known.add((mode, mode.text, hz, otherwise))
            term = mode_term(mode)
            rate = otherwise if hz is None else self.naming.rates.millihertz(hz)
            if (str(term), rate) not in entries:
                entries.add((str(term), rate))
                text = mode.text or mode.name
                words = text if hz is None else f"{text} {as_written(hz)}"
                self.add(span, "in_words", term, rate, words)

    def written_modes(self) -> Iterator[tuple[Mode, Fraction | None, Atom, Span]]:
        """Yield each required or offered mode, with its frequency or a constant in place of one."""
        for _, relationship in self.numbered:
            if isinstance(relationship, Data) and relationship.mode is not None:
                yield relationship.mode, relationship.hz, ANY, relationship.span
        for module in self.described.values():
            for service in module.services:
                if service.kind in DELIVERING:
                    for mode in service.modes:
                        hz = service.hz if mode.name == PERIODIC else None
                        yield mode, hz, NONE, service.span

    def service(self, number: int, name: str, service: Service) -> None:
        """Add a service annotation of the module `name`; `number` is its identifier."""
        span, (canonical, ambiguous) = service.span, self.naming.names
        if service.kind == "Converts":
            source, target = (*service.inputs, None)[0], service.output
            if source is not None and target is not None:
                ends = canonical[source], canonical[target]
                self.add(span, "converts", number, name, *ends, service.cost)
            return
        if service.kind == "Reset":
            self.add(span, "has_reset", number, name)
            return
        if service.kind == "Done":
            self.add(span, "completion", number)
        if service.window_ms is not None:
            self.add(span, "window", number, service.window_ms)
        if service.kind in DELIVERING:
            self.offer(number, name, service)
        for function in service.commands:
            self.add(span, "commands", number, name, function)
        for index, representation in enumerate(service.inputs):
            if representation is None or representation in ambiguous:
                self.add(span, "unknown_input", number, name, index)
            else:
                self.add(span, "input", number, name, index, canonical[representation])
            self.candidates(number, name, representation, span)

    def offer(self, number: int, name: str, service: Service) -> None:
        """Add the output of the module `name`, with modes and rates; `number` identifies it."""
        span = service.span
        name = self.called.get((name, id(service)), name)
        self.add(span, "delivers", number, name)
        if service.output is not None and service.output not in self.naming.names.ambiguous:
            self.add(span, "output", number, name, self.naming.names.canonical[service.output])
        self.candidates(number, name, service.output, span)
        for index, mode in enumerate(service.modes):
            term = mode_term(mode)
            self.add(span, "offered_mode", number, index, term)
            if mode.name == PERIODIC and service.hz is not None:
                self.add(span, "offered_rate", number, self.naming.rates.millihertz(service.hz))

    def candidates(self, number: int, name: str, written: str | None, span: Span) -> None:
        """Add the possible meanings of a `written` representation, if it is ambiguous.

        `number` identifies its annotation, `name` is its port.
        """
        for candidate in self.naming.names.ambiguous.get(written or "", ()):
            self.add(span, "ambiguous_name", number, name, written or "", candidate)

    def resemblances(self) -> None:
        """Add the known name that is most similar to each undeclared name."""
        declared = {name.text for name in self.configuration.modules}
        ends = {end for r in self.configuration.relationships for end in ends_of(r)}
        known = set(self.known)
        # `DataSplitter2` is not `DataSplitter1` misspelt.
        pools = [(self._not_nodes(ends - declared - known), sorted(declared | known))]
        if known:
            unknown = self._not_nodes(declared - known)
            pools.append((unknown, sorted(known - declared)))
            # What has a description is written right, and may be misspelt in `@modules`.
            pools.append((self._not_nodes(ends & known - declared), sorted(unknown)))
        places = {name.text: name.span for name in self.configuration.modules}
        for written, ports in unknown_ports(self.described, self.naming.ends).items():
            near = nearest(written, ports)
            if near is not None:
                self.add(self.configuration.span, "resembles", written, near)
        for strangers, candidates in pools:
            for stranger, near in resemblances(sorted(strangers), candidates, 0.75):
                span = places.get(stranger, self.configuration.span)
                self.add(span, "resembles", stranger, near)

    def _not_nodes(self, names: Set[str]) -> set[str]:
        return {name for name in names if self.configuration.node_kind(name) is None}


def given(facts: Iterable[Fact]) -> Fragment:
    """Return facts as a fragment of a program."""
    facts = tuple(facts)
    return fact_fragment(facts_text(facts), {fact.atom.name for fact in facts})


def facts_text(facts: Iterable[Fact]) -> str:
    """Return facts in the syntax of clingo, one a line."""
    return "".join(f"{fact.atom}.\n" for fact in facts)


def representations(modules: Iterable[Module]) -> Iterator[str]:
    """Yield the representations that modules name."""
    for module in modules:
        for service in module.services:
            yield from (name for name in (service.output, *service.inputs) if name is not None)
