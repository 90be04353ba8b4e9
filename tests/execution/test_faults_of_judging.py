"""Past faults of judging, by samples, outlines and tolerances."""

from pathlib import Path

import pytest

from mars_asp.execution.executor.link import Link
from mars_asp.execution.judgement import judge
from mars_asp.execution.promises import promises
from mars_asp.execution.trial import Trial
from tests.support.refusals import refusal
from tests.support.trials import BASE, DRIVE, HAND, trial, verdicts

REQUIREMENTS = "[requirements]\n"
FAST = HAND.replace("200]", "20000]")


def message_of(made: Trial, name: str) -> str:
    return next(r.message for r in judge(made).requirements if r.name == name)


def link_to(made: Trial, client: str) -> Link:
    return next(link for link in made.executor.links if link.client == client)


def test_a_place_between_two_samples_is_reached_when_the_way_enters_it() -> None:
    made = trial(f"{BASE}{FAST}{REQUIREMENTS}reach = {{ at = [30_500, 3], radius = 5 }}\n")
    assert verdicts(made)["reach"] is True
    assert made.reached(made.scenario.robots[0]) == pytest.approx((30_500 - 4) / 20_000)


def test_a_place_is_reached_in_time_or_not() -> None:
    for within, holds in ((1.0, False), (1.525, True)):
        requirement = f"reach = {{ at = [30_500, 0], radius = 0, within = {within} }}\n"
        assert verdicts(trial(f"{BASE}{FAST}{REQUIREMENTS}{requirement}"))["reach"] is holds


def test_a_place_that_may_still_be_reached_is_not_decided() -> None:
    made = trial(f"{BASE}{HAND}{REQUIREMENTS}reach = {{ at = [2500, 800], within = 60 }}\n")
    assert judge(made).verdict == "not decided"
    assert [d.message for d in made.remarks] == ["`within` is 60 s, and the run ends at 3 s"]
    assert message_of(made, "reach") == (
        "the run ended at 3 s, and the robot is to reach (2500, 800) by 60 s; "
        "nearest 2.062 m, at 3 s"
    )
    failed = trial(
        f"{BASE}limits = {{ Trans_Z = 1 }}\n{HAND}{REQUIREMENTS}"
        "reach = { at = [9, 9], within = 60 }\n"
    )
    assert judge(failed).verdict == "fail"


def test_a_clearance_is_measured_however_far_things_are() -> None:
    world = "[world]\nwalls = [[[9000, -9000], [9000, 9000]]]\n"
    made = trial(f"{BASE}{HAND}{world}{REQUIREMENTS}clearance = 8300\n")
    assert message_of(made, "clearance") == (
        "the least clearance of the robot was 8.2 m, and 8.3 m is required"
    )


def test_clearance_between_two_readings_is_found() -> None:
    world = "[world]\ncircles = [[20_100, 300, 60]]\n"
    made = trial(f"{BASE}{FAST}{world}{REQUIREMENTS}clearance = 45\n")
    assert made.bodies[0].clearance == pytest.approx(40, abs=1e-3)


@pytest.mark.parametrize(
    "solid",
    [
        "polygons = [[[-900, -900], [900, -900], [900, 900], [-900, 900]]]",
        "circles = [[0, 0, 900]]",
        "walls = [[[0, -900], [0, 900]]]",
        "moving = [{ from = [0, 0], to = [9000, 0], radius = 900, speed = 100 }]",
    ],
)
def test_a_start_inside_of_an_obstacle_is_refused_at_its_line(solid: str) -> None:
    text = f"{BASE}start = [0, 0, 45]\n{HAND}[world]\n{solid}\n"
    problem = refusal(trial, text)
    assert "inside of something solid" in problem.message
    assert problem.span.line == 4


TWO_ARMS = "@specification\n@modules P, C, A, D\nP is_controlled_by C\nA is_controlled_by D\n"
ARM = '[devices.A]\nkind = "joint"\nfunction = "Rotn_Y"\n'


def test_functions_exclude_each_other_over_all_effectors() -> None:
    turn = '[devices.D]\nkind = "joystick"\nscript = [[1, "Rotn_Y", 5]]\n'
    text = f'{BASE}{HAND}{ARM}{turn}{REQUIREMENTS}exclusive = [["Trans_Z", "Rotn_Y"]]\n'
    made = trial(text, TWO_ARMS)
    assert message_of(made, "exclusive") == "Trans_Z and Rotn_Y ran at once for 2 s, first at 1 s"


def test_a_grasp_excludes_other_functions_while_the_gripper_moves() -> None:
    grip = '[devices.D]\nkind = "joystick"\nscript = [[1, "Grasp", 30]]\n'
    hand = '[devices.A]\nkind = "gripper"\nrate = 40\nvalue = 50\n'
    text = f'{BASE}{HAND}{hand}{grip}{REQUIREMENTS}exclusive = [["Grasp", "Trans_Z"]]\n'
    made = trial(text, TWO_ARMS)
    assert message_of(made, "exclusive") == "Grasp and Trans_Z ran at once for 0.5 s, first at 1 s"


PROMISE = """\
@specification
@modules P, S, A, B
A uses_data_from S
B uses_data_from A
@module_start
@module_name S
@Sense NotifyAtFrequency 10
Image look();
@module_end
@module_start
@module_name A
@DataOut NotifyAtFrequency 10
Map made(Image image);
@module_end
"""
BOUND = """\
[devices.S]
kind = "odometry"
[bindings.A]
python = "b.py:same"
{delay}
[bindings.B]
python = "b.py:same"
"""


@pytest.mark.parametrize(
    ("delay", "fault", "holds"),
    [
        ("", "", True),
        ("delay = 950", "", True),
        ("delay = 2950", "", None),
        ("", '[faults]\nA = { kind = "late", by = 350 }\n', False),
        ("", '[faults]\nA = { kind = "silent", from = 2.9, until = 3 }\n', False),
    ],
)
def test_only_a_delay_without_a_declaration_breaks_a_promise(
    delay: str, fault: str, holds: bool | None, tmp_path: Path
) -> None:
    (tmp_path / "b.py").write_text("def same(x):\n    return x\n")
    made = trial(BASE + BOUND.format(delay=delay) + fault, PROMISE, tmp_path)
    assert verdicts(made)["services delivered"] is holds


def test_a_message_at_the_very_end_is_one_more_than_was_promised(tmp_path: Path) -> None:
    (tmp_path / "b.py").write_text("def same(x):\n    return x\n")
    made = trial(BASE + BOUND.format(delay=""), PROMISE, tmp_path)
    assert [link.delivered for link in made.executor.links] == [31, 31]
    assert [(p.promised, p.delivered, p.hz) for p in promises(made)] == [(30, 30, 10)] * 2


def test_a_value_overwritten_before_it_was_read_counts_as_unread(tmp_path: Path) -> None:
    (tmp_path / "b.py").write_text("def go(x):\n    return 'Trans_Z', 1\n")
    specification = "@specification\n@modules P, C, S\nC uses_data_from S\nP is_controlled_by C\n"
    bound = '[devices.S]\nkind = "odometry"\nperiod = 20\n[bindings.C]\npython = "b.py:go"\n'
    made = trial(f"{BASE}{bound}period = 100\n", specification, tmp_path)
    link = link_to(made, "C")
    # Five readings a period, and the first has one alone.
    assert (link.delivered, link.dropped["unread"]) == (151, 120)
    made = trial(f"{BASE}{bound}", specification, tmp_path)
    assert "unread" not in link_to(made, "C").dropped


HELD = "@specification hierarchical\n@modules P, C\nP is_controlled_by ArbitrationNode\n"


@pytest.mark.parametrize(
    ("hold", "driven"),
    [("hold 1500", 300), ("hold 200", 40), ("hold forever", 600)],
)
def test_an_effector_obeys_for_the_hold_of_the_arbiter(
    hold: str, driven: float, tmp_path: Path
) -> None:
    once = "spoken = []\ndef go():\n    if not spoken:\n        spoken.append(1)\n"
    (tmp_path / "b.py").write_text(once + "        return 'Trans_Z', 200\n")
    text = f'{BASE}[bindings.C]\npython = "b.py:go"\nperiod = 100\n'
    made = trial(text, f"{HELD}ArbitrationNode is_controlled_by C 0 {hold}\n", tmp_path)
    assert made.bodies[0].driven == pytest.approx(driven)
    made = trial(text, DRIVE, tmp_path)
    assert made.bodies[0].driven == pytest.approx(100)


def test_squares_are_covered_that_the_way_crosses_between_samples() -> None:
    corners = "[-300, -300], [40_000, -300], [40_000, 300], [-300, 300], [-300, -300]"
    box = f"[world]\nwalls = [[{corners}]]\n"
    made = trial(f"{BASE}{FAST}{box}{REQUIREMENTS}coverage = 1\n")
    # It stops at the end wall; the last whole square begins before that.
    assert made.coverage == 1
