"""Processes that answer questions, so that no input can hang the server or take its memory.

A question that is wanted no more is cancelled, which ends its process: grounding cannot be
interrupted. Each way a pickle crosses a pipe after its length (eight bytes).
"""

import asyncio
import os
import pickle
import subprocess
from collections.abc import Sequence
from contextlib import suppress
from typing import Any

from mars_asp.lsp.questions import Failed, Question

LENGTH = 8


class Workers:
    """The processes of a server, started by a command; the first that they hear is a greeting."""

    def __init__(self, command: Sequence[str], greeting: bytes, seconds: float, most: int) -> None:
        """Take how they are started, how long an answer may take, and how many work at a time."""
        self._command, self._greeting, self._seconds = command, greeting, seconds
        self._idle: list[subprocess.Popen[bytes]] = []
        self._working: set[subprocess.Popen[bytes]] = set()
        self._free = asyncio.Semaphore(most)

    async def ask(self, question: Question) -> Any:
        """Return the answer to a question, or why there is none."""
        async with self._free:
            process = self._taken()
            self._working.add(process)
            answer = None
            try:
                # A thread waits, and does so no longer when its process ends.
                waiting = asyncio.to_thread(_answered, process, question)
                answer = await asyncio.wait_for(waiting, self._seconds)
            except TimeoutError:
                return Failed(f"it took longer than {self._seconds:g} s")
            finally:
                self._working.discard(process)
                if answer is not None:
                    self._idle.append(process)
                else:
                    # The thread that reads from it hears its end, and is the one to close it.
                    process.kill()
                    self.warm_up()
            return answer or Failed("the process that worked on it ended: was memory short?")

    def warm_up(self) -> None:
        """Start a process for the next question, if none waits for it."""
        if not self._idle:
            with suppress(OSError):
                self._idle.append(self._started())

    def end(self) -> None:
        """End all processes."""
        for process in (*self._idle, *self._working):
            process.kill()
        self._idle.clear()

    def _taken(self) -> subprocess.Popen[bytes]:
        while self._idle:
            process = self._idle.pop()
            if process.poll() is None:
                return process
        return self._started()

    def _started(self) -> subprocess.Popen[bytes]:
        process = subprocess.Popen(
            self._command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, bufsize=0
        )
        assert process.stdin is not None
        with suppress(BrokenPipeError):
            # It is small, so no pipe is too full for it.
            _send(process.stdin.fileno(), self._greeting)
        return process


def _answered(process: subprocess.Popen[bytes], question: Question) -> Any:
    """Return the answer of a process, or None if it ended."""
    assert process.stdin is not None and process.stdout is not None
    answer = None
    with suppress(OSError):
        write_pickle(process.stdin.fileno(), question)
        answer = read_pickle(process.stdout.fileno())
    if answer is None:
        process.kill()
        # No other thread may read from what these numbers are given to next.
        process.communicate()
    return answer


def _send(pipe: int, payload: bytes) -> None:
    rest = memoryview(len(payload).to_bytes(LENGTH, "big") + payload)
    while rest:
        rest = rest[os.write(pipe, rest) :]


def read_pickle(pipe: int) -> Any:
    """Return the next value that crosses a pipe, or None if it was closed."""
    head = _exactly(pipe, LENGTH)
    whole = None if head is None else _exactly(pipe, int.from_bytes(head, "big"))
    return None if whole is None else pickle.loads(whole)


def write_pickle(pipe: int, value: Any) -> None:
    """Send a value through a pipe."""
    _send(pipe, pickle.dumps(value))


def _exactly(pipe: int, size: int) -> bytes | None:
    found = bytearray()
    while len(found) < size:
        chunk = os.read(pipe, min(size - len(found), 1 << 20))
        if not chunk:
            return None
        found += chunk
    return bytes(found)
