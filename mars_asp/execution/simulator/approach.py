"""The closest approach of a robot to an obstacle in a run, on its exact motion."""

from bisect import bisect_right
from math import dist, hypot, inf
from typing import NamedTuple

import numpy as np

from mars_asp.execution.simulator.body import THING, Body
from mars_asp.execution.simulator.motion import MotionSegment, Point, Pose
from mars_asp.execution.simulator.world import World, nearest_points

#: Maximal error (mm) of the gap.
_EXACT = 0.01
#: Maximal error of the time, in seconds.
_INSTANT = 1e-7
#: Maximal number of samples in the step with the minimal clearance.
_MOST_LOOKS = 20_000


class Approach(NamedTuple):
    """The pose of a robot at a time, and the nearest point of an obstacle, `gap` mm away."""

    at: float
    pose: Pose
    thing: Point
    gap: float


def pose_at(body: Body, seconds: float) -> Pose:
    """Return the pose of a body at a time up to now."""
    return _stretch(body, seconds).at(seconds)


def least_approach(body: Body) -> Approach | None:
    """Return the first approach with the minimal clearance, or None without any obstacle.

    Only the step with the minimal clearance is searched. Each sample skips the time in which the
    gap cannot become minimal; from there, the search descends to the minimum.
    """
    if body.clearance == inf:
        return None
    at, until = body.closest
    other = _robot_named(body, body.beside)
    fastest = body.world.fastest if other is None else _stretch(other, at).speed
    closing = _stretch(body, at).speed + fastest
    step = max(_EXACT, closing * (until - at) / _MOST_LOOKS)
    while at < until:
        left = approach_at(body, at, body.beside).gap - body.clearance
        if left <= _EXACT or not closing:
            break
        at = min(until, at + max(left, step) / closing)
    least, stride = approach_at(body, at, body.beside), until - at
    while stride > _INSTANT:
        further = approach_at(body, min(until, least.at + stride), body.beside)
        nearer = further.gap < least.gap
        least, stride = (further, stride) if nearer else (least, stride / 2)
    return least


def approach_at(body: Body, seconds: float, beside: str = THING) -> Approach:
    """Return the approach at a time to the robot named `beside`, or else to the world.

    In contact the gap is 0.
    """
    pose, other = pose_at(body, seconds), _robot_named(body, beside)
    place = pose.forward, pose.side
    if other is None:
        thing = _nearest(body.world, place, seconds)
    else:
        there = pose_at(other, seconds)
        thing = _rim(place, there.forward, there.side, other.radius)
    return Approach(seconds, pose, thing, max(dist(place, thing) - body.radius, 0.0))


def _robot_named(body: Body, name: str) -> Body | None:
    """Return the robot with a name in the same world as a body, or None without such a robot."""
    others = () if body.company is None else body.company.bodies
    return next((other for other in others if other.name == name != THING), None)


def _stretch(body: Body, seconds: float) -> MotionSegment:
    number = bisect_right(body.motion, seconds, key=lambda stretch: stretch.since) - 1
    return body.motion[max(number, 0)]


def _nearest(world: World, point: Point, seconds: float) -> Point:
    """Return the point of walls and circles that is nearest to a point at a time."""
    found: list[Point] = []
    if len(world.segments):
        places = nearest_points(np.array(point), world.segments)
        x, y = places[np.hypot(*(places - np.array(point)).T).argmin()].tolist()
        found.append((x, y))
    circles = [*world.circles.tolist(), *((*c.at(seconds), c.radius) for c in world.moving)]
    found += [_rim(point, *circle) for circle in circles]
    return min(found, key=lambda place: dist(place, point))


def _rim(point: Point, x: float, y: float, radius: float) -> Point:
    """Return the point on the rim of a circle that is nearest to a point."""
    way = hypot(point[0] - x, point[1] - y) or inf
    return x + radius * (point[0] - x) / way, y + radius * (point[1] - y) / way
