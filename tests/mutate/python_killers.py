"""What notices a mutant of a Python module: the tests that run its line, the shortest first.

pytest runs in a forked child, where the mutated module is put in the place of the module before any
test imports it. Which tests run which line is found once, by tracing the tests as they are.
"""

import importlib.machinery
import importlib.util
import os
import sys
import tempfile
import time
from collections.abc import Generator, Iterator, Mapping, Sequence
from dataclasses import dataclass
from types import CodeType, FrameType

import pytest

from tests.documents import ROOT
from tests.mutate.children import ask, limit
from tests.mutate.mutant import RUNS_AWAY, Mutant, Verdict
from tests.mutate.python_mutants import mutated_source

#: The modules that judge or weigh, and the test files that concern them.
TESTS: Mapping[str, tuple[str, ...]] = {
    "mars_asp/verify.py": ("test_verify", "test_exhaustive"),
    "mars_asp/repair.py": ("test_repair",),
    "mars_asp/edits.py": ("test_repair",),
    "mars_asp/frames.py": ("test_frames", "test_physical", "test_wheel", "test_execute_run"),
    "mars_asp/physical.py": ("test_physical", "test_frames"),
    "mars_asp/execute/plan.py": (
        "test_execute_arbitration",
        "test_execute_delivery",
        "test_execute_modules",
        "test_execute_run",
    ),
    "mars_asp/optimum.py": ("test_exhaustive", "test_time_limit", "test_alternatives"),
}
#: So many tests are tried at most; a mutant that takes more of the processor runs away.
_MOST_TESTS = 60
_SECONDS = 120.0
_PYTEST = ("-x", "-q", "-p", "no:cacheprovider", "-n", "0", "--hypothesis-seed=0")


@dataclass(frozen=True, slots=True)
class Run:
    """A test that passes: how long it takes, and the lines that it runs of each module."""

    test: str
    seconds: float
    lines: frozenset[tuple[str, int]]


def judge_python(mutants: Sequence[Mutant], jobs: int) -> Iterator[Verdict]:
    """Yield what notices each mutant, in no order."""
    os.environ["HYPOTHESIS_STORAGE_DIRECTORY"] = tempfile.mkdtemp()
    paths = sorted({mutant.path for mutant in mutants})
    files = sorted({name for path in paths for name in TESTS[path]})
    runs = [
        run
        for _, found in ask(files, lambda name: _traced(name, frozenset(paths)), jobs)
        for run in found or ()
    ]
    runs.sort(key=lambda run: run.seconds)

    def answer(mutant: Mutant) -> tuple[str | None]:
        limit(_SECONDS)
        return (_failing(mutant, runs),)

    for mutant, said in ask(mutants, answer, jobs):
        yield Verdict(mutant, RUNS_AWAY if said is None else said[0])


def _failing(mutant: Mutant, runs: Sequence[Run]) -> str | None:
    """Say what fails with a mutant, if anything does."""
    place = (mutant.path, mutant.line)
    concerned = tuple(f"tests/{name}.py" for name in TESTS[mutant.path])
    tests = [run.test for run in runs if place in run.lines]
    if not tests and all(place not in run.lines for run in runs):
        tests = [run.test for run in runs if run.test.startswith(concerned)]
    sys.meta_path.insert(0, _Instead(mutant))
    status = _pytest(tests[:_MOST_TESTS], ())
    if status == pytest.ExitCode.OK:
        return None
    return "import" if status != pytest.ExitCode.TESTS_FAILED else "tests"


def _pytest(tests: Sequence[str], plugins: Sequence[object]) -> int:
    """Run tests in silence, with all modules of the project imported anew."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    os.dup2(nowhere, 2)
    for name in list(sys.modules):
        project = name.partition(".")[0] in ("mars_asp", "tests")
        if project and name != "tests" and not name.startswith(__package__):
            del sys.modules[name]
    os.chdir(ROOT)
    return int(pytest.main([*_PYTEST, *tests], list(plugins)))


class _Loader(importlib.machinery.SourceFileLoader):
    """Loads a module from a source that is not in its file."""

    def __init__(self, name: str, path: str, source: str) -> None:
        super().__init__(name, path)
        self.source = source

    def get_code(self, fullname: str) -> CodeType:
        """Return the code of the source."""
        return compile(self.source, self.get_filename(fullname), "exec")


class _Instead:
    """Finds a mutated module in the place of the module."""

    def __init__(self, mutant: Mutant) -> None:
        self.name = mutant.path.removesuffix(".py").replace("/", ".")
        self.loader = _Loader(self.name, str(ROOT / mutant.path), mutated_source(mutant))

    def find_spec(
        self, fullname: str, path: object, target: object = None
    ) -> importlib.machinery.ModuleSpec | None:
        """Return how the mutated module is loaded."""
        if fullname != self.name:
            return None
        return importlib.util.spec_from_file_location(
            fullname, self.loader.path, loader=self.loader
        )


# ---- Which tests run which lines -----------------------------------------------------------------


def _traced(name: str, paths: frozenset[str]) -> list[Run]:
    tracer = _Tracer(paths)
    _pytest([f"tests/{name}.py"], [tracer])
    return tracer.runs


class _Tracer:
    """A plugin of pytest that notes which lines of some modules each passing test runs."""

    def __init__(self, paths: frozenset[str]) -> None:
        self.files = {str(ROOT / path): path for path in paths}
        self.runs: list[Run] = []

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_call(self, item: pytest.Item) -> Generator[None, None, None]:
        """Trace one test."""
        lines: set[tuple[str, int]] = set()
        files = self.files

        def line(frame: FrameType, _event: str, _argument: object) -> object:
            lines.add((files[frame.f_code.co_filename], frame.f_lineno))
            return line

        def call(frame: FrameType, _event: str, _argument: object) -> object:
            return line if frame.f_code.co_filename in files else None

        begun = time.process_time()
        sys.settrace(call)  # type: ignore[arg-type]
        try:
            yield
        finally:
            sys.settrace(None)
        self.runs.append(Run(item.nodeid, time.process_time() - begun, frozenset(lines)))
