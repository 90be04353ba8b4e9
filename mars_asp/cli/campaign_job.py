"""The job of a campaign, the files that its runs import, and the digests of its input."""

import argparse
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from mars_asp.cli.campaign_runner import Job
from mars_asp.cli.inputs import packs_of
from mars_asp.cli.limits import memory_limit
from mars_asp.diagnostic import Diagnostic, MarsError, refusal
from mars_asp.execution.campaign.code import hash_of, imported_code
from mars_asp.execution.campaign.grid import Grid
from mars_asp.execution.executor.plan import Plan
from mars_asp.execution.judgement import run_rulebook
from mars_asp.execution.parts import in_parts
from mars_asp.execution.scenario.agreement import disagreements
from mars_asp.execution.scenario.functions import bind_kinds, bound_functions
from mars_asp.execution.scenario.read import read_scenario
from mars_asp.model.declarations import Configuration, Module
from mars_asp.reasoning.packs import MANIFEST, find_packs
from mars_asp.reasoning.project import Project


class JobNeeds(NamedTuple):
    """The files that the runs of a campaign import, by absolute path, and warnings on scenarios."""

    code: Mapping[str, bytes]
    remarks: Sequence[Diagnostic]


def needs_of(
    specification: Configuration,
    modules: Mapping[str, Module],
    grid: Grid,
    text: str,
    path: Path,
) -> JobNeeds:
    """Return the Python files that runs import, and the warnings about their scenarios.

    Raises:
        MarsError: a file is missing, or a scenario does not fit the specification.
    """
    plan = Plan(*in_parts(specification, modules), {})
    files: dict[Path, None] = {}
    found: dict[Diagnostic, None] = {}
    for cell in grid.cells():
        scenario = bind_kinds(read_scenario(text, path, cell), specification)
        found |= dict.fromkeys(disagreements(plan, scenario))
        bound = dict(bound_functions(plan.modules, scenario, plan.names))
        files |= dict.fromkeys(file for file, _ in bound.values())
    if problems := [each for each in found if each.severity == "error"]:
        raise MarsError(problems)
    missing = [file for file in files if not file.is_file()]
    if missing:
        message = "this file, which runs import, is not there"
        raise refusal("campaign", message, str(missing[0]))
    return JobNeeds(imported_code(files), tuple(found))


def job_of(
    specification: Configuration,
    modules: Mapping[str, Module],
    text: str,
    path: Path,
    code: Mapping[str, bytes],
    arguments: argparse.Namespace,
) -> Job:
    """Return the values that all runs share."""
    most = memory_limit(arguments)
    if most is not None and arguments.memory_limit is None:
        # All workers share the available memory.
        most /= arguments.workers
    files = code if arguments.cluster else None
    seconds = arguments.run_limit
    rulebook = run_rulebook(packs_of(arguments))
    folder = str(Path.cwd())
    return Job(specification, modules, text, str(path), folder, files, seconds, most, rulebook)


def hashes(
    project: Project, text: str, code: Mapping[str, bytes], arguments: argparse.Namespace
) -> tuple[str, str]:
    """Return the digests of a configuration with sources and rules, and of a scenario with code."""
    configuration = project.configuration
    spans = [
        *(name.span for name in configuration.modules),
        *(line.span for line in configuration.relationships),
        *(module.span for module in project.modules.values()),
    ]
    given = find_packs(packs_of(arguments), [])
    packs = [str(file.path) for pack in given for file in pack.files]
    packs += [str(pack.folder / MANIFEST) for pack in given if pack.manifest is not None]
    paths = {*arguments.files, *(span.path for span in spans), *packs}
    files = {each: Path(each).read_bytes() for each in paths if Path(each).is_file()}
    return hash_of(project.text, files), hash_of(text, code)
