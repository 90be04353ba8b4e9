"""Devices of a robot; each returns a function that reads it at a time in seconds.

Noise comes from the generator that a device is given, so devices do not disturb one another.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from math import atan2, cos, degrees, hypot, inf, isfinite, radians, sin
from random import Random
from typing import TypeAlias

import numpy as np

from mars_asp.execution.simulator.body import Body
from mars_asp.execution.simulator.motion import Floats, Pose

#: From a time in seconds to where a device is; the body has moved on to that time.
Place: TypeAlias = Callable[[float], Pose]


@dataclass(slots=True)
class JointDevice:
    """A joint or gripper: obeys rates (degrees/s or mm/s), or a width, within its bounds."""

    function: str
    low: float = -inf
    high: float = inf
    rate: float = inf
    value: float = 0.0
    wanted: float = 0.0
    seconds: float = 0.0
    #: From when until when (s) it moved.
    moved: list[tuple[float, float]] = field(default_factory=list, init=False)

    def obey(self, command: dict[str, float], seconds: float) -> None:
        """Move on to a time, then take a command; a width that is not named stays."""
        self.advance(seconds)
        resting = self.wanted if self.function == "Grasp" else 0.0
        self.wanted = command.get(self.function, resting)

    def advance(self, seconds: float) -> float:
        """Return the angle, way or width at a time."""
        step, self.seconds = seconds - self.seconds, seconds
        rate = self.wanted
        if self.function == "Grasp":
            rate = (self.wanted - self.value) / step if step > 0 else 0.0
        rate = max(-self.rate, min(self.rate, rate))
        before = self.value
        self.value = max(self.low, min(self.high, before + rate * step))
        if self.value != before:
            began = seconds - step
            pace = self.rate if self.function == "Grasp" else abs(rate)
            ended = min(seconds, began + abs(self.value - before) / pace)
            if self.moved and self.moved[-1][1] == began:
                began, _ = self.moved.pop()
            self.moved.append((began, ended))
        return self.value


def mounted(
    body: Body, links: Sequence[tuple[float, float, float, JointDevice | None]] = ()
) -> Place:
    """Return where a device is: links (forward, side, turn, joint) from the body outwards."""

    def place(seconds: float) -> Pose:
        body.advance(seconds)
        pose = body.pose
        for forward, side, turn, joint in links:
            heading = radians(pose.heading)
            turned = 0.0 if joint is None else joint.advance(seconds)
            pose = Pose(
                pose.forward + cos(heading) * forward - sin(heading) * side,
                pose.side + sin(heading) * forward + cos(heading) * side,
                pose.heading + turn + turned,
            )
        return pose

    return place


def sonar(
    body: Body,
    place: Place,
    noise: Random,
    *,
    beams: int = 24,
    cone: float = 15.0,
    rays: int = 3,
    reach: float = 3000.0,
    sigma: float = 0.0,
) -> Callable[[float], list[float]]:
    """Return a ring's reading: beam k looks at k * 360 / beams degrees; a miss is inf.

    A cone's range is the least over `rays` sub-rays spread over it.
    """
    spread = np.linspace(-cone / 2, cone / 2, rays) if rays > 1 else np.zeros(1)
    bearings = np.radians((np.arange(beams) * 360.0 / beams)[:, None] + spread)
    return _ranges(body, place, noise, bearings, reach, sigma)


def lidar(
    body: Body,
    place: Place,
    noise: Random,
    *,
    beams: int = 181,
    view: float = 180.0,
    reach: float = 8000.0,
    sigma: float = 0.0,
) -> Callable[[float], list[float]]:
    """Return a scan's reading: `beams` single rays spread over `view` degrees, from the right."""
    bearings = np.radians(np.linspace(-view / 2, view / 2, beams))[:, None]
    return _ranges(body, place, noise, bearings, reach, sigma)


def _ranges(
    body: Body, place: Place, noise: Random, bearings: Floats, reach: float, sigma: float
) -> Callable[[float], list[float]]:
    """Return a reading of beams (n, k): of each the range of the shortest of its k rays."""
    flat, rays = bearings.ravel(), bearings.shape[-1]

    def read(seconds: float) -> list[float]:
        pose = place(seconds)
        angles = flat + radians(pose.heading)
        hits = body.rays((pose.forward, pose.side), angles, reach)
        # A single ray has no other to be compared with.
        nearest = hits if rays == 1 else hits.reshape(-1, rays).min(axis=1)
        return [_noisy(float(hit), noise, sigma) for hit in nearest]

    return read


def bumper(body: Body) -> Callable[[float], int]:
    """Return a bumper's reading: 1 in contact, else 0."""

    def read(seconds: float) -> int:
        body.advance(seconds)
        return int(body.touching)

    return read


def odometry(body: Body, noise: Random, *, sigma: float = 0.0) -> Callable[[float], list[float]]:
    """Return dead reckoning (forward, side, heading) that drifts by `sigma` of the way."""
    believed = [body.pose.forward, body.pose.side, body.pose.heading]
    before = [body.pose]

    def read(seconds: float) -> list[float]:
        body.advance(seconds)
        was, now = before[0], body.pose
        scale = 1.0 + (noise.gauss(0.0, sigma) if sigma else 0.0)
        believed[0] += (now.forward - was.forward) * scale
        believed[1] += (now.side - was.side) * scale
        believed[2] += (now.heading - was.heading) * scale
        before[0] = now
        return list(believed)

    return read


def marks(
    body: Body, place: Place, *, view: float = 60.0, reach: float = 5000.0
) -> Callable[[float], list[tuple[str, float, float]]]:
    """Return (colour, bearing, distance) of the marks that a camera sees."""

    def read(seconds: float) -> list[tuple[str, float, float]]:
        pose = place(seconds)
        seen = []
        for mark in body.world.marks:
            dx, dy = mark.at[0] - pose.forward, mark.at[1] - pose.side
            far = hypot(dx, dy)
            bearing = (degrees(atan2(dy, dx)) - pose.heading + 180) % 360 - 180
            if far > reach or abs(bearing) > view / 2:
                continue
            way = np.array([atan2(dy, dx)])
            hit = body.rays((pose.forward, pose.side), way, reach)[0]
            if hit >= far - 1.0:
                seen.append((mark.colour, bearing, far))
        return seen

    return read


def joystick(
    script: Sequence[tuple[float, tuple[str, float] | None]],
) -> Callable[[float], tuple[str, float] | None]:
    """Return a scripted hand: from each time (s) on a function and its rate, or none: it lets go.

    Before the first it commands nothing either.
    """

    def read(seconds: float) -> tuple[str, float] | None:
        return next((command for at, command in reversed(script) if at <= seconds), None)

    return read


def _noisy(hit: float, noise: Random, sigma: float) -> float:
    return max(0.0, hit + noise.gauss(0.0, sigma)) if sigma and isfinite(hit) else hit
