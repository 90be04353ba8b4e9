"""Costs that clasp could not add up are an error at their place, before anything is solved."""

import json
from pathlib import Path

import pytest

from mars_asp.asp.solve.components import Component, GroundRule
from mars_asp.asp.solve.optimum import MOST_COST, TooCostlyError, check_costs, optimise
from mars_asp.cli import run_here
from tests.reasoning.test_verification import CHOICE, CHOSEN


def forced(*weights: int) -> Component:
    """Return a component of so many free atoms, of which all have to be chosen."""
    atoms = tuple(range(1, len(weights) + 1))
    chosen = [GroundRule(True, (atom,), ()) for atom in atoms]
    needed = [GroundRule(False, (), (-atom,)) for atom in atoms]
    costs = tuple((20, weight, atom) for atom, weight in enumerate(weights, 1))
    return Component(len(atoms), (*chosen, *needed), costs, atoms)


@pytest.mark.parametrize("weights", [(MOST_COST,), (2**30, 2**30 - 1), (1, 1, MOST_COST - 2)])
def test_the_largest_sum_is_added_up(weights: tuple[int, ...]) -> None:
    component = forced(*weights)
    check_costs(component)
    best = optimise(component)
    assert best.proven
    assert best.cost == {20: MOST_COST}
    assert best.count == 1


@pytest.mark.parametrize("weights", [(MOST_COST, 1), (2_000_000_000,) * 2, (1_500_000_000,) * 2])
def test_a_larger_sum_is_refused(weights: tuple[int, ...]) -> None:
    with pytest.raises(TooCostlyError) as caught:
        check_costs(forced(*weights))
    assert (caught.value.level, caught.value.total) == (20, sum(weights))


@pytest.mark.parametrize(
    "words", [("synthesise", "c"), ("verify", "s", "c"), ("explain", "c", "DataTransformer1")]
)
def test_conversion_costs_that_do_not_fit_stand_where_the_largest_is_stated(
    words: tuple[str, ...],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
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
