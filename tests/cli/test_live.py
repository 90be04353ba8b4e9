"""The line that shows a run while it goes on: on a terminal, and nowhere else."""

import os
import re
import subprocess
import sys

import pytest

from tests.support.documents import ROOT

WORDS = ["run", "examples/level0/config.mars", "--scenario", "examples/level0/scenario.toml"]
COMMAND = [sys.executable, "-m", "mars_asp", *WORDS, "--duration", "5"]


def on_a_terminal(columns: int, *words: str) -> str:
    """Run in the root of the project; return the output on a terminal for standard error."""
    import fcntl
    import pty
    import struct
    import termios

    ours, theirs = pty.openpty()
    fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
    with subprocess.Popen(
        [*COMMAND, *words], cwd=ROOT, stdout=subprocess.DEVNULL, stderr=theirs
    ) as process:
        os.close(theirs)
        written = b""
        while True:
            try:
                part = os.read(ours, 4096)
            except OSError:  # the other end is closed
                break
            if not part:
                break
            written += part
        os.close(ours)
    assert process.returncode == 0
    return written.decode()


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no pseudo-terminals of this kind")
def test_a_terminal_shows_time_speed_control_clearance_and_drops() -> None:
    written = on_a_terminal(120)
    first = next(line for line in written.split("\r") if line.strip())
    shown = re.fullmatch(
        r" +0\.5 of 5 s +\d+x  least clearance +722 mm  dropped 0  in control: Turn *", first
    )
    assert shown, first
    # It is gone at the end, and no newline has moved it up.
    assert written.endswith("\r" + " " * 119 + "\r")
    assert "\n" not in written


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no pseudo-terminals of this kind")
def test_a_line_never_reaches_the_last_column() -> None:
    assert {len(line) for line in on_a_terminal(40).split("\r")} <= {0, 39}


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no pseudo-terminals of this kind")
def test_quiet_shows_no_line_on_a_terminal() -> None:
    assert on_a_terminal(80, "--quiet") == ""


def test_only_a_terminal_gets_a_live_line() -> None:
    done = subprocess.run(COMMAND, cwd=ROOT, capture_output=True, text=True, check=True)
    assert done.stderr == ""
    assert "in control:" not in done.stdout
    assert "\r" not in done.stdout
