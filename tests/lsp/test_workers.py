"""Answers of the processes of a language server."""

import asyncio
from typing import Any, cast

import pytest

from mars_asp.asp.contained import Server
from mars_asp.lsp.questions import Failed, Question
from mars_asp.lsp.workers import Workers


class _Fixed:
    """A server with one answer; None if its process ended."""

    def __init__(self, answer: object) -> None:
        self.answer = answer

    def ask(self, question: Question) -> object:
        return self.answer

    def is_running(self) -> bool:
        return True

    def kill(self) -> None:
        pass


@pytest.mark.parametrize("answer", [(), [], "", 0, ("a repair",)])
def test_an_empty_answer_is_an_answer(answer: object) -> None:
    assert _ask(answer) == answer


def test_a_process_that_ended_is_a_failure() -> None:
    assert isinstance(_ask(None), Failed)


def _ask(answer: object) -> object:
    workers = Workers(lambda: cast("Server[Question, Any]", _Fixed(answer)), 5.0, 1)
    return asyncio.run(workers.ask(Question("survey", "a.mars", {})))
