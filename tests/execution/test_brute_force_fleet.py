"""Runs of two robots judged a second time, by fine sampling, which shares nothing with the judge.

`python -m tests.execution.test_brute_force_fleet 200` compares that many random runs.
"""

import sys
from dataclasses import dataclass, field
from itertools import pairwise
from math import cos, hypot, inf, radians, sin
from pathlib import Path
from random import Random

import pytest

from mars_asp.execution.judgement import judge
from mars_asp.execution.scenario.read import read_scenario
from mars_asp.execution.trial import Trial, stage_trial
from mars_asp.language import parse_text
from tests.execution.test_brute_force import FASTEST, FUNCTIONS, to_segment
from tests.support.campaigns import seeds

STEP = 0.0005
DRIVE = """\
@specification
@modules left/P, left/C, right/P, right/C
left/P is_controlled_by left/C
right/P is_controlled_by right/C
"""
Point = tuple[float, float]
Script = list[tuple[float, str, float]]


@dataclass
class Robot:
    """A robot with a joystick; mm, degrees, s. Without an acceleration it changes at once."""

    name: str
    radius: float
    start: tuple[float, float, float]
    script: Script
    acceleration: float = inf
    deceleration: float = inf


@dataclass
class Case:
    """A random scenario of two robots, as numbers."""

    duration: float
    robots: list[Robot]
    walls: list[tuple[Point, Point]] = field(default_factory=list)
    moving: list[tuple[list[Point], float, float]] = field(default_factory=list)

    @property
    def text(self) -> str:
        return f"""duration = {self.duration}
{"".join(map(robot_text, self.robots))}
[world]
walls = {[[list(end) for end in wall] for wall in self.walls]}
moving = [{", ".join(moving_text(*each) for each in self.moving)}]
[requirements]
no_collision = true
clearance = 50
"""


def moving_text(way: list[Point], radius: float, speed: float) -> str:
    return f"{{ way = {[list(at) for at in way]}, radius = {radius}, speed = {speed} }}"


def robot_text(robot: Robot) -> str:
    gradual = ""
    if robot.acceleration < inf:
        for key, value in (
            ("acceleration", robot.acceleration),
            ("deceleration", robot.deceleration),
        ):
            gradual += f"{key} = {{ Trans_Z = {value}, Trans_X = {value} }}\n"
    return f"""[[robot]]
name = "{robot.name}"
module = "{robot.name}/P"
radius = {robot.radius}
start = {list(robot.start)}
{gradual}[devices."{robot.name}/C"]
kind = "joystick"
script = {[list(entry) for entry in robot.script]}
"""


def random_case(random: Random) -> Case:
    duration = random.uniform(2, 5)
    robots = []
    sizes = random.uniform(50, 250), random.uniform(50, 250)
    apart = sum(sizes) + random.uniform(20, 500)
    for name, radius, forward in zip(("left", "right"), sizes, (0.0, apart), strict=True):
        script: Script = []
        for begins in sorted(random.uniform(0, duration) for _ in range(random.randint(1, 6))):
            function = random.choice((*FUNCTIONS, "Trans_Z"))
            rate = random.uniform(-90, 90) if function == "Rotn_Y" else random.uniform(-280, 280)
            script.append((round(begins, 3), function, round(rate, 1)))
        robot = Robot(name, radius, (forward, 0.0, random.uniform(-180, 180)), script)
        if random.random() < 0.4:
            robot.acceleration, robot.deceleration = (random.uniform(100, 900) for _ in "ud")
        robots.append(robot)
    case = Case(duration, robots)
    for _ in range(random.randint(0, 3)):
        x, y = random.uniform(-900, 1500), random.choice((-1, 1)) * random.uniform(600, 1200)
        if random.random() < 0.5:
            case.walls.append(((x, y), (x + random.uniform(-300, 300), y * 1.2)))
        else:
            way = [(x, y), (x + 200, y * 1.3), (x - 100, y * 1.4)]
            way += [way[0]] * random.randint(0, 1)
            case.moving.append((way, random.uniform(20, 200), random.uniform(1, FASTEST)))
    return case


@dataclass
class Sampled:
    """The instant (in s) of the first contact, its pairs, and the smallest gap of each robot."""

    contact: float | None = None
    pairs: set[frozenset[str]] = field(default_factory=set)
    least: list[float] = field(default_factory=lambda: [inf, inf])


def sample(case: Case) -> Sampled:
    """Drive by small steps; the first contact ends it."""
    seen = Sampled()
    states = [list(robot.start) for robot in case.robots]
    rates = [dict.fromkeys(FUNCTIONS, 0.0) for _ in case.robots]
    for step in range(round(case.duration / STEP) + 1):
        at = step * STEP
        between = hypot(states[0][0] - states[1][0], states[0][1] - states[1][1])
        between -= case.robots[0].radius + case.robots[1].radius
        for k, robot in enumerate(case.robots):
            world = world_gap(case, (states[k][0], states[k][1]), at) - robot.radius
            seen.least[k] = min(seen.least[k], max(0.0, min(world, between)))
            if world <= 1e-3:
                seen.pairs.add(frozenset({robot.name, ""}))
        if between <= 1e-3:
            seen.pairs.add(frozenset({"left", "right"}))
        if seen.pairs:
            seen.contact = at
            return seen
        for robot, state, rate in zip(case.robots, states, rates, strict=True):
            drive(robot, state, rate, at)
    return seen


def drive(robot: Robot, state: list[float], rate: dict[str, float], at: float) -> None:
    """Move a robot by a step; an accelerated function has the mean rate of the step's ends."""
    # Read at each tenth of a second.
    past = [entry for entry in robot.script if entry[0] <= int(at * 10 + 1e-6) / 10]
    wanted = {past[-1][1]: past[-1][2]} if past else {}
    mean = dict[str, float]()
    for function in FUNCTIONS:
        before, goal = rate[function], wanted.get(function, 0.0)
        slows = before * goal < 0 or abs(goal) < abs(before)
        most = (robot.deceleration if slows else robot.acceleration) * STEP
        if function == "Rotn_Y":
            most = inf
        goal = 0.0 if most < inf and before * goal < 0 else goal
        rate[function] = goal if abs(goal - before) <= most else before + most * sign(goal - before)
        mean[function] = rate[function] if most == inf else (before + rate[function]) / 2
    way = radians(state[2] + mean["Rotn_Y"] * STEP / 2)
    ahead, aside = mean["Trans_Z"] * STEP, mean["Trans_X"] * STEP
    state[0] += ahead * cos(way) - aside * sin(way)
    state[1] += ahead * sin(way) + aside * cos(way)
    state[2] += mean["Rotn_Y"] * STEP


def sign(value: float) -> int:
    return 1 if value > 0 else -1


def world_gap(case: Case, at: Point, seconds: float) -> float:
    gaps = [inf, *(to_segment(at, *wall) for wall in case.walls)]
    for way, radius, speed in case.moving:
        x, y = walked(way, seconds * speed)
        gaps.append(hypot(at[0] - x, at[1] - y) - radius)
    return min(gaps)


def walked(way: list[Point], gone: float) -> Point:
    """Return the place on a way, there and back or round and round, after so many mm."""
    points = way if way[-1] == way[0] else [*way, *way[-2::-1]]
    legs = [hypot(b[0] - a[0], b[1] - a[1]) for a, b in pairwise(points)]
    gone %= sum(legs)
    for (x, y), (tx, ty), leg in zip(points[:-1], points[1:], legs, strict=True):
        if gone <= leg:
            return x + gone / leg * (tx - x), y + gone / leg * (ty - y)
        gone -= leg
    return points[-1]


def run(case: Case) -> Trial:
    scenario = read_scenario(case.text, Path("s.toml"))
    made = stage_trial(parse_text(DRIVE, "x.mars").configuration, {}, scenario)
    made.run_until(scenario.duration)
    return made


def difference(case: Case) -> str:
    """Return a difference of judge and samples that is larger than a step, or an empty text."""
    made, seen, off = run(case), sample(case), 2 * FASTEST * STEP + 0.3
    contacts = [
        (at, frozenset({body.name, other}))
        for body in made.bodies
        for at, other in zip(body.contacts, body.struck, strict=True)
    ]
    first, pair = min(contacts, default=(None, None), key=lambda each: each[0])
    holds = {r.name: r.holds for r in judge(made).requirements}
    if holds["no_collision"] is not (first is None):
        return f"{holds} with {first}"
    if (first is None) != (seen.contact is None):
        # A touch between two samples: they saw it come as near as that.
        grazed = min(seen.least) <= off if first is not None else made.clearance <= 0.3
        return "" if grazed else f"contact: {first}, {seen.contact}"
    if first is not None and seen.contact is not None:
        late = seen.contact - first
        if not -0.005 <= late <= 0.05:
            return f"contact at {first}, sampled at {seen.contact}"
        return "" if pair in seen.pairs or len(contacts) > 2 else f"{pair}, sampled {seen.pairs}"
    for body, sampled in zip(made.bodies, seen.least, strict=True):
        if body.clearance < inf and not -off <= sampled - body.clearance <= off:
            return f"clearance {body.clearance} of {body.name}, sampled {sampled}"
    return ""


@pytest.mark.parametrize("seed", seeds(2, 8))
def test_the_judge_agrees_with_fine_samples_of_two_robots(seed: int) -> None:
    assert difference(random_case(Random(seed))) == ""


if __name__ == "__main__":
    count = int(sys.argv[1])
    wrong = {s: text for s in range(count) if (text := difference(random_case(Random(s))))}
    print(f"{count} runs, {len(wrong)} differ", *wrong.items(), sep="\n")
