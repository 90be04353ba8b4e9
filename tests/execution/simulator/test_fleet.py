"""Several robots: contact, clearance, visibility of each other, and gradual changes of rates."""

from itertools import permutations
from math import inf, pi
from random import Random

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mars_asp.execution.simulator import (
    Body,
    Circle,
    Fleet,
    Mark,
    Pose,
    Ramp,
    World,
    bumper,
    lidar,
    marks,
)
from mars_asp.execution.simulator.devices import mounted
from tests.support.bodies import alone
from tests.support.campaigns import examples, sample, seeds


def row(*rates: float, apart: float = 1000, radius: float = 100) -> tuple[Body, ...]:
    """Return robots in a row, one before the other, each driving ahead."""
    world = World(walls=[((-9000, 5000), (9000, 5000))])
    return Fleet(
        [
            Body(world, Pose(k * apart, 0, 0), radius, name=f"r{k}", command={"Trans_Z": rate})
            for k, rate in enumerate(rates)
        ]
    ).bodies


def test_two_meet_at_the_instant_at_which_their_rims_touch() -> None:
    one, other = row(300, -100)
    one.advance(9)
    assert [*one.contacts, *other.contacts] == pytest.approx([2, 2], abs=1e-5)
    assert (one.struck, other.struck) == (["r1"], ["r0"])
    assert [one.pose.forward, other.pose.forward] == pytest.approx([600, 800], abs=1e-2)
    assert [one.clearance, other.clearance] == pytest.approx([0, 0], abs=1e-2)
    assert (one.beside, bumper(one)(9), bumper(other)(9)) == ("r1", 1, 1)


def test_a_body_struck_at_rest_records_it_and_may_leave() -> None:
    one, other = row(0, -200)
    one.advance(5)
    assert (one.struck, one.contacts) == (["r1"], other.contacts)
    other.obey({"Trans_Z": 200}, 5)
    one.advance(6)
    assert other.pose.forward == pytest.approx(400, abs=0.1)
    assert [bumper(one)(6.01), len(one.contacts)] == [0, 1]


def test_following_a_slower_body_is_one_contact() -> None:
    one, other = row(200, 100)
    # They touch at 8 s, and move on together for one more.
    one.advance(9)
    assert one.contacts == other.contacts == [pytest.approx(8, abs=1e-5)]
    assert len(one.contacts) == len(other.contacts) == 1
    assert other.pose.forward == pytest.approx(1900, abs=1e-6)
    assert other.pose.forward - one.pose.forward == pytest.approx(200, abs=2)


def test_a_clearance_in_passing_is_that_of_both() -> None:
    world = World()
    first = Body(world, Pose(0, 0, 0), 100, name="a", command={"Trans_Z": 400})
    second = Body(world, Pose(2000, 250, 180), 100, name="b", command={"Trans_Z": 300})
    Fleet([first, second])
    first.advance(10)
    assert [first.clearance, second.clearance] == pytest.approx([50, 50], abs=1e-6)


def test_others_are_seen_and_hide_marks() -> None:
    world = World(marks=[Mark((2000, 0), "red"), Mark((0, 500), "blue")])
    bodies = [Body(world, Pose(1000.0 * k, 0, 0), 100, name=f"r{k}") for k in range(2)]
    Fleet(bodies)
    read = lidar(bodies[0], mounted(bodies[0]), Random(1), beams=3)
    assert read(0.0) == [inf, pytest.approx(900), inf]
    assert marks(bodies[0], mounted(bodies[0]), view=360)(0.0) == [("blue", 90.0, 500.0)]
    bodies[1].obey({"Trans_X": 500}, 0.0)
    assert read(1.0) == [inf, inf, inf]


@pytest.mark.parametrize("seed", seeds(1, 2))
def test_motion_does_not_depend_on_the_order_of_bodies_or_queries(seed: int) -> None:
    random = Random(seed)
    rates = [
        {"Trans_Z": random.uniform(-300, 300), "Rotn_Y": random.uniform(-60, 60)} for _ in range(6)
    ]

    def driven(order: tuple[int, ...], queried: tuple[int, ...]) -> list[object]:
        world = World(circles=[Circle((700, 300), 150, ((0, 900),), 120)])
        bodies = {
            k: Body(world, Pose(500 * k, 0, 70 * k), 150, name=f"r{k}", command=rates[k])
            for k in range(3)
        }
        Fleet([bodies[k] for k in order])
        for step in range(1, 40):
            for k in queried:
                if step == 25:
                    bodies[k].obey(rates[k + 3], step / 10)
                bodies[k].advance(step / 10)
        return [(b.pose, b.contacts, b.struck, b.clearance) for _, b in sorted(bodies.items())]

    orders = sample(tuple(permutations(range(3))), 2)
    result = driven(orders[0], orders[0])
    assert all(driven(order, order[::-1]) == result for order in orders[1:])


@settings(deadline=None, max_examples=examples(20, 40))
@given(st.floats(-400, 400), st.floats(-400, 400), st.floats(50, 2000), st.floats(50, 2000))
def test_a_ramp_comes_as_far_as_a_rate_that_changes_all_the_time(
    before: float, after: float, up: float, down: float
) -> None:
    ramp, gone, at = Ramp(up, down, rate=before), 0.0, 0.0
    while at < 30:
        mean = ramp.at(at, after)
        until = min(ramp.until, 30.0)
        gone, at = gone + mean * (until - at), until
    assert ramp.rate == after
    first, second = (before, after) if before * after >= 0 else (before, 0.0)
    expected, left = 0.0, 30.0
    for start, end in ((first, second), (0.0, after) if before * after < 0 else (after, after)):
        slows = abs(end) < abs(start)
        spent = abs(end - start) / (down if slows else up)
        expected, left = expected + (start + end) / 2 * spent, left - spent
    expected += after * left
    # The last millisecond of each part may be one in which the rate was reached before its end.
    assert gone == pytest.approx(expected, abs=2e-3 * (abs(before) + abs(after)) + 1e-6)


def test_a_robot_with_a_deceleration_comes_to_rest_later() -> None:
    body = alone(World(), Pose(0, 0, 0), 100, ramps={"Trans_Z": Ramp(500, 250)})
    body.obey({"Trans_Z": 200}, 0)
    body.obey({}, 1)
    body.advance(5)
    # 0.4 s to come up to 200 mm/s, and 0.8 s to come down.
    assert body.pose.forward == pytest.approx(40 + 120 + 80, abs=1e-6)
    assert body.motion[-1].speed == 0


def test_contact_ends_a_gradual_motion_where_it_is() -> None:
    world = World(walls=[((500, -900), (500, 900))])
    body = alone(world, Pose(0, 0, 0), 100, ramps={"Trans_Z": Ramp(100, 100)})
    body.obey({"Trans_Z": 400}, 0)
    body.advance(5)
    assert body.pose.forward == pytest.approx(400, abs=1e-2)
    assert body.contacts == pytest.approx([(2 * 400 / 100) ** 0.5], abs=1e-5)


def test_a_ray_from_a_robot_does_not_see_itself() -> None:
    one, _ = row(0, 0)
    assert one.rays((0, 0), np.array([pi]), 3000)[0] == inf
