"""A specification in a scenario: world, robot, devices and executor, put together and run."""

from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise
from math import cos, hypot, inf, radians, sin
from random import Random
from typing import Any

from mars_asp.asp.units import measured
from mars_asp.diagnostic import Diagnostic, MarsError
from mars_asp.execution.executor import Executor
from mars_asp.execution.executor.link import Observer
from mars_asp.execution.executor.modules import Effector
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
    Joint,
    Mark,
    Pose,
    World,
)
from mars_asp.execution.simulator.body import planar_functions
from mars_asp.execution.simulator.motion import Point
from mars_asp.model.declarations import GRASP, Configuration, Function, Module


@dataclass(frozen=True)
class Trial:
    """A run: `executor` and `body` hold what happened.

    `limits` are rates by module, `joints` the simulated joints and grippers by module, `moves` the
    functions that each simulated device carries out, `remarks` warnings about the scenario.
    """

    scenario: Scenario
    executor: Executor
    body: Body
    limits: Mapping[str, Mapping[str, float]]
    joints: Mapping[str, Joint]
    moves: Mapping[str, tuple[str, ...]]
    remarks: tuple[Diagnostic, ...] = ()

    def run_until(self, seconds: float) -> None:
        """Run events and motion up to a time."""
        self.executor.step_until(round(seconds * SECOND))
        self.body.advance(seconds)
        for joint in self.joints.values():
            joint.advance(seconds)

    @property
    def control_time(self) -> dict[str, float]:
        """Return for how many seconds each module's command was in force at the robot."""
        times: defaultdict[str, float] = defaultdict(float)
        for since, until, origin, _ in self.commands:
            if origin:
                times[origin] += until - since
        return dict(sorted(times.items()))

    def together(self, first: str, second: str) -> tuple[float, float]:
        """Return for how many seconds two functions ran at once, anywhere, and since when first."""
        changes = sorted(
            (at, number, step)
            for number, function in enumerate((first, second))
            for since, until in self._runs(function)
            for at, step in ((since, 1), (until, -1))
        )
        running, total, began, before = [0, 0], 0.0, 0.0, 0.0
        for at, number, step in changes:
            if all(running) and at > before:
                began = began if total else before
                total += at - before
            running[number] += step
            before = at
        return total, began

    def _runs(self, function: str) -> Iterator[tuple[float, float]]:
        """Yield from when until when (s) effectors ran a function, and grippers moved."""
        for name, effector in self.executor.effectors.items():
            if function == GRASP and name in self.joints:
                yield from self.joints[name].moved
                continue
            for since, until, _, command in self._obeyed(effector):
                if command.get(function):
                    yield since, until

    @property
    def commands(self) -> Iterator[tuple[float, float, str, dict[str, float]]]:
        """Yield from when (s) until when the robot obeyed which module, and its command."""
        effector = self.executor.effectors.get(self.scenario.robot["module"])
        if effector is not None:
            yield from self._obeyed(effector)

    def _obeyed(self, effector: Effector) -> Iterator[tuple[float, float, str, dict[str, float]]]:
        end: tuple[int, str, dict[str, float]] = (self.executor.schedule.now, "", {})
        for (since, origin, command), (until, _, _) in pairwise([*effector.applied, end]):
            yield since / SECOND, until / SECOND, origin, command

    @property
    def reached(self) -> float | None:
        """Return when (s) the robot first came to the place it was to reach, in time."""
        place, radius, within = self._to_reach
        for stretch, until in self.body.stretches:
            if stretch.since > within:
                return None
            at = stretch.enters(place, radius, min(until, within))
            if at is not None:
                return at
        return None

    @property
    def nearest(self) -> tuple[float, float]:
        """Return how near (mm) the robot came to the place it was to reach, in time, and when."""
        place, _, within = self._to_reach
        return min(
            stretch.nearest(place, min(until, within))
            for stretch, until in self.body.stretches
            if stretch.since <= within
        )

    @property
    def _to_reach(self) -> tuple[Point, float, float]:
        """Return the place, how near (mm) is near enough, and until when (s)."""
        asked = self.scenario.requirements["reach"]
        x, y = asked["at"]
        return (x, y), asked.get("radius", 200.0), asked.get("within", inf)

    @property
    def coverage(self) -> float:
        """Return which share of squares of the robot's width its centre has been in.

        Squares lie side by side in the rectangle around all walls, whole ones alone.
        """
        segments, size = self.body.world.segments, 2 * self.body.radius
        if not len(segments) or not size:
            return 0.0
        low = segments.reshape(-1, 2).min(axis=0)
        rows, columns = ((segments.reshape(-1, 2).max(axis=0) - low) // size).astype(int)
        been = set()
        for stretch, until in self.body.stretches:
            # Between two times at which it passes a line, it is in one square.
            passed = {stretch.since, until}
            for axis in (0, 1):
                passed.update(stretch.crossings(axis, size, float(low[axis]), until))
            for since, next_ in pairwise(sorted(passed)):
                pose = stretch.at((since + next_) / 2)
                been.add((int((pose.forward - low[0]) // size), int((pose.side - low[1]) // size)))
        inside = sum(0 <= row < rows and 0 <= column < columns for row, column in been)
        return float(inside / (rows * columns)) if rows * columns else 0.0


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
    _check_start(body, scenario)
    timeout = round(scenario.command_timeout * MILLISECOND)
    running.append(Executor(specification, every, behaviours, timeout, observe))
    moves: dict[str, tuple[str, ...]] = {name: (joint.function,) for name, joint in joints.items()}
    moves[robot["module"]] = planar_functions(scenario.up)
    return Trial(scenario, running[0], body, limits, joints, moves, remarks)


def _check_start(body: Body, scenario: Scenario) -> None:
    """Refuse a robot that starts in something solid: it would have to be let out first."""
    gap = body.gap()
    if gap >= 0:
        return
    place = scenario.places.get("start", scenario.places["robot"])
    message = (
        f"the robot starts {measured(round(-gap * 1000), 'micrometres')} inside of something solid"
    )
    help_text = "start it elsewhere, or move what is there; its `radius` counts"
    raise MarsError([Diagnostic("scenario", "error", message, place, (), help_text)])


def make_world(scenario: Scenario) -> World:
    """Build the world; scattered circles are drawn from the seed."""
    world = scenario.world
    circles = [Circle((x, y), float(r)) for x, y, r in world.get("circles", ())]
    circles += [
        Circle(_point(m["from"]), m["radius"], (_point(m["to"]),), m["speed"])
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
            yield Circle(at, radius, (target,), scatter.get("speed", 100.0))
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
