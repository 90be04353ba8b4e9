"""Glue that a robot has already, as nodes of a specification.

That is muxes, throttles, and the work of the middleware: it delivers an output to all subscribers,
and the commands of all publishers to each subscriber, where the latest one wins.
"""

from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import replace
from fractions import Fraction
from itertools import count

from mars_asp.diagnostic import Span
from mars_asp.language.print import print_configuration, print_module
from mars_asp.model.declarations import (
    NODE_NAMES,
    Configuration,
    Control,
    Data,
    Inner,
    Lock,
    Muxed,
    Name,
    NodeKind,
    Relationship,
)
from mars_asp.output import visible


def lifted(configuration: Configuration) -> Configuration:
    """Return a foreign configuration as a specification: its muxes become ArbitrationNodes."""
    nodes = _Nodes({name.text for name in configuration.modules})
    arbiters = {mux: nodes.new("arbitration_node", mux.span) for mux in configuration.muxes}
    lines = _through_muxes(
        configuration,
        arbiters,
        lambda inner: nodes.new("arbitration_node", inner.span),
    )
    offered = {
        (module.name, service.port, service.hz)
        for module in configuration.declared
        for service in module.services
    }
    lines = list(_copied(lines, nodes, offered))
    for change in (_arbitrated, _commanded):
        lines = list(change(lines, nodes))
    number = nodes.in_order(lines, configuration.relationships)
    return replace(
        configuration,
        kind="specification",
        modules=(*configuration.modules, *nodes.names),
        relationships=tuple(_with_ends(lines, number)),
        muxes=tuple(
            replace(mux, module=number[arbiter], numbers=(), inner=())
            for mux, arbiter in arbiters.items()
        ),
        relays=(),
    )


def _through_muxes(
    configuration: Configuration,
    names: Mapping[Muxed, str],
    name_inner: Callable[[Inner], str],
) -> list[Relationship]:
    """Return the relationships, with the muxes in `names` between controllers and modules.

    `names` has the new module of each mux; `name_inner` makes a name for one inside a cascade.
    """
    lines: list[Relationship] = []
    arbiters: dict[str, str] = {}
    places: dict[str, dict[int | None, tuple[str, int | None]]] = {}
    for mux, name in names.items():
        arbiters[mux.module] = name
        lines.append(Control(mux.module, name, mux.span, topic=mux.topic))
        if mux.numbers:
            places[mux.module] = dict(_arbiter_lines(mux, name, name_inner, lines))
    for line in configuration.relationships:
        if isinstance(line, Lock) and line.controlled in arbiters:
            line = replace(line, controlled=arbiters[line.controlled])  # noqa: PLW2901
        if isinstance(line, Control) and line.controlled in arbiters:
            here = arbiters[line.controlled], line.priority
            arbiter, number = places.get(line.controlled, {}).get(line.priority, here)
            line = replace(line, controlled=arbiter, priority=number)  # noqa: PLW2901
        lines.append(line)
    return lines


def _arbiter_lines(
    mux: Muxed | Inner,
    arbiter: str,
    name_inner: Callable[[Inner], str],
    lines: list[Relationship],
) -> Iterator[tuple[int | None, tuple[str, int | None]]]:
    """Yield for each priority its arbiter and written priority, of a mux and muxes inside it.

    `lines` gets a control from each inner arbiter to its outer one.
    """
    for number, written in mux.numbers:
        yield number, (arbiter, written)
    for each in mux.inner:
        within = name_inner(each)
        lines.append(Control(arbiter, within, each.span, each.priority, topic=each.topic))
        yield from _arbiter_lines(each, within, name_inner, lines)


def _with_ends(lines: Iterable[Relationship], names: Mapping[str, str]) -> Iterator[Relationship]:
    """Yield relationships with ends renamed by `names`; one from a module to itself is left out."""
    for line in lines:
        if isinstance(line, Lock):
            yield replace(line, controlled=names.get(line.controlled, line.controlled))
            continue
        if not isinstance(line, Control):
            yield line
            continue
        ends = [names.get(each, each) for each in (line.controlled, line.controller)]
        if ends[0] != ends[1]:
            yield replace(line, controlled=ends[0], controller=ends[1])


def realised_by(specification: Configuration) -> dict[str, str]:
    """Return the names of the user's muxes that arbiters represent, by the arbiter's name."""
    return {
        mux.module: mux.name
        for mux in specification.muxes
        if mux.name is not None and specification.node_kind(mux.module) == "arbitration_node"
    }


def with_own_muxes(configuration: Configuration) -> Configuration:
    """Return a configuration or specification in which the user's muxes are modules.

    In a specification they replace the arbiters that represent them. Commands that pass no mux get
    no priority, as nothing ranks them.
    """
    modules = {name.text: name for name in configuration.modules}
    if configuration.kind == "specification":
        commanded = {
            line.controller: line.controlled
            for line in configuration.relationships
            if isinstance(line, Control)
        }
        names: dict[str, str] = {}
        for arbiter, name in realised_by(configuration).items():
            # A mux that something goes past is a module that its arbiter controls.
            taken = {*modules, *names.values()} - {commanded.get(arbiter)}
            names[arbiter] = next(each for each in _name_choices(name) if each not in taken)
        topics = {names.get(mux.module): mux.topic for mux in configuration.muxes}
        lines = [
            replace(line, topic=topics[line.controller])
            if isinstance(line, Control) and line.controller in topics
            else line
            for line in _with_ends(configuration.relationships, names)
        ]
        found = (replace(each, text=names.get(each.text, each.text)) for each in modules.values())
        modules = {name.text: name for name in found}
    else:
        own = {
            mux: _free(mux.name, mux.span, modules)
            for mux in configuration.muxes
            if mux.name is not None and mux.name != mux.module
        }
        lines = _through_muxes(
            configuration, own, lambda mux: _free(mux.name or "mux", mux.span, modules)
        )
    ranking = {line.controlled for line in lines if isinstance(line, Control)}.difference(
        name.text for name in configuration.modules
    ) | {mux.module for mux in configuration.muxes}
    lines = [
        replace(line, priority=None)
        if isinstance(line, Control) and line.topic is not None and line.controlled not in ranking
        else line
        for line in lines
    ]
    return replace(configuration, modules=tuple(modules.values()), relationships=tuple(lines))


def _free(name: str, span: Span, modules: dict[str, Name]) -> str:
    """Add a module to `modules`, and return its name: `name`, with a number if that is in use."""
    free = next(each for each in _name_choices(name) if each not in modules)
    modules[free] = Name(free, span)
    return free


def _name_choices(name: str) -> Iterator[str]:
    yield name
    yield from (f"{name}#{number}" for number in count(2))


def has_glue(configuration: Configuration) -> bool:
    """Whether a foreign configuration has muxes or relays, which `lifted` turns into nodes."""
    return bool(configuration.muxes or configuration.relays)


class _Nodes:
    """Makes nodes with unused names."""

    def __init__(self, taken: Set[str]) -> None:
        self.taken = taken
        self.names: list[Name] = []
        self.free: dict[NodeKind, Iterator[str]] = {}

    def new(self, kind: NodeKind, span: Span) -> str:
        """Return the name of a further node."""
        free = self.free.setdefault(kind, self._free(kind))
        name = next(name for name in free if name not in self.taken)
        self.names.append(Name(name, span))
        return name

    def _free(self, kind: NodeKind) -> Iterator[str]:
        stem = NODE_NAMES[kind]
        first, begin = (stem, 2) if kind == "arbitration_node" else (f"{stem}1", 2)
        yield first
        yield from (f"{stem}{number}" for number in count(begin))

    def in_order(
        self, lines: Sequence[Relationship], written: Sequence[Relationship]
    ) -> dict[str, str]:
        """Return new names for arbiters, numbered as synthesis numbers them.

        The order is that of the relationships (`written`) that they arbitrate. Arbiters with a
        single input, which synthesis does not need, come last.
        """
        places = {line.span: place for place, line in reversed(list(enumerate(written)))}
        into: dict[str, list[int]] = {n.text: [] for n in self.names if self.is_arbiter(n.text)}
        for line in reversed(lines):
            if isinstance(line, Control) and line.controlled in into:
                within = into.get(line.controller, ())
                into[line.controlled].append(min(within, default=places.get(line.span, -1)))
        order = sorted(into, key=lambda name: (len(into[name]) < 2, min(into[name], default=0)))
        number = dict(zip(order, into, strict=True))
        spans = {number.get(name.text, name.text): name.span for name in self.names}
        self.names = [Name(name.text, spans[name.text]) for name in self.names]
        return number

    def is_arbiter(self, name: str) -> bool:
        """Whether a name is that of an arbiter that was made."""
        stem = NODE_NAMES["arbitration_node"]
        return name not in self.taken and name.startswith(stem)


def _copied(
    lines: Sequence[Relationship],
    nodes: _Nodes,
    offered: Set[tuple[str, str | None, Fraction | None]],
) -> Iterator[Relationship]:
    """Yield the relationships, with a DataSplitter after each output that needs one.

    An output needs one if it has several readers, or one reader at another rate than its own;
    `offered` has the rates of the outputs of modules.
    """
    takers = Counter(
        (line.source, line.source_port) for line in lines if isinstance(line, Data | Lock)
    )
    splitters: dict[tuple[str, str | None], str] = {}
    for line in lines:
        if not isinstance(line, Data | Lock) or (
            takers[line.source, line.source_port] == 1
            and (
                isinstance(line, Lock)
                or line.hz is None
                or (line.source, line.source_port, line.hz) in offered
            )
        ):
            yield line
            continue
        output = line.source, line.source_port
        if output not in splitters:
            splitters[output] = nodes.new("data_splitter", line.span)
            yield Data(splitters[output], line.source, line.span, source_port=line.source_port)
        yield replace(line, source=splitters[output], source_port=None)


def _arbitrated(lines: Sequence[Relationship], nodes: _Nodes) -> Iterator[Relationship]:
    """Yield the edges, with one arbiter for all modules that have the same several controllers."""
    commanding: dict[str, list[Control]] = defaultdict(list)
    for line in lines:
        if isinstance(line, Control):
            commanding[line.controlled].append(line)
    alike: dict[frozenset[tuple[object, ...]], list[str]] = defaultdict(list)
    for controlled, own in commanding.items():
        if len(own) > 1 and not nodes.is_arbiter(controlled):
            alike[frozenset((c.controller, c.priority, c.hold_ms) for c in own)].append(controlled)
    together = {each: group for group in alike.values() for each in group}
    for line in lines:
        if not isinstance(line, Control) or line.controlled not in together:
            yield line
            continue
        group = together[line.controlled]
        if line is not commanding[group[0]][0]:
            continue
        arbiter = nodes.new("arbitration_node", line.span)
        outlet = arbiter
        if len(group) > 1:
            outlet = nodes.new("control_splitter", line.span)
            yield Control(outlet, arbiter, line.span)
        yield from (Control(each, outlet, commanding[each][0].span) for each in group)
        yield from (replace(each, controlled=arbiter) for each in commanding[group[0]])


def _commanded(lines: Sequence[Relationship], nodes: _Nodes) -> Iterator[Relationship]:
    """Yield the relationships, with a splitter after each module that controls several others."""
    commanded = Counter(line.controller for line in lines if isinstance(line, Control))
    made = {name.text for name in nodes.names}
    splitters: dict[str, str] = {}
    for line in lines:
        if (
            not isinstance(line, Control)
            or line.controller in made
            or commanded[line.controller] == 1
        ):
            yield line
            continue
        if line.controller not in splitters:
            splitters[line.controller] = nodes.new("control_splitter", line.span)
            yield Control(splitters[line.controller], line.controller, line.span)
        yield replace(line, controller=splitters[line.controller])


def with_origins(configuration: Configuration) -> str:
    """Return the text of a configuration with the location of each relationship and block.

    Relationships are printed last of the body, each on a line of its own.
    """
    printed = print_configuration(replace(configuration, declared=()))
    lines = printed.splitlines()
    first = len(lines) - len(configuration.relationships)
    texts = [
        f"{line}  {_origin(related.span)}"
        for line, related in zip(lines[first:], configuration.relationships, strict=True)
    ]
    described = [f"\n{_origin(m.span)}\n{print_module(m)}" for m in configuration.declared]
    return "\n".join((*lines[:first], *texts, *described, ""))


def _origin(span: Span) -> str:
    return f"// from {visible(span.path)}:{span.line}"
