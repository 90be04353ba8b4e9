"""Motion at constant rates in the plane, in closed form: lines and arcs of circles.

Lengths in mm, angles in degrees, times in s.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from math import (
    asin,
    atan2,
    ceil,
    copysign,
    cos,
    degrees,
    floor,
    hypot,
    inf,
    pi,
    radians,
    sin,
    sqrt,
)

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Point = tuple[float, float]


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


@dataclass(frozen=True, slots=True)
class MotionSegment:
    """A motion at constant rates (mm/s ahead and aside, degrees/s of turning) from `since` on."""

    since: float
    pose: Pose
    ahead: float
    aside: float
    turn: float

    def at(self, seconds: float) -> Pose:
        """Return the pose at a time in seconds of the run."""
        return move(self.pose, self.ahead, self.aside, self.turn, seconds - self.since)

    @property
    def speed(self) -> float:
        """Return the speed of the centre (mm/s)."""
        return hypot(self.ahead, self.aside)

    def points(self, times: Floats) -> Floats:
        """Return the positions of the centre (n, 2) at times (n,)."""
        spent = times - self.since
        angle = radians(self.turn) * spent
        small = np.abs(angle) < 1e-6
        safe = np.where(small, 1.0, angle)
        sine = np.where(small, 1.0 - angle * angle / 6, np.sin(angle) / safe)
        rest = np.where(small, angle / 2, (1.0 - np.cos(angle)) / safe)
        x = (sine * self.ahead - rest * self.aside) * spent
        y = (rest * self.ahead + sine * self.aside) * spent
        c, s = cos(radians(self.pose.heading)), sin(radians(self.pose.heading))
        return np.stack([self.pose.forward + c * x - s * y, self.pose.side + s * x + c * y], axis=1)

    def enters(self, place: Point, radius: float, until: float) -> float | None:
        """Return when the centre first is within `radius` of a place, or None by `until`."""
        p, q = self.pose.forward - place[0], self.pose.side - place[1]
        if hypot(p, q) <= radius:
            return self.since
        if not self.speed:
            return None
        if self._is_straight(until):
            vx, vy = self.velocity
            along, squared = p * vx + q * vy, vx * vx + vy * vy
            inside = along * along - squared * (p * p + q * q - radius * radius)
            spent = (-along - sqrt(inside)) / squared if inside >= 0 else inf
        else:
            angle, direction, reach, far = self._seen_from_centre(place)
            # The points of the circle within the radius are an arc around the direction.
            inside = (radius - reach + far) * (radius + reach - far)
            if inside < 0:
                return None
            half = asin(min(1.0, sqrt(inside / (4 * reach * far)))) if far else 0.0
            turning = radians(self.turn)
            way = 1.0 if turning > 0 else -1.0
            spent = (way * (direction - angle) - 2 * half) % (2 * pi) / abs(turning)
        return self.since + spent if 0 <= spent <= until - self.since else None

    def nearest(self, place: Point, until: float) -> tuple[float, float]:
        """Return the minimal distance (mm) of the centre from a place, and when it occurs."""
        times = [self.since, until]
        p, q = self.pose.forward - place[0], self.pose.side - place[1]
        if self.speed and self._is_straight(until):
            vx, vy = self.velocity
            times.append(self.since - (p * vx + q * vy) / (vx * vx + vy * vy))
        elif self.speed:
            angle, direction, _, _ = self._seen_from_centre(place)
            way = 1.0 if self.turn > 0 else -1.0
            ahead = (way * (direction - angle)) % (2 * pi)
            times.append(self.since + ahead / abs(radians(self.turn)))
        ways = []
        for time in times:
            if self.since <= time <= until:
                pose = self.at(time)
                ways.append((hypot(pose.forward - place[0], pose.side - place[1]), time))
        return min(ways)

    def crossings(self, axis: int, size: float, origin: float, until: float) -> Iterator[float]:
        """Yield the times when a coordinate (0 forward, 1 side) is `origin` + k * `size`."""
        if not self.speed:
            return
        start, rate = (self.pose.forward, self.pose.side)[axis], self.velocity[axis]
        turning, far = radians(self.turn), self.speed * (until - self.since)
        cosine = rate / self.speed
        for k in _multiples(start - far - origin, start + far - origin, size):
            gone = origin + k * size - start
            if not turning:
                times = [gone / rate] if rate else []
            else:
                # The tangent of half the turned angle is the root of a quadratic. This is exact
                # also for circles so large that their centre is not.
                c = gone * turning / self.speed
                sine = self.velocity[1 - axis] / self.speed * (1 - 2 * axis)
                a = c + 2 * sine
                root = cosine * cosine - a * c
                if root < 0:
                    continue
                q = cosine + copysign(sqrt(root), cosine)
                halves = {atan2(q, a), atan2(c, q)} if q or c else {0.0}
                times = [2 * half % copysign(2 * pi, turning) / turning for half in halves]
            period = 2 * pi / abs(turning) if turning else inf
            for time in times:
                again = time
                while 0 <= again <= until - self.since:
                    yield self.since + again
                    again += period

    def _is_straight(self, until: float) -> bool:
        """Whether the distance from the tangent is negligible (1e-4 mm) up to a time."""
        return self.speed * abs(radians(self.turn)) * (until - self.since) ** 2 <= 2e-4

    @property
    def velocity(self) -> tuple[float, float]:
        """Return the velocity (forward, side) in mm/s at the start."""
        c, s = cos(radians(self.pose.heading)), sin(radians(self.pose.heading))
        return c * self.ahead - s * self.aside, s * self.ahead + c * self.aside

    @property
    def _arc(self) -> tuple[float, float]:
        """Return the radius of the circle (mm), and the angle of its start (radians)."""
        vx, vy = self.velocity
        # The centre is a quarter turn from the velocity, so the start lies opposite.
        sign = 1.0 if self.turn > 0 else -1.0
        return self.speed / abs(radians(self.turn)), atan2(-sign * vx, sign * vy)

    def _seen_from_centre(self, place: Point) -> tuple[float, float, float, float]:
        """Return, from the circle's centre: angles of start and place, radius, place's distance."""
        reach, angle = self._arc
        x = place[0] - (self.pose.forward - reach * cos(angle))
        y = place[1] - (self.pose.side - reach * sin(angle))
        return angle, atan2(y, x), reach, hypot(x, y)


def _multiples(start: float, end: float, size: float) -> range:
    """Return the integers k with `k * size` between two numbers."""
    low, high = min(start, end), max(start, end)
    return range(ceil(low / size), floor(high / size) + 1)
