"""A round robot: exact arcs, and contact found wherever on the way it happens."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import cos, degrees, hypot, inf, radians, sin

from mars_asp.execution.simulator.world import World

#: Nearer than this (mm) is contact.
TOUCH = 1e-3


@dataclass(frozen=True, slots=True)
class Pose:
    """Position in mm and heading in degrees."""

    forward: float
    side: float
    heading: float


def move(pose: Pose, ahead: float, aside: float, turn: float, seconds: float) -> Pose:
    """Return the pose after a constant twist: mm/s ahead and aside, degrees/s.

    The closed form of the planar exponential map: arcs are exact for any length of step.
    """
    angle = radians(turn) * seconds
    heading = radians(pose.heading)
    if abs(angle) < 1e-6:
        sine, rest = 1.0 - angle * angle / 6, angle / 2
    else:
        sine, rest = sin(angle) / angle, (1.0 - cos(angle)) / angle
    x = (sine * ahead - rest * aside) * seconds
    y = (rest * ahead + sine * aside) * seconds
    return Pose(
        pose.forward + cos(heading) * x - sin(heading) * y,
        pose.side + sin(heading) * x + cos(heading) * y,
        pose.heading + degrees(angle),
    )


def planar_functions(up: str) -> tuple[str, str, str]:
    """Return the functions that drive ahead, aside and turn, with `y` or `z` up."""
    return ("Trans_Z", "Trans_X", "Rotn_Y") if up == "y" else ("Trans_X", "Trans_Y", "Rotn_Z")


@dataclass(slots=True)
class Body:
    """A disc of `radius` mm in a world, moving as it was last commanded.

    `limits` are the greatest rates by function. What happened is kept: the least clearance
    and when it was first reached, collisions (new contacts), the distance driven and seconds of
    turning and driving at once.
    """

    world: World
    pose: Pose
    radius: float
    up: str = "y"
    limits: Mapping[str, float] = field(default_factory=dict)
    command: dict[str, float] = field(default_factory=dict)
    seconds: float = 0.0
    touching: bool = False
    collisions: int = 0
    clearance: float = inf
    nearest_at: float = 0.0
    driven: float = 0.0
    both: float = 0.0
    track: list[tuple[float, Pose]] = field(default_factory=list)
    contacts: list[float] = field(default_factory=list)

    def __post_init__(self) -> None:
        """Note where it starts."""
        self.track.append((self.seconds, self.pose))

    @property
    def way(self) -> list[tuple[float, Pose]]:
        """Return where it was at times (s) no more than 0.1 s apart, up to now."""
        return [*self.track, (self.seconds, self.pose)]

    def obey(self, command: Mapping[str, float], seconds: float) -> None:
        """Move on to a time, then take a command; functions that it does not name are zero."""
        self.advance(seconds)
        self.command = dict(command)

    def rates(self) -> tuple[float, float, float]:
        """Return the rates ahead, aside and turning, within the limits."""
        wanted = [self._limited(function) for function in planar_functions(self.up)]
        return wanted[0], wanted[1], wanted[2]

    def _limited(self, function: str) -> float:
        most = self.limits.get(function, inf)
        return max(-most, min(most, self.command.get(function, 0.0)))

    def advance(self, seconds: float) -> None:
        """Move on to a time (s) by conservative advancement.

        No point of the disc moves faster than its centre, so the gap divided by the closing
        speed is a time in which nothing can be touched, however long the step. A contact ends
        the motion of the step unless the motion leads away.
        """
        ahead, aside, turn = self.rates()
        speed = hypot(ahead, aside)
        closing = speed + self.world.fastest
        while self.seconds < seconds:
            gap = self._gap(self.pose, self.seconds)
            self._note(gap)
            step = min(seconds - self.seconds, 0.1)
            if gap > TOUCH and closing:
                # Half of the tolerance on top lets the last step reach the contact.
                step = min(step, (gap + TOUCH / 2) / closing)
            elif closing:
                step = min(step, 0.005)
            after = move(self.pose, ahead, aside, turn, step)
            at = self.seconds + step
            if gap <= TOUCH and self._gap(after, at) < min(gap, 0.0) + 1e-9:
                after = Pose(self.pose.forward, self.pose.side, after.heading)
            self._take(after, at, bool(speed and turn))
        self._note(self._gap(self.pose, self.seconds))

    def _gap(self, pose: Pose, seconds: float) -> float:
        return self.world.distance((pose.forward, pose.side), seconds) - self.radius

    def _note(self, gap: float) -> None:
        if max(gap, 0.0) < self.clearance:
            self.clearance, self.nearest_at = max(gap, 0.0), self.seconds
        touching = gap <= TOUCH
        if touching and not self.touching:
            self.collisions += 1
            self.contacts.append(self.seconds)
        # A hair's breadth of hysteresis: one contact is not counted again at each step.
        self.touching = touching or (self.touching and gap <= 10 * TOUCH)

    def _take(self, pose: Pose, at: float, both: bool) -> None:
        self.driven += hypot(pose.forward - self.pose.forward, pose.side - self.pose.side)
        self.both += (at - self.seconds) * both
        self.pose, self.seconds = pose, at
        if at - self.track[-1][0] >= 0.05:
            self.track.append((at, pose))
