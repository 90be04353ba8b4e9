"""The run of a specification in a scenario, with its world, robots, devices and executor."""

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import cos, dist, inf, radians, sin
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
from mars_asp.execution.scenario.contradictions import SCATTERED
from mars_asp.execution.scenario.devices import bind_devices, make_joints
from mars_asp.execution.scenario.functions import bind_functions, bind_kinds
from mars_asp.execution.scenario.link_faults import link_faults
from mars_asp.execution.scenario.read import Scenario, ScenarioRobot
from mars_asp.execution.simulator import (
    Body,
    Circle,
    Fleet,
    JointDevice,
    Mark,
    Pose,
    Ramp,
    World,
)
from mars_asp.execution.simulator.body import planar_functions
from mars_asp.execution.simulator.motion import Point
from mars_asp.model.declarations import GRASP, Configuration, Module

#: Maximal number of random positions that are tried for a circle.
_TRIES = 10_000


@dataclass(frozen=True)
class Trial:
    """A run, recorded in `executor` and in `bodies`, which have the order of the scenario's robots.

    `limits` are maximal rates by module and function, `joints` joints and grippers by module,
    `moves` the functions of each simulated device, `remarks` warnings about the scenario.
    """

    scenario: Scenario
    executor: Executor
    bodies: tuple[Body, ...]
    limits: Mapping[str, Mapping[str, float]]
    joints: Mapping[str, JointDevice]
    moves: Mapping[str, tuple[str, ...]]
    remarks: tuple[Diagnostic, ...] = ()

    def run_until(self, seconds: float) -> None:
        """Run events and motion up to a time in seconds."""
        self.executor.step_until(round(seconds * SECOND))
        self.bodies[0].advance(seconds)  # moves all bodies
        for joint in self.joints.values():
            joint.advance(seconds)

    @property
    def robots(self) -> Iterator[tuple[ScenarioRobot, Body]]:
        """Yield each robot of the scenario with its body."""
        return zip(self.scenario.robots, self.bodies, strict=True)

    @property
    def collisions(self) -> int:
        """Return the number of contacts; one of two robots with each other counts once."""
        return len(self.contacts)

    @property
    def contacts(self) -> list[tuple[float, Body, str]]:
        """Return the seconds, the robot and the other robot or `THING` of each contact."""
        names = {body.name: k for k, body in enumerate(self.bodies)}
        found = [
            (at, body, other)
            for k, body in enumerate(self.bodies)
            for at, other in zip(body.contacts, body.struck, strict=True)
            if names.get(other, k) >= k
        ]
        return sorted(found, key=lambda contact: contact[0])

    @property
    def clearance(self) -> float:
        """Return the minimal gap (mm) so far of a robot to another or an obstacle; else inf."""
        return min(body.clearance for body in self.bodies)

    @property
    def control_time(self) -> dict[str, float]:
        """Return for how many seconds each module controlled a robot, summed over all robots."""
        times: defaultdict[str, float] = defaultdict(float)
        for robot in self.scenario.robots:
            for name, seconds in self.times_in_control(robot).items():
                times[name] += seconds
        return dict(sorted(times.items()))

    def times_in_control(self, robot: ScenarioRobot) -> dict[str, float]:
        """Return for how many seconds each module controlled a robot."""
        times: defaultdict[str, float] = defaultdict(float)
        for since, until, origin, _ in self.commands(robot):
            if origin:
                times[origin] += until - since
        return times

    def together(self, first: str, second: str) -> tuple[float, float]:
        """Return for how many seconds two functions are active at once, and when first."""
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
        """Yield begin and end, in seconds, of each period in which an effector ran a function."""
        for name, effector in self.executor.effectors.items():
            if function == GRASP and name in self.joints:
                yield from self.joints[name].moved
                continue
            for since, until, _, command in self._obeyed(effector):
                if command.get(function):
                    yield since, until

    def commands(
        self, robot: ScenarioRobot
    ) -> Iterator[tuple[float, float, str, dict[str, float]]]:
        """Yield begin, end, module and command of each command that a robot obeyed."""
        effector = self.executor.effectors.get(robot.module)
        if effector is not None:
            yield from self._obeyed(effector)

    def _obeyed(self, effector: Effector) -> Iterator[tuple[float, float, str, dict[str, float]]]:
        end: tuple[int, str, dict[str, float]] = (self.executor.schedule.now, "", {})
        for (since, origin, command), (until, _, _) in pairwise([*effector.applied, end]):
            yield since / SECOND, until / SECOND, origin, command

    def reached(self, robot: ScenarioRobot) -> float | None:
        """Return when, in seconds, a robot reached its `reach` goal, or None if not in time."""
        place, radius, within = _to_reach(robot)
        for stretch, until in self._body(robot).stretches:
            if stretch.since > within:
                return None
            at = stretch.enters(place, radius, min(until, within))
            if at is not None:
                return at
        return None

    def nearest(self, robot: ScenarioRobot) -> tuple[float, float]:
        """Return the minimal distance (mm) of a robot from its `reach` goal in time, and when."""
        place, _, within = _to_reach(robot)
        return min(
            stretch.nearest(place, min(until, within))
            for stretch, until in self._body(robot).stretches
            if stretch.since <= within
        )

    def _body(self, robot: ScenarioRobot) -> Body:
        return self.bodies[self.scenario.robots.index(robot)]

    def is_active(self, function: str) -> bool:
        """Whether an effector carried out a function at some time."""
        return any(until > since for since, until in self._runs(function))

    @property
    def coverage(self) -> float:
        """Return the share of squares that the robots' centres visited."""
        return self.coverages[1]

    @property
    def coverages(self) -> tuple[float, float]:
        """Return the share of squares with a robot's centre at the start, and in the whole run.

        The squares are as wide as the widest robot and lie side by side in the rectangle around all
        walls; only whole squares count.
        """
        segments = self.bodies[0].world.segments
        size = 2 * max(body.radius for body in self.bodies)
        if not len(segments) or not size:
            return 0.0, 0.0
        low = segments.reshape(-1, 2).min(axis=0)
        rows, columns = ((segments.reshape(-1, 2).max(axis=0) - low) // size).astype(int)

        def share(poses: Iterable[Pose]) -> float:
            found = {
                (int((pose.forward - low[0]) // size), int((pose.side - low[1]) // size))
                for pose in poses
            }
            inside = sum(0 <= row < rows and 0 <= column < columns for row, column in found)
            return float(inside / (rows * columns)) if rows * columns else 0.0

        def passed() -> Iterator[Pose]:
            for stretch, until in (each for body in self.bodies for each in body.stretches):
                # Between two crossings of lines, the centre is in one square.
                times = {stretch.since, until}
                for axis in (0, 1):
                    times.update(stretch.crossings(axis, size, float(low[axis]), until))
                for since, next_ in pairwise(sorted(times)):
                    yield stretch.at((since + next_) / 2)

        return share(body.motion[0].pose for body in self.bodies), share(passed())


def _to_reach(robot: ScenarioRobot) -> tuple[Point, float, float]:
    """Return the `reach` goal of a robot: its centre, radius (mm) and deadline in seconds."""
    goal = robot.reach or {}
    x, y = goal["at"]
    return (x, y), goal.get("radius", 200.0), goal.get("within", inf)


def stage_trial(
    specification: Configuration,
    modules: Mapping[str, Module],
    scenario: Scenario,
    observe: Observer | None = None,
) -> Trial:
    """Return a run at its start, before the first event.

    Raises:
        MarsError: with all mistakes of the scenario, such as unbound modules.
    """
    scenario = bind_kinds(scenario, specification)
    specification, every = in_parts(specification, modules)
    limits = _limits(every, scenario)
    world = make_world(scenario)
    fleet = Fleet([_body(robot, world, scenario.up, limits) for robot in scenario.robots])
    running: list[Executor] = []

    def clock() -> float:
        return running[0].schedule.now / SECOND if running else 0.0

    plan = Plan(specification, every, {})
    remarks = tuple(disagreements(plan, scenario))
    if problems := [each for each in remarks if each.severity == "error"]:
        raise MarsError(problems)
    behaviours = bind_functions(plan, scenario, clock)
    joints = make_joints(scenario)
    bodies = {r.module: body for r, body in zip(scenario.robots, fleet.bodies, strict=True)}
    behaviours |= bind_devices(plan, scenario, bodies, joints, clock)
    _check_starts(fleet.bodies, scenario)
    timeout = round(scenario.command_timeout * MILLISECOND)
    running.append(
        Executor(
            specification, every, behaviours, timeout, observe, link_faults(scenario), scenario.seed
        )
    )
    moves: dict[str, tuple[str, ...]] = {name: (joint.function,) for name, joint in joints.items()}
    moves |= dict.fromkeys(bodies, planar_functions(scenario.up))
    return Trial(scenario, running[0], fleet.bodies, limits, joints, moves, remarks)


def _body(
    robot: ScenarioRobot, world: World, up: str, limits: Mapping[str, Mapping[str, float]]
) -> Body:
    """Return the body of a robot at its start."""
    ramps = {
        function: Ramp(float(up), float(robot.deceleration.get(function, up)))
        for function, up in robot.acceleration.items()
    }
    return Body(
        world,
        Pose(*robot.start),
        robot.radius,
        up,
        limits.get(robot.module, {}),
        name=robot.name,
        ramps=ramps,
    )


def _check_starts(bodies: Sequence[Body], scenario: Scenario) -> None:
    """Raise MarsError, with all errors, if robots start in an obstacle or another robot."""
    problems = []
    for k, body in enumerate(bodies):
        gaps = [(body.gap(), "something solid")]
        for other in bodies[:k]:
            gap = dist(body.place, other.place) - body.radius - other.radius
            gaps.append((gap, f"`{other.name}`"))
        gap, inside = min(gaps)
        if gap >= 0:
            continue
        robot = scenario.robots[k]
        place = robot.places.get("start", robot.places["module"])
        deep = measured(round(-gap * 1000), "micrometres")
        message = f"{scenario.called(robot)} starts {deep} inside of {inside}"
        help_text = "start it elsewhere, or move what is there; its `radius` counts"
        problems.append(Diagnostic("scenario", "error", message, place, (), help_text))
    if problems:
        raise MarsError(problems)


def make_world(scenario: Scenario) -> World:
    """Return the world of a scenario; scattered circles depend on the seed.

    Raises:
        MarsError: there is no room for the scattered circles.
    """
    world = scenario.world
    circles = [Circle((x, y), float(r)) for x, y, r in world.get("circles", ())]
    for moving in world.get("moving", ()):
        first, *others = map(_point, moving.get("way") or (moving["from"], moving["to"]))
        circles.append(Circle(first, moving["radius"], tuple(others), moving["speed"]))
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
    """Yield random circles; the last `moving` ones move.

    They keep a distance of `free` mm from each start, each `reach` goal and each mark.

    Raises:
        MarsError: there is no room for all circles.
    """
    random = Random(f"{scenario.seed}/world")
    within, free = scatter.get("within", 4000.0), scatter.get("free", 600.0)
    count, low_high = scatter.get("count", SCATTERED), scatter.get("radius", (100.0, 300.0))
    kept = [robot.start[:2] for robot in scenario.robots]
    kept += [_point(robot.reach["at"]) for robot in scenario.robots if robot.reach is not None]
    kept += [_point(mark["at"]) for mark in scenario.world.get("marks", ())]
    made = tries = 0
    while made < count:
        tries += 1
        if tries > _TRIES:
            message = f"`scatter` finds no room for {count} circles"
            help_text = "lower `free` or `radius`, or raise `within`"
            place = scenario.places["scatter"]
            raise MarsError([Diagnostic("scenario", "error", message, place, (), help_text)])
        radius = random.uniform(*low_high)
        at = random.uniform(-within, within), random.uniform(-within, within)
        if any(dist(at, each) - radius < free for each in kept):
            continue
        made, tries = made + 1, 0
        if made > count - scatter.get("moving", 0):
            way = radians(random.uniform(0, 360))
            target = at[0] + 2000 * cos(way), at[1] + 2000 * sin(way)
            yield Circle(at, radius, (target,), scatter.get("speed", 100.0))
        else:
            yield Circle(at, radius)


def _limits(modules: Mapping[str, Module], scenario: Scenario) -> dict[str, dict[str, float]]:
    limits = {
        name: {
            f.name: float(limit)
            for f in module.functions
            # A grasp has a width.
            if (limit := f.max if f.name == GRASP else f.rate) is not None
        }
        for name, module in modules.items()
    }
    for robot in scenario.robots:
        limits.setdefault(robot.module, {}).update(robot.limits)
    return limits
