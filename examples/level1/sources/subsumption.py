"""Brooks' levels 0 and 1 as figures 17 and 20 draw them, with suppression and resets.

`Turn` takes a heading, turns by its angle, hands on the distance and waits; `Forward` drives that
distance or halts, and resets `Turn`. A heading that arrives in the meantime is lost.
`Avoid` replaces the headings of `Runaway`.
Rates and thresholds are those of `level0.py` and `brooks.py`.
"""

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


class Heading(NamedTuple):
    """A turn in degrees, and the mm to drive after it."""

    bearing: float
    distance: float


class Leg(NamedTuple):
    """A distance to drive ahead in mm, and its number in the run."""

    number: int
    distance: float


class Halt(NamedTuple):
    """Whether a collision is imminent."""

    due: bool


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
def run_away(force: Force) -> Heading | None:
    """Head where a force pushes that is worth running from."""
    return Heading(force.bearing, 250.0) if force.strength > 1.5 else None
# @module_end


# @module_start
# @module_name Collide
# @DataOut NotifyWhenReady
def collide(obstacles: SonarMap) -> Halt:
    """Return whether something immediately ahead is near."""
    return Halt(any(abs(bearing) <= 40 and distance < 450 for bearing, distance in obstacles))
# @module_end


class Turn:
    """Turn by the angle of one heading, hand on its distance, and wait for the reset."""

    def __init__(self) -> None:
        self.heading: Heading | None = None
        self.angle = self.rate = 0.0
        self.waits = False
        self.number = 0

    # @module_start
    # @module_name Turn
    # @ControlOut Rotn_Y
    def turn(self, heading: Heading, ctx: Context) -> tuple[str, float] | None:
        """Turn until 15 degrees are left; headings only tell the time during the turn."""
        if self.waits:
            return None
        if self.heading is None or ctx.dt > 0.25:  # The last command has run out: begin anew.
            self.heading, self.angle = heading, heading.bearing
        else:
            self.angle -= self.rate * ctx.dt
        if abs(self.angle) < 15:
            self.waits = True
            return None
        self.rate = max(-60.0, min(60.0, 3 * self.angle))
        return "Rotn_Y", self.rate

    # @Done
    def arrived(self) -> Leg | None:
        """Hand on the distance once the turn is complete."""
        if not self.waits or self.heading is None:
            return None
        distance, self.heading = self.heading.distance, None
        self.number += 1
        return Leg(self.number, distance)

    # @Reset
    def reset(self) -> None:
        """Be ready for the next heading."""
        self.waits = False
    # @module_end


class Forward:
    """Drive a distance at `speed`, and halt where a collision is imminent."""

    def __init__(self, speed: float = 250.0) -> None:
        self.speed = speed
        self.leg = Leg(0, 0.0)
        self.until = 0.0
        self.drives = self.ended = False

    # @module_start
    # @module_name Forward
    # @ControlOut Trans_Z
    def forward(self, heading: Leg, halt: Halt, ctx: Context) -> tuple[str, float] | None:
        """Drive until the distance is covered or a halt arrives."""
        if heading.number != self.leg.number:
            self.leg, self.drives = heading, True
            self.until = ctx.now + heading.distance / self.speed
        if not self.drives:
            return None
        if halt.due or ctx.now >= self.until:
            self.drives, self.ended = False, True
            return "Trans_Z", 0.0
        return "Trans_Z", self.speed

    # @Done
    def moved(self) -> Leg | None:
        """Report the leg once it has ended."""
        ended, self.ended = self.ended, False
        return self.leg if ended else None
    # @module_end


#: What is left of a wander, in tenths of a second, and where it heads.
_left = [0, 0.0]


# @module_start
# @module_name Wander
# @DataOut NotifyAtFrequency 10
def wander(ctx: Context) -> Heading:
    """Head to one side for up to two seconds at random, then ahead for five."""
    if _left[0] <= 0:
        _left[0], _left[1] = 70, ctx.random.uniform(-60, 60)
    _left[0] -= 1
    return Heading(_left[1] if _left[0] >= 50 else 0.0, 100.0)
# @module_end


# @module_start
# @module_name Avoid
# @DataOut NotifyWhenReady
def avoid(wish: Heading, force: Force) -> Heading:
    """Perturb the heading of `Wander` by the force."""
    ahead = 2 * cos(radians(wish.bearing)) + force.strength * cos(radians(force.bearing))
    aside = 2 * sin(radians(wish.bearing)) + force.strength * sin(radians(force.bearing))
    return Heading(degrees(atan2(aside, ahead)), min(200.0, 100.0 * hypot(ahead, aside)))
# @module_end


# @module_start
# @module_name MobilePlatform
# @Rotn_Y _ _ 60
# @Trans_Z _ _ 250
def drive() -> None: ...
# @module_end
