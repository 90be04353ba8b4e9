"""Brooks' level 0, "avoid obstacles", as the modules of the paper's figure 18."""

from math import atan2, cos, degrees, hypot, inf, radians, sin
from typing import NamedTuple

from mars_asp.behaviour import Context


class SonarData(list):
    """Ranges in mm of a ring of beams; beam k looks at k * 360 / n degrees; a miss is inf."""


class SonarMap(list):
    """Polar coordinates (bearing in degrees from ahead, range in mm) of obstacles."""


class Force(NamedTuple):
    """Where obstacles push the robot: degrees from ahead, and how hard (1: at 1 m)."""

    bearing: float
    strength: float


# @module_start
# @module_name Sonar
# @Sense NotifyWhenReady
def scan() -> SonarData: ...
# @module_end


# @module_start
# @module_name SonarMap
# @DataOut NotifyWhenReady
def map_obstacles(ranges: SonarData) -> SonarMap:
    bearings = (((k * 360 / len(ranges)) + 180) % 360 - 180 for k in range(len(ranges)))
    return SonarMap((b, r) for b, r in zip(bearings, ranges) if r < inf)
# @module_end


# @module_start
# @module_name FeelForce
# @DataOut NotifyWhenReady
def feel_force(obstacles: SonarMap) -> Force:
    """Sum the repulsions, each with the square of its nearness."""
    ahead = aside = 0.0
    for bearing, distance in obstacles:
        push = (1000 / max(distance, 50)) ** 2
        ahead -= push * cos(radians(bearing))
        aside -= push * sin(radians(bearing))
    return Force(degrees(atan2(aside, ahead)), hypot(ahead, aside))
# @module_end


# @module_start
# @module_name Runaway
# @DataOut NotifyWhenReady
def run_away(force: Force) -> Force | None:
    """Hand on a force that is worth running from."""
    return force if force.strength > 1.5 else None
# @module_end


# @module_start
# @module_name Turn
# @ControlOut Rotn_Y
def turn(heading: Force) -> tuple[str, float] | None:
    """Turn towards the heading; say nothing once it is about ahead."""
    if abs(heading.bearing) < 15:
        return None
    return "Rotn_Y", max(-60.0, min(60.0, 3 * heading.bearing))
# @module_end


# @module_start
# @module_name Forward
# @ControlOut Trans_Z
def forward(heading: Force) -> tuple[str, float]:
    """Drive along the heading, as far as it points ahead."""
    return "Trans_Z", max(0.0, 250.0 * cos(radians(heading.bearing)))
# @module_end


_before = [inf]


# @module_start
# @module_name Collide
# @ControlOut Trans_Z
def collide(obstacles: SonarMap, ctx: Context) -> tuple[str, float] | None:
    """Halt while something immediately ahead comes nearer; then let the robot turn away.

    It comes nearer where it has done so by more than the parameter `closing`, in mm, since the
    last map; 12 is more than most noise. With a value below 0, such as -10000, whatever is near
    halts the robot.
    """
    ahead = min((r for bearing, r in obstacles if abs(bearing) <= 40), default=inf)
    closing = _before[0] - ahead
    _before[0] = ahead
    if ahead < 450 and closing > ctx.parameters.get("closing", 12):
        return "Trans_Z", 0.0
    return None
# @module_end


# @module_start
# @module_name MobilePlatform
# @Rotn_Y _ _ 60
# @Trans_Z _ _ 250
def drive() -> None: ...
# @module_end
