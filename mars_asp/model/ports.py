"""The ports of a module: its outputs and inputs, by name.

Each function that delivers data is an output, named like the function or by `@Port`; each of
its parameters an input, named like the parameter, else by its representation. A parameter of one
name and representation that several functions take is one input. Any other name that comes again is
`NAME#2`.
"""

import re
from collections import Counter
from collections.abc import Iterable, Iterator
from itertools import count
from typing import NamedTuple

from mars_asp.model.declarations import Module, Service

DELIVERING = ("Sense", "DataOut", "Done")
#: Positions fit clingo's integers; a longer number is a name like others.
_POSITIONAL = re.compile(r"input([1-9][0-9]{0,8})")


class Parameter(NamedTuple):
    """A parameter of a function: the index of its service in the module, and its index there."""

    service: int
    place: int


class Input(NamedTuple):
    """An input of a module: its name, and the parameters that it feeds, at most one a function."""

    name: str
    parameters: tuple[Parameter, ...]


def outputs(module: Module) -> dict[str, int]:
    """Return the name of each output with the index of the service that delivers it."""
    delivering = [n for n, each in enumerate(module.services) if each.kind in DELIVERING]
    services = (module.services[number] for number in delivering)
    names = (each.port or each.function or each.output or "output" for each in services)
    return dict(zip(_unique_names(names), delivering, strict=True))


def inputs(module: Module) -> dict[str, Input]:
    """Return the inputs of a module by their names; none feeds a converter or a reset."""
    groups: list[tuple[str, list[Parameter]]] = []
    known: dict[tuple[str, str, int], list[Parameter]] = {}
    for number, service in enumerate(module.services):
        if service.kind in ("Converts", "Reset"):
            continue
        seen: Counter[str] = Counter()
        for index, name in enumerate(parameter_names(service)):
            representation = service.inputs[index]
            seen[name] += 1
            parameter = Parameter(number, index)
            # Unknown representations are not equal.
            shared = None if representation is None else (name, representation, seen[name])
            if shared in known:
                known[shared].append(parameter)
                continue
            groups.append((name, [parameter]))
            if shared is not None:
                known[shared] = groups[-1][1]
    names = _unique_names(name for name, _ in groups)
    return {
        name: Input(name, tuple(parameters))
        for name, (_, parameters) in zip(names, groups, strict=True)
    }


def parameter_names(service: Service) -> Iterator[str]:
    """Yield the name of each input of a service: of the parameter, else the representation."""
    for index, representation in enumerate(service.inputs):
        named = service.parameters[index] if index < len(service.parameters) else None
        yield named or representation or f"input{index}"


def input_position(port: str) -> int | None:
    """Return the number in a name such as `input2`, or None for another name."""
    found = _POSITIONAL.fullmatch(port)
    return None if found is None else int(found[1])


def free_positions(ports: Iterable[str | None]) -> Iterator[int]:
    """Yield the positions, from 1, that no port such as `input2` of a line states."""
    taken = {input_position(port) for port in ports if port is not None}
    return (number for number in count(1) if number not in taken)


def _unique_names(names: Iterable[str]) -> Iterator[str]:
    """Yield names, where the n-th repetition is `NAME#n`."""
    seen: Counter[str] = Counter()
    for name in names:
        seen[name] += 1
        yield name if seen[name] == 1 else f"{name}#{seen[name]}"
