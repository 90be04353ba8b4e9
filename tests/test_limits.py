"""The clock of a command with a time limit, and how it begins anew."""

import subprocess
import sys

import pytest

from tests.documents import ROOT

SCRIPT = """
import argparse, sys, time
from mars_asp.cli import limits

limits.GRACE_SECONDS = 0.0

def verb(arguments):
    for _ in range(2):
        time.sleep(1.2)
        if arguments.anew:
            limits.begin_clock_anew()
    return 0

arguments = argparse.Namespace(time_limit=2.0, memory_limit=None, anew=sys.argv[1:] == ["anew"])
sys.exit(limits.run_limited(verb, arguments))
"""


@pytest.mark.parametrize(("words", "status"), [(["anew"], 0), ([], 3)])
def test_what_was_found_has_the_whole_time_to_be_judged(words: list[str], status: int) -> None:
    """Together both sleeps are longer than the limit, each alone is not."""
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT, *words],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == status, done.stderr
    assert ("the time limit ended this" in done.stderr) == (status == 3)
