"""Devices of a robot; sensors are functions from a time in seconds to a reading.

Each device has its own generator of noise, so that devices do not influence one another.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from math import atan2, cos, degrees, hypot, inf, isfinite, radians, sin
from random import Random
from typing import TypeAlias

import numpy as np

from mars_asp.execution.simulator.body import Body
from mars_asp.execution.simulator.motion import Floats, Pose

#: The function from a time in seconds to the pose of a device; it moves the body to that time.
Place: TypeAlias = Callable[[float], Pose]


@dataclass(slots=True)
class JointDevice:
    """A joint commanded by rates (degrees/s or mm/s), or a gripper by widths, within bounds."""

    function: str
    low: float = -inf
    high: float = inf
    rate: float = inf
    value: float = 0.0
    wanted: float = 0.0
    seconds: float = 0.0
    #: Begin and end, in seconds, of each motion.
    moved: list[tuple[float, float]] = field(default_factory=list, init=False)

    def obey(self, command: dict[str, float], seconds: float) -> None:
        """Move to a time, then follow a command; a missing rate is 0, a missing width unchanged."""
        self.advance(seconds)
        resting = self.wanted if self.function == "Grasp" else 0.0
        self.wanted = command.get(self.function, resting)

    def advance(self, seconds: float) -> float:
        """Move to a time and return the angle, displacement or width."""
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
    """Return a function from a time to the pose of a device mounted by `links` on a robot.

    A link is (forward, side, turn, joint), where `joint` is None for a fixed one.
    """

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
    """Return a function from a time to the ranges (mm) of sonars at k * 360 / beams degrees.

    The range of a beam is the minimum over `rays` rays in its cone, or inf without a hit.
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
    """Return a function from a time to `beams` ranges (mm) over `view` degrees, from the right."""
    bearings = np.radians(np.linspace(-view / 2, view / 2, beams))[:, None]
    return _ranges(body, place, noise, bearings, reach, sigma)


def _ranges(
    body: Body, place: Place, noise: Random, bearings: Floats, reach: float, sigma: float
) -> Callable[[float], list[float]]:
    """Return a function from a time to n ranges, each the minimum of k rays (`bearings`: n, k)."""
    flat, rays = bearings.ravel(), bearings.shape[-1]

    def read(seconds: float) -> list[float]:
        pose = place(seconds)
        angles = flat + radians(pose.heading)
        hits = body.rays((pose.forward, pose.side), angles, reach)
        # Fast path for one ray per beam.
        nearest = hits if rays == 1 else hits.reshape(-1, rays).min(axis=1)
        return [_noisy(float(hit), noise, sigma) for hit in nearest]

    return read


def bumper(body: Body) -> Callable[[float], int]:
    """Return a function from a time to the reading of a bumper: 1 in contact, else 0."""

    def read(seconds: float) -> int:
        body.advance(seconds)
        return int(bool(body.on))

    return read


def odometry(body: Body, noise: Random, *, sigma: float = 0.0) -> Callable[[float], list[float]]:
    """Return a function from a time to [forward, side, heading], as an odometer estimates it.

    It begins at the true pose; each step has a relative error with deviation `sigma`.
    """
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
    """Return a function from a time to (colour, bearing, distance) of each mark a camera sees."""

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
    """Return a function from a time to the command of a scripted joystick, None if released.

    `script` has the time in seconds of each change; before the first, the joystick is released.
    """

    def read(seconds: float) -> tuple[str, float] | None:
        return next((command for at, command in reversed(script) if at <= seconds), None)

    return read


def _noisy(hit: float, noise: Random, sigma: float) -> float:
    return max(0.0, hit + noise.gauss(0.0, sigma)) if sigma and isfinite(hit) else hit
