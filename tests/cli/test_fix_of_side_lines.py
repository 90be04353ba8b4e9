"""`check --fix` drops no gate, lock or reset line: a user decides whether it is meant."""

import json
from pathlib import Path

from mars_asp.cli import run_here
from tests.support.fixtures import Captured

BLOCKS = """
@module_start
@module_name Wheel
@Rotn_Y
void wheel();
@module_end

@module_start
@module_name Go
@ControlOut Rotn_Y
Command go();
@module_end

@module_start
@module_name Stop
@DataOut NotifyWhenReady
Bool stop(Word x);
@module_end

@module_start
@module_name Map
@Sense NotifyAtFrequency 1000
Num map();
@module_end
"""


def test_a_lock_that_is_not_fed_and_a_gate_without_effect_stay(
    tmp_path: Path, capsys: Captured
) -> None:
    file = tmp_path / "a.mars"
    lines = [
        "@configuration hierarchical",
        "@modules Wheel, Go, Stop, Map",
        "Wheel is_controlled_by Go",
        "Wheel is_locked_by Stop hold 100",
        "Map is_inhibited_by Map 1",
        "Wheel is_reset_by Map",
    ]
    file.write_text("\n".join(lines) + "\n" + BLOCKS, encoding="utf-8")
    assert run_here(["check", "--fix", str(file)]) == 1
    kept = file.read_text(encoding="utf-8").splitlines()
    assert [line for line in lines if line not in kept] == []
    capsys.readouterr()
    assert run_here(["explain", str(file), "--repair", "lock_unfed"]) == 1
    assert "let `Stop` no longer bound `Wheel`" in capsys.readouterr().out


def test_a_misspelt_input_is_spelt_anew_where_a_line_can_gate_inputs(
    tmp_path: Path, capsys: Captured
) -> None:
    """Only suppressed ports can be inputs, so for an inhibited one no input is proposed."""
    file = tmp_path / "a.mars"
    block = "@module_start\n@module_name T\n@ControlOut\nTwist turn(Map heading);\n@module_end\n"
    lines = ["@configuration hierarchical", "@modules S, T, N, B", "T.heading uses_data_from S"]
    for relation, codes in (
        ("is_suppressed_by", {"undeclared_port"}),
        ("is_inhibited_by", {"class_mismatch", "idle_gate"}),
    ):
        gate = f"T.hedding {relation} N 300"
        file.write_text("\n".join([*lines, "B is_controlled_by T", gate, block]))
        run_here(["check", "--format", "json", str(file)])
        found = json.loads(capsys.readouterr().out)["findings"]
        assert {each["kind"] for each in found} == codes
