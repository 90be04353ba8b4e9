"""Execute a specification on the simulator and judge the run."""

import argparse
import json
import os.path
import sys
from collections.abc import Iterator, Mapping
from contextlib import nullcontext, redirect_stdout
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from mars_asp.cli.arguments import add_flags, positive
from mars_asp.cli.deliver import runs_code_of, write_file
from mars_asp.cli.diagnostic_text import report
from mars_asp.cli.encode import encoded
from mars_asp.cli.inputs import (
    add_file,
    check_inputs,
    packs_of,
    read_project,
)
from mars_asp.cli.limits import load_freely
from mars_asp.cli.output_files import add_outputs, check_packages, recorded, write_outputs
from mars_asp.cli.progress import live_line
from mars_asp.cli.realtime import live_view
from mars_asp.cli.run_json import run_json
from mars_asp.cli.run_text import print_reasons, print_traces, print_winners, run_line, run_text
from mars_asp.cli.schemas import add_schema
from mars_asp.cli.trials import read_changes, run_trial, scenario_text, specified
from mars_asp.cli.wrapping import columns, wrapped
from mars_asp.diagnostic import Diagnostic
from mars_asp.output import visible

if TYPE_CHECKING:
    from mars_asp.execution.judgement import Judgement
    from mars_asp.execution.scenario.read import Scenario
    from mars_asp.execution.trial import Trial
    from mars_asp.model.declarations import Configuration, Module


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    add_file(parser)
    parser.add_argument("--scenario", metavar="S.toml", required=True)
    parser.add_argument("--seed", type=int)
    parser.add_argument("--duration", metavar="SECONDS", type=positive)
    parser.add_argument("--speed", metavar="FACTOR", type=positive)
    parser.add_argument("--vary", metavar="KEY=VALUE", action="append", default=[])
    add_flags(parser, "--explain", "--why", "--why-not", "--dry-run")
    add_schema(parser, "scenarios", _scenario_schema)
    add_outputs(parser)


def _scenario_schema() -> str:
    from mars_asp.execution.scenario.schema import SCHEMA

    return f"{json.dumps(SCHEMA, indent=2)}\n"


def run(arguments: argparse.Namespace) -> int:
    """Run a specification; return 1 if the run did not pass or no specification exists."""
    load_freely("mars_asp.execution.trial")
    from mars_asp.asp.trace.document import traces_json
    from mars_asp.execution.scenario.functions import bind_kinds

    check_packages(arguments)
    check_inputs(*arguments.files, arguments.scenario)
    project = read_project(arguments)
    scenario = read_run_scenario(arguments)
    if arguments.duration is not None:
        report(_never_begun(scenario), arguments)
    found = specified(project, arguments)
    if found is None:
        return 1
    specification, modules = found
    scenario = bind_kinds(scenario, specification)
    functions = _bound_functions(specification, modules, scenario)
    if arguments.dry_run:
        is_possible = _fits(specification, modules, scenario, functions, arguments)
        # Devices of other specifications are warnings, and not simulated.
        names = {name.text for name in specification.modules}
        used = {name: each for name, each in scenario.devices.items() if name in names}
        planned = replace(scenario, devices=used)
        return max(_print_plan(functions, planned, arguments), 0 if is_possible else 2)
    # For programs, the result must not contain the output of modules.
    aside = redirect_stdout(sys.stderr) if arguments.format == "json" else nullcontext()
    runs_code_of(dict.fromkeys(str(path) for path, _ in functions.values()))
    from mars_asp.execution.judgement import run_rulebook

    with live_view(arguments, _title(scenario)) as page:
        recording = recorded(arguments, specification, modules)
        with aside, recording as record, live_line(arguments, run_line) as line:

            def show(trial: "Trial") -> None:
                line(trial)
                if page:
                    page.show(trial)

            observe = record.observe if record else None
            rulebook = run_rulebook(packs_of(arguments))
            trial, judgement = run_trial(
                specification, modules, scenario, observe, show, rulebook, arguments.speed
            )
            if record:
                record.end(trial)
        if page:
            page.show(trial, judgement)
    report(trial.remarks, arguments)
    write_outputs(trial, judgement, arguments)
    if arguments.report:
        _write_report(trial, judgement, arguments)
    if arguments.format == "json":
        result = run_json(trial, judgement)
        if arguments.explain:
            result["traces"] = traces_json(trace for _, trace in judgement.traces())
        print(encoded(result))
    else:
        print(run_text(trial, judgement, arguments), end="")
        _print_explanations(trial, judgement, arguments)
    return int(judgement.verdict != "pass")


def _print_explanations(
    trial: "Trial", judgement: "Judgement", arguments: argparse.Namespace
) -> None:
    if arguments.why:
        print_winners(trial)
        print_reasons(trial, losses=False)
    if arguments.why_not:
        print_reasons(trial, losses=True)
    if arguments.explain:
        print_traces(judgement)


def _bound_functions(
    specification: "Configuration", modules: "Mapping[str, Module]", scenario: "Scenario"
) -> "dict[str, tuple[Path, str]]":
    """Return the Python file and function that each module, or each of its outputs, runs."""
    from mars_asp.execution.parts import in_parts
    from mars_asp.execution.scenario.functions import bound_functions

    parts, described = in_parts(specification, modules)
    return dict(bound_functions(described, scenario, (name.text for name in parts.modules)))


def _fits(
    specification: "Configuration",
    modules: "Mapping[str, Module]",
    scenario: "Scenario",
    functions: "Mapping[str, tuple[Path, str]]",
    arguments: argparse.Namespace,
) -> bool:
    """Print what keeps the specification from running in the scenario; return whether it can."""
    from mars_asp.execution.executor.executor import incomplete
    from mars_asp.execution.executor.plan import Plan
    from mars_asp.execution.parts import in_parts
    from mars_asp.execution.scenario.agreement import disagreements

    plan = Plan(*in_parts(specification, modules), {})
    robots = {robot.module for robot in scenario.robots}
    run = functions.keys() | scenario.devices.keys() | robots
    found = [*disagreements(plan, scenario), *incomplete(plan, run)]
    report(found, arguments)
    return all(each.severity != "error" for each in found)


def read_run_scenario(arguments: argparse.Namespace) -> "Scenario":
    """Return the scenario with the values of the options.

    Raises:
        MarsError: the scenario cannot be read, or is wrong.
    """
    from mars_asp.execution.scenario.read import read_scenario

    scenario = read_scenario(*scenario_text(arguments), read_changes(arguments.vary))
    given = {"seed": arguments.seed, "duration": arguments.duration}
    return replace(scenario, **{key: value for key, value in given.items() if value is not None})


def _never_begun(scenario: "Scenario") -> Iterator[Diagnostic]:
    """Yield a warning for each fault in a scenario that begins after its end."""
    from mars_asp.execution.scenario.contradictions import late_faults

    late = [
        (f"faults.{name}", name, start)
        for name, start in late_faults(scenario.faults, scenario.duration)
    ]
    late += (
        (f"links.{number}.from", "{from} -> {to}".format(**entry), entry["since"])
        for number, entry in enumerate(scenario.links)
        if entry.get("since", 0) >= scenario.duration
    )
    for key, name, start in late:
        message = f"the fault of `{name}` begins at {start:g} s, after the end of this run"
        place = scenario.places[key]
        yield Diagnostic("scenario", "warning", message, place, (), "lengthen `--duration`")


def _print_plan(
    functions: "Mapping[str, tuple[Path, str]]", scenario: "Scenario", arguments: argparse.Namespace
) -> int:
    """Print the Python imports and simulated devices; return 2 if a file is missing."""
    imported: dict[str, dict[str, str]] = {}
    for name, (path, function) in functions.items():
        imported.setdefault(str(path), {})[name] = function
    missing = [file for file in imported if not Path(file).is_file()]
    for file in missing:
        print(
            f"mars-asp: error: `{visible(file)}`, which this run imports, is not a file",
            file=sys.stderr,
        )
    devices = {name: str(device["kind"]) for name, device in scenario.devices.items()}
    if arguments.format == "json":
        imports = [{"path": file, "functions": named} for file, named in imported.items()]
        plan = {"imports": imports, "devices": devices}
        print(encoded({**plan, "seconds": scenario.duration, "seed": scenario.seed}))
        return 2 if missing else 0
    width = columns(sys.stdout)
    print("imported, with whatever these files import:" if imported else "no code is imported")
    for file, named in imported.items():
        uses = ", ".join(f"{name} by `{function}`" for name, function in named.items())
        head = visible(f"  {os.path.normpath(file)}: ")
        print("\n".join(wrapped(visible(uses), width, head, "    ")))
    if devices:
        text = ", ".join(f"{name} ({kind})" for name, kind in devices.items())
        print("\n".join(wrapped(visible(text), width, "simulated: ", "  ")))
    print(f"{scenario.duration:g} s, seed {scenario.seed}; nothing was run")
    return 2 if missing else 0


def _write_report(trial: "Trial", judgement: "Judgement", arguments: argparse.Namespace) -> None:
    from mars_asp.cli.run_report import replay_seen_from, report_page
    from mars_asp.execution.judgement import reasons_of
    from mars_asp.execution.recording.picture import plot_run

    replay = arguments.replay and replay_seen_from(arguments.report, arguments.replay)
    result, title = run_json(trial, judgement), _title(trial.scenario)
    found = reasons_of(trial, losses=False)
    reasons = [(each.message, f"{span.path}:{span.line}") for each, span in found]
    page = report_page(result, plot_run(trial, judgement), title, replay, reasons)
    write_file(arguments.report, page)


def _title(scenario: "Scenario") -> str:
    return f"{Path(scenario.path).name}, seed {scenario.seed}"
