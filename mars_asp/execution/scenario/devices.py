"""Simulated devices of a scenario: what reads a sensor and obeys commands."""

from collections.abc import Callable, Mapping
from math import inf
from random import Random
from typing import Any

from mars_asp.execution.executor import Behaviour
from mars_asp.execution.executor.plan import Plan
from mars_asp.execution.executor.schedule import MILLISECOND
from mars_asp.execution.scenario.functions import Clock, faulty
from mars_asp.execution.scenario.read import Scenario
from mars_asp.execution.simulator import (
    Body,
    Joint,
    bumper,
    joystick,
    lidar,
    marks,
    odometry,
    sonar,
)
from mars_asp.execution.simulator.devices import Place, mounted

_DEFAULT_PERIOD = 100.0
_JOINT = (("low", -inf), ("high", inf), ("rate", inf), ("value", 0.0))


def make_joints(scenario: Scenario) -> dict[str, Joint]:
    """Return the joints and grippers of a scenario by their module."""
    found = {}
    for name, table in scenario.devices.items():
        if table.get("kind") in ("joint", "gripper"):
            function = table.get("function", "Grasp" if table["kind"] == "gripper" else "Rotn_Y")
            numbers = [float(table.get(key, default)) for key, default in _JOINT]
            # A width stays as it is until another is commanded.
            found[name] = Joint(function, *numbers)
            found[name].wanted = numbers[-1] if function == "Grasp" else 0.0
    return found


def bind_devices(
    plan: Plan, scenario: Scenario, body: Body, joints: Mapping[str, Joint], clock: Clock
) -> dict[str, Behaviour]:
    """Return what reads or obeys for each module that a device or the robot itself runs."""
    found: dict[str, Behaviour] = {name: _jointed(joint, clock) for name, joint in joints.items()}
    platform = scenario.robot["module"]
    # Its rates are along and about the body, wherever that has come to.
    found[platform] = Behaviour(lambda command: body.obey(command, clock()), position=dict)
    for name, table in scenario.devices.items():
        if name in found or table.get("kind") == "platform":
            continue
        place = mounted(body, _way(plan, name, scenario, joints))
        read = _sensor(table, body, place, Random(f"{scenario.seed}/{name}"))
        period = round(table.get("period", _DEFAULT_PERIOD) * MILLISECOND)
        behaviour = Behaviour(lambda read=read: read(clock()), period)
        found[name] = faulty(behaviour, scenario, name, clock)
    return found


def _jointed(joint: Joint, clock: Clock) -> Behaviour:
    return Behaviour(
        lambda command: joint.obey(command, clock()),
        position=lambda: {joint.function: joint.advance(clock())},
    )


def _sensor(
    table: Mapping[str, Any], body: Body, place: Place, noise: Random
) -> Callable[[float], Any]:
    def stated(*keys: str) -> dict[str, Any]:
        return {key: table[key] for key in keys if key in table}

    kind, script = table.get("kind"), table.get("script", ())
    if kind == "sonar":
        return sonar(body, place, noise, **stated("beams", "cone", "rays", "reach", "sigma"))
    if kind == "lidar":
        return lidar(body, place, noise, **stated("beams", "view", "reach", "sigma"))
    if kind == "marks":
        return marks(body, place, **stated("view", "reach"))
    if kind == "odometry":
        return odometry(body, noise, **stated("sigma"))
    if kind == "joystick":
        return joystick([(float(at), _held(*held)) for at, *held in script])
    return bumper(body)


def _held(function: str, rate: float | None = None) -> tuple[str, float] | None:
    """Return what an entry of a script commands; nothing where it lets go."""
    return None if rate is None else (function, float(rate))


def _way(
    plan: Plan, name: str, scenario: Scenario, joints: Mapping[str, Joint]
) -> list[tuple[float, float, float, Joint | None]]:
    """Return the mounts from the robot out to a device, as the plane sees them.

    A turn about the up axis counts; tilts and the vertices of modules are left out.
    """
    chain = plan.inheriting.chain(name)
    if scenario.robot["module"] in chain:
        chain = chain[: chain.index(scenario.robot["module"]) + 1]
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
