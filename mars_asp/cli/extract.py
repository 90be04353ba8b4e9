"""Print the modules found in annotated sources."""

import argparse
import sys
from collections.abc import Iterator
from decimal import Decimal
from fractions import Fraction
from pathlib import Path

from mars_asp.annotations.files import Extraction, extract, find_paths
from mars_asp.cli.diagnostic_text import report
from mars_asp.cli.encode import print_result
from mars_asp.cli.settings import check_settings
from mars_asp.diagnostic import MarsError
from mars_asp.language.parse import unreadable
from mars_asp.language.print import print_attribute
from mars_asp.model.declarations import Function, Module, Service
from mars_asp.model.described import module_classes
from mars_asp.model.names import plain
from mars_asp.model.ports import parameter_names
from mars_asp.model.rates import as_written
from mars_asp.output import visible


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("paths", nargs="+", metavar="PATH")


def run(arguments: argparse.Namespace) -> int:
    """Print the modules; return 1 if an annotation is wrong, 2 if a file cannot be read."""
    check_settings(arguments)
    paths: list[Path] = []
    for word in (*arguments.paths, *arguments.sources):
        matches = find_paths(word)
        if not matches:
            advice = "name the files; standard input is not read" if word == "-" else None
            raise MarsError([unreadable(word, "no such file", advice)])
        paths += matches
    found = extract(paths)
    report(found.diagnostics, arguments)
    if not (found.modules or found.diagnostics or arguments.quiet):
        where = ", ".join(map(visible, arguments.paths))
        print(f"mars-asp extract: no annotated module in {where}", file=sys.stderr)
    lines = (visible(line) for module in found.modules for line in module_lines(module))
    print_result(arguments, lambda: extraction_json(found), lines)
    errors = [d.code for d in found.diagnostics if d.severity == "error"]
    # Such an error is about a whole file, so the modules in it are unknown.
    return 2 if any(code.startswith("MARS3") for code in errors) else int(bool(errors))


def extraction_json(found: Extraction) -> dict[str, object]:
    """Return an extraction with the keys of the command line's contract."""
    return {"modules": [_module_json(module) for module in found.modules]}


def _module_json(module: Module) -> dict[str, object]:
    return {
        "name": module.name,
        "path": module.span.path,
        "line": module.span.line,
        "class": list(module_classes(module)),
        "services": [_service_json(service) for service in module.services],
        "functions": [_function_json(function) for function in module.functions],
        "tags": [each.name for each in module.attributes if each.value is None],
        "properties": {
            each.name: plain(each.value) for each in module.attributes if each.value is not None
        },
    }


def _service_json(service: Service) -> dict[str, object]:
    return {
        "kind": service.kind,
        "line": service.span.line,
        "column": service.span.column,
        "function": service.function,
        "output": service.output,
        "inputs": list(service.inputs),
        "modes": [mode.text or mode.name for mode in service.modes],
        "hz": _json_number(service.hz),
        "port": service.port,
        "parameters": list(parameter_names(service)),
        **({} if service.window_ms is None else {"window_ms": service.window_ms}),
    }


def _function_json(function: Function) -> dict[str, object]:
    return {
        "function": function.name,
        "min": _json_number(function.min),
        "max": _json_number(function.max),
        "rate": _json_number(function.rate),
    }


def _json_number(value: Decimal | Fraction | None) -> int | float | None:
    if value is None:
        return None
    return int(value) if value == int(value) else float(value)


def module_lines(module: Module) -> Iterator[str]:
    """Yield the lines of text about a module in annotated sources."""
    classes = ", ".join(module_classes(module)) or "no class"
    yield f"{module.name} ({classes})  {module.span.path}:{module.span.line}"
    for service in module.services:
        words = [mode.text or mode.name for mode in service.modes] or list(service.commands)
        words = [] if service.kind == "Done" else words
        rate = "" if service.hz is None else f" {as_written(service.hz)}"
        annotation = f"{service.kind} {', '.join(words)}".rstrip() + rate
        inputs = ", ".join(name or "?" for name in service.inputs)
        output = "" if service.kind in ("DataIn", "Reset") else f" -> {service.output or '?'}"
        yield f"  {annotation}: {service.function}({inputs}){output}"
        if service.window_ms is not None:
            yield f"    Window {service.window_ms}"
    for function in module.functions:
        bounds = (function.min, function.max, function.rate)
        shown = " ".join("_" if value is None else str(_json_number(value)) for value in bounds)
        yield f"  {function.name} {shown}"
    for attribute in module.attributes:
        yield f"  {print_attribute(attribute).removeprefix('@')}"
