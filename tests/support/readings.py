"""Which input each data line means: section 3 of the language reference, read from the text.

Nothing here uses clingo or reads `rules/`.
"""

from collections.abc import Iterator, Mapping

from mars_asp.model.declarations import Configuration, Data, Module

#: The inputs of a module by name, with their representations; None where it is unknown.
Inputs = dict[str, str | None]


def inputs_of(module: Module) -> Inputs:
    """Return the inputs: parameters by name, those of one name and type once."""
    found: list[tuple[str, str | None, int]] = []
    for service in module.services:
        if service.kind == "Converts":
            continue
        names: list[str] = []
        for number, representation in enumerate(service.inputs):
            given = service.parameters[number] if number < len(service.parameters) else None
            name = given or representation or f"input{number}"
            names.append(name)
            entry = name, representation, names.count(name)
            if representation is None or entry not in found:
                found.append(entry)
    result: Inputs = {}
    for name, representation, _ in found:
        free, number = name, 1
        while free in result:
            number += 1
            free = f"{name}#{number}"
        result[free] = representation
    return result


def delivered(line: Data, modules: Mapping[str, Module]) -> str | None:
    """Return the representation that a line brings, if it is known."""
    module = modules.get(line.source)
    outputs = [s for s in module.services if s.kind in ("Sense", "DataOut")] if module else []
    if line.source_port is not None:
        outputs = [s for s in outputs if line.source_port in (s.port, s.function)]
    return outputs[0].output if len(outputs) == 1 else None


def reachable(start: str, modules: Mapping[str, Module]) -> set[str]:
    """Return the representations that declared converters make of one, itself included."""
    found, waiting = {start}, [start]
    while waiting:
        here = waiting.pop()
        for module in modules.values():
            for service in module.services:
                if service.kind == "Converts" and service.inputs[0] == here:
                    if service.output is not None and service.output not in found:
                        found.add(service.output)
                        waiting.append(service.output)
    return found


def readings(
    configuration: Configuration, modules: Mapping[str, Module]
) -> dict[int, tuple[str, ...]]:
    """Return the inputs that each line to a described client may mean, by the line's `id`.

    One is the input of the line. Several are left to the cheapest resolution, none stay open.
    """
    lines = [line for line in configuration.relationships if isinstance(line, Data)]
    found: dict[int, tuple[str, ...]] = {}
    for client in dict.fromkeys(line.client for line in lines):
        known = inputs_of(modules[client]) if client in modules else {}
        own = [line for line in lines if line.client == client]
        if known:
            found |= dict(_of_client(own, known, modules))
    return found


def _of_client(
    lines: list[Data], known: Inputs, modules: Mapping[str, Module]
) -> Iterator[tuple[int, tuple[str, ...]]]:
    for line in lines:
        if line.client_port is not None:
            yield id(line), (line.client_port,)
    unnamed = [line for line in lines if line.client_port is None]
    if len(known) == 1:
        yield from ((id(line), tuple(known)) for line in unnamed)
        return
    free = [name for name in known if name not in {line.client_port for line in lines}]
    brought = {id(line): delivered(line, modules) for line in unnamed}
    meant: dict[int, str | None] = {}
    choosing: dict[int, set[str]] = {}

    def take(line: Data, representation: str) -> None:
        """Give a line the next free input of a representation, or the only one there is."""
        alike = [name for name, each in known.items() if each == representation]
        if len(alike) == 1:
            meant[id(line)] = alike[0]
            return
        meant[id(line)] = next((n for n in alike if n in free), None)
        if meant[id(line)] is not None:
            free.remove(meant[id(line)] or "")

    direct = [line for line in unnamed if brought[id(line)] in set(known.values()) - {None}]
    for line in direct:
        take(line, brought[id(line)] or "")
    for line in unnamed:
        start = brought[id(line)]
        if line in direct or start is None:
            continue
        ways = reachable(start, modules) & set(known.values())
        if len(ways) == 1:
            take(line, str(*ways))
        elif ways:
            choosing[id(line)] = {str(way) for way in ways}
    left = [name for name in free if name not in meant.values()]
    rest = [line for line in unnamed if id(line) not in meant and id(line) not in choosing]
    meant |= _eliminated(rest, left, known, brought)
    could = {
        number: tuple(name for way in sorted(ways) for name in _candidates(way, known, free))
        for number, ways in choosing.items()
    }
    unfed = {name for name in free if name not in meant.values()}
    for number, names in could.items():
        others = (set(each) for other, each in could.items() if other != number)
        disputed = any(len(set(names) & each & unfed) > 1 for each in others)
        yield number, () if disputed else names
    for number, name in meant.items():
        yield number, () if name is None else (name,)


def _eliminated(
    rest: list[Data], left: list[str], known: Inputs, brought: Mapping[int, str | None]
) -> dict[int, str | None]:
    """Return the input in `left` that each line in `rest` feeds, or None if it stays open."""
    meant: dict[int, str | None] = {}
    untyped = [name for name in left if known[name] is None]
    typed = [line for line in rest if brought[id(line)] is not None]
    if len(untyped) == 1 and typed:
        meant |= {id(line): untyped[0] for line in typed}
        rest = [line for line in rest if line not in typed]
        left.remove(untyped[0])
    if len(left) == 1:
        meant |= {id(line): left[0] for line in rest}
    elif len({known[name] for name in left}) == 1 and known[left[0]] is not None:
        for number, line in enumerate(rest):
            meant[id(line)] = left[number] if number < len(left) else None
    else:
        meant |= {id(line): None for line in rest}
    return meant


def _candidates(representation: str, known: Inputs, free: list[str]) -> list[str]:
    alike = [name for name, each in known.items() if each == representation]
    return alike if len(alike) == 1 else [name for name in alike if name in free][:1]
