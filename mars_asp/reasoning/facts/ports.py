"""Ports as facts: the outputs and inputs of modules, and the unconnected or misspelt ones."""

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import TypeAlias

from mars_asp.asp.solve.atoms import Fact, fact_at
from mars_asp.diagnostic import Span
from mars_asp.model.declarations import (
    Configuration,
    Data,
    Gating,
    Lock,
    Module,
    Relationship,
    Reset,
    ends_of,
    ports_of,
)
from mars_asp.model.described import module_classes
from mars_asp.model.names import end
from mars_asp.model.ports import inputs, outputs
from mars_asp.reasoning.facts.ends import Ends, side_outputs
from mars_asp.reasoning.facts.identifiers import annotation_numbers
from mars_asp.reasoning.facts.loose_ends import PortEnd, nearest
from mars_asp.reasoning.facts.topic_names import are_alike

#: Described modules by their names, each with its description.
Described: TypeAlias = Mapping[str, Module]
Numbered: TypeAlias = Sequence[tuple[int, Relationship]]
#: Yields the ports of a module: name, number of the service, index in it, and representation.
_PortsOf: TypeAlias = Callable[[Module], Iterable[tuple[str, int, int, str | None]]]
_Numbers: TypeAlias = Mapping[tuple[str, int], tuple[int, Span]]


def output_facts(configuration: Configuration, ends: Ends) -> Iterator[Fact]:
    """Yield the outputs of modules that have several."""
    places = _module_spans(configuration)
    for text, output in ends.outputs.items():
        place = places.get(output.module, configuration.span)
        span = place if output.service is None else output.service.span
        yield fact_at(span, "output_of", text, output.module)


def named_inputs(ends: Ends, lines: Numbered) -> Iterator[Fact]:
    """Yield the input that each line uses, if it has a name."""
    for number, line in lines:
        if isinstance(line, Data):
            named = ends.entry(line)
            if named is not None:
                yield fact_at(line.span, "into", number, named)


def turns(configuration: Configuration, ends: Ends, lines: Numbered) -> Iterator[Fact]:
    """Yield the index of each line that names no input, among such lines of its client.

    Only clients with an entry in `ends.entries` are included.
    """
    clients = {each.module for each in ends.entries.values() if each.found is not None}
    if not clients:
        return
    numbers = {id(line): number for number, line in lines}
    counts: Counter[str] = Counter()
    for line in configuration.relationships:
        if isinstance(line, Data) and line.client_port is None and line.client in clients:
            counts[line.client] += 1
            yield fact_at(line.span, "in_turn", numbers[id(line)], counts[line.client])


def input_facts(configuration: Configuration, described: Described, ends: Ends) -> Iterator[Fact]:
    """Yield the inputs of clients that have several inputs or whose input is named by a line."""
    if not ends.entries:
        return
    places, numbers = _module_spans(configuration), annotation_numbers(configuration, described)
    for text, entry in ends.entries.items():
        if entry.found is None:
            place = places.get(entry.module, configuration.span)
            yield fact_at(place, "input_of", text, entry.module)
            continue
        services = described[entry.module].services
        first = services[entry.found.parameters[0].service]
        yield fact_at(first.span, "input_of", text, entry.module)
        for at, index in entry.found.parameters:
            number, span = numbers[entry.module, id(services[at])]
            yield fact_at(span, "takes_in", text, number, index)


def loose_ends(
    configuration: Configuration,
    described: Described,
    ends: Ends,
    lines: Numbered,
    canonical: Mapping[str, str],
) -> Iterator[Fact]:
    """Yield the names of unconnected outputs, and the open inputs for which each may be meant.

    `canonical` are the canonical names of representations.
    """
    data = [line for _, line in lines if isinstance(line, Data)]
    taken = {ends.source(line) for line in data}
    taken |= {ends.output(*port) for port in side_outputs(configuration.relationships)}
    for line in configuration.relationships:
        # One that names no port takes the only output of a module without commands.
        if isinstance(line, Gating | Reset | Lock) and ports_of(line)[1] is None:
            source = ends_of(line)[1]
            module = described.get(source)
            if module is not None and "control_out_algorithm" not in module_classes(module):
                taken.add(source)
    numbers = annotation_numbers(configuration, described)
    outputs = list(_port_ends(described, _outputs_of, numbers, canonical))
    free = [port for port in outputs if ends.output(port.module, port.port) not in taken]
    for port in free:
        yield fact_at(port.span, "port_name", port.annotation, end(port.module, port.port))
    if not free:
        return
    entered = {(line.client, line.client_port) for line in data}
    every = _port_ends(described, _inputs_of, numbers, canonical)
    open_ = (port for port in every if (port.module, port.port) not in entered)
    for entry, output, rank in nearest(open_, outputs, frozenset(free)):
        called = end(entry.module, entry.port)
        place = entry.annotation, entry.place
        yield fact_at(entry.span, "near", *place, called, output.annotation, rank)
        if entry.port.startswith("/") and are_alike(entry.port, output.port):
            yield fact_at(entry.span, "alike_topics", *place, output.annotation)


def unknown_ports(described: Described, ends: Ends) -> Mapping[str, Iterable[str]]:
    """Return the ports that lines name but their modules lack, with the module's actual ports."""
    found: dict[str, Iterable[str]] = {}
    for text, output in ends.outputs.items():
        if output.service is None and output.module in described:
            known = outputs(described[output.module])
            found[text] = [end(output.module, port) for port in known]
    for text, entry in ends.entries.items():
        if entry.found is None and entry.module in described:
            into = inputs(described[entry.module])
            found[text] = [end(entry.module, port) for port in into]
    return found


def _module_spans(configuration: Configuration) -> Mapping[str, Span]:
    return {name.text: name.span for name in configuration.modules}


def _port_ends(
    described: Described, of: _PortsOf, numbers: _Numbers, canonical: Mapping[str, str]
) -> Iterator[PortEnd]:
    """Yield the ports of described modules; `of` returns the outputs or the inputs of one module.

    `numbers` are the identifiers of annotations, `canonical` the canonical representations.
    """
    for name, module in described.items():
        for called, service, place, representation in of(module):
            number, span = numbers[name, id(module.services[service])]
            known = canonical.get(representation) if representation is not None else None
            yield PortEnd(number, place, span, name, called, known)


def _outputs_of(module: Module) -> Iterator[tuple[str, int, int, str | None]]:
    for name, service in outputs(module).items():
        yield name, service, 0, module.services[service].output


def _inputs_of(module: Module) -> Iterator[tuple[str, int, int, str | None]]:
    for name, each in inputs(module).items():
        for service, index in each.parameters:
            yield name, service, index, module.services[service].inputs[index]
