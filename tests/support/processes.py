"""The command as a process of its own, and the time that processes take."""

import multiprocessing
import os
import resource
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from tempfile import TemporaryDirectory

from mars_asp.cli.arguments import VERBS
from tests.support.documents import ROOT

#: Messages in one line, however long they are, and nothing coloured.
PLAIN = {"COLUMNS": "1000", "NO_COLOR": "1"}
#: Seconds after which a process hangs. A busy machine delays it by less.
HANGING = 120.0
#: Clock ticks in a second of `/proc/PID/stat`.
_TICKS = os.sysconf("SC_CLK_TCK")
#: Forks a process for each command, so that the package is imported once.
_SERVER = multiprocessing.get_context("forkserver")
_SERVER.set_forkserver_preload(
    ["mars_asp.__main__", "mars_asp.cli.worker", *(f"mars_asp.cli.{verb}" for verb in VERBS)]
)


def await_true(holds: Callable[[], object], waited_for: str = "") -> None:
    """Wait until something is the case, at most as long as nothing hangs."""
    until = time.monotonic() + HANGING
    while not holds():
        assert time.monotonic() < until, f"hangs: {waited_for}"
        time.sleep(0.02)


def processor_time(process: int) -> float:
    """Return the seconds of processor time that a running process has used."""
    stat = Path(f"/proc/{process}/stat").read_text(encoding="utf-8", errors="replace")
    user, system = stat.rpartition(")")[2].split()[11:13]
    return (int(user) + int(system)) / _TICKS


def processes_where(holds: Callable[[Path], bool]) -> list[int]:
    """Return the processes whose folder in `/proc` fulfils a condition."""
    found = []
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit():
            # It may end meanwhile.
            with suppress(OSError):
                if holds(entry):
                    found.append(int(entry.name))
    return found


def children_of(parent: int) -> list[int]:
    """Return the processes that a process has started."""
    return processes_where(lambda each: f"PPid:\t{parent}\n" in (each / "status").read_text())


def ended_children_time() -> float:
    """Return the seconds of processor time of the children of this process that have ended."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


@contextmanager
def takes_at_most(seconds: float) -> Iterator[None]:
    """Check the processor time of a block, in seconds of a machine that adds 30 million numbers.

    A loaded or slow machine makes the additions slow, and the block by the same factor. The load
    may change on the way, so the slower additions before and after it count.
    """
    before = _time_of_additions()
    begun = time.process_time()
    yield
    taken = time.process_time() - begun
    assert 0.1 * taken / max(before, _time_of_additions()) < seconds


def _time_of_additions() -> float:
    begun = time.process_time()
    sum(range(3_000_000))
    return time.process_time() - begun


def mars(
    *words: str, text: str | None = None, folder: Path = ROOT
) -> subprocess.CompletedProcess[str]:
    """Run a command in a process that has imported the package already."""
    with TemporaryDirectory() as beside:
        streams = [Path(beside, name) for name in ("in", "out", "err")]
        streams[0].write_text(text or "", encoding="utf-8")
        process = _SERVER.Process(target=_run, args=(words, folder, streams))
        process.start()
        process.join()
        output, errors = (
            path.read_bytes().decode("utf-8", "surrogateescape") for path in streams[1:]
        )
        assert process.exitcode is not None
        return subprocess.CompletedProcess(words, process.exitcode, output, errors)


def _run(words: tuple[str, ...], folder: Path, streams: list[Path]) -> None:
    """Replace the standard streams and run the command line."""
    os.chdir(folder)
    os.environ.update(PLAIN)
    for number, path in enumerate(streams):
        flags = os.O_WRONLY | os.O_CREAT if number else os.O_RDONLY
        os.dup2(os.open(path, flags), number)
    # As the interpreter opens them, and for the whole command.
    sys.stdin = open(0, encoding="utf-8")  # noqa: SIM115
    sys.stdout = open(1, "w", encoding="utf-8")  # noqa: SIM115
    sys.stderr = open(2, "w", encoding="utf-8", buffering=1)  # noqa: SIM115
    from mars_asp.__main__ import main

    sys.argv = ["mars-asp", *words]
    sys.exit(main())
