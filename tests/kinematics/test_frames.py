"""Frames: exact quarter turns, chains, vertices, forward kinematics and ranks."""

import math
import random
from decimal import Decimal

import numpy as np
import pytest
from pytransform3d.rotations import active_matrix_from_angle
from pytransform3d.transformations import adjoint_from_transform, concat

from mars_asp.kinematics.frames import (
    Joint,
    Matrix,
    adjoint,
    build_robot,
    inverse,
    jacobian,
    motion,
    mount_matrix,
    rotation,
    take_posture,
    transformation_matrix,
    unit_twist,
)
from mars_asp.kinematics.supports import spanned
from mars_asp.model.declarations import MOTION_FUNCTIONS, Mount
from mars_asp.reasoning.facts.motion import frames
from tests.support.robots import HERE, module, placed, random_chain, random_placement, robot


def test_the_tuple_of_the_paper() -> None:
    """`(z, 180, x, -90, 150,_,_)`: half a turn about z, then back about the fixed x."""
    matrix = transformation_matrix(placed([("z", 180), ("x", -90)], 150, 0, 0))
    assert matrix.tolist() == [[-1, 0, 0, 150], [0, 0, 1, 0], [0, 1, 0, 0], [0, 0, 0, 1]]


def test_quarter_turns_are_exact_and_leave_no_negative_zero() -> None:
    for axis in "xyz":
        for degrees in (Decimal(-450), Decimal("90.0"), Decimal(180), Decimal(990), 270.0):
            matrix = transformation_matrix(placed([(axis, degrees)]))
            assert set(np.abs(matrix).ravel()) == {0.0, 1.0}
            assert not (np.signbit(matrix) & (matrix == 0)).any()


def test_a_turn_by_other_than_right_angles() -> None:
    turned = rotation("z", Decimal(30)) @ [1.0, 0.0, 0.0]
    assert turned == pytest.approx([math.sqrt(3) / 2, 0.5, 0.0])


def test_long_chains_of_quarter_turns_stay_whole() -> None:
    chooser = random.Random(6)
    mounts = [
        Mount(f"M{n}", f"M{n + 1}", HERE, transformation=random_placement(chooser, False))
        for n in range(200)
    ]
    for _, matrix in frames(robot(mounts, ()), {}).values():
        assert (matrix == np.round(matrix)).all()
        assert (np.abs(matrix[:, :3]).sum(axis=0) == 1).all()


def test_vertices_meet() -> None:
    """Vertex 2 of the mounting module, moved by the tuple, is at vertex 1 of the mounted."""
    at, on = placed([("y", 90)], 10, 20, 30), placed([("x", 40)], 5, 6, 7)
    modules = {"A": module("A", v2=at), "B": module("B", v1=on)}
    moved = placed([("z", 25)], 1, 2, 3)
    matrix = mount_matrix(Mount("A", "B", HERE, 2, 1, moved), modules)
    expected = transformation_matrix(on) @ transformation_matrix(moved)
    assert matrix @ transformation_matrix(at) == pytest.approx(expected)


def test_vertex_0_defaults_to_the_frame_and_can_be_declared() -> None:
    mount = Mount("A", "B", HERE)
    assert mount_matrix(mount, {}).tolist() == np.eye(4).tolist()
    known = {"B": module("B", v0=placed((), 0, 0, 9))}
    assert mount_matrix(mount, known)[:3, 3].tolist() == [0, 0, 9]


def test_joints_turn_the_modules_that_they_carry() -> None:
    """Pan by 90 degrees, then tilt by 90: a camera 100 mm ahead ends 100 mm below its head."""
    modules = {"Head": module("Head", "Rotn_Y", "Rotn_X")}
    mounts = [Mount("Camera", "Head", HERE, transformation=placed((), 0, 0, 100))]
    head = build_robot(mounts, modules)
    pose = take_posture(head, {Joint("Head", "Rotn_Y"): 90.0, Joint("Head", "Rotn_X"): 90.0})
    assert pose.poses["Camera"][:3, 3].tolist() == [0, -100, 0]
    assert pose.poses["Head"].tolist() == np.eye(4).tolist(), "own joints are at zero"


def test_the_twist_of_a_lever_arm() -> None:
    modules = {"Head": module("Head", "Rotn_Y")}
    mounts = [Mount("Camera", "Head", HERE, transformation=placed((), 0, 0, 100))]
    posture = take_posture(build_robot(mounts, modules))
    twist = jacobian(posture, "Camera", ["Head"])[:, 0]
    assert twist.tolist() == [0, 1, 0, 100, 0, 0]


def test_the_jacobian_is_the_derivative_of_the_pose() -> None:
    """Central differences of the forward kinematics give the same twists."""
    chooser = random.Random(7)
    for _ in range(20):
        chain = random_chain(chooser)
        known = {m.name: m for m in chain.declared}
        mounts = [r for r in chain.relationships if isinstance(r, Mount)]
        body = build_robot(mounts, known)
        joints = [j for name in body.ancestors("M0") for j in body.joints[name]]
        values = {joint: chooser.uniform(-90, 90) for joint in joints}
        here = take_posture(body, values)
        columns = jacobian(here, "M0", body.ancestors("M0"))
        for joint, column in zip(joints, columns.T, strict=True):
            step = 1e-3
            ahead, after = (
                take_posture(body, {**values, joint: values[joint] + way}).poses["M0"]
                for way in (step, -step)
            )
            scale = math.radians(step) if joint.function.startswith("Rotn") else step
            rate = inverse(here.poses["M0"]) @ (ahead - after) / (2 * scale)
            found = [rate[2, 1], rate[0, 2], rate[1, 0], *rate[:3, 3]]
            assert found == pytest.approx(column.tolist(), abs=1e-4)


def test_the_span_of_parallel_axes_grows_away_from_the_singular_posture() -> None:
    """Three parallel axes: stretched out they shift the tool one way only, bent in the plane."""
    modules = {name: module(name, "Rotn_Z") for name in ("A", "B", "C")}
    arm = placed((), 300, 0, 0)
    mounts = [
        Mount("Tool", "C", HERE),
        Mount("C", "B", HERE, transformation=arm),
        Mount("B", "A", HERE, transformation=arm),
    ]
    body = build_robot(mounts, modules)
    ancestors = body.ancestors("Tool")
    assert ancestors == ("C", "B", "A")
    straight = jacobian(take_posture(body), "Tool", ancestors)
    assert spanned(straight).tolist() == [False, False, True, False, True, False]
    bent = jacobian(take_posture(body, {Joint("B", "Rotn_Z"): 30.0}), "Tool", ancestors)
    assert spanned(bent).tolist() == [False, False, True, True, True, False]


def test_nothing_spans_nothing() -> None:
    assert not spanned(np.zeros((6, 2))).any()
    assert not spanned(np.empty((6, 0))).any()


def test_cycles_have_no_frame_and_the_first_of_two_mounts_counts() -> None:
    mounts = [
        Mount("A", "B", HERE),
        Mount("B", "A", HERE),
        Mount("C", "B", HERE),
        Mount("S", "S", HERE),
        Mount("D", "P", HERE, transformation=placed((), 1, 0, 0)),
        Mount("D", "Q", HERE),
    ]
    found = frames(robot(mounts, ()), {})
    assert {name: root for name, (root, _) in found.items()} == {"D": "P", "P": "P"}
    assert found["D"][1].tolist() == [[1, 0, 0, 1], [0, 1, 0, 0], [0, 0, 1, 0]]


def test_motions_and_twists_of_every_function() -> None:
    for index, function in enumerate(MOTION_FUNCTIONS):
        assert unit_twist(function).tolist() == [float(i == index) for i in range(6)]
    assert motion("Trans_Y", 7.5)[:3, 3].tolist() == [0, 7.5, 0]
    assert (motion("Rotn_Y", 90)[:3, :3] @ [0, 0, 1]).tolist() == [1, 0, 0]


def oracle_matrix(rotations: list[tuple[str, float]], shift: list[float]) -> Matrix:
    """Return R2 R1 and the shift, the rotations built by pytransform3d."""
    matrix = np.eye(4)
    for axis, degrees in rotations:
        turn = active_matrix_from_angle("xyz".index(axis), math.radians(degrees))
        matrix[:3, :3] = turn @ matrix[:3, :3]
    matrix[:3, 3] = shift
    return matrix


def test_random_chains_agree_with_pytransform3d() -> None:
    chooser = random.Random(8)
    for _ in range(200):
        should = np.eye(4)
        mounts = []
        for n in range(chooser.randint(1, 8)):
            turns = [
                (chooser.choice("xyz"), round(chooser.uniform(-400, 400), 6))
                for _ in range(chooser.randrange(3))
            ]
            shift = [round(chooser.uniform(-1, 1), 6) for _ in range(3)]
            at = placed(turns, *shift)
            mounts.append(Mount(f"M{n}", f"M{n + 1}", HERE, transformation=at))
            should = concat(should, oracle_matrix(turns, shift))
        _, matrix = frames(robot(mounts, ()), {})["M0"]
        assert np.abs(matrix - should[:3]).max() < 1e-12


def test_the_adjoint_agrees_with_pytransform3d() -> None:
    chooser = random.Random(9)
    for _ in range(50):
        pose = transformation_matrix(random_placement(chooser, True))
        assert adjoint(pose) == pytest.approx(adjoint_from_transform(pose), abs=1e-12)
