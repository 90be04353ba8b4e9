"""The line of progress appears on a terminal, and nowhere else."""

import argparse
import io
import sys

import pytest

from mars_asp.cli import progress
from tests.support.fixtures import Patch


class Terminal(io.StringIO):
    """A terminal as standard error."""

    def isatty(self) -> bool:
        return True


@pytest.fixture
def impatient(monkeypatch: Patch) -> None:
    monkeypatch.setattr(progress, "_PATIENCE", 0.0)


def wait_for(text: str) -> None:
    assert isinstance(sys.stderr, io.StringIO)
    while text not in sys.stderr.getvalue():
        pass


@pytest.mark.usefixtures("impatient")
def test_the_name_of_a_stage_is_shown_and_removed(monkeypatch: Patch) -> None:
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    with progress.stage(argparse.Namespace(quiet=False), "reading " + "x" * 100):
        wait_for("reading xxx")
    shown = terminal.getvalue().split("\r")
    assert all(len(line) <= 79 for line in shown)
    assert shown[-2:] == [" " * 79, ""]


@pytest.mark.usefixtures("impatient")
def test_a_bar_shows_the_share_of_results(monkeypatch: Patch) -> None:
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    with progress.progress_bar(argparse.Namespace(quiet=False), "components") as result:
        assert result is not None
        result(100, 200)
    assert f"[{'#' * 15}{'.' * 15}] 100 of 200 components" in terminal.getvalue()
    assert terminal.getvalue().endswith("\r")


@pytest.mark.usefixtures("impatient")
def test_files_and_quiet_commands_get_no_line(monkeypatch: Patch) -> None:
    for quiet, stream in ((False, io.StringIO()), (True, Terminal())):
        monkeypatch.setattr(sys, "stderr", stream)
        arguments = argparse.Namespace(quiet=quiet)
        with progress.stage(arguments, "reading"), progress.progress_bar(arguments, "x") as result:
            assert result is None
        assert stream.getvalue() == ""
