"""Glue that a robot has already, as nodes of a specification.

That is muxes, throttles, and what a middleware does by itself: it hands an output to all who
subscribe to it, and the commands of all publishers to whom they are for, where the latest wins.
"""

from collections import defaultdict
from collections.abc import Iterator, Sequence, Set
from dataclasses import replace
from itertools import count

from mars_asp.diagnostic import Span
from mars_asp.language.print import print_configuration, print_module
from mars_asp.model.declarations import (
    NODE_NAMES,
    Configuration,
    Control,
    Data,
    Inner,
    Muxed,
    Name,
    NodeKind,
    Relationship,
)
from mars_asp.output import visible


def lifted(configuration: Configuration) -> Configuration:
    """Return the specification that other people's wiring is: each mux an ArbitrationNode."""
    nodes = _Nodes({name.text for name in configuration.modules})
    arbiters = {mux.module: nodes.new("arbitration_node", mux.span) for mux in configuration.muxes}
    lines: list[Relationship] = [
        Control(mux.module, arbiters[mux.module], mux.span) for mux in configuration.muxes
    ]
    places = {
        mux.module: dict(_places(mux, arbiters[mux.module], nodes, lines))
        for mux in configuration.muxes
        if mux.numbers
    }
    for line in configuration.relationships:
        if isinstance(line, Control) and line.controlled in arbiters:
            here = arbiters[line.controlled], line.priority
            arbiter, number = places.get(line.controlled, {}).get(line.priority, here)
            line = replace(line, controlled=arbiter, priority=number)  # noqa: PLW2901
        lines.append(line)
    for change in (_copied, _arbitrated, _commanded):
        lines = list(change(lines, nodes))
    return replace(
        configuration,
        kind="specification",
        modules=(*configuration.modules, *nodes.names),
        relationships=tuple(lines),
        muxes=tuple(
            Muxed(arbiters[mux.module], mux.engine, mux.span) for mux in configuration.muxes
        ),
        relays=(),
    )


def _places(
    mux: Muxed | Inner, arbiter: str, nodes: "_Nodes", lines: list[Relationship]
) -> Iterator[tuple[int | None, tuple[str, int | None]]]:
    """Yield for each number of a cascade its arbiter and what is written; add those within."""
    for number, written in mux.numbers:
        yield number, (arbiter, written)
    for each in mux.inner:
        within = nodes.new("arbitration_node", each.span)
        lines.append(Control(arbiter, within, each.span, each.priority))
        yield from _places(each, within, nodes, lines)


def has_glue(configuration: Configuration) -> bool:
    """Whether there is more in other people's wiring than its configuration has."""
    return bool(configuration.muxes or configuration.relays)


class _Nodes:
    """Makes nodes, none with the name of a module."""

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

    def is_arbiter(self, name: str) -> bool:
        """Whether a name is that of an arbiter that was made."""
        stem = NODE_NAMES["arbitration_node"]
        return name not in self.taken and name.startswith(stem)


def _copied(lines: Sequence[Relationship], nodes: _Nodes) -> Iterator[Relationship]:
    """Yield lines with a splitter behind each output that several take, or one at a lower rate."""
    takers: dict[tuple[str, str | None], list[Data]] = defaultdict(list)
    for line in lines:
        if isinstance(line, Data):
            takers[line.source, line.source_port].append(line)
    splitters: dict[tuple[str, str | None], str] = {}
    for line in lines:
        output = (line.source, line.source_port) if isinstance(line, Data) else None
        if not isinstance(line, Data) or output is None:
            yield line
            continue
        if len(takers[output]) == 1 and line.hz is None:
            yield line
            continue
        if output not in splitters:
            splitters[output] = nodes.new("data_splitter", line.span)
            yield Data(splitters[output], line.source, line.span, source_port=line.source_port)
        yield replace(line, source=splitters[output], source_port=None)


def _arbitrated(lines: Sequence[Relationship], nodes: _Nodes) -> Iterator[Relationship]:
    """Yield lines with an arbiter before what several command, one where these are the same."""
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
    """Yield lines with a splitter behind each controller of several that is no splitter."""
    commanded: dict[str, list[Control]] = defaultdict(list)
    for line in lines:
        if isinstance(line, Control):
            commanded[line.controller].append(line)
    made = {name.text for name in nodes.names}
    splitters: dict[str, str] = {}
    for line in lines:
        if (
            not isinstance(line, Control)
            or line.controller in made
            or len(commanded[line.controller]) == 1
        ):
            yield line
            continue
        if line.controller not in splitters:
            splitters[line.controller] = nodes.new("control_splitter", line.span)
            yield Control(splitters[line.controller], line.controller, line.span)
        yield replace(line, controller=splitters[line.controller])


def with_origins(configuration: Configuration) -> str:
    """Return a configuration as it is printed, each relationship and block with where it is from.

    Relationships are printed last of the body, each on a line of its own.
    """
    printed = print_configuration(replace(configuration, declared=()))
    lines = printed.splitlines()
    first = len(lines) - len(configuration.relationships)
    told = [
        f"{line}  {_origin(related.span)}"
        for line, related in zip(lines[first:], configuration.relationships, strict=True)
    ]
    described = [f"\n{_origin(m.span)}\n{print_module(m)}" for m in configuration.declared]
    return "\n".join((*lines[:first], *told, *described, ""))


def _origin(span: Span) -> str:
    return f"// from {visible(span.path)}:{span.line}"
