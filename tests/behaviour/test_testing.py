"""Stepping behaviours by hand gives the results of a run."""

from pathlib import Path

import pytest

from mars_asp.behaviour import Command, Context
from mars_asp.behaviour.testing import Stepper
from tests.support.trials import BASE, trial


class Swing:
    def __init__(self, most: float) -> None:
        self.most, self.count = most, 0

    def __call__(self, ctx: Context) -> Command:
        self.count += 1
        return Command("Trans_Z", self.count + ctx.dt + self.most * ctx.random.random())


SWING = """
from tests.behaviour.test_testing import Swing
"""


def test_steps_are_those_of_a_run(tmp_path: Path) -> None:
    (tmp_path / "b.py").write_text(SWING)
    binding = '[bindings.C]\npython = "b.py:Swing"\nperiod = 100\nparameters = { most = 50 }\n'
    made = trial(f"seed = 5\n{BASE}{binding}", folder=tmp_path)
    ran = [command["Trans_Z"] for _, _, command in made.executor.effectors["P"].applied]
    stepper = Stepper(Swing, parameters={"most": 50}, seed=5, module="C")
    stepped = [stepper.command(at=k / 10) for k in range(len(ran))]
    assert stepped == [Command("Trans_Z", rate) for rate in ran]
    assert len(set(ran)) == len(ran) == 31


def test_a_stepper_copies_and_keeps_time() -> None:
    kept: list[list[int]] = []

    def keep(values: list[int], ctx: Context) -> list[list[int]]:
        values.append(round(ctx.dt * 10))
        kept.append(values)
        return kept

    stepper, given = Stepper(keep), [1]
    first = stepper.step(given, at=1.0)
    assert stepper.step(given, at=1.5) == [[1, 0], [1, 5]]
    assert (given, first) == ([1], [[1, 0]])
    with pytest.raises(ValueError, match=r"the step at 1 s comes after one at 1.5 s"):
        stepper.step(given, at=1.0)


def test_a_stepper_checks_commands() -> None:
    assert Stepper(lambda x: x).command(None) is None
    assert Stepper(lambda x: x).command({"Grasp": 3}) == Command("Grasp", 3)
    with pytest.raises(ValueError, match="a controller returns one"):
        Stepper(lambda x: x).command(3)
