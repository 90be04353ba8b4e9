"""Forty questions as a new user asks them, each with its answer, which was read aloud.

Ten each ask why, why not, for alternatives and repairs, and about runs.
"""

import pytest

from tests.support.documents import ROOT, answered, questions
from tests.support.forbidden import forbidden_in

CASES = ROOT / "tests" / "questions" / "questions.txt"
QUESTIONS = questions(CASES)


@pytest.mark.parametrize(("command", "expected"), QUESTIONS, ids=[each for each, _ in QUESTIONS])
def test_the_answer(command: str, expected: str, update_golden: bool) -> None:
    found = answered(CASES, command, expected, update_golden)
    assert list(forbidden_in(found)) == []
