"""Forty questions as a new user asks them, each with its answer, which was read aloud.

Ten each ask why, why not, for alternatives and repairs, and about runs.
"""

import pytest

from tests.support.documents import ROOT, run
from tests.support.forbidden import forbidden_in

CASES = ROOT / "tests" / "questions" / "questions.txt"
QUESTIONS = [
    (command.strip(), expected)
    for command, _, expected in (
        each.partition("\n") for each in f"\n{CASES.read_text(encoding='utf-8')}".split("\n$ ")[1:]
    )
]


@pytest.mark.parametrize(("command", "expected"), QUESTIONS, ids=[each for each, _ in QUESTIONS])
def test_the_answer(command: str, expected: str, update_golden: bool) -> None:
    found = run(command)
    if update_golden:
        text = CASES.read_text(encoding="utf-8")
        CASES.write_text(text.replace(f"{command}\n{expected}", f"{command}\n{found.strip()}\n\n"))
        return
    assert found.strip() == expected.strip()
    # A rule's name alone on a line is what did not fit beside its sentence.
    told = [each for each in forbidden_in(found) if "only a reference" not in each]
    assert told == []
