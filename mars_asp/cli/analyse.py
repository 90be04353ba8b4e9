"""Print the consequences of a configuration."""

import argparse
import sys
from collections.abc import Iterator

from mars_asp.cli.encode import encoded
from mars_asp.cli.reason import (
    add_file,
    analyse_project,
    read_project,
    rulebook_for,
)
from mars_asp.cli.report import colours, paint
from mars_asp.diagnostic import Span
from mars_asp.output import visible
from mars_asp.reasoning.analysis import Analysis, Consequence
from mars_asp.reasoning.project import Project, has_mounts


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the verb."""
    add_file(parser)


def run(arguments: argparse.Namespace) -> int:
    """Print the consequences; 1 where one is an error."""
    project = read_project(arguments)
    analysis = analyse_project(project, rulebook_for(arguments), arguments)
    if arguments.format == "json":
        print(encoded(analysis_json(project, analysis)))
    else:
        for line in _text(analysis, colours(arguments, sys.stdout), arguments.quiet):
            print(line)
    return int(analysis.has_errors)


def analysis_json(project: Project, analysis: Analysis) -> dict[str, object]:
    """Return an analysis with the keys of the command line's contract."""
    configuration = project.configuration
    return {
        "configuration": {
            "path": configuration.path,
            "kind": configuration.kind,
            "architecture": configuration.architecture,
            "modules": [name.text for name in configuration.modules],
            "relationships": len(configuration.relationships),
        },
        "frames": frames_json(project),
        "consequences": [consequence_json(consequence) for consequence in analysis.consequences],
        "unchecked": list(analysis.unchecked),
    }


def frames_json(project: Project) -> dict[str, object]:
    """Return the frames of mounted modules with the keys of the contract."""
    if not has_mounts(project):
        return {}
    from mars_asp.reasoning.facts.motion import frames

    found = frames(project.configuration, project.modules)
    return {
        name: {"root": root, "matrix": matrix.tolist()} for name, (root, matrix) in found.items()
    }


def consequence_json(consequence: Consequence) -> dict[str, object]:
    """Return one consequence with the keys of the contract."""
    rule = consequence.rule
    return {
        "kind": consequence.kind,
        "subject": consequence.subject,
        "participants": list(consequence.participants),
        "severity": consequence.severity,
        "message": consequence.message,
        "help": consequence.help,
        "locations": [location_json(span) for span in consequence.spans],
        "rule": {"id": rule.id, "path": rule.span.path, "line": rule.span.line},
    }


def location_json(span: Span) -> dict[str, object]:
    """Return where a span begins."""
    return {"path": span.path, "line": span.line, "column": span.column}


def _text(analysis: Analysis, coloured: bool, quiet: bool) -> Iterator[str]:
    for consequence in analysis.consequences:
        span = consequence.spans[0]
        kind = paint(consequence.kind, consequence.severity, coloured)
        place = visible(f"{span.path}:{span.line}:{span.column}")
        yield f"{place}: {kind}: {visible(consequence.message)}"
        if consequence.severity != "note" and consequence.help:
            yield f"    help: {visible(consequence.help)}"
    if quiet:
        return
    count = len(analysis.consequences)
    yield "nothing to resolve" if not count else f"{count} consequence{'s' * (count > 1)}"
    if analysis.has_errors:
        yield "`mars-asp explain FILE --repair` looks for edits that remove the errors"
    if analysis.unchecked:
        names = ", ".join(f"`{name}`" for name in analysis.unchecked)
        yield visible(f"not checked, for nothing describes them: {names}")
