"""Rays against those of a physics engine, MuJoCo, on random worlds; in metres there, mm here."""

from itertools import pairwise
from math import atan2, cos, degrees, dist, hypot, inf, pi, sin
from random import Random
from typing import Any, TypeAlias

import mujoco
import numpy as np
import numpy.typing as npt

from mars_asp.execution.simulator import Circle, World
from tests.support.campaigns import seeds
from tests.support.polygons import regular_polygon

Floats: TypeAlias = npt.NDArray[np.float64]
Point: TypeAlias = tuple[float, float]
BEAMS, REACH = 24, 6000.0


def random_world(random: Random) -> tuple[World, str]:
    """Return a world of ours, and the same as geoms of MuJoCo."""

    def point() -> Point:
        return random.uniform(-4000, 4000), random.uniform(-4000, 4000)

    walls = [[point() for _ in range(random.randint(2, 4))] for _ in range(random.randint(0, 4))]
    polygons = [
        regular_polygon(point(), random.uniform(50, 900), random.randint(3, 7))
        for _ in range(random.randint(0, 3))
    ]
    boxes = [
        (*point(), random.uniform(50, 900), random.uniform(50, 900), random.uniform(-pi, pi))
        for _ in range(random.randint(0, 4))
    ]
    circles = [Circle(point(), random.uniform(20, 900)) for _ in range(random.randint(0, 6))]
    moving = [Circle(point(), random.uniform(20, 900), (point(),), 100) for _ in range(2)]
    world = World(walls, [*polygons, *map(corners, boxes)], [*circles, *moving])
    lines = [*walls, *([*polygon, polygon[0]] for polygon in polygons)]
    geoms = [
        *(plane(*ends, side) for w in lines for ends in pairwise(w) for side in "+-"),
        *(geom("box", (x, y), (a, b, 1000), f"0 0 {degrees(turn)}") for x, y, a, b, turn in boxes),
        *(geom("cylinder", c.centre, (c.radius, 1000)) for c in circles),
        *(geom("cylinder", along(c, 700), (c.radius, 1000)) for c in moving),
    ]
    return world, "".join(geoms)


def along(circle: Circle, gone: float) -> Point:
    """Return where a circle is that has gone some way towards its target and back."""
    (target,) = circle.way
    way = dist(circle.centre, target)
    share = 1 - abs(1 - gone / way % 2)
    (x, y), (tx, ty) = circle.centre, target
    return x * (1 - share) + tx * share, y * (1 - share) + ty * share


def corners(box: tuple[float, ...]) -> list[Point]:
    """Return the corners of a box: centre, half its length and breadth, and its turn."""
    x, y, a, b, turn = box
    signs = ((1, 1), (-1, 1), (-1, -1), (1, -1))
    c, s = cos(turn), sin(turn)
    return [(x + i * a * c - j * b * s, y + i * a * s + j * b * c) for i, j in signs]


def plane(start: Point, end: Point, side: str) -> str:
    """Return one side of a wall: MuJoCo sees a plane from its front only."""
    heading = degrees(atan2(end[1] - start[1], end[0] - start[0]))
    middle = (start[0] + end[0]) / 2, (start[1] + end[1]) / 2
    half = hypot(end[0] - start[0], end[1] - start[1]) / 2
    return geom("plane", middle, (half, 1000, 1000), f"{side}90 0 {heading}")


def geom(kind: str, at: Point, size: tuple[float, ...], turns: str = "0 0 0") -> str:
    """Return a geom with its size in mm; `turns` are about fixed x, y and z."""
    sizes = " ".join(f"{length / 1000!r}" for length in size)
    place = f"{at[0] / 1000!r} {at[1] / 1000!r} 0"
    return f'<geom type="{kind}" pos="{place}" size="{sizes}" euler="{turns}"/>'


def mujoco_rays(geoms: str, origin: Point, angles: Floats) -> Floats:
    """Return how far each ray goes, in metres; a miss is inf."""
    text = f'<mujoco><compiler eulerseq="XYZ"/><worldbody>{geoms}</worldbody></mujoco>'
    model: Any = mujoco.MjModel.from_xml_string(text)
    state: Any = mujoco.MjData(model)
    mujoco.mj_kinematics(model, state)
    ways = np.stack([np.cos(angles), np.sin(angles), np.zeros(len(angles))], axis=1)
    hits, geom_ids = np.zeros(len(angles)), np.zeros(len(angles), dtype=np.int32)
    start = np.array([*origin, 0.0]) / 1000
    mujoco.mj_multiRay(
        model, state, start, ways.ravel(), None, True, -1, geom_ids, hits, None, len(angles), 1e9
    )
    hits[geom_ids < 0] = inf
    return hits


def test_rays_agree_with_mujocos_in_random_worlds() -> None:
    hits, wrong = 0, []
    worlds = seeds(150, 1000)
    for seed in worlds:
        random = Random(seed)
        world, geoms = random_world(random)
        origin = random.uniform(-3000, 3000), random.uniform(-3000, 3000)
        angles = np.array([random.uniform(-pi, pi) for _ in range(BEAMS)])
        got = world.rays(origin, angles, REACH, 7.0) / 1000
        if world.distance(origin, 7.0) < 0:
            # What is solid hides everything from what is in it; MuJoCo sees its rim from inside.
            assert not got.any()
            continue
        expected = mujoco_rays(geoms, origin, angles)
        expected[expected > REACH / 1000] = inf
        hits += int(np.isfinite(expected).sum())
        if not np.allclose(got, expected, rtol=0, atol=1e-9):
            wrong.append(seed)
    assert wrong == []
    assert 0.5 < hits / (len(worlds) * BEAMS) < 0.95
