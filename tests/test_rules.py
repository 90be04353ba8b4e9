"""The rule cases of `tests/rules`: facts and expected answer sets in one file."""

from pathlib import Path

import pytest

from mars_asp.rule_cases import Outcome, find_cases, run_case
from mars_asp.rulebook import Rulebook, load_rulebook
from tests.documents import ROOT

CASES = find_cases([ROOT / "tests" / "rules"])


@pytest.fixture(scope="module")
def rulebook() -> Rulebook:
    return load_rulebook(strict=True)


@pytest.mark.parametrize("case", CASES, ids=lambda path: f"{path.parent.name}/{path.stem}")
def test_case(case: Path, rulebook: Rulebook) -> None:
    outcome = run_case(case, rulebook)
    assert outcome.passed, "\n".join(outcome.difference())


def test_a_wrong_case_is_shown_as_a_difference() -> None:
    outcome = Outcome(Path("x.lp"), (("p(1)", "p(2)"),), (("p(1)", "p(3)"),))
    assert not outcome.passed
    assert list(outcome.difference()) == ["  - p(2)", "  + p(3)"]


def test_every_message_of_a_consequence_has_a_case(rulebook: Rulebook) -> None:
    """Each rule that derives a consequence must fire in some case: it goes when the rule does."""
    kinds = {
        str(rule.ast.head.atom.symbol.arguments[0])
        for rule in rulebook.rules
        if rule.because and rule.text.startswith("consequence(")
    }
    expected = {
        kind for case in CASES for kind in kinds if f"consequence({kind}," in case.read_text()
    }
    assert kinds - {"Kind"} - expected == set()
