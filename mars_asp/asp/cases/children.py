"""Questions answered by forked children, several at a time, which may crash or never end."""

import os
import pickle
import resource
import selectors
import signal
import traceback
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import Generic, TypeVar

Question = TypeVar("Question")
Answer = TypeVar("Answer")

#: What a child may use of memory, in bytes.
_MEMORY = 3_000_000_000


@dataclass
class _Child(Generic[Question]):
    process: int
    pipe: int
    question: Question
    said: bytes = b""


def limit(seconds: float) -> None:
    """End this process after so many more seconds of the processor; 0 lifts the limit.

    A process that waits for what never comes ends, too, if much later.
    """
    signal.setitimer(signal.ITIMER_PROF, seconds)
    signal.setitimer(signal.ITIMER_REAL, 20 * seconds)


def ask(
    questions: Iterable[Question], answer: Callable[[Question], Answer], jobs: int
) -> Iterator[tuple[Question, Answer | None]]:
    """Yield each question with its answer as it comes; `None` from a child that did not answer.

    A child stops by `limit`, which ends it even within clingo, or by running out of memory.

    Raises:
        RuntimeError: a child failed otherwise.
    """
    waiting = iter(questions)
    selector = selectors.DefaultSelector()
    while True:
        while len(selector.get_map()) < jobs:
            question = next(waiting, None)
            if question is None:
                break
            child = _start_child(question, answer)
            selector.register(child.pipe, selectors.EVENT_READ, child)
        if not selector.get_map():
            return
        for key, _ in selector.select():
            done: _Child[Question] = key.data
            more = os.read(done.pipe, 1 << 16)
            if more:
                done.said += more
                continue
            selector.unregister(done.pipe)
            os.close(done.pipe)
            os.waitpid(done.process, 0)
            failure, found = pickle.loads(done.said) if done.said else (None, None)
            if failure is not None:
                raise RuntimeError(failure)
            yield done.question, found


def _start_child(question: Question, answer: Callable[[Question], Answer]) -> _Child[Question]:
    reading, writing = os.pipe()
    process = os.fork()
    if process:
        os.close(writing)
        return _Child(process, reading, question)
    try:
        os.close(reading)
        resource.setrlimit(resource.RLIMIT_AS, (_MEMORY, _MEMORY))
        try:
            output = pickle.dumps((None, answer(question)))
        except Exception:
            output = pickle.dumps((traceback.format_exc(), None))
        limit(0)
        with os.fdopen(writing, "wb") as pipe:
            pipe.write(output)
    finally:
        os._exit(0)
