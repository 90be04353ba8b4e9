"""Numbers in the rules of packs and in our own that do not fit into 32 bits."""

from pathlib import Path

import pytest

from mars_asp.asp.lint.arithmetic import risks
from mars_asp.asp.lint.clauses import clauses_of
from mars_asp.cli import run_here
from mars_asp.reasoning.facts.vocabulary import unbounded
from tests.mutate.rules import built_in
from tests.support.fixtures import Captured, Patch


@pytest.fixture(autouse=True)
def wide(monkeypatch: Patch) -> None:
    """Print each message in one line."""
    monkeypatch.setenv("COLUMNS", "1000")


@pytest.mark.parametrize("words", ["analyse", "check", "synthesise", "explain big(Camera)"])
def test_a_pack_with_a_number_that_does_not_fit_is_bad_input(
    words: str, tmp_path: Path, capsys: Captured
) -> None:
    robot, pack = tmp_path / "robot.mars", tmp_path / "big.lp"
    robot.write_text("@configuration\n@modules Camera\n", encoding="utf-8")
    pack.write_text('consequence(big, note, "Camera", 2147483647+1).\n', encoding="utf-8")
    verb, *subject = words.split()
    assert run_here([verb, str(robot), *subject, "--rules", str(pack)]) == 2
    output = "".join(capsys.readouterr())
    assert f"{pack}:1:34: error: `2147483647+1` does not fit" in output


def test_lint_tells_risks_and_is_content(tmp_path: Path, capsys: Captured) -> None:
    pack = tmp_path / "risk.lp"
    pack.write_text("late(R, H + 1) :- hold(R, H).\n", encoding="utf-8")
    assert run_here(["rules", "lint", str(pack)]) == 0
    assert f"{pack}:1:9: warning: `H + 1` may not fit" in capsys.readouterr().err


def test_our_own_rules_compute_nothing_that_may_not_fit() -> None:
    rulebook = built_in()
    large = unbounded(rulebook.declarations.values())
    found = [each.diagnostic for each in risks(clauses_of(rulebook.rules).values(), large)]
    assert [f"{each.span.path}:{each.span.line}: {each.message}" for each in found] == []
