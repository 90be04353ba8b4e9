"""Costs that clasp could not add up are an error where the largest is stated."""

import json
from pathlib import Path

import pytest

from mars_asp.cli import run_here
from tests.reasoning.test_verification import CHOICE, CHOSEN
from tests.support.fixtures import Captured, Patch


@pytest.mark.parametrize(
    "words", [("synthesise", "c"), ("verify", "s", "c"), ("explain", "c", "DataTransformer1")]
)
def test_conversion_costs_that_do_not_fit_are_reported_at_the_largest(
    words: tuple[str, ...], tmp_path: Path, monkeypatch: Patch, capsys: Captured
) -> None:
    (tmp_path / "c.mars").write_text(CHOICE)
    (tmp_path / "s.mars").write_text(CHOSEN.format(comment=""))
    verb, *names = words
    files = [str(tmp_path / f"{name}.mars") if len(name) == 1 else name for name in names]
    assert run_here([verb, *files, "--format", "json"]) == 0
    capsys.readouterr()
    monkeypatch.setattr("mars_asp.asp.solve.optimum.MOST_COST", 4)
    assert run_here([verb, *files, "--format", "json"]) == 2
    error = json.loads(capsys.readouterr().err)
    assert error["code"] == "costs-too-large"
    assert "add up to 5" in error["message"]
    dear = CHOICE.split("\n").index("@Converts 3") + 1
    assert (error["path"], error["line"], error["column"]) == (
        files[-1 if verb == "verify" else 0],
        dear,
        1,
    )
