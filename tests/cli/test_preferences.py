"""Preferences of rule packs: they decide among equal costs, and unmet ones are printed."""

import json
from pathlib import Path

import pytest

from mars_asp.cli import run_here
from tests.support.documents import ROOT
from tests.support.fixtures import Captured

PACK = ROOT / "examples" / "packs" / "single-point-of-failure"
ROBOT = ROOT / "tests" / "preferences" / "one_converter.mars"
CONVERTER = """
@module_start
@module_name Lift
@Converts {cost}
Grid lift(Image image);
@module_end
"""


def synthesised(robot: Path, pack: Path, capsys: Captured) -> tuple[dict[str, object], str]:
    assert run_here(["synthesise", str(robot), "--rules", str(pack), "--format", "json"]) == 0
    out, err = capsys.readouterr()
    return json.loads(out), " ".join(err.split())


def test_an_unmet_preference_is_printed_with_its_cost(
    capsys: Captured,
) -> None:
    found, printed = synthesised(ROBOT, PACK, capsys)
    message = "all that `Map` gets comes through the converter `Flatten`"
    rule = "single-point-of-failure/resolve/single-point-of-failure/converter-for-all"
    assert found["preferences"] == [{"level": 8, "weight": 1, "message": message, "rule": rule}]
    assert f"{message}: 1 at level 8" in printed


@pytest.mark.parametrize(("cost", "paid"), [("", 0), ("2", 1)])
def test_a_preference_decides_among_equal_costs(
    cost: str, paid: int, tmp_path: Path, capsys: Captured
) -> None:
    robot = tmp_path / "robot.mars"
    robot.write_text(ROBOT.read_text() + CONVERTER.format(cost=cost))
    found, printed = synthesised(robot, PACK, capsys)
    assert isinstance(found["preferences"], list) and len(found["preferences"]) == paid
    assert ("at level 8" in printed) == bool(paid)


@pytest.mark.parametrize("level", ["0", "10", "30", "L"])
def test_a_level_that_is_not_below_that_of_lines_is_an_error(
    level: str, tmp_path: Path, capsys: Captured
) -> None:
    (tmp_path / "pack" / "resolve").mkdir(parents=True)
    rule = f"preference({level}, 1, few(M)) :- module(M), L = 3.\n"
    (tmp_path / "pack" / "resolve" / "mine.lp").write_text(rule)
    (tmp_path / "pack" / "pack.toml").write_text('name = "mine"\nversion = "1.0"\nneeds = []\n')
    assert run_here(["synthesise", str(ROBOT), "--rules", str(tmp_path / "pack")]) == 2
    printed = " ".join(capsys.readouterr().err.split())
    assert f"`{level}` is not a level of a preference" in printed
    assert "write a number from 1 to 9" in printed
