"""Scenarios at their limits: judgements of zero, simultaneous and endless events."""

from pathlib import Path

import pytest

from mars_asp.execution.judgement import judge
from tests.support.refusals import refusal
from tests.support.trials import BASE, DRIVE, HAND, trial, verdicts

WALL = "[world]\nwalls = [[[300, -900], [300, 900]]]\n"
REQUIREMENTS = (
    '[requirements]\nno_collision = true\nclearance = 1\nexclusive = [["Trans_Z", "Rotn_Y"]]\n'
)
NEVER = HAND.replace("200", "0")


@pytest.mark.parametrize(
    ("text", "violated", "driven"),
    [
        pytest.param(BASE + HAND + REQUIREMENTS, [], 600, id="an empty world"),
        pytest.param(
            f"{BASE}{HAND}[world]\nscatter.count = 0\n{REQUIREMENTS}", [], 600, id="0 obstacles"
        ),
        pytest.param(
            f"{BASE}radius = 0\n{HAND}{WALL}{REQUIREMENTS}",
            ["no_collision", "clearance"],
            300,
            id="a point meets a wall",
        ),
        pytest.param(f"{BASE}radius = 298\n{NEVER}{WALL}{REQUIREMENTS}", [], 0, id="speed 0"),
        pytest.param(
            f"{BASE}radius = 300\n{NEVER}{WALL}{REQUIREMENTS}",
            ["no_collision", "clearance"],
            0,
            id="it touches the wall that it starts at",
        ),
        pytest.param(
            BASE.replace("3", "0.001", 1) + HAND + WALL + REQUIREMENTS, [], 0.2, id="a run of 1 ms"
        ),
        pytest.param(
            BASE + HAND + "[requirements]\nreach = { at = [0, 0], radius = 0, within = 0 }\n",
            [],
            600,
            id="the goal is where it starts",
        ),
        pytest.param(
            BASE + HAND + "[requirements]\nreach = { at = [600, 0], radius = 0, within = 3 }\n",
            [],
            600,
            id="the goal is where it ends",
        ),
        pytest.param(
            BASE + HAND + "[requirements]\nreach = { at = [601, 0], radius = 0, within = 3 }\n",
            ["reach"],
            600,
            id="the goal is beyond the end",
        ),
    ],
)
def test_zero_durations_speeds_and_bounds(text: str, violated: list[str], driven: float) -> None:
    made = trial(text)
    assert [r.name for r in judge(made).requirements if r.holds is not True] == violated
    assert made.bodies[0].driven == pytest.approx(driven, abs=0.01)


@pytest.mark.parametrize(
    ("fault", "driven"),
    [
        ('kind = "silent", from = 0, until = 1', 400),
        ('kind = "silent", until = 99', 0),
        ('kind = "stuck", from = 0', 0),
        ('kind = "throwing", from = 0, until = 1', 400),
        ('kind = "late", by = 1000', 400),
        ('kind = "late", by = 99_000', 0),
        ('kind = "babbling", by = 1', 600),
    ],
)
def test_a_fault_from_the_first_instant_on(fault: str, driven: float) -> None:
    made = trial(f"{BASE}{HAND}[faults]\nC = {{ {fault} }}\n")
    assert judge(made).verdict == "pass"
    assert made.bodies[0].driven == pytest.approx(driven, abs=0.01)


ARBITER = """\
@specification hierarchical
@modules P, C, D, ArbitrationNode
P is_controlled_by ArbitrationNode
ArbitrationNode is_controlled_by C 1 hold {hold}
ArbitrationNode is_controlled_by D 0
"""
HANDS = HAND.replace('[[0, "Trans_Z", 200]]', '[[1, "Trans_Z", 200], [1.1, "release"]]') + (
    '[devices.D]\nkind = "joystick"\nscript = [[0, "Rotn_Y", 20]]\n'
)


@pytest.mark.parametrize(
    ("hold", "in_control"), [("10000", 2), ("forever", 2), ("1900", 1.9), ("1", 0.001)]
)
@pytest.mark.parametrize("timeout", [1, 500, 10_000])
def test_a_hold_is_kept_whatever_the_timeout(hold: str, in_control: float, timeout: int) -> None:
    text = f"command_timeout = {timeout}\n{BASE}{HANDS}"
    made = trial(text, ARBITER.format(hold=hold))
    assert judge(made).verdict == "pass"
    assert made.control_time["C"] == pytest.approx(in_control)


TWO = "@specification\n@modules P, C, A, D\nP is_controlled_by C\nA is_controlled_by D\n"
JOINT = '[devices.A]\nkind = "joint"\nfunction = "Rotn_Y"\n[devices.D]\nkind = "joystick"\n'


@pytest.mark.parametrize(
    ("drives", "turns", "holds"),
    [
        pytest.param((0, 1), (1, 3), True, id="one begins as the other ends"),
        pytest.param((1, 3), (1, 3), False, id="both begin at once"),
        pytest.param((0, 1.1), (1, 3), False, id="for one period"),
        pytest.param((3, 3), (3, 3), True, id="both in the last instant"),
    ],
)
def test_two_effectors_at_one_instant(
    drives: tuple[float, float], turns: tuple[float, float], holds: bool
) -> None:
    def script(name: str, begin: float, end: float) -> str:
        stop = f', [{end}, "{name}", 0]' if end > begin else ""
        return f'script = [[{begin}, "{name}", 9]{stop}]\n'

    hand = f'[devices.C]\nkind = "joystick"\n{script("Trans_Z", *drives)}'
    made = trial(f"{BASE}{hand}{JOINT}{script('Rotn_Y', *turns)}{REQUIREMENTS}", TWO)
    assert verdicts(made)["exclusive"] is holds


FLEET = """\
duration = 3
requirements.no_collision = true
[[robot]]
module = "P"
radius = {radius}
[[robot]]
module = "Q"
start = [{apart}, 0, 180]
radius = {radius}
"""


@pytest.mark.parametrize(
    ("radius", "apart", "contacts"), [(0, 0, 1), (200, 400, 1), (200, 402, 0), (0, 2, 0)]
)
def test_two_robots_that_start_side_by_side(radius: int, apart: int, contacts: int) -> None:
    made = trial(FLEET.format(radius=radius, apart=apart), "@specification\n@modules P, Q\n")
    assert len(made.contacts) == contacts
    assert verdicts(made)["no_collision"] is (contacts == 0)


def test_two_robots_at_one_place_are_refused() -> None:
    found = refusal(trial, FLEET.format(radius=200, apart=0), "@specification\n@modules P, Q\n")
    assert (found.span.line, found.message) == (8, "`Q` starts 400 mm inside of `P`")


def test_nothing_is_commanded_without_a_controller(tmp_path: Path) -> None:
    (tmp_path / "b.py").write_text("def go():\n    return None\n")
    binding = '[bindings.C]\npython = "b.py:go"\nperiod = 100\n'
    made = trial(f"{BASE}{binding}{REQUIREMENTS}", DRIVE, tmp_path)
    assert judge(made).verdict == "pass"
    assert made.control_time == {}
