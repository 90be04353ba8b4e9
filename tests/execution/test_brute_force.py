"""Runs judged a second time, by fine sampling in plain Python, which shares nothing with the judge.

`python -m tests.execution.test_brute_force 500` compares that many random runs.
"""

import sys
from dataclasses import dataclass, field
from itertools import pairwise
from math import cos, hypot, inf, pi, radians, sin
from pathlib import Path
from random import Random

import pytest

from mars_asp.execution.judgement import judge
from mars_asp.execution.scenario.read import read_scenario
from mars_asp.execution.trial import Trial, stage_trial
from mars_asp.language import parse_text

STEP = 0.001
FASTEST = 400.0
DRIVE = """\
@specification flat
@modules P, C, D
P is_controlled_by ArbitrationNode
ArbitrationNode is_controlled_by C
ArbitrationNode is_controlled_by D
"""
FUNCTIONS = ("Trans_Z", "Trans_X", "Rotn_Y")
Point = tuple[float, float]


@dataclass
class Case:
    """A random scenario, as numbers; lengths in mm, angles in degrees, times in s."""

    duration: float
    radius: float
    start: tuple[float, float, float]
    scripts: list[list[tuple[float, str, float]]]
    place: Point
    near: float
    within: float
    walls: list[list[Point]] = field(default_factory=list)
    polygons: list[list[Point]] = field(default_factory=list)
    circles: list[tuple[float, float, float]] = field(default_factory=list)
    moving: list[tuple[Point, Point, float, float]] = field(default_factory=list)

    @property
    def text(self) -> str:
        moving = ", ".join(
            f"{{ from = {list(a)}, to = {list(b)}, radius = {r}, speed = {v} }}"
            for a, b, r, v in self.moving
        )
        hands = "".join(
            f'[devices.{name}]\nkind = "joystick"\nscript = {_lists(script)}\n'
            for name, script in zip("CD", self.scripts, strict=True)
        )
        return f"""duration = {self.duration}
[robot]
module = "P"
radius = {self.radius}
start = {list(self.start)}
[world]
walls = {_lists(self.walls)}
polygons = {_lists(self.polygons)}
circles = {_lists(self.circles)}
moving = [{moving}]
{hands}
[requirements]
no_collision = true
clearance = 50
coverage = 0.1
exclusive = [["Trans_Z", "Rotn_Y"]]
reach = {{ at = {list(self.place)}, radius = {self.near}, within = {self.within} }}
"""


def _lists(value: object) -> object:
    return [_lists(each) for each in value] if isinstance(value, list | tuple) else value


def random_case(random: Random) -> Case:
    def point(reach: float = 1200) -> Point:
        return random.uniform(-reach, reach), random.uniform(-reach, reach)

    def box(centre: Point, size: float) -> list[Point]:
        turn = random.uniform(0, pi)
        corners = ((k * pi / 2 + turn) for k in range(random.randint(3, 4)))
        return [(centre[0] + size * cos(a), centre[1] + size * sin(a)) for a in corners]

    def is_clear(at: Point, size: float) -> bool:
        return hypot(*at) > size + 260

    duration = random.uniform(2, 5)
    scripts: list[list[tuple[float, str, float]]] = [[], []]
    for script in scripts:
        for begins in sorted(random.sample(range(int(duration * 1000)), random.randint(1, 6))):
            function = random.choice(FUNCTIONS)
            rate = random.uniform(-90, 90) if function == "Rotn_Y" else random.uniform(-280, 280)
            script.append((begins / 1000, function, round(rate, 1)))
    case = Case(
        duration,
        random.uniform(50, 250),
        (0.0, 0.0, random.uniform(-180, 180)),
        scripts,
        place=point(500),
        near=random.uniform(20, 300),
        within=random.uniform(0.5, 7),
    )
    for _ in range(random.randint(0, 5)):
        (x, y), size = point(), random.uniform(20, 300)
        if is_clear((x, y), 400):
            case.walls.append([(x, y), (x + 300, y - 200), (x, y + 300)])
        if is_clear((x, y), size):
            kind = random.randrange(3)
            if kind == 0:
                case.polygons.append(box((x, y), size))
            elif kind == 1:
                case.circles.append((x, y, size))
            else:
                case.moving.append(((x, y), point(), size, random.uniform(0, FASTEST)))
    return case


@dataclass
class Sampled:
    """The results of fine sampling, as precise as its step."""

    contact: float | None = None
    least: float = inf
    reached: float | None = None
    nearest: float = inf
    squares: set[tuple[int, int]] = field(default_factory=set)
    both: int = 0
    share: float = 0.0
    one: float = 1.0


def sample(case: Case) -> Sampled:
    """Drive by small steps; the first contact ends it."""
    seen, (x, y, heading), means = Sampled(), case.start, averages(case)
    corners = [p for line in (*case.walls, *case.polygons) for p in line]
    low = [min((p[k] for p in corners), default=0.0) for k in (0, 1)]
    high = [max((p[k] for p in corners), default=0.0) for k in (0, 1)]
    size = 2 * case.radius
    rows, columns = int((high[0] - low[0]) // size), int((high[1] - low[1]) // size)
    for step in range(round(case.duration / STEP) + 1):
        at = step * STEP
        gap = least_gap(case, (x, y), at) - case.radius
        seen.least = min(seen.least, max(gap, 0.0))
        far = hypot(x - case.place[0], y - case.place[1])
        if at <= case.within:
            seen.nearest = min(seen.nearest, far)
            if far <= case.near and seen.reached is None:
                seen.reached = at
        square = int((x - low[0]) // size), int((y - low[1]) // size)
        if 0 <= square[0] < rows and 0 <= square[1] < columns:
            seen.squares.add(square)
            seen.share = len(seen.squares) / (rows * columns)
            seen.one = 1 / (rows * columns)
        if gap <= 1e-3:
            seen.contact = at
            return seen
        rates = means[step // 100]
        seen.both += bool(rates["Trans_Z"] and rates["Rotn_Y"])
        way = radians(heading + rates["Rotn_Y"] * STEP / 2)
        ahead, aside = rates["Trans_Z"] * STEP, rates["Trans_X"] * STEP
        x, y = x + ahead * cos(way) - aside * sin(way), y + ahead * sin(way) + aside * cos(way)
        heading += rates["Rotn_Y"] * STEP
    return seen


def averages(case: Case) -> list[dict[str, float]]:
    """Return the average of each tenth of a second, in which each joystick is read at the end."""
    means: list[dict[str, float]] = [dict.fromkeys(FUNCTIONS, 0.0)]
    for k in range(1, round(case.duration * 10) + 2):
        entries: dict[str, list[float]] = {}
        for script in case.scripts:
            for tick in (0, 1) if k == 1 else (k,):
                past = [(f, r) for since, f, r in script if since <= tick / 10]
                if past:
                    entries.setdefault(past[-1][0], []).append(past[-1][1])
        means.append(
            {f: sum(entries.get(f, [0.0])) / len(entries.get(f, [0.0])) for f in FUNCTIONS}
        )
    return means


def least_gap(case: Case, at: Point, seconds: float) -> float:
    gaps = [inf]
    for line in (*case.walls, *([*rim, rim[0]] for rim in case.polygons)):
        gaps += [to_segment(at, a, b) for a, b in pairwise(line)]
    gaps += [hypot(at[0] - x, at[1] - y) - r for x, y, r in case.circles]
    for (ax, ay), (bx, by), radius, speed in case.moving:
        length = hypot(bx - ax, by - ay)
        share = abs((seconds * speed / length + 1) % 2 - 1)
        cx, cy = ax + share * (bx - ax), ay + share * (by - ay)
        gaps.append(hypot(at[0] - cx, at[1] - cy) - radius)
    return min(gaps)


def to_segment(p: Point, a: Point, b: Point) -> float:
    dx, dy = b[0] - a[0], b[1] - a[1]
    share = ((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / (dx * dx + dy * dy)
    share = min(1.0, max(0.0, share))
    return hypot(p[0] - a[0] - share * dx, p[1] - a[1] - share * dy)


def run(case: Case) -> Trial:
    scenario = read_scenario(case.text, Path("s.toml"))
    made = stage_trial(parse_text(DRIVE, "x.mars").configuration, {}, scenario)
    made.run_until(scenario.duration)
    return made


def difference(case: Case) -> str:
    """Return a difference of judge and samples that is larger than a step, or an empty text."""
    made, seen, off = run(case), sample(case), 2 * FASTEST * STEP
    first = next(iter(made.bodies[0].contacts), None)
    if (first is None) != (seen.contact is None):
        # A touch between two samples: they saw it come as near as that.
        return (
            "" if first is not None and seen.least <= off else f"contact: {first}, {seen.contact}"
        )
    if first is not None and seen.contact is not None:
        # A glancing touch is found at once, but by samples only once it is as deep as they see.
        late = seen.contact - first
        return "" if -1e-6 <= late <= 0.05 else f"contact at {first}, sampled at {seen.contact}"
    if made.bodies[0].clearance < inf and not -off <= seen.least - made.bodies[0].clearance <= off:
        return f"clearance {made.bodies[0].clearance}, sampled {seen.least}"
    (robot,) = made.scenario.robots
    reached, (nearest, _) = made.reached(robot), made.nearest(robot)
    if not -off <= seen.nearest - nearest <= off:
        return f"nearest {nearest}, sampled {seen.nearest}"
    edge = abs(nearest - case.near) <= off
    if (reached is None) != (seen.reached is None) and not edge:
        return f"reached {reached}, sampled {seen.reached}"
    if reached is not None and seen.reached is not None and not edge:
        far = abs(seen.reached - reached) * FASTEST
        if not -1e-9 <= seen.reached - reached <= 0.05 or far > 25:
            return f"reached at {reached}, sampled {seen.reached}"
    # Corners of squares are cut in less than a step.
    if not seen.share - 1e-9 <= made.coverage <= seen.share + 2 * seen.one:
        return f"coverage {made.coverage}, sampled {seen.share}"
    together, _ = made.together("Trans_Z", "Rotn_Y")
    if abs(together - seen.both * STEP) > 2 * STEP:
        return f"together {together} s, sampled {seen.both} steps"
    holds = {r.name: r.holds for r in judge(made).requirements}
    expected = reached is not None or (None if case.within > case.duration else False)
    if holds["reach"] is not expected or holds["no_collision"] is not (first is None):
        return f"{holds} with {expected}"
    return ""


@pytest.mark.parametrize("seed", range(12))
def test_the_judge_agrees_with_fine_samples(seed: int) -> None:
    assert difference(random_case(Random(seed))) == ""


if __name__ == "__main__":
    count = int(sys.argv[1])
    wrong = {s: text for s in range(count) if (text := difference(random_case(Random(s))))}
    print(f"{count} runs, {len(wrong)} differ", *wrong.items(), sep="\n")
