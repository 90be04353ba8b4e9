"""Which of several offered modes a source's link carries, where a specification leaves it open."""

from collections.abc import Callable, Iterator, Mapping, Sequence, Set
from dataclasses import replace
from typing import NamedTuple

from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.solve.grounding import Grounding
from mars_asp.model.declarations import Configuration, Data, Module, ends_of
from mars_asp.model.described import described_modules
from mars_asp.reasoning.analysis import analyse
from mars_asp.reasoning.facts.ends import ends_in
from mars_asp.reasoning.project import Project, project_facts, with_brought

_NODES = ("data_splitter", "data_transformer")


def state_modes(
    specification: Configuration, modules: Mapping[str, Module], rulebook: Rulebook
) -> Configuration:
    """Return the specification with a mode on each line that leaves its source a choice.

    It is the mode that `rules/services.lp` finds for the clients downstream of the nodes: the first
    that serves most of them.

    Raises:
        MarsError: clingo refuses the rules.
    """
    known = described_modules(specification, modules)
    ends = ends_in(specification, known)
    lines = [line for line in specification.relationships if isinstance(line, Data)]
    offered = {
        name: service.modes
        for name, service in ends.services(known).items()
        if len(service.modes) > 1
    }
    if not any(line.mode is None and ends.source(line) in offered for line in lines):
        return specification
    grounding = connect_directly(specification, modules, rulebook).grounding
    carried = {
        symbol.arguments[0].string: symbol.arguments[1].number
        for symbol in grounding.symbols("favoured", 2)
    }

    def with_mode(line: Data) -> Data:
        source = ends.source(line)
        if line.mode is not None or source not in carried or source not in offered:
            return line
        return replace(line, mode=offered[source][carried[source]])

    return change_data(specification, with_mode)


def change_data(specification: Configuration, change: Callable[[Data], Data]) -> Configuration:
    """Return a specification with the result of `change` in place of each data line."""
    lines = specification.relationships
    changed = (change(line) if isinstance(line, Data) else line for line in lines)
    return replace(specification, relationships=tuple(changed))


class DirectLines(NamedTuple):
    """The data lines of a specification without nodes, and the atoms that rules derive from them.

    Each line is paired with the line of the specification into its client.
    """

    configuration: Configuration
    lines: Sequence[tuple[Data, Data]]
    grounding: Grounding


def connect_directly(
    specification: Configuration,
    modules: Mapping[str, Module],
    rulebook: Rulebook,
    clients: Set[str] | None = None,
) -> DirectLines:
    """Return the data lines between the modules of a specification, without its nodes.

    `clients` restricts them to the lines of some clients.

    Raises:
        MarsError: clingo refuses the rules.
    """
    nodes = _data_nodes(specification, described_modules(specification, modules))
    data = [line for line in specification.relationships if isinstance(line, Data)]
    feeds: dict[str, list[Data]] = {}
    for line in data:
        if line.client in nodes:
            feeds.setdefault(line.client, []).append(line)
    lines = [
        (direct, line)
        for line in data
        if line.client not in nodes and (clients is None or line.client in clients)
        for direct in _from_sources(line, feeds)
    ]
    configuration = replace(
        specification,
        kind="configuration",
        modules=tuple(n for n in specification.modules if n.text not in nodes),
        relationships=tuple(direct for direct, _ in lines),
        conversions=(),
    )
    project = with_brought(Project(configuration, modules, ()), rulebook.brought)
    analysis = analyse(project_facts(project), rulebook, configuration.span)
    return DirectLines(configuration, lines, analysis.grounding)


def _data_nodes(specification: Configuration, known: Mapping[str, Module]) -> frozenset[str]:
    """Return the nodes that forward data, those of rule packs among them."""

    def forwards_data(name: str) -> bool:
        brought = specification.pack_kind(name)
        if brought is not None:
            return brought.carries == "data"
        return specification.node_kind(name) in _NODES

    ends = {name.text for name in specification.modules}.union(
        *(ends_of(line) for line in specification.relationships)
    )
    return frozenset(name for name in ends - known.keys() if forwards_data(name))


def _from_sources(line: Data, feeds: Mapping[str, list[Data]]) -> Iterator[Data]:
    """Yield a direct line from each source upstream of a line's client, without duplicates."""
    waiting, seen = [line], set()
    while waiting:
        each = waiting.pop()
        if (key := (each.source, each.source_port, each.mode, each.hz)) in seen:
            continue
        seen.add(key)
        if each.source not in feeds:
            yield each
        for above in feeds.get(each.source, ()):
            states = above if each.mode is None else each
            source, port = above.source, above.source_port
            waiting.append(
                replace(each, source=source, source_port=port, mode=states.mode, hz=states.hz)
            )
