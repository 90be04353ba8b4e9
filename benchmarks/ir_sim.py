"""One step of ours and of IR-SIM in the same crowd: drive 0.1 s on an arc, cast 24 rays of 3 m."""

import contextlib
import io
import json
import tempfile
import time
from collections.abc import Callable
from math import degrees, hypot, pi
from pathlib import Path
from random import Random
from typing import Any

import numpy as np

with contextlib.redirect_stdout(io.StringIO()):  # it tells which displays it has tried
    import irsim

from mars_asp.execution.simulator import Body, Circle, Fleet, Pose, World, sonar
from mars_asp.execution.simulator.devices import mounted

BEAMS, REACH, STEP, STEPS = 24, 3000.0, 0.1, 100
AHEAD, TURN = 200.0, 0.5  # mm/s, radians/s: a circle of 400 mm radius
#: IR-SIM looks from the right to the left; the last beam is one before the first.
ANGLES = np.linspace(-pi * (BEAMS - 1) / BEAMS, pi * (BEAMS - 1) / BEAMS, BEAMS)


def crowd(count: int) -> list[Circle]:
    """Return circles of one density, none in the robot's way."""
    random, within = Random(1), 1000.0 * (count / 2) ** 0.5
    found: list[Circle] = []
    while len(found) < count:
        x, y = random.uniform(-within, within), random.uniform(-within, within)
        radius = random.uniform(100, 300)
        if hypot(x, y) - radius > 1500:
            found.append(Circle((x, y), radius))
    return found


def theirs(circles: list[Circle]) -> Any:
    """Return IR-SIM's world; lengths in metres."""
    wide = 2 * max(hypot(*circle.centre) for circle in circles) / 1000 + 4
    lidar = {
        "name": "lidar2d",
        "range_max": REACH / 1000,
        "angle_range": float(ANGLES[-1] - ANGLES[0]),
        "number": BEAMS,
    }
    robot = {
        "kinematics": {"name": "diff"},
        "shape": {"name": "circle", "radius": 0.2},
        "state": [0, 0, 0],
        "sensors": [lidar],
    }
    obstacles = [
        {
            "shape": {"name": "circle", "radius": c.radius / 1000},
            "state": [c.centre[0] / 1000, c.centre[1] / 1000, 0],
        }
        for c in circles
    ]
    world = {
        "height": wide,
        "width": wide,
        "offset": [-wide / 2, -wide / 2],
        "step_time": STEP,
        "sample_time": STEP,
    }
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "world.yaml"
        path.write_text(json.dumps({"world": world, "robot": [robot], "obstacle": obstacles}))
        return irsim.make(str(path), headless=True, log_level="ERROR", seed=1)


def compare(count: int) -> tuple[float, float]:
    """Return milliseconds of processor time a step, theirs and ours.

    Before the clock starts, rays from one place are compared: both have to do the same work.
    """
    circles = crowd(count)
    env, world = theirs(circles), World(circles=circles)
    (body,) = Fleet([Body(world, Pose(0.0, 0.0, 0.0), 200.0, up="z")]).bodies
    body.obey({"Trans_X": AHEAD, "Rotn_Z": degrees(TURN)}, 0.0)
    read = sonar(body, mounted(body), Random(1), beams=BEAMS, rays=1, reach=REACH)
    env.step([AHEAD / 1000, TURN])
    x, y, heading = (float(value) for value in env.robot.state[:3, 0])
    seen = 1000 * np.array(env.robot.get_lidar_scan()["ranges"])
    ours = world.rays((1000 * x, 1000 * y), ANGLES + heading, REACH, 0.0)
    assert np.abs(np.minimum(ours, REACH) - seen).max() < 1.0, "the worlds differ"
    they = timed(lambda step: env.step([AHEAD / 1000, TURN]))
    return they, timed(lambda step: read(step * STEP))


def timed(action: Callable[[int], object]) -> float:
    # What is loaded with the first steps is no part of a step.
    for step in range(1, STEPS + 1):
        action(step)
    started = time.process_time()
    for step in range(STEPS + 1, 2 * STEPS + 1):
        action(step)
    return 1000 * (time.process_time() - started) / STEPS
