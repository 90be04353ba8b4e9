"""Brooks' level 1: wander about, and avoid what is near while doing so."""

from math import atan2, cos, degrees, hypot, radians, sin
from random import Random
from typing import NamedTuple

#: The seed of the run; the executor puts its own here.
SEED = globals().get("SEED", 0)
_random = Random(f"{SEED}/wander")
_left = [0, 0.0]


class Force(NamedTuple):
    """Where obstacles push the robot: degrees from ahead, and how hard."""

    bearing: float
    strength: float


# @module_start
# @module_name Wander
# @ControlOut
def wander() -> tuple[str, float]:
    """Turn for up to two seconds at random, then drive for five."""
    if _left[0] <= 0:
        _left[0], _left[1] = 70, _random.uniform(-60, 60)
    _left[0] -= 1
    if _left[0] >= 50:
        return "Rotn_Y", _left[1]
    return "Trans_Z", 200.0
# @module_end


# @module_start
# @module_name Avoid
# @ControlOut
def avoid(force: Force) -> tuple[str, float]:
    """Drive ahead, perturbed by the force: turn until the sum of both points ahead."""
    ahead = 2 + force.strength * cos(radians(force.bearing))
    aside = force.strength * sin(radians(force.bearing))
    bearing = degrees(atan2(aside, ahead))
    if abs(bearing) > 15:
        return "Rotn_Y", max(-60.0, min(60.0, 3 * bearing))
    return "Trans_Z", min(200.0, 100.0 * hypot(ahead, aside))
# @module_end
