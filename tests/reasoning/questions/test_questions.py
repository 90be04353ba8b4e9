"""Forty questions of new users, each with its expected answer.

Ten each are about reasons, absences, alternatives with repairs, and runs.
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
