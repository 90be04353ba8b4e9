"""Modules with several outputs as what they are when they run: one part for each function.

A part is called like its output, `Camera.image`, and a scenario binds it by that name. What else a
module does stays with its own name.
"""

from collections.abc import Iterator, Mapping
from dataclasses import replace

from mars_asp.model.declarations import Configuration, Data, Module, Name, Relationship, ends_of
from mars_asp.model.ports import DELIVERING, inputs, outputs


def in_parts(
    specification: Configuration, modules: Mapping[str, Module]
) -> tuple[Configuration, dict[str, Module]]:
    """Return a specification, its modules apart where they have several outputs, and all modules.

    Lines to named inputs come in the order of the function's parameters, which is the order in
    which it is given its messages.
    """
    every = {**modules, **{module.name: module for module in specification.declared}}
    split = {name: found for name, module in every.items() if len(found := outputs(module)) > 1}
    placed = _by_parameter(specification, every)
    if not split:
        return replace(specification, declared=(), relationships=placed), every
    lines = tuple(_apart(line, every, split) for line in placed)
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


def _apart(
    line: Relationship, every: Mapping[str, Module], split: Mapping[str, Mapping[str, int]]
) -> Relationship:
    """Return a line between the parts that it is about."""
    if not isinstance(line, Data):
        return line
    source, client = line.source, line.client
    if source in split and line.source_port is not None:
        source = f"{source}.{line.source_port}"
    if client in split:
        service = _service_of(line, every)
        port = next((p for p, number in split[client].items() if number == service), None)
        client = client if port is None else f"{client}.{port}"
    return replace(line, source=source, client=client)


def _service_of(line: Data, every: Mapping[str, Module]) -> int | None:
    """Return which of its client's functions a line is for: by the input, else by what it takes."""
    client = every[line.client]
    if line.client_port is not None:
        entry = inputs(client).get(line.client_port)
        return None if entry is None else entry.service
    source = every.get(line.source)
    delivered = set()
    if source is not None:
        for port, number in outputs(source).items():
            if line.source_port in (None, port):
                delivered.add(source.services[number].output)
    taking = [n for n, each in enumerate(client.services) if delivered & set(each.inputs)]
    able = taking or [n for n, each in enumerate(client.services) if each.inputs]
    return able[0] if able else None


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
