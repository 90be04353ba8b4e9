"""Brooks' level 1 with data: `Wander` gives a heading, and `Avoid` perturbs it by the force."""

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


class Heading(NamedTuple):
    """Where to go: degrees from ahead."""

    bearing: float


# @module_start
# @module_name Wander
# @DataOut NotifyAtFrequency 10
def wander() -> Heading:
    """Head to one side for up to two seconds at random, then ahead for five."""
    if _left[0] <= 0:
        _left[0], _left[1] = 70, _random.uniform(-60, 60)
    _left[0] -= 1
    return Heading(_left[1] if _left[0] >= 50 else 0.0)
# @module_end


# @module_start
# @module_name Avoid
# @ControlOut
def avoid(force: Force, heading: Heading) -> tuple[str, float]:
    """Turn until the sum of heading and force points ahead, else drive."""
    ahead = 2 * cos(radians(heading.bearing)) + force.strength * cos(radians(force.bearing))
    aside = 2 * sin(radians(heading.bearing)) + force.strength * sin(radians(force.bearing))
    bearing = degrees(atan2(aside, ahead))
    if abs(bearing) > 15:
        return "Rotn_Y", max(-60.0, min(60.0, 3 * bearing))
    return "Trans_Z", min(200.0, 100.0 * hypot(ahead, aside))
# @module_end
