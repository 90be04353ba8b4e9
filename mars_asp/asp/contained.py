"""Processes that are contained: none can hang, crash or outlive the process that started it.

A child leads a process group, so that it is killed with everything that it started. It watches a
pipe that the system closes when its parent ends. Values cross pipes as pickles, each after its
length (eight bytes).
"""

import os
import pickle
import resource
import select
import signal
import sys
import threading
import time
import warnings
from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from contextlib import suppress
from itertools import islice
from typing import Any, Generic, NamedTuple, NoReturn, TypeVar

Question = TypeVar("Question")
Answer = TypeVar("Answer")

#: The signals that end a command and everything that it started.
ENDING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT)
_MEGABYTE = 1 << 20
#: The memory of a child that answers a question, in megabytes.
_MEMORY = 2_861.0
_LENGTH = 8
#: Seconds within which a child ends that has closed its pipe.
_PATIENCE = 1.0
#: Seconds that one system call waits at most: it cannot count more than 24 days.
_LONGEST_WAIT = 1e6
#: Seconds between two checks of whether an answer is still wanted.
_GLANCE = 0.25

#: `os._exit` itself: in a child, code of the user cannot call it by this name.
leave = os._exit
#: The process that leads the group of a child; None outside of one.
leader: int | None = None
#: The ends of pipes between this process, its parent and its children. A child closes them, so
#: that it keeps no sibling alive and cannot write an answer of its parent.
_ends: set[int] = set()


def limit_memory(megabytes: float | None) -> None:
    """Limit the memory of this process, in megabytes."""
    if megabytes is None:
        return
    most = int(megabytes * _MEGABYTE)
    _, hard = resource.getrlimit(resource.RLIMIT_AS)
    if hard != resource.RLIM_INFINITY:
        most = min(most, hard)
    resource.setrlimit(resource.RLIMIT_AS, (most, hard))


def limit_time(seconds: float) -> None:
    """End this process after `seconds` of further CPU time; 0 removes the limit.

    A process that only waits is ended after 20 times as long.
    """
    signal.setitimer(signal.ITIMER_PROF, seconds)
    signal.setitimer(signal.ITIMER_REAL, 20 * seconds)


def send(pipe: int, value: object) -> None:
    """Send a value through a pipe."""
    raw = pickle.dumps(value)
    for part in (len(raw).to_bytes(_LENGTH, "big"), raw):
        rest = memoryview(part)
        while rest:
            rest = rest[os.write(pipe, rest) :]


def receive(pipe: int) -> Any:
    """Return the next value from a pipe, or None if the pipe was closed."""
    head = _exactly(pipe, _LENGTH)
    raw = head and _exactly(pipe, int.from_bytes(head, "big"))
    return pickle.loads(raw) if raw else None


def _exactly(pipe: int, size: int) -> bytes:
    """Return `size` bytes from a pipe, or no bytes if it was closed before."""
    result = bytearray()
    while len(result) < size:
        chunk = os.read(pipe, min(size - len(result), 1 << 20))
        if not chunk:
            return b""
        result += chunk
    return bytes(result)


# ---- In a child ----------------------------------------------------------------------------------


def _work(work: Callable[[int], object], sent: int, watched: Sequence[int]) -> NoReturn:
    """Run a child: begin a group that ends with the watched pipes, call `work`, and exit."""
    status = 1
    try:
        for end in _ends.difference(watched):
            os.close(end)
        _ends.clear()
        _ends.update((sent, *watched))
        begin_group(*watched)
        for number in ENDING:
            # Python's own handlers would wait until clingo returns.
            if signal.getsignal(number) != signal.SIG_IGN:
                signal.signal(number, signal.SIG_DFL)
        signal.pthread_sigmask(signal.SIG_UNBLOCK, ENDING)
        work(sent)
        status = 0
    finally:
        leave(status)


def begin_group(*watched: int) -> None:
    """Make this process the leader of a group that is killed when a watched pipe is closed."""
    global leader  # noqa: PLW0603 -- this process is one
    leader = os.getpid()
    os.setpgid(0, 0)
    os._exit = _raise_exit  # type: ignore[assignment]
    threading.Thread(target=_watch, args=watched, daemon=True).start()


def _raise_exit(code: int) -> NoReturn:
    """Replace `os._exit`: raise SystemExit in the leader, which user code must not end."""
    if os.getpid() != leader:
        leave(code)
    raise SystemExit(code)


def _watch(*watched: int) -> None:
    """Wait until one of the pipes is closed, then kill the group; nothing is read from them."""
    poll = select.poll()
    for pipe in watched:
        poll.register(pipe, 0)
    poll.poll()
    os.killpg(0, signal.SIGKILL)


def end_with_parent() -> None:
    """Ask the system, if it can, to kill this process when its parent ends.

    The watching thread cannot do so while the user's code holds the interpreter.
    """
    if sys.platform == "linux":
        import ctypes  # noqa: PLC0415 -- few processes need it

        with suppress(OSError, AttributeError):
            ctypes.CDLL(None).prctl(1, signal.SIGKILL)  # PR_SET_PDEATHSIG


# ---- In its parent -------------------------------------------------------------------------------


class Child:
    """A forked process that calls a function with the pipe to which it sends values."""

    def __init__(self, work: Callable[[int], object], *watched: int) -> None:
        """Fork; the child is also killed when one of the watched pipes is closed."""
        results, sent = os.pipe()
        alive, self._alive = os.pipe()
        _ends.update((results, self._alive))
        # Signals wait until the child no longer handles them as its parent does.
        before = signal.pthread_sigmask(signal.SIG_BLOCK, ENDING)
        try:
            with warnings.catch_warnings():
                # The only other thread of a child watches pipes, and holds no lock.
                warnings.simplefilter("ignore", DeprecationWarning)
                self.process = os.fork()
            if not self.process:
                _work(work, sent, (alive, *watched))
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)
        os.close(sent)
        os.close(alive)
        os.set_blocking(results, False)
        self._results = results
        self._rest = bytearray()
        #: Whether the child sends no more values: its pipe was closed, or it has ended.
        self.closed = False
        #: The moment (`time.monotonic`) at which `wait` returns the child even so.
        self.until = float("inf")
        self._ends = {results, self._alive}
        #: The pipes for which `wait` waits, with the events; of a watched one the end alone.
        self.pipes = {results: select.POLLIN, **dict.fromkeys(watched, 0)}
        # A process that the child started may hold the pipe open for longer.
        with suppress(AttributeError, OSError):
            ended = os.pidfd_open(self.process)
            self._ends.add(ended)
            self.pipes[ended] = select.POLLIN
        self._status: int | None = None
        _ends.update(self._ends)

    def read(self) -> Iterator[Any]:
        """Yield the values that have arrived; at a malformed value, end the child.

        The user's code may write anything to the pipe.
        """
        try:
            chunk = os.read(self._results, 1 << 20)
        except BlockingIOError:
            chunk = b""
        self.closed = not chunk
        rest = self._rest
        rest += chunk
        while len(rest) >= _LENGTH:
            after = _LENGTH + int.from_bytes(rest[:_LENGTH], "big")
            if len(rest) < after:
                return
            raw = bytes(rest[_LENGTH:after])
            del rest[:after]
            try:
                value = pickle.loads(raw)
            except Exception:
                self.closed = True
                return
            yield value

    def end(self, patience: float | None = 0.0) -> int:
        """Kill the child and all its processes, and return its exit status.

        Before this it has `patience` seconds to end by itself, any time if None.
        """
        until = time.monotonic() + (patience or 0.0)
        with suppress(ChildProcessError):
            while self._status is None:
                ended, status = os.waitpid(self.process, os.WNOHANG if patience is not None else 0)
                if ended:
                    self._status = status
                elif time.monotonic() < until:
                    time.sleep(0.01)
                else:
                    break
            with suppress(ProcessLookupError, PermissionError):
                os.killpg(self.process, signal.SIGKILL)
            if self._status is None:
                # It may have no group yet.
                os.kill(self.process, signal.SIGKILL)
                _, self._status = os.waitpid(self.process, 0)
        _ends.difference_update(self._ends)
        # A signal that interrupts this ends the child once more.
        while self._ends:
            os.close(self._ends.pop())
        return self._status or 0


def wait(children: Sequence[Child]) -> list[Child]:
    """Return the children that have sent something, have ended, or have no time left.

    It waits until there is one, but returns none after a long while.
    """
    poll = select.poll()
    for child in children:
        for pipe, events in child.pipes.items():
            poll.register(pipe, events)
    left = min(child.until for child in children) - time.monotonic()
    found = dict(poll.poll(1000 * min(max(0.0, left), _LONGEST_WAIT)))
    now = time.monotonic()
    return [child for child in children if child.pipes.keys() & found.keys() or child.until <= now]


class Lost(NamedTuple):
    """A child that ended without an answer: by a signal or a status, or None if time was over."""

    how: str | None


def ask(
    questions: Iterable[Question],
    answer: Callable[[Question], Answer],
    jobs: int,
    *,
    seconds: Callable[[Question], float] = lambda question: float("inf"),
    megabytes: float | None = _MEMORY,
    tries: int = 1,
    watched: Sequence[int] = (),
) -> Generator[tuple[Question, Answer | Lost]]:
    """Yield each question with its answer, in order of arrival; `jobs` children answer in parallel.

    Args:
        questions: They are read when a child is free.
        answer: Called in a child, which may also call `limit_time`.
        jobs: How many children there are at a time.
        seconds: How long a question may take.
        megabytes: The memory of each child.
        tries: How many children may be lost with one question before its time is over.
        watched: Pipes; the children are killed when one of them is closed.

    Raises:
        RuntimeError: an answer raised an exception.
    """

    def work(question: Question, sent: int) -> None:
        limit_memory(megabytes)
        try:
            value = answer(question)
            limit_time(0)
            send(sent, (None, value))
        except MemoryError:
            # The child is lost, as where a library ends it.
            raise
        except Exception:
            from traceback import format_exc  # noqa: PLC0415 -- few processes need it

            send(sent, (format_exc(), None))

    def start(question: Question, tried: int) -> None:
        child = Child(lambda sent: work(question, sent), *watched)
        child.until = time.monotonic() + seconds(question)
        busy[child] = question, tried

    waiting = iter(questions)
    busy: dict[Child, tuple[Question, int]] = {}
    try:
        while True:
            for question in islice(waiting, jobs - len(busy)):
                start(question, 1)
            if not busy:
                return
            for child in wait([*busy]):
                question, tried = busy[child]
                is_late = child.until <= time.monotonic()
                values = [] if is_late else [*child.read()]
                if not (is_late or values or child.closed):
                    continue
                # The way in which it ends by itself is reported.
                status = child.end(0.0 if is_late or values else _PATIENCE)
                del busy[child]
                if values:
                    failure, found = values[0]
                    if failure is not None:
                        raise RuntimeError(failure)
                    yield question, found
                elif not is_late and tried < tries:
                    start(question, tried + 1)
                elif is_late:
                    yield question, Lost(None)
                else:
                    code = os.waitstatus_to_exitcode(status)
                    how = f"status {code}" if code >= 0 else signal.Signals(-code).name
                    yield question, Lost(how)
    finally:
        for child in busy:
            child.end()


# ---- Processes with an interpreter of their own --------------------------------------------------


class Server(Generic[Question, Answer]):
    """A process of its own that answers questions one after another; it runs `serve`."""

    def __init__(self, module: str, function: str, greeting: object) -> None:
        """Start the process, which calls `function` of `module`; send `greeting` to it."""
        import subprocess  # noqa: PLC0415 -- few processes need it

        code = f"import sys; sys.path[:] = {sys.path!r}; from {module} import {function}"
        self._process = subprocess.Popen(
            [sys.executable, "-P", "-c", f"{code}; {function}()"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            bufsize=0,
        )
        assert self._process.stdin is not None and self._process.stdout is not None
        self._given, self._answers = self._process.stdin.fileno(), self._process.stdout.fileno()
        with suppress(BrokenPipeError):
            send(self._given, greeting)

    def ask(self, question: Question, wanted: Callable[[], bool] = lambda: True) -> Answer | None:
        """Return the answer, or None if the process ended or `wanted` returned False meanwhile."""
        answer: Answer | None = None
        with suppress(OSError, EOFError, pickle.UnpicklingError):
            send(self._given, question)
            while not (ready := select.select([self._answers], [], [], _GLANCE)[0]):
                if not wanted():
                    break
            answer = receive(self._answers) if ready else None
        if answer is None:
            self.end()
        return answer

    def is_running(self) -> bool:
        """Return whether the process has not ended."""
        return self._process.poll() is None

    def kill(self) -> None:
        """End the process; the thread that is in `ask` closes its pipes."""
        self._process.kill()

    def end(self) -> None:
        """End the process and close its pipes, from which no other thread may read."""
        self._process.kill()
        self._process.communicate()


def serve(begin: Callable[[int, Any], Callable[[Any], object]], idle: float | None = None) -> None:
    """Answer questions from standard input until it is closed, or none arrives for `idle` seconds.

    `begin` is called with the pipe of the questions and with the first value; it returns the
    function that answers.
    """
    given, answers = os.dup(0), os.dup(1)
    # Other code may read and print, but no part of the conversation.
    nowhere = os.open(os.devnull, os.O_RDWR)
    os.dup2(nowhere, 0)
    os.dup2(nowhere, 1)
    for number in ENDING:
        signal.signal(number, signal.SIG_DFL)
    _ends.update((given, answers))
    greeting = receive(given)
    if greeting is None:
        return
    answer = begin(given, greeting)
    with suppress(BrokenPipeError):
        while select.select([given], [], [], idle)[0] and (question := receive(given)) is not None:
            send(answers, answer(question))
