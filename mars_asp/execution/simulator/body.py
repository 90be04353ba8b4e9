"""A round robot: its way in lines and arcs, and contact and clearance found on all of it."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from itertools import pairwise
from math import ceil, inf, nextafter, radians

import numpy as np

from mars_asp.execution.simulator.motion import Floats, Pose, Stretch
from mars_asp.execution.simulator.world import World

#: Nearer than this (mm) is contact.
TOUCH = 1e-3
#: Up to ten times as far away, it still is the same contact.
_APART = 10 * TOUCH
#: Chords stand for arcs that are nowhere further from them (mm).
_EXACT = 2.5e-4
#: For so long (s) a robot that touches something goes on as it does.
_HALTED = 0.005


def planar_functions(up: str) -> tuple[str, str, str]:
    """Return the functions that drive ahead, aside and turn, with `y` or `z` up."""
    return ("Trans_Z", "Trans_X", "Rotn_Y") if up == "y" else ("Trans_X", "Trans_Y", "Rotn_Z")


@dataclass(slots=True)
class Body:
    """A disc of `radius` mm in a world, moving as it was last commanded.

    `limits` are the greatest rates by function. What happened is kept: the motion, the least
    clearance (mm) on all of it, contacts (s), and seconds of turning and driving at once.
    """

    world: World
    pose: Pose
    radius: float
    up: str = "y"
    limits: Mapping[str, float] = field(default_factory=dict)
    command: dict[str, float] = field(default_factory=dict)
    seconds: float = 0.0
    touching: bool = False
    clearance: float = inf
    driven: float = 0.0
    both: float = 0.0
    motion: list[Stretch] = field(default_factory=list)
    contacts: list[float] = field(default_factory=list)
    #: From when until when (s) the step lasted on which the clearance was least.
    closest: tuple[float, float] = (0.0, 0.0)
    #: No less is the gap (mm) now; it is measured where that does not suffice.
    _room: float = 0.0

    def __post_init__(self) -> None:
        """Note how near things are where it starts."""
        self.motion.append(Stretch(self.seconds, self.pose, 0.0, 0.0, 0.0))
        self._room = self.gap()
        self._note(self._room)

    @property
    def collisions(self) -> int:
        """Return how often it came into contact."""
        return len(self.contacts)

    @property
    def stretches(self) -> Iterator[tuple[Stretch, float]]:
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
        """Return how far (mm) its rim is from the nearest thing; where they overlap, below 0."""
        return self.world.distance((self.pose.forward, self.pose.side), self.seconds) - self.radius

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
        """Move on to a time (s).

        No point of the disc moves faster than its centre, so what is further away than both can go
        is not looked at. Otherwise the way is searched for the least gap: a step without contact is
        taken whole, one with contact is halved until the contact is at its end.
        """
        rates = self.rates()
        while self.seconds < seconds:
            way = Stretch(self.seconds, self.pose, *rates)
            closing = way.speed + self.world.fastest
            if not closing or self._room - closing * (seconds - self.seconds) >= self._least:
                self._room -= closing * (seconds - self.seconds) if closing else 0.0
                self._take(way, seconds)
                return
            self._room = self.gap()
            self._note(self._room)
            if self._room <= TOUCH:
                self._slide(way, min(seconds, self.seconds + _HALTED))
            else:
                self._proceed(way, seconds, closing)

    @property
    def _least(self) -> float:
        """Return the gap (mm) below which it matters how far things are."""
        return max(self.clearance, _APART)

    def _proceed(self, way: Stretch, seconds: float, closing: float) -> None:
        """Go on until a time or a contact, whichever is first, or until what is near changes."""
        at = way.pose.forward, way.pose.side
        step = min(seconds - way.since, self.world.horizon(at, way.since, way.speed))
        nearest = self._nearest(way, step)
        while nearest <= TOUCH and closing * step > TOUCH / 2:
            step /= 2
            nearest = self._nearest(way, step)
        whole = step == seconds - way.since
        self._take(way, seconds if whole else max(way.since + step, nextafter(way.since, inf)))
        self._note(nearest, way.since)
        self._room -= closing * step
        if nearest <= _APART:
            self._room = self.gap()
            self._note(self._room)

    def _nearest(self, way: Stretch, step: float) -> float:
        """Return the least gap (mm) on a way of so many seconds, if that is less than is known.

        An arc is no further from its chord than `speed * turn * t ** 2 / 8`: chords bound it from
        below. Those that might matter are cut in four, until they are as good as arcs.
        """
        edges: Floats = np.array([[way.since, way.since + step]])
        bend, found = way.speed * abs(radians(way.turn)) / 8, inf
        while True:
            ends = way.points(edges.ravel()).reshape(-1, 4)
            gaps = self.world.gaps(ends, edges[:, 0], edges[:, 1]) - self.radius
            off = bend * (edges[:, 1] - edges[:, 0]) ** 2
            exact = off <= _EXACT
            found = min(found, float(gaps[exact].min(initial=inf)))
            rest = edges[~exact & (gaps - off < min(found, self._least - _EXACT))]
            if not len(rest):
                return found
            parts = np.linspace(rest[:, 0], rest[:, 1], 5, axis=1)
            edges = np.stack([parts[:, :-1].ravel(), parts[:, 1:].ravel()], axis=1)

    def _slide(self, way: Stretch, seconds: float) -> None:
        """Go on in contact, for a moment: a motion that does not lead away stays where it is."""
        after = way.at(seconds)
        there = self.world.distance((after.forward, after.side), seconds) - self.radius
        if there < min(self._room, 0.0) + 1e-9:
            way = Stretch(way.since, way.pose, 0.0, 0.0, way.turn)
        self._take(way, seconds)

    def _note(self, gap: float, since: float | None = None) -> None:
        """Take a gap (mm) into account that there is now, or was at some time since a time (s)."""
        if max(gap, 0.0) < self.clearance:
            self.clearance = max(gap, 0.0)
            self.closest = (self.seconds if since is None else since, self.seconds)
        touching = gap <= TOUCH
        if touching and not self.touching:
            self.contacts.append(self.seconds)
        self.touching = touching or (self.touching and gap <= _APART)

    def _take(self, way: Stretch, at: float) -> None:
        """Go along a way to a time (s)."""
        self.driven += way.speed * (at - self.seconds)
        self.both += (at - self.seconds) * bool(way.speed and way.turn)
        last = self.motion[-1]
        if (last.ahead, last.aside, last.turn) == (way.ahead, way.aside, way.turn):
            way = last
        elif last.since == way.since:
            self.motion[-1] = way
        else:
            self.motion.append(way)
        self.pose, self.seconds = way.at(at), at
