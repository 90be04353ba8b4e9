"""The content of a foreign file as lines of an expected output, and that of a configuration."""

from collections.abc import Iterator

from mars_asp.diagnostic import Diagnostic
from mars_asp.language import Parsed
from mars_asp.language.print import print_relationship
from mars_asp.model.declarations import Configuration, Module, Service
from mars_asp.model.rates import as_written
from mars_asp.reasoning.analysis import analyse
from mars_asp.reasoning.project import described, project_facts
from mars_asp.reasoning.rules import load_rulebook


def place(diagnostic: Diagnostic) -> str:
    """Return a diagnostic in a line."""
    span = diagnostic.span
    return f"{span.line}:{span.column}: {diagnostic.severity}: {diagnostic.message}"


def golden_lines(found: Parsed) -> Iterator[str]:
    """Yield the modules with their ports, the relationships and the warnings, with locations."""
    configuration = found.configuration
    described = {module.name: module for module in configuration.declared}
    for name in configuration.modules:
        yield f"{name.span.line}:{name.span.column}: {name.text}"
        if name.text in described:
            yield from map(_port, described[name.text].services)
    for line in configuration.relationships:
        yield f"{line.span.line}:{line.span.column}: {print_relationship(line)}"
    yield from map(place, found.warnings)


def _port(service: Service) -> str:
    at = f"  {service.span.line}:{service.span.column}:"
    if service.kind == "ControlOut":
        return f"{at} commands"
    if service.inputs:
        return f"{at} in {service.parameters[0]}: {service.inputs[0]}"
    rate = "" if service.hz is None else f" {as_written(service.hz)}"
    return f"{at} out {service.port}: {service.output}{rate}"


def meaning(of: Configuration) -> tuple[object, ...]:
    """Return the content of a configuration without locations."""
    lines = [print_relationship(line) for line in of.relationships]
    return (
        of.architecture,
        [name.text for name in of.modules],
        lines,
        set(map(_described, of.declared)),
    )


def _described(module: Module) -> tuple[object, ...]:
    services = [
        (s.kind, s.output, s.inputs, s.modes, s.hz, s.port, s.parameters) for s in module.services
    ]
    return module.name, tuple(services)


def findings_of(found: Parsed) -> list[str]:
    """Return the findings of a configuration, each with its subject, but unused outputs."""
    project = described(found, "")
    rulebook = load_rulebook([], ("resolve",))
    analysis = analyse(project_facts(project), rulebook, project.configuration.span)
    lines = [f"{each.kind}({each.subject})" for each in analysis.consequences]
    return sorted(each for each in lines if not each.startswith("unused_output"))
