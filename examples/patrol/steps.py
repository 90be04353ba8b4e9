"""Step behaviours by hand: `python examples/patrol/steps.py`."""

from behaviours import Retreat, Side, steer

from mars_asp.behaviour import Command
from mars_asp.behaviour.testing import Stepper

CLEAR, NEAR = [3000.0] * 24, [400.0] + [3000.0] * 23

right = Stepper(steer, parameters={"near": 500, "rate": 60})
assert right.step(400.0, 900.0) == Command("Rotn_Y", -60)
assert right.step(900.0, 900.0) is None

retreat = Stepper(Retreat, method="step")
assert retreat.step(CLEAR, at=0.0) is None
assert retreat.step(NEAR, at=0.1) == Command("Trans_Z", -120)
assert retreat.step(CLEAR, at=1.0) == Command("Trans_Z", -120)  # a second has not passed
assert retreat.step(CLEAR, at=1.2) is None

side = Stepper(Side, parameters={"bearing": 0})
print(side.step(NEAR, at=0.0), side.step(NEAR, at=0.1))
