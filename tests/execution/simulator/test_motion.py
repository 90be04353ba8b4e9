"""Contacts and distances on lines and arcs, against dense samples of the same motion."""

from itertools import pairwise
from math import ceil, hypot, inf, pi, radians
from random import Random

import numpy as np
import pytest

from mars_asp.execution.simulator import Circle, MotionSegment, Pose, World
from mars_asp.execution.simulator.motion import Floats
from tests.support.bodies import alone
from tests.support.campaigns import seeds
from tests.support.polygons import regular_polygon

SEEDS = seeds(10, 60)


def drawn(random: Random) -> tuple[MotionSegment, float]:
    """Return a random stretch and how long it lasts: a few of them lines, some of many turns."""
    turn = random.choice((0.0, 1e-7, random.uniform(-40, 40), random.uniform(-400, 400)))
    rates = random.uniform(-500, 500), random.choice((0.0, random.uniform(-500, 500)))
    pose = Pose(random.uniform(-200, 200), random.uniform(-200, 200), random.uniform(-180, 180))
    return MotionSegment(random.choice((0.0, 3.5)), pose, *rates, turn), random.uniform(0.5, 8)


def samples(way: MotionSegment, seconds: float, step: float = 2e-4) -> tuple[Floats, Floats]:
    """Return times (n,) and places (n, 2), added up in small steps by the midpoint rule."""
    count = ceil(seconds / step)
    width = seconds / count
    heading = np.radians(way.pose.heading) + radians(way.turn) * width * (np.arange(count) + 0.5)
    velocity = (way.ahead + 1j * way.aside) * np.exp(1j * heading)
    places = np.concatenate([[0], np.cumsum(velocity * width)])
    places = places + complex(way.pose.forward, way.pose.side)
    times = way.since + width * np.arange(count + 1)
    placed: Floats = np.stack([places.real, places.imag], axis=1)
    return np.asarray(times, dtype=float), placed


@pytest.mark.parametrize("seed", SEEDS)
def test_where_and_when_it_comes_near_to_a_place(seed: int) -> None:
    random = Random(seed)
    way, seconds = drawn(random)
    times, places = samples(way, seconds)
    assert np.allclose(way.points(times), places, atol=2e-3)
    place = random.uniform(-900, 900), random.uniform(-900, 900)
    far = np.hypot(*(places - place).T)
    nearest, when = way.nearest(place, way.since + seconds)
    assert nearest == pytest.approx(far.min(), abs=0.2)
    pose = way.at(when)
    assert hypot(pose.forward - place[0], pose.side - place[1]) == pytest.approx(nearest, abs=1e-6)
    radius = random.uniform(10, 900)
    entered = way.enters(place, radius, way.since + seconds)
    first = times[far <= radius]
    if entered is None:
        assert not len(first) or far.min() > radius - 1e-2
    else:
        pose = way.at(entered)
        at_rim = hypot(pose.forward - place[0], pose.side - place[1])
        assert entered == way.since or at_rim == pytest.approx(radius, abs=1e-5)
        assert (far[times < entered - 2e-4] > radius - 1e-2).all()
        assert not len(first) or entered <= first[0] + 1e-4


@pytest.mark.parametrize("seed", SEEDS)
def test_when_it_passes_lines(seed: int) -> None:
    random = Random(seed)
    way, seconds = drawn(random)
    times, places = samples(way, seconds)
    for axis in (0, 1):
        found = sorted(way.crossings(axis, 170.0, 30.0, way.since + seconds))
        rows = np.floor((places[:, axis] - 30.0) / 170.0)
        passed = times[1:][rows[1:] != rows[:-1]]
        # Samples miss what turns back at once.
        assert all(any(abs(t - f) < 1e-3 for f in found) for t in passed)
        for at in found:
            pose = way.at(at)
            off = ((pose.forward, pose.side)[axis] - 30.0) / 170.0
            assert abs(off - round(off)) < 1e-5


@pytest.mark.parametrize("seed", SEEDS)
def test_the_least_clearance_and_the_first_contact_of_one_long_step(seed: int) -> None:
    random = Random(seed)
    way, seconds = drawn(random)
    start = way.pose.forward, way.pose.side

    def point(reach: float = 3000) -> tuple[float, float]:
        return random.uniform(-reach, reach), random.uniform(-reach, reach)

    walls, polygons, circles = [], [], []
    for _ in range(random.randint(1, 12)):
        at = point()
        if hypot(at[0] - start[0], at[1] - start[1]) < 700:
            continue
        walls.append([at, (at[0] + random.uniform(-200, 200), at[1] + random.uniform(-200, 200))])
        polygons.append(regular_polygon((20_000, 0), 90, 5))
        legs = tuple(point() for _ in range(random.randint(0, 3)))
        circles.append(Circle(at, random.uniform(5, 200), legs, random.uniform(0, 300)))
    world = World(walls, polygons, circles)
    times, places = samples(way, seconds, 1e-3)
    gaps = np.array([plain_gap(walls, circles, p, t) for p, t in zip(places, times, strict=True)])
    gaps -= 100
    command = {"Trans_Z": way.ahead, "Trans_X": way.aside, "Rotn_Y": way.turn}
    body = alone(world, way.pose, 100, command=command, seconds=way.since)
    body.advance(way.since + seconds)
    hit = times[gaps <= 0]
    slow = 1e-3 * (way.speed + 300)
    if not body.contacts:
        assert not len(hit)
        least = gaps.min(initial=inf)
        assert least - slow <= body.clearance <= least + 1e-2
    else:
        assert gaps.min() <= slow
        assert not len(hit) or body.contacts[0] <= hit[0] + 1e-3
        assert (gaps[times < body.contacts[0] - 1e-3] > -1e-2).all()


def plain_gap(
    walls: list[list[tuple[float, float]]], circles: list[Circle], at: Floats, time: float
) -> float:
    found = [inf]
    p = complex(*at)
    for a, b in walls:
        start, along = complex(*a), complex(*b) - complex(*a)
        share = ((p - start) * along.conjugate()).real / abs(along) ** 2
        found.append(abs(p - start - min(1.0, max(0.0, share)) * along))
    for circle in circles:
        points = [complex(*c) for c in (circle.centre, *circle.way)]
        left = time * circle.speed
        rounds = [*points, *points[-2::-1]]
        length = sum(abs(b - a) for a, b in pairwise(rounds))
        place = rounds[0]
        left = left % length if length else 0.0
        for here, there in pairwise(rounds):
            if left <= abs(there - here):
                place = here + (there - here) / abs(there - here) * left if here != there else here
                break
            left -= abs(there - here)
        found.append(abs(p - place) - circle.radius)
    return min(found)


def test_a_circuit_goes_round_and_does_not_turn_back() -> None:
    square = ((100.0, 0.0), (100.0, 100.0), (0.0, 100.0), (0.0, 0.0))
    round_, back = Circle((0, 0), 5, square, 100), Circle((0, 0), 5, square[:-1], 100)
    assert [round_.at(t) for t in (0, 0.5, 3.5, 4, 4.5)] == [
        (0, 0),
        (50, 0),
        (0, 50),
        (0, 0),
        (50, 0),
    ]
    assert [back.at(t) for t in (3, 3.5, 5.5, 6.5)] == [(0, 100), (50, 100), (50, 0), (50, 0)]


def test_a_polygon_is_solid_and_a_circle_too() -> None:
    world = World(polygons=[regular_polygon((0, 0), 500, 4)], circles=[Circle((3000, 0), 200)])
    assert world.distance((0, 0), 0) == pytest.approx(-500 / 2**0.5)
    assert world.distance((3050, 0), 0) == pytest.approx(-150)
    assert world.distance((1000, 0), 0) == pytest.approx(500)
    for inside in ((100.0, 50.0), (3000.0, 199.0)):
        assert world.rays(inside, np.array([0.0, pi]), 9000, 0).tolist() == [0, 0]


def test_far_obstacles_are_measured() -> None:
    body = alone(World(circles=[Circle((50_000, 0), 1000)]), Pose(0, 0, 0), 200)
    assert body.clearance == 48_800
    body.obey({"Trans_Z": 1000}, 0)
    body.advance(30)
    assert body.clearance == pytest.approx(18_800)
