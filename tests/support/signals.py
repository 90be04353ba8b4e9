"""Commands that are ended at random moments: `python -m tests.support.signals [NUMBER] [SEED]`.

Each is ended by a signal, by this program within a second, leaves no process, no torn file and no
late one. A loop of a shell represents programs that start command after command.
"""

import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import NamedTuple

from tests.support.documents import ROOT
from tests.support.processes import HANGING, processes_where, processor_time

MARS = (sys.executable, "-m", "mars_asp")
LEVEL1 = "examples/level1/config.mars"
RUN = ("run", LEVEL1, "--scenario", "examples/level1/scenario.toml", "--duration", "5")
SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGKILL)
_MARKER = "MARS_ASP_ENDED_BY_TEST"
#: Seconds within which everything has ended.
_SOON = 1.0
#: Seconds of processor time that a process uses at most which its command has left and that ends.
_ENDING = 0.3


class Command(NamedTuple):
    """Words of a command, the option that names its output if it writes one, and its seconds."""

    words: Sequence[str]
    option: str | None
    seconds: float


COMMANDS = {
    "analyse": Command(("analyse", LEVEL1), None, 0.6),
    "synthesise": Command(("synthesise", LEVEL1), "-o", 1.0),
    "explain": Command(("explain", LEVEL1), None, 1.2),
    "run": Command(RUN, "--record", 2.0),
    "loop": Command(("synthesise", LEVEL1), "-o", 3.0),
}


def end_at_random(seed: int, soon: float = HANGING) -> list[str]:
    """Start a command, end it at a random moment, and return the faults.

    All its processes have to end within `soon` seconds; a busy machine needs the default.
    """
    rng = random.Random(seed)
    name, command = rng.choice(sorted(COMMANDS.items()))
    number = rng.choice(SIGNALS)
    after = rng.uniform(0, command.seconds)
    marker = f"{os.getpid()}-{seed}"
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / f"out{_suffix(command)}"
        written = [*command.words, command.option, str(out)] if command.option else command.words
        words: Sequence[str] = [*MARS, *written]
        if name == "loop":
            words = ["/bin/sh", "-c", f"while {' '.join(words)}; do :; done"]
        child = subprocess.Popen(
            words,
            cwd=ROOT,
            env={**os.environ, _MARKER: marker},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            start_new_session=True,
        )
        time.sleep(after)
        sent = time.monotonic()
        # What a terminal or a supervisor ends is a group: that of a loop is the shell's.
        if name == "loop":
            os.killpg(child.pid, number)
        else:
            child.send_signal(number)
        wrong = []
        try:
            _, result = child.communicate(timeout=HANGING)
        except subprocess.TimeoutExpired:
            child.kill()
            return [f"seed {seed}: {name} goes on after {number.name}"]
        if time.monotonic() - sent > soon:
            wrong.append(f"took {time.monotonic() - sent:.1f} s to end")
        # Until it runs our `main` Python itself tells that it was interrupted.
        if b"Traceback" in result and b"in main" in result:
            wrong.append(f"said {result.decode(errors='replace')}")
        before = out.read_bytes() if out.exists() else None
        first = left = _left(marker)
        while left and time.monotonic() - sent < soon:
            time.sleep(0.02)
            if any(used > first.get(each, 0) + _ENDING for each, used in left.items()):
                break
            left = _left(marker)
        if left:
            wrong.append("left a process")
        now = out.read_bytes() if out.exists() else None
        if now != before:
            wrong.append("wrote a file late")
        if now is not None and now != _expected(name):
            wrong.append("left a torn file")
        others = [path.name for path in Path(folder).iterdir() if path != out]
        if others and number != signal.SIGKILL:
            wrong.append(f"left {others}")
    return [f"seed {seed}: {name}, {number.name} after {after:.2f} s: {each}" for each in wrong]


def _suffix(command: Command) -> str:
    return {"-o": ".mars", "--record": ".jsonl"}.get(command.option or "", "")


@cache
def _expected(name: str) -> bytes:
    command = COMMANDS[name]
    assert command.option is not None
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / f"out{_suffix(command)}"
        words = [*MARS, *command.words, command.option, str(out)]
        subprocess.run(words, cwd=ROOT, check=False, capture_output=True)
        return out.read_bytes()


def _left(marker: str) -> dict[int, float]:
    """Return the processes that were started with a marker, and the processor time of each."""
    wanted = f"{_MARKER}={marker}".encode()
    found = {}
    for each in processes_where(lambda e: wanted in (e / "environ").read_bytes().split(b"\0")):
        with suppress(OSError):
            found[each] = processor_time(each)
    return found


def main() -> int:
    """End as many commands as the command line states, from its seed."""
    number, first = [*map(int, sys.argv[1:]), *(200, 0)[len(sys.argv) - 1 :]][:2]
    wrong = [each for seed in range(first, first + number) for each in end_at_random(seed, _SOON)]
    print("\n".join([*wrong, f"{number} commands ended, {len(wrong)} faults"]))
    return int(bool(wrong))


if __name__ == "__main__":
    sys.exit(main())
