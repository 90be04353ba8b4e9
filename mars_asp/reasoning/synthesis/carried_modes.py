"""Which of several offered modes a source's link carries, where a specification leaves it open."""

from collections.abc import Iterator, Mapping
from dataclasses import replace

from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.model.declarations import Configuration, Data, Module, node_kind
from mars_asp.model.described import described_modules
from mars_asp.reasoning.analysis import analyse
from mars_asp.reasoning.facts.ends import ends_in
from mars_asp.reasoning.project import Project, project_facts, with_brought

_NODES = ("data_splitter", "data_transformer")


def state_modes(
    specification: Configuration, modules: Mapping[str, Module], rulebook: Rulebook
) -> Configuration:
    """Return the specification with a mode on each line that leaves its source a choice.

    It is the mode that `rules/services.lp` finds for the clients behind the nodes: the first that
    serves most of them.

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
    apart = replace(
        specification,
        kind="configuration",
        modules=tuple(n for n in specification.modules if not _is_node(n.text, known)),
        relationships=tuple(_end_to_end(lines, known)),
    )
    project = with_brought(Project(apart, modules, ()), rulebook.brought)
    analysis = analyse(project_facts(project), rulebook, apart.span)
    carried = {
        symbol.arguments[0].string: symbol.arguments[1].number
        for symbol in analysis.grounding.symbols("favoured", 2)
    }

    def stated(line: Data) -> Data:
        source = ends.source(line)
        if line.mode is not None or source not in carried or source not in offered:
            return line
        return replace(line, mode=offered[source][carried[source]])

    return replace(
        specification,
        relationships=tuple(
            stated(line) if isinstance(line, Data) else line for line in specification.relationships
        ),
    )


def _is_node(name: str, known: Mapping[str, Module]) -> bool:
    return name not in known and node_kind(name) in _NODES


def _end_to_end(lines: list[Data], known: Mapping[str, Module]) -> Iterator[Data]:
    """Yield what modules use from modules, the nodes between them left out."""
    feeds = {line.client: line for line in lines if _is_node(line.client, known)}
    for line in lines:
        if _is_node(line.client, known):
            continue
        first, seen = line, set()
        while first.source in feeds and first.source not in seen:
            seen.add(first.source)
            above = feeds[first.source]
            states = above if first.mode is None else first
            source, port = above.source, above.source_port
            first = replace(first, source=source, source_port=port, mode=states.mode, hz=states.hz)
        yield first
