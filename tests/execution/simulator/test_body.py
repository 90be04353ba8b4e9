"""Arcs, contact and devices of the simulator."""

from math import cos, inf, radians, sin
from random import Random

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mars_asp.execution.simulator import (
    Circle,
    JointDevice,
    Mark,
    Pose,
    World,
    bumper,
    joystick,
    lidar,
    marks,
    move,
    odometry,
    sonar,
)
from mars_asp.execution.simulator.approach import least_approach
from mars_asp.execution.simulator.devices import mounted
from tests.support.bodies import alone

WALL = ((1000.0, -5000.0), (1000.0, 5000.0))


@given(st.floats(-500, 500), st.floats(-180, 180).filter(lambda w: abs(w) > 1), st.floats(0, 9))
def test_a_turn_on_an_arc_agrees_with_the_closed_form(v: float, w: float, t: float) -> None:
    got = move(Pose(0, 0, 0), v, 0, w, t)
    radius, angle = v / radians(w), radians(w * t)
    assert got.forward == pytest.approx(radius * sin(angle), abs=1e-9)
    assert got.side == pytest.approx(radius * (1 - cos(angle)), abs=1e-9)


@given(st.floats(-90, 90), st.integers(2, 40))
def test_many_small_steps_are_one_large_one(w: float, n: int) -> None:
    pose = Pose(3, 4, 5)
    for _ in range(n):
        pose = move(pose, 200, 50, w, 1 / n)
    once = move(Pose(3, 4, 5), 200, 50, w, 1)
    assert (pose.forward, pose.side) == pytest.approx((once.forward, once.side), abs=1e-8)


def test_no_step_is_too_long_to_notice_a_thin_wall() -> None:
    body = alone(World(walls=[WALL]), Pose(0, 0, 0), 200, command={"Trans_Z": 5000.0})
    body.advance(10.0)
    assert body.pose.forward == pytest.approx(800, abs=0.01)
    assert [len(body.contacts), *body.contacts] == pytest.approx([1, 0.16], abs=1e-3)
    body.obey({"Trans_Z": -100.0}, 10.0)
    body.advance(11.0)
    assert body.pose.forward == pytest.approx(700, abs=0.1)
    assert len(body.contacts) == 1


@pytest.mark.parametrize("speed", [100.0, 1e6, 1e9])
@pytest.mark.parametrize("radius", [0.0, 200.0])
@pytest.mark.parametrize("turn", [0.0, 1e-3])
def test_a_body_passes_no_obstacle_at_any_speed(speed: float, radius: float, turn: float) -> None:
    """A wall is ahead, a box at the back: the body leaves the wall, and the box stops it."""
    far, until = 100 + radius, 210 / speed + 0.02
    box = [(-far, -900.0), (-far, 900.0), (-far - 50, 900.0), (-far - 50, -900.0)]
    world = World(walls=[((far, -900.0), (far, 900.0))], polygons=[box])
    body = alone(world, Pose(0, 0, 0), radius, command={"Trans_Z": speed, "Rotn_Y": turn})
    body.advance(until)
    assert body.pose.forward == pytest.approx(100, abs=2e-3)
    body.obey({"Trans_Z": -speed}, until)
    body.advance(2 * until)
    assert body.pose.forward == pytest.approx(-100, abs=2e-3)
    # The same thing within 0.1 s is the same contact.
    assert len(body.contacts) == (2 if speed == 100 else 1)
    assert body.driven == pytest.approx(300, abs=0.1)


@pytest.mark.parametrize("speed", [100.0, 1e6])
def test_a_body_slides_along_a_wall_but_not_around_a_corner_into_the_next(speed: float) -> None:
    corner = World(walls=[((100.0, -500.0), (100.0, 700.0), (-500.0, 700.0))])
    body = alone(corner, Pose(0, 0, 0), 100 - 5e-4, command={"Trans_X": speed})
    body.advance(10.0)
    assert body.pose.forward == 0
    assert body.pose.side == pytest.approx(600, abs=2e-3)


def test_an_obstacle_left_at_high_speed_is_not_checked_step_by_step() -> None:
    body = alone(World(walls=[WALL]), Pose(0, 0, 0), 200, command={"Trans_Z": -1e12})
    body.advance(1000.0)
    assert (body.pose.forward, body.clearance) == (-1e15, 800.0)


def test_a_moving_obstacle_that_reaches_a_resting_robot_collides() -> None:
    world = World(circles=[Circle((1000, 0), 100, ((0, 0),), 100)])
    body = alone(world, Pose(0, 0, 0), 200)
    body.advance(6.9)
    assert [len(body.contacts), body.clearance] == pytest.approx([0, 10], abs=0.1)
    least = least_approach(body)
    assert least is not None
    assert least.at == pytest.approx(6.9, abs=1e-6)
    body.advance(7.1)
    assert len(body.contacts) == 1


def test_rates_are_limited_and_turning_while_driving_is_timed() -> None:
    body = alone(World(), Pose(0, 0, 0), 200, limits={"Trans_Z": 100})
    body.obey({"Trans_Z": 900}, 0)
    body.obey({"Trans_Z": 100, "Rotn_Y": 10}, 1)
    body.advance(3)
    assert [body.driven, body.both] == pytest.approx([300, 2], rel=1e-3)


def test_functions_that_a_command_does_not_name_are_zero() -> None:
    body = alone(World(), Pose(0, 0, 0), 200)
    body.obey({"Trans_Z": 100}, 0)
    body.obey({"Rotn_Y": 10}, 1)
    body.advance(2)
    pose = body.pose
    assert (pose.forward, pose.side, pose.heading) == pytest.approx((100, 0, 10))
    assert body.both == 0


def test_either_axis_may_be_up() -> None:
    body = alone(World(), Pose(0, 0, 0), 200, up="z", command={"Trans_Y": 10})
    body.advance(1)
    assert [body.pose.forward, body.pose.side] == pytest.approx([0, 10])


def test_a_sonar_cone_is_the_least_over_its_rays_and_a_miss_is_infinite() -> None:
    body = alone(World(circles=[Circle((1000, 120), 20)]), Pose(0, 0, 0), 100)
    read = sonar(body, mounted(body), Random(1), beams=4, cone=15, rays=5)
    assert read(0.0) == [pytest.approx(np.hypot(1000, 120), abs=25), inf, inf, inf]
    assert sonar(body, mounted(body), Random(1), beams=4, rays=1)(0.0)[0] == inf


def test_devices_see_bump_and_reckon() -> None:
    world = World(walls=[WALL], marks=[Mark((900, 0), "red"), Mark((1100, 0), "blue")])
    body = alone(world, Pose(0, 0, 0), 200)
    assert lidar(body, mounted(body), Random(1), beams=3)(0.0) == [inf, pytest.approx(1000), inf]
    assert marks(body, mounted(body))(0.0) == [("red", 0.0, 900.0)]
    assert bumper(body)(0.0) == 0
    reckon = odometry(body, Random(1))
    body.obey({"Trans_Z": 5000.0}, 0.0)
    assert reckon(1.0)[0] == pytest.approx(800, abs=0.01)
    assert bumper(body)(1.0) == 1


def test_noise_is_seeded_for_each_device() -> None:
    body = alone(World(walls=[WALL]), Pose(0, 0, 0), 200)
    first = sonar(body, mounted(body), Random("1/a"), sigma=5)(0.0)
    assert first == sonar(body, mounted(body), Random("1/a"), sigma=5)(0.0)
    assert first != sonar(body, mounted(body), Random("1/b"), sigma=5)(0.0)


def test_joints_turn_mounted_devices_within_their_bounds() -> None:
    body = alone(World(walls=[WALL]), Pose(0, 0, 0), 200)
    joint = JointDevice("Rotn_Y", -60, 60, 30)
    place = mounted(body, [(100, 0, 0, joint)])
    joint.obey({"Rotn_Y": 90}, 0.0)
    assert place(1.0) == Pose(100, 0, 30)
    assert place(9.0).heading == 60
    gripper = JointDevice("Grasp", 0, 80, 20, value=80, wanted=80)
    gripper.obey({"Grasp": 50}, 0.0)
    assert [gripper.advance(t) for t in (1.0, 2.0)] == [60, 50]


def test_a_scripted_hand() -> None:
    read = joystick([(1, ("Trans_Z", 5)), (2, ("Rotn_Y", 3)), (4, None)])
    assert [read(t) for t in (0.5, 1, 3, 4)] == [None, ("Trans_Z", 5), ("Rotn_Y", 3), None]


@given(st.integers(0, 10**6))
@settings(max_examples=30, deadline=None)
def test_culling_changes_no_ray_and_no_distance(seed: int) -> None:
    random = Random(seed)

    def point() -> tuple[float, float]:
        return random.uniform(-9000, 9000), random.uniform(-9000, 9000)

    walls = [[point(), point()] for _ in range(20)]
    circles = [Circle(point(), random.uniform(10, 900)) for _ in range(20)]
    walked = World(walls, circles=circles)
    angles = np.array([random.uniform(-9, 9) for _ in range(16)])
    for _ in range(5):
        at, fresh = point(), World(walls, circles=circles)
        walked.rays((at[0] + 300, at[1]), angles, 3000, 0)
        got = walked.rays(at, angles, 3000, 0)
        wide = fresh.rays(at, angles, 1e6, 0)
        assert np.array_equal(got, np.where(wide > 3000, inf, wide))
        assert walked.distance(at, 0) == fresh.distance(at, 0)
