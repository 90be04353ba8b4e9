"""Print the minimal specification that resolves a configuration."""

import argparse
import json
import sys
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.cli.arguments import add_output
from mars_asp.cli.deliver import write_result
from mars_asp.cli.diagnostic_text import report, report_unrealisable
from mars_asp.cli.inputs import (
    JUDGING,
    add_file,
    analyse_project,
    judge_project,
    read_project,
    rulebook_for,
)
from mars_asp.cli.limits import seconds_to_search
from mars_asp.cli.progress import progress_bar, stage
from mars_asp.cli.selection import Selection, add_selection
from mars_asp.diagnostic import Diagnostic, MarsError, whole_file
from mars_asp.language import print_configuration
from mars_asp.language.relocate import sources_seen_from
from mars_asp.model.declarations import (
    Configuration,
    Control,
    Conversion,
    Data,
    Gating,
    Limit,
    Lock,
    Mount,
    Relationship,
    Reset,
    Strategy,
)
from mars_asp.model.described import module_classes
from mars_asp.model.rates import as_number
from mars_asp.reasoning.analysis import Analysis, diagnostic
from mars_asp.reasoning.budget import Budget
from mars_asp.reasoning.project import Project
from mars_asp.reasoning.rules import NODES, by_name
from mars_asp.reasoning.synthesis.synthesise import Synthesis, synthesise
from mars_asp.reasoning.verification import Violation, verify


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    add_file(parser)
    add_output(parser)
    add_selection(parser, writes=False)


def run(arguments: argparse.Namespace) -> int:
    """Print the specification; return 1 if an error is reported, 3 if a better one may exist."""
    project = read_project(arguments)
    rulebook = rulebook_for(arguments, ("resolve", "verify"))
    analysis = analyse_project(project, rulebook, arguments)
    if project.trees:
        # Launch trees have the findings of `check`.
        judging = rulebook_for(arguments, JUDGING)
        selection = Selection(arguments, judging)
        findings = judge_project(project, judging, arguments)
    else:
        selection = Selection(arguments, rulebook)
        findings = analysis
    selected = selection.of(project, findings, notes=False)
    report(map(diagnostic, selected.shown), arguments)
    report((*selected.remarks, *selection.end()), arguments)
    found = minimal_specification(project, analysis, rulebook, arguments)
    if found is None:
        report_unrealisable(project.configuration.path, analysis, arguments)
        return 1
    printed = found.specification.configuration
    unmet = (
        Diagnostic(
            each.rule.id,
            "note",
            f"{each.message}: {each.weight} at level {each.level}",
            each.rule.span,
        )
        for each in found.preferences
    )
    report(unmet, arguments)
    if arguments.format == "json":
        text = json.dumps(synthesis_json(project, found)) + "\n"
    else:
        text = specification_text(printed, project, arguments)
    write_result(arguments.output, text)
    if selected.has_errors and arguments.output != "-":
        message = "written, though the configuration has errors"
        report([Diagnostic("errors", "note", message, whole_file(arguments.output))], arguments)
    if not found.resolution.proven:
        print(
            f"mars-asp: best found, {found.cost(NODES)} nodes; lower bound {found.bound(NODES)}",
            file=sys.stderr,
        )
        return 3
    return int(selected.has_errors)


def minimal_specification(
    project: Project, analysis: Analysis, rulebook: Rulebook, arguments: argparse.Namespace
) -> Synthesis | None:
    """Return the minimal specification, verified, or None if nothing realises the configuration.

    `rulebook` holds the stages `resolve` and `verify`.

    Raises:
        MarsError: clingo refuses rules, or rules in `verify` refuse the specification.
        TimeoutError: no specification was found in time.
    """
    with (
        stage(arguments, "looking for nodes"),
        progress_bar(arguments, "components") as progress,
    ):
        budget = Budget(seconds_to_search(arguments), progress)
        found = synthesise(project, analysis, rulebook, budget)
    if found is None:
        return None
    with stage(arguments, "verifying"):
        printed = found.specification.configuration
        violations = verify(printed, project, rulebook, analysis.grounding)
    if violations:
        raise MarsError((_refused_specification(violations[0], rulebook),))
    return found


def _refused_specification(violation: Violation, rulebook: Rulebook) -> Diagnostic:
    """Return the error that a rule of `verify` refuses the specification."""
    if violation.rule not in rulebook.of_packs:
        message = f"internal error, please report it: {violation.message}"
        return Diagnostic(violation.rule.id, "error", message, violation.rule.span)
    message = f"the rule refuses the specification that was found: {violation.message}"
    advice = "let the rules of packs in `resolve` give what their rules in `verify` ask for"
    return Diagnostic(violation.rule.id, "error", message, violation.rule.span, help=advice)


def specification_text(
    printed: Configuration, project: Project, arguments: argparse.Namespace
) -> str:
    """Return a specification with the sources and blocks of its project.

    Raises:
        MarsError: a path to a source cannot be written.
    """
    folder = Path() if arguments.output == "-" else Path(arguments.output).parent
    sources = sources_seen_from(folder, project.configuration, arguments.sources)
    text = print_configuration(replace(printed, sources=sources))
    return "".join((text, *(f"\n{block}\n" for block in project.blocks)))


def synthesis_json(project: Project, found: Synthesis) -> dict[str, object]:
    """Return a synthesis with the keys of the command line's contract."""
    printed = found.specification.configuration
    relationships = printed.relationships
    return {
        "architecture": printed.architecture,
        "period_ms": printed.period_ms,
        "modules": _modules_json(project, found),
        "data": [_data_json(r) for r in relationships if isinstance(r, Data)],
        "control": [_control_json(r) for r in relationships if isinstance(r, Control)],
        "mounts": [_mount_json(r) for r in relationships if isinstance(r, Mount)],
        **_side_lines_json(relationships),
        "cost": by_name(found.resolution.cost),
        "proven_minimal": found.resolution.proven,
        "optimal_count": found.resolution.count,
        "preferences": [
            {
                "level": each.level,
                "weight": each.weight,
                "message": each.message,
                "rule": each.rule.id,
            }
            for each in found.preferences
        ],
        "resolves": {name: list(kinds) for name, kinds in found.specification.resolves.items()},
        **({} if found.resolution.proven else {"lower_bound": {"nodes": found.bound(NODES)}}),
    }


def _modules_json(project: Project, found: Synthesis) -> list[dict[str, object]]:
    from mars_asp.exchange.lift import realised_by

    configuration = project.configuration
    described = configuration.with_declared(project.modules)
    entries = {conversion.transformer: conversion for conversion in configuration.conversions}
    stands_for = {each.node: each.module for each in found.specification.configuration.stand_ins}
    muxes = realised_by(found.specification.configuration)
    listed: list[dict[str, object]] = []
    for name in (name.text for name in configuration.modules):
        kind = configuration.node_kind(name) if configuration.kind == "specification" else None
        if not kind and name in described:
            kind = next(module_classes(described[name]), None)
        listed.append(
            {
                "name": name,
                "kind": kind,
                "origin": "declared",
                **_conversion_json(entries.get(name)),
                **({"stands_for": stands_for[name]} if name in stands_for else {}),
                **({"realised_by": muxes[name]} if name in muxes else {}),
            }
        )
    listed.extend(
        {
            "name": node.name,
            "kind": node.kind,
            "origin": "introduced",
            **_conversion_json(node.conversion),
            **({} if node.stands_for is None else {"stands_for": node.stands_for}),
            **({"realised_by": muxes[node.name]} if node.name in muxes else {}),
        }
        for node in found.specification.nodes
    )
    return listed


def _conversion_json(conversion: Conversion | None) -> dict[str, object]:
    if conversion is None:
        return {}
    return {
        "converter": conversion.converter,
        "from": conversion.source,
        "to": conversion.target,
    }


def _side_lines_json(relationships: Iterable[Relationship]) -> dict[str, list[object]]:
    """Return the side lines by their kinds, or nothing if there are none of any kind."""
    found: dict[str, list[object]] = {
        kind: [] for kind in ("gates", "locks", "limits", "resets", "strategies")
    }
    for line in relationships:
        match line:
            case Gating(node, source, _, kind, ms, _, port):
                entry = {"node": node, "source": source, "source_port": port}
                found["gates"].append({**entry, "kind": kind, "ms": ms})
            case Lock(controlled, source, _, priority, hold, port):
                entry = {"controlled": controlled, "source": source, "source_port": port}
                found["locks"].append({**entry, "priority": priority, "hold_ms": hold})
            case Limit(controlled, source, _, hold, port):
                entry = {"controlled": controlled, "source": source, "source_port": port}
                found["limits"].append({**entry, "hold_ms": hold})
            case Reset(module, source, _, port):
                entry = {"module": module, "source": source, "source_port": port}
                found["resets"].append(entry)
            case Strategy(node, _, strategy, period):
                found["strategies"].append(
                    {"node": node, "strategy": strategy, "period_ms": period}
                )
    return found if any(found.values()) else {}


def _data_json(data: Data) -> dict[str, object]:
    mode = None if data.mode is None else data.mode.text or data.mode.name
    return {
        "client": data.client,
        "client_port": data.client_port,
        "source": data.source,
        "source_port": data.source_port,
        "mode": mode,
        "hz": None if data.hz is None else as_number(data.hz),
    }


def _control_json(control: Control) -> dict[str, object]:
    entry: dict[str, object] = {
        "controlled": control.controlled,
        "controller": control.controller,
        "priority": control.priority,
        "hold_ms": control.hold_ms,
    }
    return entry if control.allocation is None else {**entry, "allocation": control.allocation}


def _mount_json(mount: Mount) -> dict[str, object]:
    return {
        "mounting": mount.mounting,
        "mounting_vertex": mount.mounting_vertex,
        "mounted": mount.mounted,
        "mounted_vertex": mount.mounted_vertex,
        "transformation": mount.transformation.text if mount.transformation else None,
    }
