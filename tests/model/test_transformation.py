"""Tuples that state one pose by the same axes are written in one way."""

import random
from decimal import Decimal

import numpy as np
import pytest

from mars_asp.kinematics.frames import transformation_matrix
from mars_asp.model.declarations import Transformation
from mars_asp.model.transformation import normalized, read_transformation


def pose(*slots: str) -> Transformation:
    found = read_transformation(slots)
    assert isinstance(found, Transformation)
    return found


@pytest.mark.parametrize(
    ("slots", "alike"),
    [
        (("x", "90", "_", "_", "0", "0", "5"), ("x", "-270", "0", "0", "5")),
        (("x", "360", "y", "0", "1", "_", "_"), ("1", "0", "0")),
        (("z", "45", "z", "45.0", "_", "_", "_"), ("z", "90", "0", "0", "0")),
        (("y", "-180", "_", "_", "_", "_", "_"), ("y", "180", "_", "_", "_")),
        (("x", "30", "x", "-30", "_", "_", "_"), ("_", "_", "_")),
    ],
)
def test_texts_of_one_pose_are_equal(slots: tuple[str, ...], alike: tuple[str, ...]) -> None:
    assert normalized(pose(*slots)) == normalized(pose(*alike))


def test_another_pose_is_not_alike() -> None:
    assert normalized(pose("x", "90", "0", "0", "0")) != normalized(pose("x", "91", "0", "0", "0"))
    assert normalized(pose("x", "9", "y", "9", "0", "0", "0")) != normalized(
        pose("y", "9", "x", "9", "0", "0", "0")
    )


def test_it_stays_the_same_pose() -> None:
    rng = random.Random(1)
    for _ in range(200):
        angles = [Decimal(rng.choice([0, 30, 90, -450, 720, 1000])) for _ in range(2)]
        turns = [(rng.choice("xyz"), angle) for angle in angles]
        given = Transformation(tuple(turns), (Decimal(1), Decimal(2), Decimal(3)))
        same = normalized(given)
        assert np.allclose(transformation_matrix(given), transformation_matrix(same), atol=1e-9)
        assert normalized(same) == same
        assert all(-180 < turn <= 180 and turn for _, turn in same.rotations)
