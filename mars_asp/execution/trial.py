"""A specification in a scenario: world, robot, devices and executor, put together and run."""

from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise
from math import cos, hypot, inf, radians, sin
from random import Random
from typing import Any

from mars_asp.diagnostic import Diagnostic, MarsError
from mars_asp.execution.executor import Executor
from mars_asp.execution.executor.link import Observer
from mars_asp.execution.executor.plan import Plan
from mars_asp.execution.executor.schedule import MILLISECOND, SECOND
from mars_asp.execution.parts import in_parts
from mars_asp.execution.scenario.agreement import disagreements
from mars_asp.execution.scenario.devices import bind_devices, make_joints
from mars_asp.execution.scenario.functions import bind_functions
from mars_asp.execution.scenario.read import Scenario
from mars_asp.execution.simulator import (
    Body,
    Circle,
    Mark,
    Pose,
    World,
)
from mars_asp.execution.simulator.body import planar_functions
from mars_asp.model.declarations import GRASP, Configuration, Function, Module


@dataclass(frozen=True)
class Trial:
    """A run: `executor` and `body` hold what happened.

    `limits` are rates by module, `moves` the functions that each simulated device carries out,
    `remarks` warnings about the scenario.
    """

    scenario: Scenario
    executor: Executor
    body: Body
    limits: Mapping[str, Mapping[str, float]]
    moves: Mapping[str, tuple[str, ...]]
    remarks: tuple[Diagnostic, ...] = ()

    def run_until(self, seconds: float) -> None:
        """Run events and motion up to a time."""
        self.executor.step_until(round(seconds * SECOND))
        self.body.advance(seconds)

    @property
    def control_time(self) -> dict[str, float]:
        """Return for how many seconds each module's command was in force at the robot."""
        times: defaultdict[str, float] = defaultdict(float)
        for since, until, origin, _ in self.commands:
            if origin:
                times[origin] += until - since
        return dict(sorted(times.items()))

    def together(self, first: str, second: str) -> float:
        """Return for how many seconds two functions of the robot ran at once."""
        return sum(
            until - since
            for since, until, _, command in self.commands
            if command.get(first) and command.get(second)
        )

    @property
    def commands(self) -> Iterator[tuple[float, float, str, dict[str, float]]]:
        """Yield from when (s) until when the robot obeyed which module, and its command."""
        effector = self.executor.effectors.get(self.scenario.robot["module"])
        if effector is None:
            return
        end: tuple[int, str, dict[str, float]] = (self.executor.schedule.now, "", {})
        for (since, origin, command), (until, _, _) in pairwise([*effector.applied, end]):
            yield since / SECOND, until / SECOND, origin, command

    @property
    def reached(self) -> float | None:
        """Return when the robot was first at the place it was to reach."""
        asked = self.scenario.requirements["reach"]
        x, y = asked["at"]
        for at, pose in self.body.track:
            near = hypot(pose.forward - x, pose.side - y) <= asked.get("radius", 200.0)
            if near and at <= asked.get("within", inf):
                return at
        return None

    @property
    def nearest(self) -> tuple[float, float]:
        """Return how near (mm) the robot came to the place it was to reach, in time, and when."""
        asked = self.scenario.requirements["reach"]
        x, y = asked["at"]
        return min(
            (hypot(pose.forward - x, pose.side - y), at)
            for at, pose in self.body.track
            if at <= asked.get("within", inf)
        )

    @property
    def coverage(self) -> float:
        """Return which share of squares of the robot's width it has been in, within the walls."""
        segments, size = self.body.world.segments, 2 * self.body.radius
        if not len(segments):
            return 0.0
        low = segments.reshape(-1, 2).min(axis=0)
        across = segments.reshape(-1, 2).max(axis=0) - low
        been = {
            (int((p.forward - low[0]) // size), int((p.side - low[1]) // size))
            for _, p in self.body.track
        }
        return float(len(been) / max(1.0, (across[0] // size) * (across[1] // size)))


def stage_trial(
    specification: Configuration,
    modules: Mapping[str, Module],
    scenario: Scenario,
    observe: Observer | None = None,
) -> Trial:
    """Put a run together; nothing has happened yet.

    Raises:
        MarsError: what is unbound or cannot be used, all at once.
    """
    try:
        return _stage(specification, modules, scenario, observe)
    except ValueError as error:  # the world has no room for what is to be scattered in it
        raise MarsError([Diagnostic("scenario", "error", str(error), scenario.span)]) from None


def _stage(
    specification: Configuration,
    modules: Mapping[str, Module],
    scenario: Scenario,
    observe: Observer | None,
) -> Trial:
    specification, every = in_parts(specification, modules)
    limits = _limits(every, scenario)
    robot = scenario.robot
    body = Body(
        make_world(scenario),
        Pose(*map(float, robot.get("start", (0, 0, 0)))),
        float(robot.get("radius", 200.0)),
        scenario.up,
        limits.get(robot["module"], {}),
    )
    running: list[Executor] = []

    def clock() -> float:
        return running[0].schedule.now / SECOND if running else 0.0

    plan = Plan(specification, every, {})
    remarks = tuple(disagreements(plan, scenario))
    if problems := [each for each in remarks if each.severity == "error"]:
        raise MarsError(problems)
    behaviours = bind_functions(plan, scenario, clock)
    joints = make_joints(scenario)
    behaviours |= bind_devices(plan, scenario, body, joints, clock)
    timeout = round(scenario.command_timeout * MILLISECOND)
    running.append(Executor(specification, every, behaviours, timeout, observe))
    moves: dict[str, tuple[str, ...]] = {name: (joint.function,) for name, joint in joints.items()}
    moves[robot["module"]] = planar_functions(scenario.up)
    return Trial(scenario, running[0], body, limits, moves, remarks)


def make_world(scenario: Scenario) -> World:
    """Build the world; scattered circles are drawn from the seed."""
    world = scenario.world
    circles = [Circle((x, y), float(r)) for x, y, r in world.get("circles", ())]
    circles += [
        Circle(_point(m["from"]), m["radius"], _point(m["to"]), m["speed"])
        for m in world.get("moving", ())
    ]
    if "scatter" in world:
        circles += list(_scattered(world["scatter"], scenario))
    seen = [Mark(_point(m["at"]), m["colour"]) for m in world.get("marks", ())]
    return World(_points(world.get("walls")), _points(world.get("polygons")), circles, seen)


def _points(lines: Any) -> list[list[tuple[float, float]]]:
    return [[_point(at) for at in line] for line in lines or ()]


def _point(at: Any) -> tuple[float, float]:
    x, y = at
    return float(x), float(y)


def _scattered(scatter: Mapping[str, Any], scenario: Scenario) -> Iterator[Circle]:
    """Yield circles that leave `free` mm around the start, the last `moving` of them moving."""
    random = Random(f"{scenario.seed}/world")
    x, y, *_ = scenario.robot.get("start", (0, 0, 0))
    within, free = scatter.get("within", 4000.0), scatter.get("free", 600.0)
    count, low_high = scatter.get("count", 10), scatter.get("radius", (100.0, 300.0))
    made = tries = 0
    while made < count:
        tries += 1
        if tries > 1000 * (count + 1):
            raise ValueError(f"`scatter` finds no room for {count} circles: lower `free`")
        radius = random.uniform(*low_high)
        at = random.uniform(-within, within), random.uniform(-within, within)
        if hypot(at[0] - x, at[1] - y) - radius < free:
            continue
        made += 1
        if made > count - scatter.get("moving", 0):
            way = radians(random.uniform(0, 360))
            target = at[0] + 2000 * cos(way), at[1] + 2000 * sin(way)
            yield Circle(at, radius, target, scatter.get("speed", 100.0))
        else:
            yield Circle(at, radius)


def _limit(function: Function) -> float | None:
    """Return how fast a function may be commanded; of a grasp, how wide."""
    limit = function.max if function.name == GRASP else function.rate
    return None if limit is None else float(limit)


def _limits(modules: Mapping[str, Module], scenario: Scenario) -> dict[str, dict[str, float]]:
    limits = {
        name: {f.name: limit for f in module.functions if (limit := _limit(f)) is not None}
        for name, module in modules.items()
    }
    stated = scenario.robot.get("limits", {})
    limits.setdefault(scenario.robot["module"], {}).update(stated)
    return limits
