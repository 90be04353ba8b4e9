"""Scenarios of several robots: owners of devices, requirements of each robot, and refusals."""

from pathlib import Path
from typing import Any

import pytest

from mars_asp.cli.run_json import run_json
from mars_asp.diagnostic import MarsError
from mars_asp.execution.judgement import judge
from mars_asp.execution.recording.picture import plot_run
from mars_asp.execution.scenario.read import read_scenario
from tests.support.refusals import refusal
from tests.support.trials import trial, verdicts

TWO = """\
duration = 3
[[robot]]
name = "left"
module = "left/P"
radius = 100
[[robot]]
name = "right"
module = "right/P"
radius = 100
start = [1000, 0, 180]
[devices]
"left/C" = { kind = "joystick", script = [[0, "Trans_Z", 200]] }
"right/C" = { kind = "joystick", script = [[0, "Trans_Z", 100]] }
"""
DRIVE = """\
@specification
@modules left/P, left/C, right/P, right/C
left/P is_controlled_by left/C
right/P is_controlled_by right/C
"""
REQUIREMENTS = "[requirements]\nno_collision = true\nclearance = 50\n"


def test_a_contact_of_two_counts_once_and_names_the_driving_robot() -> None:
    made = trial(TWO + REQUIREMENTS, DRIVE)
    judgement = judge(made)
    entries = {r.name: r.message for r in judgement.requirements if not r.holds}
    assert entries["clearance"] == (
        "the least clearance between `left` and `right` was 0.001 mm, and 50 mm is required"
    )
    for one, other in (("left", "right"), ("right", "left")):
        assert (
            f"`{one}` came into contact with `{other}` at 2.667 s, while it obeyed `{one}/C` "
            "in Trans_Z"
        ) in entries["no_collision"]
    run: dict[str, Any] = run_json(made, judgement)
    assert run["collisions"] == 1
    first, second = run["robots"]
    assert [c["with"] for c in (*first["collisions"], *second["collisions"])] == ["right", "left"]
    assert (first["nearest"], second["nearest"]) == ("right", "left")
    assert run["driven_mm"] == pytest.approx(800, abs=1)


def test_each_robot_has_its_own_place_to_reach() -> None:
    here = TWO.replace('name = "left"', 'name = "left"\nreach = { at = [400, 0], radius = 10 }')
    both = here.replace('name = "right"', 'name = "right"\nreach = { at = [0, 0], within = 2 }')
    assert verdicts(trial(here, DRIVE))["reach"] is True
    made = trial(both, DRIVE)
    (wrong,) = (r for r in judge(made).requirements if not r.holds)
    assert wrong.message == "`right` did not reach (0, 0) within 2 s; nearest 800 mm, at 2 s"


def test_a_device_is_on_the_robot_that_carries_it() -> None:
    bumpers = 'B = { kind = "odometry" }\n"left/B" = { kind = "odometry" }\n'
    lines = DRIVE.replace("right/C\n", "right/C, B, left/B, X, Y\n", 1) + (
        "B is_mounted_on X\nX is_mounted_on right/P\nleft/B is_mounted_on left/P\n"
        "Y uses_data_from B\nX uses_data_from left/B\n"
    )
    seen: dict[str, list[float]] = {}
    made = trial(TWO + bumpers, lines)
    for name in ("B", "left/B"):
        seen[name] = made.executor.elements[name].call()
    assert [seen[name][0] for name in ("left/B", "B")] == pytest.approx(
        [body.pose.forward for body in made.bodies]
    )


def test_of_several_robots_each_has_its_own_state_of_a_file(tmp_path: Path) -> None:
    (tmp_path / "b.py").write_text(
        "count = [0]\ndef go():\n    count[0] += 1\n    return 'Trans_Z', float(count[0])\n"
    )
    head = TWO[: TWO.index("[devices]")]
    bound = head + "".join(
        f'[bindings."{name}/C"]\npython = "b.py:go"\nperiod = 1000\n' for name in ("left", "right")
    )
    made = trial(bound, DRIVE, tmp_path)
    applied = [effector.applied for effector in made.executor.effectors.values()]
    assert [[c.get("Trans_Z") for _, _, c in each if c] for each in applied] == [[1, 2, 3, 4]] * 2


def test_a_picture_shows_all_robots() -> None:
    assert plot_run(trial(TWO, DRIVE)).count('<g id="robot') == 2


WRONG = [
    ('name = "right"', 'name = "left"', "two robots have the name `left`", 7),
    ('module = "right/P"', 'module = "left/P"', "two robots have the module `left/P`", 8),
    ("start = [1000", "start = [150", "`right` starts 50 mm inside of `left`", 10),
    ("[devices]", "acceleration = { Trans_Y = 3 }\n[devices]", "does not carry out `Trans_Y`", 11),
    ("[devices]", "deceleration = { Trans_Z = 3 }\n[devices]", "and no acceleration", 11),
    ("[devices]", "[requirements]\nreach = { at = [0, 0] }\n[devices]", "`reach` does not st", 12),
    (
        "[devices]",
        '[devices]\nS = { kind = "sonar" }',
        "no mount leads from `S` to a robot, and there are 2",
        12,
    ),
]


@pytest.mark.parametrize(("old", "new", "message", "line"), WRONG)
def test_names_that_fit_several_robots_are_refused(
    old: str, new: str, message: str, line: int
) -> None:
    text = DRIVE.replace("right/C\n", "right/C, S, M\n", 1) + "M uses_data_from S\n"
    found = refusal(trial, TWO.replace(old, new), text if "sonar" in new else DRIVE)
    assert message in found.message
    assert found.span.line == line


def test_an_obstacle_may_go_round_by_points() -> None:
    text = 'duration = 3\n[robot]\nmodule = "P"\n[world]\n'
    way = "[[900, 0], [900, 900], [0, 900], [900, 0]]"
    made = trial(
        f"{text}moving = [{{ way = {way}, radius = 10, speed = 900 }}]\n",
        "@specification\n@modules P\n",
    )
    (obstacle,) = made.bodies[0].world.moving
    assert obstacle.at(1.5) == pytest.approx((450, 900))
    assert obstacle.at(2 + 2**0.5) == pytest.approx((900, 0))
    for wrong, item in (
        ("way = [[0, 0]]", "`way` must be a list of at least two points"),
        (f"way = {way}, to = [0, 0]", "an entry of `moving` must be a table"),
        ("from = [0, 0]", "an entry of `moving` must be a table"),
    ):
        with pytest.raises(MarsError, match=item):
            read_scenario(f"{text}moving = [{{ {wrong}, radius = 1, speed = 1 }}]\n", Path("s"))
