"""The names of outputs and inputs in facts.

An output has the name of its module or, if the module has several, `MODULE.PORT`, as in a line.
A port of an undescribed module is assumed to exist; rules check the ports of described modules.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

from mars_asp.model.declarations import (
    Configuration,
    Data,
    Gating,
    Module,
    Relationship,
    Service,
    ends_of,
    ports_of,
)
from mars_asp.model.names import end
from mars_asp.model.ports import DELIVERING, Input, inputs, outputs
from mars_asp.model.remembered import remembered


class Output(NamedTuple):
    """An output: its module, its port, and the service that delivers it, or None if undescribed."""

    module: str
    port: str
    service: Service | None


class InputEnd(NamedTuple):
    """An input: its module, its port, and its description, or None if it has none."""

    module: str
    port: str
    found: Input | None


@dataclass(frozen=True)
class Ends:
    """The names of the ports that a configuration uses; `outputs` only of modules with several.

    `entries` are the inputs of clients that have several inputs or are connected by a named port.
    """

    outputs: Mapping[str, Output]
    entries: Mapping[str, InputEnd]
    #: The name of an output, by module and port, and by the module alone.
    _sources: Mapping[tuple[str, str | None], str]
    _clients: Mapping[tuple[str, str | None], str]
    #: The port that lines name, by the name of an output.
    _port_of: Mapping[str, str]

    def source(self, data: Data) -> str:
        """Return the name of the output from which a data line takes its data."""
        port = data.source_port
        unknown = data.source if port is None else end(data.source, port)
        return self._sources.get((data.source, port), unknown)

    def entry(self, data: Data) -> str | None:
        """Return the name of the input at which a data line arrives, or None if it needs none."""
        port = data.client_port
        if port is None:
            return self._clients.get((data.client, None))
        return self._clients.get((data.client, port), end(data.client, port))

    def taken(self, module: str, port: str | None) -> str:
        """Return the name of the output, or else of the module, that a side line names."""
        return self._sources.get((module, port), module if port is None else end(module, port))

    def gated(self, line: Gating) -> str:
        """Return the name of the output or input that a line gates."""
        place = line.gated, line.port
        if line.port is not None and place not in self._sources and place in self._clients:
            return self._clients[place]
        return self.taken(*place)

    def output(self, module: str, port: str) -> str:
        """Return the name of an output in facts: `MODULE.PORT`, or `MODULE` if it has only one."""
        return self._sources.get((module, port), module)

    def services(self, described: Mapping[str, Module]) -> dict[str, Service]:
        """Return the service that delivers each output, by the name of the output.

        An output without exactly one delivering service is left out. `described` are the described
        modules.
        """
        delivering = ((name, _delivering(module)) for name, module in described.items())
        found = {name: services[0] for name, services in delivering if len(services) == 1}
        several = ((name, output.service) for name, output in self.outputs.items())
        return found | {name: service for name, service in several if service is not None}

    def written(self, name: str) -> tuple[str, str | None]:
        """Return the module and port of an output in facts; None if no line names the port."""
        found = self.outputs.get(name)
        return (name, self._port_of.get(name)) if found is None else (found.module, found.port)


@remembered
def ends_in(configuration: Configuration, described: Mapping[str, Module]) -> Ends:
    """Return the names of the ports that the data lines of a configuration use."""
    lines = [each for each in configuration.relationships if isinstance(each, Data)]
    named: dict[str, dict[str, None]] = {}
    entered: dict[str, dict[str, None]] = {}
    # Most modules have few parameters, and need no names for them.
    several = (n for n, m in described.items() if sum(len(s.inputs) for s in m.services) > 1)
    several_inputs = {name for name in several if len(inputs(described[name])) > 1}
    for line in lines:
        if line.source_port is not None:
            named.setdefault(line.source, {})[line.source_port] = None
        if line.client_port is not None:
            entered.setdefault(line.client, {})[line.client_port] = None
        elif line.client in several_inputs:
            entered.setdefault(line.client, {})
    for module, port in side_outputs(configuration.relationships):
        named.setdefault(module, {})[port] = None
    for each in configuration.relationships:
        if isinstance(each, Gating) and each.port is not None:
            is_input = _is_input(each, described, named, entered)
            (entered if is_input else named).setdefault(each.gated, {})[each.port] = None
    taken = {name.text for name in configuration.modules}
    every: dict[str, Output] = {}
    sources: dict[tuple[str, str | None], str] = {}
    declared: dict[str, str] = {}
    delivering = {name for name, module in described.items() if len(_delivering(module)) > 1}
    for name in sorted(delivering | named.keys()):
        found = _outputs(name, described.get(name), named.get(name, ()))
        own = [output for output in found if name not in described or output.service is not None]
        for output in found:
            if own == [output]:
                sources[name, output.port] = name
                declared[name] = output.port
            else:
                text = _free(taken, name, output.port)
                sources[name, output.port] = text
                every[text] = output
    entries: dict[str, InputEnd] = {}
    clients: dict[tuple[str, str | None], str] = {}
    for name, ports in sorted(entered.items()):
        known = inputs(described[name]) if name in described else {}
        for port in dict.fromkeys((*known, *ports)):
            text = clients[name, port] = _free(taken, name, port)
            entries[text] = InputEnd(name, port, known.get(port))
    return Ends(every, entries, sources, clients, declared)


def side_outputs(lines: Iterable[Relationship]) -> Iterator[tuple[str, str]]:
    """Yield the outputs that lines of gates, resets, locks and limits take, as module and port."""
    for line in lines:
        port = ports_of(line)[1]
        if port is not None and not isinstance(line, Data):
            yield ends_of(line)[1], port


def _is_input(
    line: Gating,
    described: Mapping[str, Module],
    named: Mapping[str, Mapping[str, None]],
    entered: Mapping[str, Mapping[str, None]],
) -> bool:
    """Whether a line gates an input: the port is one, and no output has its name.

    Of a module that has inputs and no outputs, any suppressed port is an input, if a misspelt one.
    `named` are the outputs, `entered` the inputs that other lines name, by their modules.
    """
    module = described.get(line.gated)
    if module is not None:
        known, own = inputs(module), outputs(module)
        return line.port not in own and (
            line.port in known or bool(known and not own and line.sign == "suppress")
        )
    return line.port in entered.get(line.gated, ()) and line.port not in named.get(line.gated, ())


def ends_of_specification(
    configuration: Configuration, described: Mapping[str, Module], specification: Configuration
) -> Ends:
    """Return the ends of a configuration, extended by the ports that its specification names.

    A port that only the specification names is the output of a source with a single output, or the
    only named port of an undescribed source. The only input of a client is the same end with and
    without its name.
    """
    ends = ends_in(configuration, described)
    named: dict[str, set[str]] = {}
    for line in specification.relationships:
        if isinstance(line, Data) and line.source_port is not None:
            named.setdefault(line.source, set()).add(line.source_port)
    for source, port in side_outputs(specification.relationships):
        named.setdefault(source, set()).add(port)
    known = {module for module, _ in ends._sources}
    alone: dict[tuple[str, str | None], str] = {}
    for module in named.keys() - known:
        ports = outputs(described[module]) if module in described else named[module]
        if len(ports) == 1:
            alone[module, *ports] = module
    entries: dict[tuple[str, str | None], str] = {}
    clients = {line.client for line in specification.relationships if isinstance(line, Data)}
    for client in clients & described.keys():
        if len(own := inputs(described[client])) == 1:
            (port,) = own
            if (client, port) in ends._clients:
                entries[client, None] = ends._clients[client, port]
            else:
                entries[client, port] = client
    return replace(ends, _sources={**ends._sources, **alone}, _clients={**ends._clients, **entries})


def _delivering(module: Module) -> list[Service]:
    return [service for service in module.services if service.kind in DELIVERING]


def _outputs(name: str, module: Module | None, named: Iterable[str]) -> Sequence[Output]:
    """Return the outputs of a module, with those that lines name (`named`)."""
    known = {} if module is None else outputs(module)
    services: Sequence[Service] = () if module is None else module.services
    return [
        Output(name, port, services[known[port]] if port in known else None)
        for port in dict.fromkeys((*known, *named))
    ]


def _free(taken: set[str], module: str, port: str) -> str:
    """Return `MODULE.PORT`, with `'` appended until it is not in `taken`, and add it to `taken`."""
    text = end(module, port)
    while text in taken:
        text += "'"
    taken.add(text)
    return text
