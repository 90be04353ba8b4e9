"""The inputs that the lines of a specification mean, where they leave them out."""

from collections.abc import Mapping
from dataclasses import replace

from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.model.declarations import Configuration, Data, Module
from mars_asp.model.described import described_modules
from mars_asp.model.ports import inputs
from mars_asp.reasoning.analysis import analyse
from mars_asp.reasoning.facts.ends import ends_in
from mars_asp.reasoning.facts.identifiers import numbered
from mars_asp.reasoning.project import Project, project_facts, with_brought
from mars_asp.reasoning.synthesis.carried_modes import data_nodes, from_sources


def state_inputs(
    specification: Configuration, modules: Mapping[str, Module], rulebook: Rulebook
) -> Configuration:
    """Return the specification with the input on each line to a client that has several.

    The inputs are those of `rules/inputs.lp` for the same lines without the nodes. A line that
    leaves several open stays as it is.

    Raises:
        MarsError: clingo refuses the rules.
    """
    known = described_modules(specification, modules)
    lines = [line for line in specification.relationships if isinstance(line, Data)]
    unnamed = {line.client for line in lines if line.client_port is None} & known.keys()
    several = {client for client in unnamed if len(inputs(known[client])) > 1}
    if not several:
        return specification
    nodes = data_nodes(specification, known)
    feeds: dict[str, list[Data]] = {}
    for line in lines:
        if line.client in nodes:
            feeds.setdefault(line.client, []).append(line)
    realised = {
        id(direct): (direct, line)
        for line in lines
        if line.client in several
        for direct in from_sources(line, feeds)
    }
    direct_lines = tuple(direct for direct, _ in realised.values())
    apart = replace(
        specification,
        kind="configuration",
        modules=tuple(n for n in specification.modules if n.text not in nodes),
        relationships=direct_lines,
        conversions=(),
    )
    project = with_brought(Project(apart, modules, ()), rulebook.brought)
    grounding = analyse(project_facts(project), rulebook, apart.span).grounding
    entries = ends_in(apart, described_modules(apart, modules)).entries
    line_of = {number: realised[id(direct)][1] for number, direct in numbered(direct_lines)}
    ports: dict[int, set[str | None]] = {id(line): set() for line in lines}
    for symbol in grounding.symbols("arrives_at", 2):
        number, end = symbol.arguments
        entry = entries.get(end.string)
        ports[id(line_of[number.number])].add(None if entry is None else entry.port)

    def with_port(line: Data) -> Data:
        port, *others = ports[id(line)] or {None}
        return line if others or port is None else replace(line, client_port=port)

    return replace(
        specification,
        relationships=tuple(
            with_port(line) if isinstance(line, Data) else line
            for line in specification.relationships
        ),
    )
