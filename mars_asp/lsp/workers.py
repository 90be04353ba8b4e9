"""Processes that answer questions, so that no input can hang the server or use up its memory.

Cancelling an outdated question ends its process, because grounding cannot be interrupted.
"""

import asyncio
from collections.abc import Callable
from contextlib import suppress
from typing import Any, TypeAlias

from mars_asp.asp.contained import Server
from mars_asp.lsp.questions import Failed, Question

_Worker: TypeAlias = Server[Question, Any]


class Workers:
    """The processes of a language server."""

    def __init__(self, start: Callable[[], _Worker], seconds: float, most: int) -> None:
        """Set how to start a process, the time limit of a question, and how many may be busy."""
        self._start, self._seconds = start, seconds
        self._idle: list[_Worker] = []
        self._working: set[_Worker] = set()
        self._free = asyncio.Semaphore(most)

    async def ask(self, question: Question) -> Any:
        """Return the answer to a question, or `Failed` with the reason."""
        async with self._free:
            worker = self._idle_worker()
            self._working.add(worker)
            answer = None
            try:
                # The thread that waits ends when its process ends.
                waiting = asyncio.to_thread(worker.ask, question)
                answer = await asyncio.wait_for(waiting, self._seconds)
            except TimeoutError:
                return Failed(f"it took longer than {self._seconds:g} s")
            finally:
                self._working.discard(worker)
                if answer is not None:
                    self._idle.append(worker)
                else:
                    worker.kill()
                    self.warm_up()
            if answer is None:
                return Failed("the process that worked on it ended: was memory short?")
            return answer

    def warm_up(self) -> None:
        """Start a process for the next question, unless one is idle."""
        if not self._idle:
            with suppress(OSError):
                self._idle.append(self._start())

    def end(self) -> None:
        """Kill all processes, idle or working."""
        for worker in (*self._idle, *self._working):
            worker.kill()
        self._idle.clear()

    def _idle_worker(self) -> _Worker:
        while self._idle:
            worker = self._idle.pop()
            if worker.is_running():
                return worker
        return self._start()
