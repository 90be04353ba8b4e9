"""The commands of an InheritanceNode give the module its commanded motion.

The joints' rates are turned into the module's velocity by the twists of
`tests.support.motions`, which shares nothing with the algebra that made the rates: vertices,
tuples and joints of every order.
"""

from collections import Counter

import numpy as np
import pytest

from mars_asp.execution.executor import Behaviour, Executor
from mars_asp.execution.executor.schedule import MILLISECOND
from mars_asp.language import parse_text
from mars_asp.model.declarations import MOTION_FUNCTIONS, Configuration, Mount
from tests.reasoning.test_combinations import expected_target, specifying
from tests.support.campaigns import seeds
from tests.support.motions import (
    Joint,
    Values,
    all_motions,
    block,
    generic_values,
    measure,
    motions_of,
    random_tree,
    twists,
)

RATE = 7.0


def commanded(
    robot: Configuration, specification: Configuration, function: str, values: Values
) -> dict[Joint, float]:
    """Return the joints' rates for a command to the camera, in radians and `UNIT` mm a second."""
    got: dict[str, dict[str, float]] = {}
    modules = {module.name: module for module in robot.declared}

    def obeying(name: str) -> Behaviour:
        stands = {f: values.get((name, f), 0.0) for f in motions_of(modules[name])}
        return Behaviour(lambda command: got.update({name: command}), position=lambda: stands)

    behaviours = {name: obeying(name) for name in modules if motions_of(modules[name])}
    behaviours["Pilot"] = Behaviour(lambda: (function, RATE), 100 * MILLISECOND)
    behaviours["Cam"] = Behaviour(lambda: None, 100 * MILLISECOND)
    executor = Executor(specification, modules, behaviours)
    executor.step_until(0)
    assert not executor.failures
    return {
        (name, f): rate / measure(f) for name, command in got.items() for f, rate in command.items()
    }


def differences(tree: str, seed: int, seen: Counter[str]) -> list[str]:
    entries = []
    robot = parse_text(tree, "c.mars").configuration
    mounts = {m.mounting: m for m in robot.relationships if isinstance(m, Mount)}
    modules = {module.name: module for module in robot.declared}
    camera = all_motions(robot, seed)["Cam"]
    for index, function in enumerate(MOTION_FUNCTIONS):
        fed = expected_target(camera, function)
        if fed is None:
            continue
        alone = len(camera.givers(function)) > 0
        # What one module gives is so at rest; what several make up together follows the posture.
        values = {} if alone else generic_values(robot, seed + 1000)
        rates = commanded(robot, specifying(tree, fed), function, values)
        there = dict(twists("Cam", mounts, modules, values))
        moved = sum((rate * there[joint] for joint, rate in rates.items()), np.zeros(6))
        rows = slice(0, 3) if alone and index < 3 else slice(0, 6)
        wanted = np.eye(6)[index] * RATE / measure(function)
        if not np.allclose(moved[rows], wanted[rows], atol=1e-6):
            entries.append(f"{seed}: {function} by {rates} moves {moved.round(4)}")
        seen["alone" if alone else "together"] += 1
    return entries


def test_the_camera_moves_as_it_is_commanded() -> None:
    seen: Counter[str] = Counter()
    entries = []
    for seed in seeds(10, 60):
        entries += differences(random_tree(seed, eye=False), seed, seen)
    assert entries == []
    assert seen["alone"] > 7, seen
    assert seen["together"] > 7, seen


#: The vertices and the tuple have two turns each that do not commute, so any swapped pair shows.
TURNED = "\n".join(
    [
        "@configuration\n@modules Base, Cam",
        "Cam 1 is_mounted_on Base 1 (y,90,z,20,5,0,40)",
        block("Base", *MOTION_FUNCTIONS, vertex="(z,90,x,45,10,20,30)"),
        block("Cam", vertex="(x,90,y,30,10,20,30)"),
    ]
)


@pytest.mark.parametrize("function", MOTION_FUNCTIONS)
def test_turned_vertices_and_a_turned_tuple_are_taken_in_their_order(function: str) -> None:
    assert differences(TURNED, 1, Counter()) == []
    robot = parse_text(TURNED, "c.mars").configuration
    rates = commanded(robot, specifying(TURNED, frozenset({"Base"})), function, {})
    assert len(rates) == 3


def test_a_stretched_arm_reports_an_impossible_command() -> None:
    """The posture is singular: along the arm no rate of the hinges moves it."""
    text = "\n".join(
        [
            "@specification",
            "@modules A, B, C, Cam, Pilot, InheritanceNode1",
            "B is_mounted_on A (_,_,_,_,300,_,_)",
            "C is_mounted_on B (_,_,_,_,200,_,_)",
            "Cam is_mounted_on C (_,_,_,_,100,_,_)",
            "InheritanceNode1 is_controlled_by Pilot",
            *(f"{name} is_controlled_by InheritanceNode1" for name in "ABC"),
            *(f"@module_start\n@module_name {n}\n@Rotn_Z\n@module_end" for n in "ABC"),
        ]
    )
    got: list[object] = []
    behaviours = {name: Behaviour(got.append) for name in "ABC"}
    behaviours["Pilot"] = Behaviour(lambda: ("Trans_X", 5), 100 * MILLISECOND)
    executor = Executor(parse_text(text, "s.mars").configuration, {}, behaviours)
    executor.step_until(0)
    assert got == []
    (failures,) = executor.failures.values()
    assert failures.count == 1


def test_an_unreported_joint_position_is_computed() -> None:
    """Two slides are parallel until the hinge between them has turned by 90 degrees."""
    functions = {"Low": "Trans_X", "Hinge": "Rotn_Z", "High": "Trans_X"}
    text = "\n".join(
        [
            "@specification",
            "@modules Low, Hinge, High, Cam, Pilot, Turner, InheritanceNode1",
            "Hinge is_mounted_on Low",
            "High is_mounted_on Hinge",
            "Cam is_mounted_on High (z,45,_,_,_,_,_)",
            "Hinge is_controlled_by Turner",
            "InheritanceNode1 is_controlled_by Pilot",
            "Low is_controlled_by InheritanceNode1",
            "High is_controlled_by InheritanceNode1",
            *(f"@module_start\n@module_name {n}\n@{f}\n@module_end" for n, f in functions.items()),
        ]
    )
    got: dict[str, dict[str, float]] = {}
    behaviours = {
        name: Behaviour(lambda command, name=name: got.update({name: command}))
        for name in functions
    }
    behaviours["Turner"] = Behaviour(lambda: ("Rotn_Z", 90), 100 * MILLISECOND)
    behaviours["Pilot"] = Behaviour(lambda: ("Trans_X", 5), 1000 * MILLISECOND)
    executor = Executor(parse_text(text, "s.mars").configuration, {}, behaviours)
    executor.step_until(1000 * MILLISECOND)
    half = 5 / np.sqrt(2)
    assert got["High"] == pytest.approx({"Trans_X": half})
    assert got["Low"] == pytest.approx({"Trans_X": -half})
