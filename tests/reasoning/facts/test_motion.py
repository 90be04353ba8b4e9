"""The facts that mounts give, each with its numbers, computed by hand."""

from collections.abc import Iterable
from decimal import Decimal

import pytest

from mars_asp.model.declarations import Module, Mount, Transformation
from mars_asp.model.ranges import MOST
from mars_asp.reasoning.facts.motion import frame_facts
from tests.support.robots import HERE, module, placed, robot


def motion_facts(
    mounts: Iterable[tuple[str, str, Transformation | None]],
    *modules: Module,
    queries: Iterable[tuple[str, str]] = (),
) -> list[str]:
    """Return the facts about modules mounted on others."""
    made = [Mount(above, below, HERE, transformation=at) for above, below, at in mounts]
    return [str(fact.atom) for fact in frame_facts(robot(made, modules), {}, queries)]


CAM = module("Cam", sensor=True)


def about(*modules: Module, at: Transformation | None = None) -> list[str]:
    """Return the facts about a camera on some carriers in a row, the nearest at a place."""
    names = ["Cam", *(each.name for each in modules)]
    placements = [at, *[None] * len(modules)]
    mounts = list(zip(names[:-1], names[1:], placements[: len(modules)], strict=True))
    return motion_facts(mounts, CAM, *modules)


def test_there_are_no_facts_without_motion_or_query() -> None:
    turning = module("A", "Rotn_Z")
    assert about(module("A")) == []
    assert motion_facts([("Cam", "A", None)], CAM) == []
    assert motion_facts([("Box", "A", None)], module("Box"), turning) == []
    assert (
        motion_facts([("Box", "A", None)], module("Box"), turning, queries=[("Rotn_Z", "A")]) == []
    )
    assert motion_facts([], CAM, turning) == []
    facts = motion_facts([("Box", "A", None)], module("Box"), turning, queries=[("Rotn_Z", "Box")])
    assert facts == ['rooted("Box","A",1)', 'appears("Box","A","Rotn_Z","Rotn_Z",1)']


def test_a_module_on_a_fixed_carrier_is_only_rooted() -> None:
    mounts = [("Cam", "Plate", None), ("Cam2", "A", None)]
    modules = (CAM, module("Cam2", sensor=True), module("Plate"), module("A", "Rotn_Z"))
    assert motion_facts(mounts, *modules) == [
        'rooted("Cam","Plate",1)',
        'rooted("Cam2","A",1)',
        'appears("Cam2","A","Rotn_Z","Rotn_Z",1)',
    ]


def test_a_motion_appears_as_motions_of_the_carried_module() -> None:
    turned_round = placed([("x", 180)], 0, 0, 0)
    assert about(module("A", "Trans_X", "Trans_Y"), at=turned_round)[1:3] == [
        'appears("Cam","A","Trans_X","Trans_X",1)',
        'appears("Cam","A","Trans_Y","Trans_Y",-1)',
    ]
    # The camera's x lies between the carrier's x and y: cos 60 and sin 60 of them.
    oblique = about(module("A", "Trans_X"), at=placed([("z", 60)]))
    assert oblique == [
        'rooted("Cam","A",1)',
        'appears_in_part("Cam","A","Trans_X","Trans_X",500000)',
        'appears_in_part("Cam","A","Trans_X","Trans_Y",-866025)',
        'appears_in_part("Cam","A","Trans_X","Trans_Z",0)',
    ]


@pytest.mark.parametrize(("degrees", "aligned"), [("0.00000005", True), ("0.00000006", False)])
def test_the_sine_of_a_slant_of_one_billionth_is_the_least_that_counts(
    degrees: str, aligned: bool
) -> None:
    """1e-9 radians are 5.7e-8 degrees."""
    facts = about(module("A", "Rotn_X"), at=placed([("z", Decimal(degrees))]))
    assert ('appears("Cam","A","Rotn_X","Rotn_X",1)' in facts) is aligned


def test_lever_arms_are_micrometres_across_the_axis() -> None:
    """Distances along the axis and those below half a micrometre are not lever arms."""

    def arms(*shift: object, functions: tuple[str, ...] = ("Rotn_X",)) -> list[str]:
        facts = about(module("A", *functions), at=placed((), *shift))
        return [fact for fact in facts if fact.startswith("lever_arm")]

    assert arms(7, 3, -4) == ['lever_arm("Cam","A","Rotn_X",5000)']
    assert arms(7, 0, 0) == []
    assert arms(0, "0.0004", 0) == []
    assert arms(0, "0.0006", 0) == ['lever_arm("Cam","A","Rotn_X",1)']
    assert arms(3, 4, 12, functions=("Trans_X", "Rotn_Z")) == ['lever_arm("Cam","A","Rotn_Z",5000)']
    assert arms(3, 4, 0, functions=("Rotn_X", "Rotn_Y")) == [
        'lever_arm("Cam","A","Rotn_X",4000)',
        'lever_arm("Cam","A","Rotn_Y",3000)',
    ]
    assert arms(0, 2147483647, 0) == [f'lever_arm("Cam","A","Rotn_X",{MOST})']


def facts_of(name: str, facts: Iterable[str]) -> set[str]:
    return {fact for fact in facts if fact.startswith(f"{name}(")}


def test_one_carrier_combines_its_motions() -> None:
    """Two slides at 45 degrees make the camera's x and y, each of both, in every posture."""
    facts = about(module("A", "Trans_X", "Trans_Y"), at=placed([("z", 45)]))
    assert facts_of("combines", facts) == {
        f'combines("Cam","A",{posture},"{function}","{shared}")'
        for posture in ("zero", "generic")
        for function in ("Trans_X", "Trans_Y")
        for shared in ("Trans_X", "Trans_Y")
    }
    assert facts_of("combines", about(module("A", "Trans_X"))) == set()
    # After a rotation about z a slide along x reaches every shift across z.
    facts = about(module("A", "Trans_X", "Trans_Y", "Rotn_Z"), at=placed((), 300, 0, 0))
    zero = facts_of("combines", facts)
    assert 'combines("Cam","A",zero,"Rotn_Z","Rotn_Z")' in zero
    assert not any('"Rotn_Z","Trans' in fact for fact in zero)


def test_the_fewest_nearest_carriers_together_give_a_motion_that_none_gives_alone() -> None:
    """A, B and C slide along x at 0, 45 and 90 degrees to the camera's x.

    A gives x alone and C gives y alone, so nothing is left for several; without C any two give y,
    and A and B are nearest.
    """

    def sliding(*turns: int) -> list[str]:
        names = ["Cam", *"ABC"[: len(turns)]]
        places = [placed([("z", turn)]) for turn in turns]
        mounts = list(zip(names[:-1], names[1:], places, strict=True))
        return motion_facts(mounts, CAM, *(module(name, "Trans_X") for name in names[1:]))

    assert facts_of("support", sliding(0, -45, -45)) == set()
    assert facts_of("shares", sliding(0, -45, -45)) == set()
    facts = sliding(0, -45)
    assert facts_of("support", facts) == {'support("Cam","Trans_Y",0,3)'}
    assert facts_of("shares", facts) == {
        'shares("Cam","Trans_Y",0,"A","Trans_X")',
        'shares("Cam","Trans_Y",0,"B","Trans_X")',
    }
    facts = sliding(0, -30, -30)
    assert facts_of("support", facts) == {'support("Cam","Trans_Y",0,3)'}
    facts = sliding(20, 30)
    assert facts_of("support", facts) == {
        'support("Cam","Trans_X",0,3)',
        'support("Cam","Trans_Y",0,3)',
    }
    assert facts_of("circuit", facts) == set()


def test_a_motion_combined_by_one_carrier_has_no_other_support() -> None:
    modules = module("A", "Trans_X", "Trans_Y"), module("B", "Trans_X")
    facts = motion_facts([("Cam", "A", placed([("z", 30)])), ("A", "B", None)], CAM, *modules)
    assert facts_of("combines", facts) != set()
    assert facts_of("support", facts) == set()


def test_sets_as_near_as_another_are_numbered_by_their_names() -> None:
    """Four slides along y, each turned out of it by 30 degrees: the first and the last towards x,
    to either side, the others towards z. Two of one plane give the shift along y.
    """
    mounts = [
        ("Cam", "Z", placed([("z", 30)])),
        ("Z", "A", placed([("z", -30), ("x", 30)])),
        ("A", "B", placed([("x", -60)])),
        ("B", "Y", placed([("x", 30), ("z", -30)])),
        ("Y", "Far", None),
    ]
    facts = motion_facts(
        mounts, CAM, *(module(name, "Trans_Y") for name in ("Z", "A", "B", "Y", "Far"))
    )
    about_y = [fact for fact in facts if fact.startswith(('support("Cam","Trans_Y"', "shares"))]
    assert [fact for fact in about_y if '"Trans_Y",' in fact and '"Cam","Trans_Y"' in fact] == [
        'support("Cam","Trans_Y",0,5)',
        'shares("Cam","Trans_Y",0,"A","Trans_Y")',
        'shares("Cam","Trans_Y",0,"B","Trans_Y")',
        'support("Cam","Trans_Y",1,5)',
        'shares("Cam","Trans_Y",1,"Z","Trans_Y")',
        'shares("Cam","Trans_Y",1,"Y","Trans_Y")',
    ]


def test_a_queried_motion_has_the_circuits_of_several_carriers() -> None:
    """Three slides in a plane: x by A alone, y by any two; a circuit within one carrier is none."""
    mounts = [
        ("Cam", "A", None),
        ("A", "B", placed([("z", -30)])),
        ("B", "C", placed([("z", -30)])),
    ]
    modules = [module(name, "Trans_X") for name in "ABC"]
    queries = [("Trans_Y", "Cam"), ("Trans_Y", "Cam"), ("Grasp", "Cam"), ("Trans_Z", "Cam")]
    facts = motion_facts(mounts, CAM, *modules, queries=queries)
    assert [fact for fact in facts if fact.startswith("circuit")] == [
        f'circuit("Cam","Trans_Y",{number},"{name}","Trans_X")'
        for number, pair in enumerate(["AB", "AC", "BC"])
        for name in pair
    ]
    both = [module("A", "Trans_X", "Trans_Y"), module("B", "Rotn_Z")]
    facts = motion_facts(
        [("Cam", "A", placed([("z", 30)])), ("A", "B", None)], CAM, *both, queries=queries[:1]
    )
    assert facts_of("circuit", facts) == set()
