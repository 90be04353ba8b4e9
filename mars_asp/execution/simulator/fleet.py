"""Robots that move together in one world.

Advancing one robot advances all, so contacts between robots do not depend on the order in which
devices are read.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from math import dist, hypot, inf, nextafter

import numpy as np

from mars_asp.execution.simulator.body import APART, THING, TOUCH, Body, bend, least_gap
from mars_asp.execution.simulator.motion import Floats, MotionSegment, Point
from mars_asp.execution.simulator.world import origin_distances

#: Maximal step, in seconds, of a robot that touches something.
_HALTED = 0.005
#: Rounding error (mm) of a gap.
_DEEPER = 1e-6
#: Rounding error of the speed towards a touched obstacle, as a share of the speed.
_ALONG = 1e-9
_NONE: Floats = np.empty((0, 3))


@dataclass(frozen=True, slots=True)
class _Search:
    """The search for the minimal gap of a robot to the world or to another robot.

    `least` returns this gap in a step of some seconds, `note` records it; `closing` is in mm/s. A
    step is halved while its gap is at most `floor` (mm) and can shrink by more than `fine` (mm).
    """

    least: Callable[[float], float]
    closing: float
    note: Callable[[float], None]
    floor: float
    fine: float


class Fleet:
    """Robots with different names in one world, all at the same time."""

    def __init__(self, bodies: Sequence[Body]) -> None:
        """Join robots, and measure the gaps between them."""
        self.bodies = tuple(bodies)
        self._numbers = {body.name: k for k, body in enumerate(self.bodies)}
        self._radii: Floats = np.array([body.radius for body in self.bodies])
        self._seen: tuple[float, Floats] = -inf, _NONE
        for body in self.bodies:
            body.company = self
            if len(self.bodies) > 1:
                # A world caches the near obstacles of one robot.
                body.world = body.world.beside()
                body.berth = -inf
        for body in self.bodies:
            self._measure(body)

    @property
    def seconds(self) -> float:
        """Return the current time in seconds of all robots."""
        return self.bodies[0].seconds

    def discs(self, name: str, place: Point, reach: float) -> Floats:
        """Return centre and radius (n, 3) of the other robots within reach of a point."""
        if len(self.bodies) == 1:
            return _NONE
        every = self._discs()
        near = np.hypot(every[:, 0] - place[0], every[:, 1] - place[1]) - self._radii <= reach
        near[self._numbers[name]] = False
        return every[near]

    def _discs(self) -> Floats:
        """Return centre and radius (n, 3) of all robots now."""
        if self._seen[0] != self.seconds:
            places = [(*body.place, body.radius) for body in self.bodies]
            self._seen = self.seconds, np.array(places)
        return self._seen[1]

    def advance(self, seconds: float) -> None:
        """Move all robots to a time in seconds.

        No point of a disc moves faster than its centre, so obstacles out of reach are skipped. For
        others the minimal gap is searched: a step without contact is made whole, a step with a
        contact is halved until the contact is at its end.
        """
        while self.seconds < seconds:
            fastest = self._fastest([body.most for body in self.bodies])
            if all(body.is_far(seconds, fastest) for body in self.bodies):
                for body in self.bodies:
                    body.go(seconds, fastest)
                return
            self._advance(seconds)

    def _fastest(self, speeds: Sequence[float]) -> float:
        """Return the maximal speed (mm/s) of the robots, 0 if there is only one."""
        return max(speeds) if len(speeds) > 1 else 0.0

    def _advance(self, seconds: float) -> None:
        """Move on to a time, a change of rates or a contact, whichever is first."""
        now = self.seconds
        ways = [MotionSegment(now, body.pose, *body.rates()) for body in self.bodies]
        fastest = self._fastest([way.speed for way in ways])
        until = min(seconds, *(body.until for body in self.bodies))
        near, pairs = self._look(ways, until, fastest)
        held = [k for k in near if self.bodies[k].room <= TOUCH]
        met = [pair for pair, gap in pairs.items() if gap <= TOUCH]
        if held or met:
            until = min(until, now + _HALTED)
            ways = self._halted(ways, held, met)
        step = until - now
        searches = []
        for k in near:
            body, way = self.bodies[k], ways[k]
            if k in held and not way.speed:
                continue
            horizon = body.world.horizon(body.place, now, way.speed)
            closing = way.speed + body.world.fastest
            free = (body.room - body.least) / closing if closing else inf
            step = min(step, max(horizon, free))
            if free < horizon:
                searches.append(self._search(k, way))
        for pair, gap in pairs.items():
            if pair not in met or any(ways[k].speed for k in pair):
                searches.append(self._search_pair(*pair, ways, gap))
        while True:
            found = [search.least(step) for search in searches]
            if not any(
                gap <= search.floor and search.closing * step > search.fine
                for gap, search in zip(found, searches, strict=True)
            ):
                break
            step /= 2
        at = until if step == until - now else max(now + step, nextafter(now, inf))
        for body, way in zip(self.bodies, ways, strict=True):
            body.take(way, at, fastest)
        for gap, search in zip(found, searches, strict=True):
            search.note(gap)

    def _look(
        self, ways: Sequence[MotionSegment], until: float, fastest: float
    ) -> tuple[list[int], dict[tuple[int, int], float]]:
        """Return the robots that may get near an obstacle, and the gaps of pairs that may.

        They may until the instant `until`; gaps are those at the begin of the segments `ways`, and
        `fastest` is the highest speed of any robot.
        """
        near, pairs = list[int](), dict[tuple[int, int], float]()
        for k, (body, way) in enumerate(zip(self.bodies, ways, strict=True)):
            spent = until - way.since
            closing = way.speed + body.world.fastest
            if closing and body.room - closing * spent < body.least:
                body.measure()
                near.append(k)
            closing = way.speed + fastest
            if closing and body.berth - closing * spent < body.least:
                gaps = self._measure(body)
                for other in np.flatnonzero(gaps - closing * spent < body.least).tolist():
                    pairs[min(k, other), max(k, other)] = float(gaps[other])
        return near, pairs

    def _measure(self, body: Body) -> Floats:
        """Return the gap of each robot to one robot (inf for itself), and record the gaps."""
        every = self._discs()
        away = np.hypot(every[:, 0] - body.pose.forward, every[:, 1] - body.pose.side)
        gaps: Floats = away - self._radii - body.radius
        gaps[self._numbers[body.name]] = inf
        body.berth = float(gaps.min())
        body.note(body.berth, self.bodies[int(gaps.argmin())].name)
        for name in {*body.on, *(self.bodies[k].name for k in np.flatnonzero(gaps <= APART))}:
            if name != THING:
                number = self._numbers[name]
                _note_gap(body, self.bodies[number], float(gaps[number]))
        return gaps

    def _halted(
        self, ways: Sequence[MotionSegment], held: Sequence[int], met: Sequence[tuple[int, int]]
    ) -> list[MotionSegment]:
        """Return segments in which robots that drive into a touched obstacle only turn.

        The velocities at this instant decide; in contacts between robots, the other is at rest.
        """
        halted = list(ways)

        def stay(k: int, rate: float) -> None:
            way = ways[k]
            if rate < -_ALONG * way.speed:
                halted[k] = MotionSegment(way.since, way.pose, 0.0, 0.0, way.turn)

        for k in held:
            body = self.bodies[k]
            rates = body.world.departures(
                body.place, ways[k].velocity, body.radius + TOUCH, ways[k].since
            )
            stay(k, float(rates.min(initial=inf)))
        for pair in met:
            for k, other in (pair, pair[::-1]):
                (x, y), (p, q) = self.bodies[k].place, self.bodies[other].place
                vx, vy = ways[k].velocity
                stay(k, ((x - p) * vx + (y - q) * vy) / (hypot(x - p, y - q) or 1.0))
        return halted

    def _search(self, k: int, way: MotionSegment) -> _Search:
        """Return the search for the gap of robot `k` to the world on its segment `way`."""
        body = self.bodies[k]

        def note(gap: float) -> None:
            body.note(gap, THING, way.since)
            if gap <= APART:
                body.measure()

        closing = way.speed + body.world.fastest
        return _Search(partial(body.nearest, way), closing, note, *_end_gaps(body.room))

    def _search_pair(
        self, first: int, second: int, ways: Sequence[MotionSegment], now: float
    ) -> _Search:
        """Return the search for the gap between two robots, by chords relative to the second.

        `now` is the current gap (mm).
        """
        one, other = self.bodies[first], self.bodies[second]
        way, passing = ways[first], ways[second]
        least, apart = max(one.least, other.least), one.radius + other.radius

        def gaps(edges: Floats) -> Floats:
            times = edges.ravel()
            chords = (way.points(times) - passing.points(times)).reshape(-1, 4)
            return origin_distances(chords) - apart

        def search(step: float) -> float:
            return least_gap(gaps, bend(way) + bend(passing), least, way.since, way.since + step)

        def note(gap: float) -> None:
            _note_gap(one, other, gap, way.since)
            if gap <= APART:
                _note_gap(one, other, dist(one.place, other.place) - apart)

        return _Search(search, way.speed + passing.speed, note, *_end_gaps(now))


def _end_gaps(gap: float) -> tuple[float, float]:
    """Return the `floor` and `fine` (mm) for a search that begins at a gap (mm).

    A robot may move along or away from a touched obstacle, but not further into it.
    """
    if gap > TOUCH:
        return TOUCH, TOUCH / 2
    return (0.0, gap / 2) if gap > 0 else (gap - _DEEPER, _DEEPER)


def _note_gap(one: Body, other: Body, gap: float, since: float | None = None) -> None:
    """Record the gap between two robots at both: now, or at some time after `since`."""
    one.note(gap, other.name, since)
    other.note(gap, one.name, since)
