"""Walls, polygons, circles and moving circles: distances and rays, culled by range."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import cos, hypot, inf, pi, sin

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Point = tuple[float, float]
#: How far (mm) a robot may go before what is near it is looked up again.
_SLACK = 500.0


@dataclass(frozen=True, slots=True)
class Circle:
    """A circle; with a `target` it goes there and back for ever at `speed` mm/s."""

    centre: Point
    radius: float
    target: Point | None = None
    speed: float = 0.0

    def at(self, seconds: float) -> Point:
        """Return where the centre is at a time."""
        if self.target is None or not self.speed:
            return self.centre
        (x, y), (tx, ty) = self.centre, self.target
        length = hypot(tx - x, ty - y)
        if not length:
            return self.centre
        gone = (seconds * self.speed) % (2 * length)
        share = min(gone, 2 * length - gone) / length
        return x + share * (tx - x), y + share * (ty - y)


@dataclass(frozen=True, slots=True)
class Mark:
    """A coloured mark that a camera sees."""

    at: Point
    colour: str


def regular_polygon(centre: Point, radius: float, corners: int) -> list[Point]:
    """Return the corners of a regular polygon."""
    angles = [2 * pi * k / corners for k in range(corners)]
    return [(centre[0] + radius * cos(a), centre[1] + radius * sin(a)) for a in angles]


class World:
    """What stands and moves in the plane. `walls` are open polylines, `polygons` closed ones."""

    def __init__(
        self,
        walls: Sequence[Sequence[Point]] = (),
        polygons: Sequence[Sequence[Point]] = (),
        circles: Sequence[Circle] = (),
        marks: Sequence[Mark] = (),
    ) -> None:
        lines = [*walls, *([*p, p[0]] for p in polygons)]
        segments = [(*a, *b) for line in lines for a, b in pairwise(line)]
        fixed = [(*c.centre, c.radius) for c in circles if c.target is None]
        self.segments: Floats = np.array(segments, dtype=float).reshape(-1, 4)
        self.circles: Floats = np.array(fixed, dtype=float).reshape(-1, 3)
        self.moving = tuple(c for c in circles if c.target is not None)
        self.marks = tuple(marks)
        self.fastest = max((c.speed for c in self.moving), default=0.0)
        self._centre, self._reach = (inf, inf), -inf
        self._near = self.segments, self.circles

    def rays(self, origin: Point, angles: Floats, reach: float, seconds: float) -> Floats:
        """Return how far each ray (n,) of an angle in radians goes; a miss within reach is inf.

        Exact line against segment and circle; an origin inside a circle sees its rim.
        """
        segments, circles = self._within(origin, reach, seconds)
        ways = np.stack([np.cos(angles), np.sin(angles)])
        hits = np.full(angles.shape, inf)
        if len(segments):
            hits = np.minimum(hits, _segment_hits(np.array(origin), ways, segments))
        if len(circles):
            hits = np.minimum(hits, _circle_hits(np.array(origin), ways, circles))
        hits[hits > reach] = inf
        return hits

    def distance(self, point: Point, seconds: float, reach: float = 2000.0) -> float:
        """Return the distance from a point to the nearest thing; inf beyond `reach`.

        Inside of a circle it is negative; polygons and walls are lines.
        """
        segments, circles = self._within(point, reach, seconds)
        best = inf
        if len(segments):
            best = float(_segment_distances(point, segments).min())
        if len(circles):
            gaps = np.hypot(circles[:, 0] - point[0], circles[:, 1] - point[1]) - circles[:, 2]
            best = min(best, float(gaps.min()))
        return best if best <= reach else inf

    def _within(self, point: Point, reach: float, seconds: float) -> tuple[Floats, Floats]:
        """Return the segments and circles that may be within reach of a point at a time."""
        away = hypot(point[0] - self._centre[0], point[1] - self._centre[1])
        if not away + reach <= self._reach:
            self._centre, self._reach = point, max(reach, 2000.0) + _SLACK
            near = _segment_distances(point, self.segments) <= self._reach
            gaps = np.hypot(self.circles[:, 0] - point[0], self.circles[:, 1] - point[1])
            round_ = gaps - self.circles[:, 2] <= self._reach
            self._near = self.segments[near], self.circles[round_]
        segments, circles = self._near
        if self.moving:
            moved = np.array([(*c.at(seconds), c.radius) for c in self.moving])
            circles = np.concatenate([circles, moved])
        return segments, circles


def _segment_distances(point: Point, segments: Floats) -> Floats:
    start, along = segments[:, :2], segments[:, 2:] - segments[:, :2]
    offset = np.array(point) - start
    squared = np.maximum((along * along).sum(axis=1), 1e-300)
    share = np.clip((offset * along).sum(axis=1) / squared, 0.0, 1.0)
    gaps = offset - share[:, None] * along
    distances: Floats = np.hypot(gaps[:, 0], gaps[:, 1])
    return distances


def _segment_hits(origin: Floats, ways: Floats, segments: Floats) -> Floats:
    offset = segments[:, :2] - origin
    along = segments[:, 2:] - segments[:, :2]
    dx, dy = ways[0][:, None], ways[1][:, None]
    with np.errstate(divide="ignore", invalid="ignore"):
        across = dx * along[:, 1] - dy * along[:, 0]
        far = (offset[:, 0] * along[:, 1] - offset[:, 1] * along[:, 0]) / across
        share = (offset[:, 0] * dy - offset[:, 1] * dx) / across
        hit = (far >= 0) & (share >= 0) & (share <= 1)
    nearest: Floats = np.where(hit, far, inf).min(axis=1)
    return nearest


def _circle_hits(origin: Floats, ways: Floats, circles: Floats) -> Floats:
    offset = circles[:, :2] - origin
    along = ways[0][:, None] * offset[:, 0] + ways[1][:, None] * offset[:, 1]
    squared = (offset * offset).sum(axis=1) - circles[:, 2] ** 2
    inside = along * along - squared
    root = np.sqrt(np.maximum(inside, 0.0))
    first, second = along - root, along + root
    far = np.where(first >= 0, first, np.where(second >= 0, second, inf))
    nearest: Floats = np.where(inside >= 0, far, inf).min(axis=1)
    return nearest
