"""The processes that carry out the runs of a campaign, each one run after another, in children.

A child has its own interpreter state, memory and time, so that no run depends on those before it
and no behaviour can hang or end more than its own run. The runner has one thread, so it can fork;
it ends with the process that started it, as its standard input does, and so does a child.

Both ways pickles cross pipes, each after its length (eight bytes); what a child says is JSON.
"""

import gc
import importlib
import json
import os
import pickle
import select
import signal
import subprocess
import sys
import tempfile
import time
import warnings
from collections.abc import Callable, Generator, Mapping, Sequence
from contextlib import ExitStack, suppress
from dataclasses import dataclass, replace
from itertools import islice
from pathlib import Path
from typing import IO, Any, NamedTuple, NoReturn

from mars_asp import __version__
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.cli import worker
from mars_asp.cli.limits import limit_memory
from mars_asp.cli.perform import performed
from mars_asp.cli.run_json import run_json
from mars_asp.diagnostic import Diagnostic, MarsError, point, refusal
from mars_asp.execution.campaign.grid import Run
from mars_asp.execution.campaign.summary import FAIL, NOT_DECIDED
from mars_asp.execution.scenario.read import Scenario, read_scenario
from mars_asp.language import parse_text
from mars_asp.model.declarations import Configuration, Module

#: A run whose process ends without a result is carried out so often: it may have been killed.
_TRIES = 3
#: Seconds after which a runner that is asked for nothing ends.
_IDLE = 60.0
#: Seconds between two looks at whether a run is still wanted.
_GLANCE = 0.25
_LENGTH = 8
#: What a child imports beyond what this file does, before it is forked.
_PRELOADED = ("ctypes", "clingo", "numpy", "mars_asp.asp.trace", "mars_asp.execution.trial")


@dataclass(frozen=True, slots=True)
class Job:
    """What the runs of a campaign have in common.

    `path` is that of the scenario, `folder` the one in which they are carried out. `files` are the
    contents of Python files by their absolute paths, where others cannot see these. `seconds` is
    how long each run may take, without it 60 s and ten times its simulated time; `megabytes` how
    much memory. `rulebook` judges them.
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


class RunOutcome(NamedTuple):
    """What became of a run: its result, or else what of the input is wrong."""

    result: Mapping[str, Any] | None
    problems: tuple[Diagnostic, ...] = ()


class RunnerLostError(Exception):
    """A runner ended without being asked to."""


class _Fork:
    """A runner that has imported all that this process has; of its threads it has this one."""

    def __init__(self) -> None:
        given, sent = os.pipe()
        answers, answered = os.pipe()
        with warnings.catch_warnings():
            # The only other thread of a worker waits for an end, and holds no lock.
            warnings.simplefilter("ignore", DeprecationWarning)
            self._child = os.fork()
        if not self._child:
            try:
                os.dup2(given, 0)
                os.dup2(answered, 1)
                os.closerange(3, os.sysconf("SC_OPEN_MAX"))
                sys.stdout = open(os.devnull, "w")  # noqa: PTH123, SIM115 -- for as long as it runs
                serve_runs()
            finally:
                os._exit(0)
        os.close(given)
        os.close(answered)
        self.stdin, self.stdout = os.fdopen(sent, "wb", 0), os.fdopen(answers, "rb", 0)

    def kill(self) -> None:
        """End it."""
        os.kill(self._child, signal.SIGKILL)

    def wait(self) -> None:
        """Wait for its end, once."""
        with suppress(ChildProcessError):
            os.waitpid(self._child, 0)


class Runner:
    """A runner of one job, as a process of its own."""

    def __init__(self, job: bytes, *, forked: bool = False) -> None:
        """Start it, as a fork of this process or with an interpreter of its own.

        The pickled job is sent with the first run, when others may have started as well.
        """
        self._job: bytes | None = job
        self._process: _Fork | subprocess.Popen[bytes]
        if forked and hasattr(os, "fork"):
            self._process = _Fork()
            return
        path = f"import sys; sys.path[:] = {sys.path!r}"
        start = f"{path}; from {__name__} import serve_runs; serve_runs()"
        self._process = subprocess.Popen(
            [sys.executable, "-P", "-c", start],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            bufsize=0,
        )

    @property
    def answers(self) -> IO[bytes]:
        """The pipe that has something to read when a run has ended, or the runner has."""
        assert self._process.stdout is not None
        return self._process.stdout

    def start_run(self, run: Run) -> None:
        """Request a run; a runner that has ended is noticed when its answer is read."""
        with suppress(OSError, ValueError):
            if self._job is not None:
                self._send(self._job)
                self._job = None
            self._send(pickle.dumps(run))

    def outcome(self) -> RunOutcome:
        """Return the outcome of the run that was requested, when it has ended.

        Raises:
            RunnerLostError: the runner ended.
        """
        try:
            answer = _received(self.answers)
        except (OSError, ValueError):
            answer = None
        if answer is None:
            self.end()
            raise RunnerLostError
        found: RunOutcome = pickle.loads(answer)
        return found

    def run(self, run: Run, wanted: Callable[[], bool] = lambda: True) -> RunOutcome | None:
        """Carry out a run; return its outcome, or None if it is wanted no more.

        Raises:
            RunnerLostError: the runner ended.
        """
        self.start_run(run)
        while not select.select([self.answers], [], [], _GLANCE)[0]:
            if not wanted():
                self.end()
                return None
        return self.outcome()

    def end(self) -> None:
        """End it and what it runs."""
        self._process.kill()
        for pipe in (self._process.stdin, self._process.stdout):
            assert pipe is not None
            with suppress(OSError):
                pipe.close()
        self._process.wait()

    def _send(self, payload: bytes) -> None:
        assert self._process.stdin is not None
        _send(self._process.stdin, payload)


def outcomes_of(job: bytes, runs: Sequence[Run], workers: int) -> Generator[tuple[Run, RunOutcome]]:
    """Yield runs with their outcomes as they end, carried out by so many runners.

    Raises:
        MarsError: a runner ended again and again with one run.
    """
    waiting = iter(runs)
    busy: dict[int, tuple[Runner, Run, int]] = {}
    ready = select.poll()

    def assign(runner: Runner, run: Run, tries: int) -> None:
        runner.start_run(run)
        busy[runner.answers.fileno()] = runner, run, tries
        ready.register(runner.answers, select.POLLIN)

    try:
        for runner, run in [(Runner(job, forked=True), run) for run in islice(waiting, workers)]:
            assign(runner, run, 1)
        while busy:
            for pipe, _ in ready.poll():
                ready.unregister(pipe)
                runner, run, tries = busy.pop(pipe)
                try:
                    outcome = runner.outcome()
                except RunnerLostError:
                    if tries == _TRIES:
                        message = "the process that carries out runs ended again and again"
                        help_text = "is there enough memory?"
                        raise refusal("campaign", message, "--scenario", help_text) from None
                    assign(Runner(job, forked=True), run, tries + 1)
                    continue
                following = next(waiting, None)
                if following is None:
                    runner.end()
                else:
                    assign(runner, following, 1)
                yield run, outcome
    finally:
        for runner, _, _ in busy.values():
            runner.end()


def _send(pipe: IO[bytes], payload: bytes) -> None:
    whole = memoryview(len(payload).to_bytes(_LENGTH, "big") + payload)
    while whole:
        whole = whole[os.write(pipe.fileno(), whole) :]


def _received(pipe: IO[bytes]) -> bytes | None:
    """Return the bytes sent through a pipe, or None if it was closed."""
    head = _exactly(pipe, _LENGTH)
    return None if head is None else _exactly(pipe, int.from_bytes(head, "big"))


def _exactly(pipe: IO[bytes], size: int) -> bytes | None:
    found = bytearray()
    while len(found) < size:
        chunk = os.read(pipe.fileno(), min(size - len(found), 1 << 20))
        if not chunk:
            return None
        found += chunk
    return bytes(found)


# ---- In the runner -------------------------------------------------------------------------------


def serve_runs() -> None:
    """Carry out what standard input asks for, until it is closed or asks for nothing more."""
    given = os.fdopen(os.dup(0), "rb", buffering=0)
    answers = os.fdopen(os.dup(1), "wb", buffering=0)
    # What behaviours print is no part of a result; `run` shows it.
    nothing = os.open(os.devnull, os.O_RDWR)
    os.dup2(nothing, 0)
    os.dup2(nothing, 1)
    for number in worker.ENDING:
        signal.signal(number, signal.SIG_DFL)
    with ExitStack() as stack:
        raw = _received(given)
        if raw is None:
            return
        job: Job = pickle.loads(raw)
        root = ""
        if job.files is not None:
            # What it is a link to is what an interpreter calls the folder it is in.
            root = os.path.realpath(stack.enter_context(tempfile.TemporaryDirectory()))
            job = _unpacked(job, root)
        os.chdir(job.folder)
        carry_out = _Carrier(job, given, root)
        while select.select([given], [], [], _IDLE)[0] and (query := _received(given)):
            _send(answers, pickle.dumps(carry_out(pickle.loads(query))))


def _unpacked(job: Job, root: str) -> Job:
    """Write the files of a job below a folder, which its paths then begin with."""

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


class _Carrier:
    """Carries out runs of a job; scenarios of one cell are read once."""

    def __init__(self, job: Job, given: IO[bytes], root: str) -> None:
        self._job, self._given = job, given
        #: What paths begin with here and nowhere else.
        self._root = root.encode()
        self._rulebook = job.rulebook
        self._scenarios: dict[str, Scenario] = {}
        for name in _PRELOADED:
            importlib.import_module(name)
        # Each child would fill caches again; and no collection is to copy what is shared.
        _warm_up(self._rulebook)
        gc.collect()
        gc.freeze()
        gc.set_threshold(1_000_000, 20, 20)

    def __call__(self, run: Run) -> RunOutcome:
        key = json.dumps(run.vary)
        try:
            if key not in self._scenarios:
                path = Path(self._job.path)
                self._scenarios[key] = read_scenario(self._job.scenario, path, run.changes)
        except MarsError as error:
            return RunOutcome(None, error.diagnostics)
        scenario = replace(self._scenarios[key], seed=run.seed)
        seconds = self._job.seconds or 60.0 + 10 * scenario.duration
        for _ in range(_TRIES):
            result, how = self._contained(scenario, seconds)
            if result is not None:
                return _outcome(json.loads(result.decode("utf-8", "surrogatepass")))
            if how is None:
                text = f"the run took longer than {seconds:g} s, so it was ended"
                return RunOutcome(_unfinished(scenario, NOT_DECIDED, text))
        text = f"the code of a behaviour ended the run ({how})"
        return RunOutcome(_unfinished(scenario, FAIL, text))

    def _contained(self, scenario: Scenario, seconds: float) -> tuple[bytes | None, str | None]:
        """Return what a child says of a run; else how it ended, or None if its time was over."""
        if not hasattr(os, "fork"):
            return self._result(scenario), None
        results, result = os.pipe()
        watched, alive = os.pipe()
        child = os.fork()
        if not child:
            os.close(results)
            os.close(alive)
            self._work(scenario, result, watched)
        os.close(result)
        os.close(watched)
        status = None
        try:
            heard = self._heard(results, child, seconds)
            if heard is not None and not heard.endswith(b"\n"):
                status = _ended_soon(child)
        finally:
            os.close(results)
            os.close(alive)
            worker.end_group(child)
            if status is None:
                _, status = os.waitpid(child, 0)
        if heard is None:
            return None, None
        if heard.endswith(b"\n"):
            return heard, None
        code = os.waitstatus_to_exitcode(status)
        return None, f"status {code}" if code >= 0 else signal.Signals(-code).name

    def _heard(self, results: int, child: int, seconds: float) -> bytes | None:
        """Return what comes through a pipe until its end, or until that of the child or the job."""
        ready, heard = select.poll(), bytearray()
        ready.register(results, select.POLLIN)
        ready.register(self._given, 0)  # its end alone
        with ExitStack() as stack:
            with suppress(AttributeError, OSError):
                ended = os.pidfd_open(child)
                stack.callback(os.close, ended)
                ready.register(ended, select.POLLIN)
            until = time.monotonic() + seconds
            while (left := until - time.monotonic()) > 0:
                found = dict(ready.poll(left * 1000))
                if self._given.fileno() in found:
                    worker.end_group(child)
                    os._exit(0)
                if results in found:
                    chunk = os.read(results, 1 << 20)
                    heard += chunk
                    if not chunk or chunk.endswith(b"\n"):
                        return bytes(heard)
                elif found:
                    return bytes(heard)
        return None

    def _work(self, scenario: Scenario, said: int, watched: int) -> NoReturn:
        """Carry out a run in this child, say what came of it, and end."""
        worker.begin_group(self._given.fileno(), watched)
        _end_with_parent()
        limit_memory(self._job.megabytes)
        raw = b""
        try:
            raw = self._result(scenario)
        except BaseException as error:
            print(f"mars-asp: a run failed: {error!r:.300}", file=sys.stderr)
        worker.leave_with(said, raw)

    def _result(self, scenario: Scenario) -> bytes:
        """Carry out a run; return what is said of it in one line."""
        job = self._job
        try:
            done = performed(job.specification, job.modules, scenario, rulebook=self._rulebook)
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
        # No result depends on where it was found.
        raw = json.dumps(found, ensure_ascii=False).encode("utf-8", "surrogatepass")
        return (raw.replace(self._root, b"") if self._root else raw) + b"\n"


def _warm_up(rulebook: Rulebook) -> None:
    """Carry out and judge a run without the code of others."""
    robot = "@specification\n@modules P, C\nP is_controlled_by C\n"
    world = "walls = [[[900, -900], [900, 900]]]\nscatter.count = 3"
    hand = 'kind = "joystick"\nscript = [[0, "Trans_Z", 200], [0.5, "Rotn_Y", 20]]'
    text = f'duration = 1\n[robot]\nmodule = "P"\n[world]\n{world}\n[devices.C]\n{hand}\n'
    scenario = read_scenario(text, Path("warm-up.toml"))
    configuration = parse_text(robot, "warm-up.mars").configuration
    run_json(*performed(configuration, {}, scenario, rulebook=rulebook))


def _ended_soon(child: int) -> int | None:
    """Return the status of a child that closed its pipe, or None if it does not end soon.

    It is not ended before: how it ended by itself is what is reported.
    """
    until = time.monotonic() + 1
    while time.monotonic() < until:
        ended, status = os.waitpid(child, os.WNOHANG)
        if ended:
            return status
        time.sleep(0.01)
    return None


def _outcome(said: Mapping[str, Any]) -> RunOutcome:
    problems = tuple(
        Diagnostic(code, "error", message, point(path, line, column), help=help_text)
        for code, message, path, line, column, help_text in said.get("problems", ())
    )
    return RunOutcome(said.get("result"), problems)


def _unfinished(scenario: Scenario, verdict: str, error: str) -> dict[str, object]:
    """Return the result of a run that did not come to its end: the keys of `run`, and why."""
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


def _end_with_parent() -> None:
    """Have the system end this process when its parent ends, where it is able to.

    A thread that watches does the same, but for code that lets no other thread run.
    """
    if sys.platform == "linux":
        import ctypes

        with suppress(OSError, AttributeError):
            ctypes.CDLL(None).prctl(1, signal.SIGKILL)  # PR_SET_PDEATHSIG
