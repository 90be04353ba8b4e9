"""The worker: the child in which a command works, so that no input can hang or kill the command.

Grounding cannot be interrupted, and some programs abort the process. The command waits for its
worker, ends it at once when the command itself is ended, and alone writes results. Results cross a
pipe as messages (`deliver`). The last message has the exit status, so a worker that was ended
writes nothing.
"""

import argparse
import gc
import math
import os
import resource
import signal
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from types import FrameType

from mars_asp.asp import contained
from mars_asp.cli import deliver
from mars_asp.cli.limits import memory_limit, run_plain, say_memory_ended
from mars_asp.cli.progress import clear_line
from mars_asp.output import visible

#: Seconds after the time limit for the worker's own message: less than the allowed second.
_GRACE_SECONDS = 0.3


class Ended(BaseException):
    """A signal that ends the command, or the end of its time."""

    def __init__(self, number: int) -> None:
        super().__init__(number)
        self.number = number


def run_contained(run: Callable[[argparse.Namespace], int], arguments: argparse.Namespace) -> int:
    """Return the exit status of a command; 3 if a limit of time or memory ended it."""
    # A collection in the worker must not write to, and so copy, the shared memory.
    gc.freeze()
    # A run creates millions of values and hardly a cycle, so rare collections suffice.
    gc.set_threshold(1_000_000, 20, 20)
    gc.enable()
    for stream in (sys.stdout, sys.stderr):
        stream.flush()

    def work(pipe: int) -> None:
        deliver.to_pipe(pipe)
        contained.limit_memory(memory_limit(arguments))
        status = 2
        try:
            status = run_plain(run, arguments)
        except Exception as error:  # a worker must not end without a message
            text = f"{error!r:.300}"
            print(f"mars-asp: internal error, please report it: {text}", file=sys.stderr)
        deliver.end(status)
        sys.stderr.flush()

    return _await(contained.Child(work), arguments)


def read_standard_input(most: int = -1) -> bytes:
    """Return the content of standard input, at most `most` bytes.

    Only the foreground process group may read a terminal, and the command is in that group.
    """
    grouped = contained.leader is not None and sys.stdin.isatty()
    if grouped:
        os.setpgid(0, os.getpgid(os.getppid()))
    try:
        return sys.stdin.buffer.read(most)
    finally:
        if grouped:
            os.setpgid(0, 0)


@contextmanager
def ended_by_signals() -> Iterator[None]:
    """Raise `Ended` in the block if a signal ends the command."""

    def end(number: int, frame: FrameType | None) -> None:
        for other in contained.ENDING:
            signal.signal(other, signal.SIG_IGN)
        raise Ended(number)

    before = {number: signal.getsignal(number) for number in contained.ENDING}
    for number in contained.ENDING:
        # Keep ignoring signals that were ignored at start (nohup, `&`).
        if before[number] != signal.SIG_IGN:
            signal.signal(number, end)
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _await(worker: contained.Child, arguments: argparse.Namespace) -> int:
    """Wait for the worker and deliver its results; end it at a signal or the time limit."""
    limit, result = arguments.time_limit, deliver.WorkerOutput()
    if limit is not None:
        worker.until = max(time.monotonic(), arguments.started + limit) + _GRACE_SECONDS
    try:
        with ended_by_signals(), _paused_together(worker.process):
            with suppress(ValueError):
                while result.status is None and not (result.failed or worker.closed):
                    for _ in contained.wait([worker]):
                        if worker.until <= time.monotonic():
                            raise Ended(signal.SIGALRM)
                        for message in worker.read():
                            result.take(message)
            status = worker.end(_patience(worker, result))
            if result.status is not None and worker.until <= time.monotonic():
                raise Ended(signal.SIGALRM)
            if result.failed:
                return 2
            if result.status is None:
                return _broken(status, result.code, arguments)
            return result.deliver()
    except Ended as ended:
        worker.end()
        clear_line()
        if ended.number == signal.SIGALRM:
            print(f"mars-asp: the time limit of {limit:g} s ended this", file=sys.stderr)
            return 3
        return 128 + ended.number
    finally:
        result.drop()


def _patience(worker: contained.Child, result: deliver.WorkerOutput) -> float | None:
    """Return how many more seconds a worker may take to end; None without a time limit."""
    if result.status is None:
        return 0.0
    # User code may delay a worker that has sent its status.
    left = worker.until - time.monotonic()
    return None if left == math.inf else max(0.0, left)


@contextmanager
def _paused_together(worker: int) -> Iterator[None]:
    """Pause the worker while Ctrl-Z pauses the command."""

    def pause(number: int, frame: FrameType | None) -> None:
        with suppress(ProcessLookupError, PermissionError):
            os.killpg(worker, signal.SIGSTOP)
        os.kill(os.getpid(), signal.SIGSTOP)
        with suppress(ProcessLookupError, PermissionError):
            os.killpg(worker, signal.SIGCONT)

    before = signal.signal(signal.SIGTSTP, pause)
    try:
        yield
    finally:
        signal.signal(signal.SIGTSTP, before)


def _broken(status: int, code: Sequence[str], arguments: argparse.Namespace) -> int:
    """Print why a worker ended without a result; return the exit status.

    `code` are the files of the user whose code it ran.
    """
    if code:
        files = " or ".join(f"`{visible(path)}`" for path in code)
        print(f"mars-asp: the code of {files} ended the run, so it failed", file=sys.stderr)
        return 1
    most = memory_limit(arguments)
    # Without memory, libraries end the process in various ways. They allocate much at a time, so a
    # good part of the allowed memory may be unused. The unit depends on the system.
    used = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss
    megabytes = used / (1024 * 1024 if sys.platform == "darwin" else 1024)
    if most is not None and megabytes > most / 2:
        say_memory_ended(arguments)
        return 3
    if os.WIFEXITED(status):
        print(
            "mars-asp: internal error, please report it: the worker ended without a result",
            file=sys.stderr,
        )
        return 2
    number = os.WTERMSIG(status)
    if number == signal.SIGKILL:
        print("mars-asp: the system ended this; was memory short?", file=sys.stderr)
        return 3
    name = signal.Signals(number).name
    # Only this quotient ends clingo.
    why = ": does a rule divide -2147483648 by -1?" if number == signal.SIGFPE else ""
    print(f"mars-asp: the reasoner crashed ({name}), so there is no result{why}", file=sys.stderr)
    return 2
