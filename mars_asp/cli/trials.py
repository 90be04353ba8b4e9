"""What `run` and `campaign` have in common: what is run in which scenario, and one run of it."""

import argparse
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from mars_asp.cli.diagnostic_text import report, report_unrealisable
from mars_asp.cli.inputs import (
    SHOWN_INPUT,
    STANDARD_INPUT,
    analyse_project,
    read_input,
    rulebook_for,
)
from mars_asp.cli.realtime import run_realtime

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
    """Return the text of the scenario, and the path that it has in places.

    Raises:
        MarsError: it cannot be read.
    """
    from mars_asp.language.parse import decode, read_bytes

    if arguments.scenario == STANDARD_INPUT:
        return read_input(SHOWN_INPUT), Path(SHOWN_INPUT)
    path = Path(arguments.scenario)
    return decode(read_bytes(path), str(path)), path


def read_changes(stated: Iterable[str]) -> "Changes":
    """Return what `--vary` states, which is one value of each key.

    Raises:
        MarsError: it states something else.
    """
    from mars_asp.execution.scenario.vary import read_axes

    return {axis.key: axis.only for axis in read_axes(stated)}


def specified(
    project: "Project", arguments: argparse.Namespace
) -> "tuple[Configuration, Mapping[str, Module]] | None":
    """Return the specification that is to run, and its modules; where there is none, report it."""
    specification = _specification(project, arguments)
    return None if specification is None else runnable(specification, project, arguments)


def runnable(
    specification: "Configuration", project: "Project", arguments: argparse.Namespace
) -> "tuple[Configuration, Mapping[str, Module]]":
    """Return a specification of a project with inputs and modes stated, and its modules.

    Raises:
        MarsError: rule packs are wrong.
    """
    from mars_asp.model.described import described_modules
    from mars_asp.reasoning.synthesis.carried_modes import state_modes
    from mars_asp.reasoning.synthesis.line_inputs import state_inputs

    # A specification that was made here does not repeat the blocks of its configuration.
    modules = described_modules(project.configuration, project.modules)
    rulebook = rulebook_for(arguments)
    named = state_inputs(specification, modules, rulebook)
    return state_modes(named, modules, rulebook), modules


def _specification(project: "Project", arguments: argparse.Namespace) -> "Configuration | None":
    """Return the file's specification, or the minimal one; report it where there is none."""
    if project.configuration.kind == "specification":
        return project.configuration
    from mars_asp.reasoning.analysis import findings
    from mars_asp.reasoning.budget import Budget
    from mars_asp.reasoning.synthesis.synthesise import synthesise

    rulebook = rulebook_for(arguments)
    analysis = analyse_project(project, rulebook, arguments)
    report(findings(analysis), arguments)
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
    """Run a specification in a scenario to its end and judge it; `show` is called with each stage.

    A `speed` limits the run to so many times real time.

    Raises:
        MarsError: what is unbound or cannot be used, all at once.
    """
    from mars_asp.execution.judgement import judge
    from mars_asp.execution.trial import stage_trial

    trial = stage_trial(specification, modules, scenario, observe)
    for _ in run_realtime(trial, speed):
        show(trial)
    return trial, judge(trial, rulebook)
