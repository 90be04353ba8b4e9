"""Options of the test suite."""

import gc
import os
import signal
import sys
from collections.abc import Iterator
from itertools import count
from pathlib import Path

import pytest
from xdist.remote import Producer
from xdist.scheduler import LoadGroupScheduling

from mars_asp.asp import cache
from tests.support.browser import Browser
from tests.support.campaigns import IS_CAMPAIGN

# What commands print does not depend on where the tests run.
for _name in ("COLUMNS", "NO_COLOR", "FORCE_COLOR"):
    os.environ.pop(_name, None)
# The commands that tests start need not compile the package each time.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False
# What was started in the background ignores signals, and hands that on to the commands.
for _signal in (signal.SIGINT, signal.SIGQUIT, signal.SIGHUP):
    if signal.getsignal(_signal) == signal.SIG_IGN:
        ours = signal.default_int_handler if _signal == signal.SIGINT else signal.SIG_DFL
        signal.signal(_signal, ours)


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_auto_num_workers() -> int:
    """Return one more than there are processors, as some tests wait for others to end."""
    return 1 + (os.cpu_count() or 1)


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--update-golden", action="store_true", help="write what is printed as what is expected"
    )
    few = 10_000 if IS_CAMPAIGN else 3_000
    parser.addoption("--fuzz", type=int, default=few, help="how many mutated sources are extracted")


def pytest_collection_finish() -> None:
    """Look for cycles as rarely as commands do: tests keep much, and hardly a cycle."""
    gc.freeze()
    gc.set_threshold(100_000, 20, 100)


#: Counts the tests that have ended in this process.
_ENDED = count(1)
#: So many tests keep little that is not needed any more.
_FEW = 750


def pytest_runtest_teardown() -> None:
    """Keep values that tests share out of collections, also of those of forked processes."""
    if next(_ENDED) % _FEW == 0:
        gc.collect()
        gc.freeze()


def pytest_unconfigure() -> None:
    gc.unfreeze()
    gc.collect()


@pytest.fixture
def update_golden(request: pytest.FixtureRequest) -> bool:
    return bool(request.config.getoption("--update-golden"))


@pytest.fixture
def fuzz(request: pytest.FixtureRequest) -> int:
    return int(request.config.getoption("--fuzz"))


@pytest.fixture
def tables(tmp_path: Path) -> Iterator[Path]:
    """Return an empty folder of tables, in the place of those of the build."""
    folder = cache.FOLDER
    cache.forget(tmp_path)
    yield tmp_path
    cache.forget(folder)


@pytest.fixture(scope="session")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    """Return a browser that shows one page after another."""
    with Browser(tmp_path_factory.mktemp("profile")) as begun:
        yield begun


_GROUPS = {
    "tests/cli/test_explain_page.py": "pages",
    "tests/cli/test_trace_document.py": "documents",
    "tests/exchange/test_saved.py": "saved",
    "tests/reasoning/test_golden_traces.py": "rules",
    "tests/reasoning/test_nodes_of_packs.py": "nodes",
    "tests/reasoning/test_rules.py": "rules",
    "tests/reasoning/test_session.py": "session",
    "tests/reasoning/questions/test_account.py": "accounts",
    "tests/reasoning/questions/test_alternatives.py": "alternatives",
    "tests/test_layers.py": "layers",
    "tests/test_mutate.py": "rules",
    "tests/test_wheel.py": "wheel",
}


class _Groups(LoadGroupScheduling):  # type: ignore[misc]
    """Tests of one group are run by one process, which computes once the data that they share.

    The groups are of modules: from pytest 9.2 on, pytest-xdist 3.8 loses the marks of tests.
    """

    def _split_scope(self, nodeid: str) -> str:
        return _GROUPS.get(nodeid.partition("::")[0], nodeid)


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Producer) -> _Groups:
    return _Groups(config, log)
