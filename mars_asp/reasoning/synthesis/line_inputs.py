"""The inputs that the lines of a specification mean, where they leave them out."""

from collections.abc import Mapping
from dataclasses import replace

from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.model.declarations import Configuration, Data, Module
from mars_asp.model.described import described_modules
from mars_asp.model.ports import inputs
from mars_asp.reasoning.facts.ends import ends_in
from mars_asp.reasoning.facts.identifiers import numbered
from mars_asp.reasoning.synthesis.carried_modes import change_data, connect_directly


def state_inputs(
    specification: Configuration, modules: Mapping[str, Module], rulebook: Rulebook
) -> Configuration:
    """Return the specification with the input named on each line to a client with several.

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
    direct = connect_directly(specification, modules, rulebook, several)
    entries = ends_in(
        direct.configuration, described_modules(direct.configuration, modules)
    ).entries
    line_of = {id(each): line for each, line in direct.lines}
    numbers = dict(numbered(direct.configuration.relationships))
    ports: dict[int, set[str | None]] = {id(line): set() for line in lines}
    for symbol in direct.grounding.symbols("arrives_at", 2):
        number, end = symbol.arguments
        entry, line = entries.get(end.string), line_of[id(numbers[number.number])]
        ports[id(line)].add(None if entry is None else entry.port)

    def with_port(line: Data) -> Data:
        port, *others = ports[id(line)] or {None}
        return line if others or port is None else replace(line, client_port=port)

    return change_data(specification, with_port)
