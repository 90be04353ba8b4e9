"""Execute a specification on the simulator and judge the run."""

import argparse
import json
import os.path
import sys
from collections import Counter
from collections.abc import Iterator, Mapping
from contextlib import nullcontext, redirect_stdout
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mars_asp.cli.arguments import positive
from mars_asp.cli.deliver import runs_code_of, write_file
from mars_asp.cli.encode import encoded
from mars_asp.cli.layout import columns, counted, wrapped
from mars_asp.cli.limits import load_freely
from mars_asp.cli.live import live_line, run_line
from mars_asp.cli.outputs import add_outputs, check_packages, recorded, write_outputs
from mars_asp.cli.pace import shown
from mars_asp.cli.perform import performed, read_changes, scenario_text, specified
from mars_asp.cli.reason import (
    add_file,
    check_inputs,
    packs_of,
    read_project,
)
from mars_asp.cli.report import report
from mars_asp.cli.schemas import add_schema
from mars_asp.cli.winners import in_turn
from mars_asp.diagnostic import Diagnostic
from mars_asp.output import visible

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table

    from mars_asp.execution.executor import Link
    from mars_asp.execution.executor.link import Failures
    from mars_asp.execution.judgement import Judgement
    from mars_asp.execution.scenario.read import Robot, Scenario
    from mars_asp.execution.simulator import Body
    from mars_asp.execution.trial import Trial

#: Who holds control where no controller does.
_NONE = "none"
#: A reason why a controller wins goes on below by this.
_BELOW_WINNER = " " * 6
#: How a requirement that holds, does not, or is not decided, is listed.
_WORDS = {True: "holds", False: "VIOLATED", None: "NOT DECIDED"}


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the verb."""
    add_file(parser)
    parser.add_argument("--scenario", metavar="S.toml", required=True, help="world and robot")
    parser.add_argument("--seed", type=int, help="instead of the scenario's")
    parser.add_argument("--duration", metavar="SECONDS", type=positive, help="simulated time")
    parser.add_argument(
        "--speed",
        metavar="FACTOR",
        type=positive,
        help="pace the run, 1 is real time, and show it in a page whose address is printed",
    )
    parser.add_argument(
        "--vary",
        metavar="KEY=VALUE",
        action="append",
        default=[],
        help="give a key of the scenario another value, as in `robot.radius=150`; "
        "`modules.NAME=off` has a module send nothing; repeatable",
    )
    parser.add_argument(
        "--explain", action="store_true", help="show why each requirement was violated"
    )
    parser.add_argument(
        "--why", action="store_true", help="list who won at each arbiter, when and why"
    )
    parser.add_argument(
        "--dry-run",
        action="store_true",
        help="list whose code would run and what is simulated; import and run nothing",
    )
    add_schema(parser, "scenarios", _scenario_schema)
    add_outputs(parser)


def _scenario_schema() -> str:
    from mars_asp.execution.scenario.schema import SCHEMA

    return f"{json.dumps(SCHEMA, indent=2)}\n"


def run(arguments: argparse.Namespace) -> int:
    """Run it; 1 where a requirement was violated, or the run ended too early to tell."""
    load_freely("mars_asp.execution.trial")
    from mars_asp.asp.trace.document import traces_json
    from mars_asp.execution.scenario.functions import bound_functions

    check_packages(arguments)
    check_inputs(*arguments.files, arguments.scenario)
    project = read_project(arguments)
    scenario = _scenario(arguments)
    if arguments.seed is not None:
        scenario = replace(scenario, seed=arguments.seed)
    if arguments.duration is not None:
        scenario = replace(scenario, duration=arguments.duration)
        report(_never_begun(scenario), arguments)
    found = specified(project, arguments)
    if found is None:
        return 1
    specification, modules = found
    named = [name.text for name in specification.modules]
    functions = dict(bound_functions(modules, scenario, named))
    if arguments.dry_run:
        return _print_plan(functions, scenario, arguments)
    # What modules print is no part of the result that programs read.
    aside = redirect_stdout(sys.stderr) if arguments.format == "json" else nullcontext()
    runs_code_of(dict.fromkeys(str(path) for path, _ in functions.values()))
    from mars_asp.execution.judgement import run_rulebook

    with shown(arguments, _title(scenario)) as page:
        with aside, recorded(arguments) as record, live_line(arguments, run_line) as line:

            def show(trial: "Trial") -> None:
                line(trial)
                if page:
                    page.show(trial)

            observe = record.observe if record else None
            rulebook = run_rulebook(packs_of(arguments))
            trial, judgement = performed(
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
        _print_run(trial, judgement, arguments)
        if arguments.why:
            _print_winners(trial)
        if arguments.explain:
            _explain(judgement)
    return int(judgement.verdict != "pass")


def _scenario(arguments: argparse.Namespace) -> "Scenario":
    from mars_asp.execution.scenario.read import read_scenario

    return read_scenario(*scenario_text(arguments), read_changes(arguments.vary))


def _never_begun(scenario: "Scenario") -> Iterator[Diagnostic]:
    """Yield a warning for each fault that a run that was cut short does not come to."""
    from mars_asp.execution.scenario.contradictions import late_faults

    for name, start in late_faults(scenario.faults, scenario.duration):
        message = f"the fault of `{name}` begins at {start:g} s, after the end of this run"
        place = scenario.places[f"faults.{name}"]
        yield Diagnostic("scenario", "warning", message, place, (), "lengthen `--duration`")


def _print_plan(
    functions: "Mapping[str, tuple[Path, str]]", scenario: "Scenario", arguments: argparse.Namespace
) -> int:
    """Print what a run would import and simulate; 2 where a file is missing."""
    imported: dict[str, dict[str, str]] = {}
    for name, (path, function) in functions.items():
        imported.setdefault(str(path), {})[name] = function
    missing = [file for file in imported if not Path(file).is_file()]
    for file in missing:
        print(
            f"mars-asp: `{visible(file)}`, which this run imports, is not a file", file=sys.stderr
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
        told = ", ".join(f"{name} ({kind})" for name, kind in devices.items())
        print("\n".join(wrapped(visible(told), width, "simulated: ", "  ")))
    print(f"{scenario.duration:g} s, seed {scenario.seed}; nothing was run")
    return 2 if missing else 0


def run_json(trial: "Trial", judgement: "Judgement") -> dict[str, object]:
    """Return a run with the keys of the command line's contract."""
    executor, times = trial.executor, trial.control_time
    return {
        "verdict": judgement.verdict,
        "requirements": [
            {"name": r.name, "holds": r.holds, "message": r.message} for r in judgement.requirements
        ],
        "seconds": trial.scenario.duration,
        "seed": trial.scenario.seed,
        "events": executor.schedule.events,
        "messages": sum(link.delivered for link in executor.links),
        "collisions": trial.collisions,
        "min_clearance_mm": _millimetres(trial.clearance),
        # A controller that was never in control has none, and is listed, too.
        "control_time": {
            name: round(times.get(name, 0.0), 6) for name in sorted({*times, *_speakers(trial)})
        },
        "driven_mm": round(sum(body.driven for body in trial.bodies), 3),
        "turn_while_driving_s": round(sum(body.both for body in trial.bodies), 6),
        "robots": [_robot_json(trial, *each) for each in trial.robots],
        "links": _links_json(trial),
        "control": [
            {"seconds": h.since / 1e9, "node": h.node, "holder": h.holder or None, "why": h.why}
            for arbiter in executor.arbiters.values()
            for h in arbiter.holdings
        ],
        "failures": [_failures_json(*each) for each in executor.failures.items()],
    }


def _millimetres(clearance: float) -> float | None:
    return round(clearance, 3) if clearance < float("inf") else None


def _robot_json(trial: "Trial", robot: "Robot", body: "Body") -> dict[str, object]:
    reached = None if robot.reach is None else trial.reached(robot)
    missing = None if robot.reach is None else trial.nearest(robot)[0]
    return {
        "name": robot.name,
        "module": robot.module,
        "collisions": [
            {"seconds": at, "with": other or None}
            for at, other in zip(body.contacts, body.struck, strict=True)
        ],
        "min_clearance_mm": _millimetres(body.clearance),
        "nearest": body.beside or None,
        "reached_s": None if reached is None else round(reached, 6),
        "nearest_to_place_mm": None if missing is None else round(missing, 3),
        "control_time": {
            name: round(seconds, 6)
            for name, seconds in sorted(trial.times_in_control(robot).items())
        },
        "driven_mm": round(body.driven, 3),
        "turn_while_driving_s": round(body.both, 6),
    }


def _write_report(trial: "Trial", judgement: "Judgement", arguments: argparse.Namespace) -> None:
    from mars_asp.cli.run_report import replay_seen_from, report_page
    from mars_asp.execution.recording.picture import plot_run

    replay = arguments.replay and replay_seen_from(arguments.report, arguments.replay)
    told, title = run_json(trial, judgement), _title(trial.scenario)
    page = report_page(told, plot_run(trial, judgement), title, replay)
    write_file(arguments.report, page)


def _title(scenario: "Scenario") -> str:
    return f"{Path(scenario.path).name}, seed {scenario.seed}"


def _links_json(trial: "Trial") -> list[dict[str, Any]]:
    from mars_asp.execution.promises import promises

    rates = {each.number: each.hz for each in promises(trial)}
    now = trial.executor.schedule.now
    return [
        _link_json(trial, link, rates.get(number, 1e9 * link.before(Fraction(now)) / now))
        for number, link in enumerate(trial.executor.links)
    ]


def _link_json(trial: "Trial", link: "Link", hz: float) -> dict[str, Any]:
    asked = trial.executor.plan.carried(link)[1] if link.kind == "data" else None
    return {
        "source": link.source,
        "client": link.client,
        "asked_hz": None if asked is None else float(asked),
        "got_hz": round(hz, 6),
        "oldest_ms": link.oldest / 1e6,
        "delivered": link.delivered,
        "dropped": dict(link.dropped),
        "stale": link.stale,
        "faulty": link.faulty,
        "fault": link.fault or None,
    }


def _failures_json(name: str, failures: "Failures") -> dict[str, object]:
    from mars_asp.execution.judgement import raised_at

    path, line = raised_at(failures)
    first = {"first": failures.first, "path": path, "line": line, "seconds": failures.at / 1e9}
    return {"name": name, "count": failures.count, **first, "inputs": list(failures.inputs)}


def _print_run(trial: "Trial", judgement: "Judgement", arguments: argparse.Namespace) -> None:
    from rich.console import Console

    colour = {"always": True, "never": False}.get(arguments.color)
    console = Console(emoji=False, highlight=False, force_terminal=colour, no_color=colour is False)
    # Where nobody reads, rich would end the program with a status of its own; `print` does not.
    with console.capture() as captured:
        _print_tables(trial, judgement, arguments, console)
    print(captured.get(), end="")


def _print_tables(
    trial: "Trial", judgement: "Judgement", arguments: argparse.Namespace, console: "Console"
) -> None:
    _say(console, "", _verdict(judgement))
    for table in (_links(trial), _controllers(trial)):
        if table.row_count and not arguments.quiet:
            console.print(table)
    for link in trial.executor.links:
        if link.faulty:
            fault = " ".join(f"{link.fault:.200}".splitlines())
            _say(console, f"failed   {link.source} -> {link.client}  ", f"first by {fault}")
    for requirement in judgement.requirements:
        word = _WORDS[requirement.holds]
        _say(console, f"{word:8} {requirement.name}  ", requirement.message)
    bodies, clearance = trial.bodies, trial.clearance
    # Where there is nothing to come near to, there is no clearance.
    clear = f"least clearance {clearance:.0f} mm, " if clearance < float("inf") else ""
    _say(
        console,
        f"{trial.scenario.duration:g} s, seed {trial.scenario.seed}: ",
        f"{counted(trial.collisions, 'collision')}, {clear}"
        f"{sum(body.driven for body in bodies):.0f} mm driven, "
        f"{sum(body.both for body in bodies):.2f} s turning while driving",
        "  ",
    )


def _say(console: "Console", head: str, text: str, further: str = " " * 9) -> None:
    """Print a sentence after its head, further lines indented."""
    from rich.text import Text

    for line in wrapped(visible(text), columns(sys.stdout), visible(head), further):
        console.print(Text(line.rstrip()), soft_wrap=True)


def _verdict(judgement: "Judgement") -> str:
    """Return the verdict, and which requirements were violated."""
    count = len(judgement.requirements)
    if judgement.verdict == "pass":
        return f"pass: all {count} requirements hold"
    state, told = (False, "violated") if judgement.verdict == "fail" else (None, "not decided")
    names = [each.name for each in judgement.requirements if each.holds is state]
    are = "is" if len(names) == 1 else "are"
    named = ", ".join(names)
    return f"{judgement.verdict}: {len(names)} of {count} requirements {are} {told}: {named}"


def _print_winners(trial: "Trial") -> None:
    """Print who held control at each arbiter, from when on and why."""
    from mars_asp.execution.executor.arbitration import FlatArbitration

    for name, arbiter in trial.executor.arbiters.items():
        print(f"\n{visible(name)}")
        if isinstance(arbiter, FlatArbitration):
            print(f"  flat: sends the mean of each {arbiter.period / 1e6:g} ms; no controller wins")
            continue
        rows = [(held.since / 1e9, held.holder or _NONE, held.why) for held in arbiter.holdings]
        longest = max((len(holder) for _, holder, _ in rows), default=0)
        for since, holder, why in in_turn(rows):
            head = visible(f"  {since:9.3f} s  {holder:{longest}}  ")
            print("\n".join(wrapped(visible(why), columns(sys.stdout), head, _BELOW_WINNER)))
        if not arbiter.holdings:
            print("  no command arrived")


def _explain(judgement: "Judgement") -> None:
    from mars_asp.asp.trace.text import traces_text
    from mars_asp.cli.lines import line_at

    topics = [(c.kind, trace) for c, trace in judgement.traces()]
    for line in traces_text(topics, line_at, width=columns(sys.stdout)):
        print(visible(line) if line.startswith(" ") else f"\n{visible(line)}")


def _links(trial: "Trial") -> "Table":
    rows = (
        (
            f"{link['source']} -> {link['client']}",
            "" if link["asked_hz"] is None else f"{link['asked_hz']:g}",
            f"{link['got_hz']:.2f}",
            f"{link['oldest_ms']:g}",
            ", ".join(f"{count} {why}" for why, count in sorted(link["dropped"].items())),
        )
        for link in _links_json(trial)
    )
    return _table(("link", "asked Hz", "got Hz", "oldest ms", "dropped"), rows)


def _controllers(trial: "Trial") -> "Table":
    # One that never said anything has a row, too.
    suppressed = Counter(dict.fromkeys(_speakers(trial), 0))
    for arbiter in trial.executor.arbiters.values():
        suppressed.update(_suppressed(arbiter))
    times, duration = trial.control_time, trial.scenario.duration
    rows = (
        (name, f"{100 * times.get(name, 0.0) / duration:.1f} %", str(suppressed[name]))
        for name in sorted({*times, *suppressed})
    )
    return _table(("controller", "in control", "suppressed"), rows)


def _speakers(trial: "Trial") -> Iterator[str]:
    """Yield the modules that send commands and are not arbiters, once for each link."""
    links, plan = trial.executor.links, trial.executor.plan
    return (link.source for link in links if plan.kind(link.source) == "control_out")


def _table(heads: tuple[str, ...], rows: Any) -> "Table":
    from rich.table import Table
    from rich.text import Text

    table = Table(box=None, pad_edge=False)
    for number, head in enumerate(heads):
        table.add_column(head, justify="right" if 0 < number < 4 else "left")
    for row in rows:
        table.add_row(*(Text(visible(cell)) for cell in row))
    return table


def _suppressed(arbiter: object) -> Mapping[str, int]:
    from mars_asp.execution.executor.arbitration import HierarchicalArbitration

    return arbiter.suppressed if isinstance(arbiter, HierarchicalArbitration) else {}
