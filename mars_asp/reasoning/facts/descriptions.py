"""The descriptions of modules as facts that `rules/verify` compares, part by part."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from fractions import Fraction

from mars_asp.asp.solve.atoms import Atom, Fact
from mars_asp.diagnostic import Span
from mars_asp.language.print import print_mode, print_number, print_transformation
from mars_asp.model.declarations import Configuration, Module, Service
from mars_asp.model.ports import DELIVERING, inputs, outputs
from mars_asp.model.rates import as_written
from mars_asp.model.transformation import normalized

_UNKNOWN = "unknown"
_NONE = "none"
#: Where vertex 0 is unless a module states it.
_IDENTITY = "(_,_,_,_,_,_,_)"


def instance_facts(
    prefix: str, configuration: Configuration, described: Mapping[str, Module]
) -> Iterator[Fact]:
    """Yield a fact with the describing module of each module of a configuration that has one.

    `prefix` precedes the name of the predicate; `described` are the described modules by name.
    """
    for name in configuration.modules:
        own = name.text if name.text in described else None
        if (instance := name.described or own) is not None:
            yield _located(f"{prefix}instance", name.span, name.text, instance)


def description_facts(
    prefix: str, described: Mapping[str, Module], canonical: Mapping[str, str]
) -> Iterator[Fact]:
    """Yield a fact for each detail of each module's description, so that two can be compared.

    `prefix` precedes the names of the predicates. `canonical` maps each representation to the name
    that the rules compare.
    """
    for module in described.values():
        place = module.named or module.span
        yield _located(f"{prefix}described_at", place, module.name)
        for part, name, aspect, value, span in _details(module, canonical):
            at = (module.name, Atom(part), name, Atom(aspect), value)
            yield Fact(Atom(f"{prefix}detail", (*at, _location(span))), span)


def _located(predicate: str, span: Span, *arguments: str) -> Fact:
    return Fact(Atom(predicate, (*arguments, _location(span))), span)


def _location(span: Span) -> Atom:
    return Atom("at", (span.path, span.line, span.column))


def _details(
    module: Module, canonical: Mapping[str, str]
) -> Iterator[tuple[str, str, str, str, Span]]:
    """Yield part, name, aspect, value and location of each detail of a module's description."""
    if module.guard is not None:
        yield "annotation", "@Guard", "place", "stated", module.guard
    for function in module.functions:
        numbers = (function.min, function.max, function.rate)
        limits = " ".join("_" if number is None else print_number(number) for number in numbers)
        yield "motion", function.name, "limits", limits, function.span
    for vertex in module.vertices:
        pose = print_transformation(normalized(vertex.transformation))
        if vertex.number or pose != _IDENTITY:
            yield "vertex", str(vertex.number), "transformation", pose, vertex.span
    entries = inputs(module)
    for name, entry in entries.items():
        number, index = entry.parameters[0]
        service = module.services[number]
        representation = _representation(service.inputs[index], canonical)
        yield "input", name, "representation", representation, service.span
    for number, (part, name) in _named_services(module).items():
        service = module.services[number]
        own = [
            entry.name
            for entry in entries.values()
            if any(parameter.service == number for parameter in entry.parameters)
        ]
        for aspect, value in _aspects(service, own, canonical):
            yield part, name, aspect, value, service.span


def _named_services(module: Module) -> Mapping[int, tuple[str, str]]:
    """Return the part and the name of each service, by its number."""
    found = {number: ("output", port) for port, number in outputs(module).items()}
    seen: dict[str, int] = {}
    for number, service in enumerate(module.services):
        if number not in found:
            name = service.function or service.kind
            seen[name] = seen.get(name, 0) + 1
            apart = name if seen[name] == 1 else f"{name}#{seen[name]}"
            found[number] = ("converter" if service.kind == "Converts" else "function", apart)
    return found


def _aspects(
    service: Service, own: list[str], canonical: Mapping[str, str]
) -> Iterator[tuple[str, str]]:
    """Yield each aspect of a service with its value; `own` are the names of its inputs."""
    yield "annotation", f"@{service.kind}"
    if service.kind == "Converts":
        ends = (*service.inputs[:1], service.output)
        yield "conversion", " -> ".join(_representation(end, canonical) for end in ends)
        yield "cost", str(service.cost)
        return
    yield "inputs", ", ".join(own) or _NONE
    if service.kind == "ControlOut":
        yield "functions", ", ".join(sorted(set(service.commands))) or _NONE
    if service.window_ms is not None:
        yield "window", f"{service.window_ms} ms"
    if service.kind in DELIVERING:
        yield "representation", _representation(service.output, canonical)
        # Modes are equal whatever their texts are.
        modes = (print_mode(replace(mode, text="")) for mode in service.modes)
        yield "modes", ", ".join(modes) or _NONE
        yield "rate", _NONE if service.hz is None else as_written(Fraction(service.hz))


def _representation(written: str | None, canonical: Mapping[str, str]) -> str:
    return _UNKNOWN if written is None else canonical[written]
