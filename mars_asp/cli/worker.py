"""The worker: the process in which a verb works, so that no input can hang or kill the command.

Grounding cannot be interrupted, and some programs abort the process. A worker contains both: the
command waits for it, ends it at once when it is asked to end itself, and is the only one that
writes results. They cross a pipe and end with a mark, so what was ended writes nothing.

A message in the pipe is a letter, the length of what follows (eight bytes), and what follows:
`o` output, `f` a file (its name and a digest of what it replaces in a line, then its content), `g`
how many of the next files are written together or not at all, `p` a part of a file (its name in a
line, then more of its content), `w` that it is whole (its name), `c` the files whose code runs from
now on, `l` a file that grows by lines from now on (its name, how much of it stays, its size), `n` a
line of it, `e` text for standard error after the output, `.` the end (the exit status).
"""

import argparse
import gc
import os
import select
import signal
import sys
import threading
import time
from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import closing, contextmanager, suppress
from types import FrameType
from typing import NoReturn

from mars_asp.cli import deliver
from mars_asp.cli.limits import limit_memory, memory_limit, run_plain, say_memory_ended
from mars_asp.cli.progress import clear_line
from mars_asp.output import visible

#: What ends a command, and all that it started.
ENDING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT)
#: Behind the limit the worker may still say that the time is over: less than the second allowed.
_GRACE_SECONDS = 0.3


_leave = os._exit
#: The number of this process where it is a worker.
_worker: int | None = None


class Ended(BaseException):
    """A signal asks the command to end, or its time is over."""

    def __init__(self, number: int) -> None:
        super().__init__(number)
        self.number = number


def run_contained(run: Callable[[argparse.Namespace], int], arguments: argparse.Namespace) -> int:
    """Return a verb's exit status; 3 where a time or memory limit ended it."""
    # What both have in common is not written to, and so not copied, by a collection in the worker.
    gc.freeze()
    # A run makes millions of values and hardly a cycle, so it is enough to look for some rarely.
    gc.set_threshold(1_000_000, 20, 20)
    gc.enable()
    if not hasattr(os, "fork"):
        return run_plain(run, arguments)
    for stream in (sys.stdout, sys.stderr):
        stream.flush()
    results, result = os.pipe()
    watched, alive = os.pipe()
    with _held_back():
        worker = os.fork()
        if not worker:
            os.close(results)
            os.close(alive)
            _work(run, arguments, result, watched)
        os.close(result)
        os.close(watched)
    try:
        return _await(worker, results, arguments)
    finally:
        os.close(alive)


def read_standard_input(most: int = -1) -> bytes:
    """Return the content of standard input, at most so many bytes.

    A terminal is read by the group of processes in its foreground, and that is the command's.
    """
    grouped = _worker is not None and sys.stdin.isatty()
    if grouped:
        os.setpgid(0, os.getpgid(os.getppid()))
    try:
        return sys.stdin.buffer.read(most)
    finally:
        if grouped:
            os.setpgid(0, 0)


@contextmanager
def ended_by_signals() -> Iterator[None]:
    """Raise `Ended` where a signal asks the command to end."""

    def end(number: int, frame: FrameType | None) -> None:
        for other in ENDING:
            signal.signal(other, signal.SIG_IGN)
        raise Ended(number)

    before = {number: signal.getsignal(number) for number in ENDING}
    for number in ENDING:
        # Who started the command in the background asked that it goes on.
        if before[number] != signal.SIG_IGN:
            signal.signal(number, end)
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


@contextmanager
def _held_back() -> Iterator[None]:
    """Hold signals back until it is known whom they concern."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, ENDING)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


# ---- In the worker -------------------------------------------------------------------------------


def _work(
    run: Callable[[argparse.Namespace], int],
    arguments: argparse.Namespace,
    said: int,
    watched: int,
) -> NoReturn:
    """Run the verb, say what came of it, and end without what belongs to the command."""
    status = 2
    try:
        begin_group(watched)
        for number in ENDING:
            # Not Python's own handlers: they wait until clingo comes back.
            if signal.getsignal(number) != signal.SIG_IGN:
                signal.signal(number, signal.SIG_DFL)
        signal.pthread_sigmask(signal.SIG_UNBLOCK, ENDING)
        deliver.to_pipe(said)
        limit_memory(memory_limit(arguments))
        try:
            status = run_plain(run, arguments)
        except Exception as error:  # whatever it is, the worker must not end without a word
            text = f"{error!r:.300}"
            print(f"mars-asp: internal error, please report it: {text}", file=sys.stderr)
        deliver.end(status)
        sys.stderr.flush()
    finally:
        _leave(status)


def begin_group(*watched: int) -> None:
    """Make this process a worker with a group of its own, which ends when a watched pipe does."""
    global _worker  # noqa: PLW0603 -- this process is one
    _worker = os.getpid()
    os.setpgid(0, 0)
    os._exit = _stay  # type: ignore[assignment]
    threading.Thread(target=_watch, args=watched, daemon=True).start()


def leave_with(said: int, result: bytes) -> NoReturn:
    """End this worker when its result has gone through a pipe; without one it has failed."""
    with suppress(OSError):
        rest = memoryview(result)
        while rest:
            rest = rest[os.write(said, rest) :]
    _leave(int(not result))


def _stay(code: int) -> NoReturn:
    """Let code that a verb runs fail where it would end the worker; what it forked may end."""
    if os.getpid() != _worker:
        _leave(code)
    raise SystemExit(code)


def _watch(*watched: int) -> None:
    """End the whole group of the worker when one of the processes that hold the pipes is no more.

    Nothing is ever sent through them, but what may be is left for others.
    """
    ends = select.poll()
    for pipe in watched:
        ends.register(pipe, 0)
    ends.poll()
    os.killpg(0, signal.SIGKILL)


# ---- In the command ------------------------------------------------------------------------------


def _await(worker: int, results: int, arguments: argparse.Namespace) -> int:
    """Wait for the worker and deliver what it says; end it when that is asked for."""
    limit, result = arguments.time_limit, deliver.WorkerOutput()
    try:
        with ended_by_signals(), _paused_together(worker):
            if limit is not None:
                signal.signal(signal.SIGALRM, _expire)
                spent = time.monotonic() - arguments.started
                signal.setitimer(signal.ITIMER_REAL, max(0.001, limit - spent) + _GRACE_SECONDS)
            with suppress(ValueError), closing(_heard(results, worker)) as chunks:
                while result.status is None and (chunk := next(chunks, b"")):
                    result.hear(chunk)
                    if result.failed:
                        break
            if result.status is None:
                end_group(worker)
            _, status = os.waitpid(worker, 0)
            signal.setitimer(signal.ITIMER_REAL, 0)
            end_group(worker)
            if result.failed:
                return 2
            if result.status is None:
                return _broken(status, result.code, arguments)
            return result.deliver()
    except Ended as ended:
        end_group(worker)
        os.waitpid(worker, 0)
        clear_line()
        if ended.number == signal.SIGALRM:
            print(f"mars-asp: the time limit of {limit:g} s ended this", file=sys.stderr)
            return 3
        return 128 + ended.number
    finally:
        result.drop()


def _heard(results: int, worker: int) -> Generator[bytes]:
    """Yield the chunks of the pipe until it is closed or the worker has ended.

    A process that the worker began may hold the pipe open for longer. Where the system does not
    tell of an end, that process is waited for.
    """
    ended = None
    with suppress(AttributeError, OSError):
        ended = os.pidfd_open(worker)
    ready = select.poll()
    for each in (results, ended):
        if each is not None:
            ready.register(each, select.POLLIN)
    try:
        # What was sent before the end is still heard.
        while results in dict(ready.poll()) and (chunk := os.read(results, 1 << 20)):
            yield chunk
    finally:
        os.close(results)
        if ended is not None:
            os.close(ended)


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


def _expire(number: int, frame: FrameType | None) -> None:
    raise Ended(number)


def end_group(worker: int) -> None:
    """End the worker and what it started; it need not have its group yet."""
    for end in (os.killpg, os.kill):
        with suppress(ProcessLookupError, PermissionError):
            end(worker, signal.SIGKILL)


def _broken(status: int, code: Sequence[str], arguments: argparse.Namespace) -> int:
    """Report why a worker ended without its end mark; return the exit status.

    `code` are the files of others whose code it ran.
    """
    import resource

    if code:
        files = " or ".join(f"`{visible(path)}`" for path in code)
        print(f"mars-asp: the code of {files} ended the run, so it failed", file=sys.stderr)
        return 1
    most = memory_limit(arguments)
    # Where no memory is left, libraries end the process in ways of their own. They ask for much at
    # a time, so that a good part of what was allowed may be left. The unit is the system's.
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
    # No other quotient ends clingo.
    why = ": does a rule divide -2147483648 by -1?" if number == signal.SIGFPE else ""
    print(f"mars-asp: the reasoner crashed ({name}), so there is no result{why}", file=sys.stderr)
    return 2
