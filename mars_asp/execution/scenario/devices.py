"""Behaviours of the simulated devices of a scenario: sensors, joints and robots."""

from collections.abc import Callable, Mapping, Sequence, Set
from math import inf
from random import Random
from typing import Any

from mars_asp.diagnostic import Diagnostic, MarsError
from mars_asp.execution.executor import Behaviour
from mars_asp.execution.executor.plan import Plan
from mars_asp.execution.executor.schedule import MILLISECOND
from mars_asp.execution.scenario.functions import Clock, faulty
from mars_asp.execution.scenario.read import Scenario
from mars_asp.execution.simulator import (
    Body,
    JointDevice,
    bumper,
    joystick,
    lidar,
    marks,
    odometry,
    sonar,
)
from mars_asp.execution.simulator.devices import Place, mounted

_DEFAULT_PERIOD = 100.0
#: Devices that must be mounted on a robot.
_CARRIED = ("sonar", "lidar", "bumper", "odometry", "marks")
_JOINT = (("low", -inf), ("high", inf), ("rate", inf), ("value", 0.0))


def make_joints(scenario: Scenario) -> dict[str, JointDevice]:
    """Return the joints and grippers of a scenario by module."""
    found = {}
    for name, table in scenario.devices.items():
        if table.get("kind") in ("joint", "gripper"):
            function = table.get("function", "Grasp" if table["kind"] == "gripper" else "Rotn_Y")
            numbers = [float(table.get(key, default)) for key, default in _JOINT]
            # A gripper keeps its width until another is commanded.
            found[name] = JointDevice(function, *numbers)
            found[name].wanted = numbers[-1] if function == "Grasp" else 0.0
    return found


def bind_devices(
    plan: Plan,
    scenario: Scenario,
    bodies: Mapping[str, Body],
    joints: Mapping[str, JointDevice],
    clock: Clock,
) -> dict[str, Behaviour]:
    """Return the behaviour of each module that a device or a robot runs.

    `bodies` are by the module that moves them.

    Raises:
        MarsError: with all devices that are not mounted on any of several robots.
    """
    found: dict[str, Behaviour] = {name: _jointed(joint, clock) for name, joint in joints.items()}
    # Its rates are in the frame of the body.
    for module, body in bodies.items():
        described = plan.modules.get(module)
        functions = (
            frozenset(each.name for each in described.functions) if described else frozenset()
        )
        found[module] = _moved(body, clock, functions)
    problems = []
    for name, table in scenario.devices.items():
        if name in found or table.get("kind") == "platform":
            continue
        chain, robot = _mounted_on(plan, name, bodies)
        if robot is None and table["kind"] in _CARRIED:
            problems.append(_loose(name, scenario))
            continue
        body = bodies[robot or scenario.robots[0].module]
        place = mounted(body, _way(plan, chain, scenario, joints))
        read = _sensor(table, body, place, Random(f"{scenario.seed}/{name}"))
        period = round(table.get("period", _DEFAULT_PERIOD) * MILLISECOND)
        behaviour = Behaviour(lambda read=read: read(clock()), period)
        found[name] = faulty(behaviour, scenario, name, clock)
    if problems:
        raise MarsError(problems)
    return found


def _moved(body: Body, clock: Clock, functions: Set[str]) -> Behaviour:
    """Return the behaviour that moves a body by some functions, or by any if there are none."""

    def obey(command: Mapping[str, float]) -> None:
        own = {name: rate for name, rate in command.items() if name in functions or not functions}
        body.obey(own, clock())

    return Behaviour(obey, position=dict)


def _mounted_on(plan: Plan, name: str, bodies: Mapping[str, Body]) -> tuple[list[str], str | None]:
    """Return the chain of mounts from a device to a robot, and the robot's module.

    Without mounts this is the only robot, None if there are several. A part of a module has the
    mounts of the module.
    """
    whole = name.rpartition(".")[0]
    chain = plan.inheriting.chain(whole if whole in plan.inheriting.mounts else name)
    for number, module in enumerate(chain):
        if module in bodies:
            return chain[: number + 1], module
    return chain, next(iter(bodies)) if len(bodies) == 1 else None


def _loose(name: str, scenario: Scenario) -> Diagnostic:
    message = f"no mount leads from `{name}` to a robot, and there are {len(scenario.robots)}"
    robot = scenario.robots[0].module
    help_text = f"mount it in the configuration, as in `{name} is_mounted_on {robot}`"
    place = scenario.places[f"devices.{name}"]
    return Diagnostic("scenario", "error", message, place, (), help_text)


def _jointed(joint: JointDevice, clock: Clock) -> Behaviour:
    return Behaviour(
        lambda command: joint.obey(command, clock()),
        position=lambda: {joint.function: joint.advance(clock())},
    )


def _sensor(
    table: Mapping[str, Any], body: Body, place: Place, noise: Random
) -> Callable[[float], Any]:
    def options(*keys: str) -> dict[str, Any]:
        return {key: table[key] for key in keys if key in table}

    kind, script = table.get("kind"), table.get("script", ())
    if kind == "sonar":
        return sonar(body, place, noise, **options("beams", "cone", "rays", "reach", "sigma"))
    if kind == "lidar":
        return lidar(body, place, noise, **options("beams", "view", "reach", "sigma"))
    if kind == "marks":
        return marks(body, place, **options("view", "reach"))
    if kind == "odometry":
        return odometry(body, noise, **options("sigma"))
    if kind == "joystick":
        # An entry without a rate releases the stick.
        held = ((float(at), (name, float(*rate)) if rate else None) for at, name, *rate in script)
        return joystick(list(held))
    return bumper(body)


def _way(
    plan: Plan, chain: Sequence[str], scenario: Scenario, joints: Mapping[str, JointDevice]
) -> list[tuple[float, float, float, JointDevice | None]]:
    """Return the links (forward, side, turn, joint) from a robot to a device, in the plane.

    Rotations about the up axis are included; tilts and vertices are ignored. `chain` are the
    mounts.
    """
    ahead, aside = (2, 0) if scenario.up == "y" else (0, 1)
    way = []
    for mounting in reversed(chain[:-1]):
        across = plan.inheriting.mounts[mounting].transformation
        translation = across.translation if across else (0, 0, 0)
        turns = across.rotations if across else ()
        turn = sum(float(angle) for axis, angle in turns if axis.lower() == scenario.up)
        joint = joints.get(mounting)
        way.append((float(translation[ahead]), float(translation[aside]), turn, joint))
    return way
