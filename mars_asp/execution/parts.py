"""Splitting of modules with several functions into one part for each output.

A module with several outputs, or with an output beside commands or a sink, has a part for each
output. The part is named by the output, `Camera.image`, and a scenario binds it by that name. The
commands and the sink of a module keep the module's name. An input that several functions share, by
name and representation, feeds the part of each.
"""

from collections.abc import Iterator, Mapping
from dataclasses import replace

from mars_asp.model.declarations import (
    Configuration,
    Control,
    Data,
    Gating,
    Limit,
    Lock,
    Module,
    Mount,
    Name,
    Relationship,
    Reset,
    Strategy,
    ends_of,
    ports_of,
    with_source,
)
from mars_asp.model.ports import DELIVERING, inputs, outputs


def in_parts(
    specification: Configuration, modules: Mapping[str, Module]
) -> tuple[Configuration, dict[str, Module]]:
    """Return a specification whose modules with several outputs are split, and all modules.

    A relationship with an input that several parts share becomes one for each part.
    """
    every = specification.with_declared(modules)
    split = {name: outputs(module) for name, module in every.items() if _has_parts(module)}
    if not split:
        return replace(specification, declared=()), every
    lines = tuple(
        each for line in specification.relationships for each in _split_lines(line, every, split)
    )
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
    """Whether a module has several outputs, or one beside commands or a sink, or of completion."""
    count = len(outputs(module))
    beside = any(each.kind in ("ControlOut", "DataIn", "Done") for each in module.services)
    return count > 1 or bool(count and beside)


def _split_lines(
    line: Relationship, every: Mapping[str, Module], split: Mapping[str, Mapping[str, int]]
) -> Iterator[Relationship]:
    """Yield the relationships that replace one whose ends are split into parts."""
    if isinstance(line, Mount | Control | Strategy):
        yield line
        return
    if not isinstance(line, Data):
        yield _from_part(line, every, split)
        return
    if line.source in split:
        own = split[line.source]
        port = line.source_port or (next(iter(own)) if len(own) == 1 else None)
        line = line if port is None else replace(line, source=f"{line.source}.{port}")
    if line.client not in split:
        yield line
        return
    for part, port in _fed_parts(line, every[line.client], split[line.client]):
        yield replace(line, client=part, client_port=port)


def _from_part(
    line: Gating | Reset | Lock | Limit,
    every: Mapping[str, Module],
    split: Mapping[str, Mapping[str, int]],
) -> Relationship:
    """Return a line to a side from the part that its source means.

    Without a port, that is the module's command, or else its only output.
    """
    source, port = ends_of(line)[1], ports_of(line)[1]
    if source not in split:
        return line
    own = split[source]
    commands = any(each.kind == "ControlOut" for each in every[source].services)
    if port is None and not commands and len(own) == 1:
        port = next(iter(own))
    if port not in own:
        return line
    return with_source(line, f"{source}.{port}", None)


def _fed_parts(
    line: Data, client: Module, split: Mapping[str, int]
) -> Iterator[tuple[str, str | None]]:
    """Yield each part of the client that a relationship feeds, with the input of the part."""
    known = inputs(client)
    named = line.client_port or (next(iter(known)) if len(known) == 1 else None)
    if named is None or named not in known:
        # The part is ambiguous; the plan reports the error.
        yield line.client, line.client_port
        return
    ports = {number: port for port, number in split.items()}
    for number, index in known[named].parameters:
        service = client.services[number]
        own = tuple(inputs(replace(client, services=(service,))))[index]
        yield (f"{line.client}.{ports[number]}" if number in ports else line.client), own
