"""A round robot: its way in lines and arcs, and how near it came to the world on all of it."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from itertools import pairwise
from math import ceil, hypot, inf, radians
from typing import Protocol

import numpy as np

from mars_asp.execution.simulator.motion import Floats, MotionSegment, Point, Pose
from mars_asp.execution.simulator.ramp import Ramp
from mars_asp.execution.simulator.world import World

#: Nearer than this (mm) is contact.
TOUCH = 1e-3
#: Up to ten times as far away, it still is the same contact.
APART = 10 * TOUCH
#: So long (s) after a contact, it still is the same.
_AGAIN = 0.1
#: Chords stand for arcs that are nowhere further from them (mm).
_EXACT = 2.5e-4
#: What is no robot, where the others have names.
THING = ""


def planar_functions(up: str) -> tuple[str, str, str]:
    """Return the functions that drive ahead, aside and turn, with `y` or `z` up."""
    return ("Trans_Z", "Trans_X", "Rotn_Y") if up == "y" else ("Trans_X", "Trans_Y", "Rotn_Z")


class Company(Protocol):
    """The robots that a robot moves among."""

    def advance(self, seconds: float) -> None:
        """Move all of them on to a time (s)."""

    @property
    def bodies(self) -> "tuple[Body, ...]":
        """Return all of them."""

    def discs(self, name: str, place: Point, reach: float) -> Floats:
        """Return those (n, 3) within reach of a place, but for the named one."""


@dataclass(slots=True)
class Body:
    """A disc of `radius` mm in a world, moving as it was last commanded.

    `limits` are the greatest rates by function, `ramps` those that change gradually. What happened
    is kept: the motion, the least clearance (mm) on all of it and to whom, contacts (s) and with
    whom, and seconds of turning and driving at once.
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
    #: The robot that was nearest; `THING` for what is none.
    beside: str = THING
    #: From when until when (s) the step lasted on which the clearance was least.
    closest: tuple[float, float] = (0.0, 0.0)
    driven: float = 0.0
    both: float = 0.0
    motion: list[MotionSegment] = field(default_factory=list)
    contacts: list[float] = field(default_factory=list)
    #: With whom each contact was.
    struck: list[str] = field(default_factory=list)
    company: Company | None = None
    #: Whom it touches, and when (s) it last was seen to touch whom.
    on: set[str] = field(default_factory=set)
    touched: dict[str, float] = field(default_factory=dict)
    #: No less are the gaps (mm) to the world and to robots; they are measured where need be.
    room: float = 0.0
    berth: float = inf

    def __post_init__(self) -> None:
        """Note how near things are where it starts."""
        self.motion.append(MotionSegment(self.seconds, self.pose, 0.0, 0.0, 0.0))
        self.measure()

    @property
    def touching(self) -> bool:
        """Whether it is in contact with anything."""
        return bool(self.on)

    @property
    def collisions(self) -> int:
        """Return how often it came into contact."""
        return len(self.contacts)

    @property
    def place(self) -> Point:
        """Return where its centre is."""
        return self.pose.forward, self.pose.side

    @property
    def stretches(self) -> Iterator[tuple[MotionSegment, float]]:
        """Yield its motion up to now: each stretch, and until when (s) it lasted."""
        for stretch, following in pairwise(self.motion):
            yield stretch, following.since
        yield self.motion[-1], self.seconds

    @property
    def way(self) -> list[tuple[float, Pose]]:
        """Return where it was at times (s) no more than 0.1 s apart, up to now."""
        found = []
        for stretch, until in self.stretches:
            count = ceil((until - stretch.since) / 0.1)
            times = (stretch.since + k * (until - stretch.since) / count for k in range(count))
            found += [(at, stretch.at(at)) for at in times]
        return [*found, (self.seconds, self.pose)]

    def gap(self) -> float:
        """Return how far (mm) its rim is from the world; where they overlap, below 0."""
        return self.world.distance(self.place, self.seconds) - self.radius

    def rays(self, origin: Point, angles: Floats, reach: float) -> Floats:
        """Return how far rays go now that begin at this robot: see `World.rays`."""
        discs = () if self.company is None else (self.company.discs(self.name, origin, reach),)
        return self.world.rays(origin, angles, reach, self.seconds, *discs)

    def obey(self, command: Mapping[str, float], seconds: float) -> None:
        """Move on to a time, then take a command; functions that it does not name are zero."""
        self.advance(seconds)
        self.command = dict(command)

    def advance(self, seconds: float) -> None:
        """Move on to a time (s), and all of its company with it."""
        if seconds > self.seconds and self.company is not None:
            self.company.advance(seconds)

    def rates(self) -> tuple[float, float, float]:
        """Return the rates ahead, aside and turning from now on, within the limits."""
        ahead, aside, turn = (self._ramped_rate(function) for function in planar_functions(self.up))
        return ahead, aside, turn

    def _ramped_rate(self, function: str) -> float:
        wanted, ramp = self._wanted(function), self.ramps.get(function)
        return wanted if ramp is None else ramp.at(self.seconds, wanted)

    def _wanted(self, function: str) -> float:
        most = self.limits.get(function, inf)
        return max(-most, min(most, self.command.get(function, 0.0)))

    @property
    def until(self) -> float:
        """Return until when (s) the rates hold, if no command comes."""
        return min((ramp.until for ramp in self.ramps.values()), default=inf)

    @property
    def most(self) -> float:
        """Return the greatest speed (mm/s) before the next command."""
        peaks = []
        for function in planar_functions(self.up)[:2]:
            ramp = self.ramps.get(function)
            rates = () if ramp is None else (abs(ramp.rate), abs(ramp.mean))
            peaks.append(max(abs(self._wanted(function)), *rates, 0.0))
        return hypot(*peaks)

    @property
    def least(self) -> float:
        """Return the gap (mm) below which it matters how far things are."""
        return max(self.clearance, APART)

    def is_far(self, seconds: float, fastest: float) -> bool:
        """Whether nothing matters until a time, where robots go no faster than `fastest` mm/s."""
        spent, most = seconds - self.seconds, self.most
        closing = most + self.world.fastest
        if closing and self.room - closing * spent < self.least:
            return False
        return not most + fastest or self.berth - (most + fastest) * spent >= self.least

    def go(self, seconds: float, fastest: float) -> None:
        """Move on to a time, up to which nothing is near."""
        while self.seconds < seconds:
            way = MotionSegment(self.seconds, self.pose, *self.rates())
            self.take(way, min(seconds, self.until), fastest)

    def take(self, way: MotionSegment, at: float, fastest: float) -> None:
        """Go along a way to a time (s)."""
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
        """Find out how near the world is."""
        self.room = self.gap()
        self.note(self.room, THING)

    def note(self, gap: float, other: str, since: float | None = None) -> None:
        """Take a gap (mm) into account that there is now, or was at some time since a time (s)."""
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
        """Return the least gap (mm) to the world on a way of so many seconds, if it matters."""

        def gaps(edges: Floats) -> Floats:
            ends = way.points(edges.ravel()).reshape(-1, 4)
            return self.world.gaps(ends, edges[:, 0], edges[:, 1]) - self.radius

        return least_gap(gaps, bend(way), self.least, way.since, way.since + step)


def bend(way: MotionSegment) -> float:
    """Return by how much an arc leaves its chord: so many mm for the square of its seconds."""
    return way.speed * abs(radians(way.turn)) / 8


def least_gap(
    gaps: Callable[[Floats], Floats], bend: float, least: float, since: float, until: float
) -> float:
    """Return the least gap (mm) between two times (s), if that is less than `least`.

    `gaps` are those of chords, each from a time to a time (n, 2); an arc is no further from its
    chord than `bend * t ** 2`: chords bound it from below. Those that might matter are cut in four,
    until they are as good as arcs.
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
