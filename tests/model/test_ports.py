"""Positions of the inputs of modules that nothing describes."""

from pathlib import Path

import pytest

from mars_asp.cli.folding import natural_order
from mars_asp.model.ports import free_positions, input_position
from tests.support.processes import mars

CONFIGURATION = """\
@configuration
@modules A, B, Ctl, Log
Log uses_data_from B
Ctl uses_data_from A
Ctl uses_data_from B
"""
SPECIFICATION = """\
@specification
@modules A, B, Ctl, Log, DataSplitter1
DataSplitter1 uses_data_from B
Log uses_data_from DataSplitter1
Ctl.input2 uses_data_from DataSplitter1
Ctl.input1 uses_data_from A
"""


@pytest.mark.parametrize(
    ("port", "position"),
    [
        ("input1", 1),
        ("input999999999", 999_999_999),
        ("input0", None),
        ("input01", None),
        ("input2147483648", None),
        ("input" + "9" * 5000, None),
        ("left", None),
    ],
)
def test_a_position_fits_the_integers_of_rules(port: str, position: int | None) -> None:
    assert input_position(port) == position


def test_free_positions_leave_out_those_that_ports_state() -> None:
    free = free_positions(["input2", None, "left", None, "input3"])
    assert [next(free), next(free)] == [1, 4]


def test_a_line_of_a_logger_keeps_the_inputs_of_a_controller(tmp_path: Path) -> None:
    (tmp_path / "robot.mars").write_text(CONFIGURATION)
    done = mars("synthesise", str(tmp_path / "robot.mars"))
    assert done.stdout == SPECIFICATION
    (tmp_path / "spec.mars").write_text(SPECIFICATION)
    assert mars("verify", str(tmp_path / "spec.mars"), str(tmp_path / "robot.mars")).returncode == 0


@pytest.mark.parametrize("number", ["1", "3", "4294967298", "9" * 5000])
def test_another_position_is_a_violation(number: str, tmp_path: Path) -> None:
    """2 ** 32 + 2 would be 2 in clingo's integers."""
    (tmp_path / "robot.mars").write_text(CONFIGURATION)
    changed = SPECIFICATION.replace("input2", f"input{number}").replace("input1 ", "input7 ")
    (tmp_path / "spec.mars").write_text(changed)
    done = mars("verify", str(tmp_path / "spec.mars"), str(tmp_path / "robot.mars"))
    assert (done.returncode, done.stderr) == (1, "")


def test_names_are_in_natural_order_however_long_their_numbers_are() -> None:
    names = ["robot10", "robot2", "robot" + "9" * 5000, "robot02"]
    assert sorted(names, key=natural_order) == ["robot02", "robot2", "robot10", names[2]]
