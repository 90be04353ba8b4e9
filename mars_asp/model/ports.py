"""The ports of a module: its outputs and inputs, by name.

Each function that delivers data is an output, named like the function or as `@Port` says; each of
its parameters an input, named like the parameter, else by its representation. A name that comes
again is `NAME#2`.
"""

from collections import Counter
from collections.abc import Iterable, Iterator
from typing import NamedTuple

from mars_asp.model.declarations import Module, Service

DELIVERING = ("Sense", "DataOut")


class Input(NamedTuple):
    """An input of a module: its name, the number of its service, and its place there."""

    name: str
    service: int
    place: int


def outputs(module: Module) -> dict[str, int]:
    """Return the numbers of the services that deliver data, by the names of their outputs."""
    delivering = [n for n, each in enumerate(module.services) if each.kind in DELIVERING]
    names = (_output(module.services[number]) for number in delivering)
    return dict(zip(_told_apart(names), delivering, strict=True))


def inputs(module: Module) -> dict[str, Input]:
    """Return the inputs of a module by their names; a converter is fed by no line."""
    found = [
        (name, number, index)
        for number, service in enumerate(module.services)
        if service.kind != "Converts"
        for index, name in enumerate(parameter_names(service))
    ]
    names = _told_apart(name for name, _, _ in found)
    return {
        name: Input(name, number, index)
        for name, (_, number, index) in zip(names, found, strict=True)
    }


def parameter_names(service: Service) -> Iterator[str]:
    """Yield how each input of a service is called."""
    for index, representation in enumerate(service.inputs):
        named = service.parameters[index] if index < len(service.parameters) else None
        yield named or representation or f"input{index}"


def _output(service: Service) -> str:
    return service.port or service.function or service.output or "output"


def _told_apart(names: Iterable[str]) -> Iterator[str]:
    """Yield names, each that came before with its number."""
    seen: Counter[str] = Counter()
    for name in names:
        seen[name] += 1
        yield name if seen[name] == 1 else f"{name}#{seen[name]}"
