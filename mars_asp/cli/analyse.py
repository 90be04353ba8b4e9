"""Print the consequences of a configuration."""

import argparse
import sys
from collections import Counter
from collections.abc import Iterator
from dataclasses import replace

from mars_asp.cli.diagnostic_text import colours, finding_lines, paint, report
from mars_asp.cli.encode import print_result
from mars_asp.cli.finding_formats import FINDING_FORMATS, is_published, publish, published
from mars_asp.cli.inputs import (
    JUDGING,
    add_file,
    add_stdin_filename,
    judge_project,
    read_project,
    rulebook_for,
    unapplied_packs,
)
from mars_asp.cli.lines import location_json, rule_location_json
from mars_asp.cli.results import Result, results_of
from mars_asp.cli.selection import Selected, Selection, add_selection, hidden_text
from mars_asp.cli.suggested_commands import command
from mars_asp.cli.wrapping import columns, wrapped
from mars_asp.output import counted, visible
from mars_asp.reasoning.analysis import Analysis, Consequence, diagnostic
from mars_asp.reasoning.findings import SEVERITIES
from mars_asp.reasoning.project import Project, has_mounts

#: The formats of the result.
RESULT_FORMATS = FINDING_FORMATS


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    add_file(parser)
    add_stdin_filename(parser)
    add_selection(parser)


@published
def run(arguments: argparse.Namespace) -> int:
    """Print the consequences; return 1 if an error is reported."""
    project = read_project(arguments, quietly=True)
    rulebook = rulebook_for(arguments, JUDGING if project.trees else ("resolve",))
    selection = Selection(arguments, rulebook)
    messages, _ = selection.messages(project, unapplied_packs(project, rulebook))
    if not is_published(arguments):
        report(messages, arguments)
    analysis = judge_project(project, rulebook, arguments)
    selected = selection.of(project, analysis)
    remarks = (*selected.remarks, *selection.end())
    status = int(selected.has_errors)
    if is_published(arguments):
        entries = (*messages, *remarks[len(selected.remarks) :])
        return publish([*results_of(selected), *map(Result, entries)], arguments, status)
    report(remarks, arguments)
    lines = analysis_lines(project, analysis, selected, arguments)
    print_result(arguments, lambda: analysis_json(project, analysis, selected), lines)
    return status


def analysis_lines(
    project: Project, analysis: Analysis, selected: Selected, arguments: argparse.Namespace
) -> Iterator[str]:
    """Yield the lines of the text of an analysis; with `--quiet` only the findings."""
    coloured, width = colours(arguments, sys.stdout), columns(sys.stdout)
    has_summary = not (arguments.quiet or arguments.write_baseline)
    yield from _analysis_text(analysis, selected, coloured, width, has_summary)
    if has_summary:
        yield from _closing(project, analysis, selected, arguments, width)


def analysis_json(project: Project, analysis: Analysis, selected: Selected) -> dict[str, object]:
    """Return the reported (`selected`) consequences as JSON of the command's contract."""
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
        "consequences": [consequence_json(consequence) for consequence in selected.shown],
        "hidden": [
            {**consequence_json(each.consequence), "by": each.by, "reason": each.reason}
            for each in selected.hidden
        ],
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
    return {
        "kind": consequence.kind,
        "subject": consequence.subject,
        "participants": list(consequence.participants),
        "severity": consequence.severity,
        "message": consequence.message,
        "help": consequence.help,
        "effect": consequence.effect,
        "locations": [location_json(span) for span in consequence.spans],
        "rule": rule_location_json(consequence.rule),
        "launch_files": list(consequence.trees),
        "conditions": [
            {
                "variable": each.variable,
                "value": each.value,
                "how": each.how,
                "location": None if each.span is None else location_json(each.span),
            }
            for each in consequence.conditions
        ],
    }


def _analysis_text(
    analysis: Analysis, selected: Selected, coloured: bool, width: int, has_summary: bool
) -> Iterator[str]:
    for consequence in selected.shown:
        found = diagnostic(consequence)
        if found.severity == "note":
            # Nothing is wrong, so the message suffices.
            found = replace(found, labels=(), help=None, effect=None, excerpt="")
        kind = paint(visible(consequence.kind), consequence.severity, coloured)
        yield from finding_lines(found, f"{kind}: {visible(found.message)}", coloured, width)
    if not has_summary:
        return
    count = Counter(consequence.severity for consequence in selected.shown)
    parts = ", ".join(counted(count[of], of) for of in reversed(SEVERITIES) if count[of])
    total = counted(count.total(), "consequence")
    if count or not analysis.consequences:
        yield f"{total}: {parts}" if count else "nothing to resolve"
    elif not selected.hidden:
        yield "nothing to report"
    if selected.hidden:
        yield hidden_text(Counter(each.by for each in selected.hidden))


def _closing(
    project: Project,
    analysis: Analysis,
    selected: Selected,
    arguments: argparse.Namespace,
    width: int,
) -> Iterator[str]:
    """Yield the command that suggests repairs, if errors are shown, and the unannotated modules."""
    if selected.has_errors:
        # A command is not broken.
        yield f"For edits that remove the errors: {command('explain', arguments, '--repair')}"
    if analysis.unchecked:
        names = ", ".join(f"`{name}`" for name in analysis.unchecked)
        lacking = f"no annotations found for {names}"
        if project.format == "dora":
            lacking = f"other files list the outputs of {names}"
        yield from wrapped(visible(f"{lacking}, so these were not checked"), width, further="  ")
