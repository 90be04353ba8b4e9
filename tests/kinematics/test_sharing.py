"""How commands for a carried module are shared out, with values computed by hand."""

import math
from itertools import pairwise

import pytest

from mars_asp.kinematics.frames import Joint, build_robot
from mars_asp.kinematics.sharing import Carrying
from mars_asp.model.declarations import MOTION_FUNCTIONS, Mount, Transformation
from tests.support.robots import HERE, module, placed

Positions = dict[str, dict[str, float]]


def carrying(
    *links: tuple[str, tuple[str, ...], Transformation | None],
    carriers: str = "",
    positions: Positions | None = None,
) -> Carrying:
    """Return a camera on carriers A, B, ..., nearest first, each at its place on its carrier."""
    names = ["Cam", *(name for name, _, _ in links)]
    mounts = [
        Mount(above, below, HERE, transformation=links[place][2])
        for place, (above, below) in enumerate(pairwise(names))
    ]
    modules = {name: module(name, *functions) for name, functions, _ in links}
    there = positions or {}
    return Carrying(
        build_robot(mounts, modules),
        "Cam",
        list(carriers) or names[1:],
        lambda name: there.get(name, {}),
    )


def test_a_carrier_with_the_commanded_rotation_serves_it_alone() -> None:
    """Half a turn about x between them turns the sense of y round; a lever arm does not matter."""
    found = carrying(("A", ("Rotn_Y",), placed([("x", 180)], 0, 0, 300)))
    assert found.alone("A", "Rotn_Y") == {"Rotn_Y": pytest.approx(-1)}
    assert found.anyone("Rotn_Y")
    for function in MOTION_FUNCTIONS:
        if function != "Rotn_Y":
            assert found.alone("A", function) == {}
            assert not found.anyone(function)
    assert found.alone("A", "Grasp") == {}
    assert not found.anyone("Grasp")
    assert found.support("Grasp") == ()
    assert found.together("Grasp") == {}


def test_a_shift_is_none_that_turns_besides() -> None:
    """A turn about y at the end of a lever along z shifts along x, and turns: it gives no shift."""
    found = carrying(("A", ("Rotn_Y", "Trans_Z"), placed((), 0, 0, 300)))
    assert found.alone("A", "Trans_X") == {}
    assert found.alone("A", "Trans_Z") == {"Trans_Z": pytest.approx(1)}


def test_two_motions_of_one_carrier_combine() -> None:
    """Seen from a camera turned by 30 degrees about z, its x lies between its carrier's x and y."""
    oblique = placed([("z", 30)])
    found = carrying(("A", ("Trans_X", "Trans_Y", "Rotn_X", "Rotn_Y"), oblique))
    cosine, sine = math.cos(math.radians(30)), math.sin(math.radians(30))
    shift, turn = found.alone("A", "Trans_X"), found.alone("A", "Rotn_Y")
    assert shift == {"Trans_X": pytest.approx(cosine), "Trans_Y": pytest.approx(sine)}
    assert turn == {"Rotn_X": pytest.approx(-sine), "Rotn_Y": pytest.approx(cosine)}
    assert sorted(found.shares("Trans_X", None)) == [
        ("A", function, shift[function]) for function in ("Trans_X", "Trans_Y")
    ]


@pytest.mark.parametrize(("degrees", "shared"), [("0.0001", 1), ("0.001", 2)])
def test_a_slant_too_small_to_tell_gives_no_share(degrees: str, shared: int) -> None:
    """The least slant that counts is 3.2e-6 radians, 0.00018 degrees."""
    found = carrying(("A", ("Trans_X", "Trans_Y", "Trans_Z"), placed([("z", degrees)])))
    shares = found.alone("A", "Trans_X")
    assert len(shares) == shared
    assert shares["Trans_X"] == pytest.approx(1)


@pytest.mark.parametrize(
    ("allocation", "expected"),
    [
        (None, [("A", "Rotn_Z", 1.0)]),
        ("root", [("C", "Rotn_Z", 1.0)]),
        ("split", [("A", "Rotn_Z", 0.5), ("C", "Rotn_Z", 0.5)]),
    ],
)
def test_the_allocation_chooses_among_several_carriers(
    allocation: str | None, expected: list[tuple[str, str, float]]
) -> None:
    found = carrying(("A", ("Rotn_Z",), None), ("B", ("Rotn_X",), None), ("C", ("Rotn_Z",), None))
    assert found.shares("Rotn_Z", allocation) == expected


ARM = placed((), 100, 0, 0)


def test_turns_that_make_up_a_shift_are_in_degrees() -> None:
    """Three hinges about z, A nearest, 100 mm from one to the next; A and B are bent by 90 degrees.

    Seen from the camera A is at (-100, 0), B at (-100, 100), C at (0, 100). A radian of each
    shifts the camera by (0, 100), (100, 100), (100, 0). A shift without a turn along x thus takes
    as much of B as A turns back, and one along y as much of B as C turns back.
    """
    hinge = ("Rotn_Z",)
    joints = tuple(Joint(name, "Rotn_Z") for name in "ABC")
    two = carrying(("A", hinge, ARM), ("B", hinge, ARM), positions={"A": {"Rotn_Z": 90.0}})
    assert two.support("Trans_X") == ()
    assert two.together("Trans_X") == {}
    arm = [(name, hinge, ARM) for name in "ABC"]
    bent = carrying(*arm, positions={"A": {"Rotn_Z": 90.0}, "B": {"Rotn_Z": 90.0}})
    assert bent.support("Trans_X") == joints
    degrees = math.degrees(0.01)
    x, y = bent.together("Trans_X"), bent.together("Trans_Y")
    assert [x[joint] for joint in joints] == pytest.approx([-degrees, degrees, 0], abs=1e-9)
    assert [y[joint] for joint in joints] == pytest.approx([0, degrees, -degrees], abs=1e-9)
    shares = [(joint.module, "Rotn_Z", x[joint]) for joint in joints]
    assert bent.shares("Trans_X", None) == shares
    straight = carrying(*arm)
    assert straight.support("Trans_X") == joints
    assert straight.together("Trans_X") == {}
    assert straight.shares("Trans_X", None) == []


def test_slides_that_make_up_a_turn_are_in_mm() -> None:
    """A turn about z with a lever of 300 mm along x, whose arc a table takes back along y."""
    found = carrying(
        ("Table", ("Trans_X", "Trans_Y"), None), ("A", ("Rotn_Z",), placed((), 300, 0, 0))
    )
    shares = found.together("Rotn_Z")
    assert {(joint.module, joint.function): share for joint, share in shares.items()} == {
        ("A", "Rotn_Z"): pytest.approx(1),
        ("Table", "Trans_X"): pytest.approx(0, abs=1e-9),
        ("Table", "Trans_Y"): pytest.approx(-300 * math.pi / 180),
    }


def test_oblique_slides_of_two_carriers_give_a_motion_that_neither_gives() -> None:
    """Slides along the carrier's x, once in the camera's x, once at 45 degrees to it."""
    found = carrying(("A", ("Trans_X",), None), ("B", ("Trans_X",), placed([("z", -45)])))
    a, b = Joint("A", "Trans_X"), Joint("B", "Trans_X")
    assert found.support("Trans_Y") == (a, b)
    shares = found.together("Trans_Y")
    # The camera's frame is that of A, turned by -45 degrees in B's: B slides along (1, 1).
    assert shares[b] == pytest.approx(math.sqrt(2))
    assert shares[a] == pytest.approx(-1)
    assert found.shares("Trans_Y", "root") == [
        ("A", "Trans_X", shares[a]),
        ("B", "Trans_X", shares[b]),
    ]


def test_a_least_support_is_of_the_nearest_carriers() -> None:
    """Three oblique slides: any two make up the shift along y, and the nearest two do it."""
    turns = (("A", 0), ("B", -30), ("C", -30))
    links = [(name, ("Trans_X",), placed([("z", turn)])) for name, turn in turns]
    found = carrying(*links)
    assert found.support("Trans_Y") == (Joint("A", "Trans_X"), Joint("B", "Trans_X"))
    far = carrying(*links, carriers="BC")
    assert far.support("Trans_Y") == (Joint("B", "Trans_X"), Joint("C", "Trans_X"))
    turned_round = carrying(*links, carriers="CBA")
    assert set(turned_round.support("Trans_Y")) == set(found.support("Trans_Y"))
