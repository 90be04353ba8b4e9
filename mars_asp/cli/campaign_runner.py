"""Runs of a campaign, each in a child process with its own state, memory and time.

So no run depends on an earlier one, and no behaviour can hang or end another run. A worker of Dask
has threads and cannot fork, so it sends its runs to a server without threads.
"""

import argparse
import gc
import importlib
import json
import os
import pickle
import sys
import tempfile
from collections.abc import Callable, Generator, Iterable, Mapping, Sequence
from contextlib import ExitStack, closing
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

from mars_asp import __version__
from mars_asp.asp.contained import Lost, ask, end_with_parent, leave, serve
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.cli.inputs import packs_of
from mars_asp.cli.limits import memory_limit
from mars_asp.cli.run_json import run_json
from mars_asp.cli.trials import run_trial
from mars_asp.diagnostic import Diagnostic, MarsError, point, refusal
from mars_asp.execution.campaign.code import hash_of, imported_code
from mars_asp.execution.campaign.grid import Grid, Run
from mars_asp.execution.campaign.summary import FAIL, NOT_DECIDED
from mars_asp.execution.executor.plan import Plan
from mars_asp.execution.judgement import run_rulebook
from mars_asp.execution.parts import in_parts
from mars_asp.execution.scenario.agreement import disagreements
from mars_asp.execution.scenario.functions import bind_kinds, bound_functions
from mars_asp.execution.scenario.read import Scenario, read_scenario
from mars_asp.language import parse_text
from mars_asp.model.declarations import Configuration, Module
from mars_asp.reasoning.packs import MANIFEST, find_packs
from mars_asp.reasoning.project import Project

#: A run whose process ends without a result is tried so often: it may have been killed.
_TRIES = 3
#: Seconds without a request after which a server ends.
_IDLE = 60.0
#: The imports of a child beyond those of this file, done before it is forked.
_PRELOADED = ("ctypes", "clingo", "numpy", "mars_asp.asp.trace", "mars_asp.execution.trial")


@dataclass(frozen=True, slots=True)
class Job:
    """The values that all runs of a campaign share.

    `path` is the path of the scenario, `folder` the working folder of the runs. `files` are the
    contents of Python files by absolute path, or None if the machine of the runs has these files.
    `seconds` limits the time of a run (None: 60 s and ten times its simulated time), `megabytes`
    its memory. `rulebook` judges the runs.
    """

    specification: Configuration
    modules: Mapping[str, Module]
    scenario: str
    path: str
    folder: str
    files: Mapping[str, bytes] | None
    seconds: float | None
    megabytes: float | None
    rulebook: Rulebook
    version: str = __version__


def needs_of(
    specification: Configuration,
    modules: Mapping[str, Module],
    grid: Grid,
    text: str,
    path: Path,
) -> tuple[Mapping[str, bytes], Sequence[Diagnostic]]:
    """Return the contents of Python files that runs import, and warnings about their scenarios.

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
    return imported_code(files), tuple(found)


def job_of(
    specification: Configuration,
    modules: Mapping[str, Module],
    text: str,
    path: Path,
    code: Mapping[str, bytes],
    arguments: argparse.Namespace,
) -> Job:
    """Return the values that all runs share; `text` is the scenario, `code` the Python files."""
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
    """Return digests of the configuration, sources and packs, and of the scenario with its code."""
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


class RunOutcome(NamedTuple):
    """The result of a run, or the errors of its input."""

    result: Mapping[str, Any] | None
    problems: tuple[Diagnostic, ...] = ()


class Runs:
    """Carries out runs of a job; the scenario of each cell is read once."""

    def __init__(self, job: Job, root: str = "") -> None:
        """Prepare for forks; results omit `root`, a prefix of the paths of a job."""
        self._job, self._root = job, root.encode()
        self._scenarios: dict[str, Scenario] = {}
        for name in _PRELOADED:
            importlib.import_module(name)
        # Children share the filled caches; a garbage collection would copy the shared memory.
        _warm_up(job.rulebook)
        gc.collect()
        gc.freeze()
        gc.set_threshold(1_000_000, 20, 20)

    def outcomes(
        self, runs: Iterable[Run], workers: int, watched: Sequence[int] = ()
    ) -> Generator[tuple[Run, RunOutcome]]:
        """Yield runs with their outcomes as they end, `workers` of them in parallel.

        The runs are ended when one of the `watched` pipes is closed.
        """
        answers = ask(
            runs,
            self._carry_out,
            workers,
            seconds=self._seconds,
            megabytes=self._job.megabytes,
            tries=_TRIES,
            watched=watched,
        )
        with closing(answers):
            for run, answer in answers:
                yield run, self._outcome(run, answer)

    def _scenario(self, run: Run) -> Scenario:
        key = json.dumps(run.vary)
        if key not in self._scenarios:
            path = Path(self._job.path)
            self._scenarios[key] = read_scenario(self._job.scenario, path, run.changes)
        return replace(self._scenarios[key], seed=run.seed)

    def _seconds(self, run: Run) -> float:
        return self._job.seconds or 60.0 + 10 * self._scenario(run).duration

    def _outcome(self, run: Run, answer: bytes | Lost) -> RunOutcome:
        if isinstance(answer, Lost):
            if answer.how is None:
                text = f"the run took longer than {self._seconds(run):g} s, so it was ended"
                return RunOutcome(_unfinished(self._scenario(run), NOT_DECIDED, text))
            text = f"the code of a behaviour ended the run ({answer.how})"
            return RunOutcome(_unfinished(self._scenario(run), FAIL, text))
        found = json.loads(answer.decode("utf-8", "surrogatepass"))
        problems = tuple(
            Diagnostic(code, "error", message, point(path, line, column), help=help_text)
            for code, message, path, line, column, help_text in found.get("problems", ())
        )
        return RunOutcome(found.get("result"), problems)

    def _carry_out(self, run: Run) -> bytes:
        """Carry out a run in this child; return its result or its errors as JSON."""
        end_with_parent()
        # Results omit the output of behaviours; `run` shows it.
        nowhere = os.open(os.devnull, os.O_RDWR)
        os.dup2(nowhere, 0)
        os.dup2(nowhere, 1)
        sys.stdout = os.fdopen(nowhere, "w")
        try:
            return self._result(self._scenario(run))
        except BaseException as error:
            print(f"mars-asp: a run failed: {error!r:.300}", file=sys.stderr)
            leave(1)

    def _result(self, scenario: Scenario) -> bytes:
        job = self._job
        try:
            done = run_trial(job.specification, job.modules, scenario, rulebook=job.rulebook)
            found: Mapping[str, Any] = {"result": run_json(*done)}
        except MarsError as error:
            problems = [
                [d.code, d.message, d.span.path, d.span.line, d.span.column, d.help]
                for d in error.diagnostics
                if d.severity == "error"
            ]
            found = {"problems": problems}
        except MemoryError:
            text = "the memory limit ended the run; --memory-limit MB allows more"
            found = {"result": _unfinished(scenario, NOT_DECIDED, text)}
        # A result does not depend on the folder of its files.
        raw = json.dumps(found, ensure_ascii=False).encode("utf-8", "surrogatepass")
        return raw.replace(self._root, b"") if self._root else raw


def _warm_up(rulebook: Rulebook) -> None:
    """Perform and judge a run of built-in behaviours, which fills caches before forks."""
    robot = "@specification\n@modules P, C\nP is_controlled_by C\n"
    world = "walls = [[[900, -900], [900, 900]]]\nscatter.count = 3"
    hand = 'kind = "joystick"\nscript = [[0, "Trans_Z", 200], [0.5, "Rotn_Y", 20]]'
    text = f'duration = 1\n[robot]\nmodule = "P"\n[world]\n{world}\n[devices.C]\n{hand}\n'
    scenario = read_scenario(text, Path("warm-up.toml"))
    configuration = parse_text(robot, "warm-up.mars").configuration
    run_json(*run_trial(configuration, {}, scenario, rulebook=rulebook))


def _unfinished(scenario: Scenario, verdict: str, error: str) -> dict[str, object]:
    """Return the result of a run that ended early, with the keys of `run` and the error."""
    return {
        "verdict": verdict,
        "requirements": [],
        "warnings": [],
        "seconds": scenario.duration,
        "seed": scenario.seed,
        "events": None,
        "messages": None,
        "collisions": None,
        "min_clearance_mm": None,
        "control_time": {},
        "error": error,
    }


# ---- A server ------------------------------------------------------------------------------------


def serve_runs() -> None:
    """Carry out the runs that standard input requests, until it is closed or idle."""
    with ExitStack() as stack:
        serve(partial(_begin, stack), _IDLE)


def _begin(stack: ExitStack, given: int, raw: bytes) -> Callable[[Run], RunOutcome]:
    """Unpack a job; return the function that carries out a run, ended with the pipe `given`."""
    job: Job = pickle.loads(raw)
    root = ""
    if job.files is not None:
        # The interpreter names its working folder by the path without links.
        root = os.path.realpath(stack.enter_context(tempfile.TemporaryDirectory()))
        job = _unpacked(job, root)
    os.chdir(job.folder)
    runs = Runs(job, root)

    def carry_out(run: Run) -> RunOutcome:
        [(_, outcome)] = runs.outcomes([run], 1, (given,))
        return outcome

    return carry_out


def _unpacked(job: Job, root: str) -> Job:
    """Write the files of a job below `root`, and return the job with these paths."""

    def moved(path: str) -> str:
        return f"{root}{path}" if path.startswith("/") else path

    for path, content in (job.files or {}).items():
        file = Path(moved(path))
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(content)
    folder = moved(job.folder)
    Path(folder).mkdir(parents=True, exist_ok=True)
    modules = {}
    for name, module in job.modules.items():
        services = (
            replace(each, span=each.span._replace(path=moved(each.span.path)))
            for each in module.services
        )
        modules[name] = replace(module, services=tuple(services))
    return replace(job, modules=modules, path=moved(job.path), folder=folder)
