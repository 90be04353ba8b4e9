"""Walls, polygons, fixed and moving circles: distances and rays, computed for near ones only."""

from bisect import bisect_right
from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass, field
from itertools import accumulate, pairwise
from math import dist, inf

import numpy as np
import numpy.typing as npt

from mars_asp.execution.simulator.motion import Floats, Point

Booleans = npt.NDArray[np.bool_]
#: Relative motion (mm) after which the near obstacles are searched again.
_SLACK = 500.0
_NONE: Floats = np.empty((0, 3))


@dataclass(frozen=True, slots=True)
class Circle:
    """A circle, which moves along the points of its `way` at `speed` mm/s without end.

    It starts at `centre` and turns back at the last point, or goes round if that is `centre`.
    """

    centre: Point
    radius: float
    way: tuple[Point, ...] = ()
    speed: float = 0.0
    #: The points of one round; the last is the first again.
    round: tuple[Point, ...] = field(init=False, repr=False, compare=False)
    #: The distance from the start to each point of the round.
    _gone: tuple[float, ...] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        """Compute the points of one round and their distances."""
        there = (self.centre, *self.way)
        back = () if there[-1] == there[0] else there[-2::-1]
        object.__setattr__(self, "round", (*there, *back))
        lengths = (dist(a, b) for a, b in pairwise(self.round))
        object.__setattr__(self, "_gone", tuple(accumulate(lengths, initial=0.0)))

    @property
    def moves(self) -> bool:
        """Whether the circle has a speed and a path of positive length."""
        return bool(self.speed and self._gone[-1])

    def leg(self, seconds: float) -> tuple[float, ...]:
        """Return x, y, their rates of change, and the time until which these hold."""
        if not self.moves:
            return (*self.centre, 0.0, 0.0, inf)
        rounds, gone = divmod(seconds * self.speed, self._gone[-1])
        last = len(self.round) - 2
        k = min(bisect_right(self._gone, gone) - 1, last)
        until = (rounds * self._gone[-1] + self._gone[k + 1]) / self.speed
        while until <= seconds:  # rounding can put the time at the end of the leg
            k, rounds = (k + 1, rounds) if k < last else (0, rounds + 1)
            gone = self._gone[k]
            until = (rounds * self._gone[-1] + self._gone[k + 1]) / self.speed
        (x, y), (tx, ty) = self.round[k], self.round[k + 1]
        length = self._gone[k + 1] - self._gone[k]
        share, rate = (gone - self._gone[k]) / length, self.speed / length
        return x + share * (tx - x), y + share * (ty - y), rate * (tx - x), rate * (ty - y), until

    def at(self, seconds: float) -> Point:
        """Return the position of the centre at a time."""
        x, y, *_ = self.leg(seconds)
        return x, y


@dataclass(frozen=True, slots=True)
class Mark:
    """A coloured mark that a camera sees."""

    at: Point
    colour: str


@dataclass(frozen=True, slots=True)
class _NearObstacle:
    """The obstacles near a point at a time, valid until something has moved by `_SLACK`.

    `segments` (n, 4) are start and end points, `circles` (n, 3) centres and radii, `moving` the
    indices of moving circles.
    """

    centre: Point
    seconds: float
    segments: Floats
    circles: Floats
    moving: tuple[int, ...]


class World:
    """The obstacles and marks in the plane; `walls` are open polylines, `polygons` are solid."""

    def __init__(
        self,
        walls: Sequence[Sequence[Point]] = (),
        polygons: Sequence[Sequence[Point]] = (),
        circles: Sequence[Circle] = (),
        marks: Sequence[Mark] = (),
    ) -> None:
        rims = [[*p, p[0]] for p in polygons]
        segments = [(*a, *b) for line in (*walls, *rims) for a, b in pairwise(line)]
        fixed = [(*c.centre, c.radius) for c in circles if not c.moves]
        self.segments: Floats = np.array(segments, dtype=float).reshape(-1, 4)
        self.circles: Floats = np.array(fixed, dtype=float).reshape(-1, 3)
        self.moving = tuple(c for c in circles if c.moves)
        self.marks = tuple(marks)
        self.fastest = max((c.speed for c in self.moving), default=0.0)
        self._solid = self.segments[len(segments) - sum(len(rim) - 1 for rim in rims) :]
        self._rims = np.repeat(np.arange(len(rims)), [len(rim) - 1 for rim in rims])
        self._radii: Floats = np.array([c.radius for c in self.moving], dtype=float)
        #: For each moving circle: x, y, their rates, and begin and end of these rates in seconds.
        self._legs: Floats = np.full((len(self.moving), 6), -inf)
        self._seen: _NearObstacle | None = None
        self._reach = -inf
        self._beside: _NearObstacle | None = None

    def beside(self) -> "World":
        """Return a copy for another robot, because each copy caches its own near obstacles."""
        return copy(self)

    @property
    def is_built(self) -> bool:
        """Whether the world has any fixed obstacle."""
        return bool(len(self.segments) or len(self.circles))

    def without_moving(self) -> "World":
        """Return a copy without the moving circles."""
        still = copy(self)
        still.moving, still._seen, still._beside = (), None, None
        return still

    def rays(
        self, origin: Point, angles: Floats, reach: float, seconds: float, discs: Floats = _NONE
    ) -> Floats:
        """Return the length of each ray (n,) at angles in radians; inf without a hit in reach.

        Intersections are exact; `discs` (n, 3) are further circles, such as robots. All rays from
        inside of an obstacle are 0.
        """
        near = self._seen
        if near is None or reach > self._reach or self._passed(near, origin, seconds) > _SLACK:
            near = self._seen = self._gather(origin, seconds, reach + _SLACK)
            self._reach = reach
        circles = np.concatenate([near.circles, self._moved(near.moving, seconds), discs])
        if self._is_inside(origin, circles):
            return np.zeros(angles.shape)
        ways = np.stack([np.cos(angles), np.sin(angles)])
        hits = np.full(angles.shape, inf)
        if len(near.segments):
            hits = np.minimum(hits, _segment_hits(np.array(origin), ways, near.segments))
        if len(circles):
            hits = np.minimum(hits, _circle_hits(np.array(origin), ways, circles))
        hits[hits > reach] = inf
        return hits

    def distance(self, point: Point, seconds: float) -> float:
        """Return the distance (mm) from a point to the nearest obstacle; inf without obstacles.

        Inside of an obstacle the distance is negative.
        """
        near = self._around(point, seconds)
        best = inf
        if len(near.segments):
            best = float(_segment_distances(point, near.segments).min())
            best = -best if self._is_inside(point, self.circles[:0]) else best
        circles = np.concatenate([near.circles, self._moved(near.moving, seconds)])
        if len(circles):
            best = min(best, float(_circle_distances(point, circles).min()))
        return best

    def horizon(self, point: Point, seconds: float, speed: float) -> float:
        """Return how many seconds `gaps` is valid if a point moves at up to `speed` from now on.

        Until then, moving circles keep their direction and no further obstacle comes near.
        """
        near, closing = self._around(point, seconds), speed + self.fastest
        left = _SLACK - self._passed(near, point, seconds)
        ends = self._legs[list(near.moving), 5] - seconds
        return min(left / closing if closing else inf, float(ends.min(initial=inf)))

    def gaps(self, chords: Floats, since: Floats, until: Floats) -> Floats:
        """Return the minimal distance (n,) of points that move along chords (n, 4), start and end.

        Each point moves at a constant speed from `since` to `until` (seconds, within `horizon`) and
        starts outside of all obstacles.
        """
        near = self._beside
        best = np.full(len(chords), inf)
        if near is None:
            return best
        if len(near.segments):
            best = np.minimum(best, _chord_distances(chords, near.segments).min(axis=1))
        circles = near.circles[None, :, [0, 1, 0, 1]]
        relative, radii = chords[:, None, :] - circles, near.circles[:, 2]
        if near.moving:
            which = list(near.moving)
            legs = self._legs[which]
            spent = np.stack([since, until], axis=1)[:, None, :, None] - legs[None, :, None, 4:5]
            moved = legs[None, :, None, :2] + legs[None, :, None, 2:4] * spent
            passing = chords[:, None, :] - moved.reshape(len(chords), len(which), 4)
            relative = np.concatenate([relative, passing], axis=1)
            radii = np.concatenate([radii, self._radii[which]])
        if len(radii):
            best = np.minimum(best, (origin_distances(relative) - radii).min(axis=1))
        return best

    def departures(self, point: Point, velocity: Point, reach: float, seconds: float) -> Floats:
        """Return the rates (n,) in mm/s at which a point departs from the obstacles within reach.

        A rate is negative if the distance shrinks, whichever of the two moves.
        """
        near, here = self._around(point, seconds), np.array(point)
        segments = near.segments[_segment_distances(point, near.segments) <= reach]
        away = [here - nearest_points(here, segments)]
        ways: list[Floats] = [np.zeros((len(segments), 2))]
        for circles, moved in (
            (near.circles, np.zeros((len(near.circles), 2))),
            (self._moved(near.moving, seconds), self._legs[list(near.moving), 2:4]),
        ):
            touched = _circle_distances(point, circles) <= reach
            away.append(here - circles[touched, :2])
            ways.append(moved[touched])
        normals, passing = np.concatenate(away), np.array(velocity) - np.concatenate(ways)
        lengths = np.maximum(np.hypot(normals[:, 0], normals[:, 1]), 1e-300)
        rates: Floats = (normals * passing).sum(axis=1) / lengths
        return rates

    def _around(self, point: Point, seconds: float) -> _NearObstacle:
        """Return the obstacles near a point at a time, cached until something moves by `_SLACK`."""
        near = self._beside
        if near is None or self._passed(near, point, seconds) > _SLACK / 2:
            gaps = [_segment_distances(point, self.segments)]
            gaps.append(_circle_distances(point, self.circles))
            gaps.append(
                _circle_distances(point, self._moved(tuple(range(len(self.moving))), seconds))
            )
            least = min((float(gap.min()) for gap in gaps if len(gap)), default=inf)
            near = self._beside = self._gather(point, seconds, least + 2 * _SLACK)
        elif near.moving:
            self._renew(near.moving, seconds)
        return near

    def _passed(self, near: _NearObstacle, point: Point, seconds: float) -> float:
        """Return an upper bound (mm) of how far point and obstacles moved since `near` was made."""
        spent = seconds - near.seconds
        if spent < 0:
            return inf
        return dist(point, near.centre) + (self.fastest * spent if self.moving else 0.0)

    def _gather(self, point: Point, seconds: float, reach: float) -> _NearObstacle:
        every = self._moved(tuple(range(len(self.moving))), seconds)
        return _NearObstacle(
            point,
            seconds,
            self.segments[_segment_distances(point, self.segments) <= reach],
            self.circles[_circle_distances(point, self.circles) <= reach],
            tuple(np.flatnonzero(_circle_distances(point, every) <= reach).tolist()),
        )

    def _moved(self, which: Sequence[int], seconds: float) -> Floats:
        """Return the moving circles with indices `which` (n, 3) at a time."""
        if not which:
            return _NONE
        self._renew(which, seconds)
        numbers = list(which)
        legs = self._legs[numbers]
        at = legs[:, :2] + legs[:, 2:4] * (seconds - legs[:, 4:5])
        return np.concatenate([at, self._radii[numbers, None]], axis=1)

    def _renew(self, which: Sequence[int], seconds: float) -> None:
        """Update the legs of those moving circles whose leg does not contain a time."""
        numbers = np.array(which)
        legs = self._legs[numbers]
        for number in numbers[(seconds < legs[:, 4]) | (seconds >= legs[:, 5])].tolist():
            *state, until = self.moving[number].leg(seconds)
            self._legs[number] = *state, seconds, until

    def _is_inside(self, point: Point, circles: Floats) -> bool:
        """Whether a point is in a circle, or in a polygon by the even-odd rule."""
        if len(circles) and bool((_circle_distances(point, circles) < 0).any()):
            return True
        if not len(self._solid):
            return False
        (x, y), (ax, ay, bx, by) = point, self._solid.T
        spans = (ay > y) != (by > y)
        with np.errstate(divide="ignore", invalid="ignore"):
            crossed = spans & (x < ax + (y - ay) * (bx - ax) / (by - ay))
        return bool((np.bincount(self._rims, crossed) % 2).any())


def _circle_distances(point: Point, circles: Floats) -> Floats:
    gaps: Floats = np.hypot(circles[:, 0] - point[0], circles[:, 1] - point[1]) - circles[:, 2]
    return gaps


def _segment_distances(point: Point, segments: Floats) -> Floats:
    ends = np.array(segments) - np.array((*point, *point))
    return origin_distances(ends)


def origin_distances(segments: Floats) -> Floats:
    """Return the least distance of each of `segments` (..., 4) from the point (0, 0)."""
    nearest = nearest_points(np.zeros(2), segments)
    distances: Floats = np.hypot(nearest[..., 0], nearest[..., 1])
    return distances


def nearest_points(point: Floats, segments: Floats) -> Floats:
    """Return the points (..., 2) of segments (..., 4) that are nearest to a point."""
    start, along = segments[..., :2], segments[..., 2:] - segments[..., :2]
    squared = np.maximum((along * along).sum(axis=-1), 1e-300)
    share = np.clip(((point - start) * along).sum(axis=-1) / squared, 0.0, 1.0)
    nearest: Floats = start + share[..., None] * along
    return nearest


def _chord_distances(chords: Floats, segments: Floats) -> Floats:
    """Return the distances (n, m) of chords (n, 4) from segments (m, 4); 0 if they cross."""
    p, q = chords[:, None, :2], chords[:, None, 2:]
    a, b = segments[None, :, :2], segments[None, :, 2:]
    pairs = ((a - p, b - p), (a - q, b - q), (p - a, q - a), (p - b, q - b))
    ends = np.stack([np.concatenate(np.broadcast_arrays(*each), axis=-1) for each in pairs])
    apart: Floats = origin_distances(ends).min(axis=0)
    crossed = (_side(p, q, a) != _side(p, q, b)) & (_side(a, b, p) != _side(a, b, q))
    apart[crossed] = 0.0
    return apart


def _side(a: Floats, b: Floats, c: Floats) -> Booleans:
    """Whether point c is to the left of the line from a to b."""
    side: Booleans = (b[..., 0] - a[..., 0]) * (c[..., 1] - a[..., 1]) > (b[..., 1] - a[..., 1]) * (
        c[..., 0] - a[..., 0]
    )
    return side


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
    """Return the length of each ray to the first circle; the origin is outside of all circles."""
    offset = circles[:, :2] - origin
    along = ways[0][:, None] * offset[:, 0] + ways[1][:, None] * offset[:, 1]
    squared = (offset * offset).sum(axis=1) - circles[:, 2] ** 2
    inside = along * along - squared
    first = along - np.sqrt(np.maximum(inside, 0.0))
    nearest: Floats = np.where((inside >= 0) & (first >= 0), first, inf).min(axis=1)
    return nearest
