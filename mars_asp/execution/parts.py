"""Modules of several functions as they run: one part for each output.

A module with several outputs, or with an output beside commands or a sink, has a part for each
output. It is named like the output, `Camera.image`, and a scenario binds it by that name. The
commands and the sink of a module keep its own name. An input that several functions take, of one
name and representation, feeds each of their parts.
"""

from collections.abc import Iterator, Mapping
from dataclasses import replace

from mars_asp.model.declarations import (
    Configuration,
    Data,
    Module,
    Name,
    Relationship,
    Service,
    ends_of,
)
from mars_asp.model.ports import DELIVERING, inputs, outputs, parameter_names


def in_parts(
    specification: Configuration, modules: Mapping[str, Module]
) -> tuple[Configuration, dict[str, Module]]:
    """Return a specification, its modules apart where they have several outputs, and all modules.

    Lines to named inputs come in the order of the function's parameters, which is the order in
    which it is given its messages.
    """
    every = {**modules, **{module.name: module for module in specification.declared}}
    split = {name: outputs(module) for name, module in every.items() if _has_parts(module)}
    placed = _by_parameter(specification, every)
    if not split:
        return replace(specification, declared=(), relationships=placed), every
    lines = tuple(part for line in placed for part in _apart(line, every, split))
    used = {end for line in lines for end in ends_of(line)}
    parts = dict(every)
    names: list[Name] = []
    for name in specification.modules:
        if name.text not in split:
            names.append(name)
            continue
        module = every[name.text]
        for port, service in split[name.text].items():
            part = f"{name.text}.{port}"
            parts[part] = Module(part, module.span, (module.services[service],))
            names.append(Name(part, name.span))
        rest = tuple(each for each in module.services if each.kind not in DELIVERING)
        parts[name.text] = replace(module, services=rest)
        if rest or module.functions or name.text in used:
            names.append(name)
    split_up = replace(specification, modules=tuple(names), relationships=lines, declared=())
    return split_up, parts


def _has_parts(module: Module) -> bool:
    """Whether a module has several outputs, or one beside commands or a sink."""
    count = len(outputs(module))
    return count > 1 or bool(
        count and any(each.kind in ("ControlOut", "DataIn") for each in module.services)
    )


def _apart(
    line: Relationship, every: Mapping[str, Module], split: Mapping[str, Mapping[str, int]]
) -> Iterator[Relationship]:
    """Yield a line between the parts that it is about, once for each part that it feeds."""
    if not isinstance(line, Data):
        yield line
        return
    source = line.source
    if source in split:
        named = line.source_port or (next(iter(split[source])) if len(split[source]) == 1 else None)
        source = source if named is None else f"{source}.{named}"
    if line.client not in split:
        yield replace(line, source=source)
        return
    ports = {number: port for port, number in split[line.client].items()}
    served = [ports.get(number) for number in _services_of(line, every)] or [None]
    for port in dict.fromkeys(served):
        client = line.client if port is None else f"{line.client}.{port}"
        yield replace(line, source=source, client=client)


def _services_of(line: Data, every: Mapping[str, Module]) -> list[int]:
    """Return the functions of its client that a line feeds: by the input, else by the data.

    The first that takes them is meant, and each that has the same parameter.
    """
    services = every[line.client].services
    if line.client_port is not None:
        entry = inputs(every[line.client]).get(line.client_port)
        if entry is None:
            return []
        first, place = entry.service, entry.place
        if "#" in line.client_port:
            return [first]
    else:
        taken = [
            (number, place)
            for number, service in enumerate(services)
            for place in range(len(service.inputs))
        ]
        delivered = _delivered(line, every)
        fitting = [(n, place) for n, place in taken if services[n].inputs[place] in delivered]
        if not taken:
            return []
        first, place = (fitting or taken)[0]
    shared = _parameter_pairs(services[first])[place]
    others = (n for n, each in enumerate(services) if shared in _parameter_pairs(each))
    return [first, *(n for n in others if n != first and services[n].kind != "Converts")]


def _parameter_pairs(service: Service) -> list[tuple[str, str | None]]:
    return list(zip(parameter_names(service), service.inputs, strict=True))


def _delivered(line: Data, every: Mapping[str, Module]) -> set[str | None]:
    """Return the representations that the source of a line may deliver over it."""
    source = every.get(line.source)
    if source is None:
        return set()
    return {
        source.services[number].output
        for port, number in outputs(source).items()
        if line.source_port in (None, port)
    }


def _by_parameter(
    specification: Configuration, every: Mapping[str, Module]
) -> tuple[Relationship, ...]:
    """Return the lines, those to named inputs of a module among themselves in their order."""
    lines = list(specification.relationships)
    named: dict[str, list[int]] = {}
    for at, line in enumerate(lines):
        if isinstance(line, Data) and line.client_port is not None and line.client in every:
            named.setdefault(line.client, []).append(at)
    for client, places in named.items():
        order = list(inputs(every[client]))
        rank = {port: number for number, port in enumerate(order)}
        stated = sorted(_at(lines, places), key=lambda d: rank.get(d.client_port or "", len(rank)))
        for at, line in zip(places, stated, strict=True):
            lines[at] = line
    return tuple(lines)


def _at(lines: list[Relationship], places: list[int]) -> Iterator[Data]:
    for at in places:
        line = lines[at]
        assert isinstance(line, Data)
        yield line
