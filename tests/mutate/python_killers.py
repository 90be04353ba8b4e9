"""Mutants of Python modules, judged by the tests that run their lines, the shortest first.

pytest imports and collects the tests once. Each test then runs in a forked child, which finds the
lines that it runs; and for each mutant a child puts the mutant in the place of the module and runs
tests until one fails.
"""

import os
import resource
import sys
import tempfile
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from types import CodeType

import pytest
from _pytest.runner import runtestprotocol

from mars_asp.asp.cases.killers import RUNS_AWAY
from mars_asp.asp.cases.mutants import Mutant, MutantVerdict
from mars_asp.asp.contained import Lost, ask, limit_time
from tests.mutate.exchange import Exchange, exchanges
from tests.mutate.python_mutants import compiled_mutants, noting_module
from tests.support.documents import ROOT

_REPAIRS = (
    "reasoning/questions/test_edits",
    "language/test_text_edits",
    "reasoning/questions/test_repair",
)
_EXECUTION = (
    "execution/executor/test_arbitration",
    "execution/executor/test_delivery",
    "execution/executor/test_equivalence",
    "execution/executor/test_modules",
    "execution/executor/test_priorities",
    "execution/test_trial",
    "execution/test_judgement",
    "cli/test_run",
    "execution/executor/test_commanded_motion",
    "execution/executor/test_plan",
)
_MOTION = (
    "kinematics/test_supports",
    "kinematics/test_frames",
    "reasoning/facts/test_motion",
    "reasoning/test_combinations",
    "reasoning/test_physical",
    "test_wheel",
    "exchange/test_urdf",
)
#: The modules that judge, weigh or repair, and the test files that concern them, those first that
#: pin most for little time.
TESTS: Mapping[str, tuple[str, ...]] = {
    "mars_asp/reasoning/verification.py": (
        "reasoning/test_verification",
        "reasoning/test_realises",
        "test_standalone",
        "reasoning/synthesis/test_exhaustive",
    ),
    "mars_asp/reasoning/questions/repair.py": (
        "reasoning/questions/test_repair_search",
        "reasoning/questions/test_repair",
    ),
    "mars_asp/reasoning/questions/edits.py": _REPAIRS,
    "mars_asp/language/text_edits.py": _REPAIRS,
    "mars_asp/reasoning/questions/annotation_edits.py": _REPAIRS,
    "mars_asp/kinematics/frames.py": _MOTION,
    "mars_asp/kinematics/supports.py": (*_MOTION, "kinematics/test_sharing"),
    "mars_asp/reasoning/facts/motion.py": _MOTION,
    "mars_asp/execution/executor/plan.py": _EXECUTION,
    "mars_asp/kinematics/sharing.py": (
        "kinematics/test_sharing",
        *_EXECUTION,
        "reasoning/test_combinations",
    ),
    "mars_asp/asp/solve/optimum.py": (
        "asp/solve/test_optimum",
        "asp/solve/test_costs",
        "reasoning/synthesis/test_costs",
        "asp/trace/test_counting_rules",
        "reasoning/questions/test_alternatives",
        "reasoning/synthesis/test_time_limit",
        "reasoning/synthesis/test_exhaustive",
    ),
}
#: Tests that take more seconds of the processor than this are not asked.
_LONGEST = 15.0
_WITHOUT = ("cacheprovider", "xdist", "terminal", "faulthandler")
_OPTIONS = ("-s", "-o", "addopts=", "--hypothesis-seed=0", *(f"-pno:{name}" for name in _WITHOUT))
_NOTED = "__noted__"


@dataclass(frozen=True, slots=True)
class Run:
    """A test that passes: how long it takes, and the lines that it runs of each module."""

    item: pytest.Item
    seconds: float
    lines: frozenset[tuple[str, int]]


def judge_python(mutants: Sequence[Mutant], jobs: int, seconds: float) -> Sequence[MutantVerdict]:
    """Return the verdict on each mutant, in no order.

    Args:
        mutants: the mutants to try.
        jobs: how many at a time.
        seconds: the total time of the tests of one mutant, measured without it.

    Raises:
        RuntimeError: the tests cannot be collected.
    """
    if not mutants:
        return ()
    files = sorted({name for mutant in mutants for name in TESTS[mutant.path]})
    judge = _Judge(mutants, jobs, seconds)
    with tempfile.TemporaryDirectory() as folder:
        os.environ["HYPOTHESIS_STORAGE_DIRECTORY"] = os.environ["PYTEST_DEBUG_TEMPROOT"] = folder
        os.chdir(ROOT)
        status = pytest.main([*_OPTIONS, *(f"tests/{name}.py" for name in files)], [judge])
    if status != pytest.ExitCode.OK:
        raise RuntimeError(f"the tests cannot be collected: {status}")
    return judge.verdicts


class _Judge:
    """A plugin of pytest that, in the place of running the tests, lets them judge mutants."""

    def __init__(self, mutants: Sequence[Mutant], jobs: int, seconds: float) -> None:
        self.mutants = mutants
        self.jobs = jobs
        self.seconds = seconds
        self.verdicts: list[MutantVerdict] = []

    def pytest_runtestloop(self, session: pytest.Session) -> bool:
        """Judge all mutants."""
        if session.testsfailed:
            return False
        paths = sorted({mutant.path for mutant in self.mutants})
        places = exchanges(paths)
        runs = _runs(session.items, places, self.jobs)
        wanted = set(self.mutants)
        compiled = {
            mutant: (code, alone)
            for path in paths
            for mutant, code, alone in compiled_mutants(path)
            if mutant in wanted
        }

        def answer(mutant: Mutant) -> tuple[str | None]:
            try:
                places[mutant.path].put(*compiled[mutant])
            except Exception:
                return ("its import",)
            return (_failing(_concerned(mutant, runs, self.seconds)),)

        for mutant, item in ask(self.mutants, answer, self.jobs):
            killer = RUNS_AWAY if isinstance(item, Lost) else item[0]
            self.verdicts.append(MutantVerdict(mutant, killer))
            # pytest has standard output; who waits for hours wants to see what comes of it.
            print(f"{mutant}\n  {killer or 'survives'}", file=sys.stderr, flush=True)
        return True


def _concerned(mutant: Mutant, runs: Sequence[Run], seconds: float) -> Iterator[Run]:
    """Yield the tests that run the line of a mutant; if none notes it, those of its module."""
    place = (mutant.path, mutant.line)
    tests = [run for run in runs if place in run.lines]
    if not tests and mutant.before.startswith(": "):
        tests = [run for run in runs if any(path == mutant.path for path, _ in run.lines)]
    left = seconds
    names = TESTS[mutant.path]
    ranked = {name: rank for rank, name in enumerate(names)}
    for run in sorted(tests, key=lambda run: ranked.get(_name(run.item), len(names))):
        left -= run.seconds
        if left > 0:
            yield run


def _name(item: pytest.Item) -> str:
    """Return the file of a test as `TESTS` names it."""
    return item.path.relative_to(ROOT / "tests").with_suffix("").as_posix()


def _failing(runs: Iterable[Run]) -> str | None:
    """Return the first test that fails, if one does; one that takes far too long ends the child."""
    for run in runs:
        limit_time(5 + 4 * run.seconds)
        if not _passes(run.item):
            return run.item.nodeid
    return None


def _passes(item: pytest.Item) -> bool:
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    os.dup2(nowhere, 2)
    os.close(nowhere)
    return not any(entry.failed for entry in runtestprotocol(item, log=False))


# ---- Which tests run which lines -----------------------------------------------------------------


def _runs(items: Sequence[pytest.Item], places: Mapping[str, Exchange], jobs: int) -> list[Run]:
    """Return the tests that pass, the shortest first."""
    noting = {path: noting_module(path, _NOTED) for path in places}

    def answer(item: pytest.Item) -> tuple[bool, float, frozenset[tuple[str, int]]]:
        lines = {path: _put_noting(place, noting[path]) for path, place in places.items()}
        limit_time(_LONGEST)
        begun = _processor()
        passed = _passes(item)
        ran = frozenset((path, line) for path, found in lines.items() for line in found)
        return passed, _processor() - begun, ran

    runs: list[Run] = []
    for item, found in ask(items, answer, jobs):
        passed, seconds, lines = (
            (False, _LONGEST, frozenset[tuple[str, int]]()) if isinstance(found, Lost) else found
        )
        if lines and passed:
            runs.append(Run(item, seconds, lines))
        elif not passed:
            why = "takes too long" if isinstance(found, Lost) else "fails"
            print(f"{item.nodeid} {why}, and judges nothing", file=sys.stderr)
    return sorted(runs, key=lambda run: (run.seconds, run.item.nodeid))


def _put_noting(place: Exchange, code: CodeType) -> set[int]:
    lines: set[int] = set()
    vars(place.module)[_NOTED] = lines.add
    place.put(code)
    return lines


def _processor() -> float:
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(each.ru_utime + each.ru_stime for each in used)
