"""A round robot: its motion in lines and arcs, its clearance and its contacts."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from itertools import pairwise
from math import ceil, hypot, inf, radians
from typing import Protocol

import numpy as np

from mars_asp.execution.simulator.motion import Floats, MotionSegment, Point, Pose
from mars_asp.execution.simulator.ramp import Ramp
from mars_asp.execution.simulator.world import World

#: A smaller gap (mm) is a contact.
TOUCH = 1e-3
#: Up to this gap (mm), a contact lasts.
APART = 10 * TOUCH
#: Within this time in seconds, a further contact with the same obstacle does not count.
_AGAIN = 0.1
#: Maximal distance (mm) of an arc from the chord that approximates it.
_EXACT = 2.5e-4
#: The name of all obstacles other than robots.
THING = ""


def planar_functions(up: str) -> tuple[str, str, str]:
    """Return the functions that move ahead, move aside and turn if axis `up` is vertical."""
    return ("Trans_Z", "Trans_X", "Rotn_Y") if up == "y" else ("Trans_X", "Trans_Y", "Rotn_Z")


class Company(Protocol):
    """The robots of one world, which move together."""

    def advance(self, seconds: float) -> None:
        """Move all robots to a time in seconds."""

    @property
    def bodies(self) -> "tuple[Body, ...]":
        """Return all robots in the world, in a fixed order."""

    def discs(self, name: str, place: Point, reach: float) -> Floats:
        """Return centre and radius (n, 3) of the other robots within reach of a point."""


@dataclass(slots=True)
class Body:
    """A disc of `radius` mm in a world, which moves by its last command.

    `limits` are the maximal rates by function, `ramps` the rates that change gradually. Recorded
    are the `motion`, the minimal `clearance` (mm), the times of `contacts` in seconds, the
    distance `driven` and the seconds of `both` driving and turning.
    """

    world: World
    pose: Pose
    radius: float
    up: str = "y"
    limits: Mapping[str, float] = field(default_factory=dict)
    command: dict[str, float] = field(default_factory=dict)
    seconds: float = 0.0
    name: str = "robot"
    ramps: Mapping[str, Ramp] = field(default_factory=dict)
    clearance: float = inf
    #: The nearest robot at the minimal clearance, or `THING`.
    beside: str = THING
    #: Begin and end, in seconds, of the step with the minimal clearance.
    closest: tuple[float, float] = (0.0, 0.0)
    driven: float = 0.0
    both: float = 0.0
    motion: list[MotionSegment] = field(default_factory=list)
    contacts: list[float] = field(default_factory=list)
    #: The robot, or `THING`, of each contact.
    struck: list[str] = field(default_factory=list)
    company: Company | None = None
    #: The touched robots (or `THING`), and the last time in seconds at which each was touched.
    on: set[str] = field(default_factory=set)
    touched: dict[str, float] = field(default_factory=dict)
    #: Lower bounds of the gaps (mm) to the world and to other robots.
    room: float = 0.0
    berth: float = inf

    def __post_init__(self) -> None:
        """Measure the gap at the start."""
        self.motion.append(MotionSegment(self.seconds, self.pose, 0.0, 0.0, 0.0))
        self.measure()

    @property
    def place(self) -> Point:
        """Return the position of the centre in mm."""
        return self.pose.forward, self.pose.side

    @property
    def stretches(self) -> Iterator[tuple[MotionSegment, float]]:
        """Yield each motion segment up to now, with its end in seconds."""
        for stretch, following in pairwise(self.motion):
            yield stretch, following.since
        yield self.motion[-1], self.seconds

    @property
    def way(self) -> list[tuple[float, Pose]]:
        """Return times in seconds, at most 0.1 apart, up to now, with the pose at each."""
        found = []
        for stretch, until in self.stretches:
            count = ceil((until - stretch.since) / 0.1)
            times = (stretch.since + k * (until - stretch.since) / count for k in range(count))
            found += [(at, stretch.at(at)) for at in times]
        return [*found, (self.seconds, self.pose)]

    def gap(self) -> float:
        """Return the gap (mm) between rim and obstacles, negative if they overlap."""
        return self.world.distance(self.place, self.seconds) - self.radius

    def rays(self, origin: Point, angles: Floats, reach: float) -> Floats:
        """Return the lengths (mm) of rays from a point, at angles in radians, as `World.rays`."""
        discs = () if self.company is None else (self.company.discs(self.name, origin, reach),)
        return self.world.rays(origin, angles, reach, self.seconds, *discs)

    def obey(self, command: Mapping[str, float], seconds: float) -> None:
        """Move to a time, then follow a command; functions that are not in it get rate 0."""
        self.advance(seconds)
        self.command = dict(command)

    def advance(self, seconds: float) -> None:
        """Move this robot and all others to a time in seconds."""
        if seconds > self.seconds and self.company is not None:
            self.company.advance(seconds)

    def rates(self) -> tuple[float, float, float]:
        """Return the rates ahead, aside and turning from now on, within the limits."""
        rates = []
        for function in planar_functions(self.up):
            wanted, ramp = self._wanted(function), self.ramps.get(function)
            rates.append(wanted if ramp is None else ramp.at(self.seconds, wanted))
        ahead, aside, turn = rates
        return ahead, aside, turn

    def _wanted(self, function: str) -> float:
        most = self.limits.get(function, inf)
        return max(-most, min(most, self.command.get(function, 0.0)))

    @property
    def until(self) -> float:
        """Return the time in seconds at which a ramp changes a rate; inf if none does."""
        return min((ramp.until for ramp in self.ramps.values()), default=inf)

    @property
    def most(self) -> float:
        """Return an upper bound of the speed (mm/s) before the next command."""
        peaks = []
        for function in planar_functions(self.up)[:2]:
            ramp = self.ramps.get(function)
            rates = () if ramp is None else (abs(ramp.rate), abs(ramp.mean))
            peaks.append(max(abs(self._wanted(function)), *rates, 0.0))
        return hypot(*peaks)

    @property
    def least(self) -> float:
        """Return the gap (mm) below which gaps are measured: they change clearance or contacts."""
        return max(self.clearance, APART)

    def is_far(self, seconds: float, fastest: float) -> bool:
        """Whether no gap can fall below `least` before a time, with robots up to `fastest` mm/s."""
        spent, most = seconds - self.seconds, self.most
        closing = most + self.world.fastest
        if closing and self.room - closing * spent < self.least:
            return False
        return not most + fastest or self.berth - (most + fastest) * spent >= self.least

    def go(self, seconds: float, fastest: float) -> None:
        """Move to a time before which `is_far` holds."""
        while self.seconds < seconds:
            way = MotionSegment(self.seconds, self.pose, *self.rates())
            self.take(way, min(seconds, self.until), fastest)

    def take(self, way: MotionSegment, at: float, fastest: float) -> None:
        """Move along a segment until `at` (seconds); others drive at most `fastest` mm/s."""
        spent, speed = at - self.seconds, way.speed
        self.driven += speed * spent
        self.both += spent * bool(speed and way.turn)
        if closing := speed + self.world.fastest:
            self.room -= closing * spent
        if closing := speed + fastest:
            self.berth -= closing * spent
        last = self.motion[-1]
        if (last.ahead, last.aside, last.turn) == (way.ahead, way.aside, way.turn):
            way = last
        elif last.since == way.since:
            self.motion[-1] = way
        else:
            self.motion.append(way)
        self.pose, self.seconds = way.at(at), at

    def measure(self) -> None:
        """Measure the gap to the world, and record it."""
        self.room = self.gap()
        self.note(self.room, THING)

    def note(self, gap: float, other: str, since: float | None = None) -> None:
        """Record a gap (mm) to the robot or world `other`, which occurred since `since`, or now."""
        if max(gap, 0.0) < self.clearance:
            self.clearance, self.beside = max(gap, 0.0), other
            self.closest = (self.seconds if since is None else since, self.seconds)
        if gap <= TOUCH and other not in self.on:
            self.on.add(other)
            if self.seconds - self.touched.get(other, -inf) > _AGAIN:
                self.contacts.append(self.seconds)
                self.struck.append(other)
        elif gap > APART:
            self.on.discard(other)
        if other in self.on:
            self.touched[other] = self.seconds

    def nearest(self, way: MotionSegment, step: float) -> float:
        """Return the minimal gap (mm) to the world in `step` seconds; see `least_gap`."""

        def gaps(edges: Floats) -> Floats:
            ends = way.points(edges.ravel()).reshape(-1, 4)
            return self.world.gaps(ends, edges[:, 0], edges[:, 1]) - self.radius

        return least_gap(gaps, bend(way), self.least, way.since, way.since + step)


def bend(way: MotionSegment) -> float:
    """Return b such that an arc of t seconds is at most b * t ** 2 mm from its chord."""
    return way.speed * abs(radians(way.turn)) / 8


def least_gap(
    gaps: Callable[[Floats], Floats], bend: float, least: float, since: float, until: float
) -> float:
    """Return the minimal gap (mm) between two times in seconds, or inf if it is above `least`.

    `gaps` computes the gaps of chords, given by begin and end (n, 2). An arc is within
    `bend * t ** 2` of its chord, so chords give lower bounds. Chords whose bound is too low are cut
    in four, until they approximate the arc well enough.
    """
    edges: Floats = np.array([[since, until]])
    found = inf
    while True:
        far = gaps(edges)
        off = bend * (edges[:, 1] - edges[:, 0]) ** 2
        exact = off <= _EXACT
        found = min(found, float(far[exact].min(initial=inf)))
        rest = edges[~exact & (far - off < min(found, least - _EXACT))]
        if not len(rest):
            return found
        parts = np.linspace(rest[:, 0], rest[:, 1], 5, axis=1)
        edges = np.stack([parts[:, :-1].ravel(), parts[:, 1:].ravel()], axis=1)
