"""The common steps of `run` and `campaign`: read the input, find a specification, run a trial."""

import argparse
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from mars_asp.cli.diagnostic_text import report, report_unrealisable
from mars_asp.cli.inputs import (
    STANDARD_INPUT,
    analyse_project,
    read_input,
    rulebook_for,
)
from mars_asp.cli.realtime import run_realtime
from mars_asp.reading import SHOWN_INPUT

if TYPE_CHECKING:
    from mars_asp.asp.rules.rulebook import Rulebook
    from mars_asp.execution.executor.link import Observer
    from mars_asp.execution.judgement import Judgement
    from mars_asp.execution.scenario.read import Scenario
    from mars_asp.execution.scenario.vary import Changes
    from mars_asp.execution.trial import Trial
    from mars_asp.model.declarations import Configuration, Module
    from mars_asp.reasoning.project import Project


def scenario_text(arguments: argparse.Namespace) -> "tuple[str, Path]":
    """Return the text of the scenario, and its path in locations.

    Raises:
        MarsError: the scenario cannot be read.
    """
    from mars_asp.language.parse import decode, read_bytes

    if arguments.scenario == STANDARD_INPUT:
        return read_input(SHOWN_INPUT), Path(SHOWN_INPUT)
    path = Path(arguments.scenario)
    return decode(read_bytes(path), str(path)), path


def read_changes(texts: Iterable[str]) -> "Changes":
    """Return the value of each key in the arguments of `--vary`.

    Raises:
        MarsError: an argument is malformed, or has several values for a key.
    """
    from mars_asp.execution.scenario.vary import read_axes

    return {axis.key: axis.only for axis in read_axes(texts)}


def specified(
    project: "Project", arguments: argparse.Namespace
) -> "tuple[Configuration, Mapping[str, Module]] | None":
    """Return the specification to run and its modules, or None, with a message, without one."""
    specification = _specification(project, arguments)
    return None if specification is None else runnable(specification, project, arguments)


def runnable(
    specification: "Configuration", project: "Project", arguments: argparse.Namespace
) -> "tuple[Configuration, Mapping[str, Module]]":
    """Return the specification with all inputs and modes stated, and the modules by name.

    Raises:
        MarsError: rule packs are wrong.
    """
    from mars_asp.model.described import described_modules
    from mars_asp.reasoning.synthesis.carried_modes import state_modes
    from mars_asp.reasoning.synthesis.line_inputs import state_inputs

    # A specification that was synthesised does not repeat the blocks of its configuration.
    modules = described_modules(project.configuration, project.modules)
    rulebook = rulebook_for(arguments)
    named = state_inputs(specification, modules, rulebook)
    return state_modes(named, modules, rulebook), modules


def _specification(project: "Project", arguments: argparse.Namespace) -> "Configuration | None":
    """Return the specification in the file or a minimal one; None, with a message, without one."""
    if project.configuration.kind == "specification":
        return project.configuration
    from mars_asp.cli.selection import Selection
    from mars_asp.reasoning.analysis import diagnostic
    from mars_asp.reasoning.budget import Budget
    from mars_asp.reasoning.synthesis.synthesise import synthesise

    rulebook = rulebook_for(arguments)
    analysis = analyse_project(project, rulebook, arguments)
    options = dict.fromkeys(("select", "ignore", "baseline", "write_baseline"))
    selection = Selection(argparse.Namespace(**vars(arguments) | options), rulebook)
    report(map(diagnostic, selection.of(project, analysis, notes=False).shown), arguments)
    found = synthesise(project, analysis, rulebook, Budget(arguments.time_limit))
    if found is None:
        report_unrealisable(project.configuration.path, analysis, arguments)
        return None
    return found.specification.configuration


def run_trial(
    specification: "Configuration",
    modules: "Mapping[str, Module]",
    scenario: "Scenario",
    observe: "Observer | None" = None,
    show: "Callable[[Trial], None]" = lambda trial: None,
    rulebook: "Rulebook | None" = None,
    speed: float | None = None,
) -> "tuple[Trial, Judgement]":
    """Return a finished run and its judgement.

    `observe` receives its events, and `show` is called with each stage. `speed` limits the run to
    so many times real time. `rulebook` judges it; None is the built-in rules.

    Raises:
        MarsError: modules are unbound or unusable; has all errors.
    """
    from mars_asp.execution.judgement import judge
    from mars_asp.execution.trial import stage_trial

    trial = stage_trial(specification, modules, scenario, observe)
    for _ in run_realtime(trial, speed):
        show(trial)
    trial.executor.finish()
    return trial, judge(trial, rulebook)
