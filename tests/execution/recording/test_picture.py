"""A run as a diagram: its elements, their positions, and no text covering another."""

import re
from math import dist, hypot
from pathlib import Path
from random import Random
from xml.etree.ElementTree import Element, fromstring

import pytest

from mars_asp.draw.shapes import text_width
from mars_asp.execution.judgement import judge
from mars_asp.execution.recording.lanes import round_step
from mars_asp.execution.recording.picture import framed, plot_run
from mars_asp.execution.recording.signs import Signs
from mars_asp.execution.simulator import Body, Fleet, Pose, World
from mars_asp.execution.simulator.approach import approach_at, least_approach, pose_at
from mars_asp.execution.trial import Trial
from tests.support.campaigns import seeds
from tests.support.trials import BASE, HAND, WALL, trial

#: Beside `C` one controller that always speaks, one that never does, and one with a long name.
SPECIFICATION = """@specification hierarchical
@modules P, C, Mute, {long}, ArbitrationNode
P is_controlled_by ArbitrationNode
ArbitrationNode is_controlled_by C 3
ArbitrationNode is_controlled_by Mute 7
ArbitrationNode is_controlled_by {long} 1
"""
LONG = "WideControllerWithANameOfWhichNobodySeesTheEnd"
OTHERS = "".join(
    f'[devices.{name}]\nkind = "joystick"\nscript = [[0, "Rotn_Y", 10]]\n'
    for name in ("Mute", LONG)
)
SILENT = '[faults.Mute]\nkind = "silent"\nfrom = 0\nuntil = 9\n'
GOAL = "[requirements]\nno_collision = true\nclearance = 1000\nreach = {}\n"
THERE, TOO_FAR = "{ at = [300, 50], radius = 60 }", "{ at = [900, 400], within = 2 }"


def drawn(made: Trial) -> Element:
    return fromstring(plot_run(made, judge(made)))


def texts(picture: Element) -> list[str]:
    return [each.text or "" for each in picture.iterfind(".//{*}text")]


def test_a_plot_names_the_holder_of_control() -> None:
    made = trial(BASE + HAND + WALL)
    assert "C" in texts(drawn(made))


def test_a_contact_is_shown_where_and_when_it_was() -> None:
    made = trial(BASE + HAND + WALL + GOAL.format(THERE))
    result, frame = texts(drawn(made)), framed(made, judge(made))[0]
    assert result[:2] == ["fail", "violated: no_collision, clearance"]
    # At 200 mm/s the rim of 200 mm comes to the wall at 500 mm after 1.5 s.
    assert "contact: at 1.50 s" in result
    assert not [each for each in result if each.startswith("least clearance")]
    x, y = frame.at(500, 0)
    title = "contact at 1.50 s"
    (found,) = re.findall(
        rf'translate\(([\d.]+) ([\d.]+)\)"><title>{title}<', plot_run(made, judge(made))
    )
    assert [float(each) for each in found] == pytest.approx([x, y], abs=0.1)


def test_a_goal_is_shown_with_when_it_was_reached_or_how_near_the_robot_came() -> None:
    # The circle of 60 mm around (300, 50) is entered at 300 - sqrt(60 ** 2 - 50 ** 2) mm.
    reached = texts(drawn(trial(BASE + HAND + GOAL.format(THERE))))
    assert "goal: 60 mm around (300, 50), reached at 1.33 s" in reached
    missed = texts(drawn(trial(BASE + HAND + GOAL.format(TOO_FAR))))
    assert missed[:2] == ["fail", "violated: reach"]
    assert "goal: 200 mm around (900, 400), not reached" in missed
    # After 2 s it is at (400, 0).
    assert f"nearest to it: {round(hypot(500, 400))} mm, at 2.00 s" in missed


def test_undecided_requirements_are_distinguished() -> None:
    made = trial(BASE + HAND + GOAL.format("{ at = [900, 400], within = 9 }"))
    assert texts(drawn(made))[:2] == ["not decided", "not decided: reach"]


def test_the_least_clearance_is_a_line_from_the_rim_to_the_thing() -> None:
    circle = "[world]\ncircles = [[300, 700, 100]]\n"
    made = trial(BASE + HAND + circle)
    (line,) = [e for e in drawn(made).iterfind(".//{*}path") if e.get("class") == "least"]
    frame = framed(made, judge(made))[0]
    ends = [float(number) for number in re.findall(r"[\d.]+", line.attrib["d"])]
    # It passes at (300, 0): from its rim at 200 to the circle at 600 mm to the side.
    assert ends == pytest.approx([*frame.at(300, 200), *frame.at(300, 600)], abs=0.06)
    assert "least clearance: 400 mm, at 1.50 s" in texts(drawn(made))


@pytest.mark.parametrize("seed", range(12))
def test_the_instant_of_the_least_clearance_is_that_of_fine_sampling(seed: int) -> None:
    random = Random(seed)
    scatter = (
        f"[world]\nscatter = {{ count = 8, within = 2500, free = 300, moving = {seed % 4} }}\n"
    )
    turns = [
        f'[{k / 2}, "{random.choice(("Trans_Z", "Rotn_Y"))}", {random.uniform(-150, 250):.0f}]'
        for k in range(6)
    ]
    hand = f'[devices.C]\nkind = "joystick"\nscript = [{", ".join(turns)}]\n'
    made = trial(f"seed = {seed}\n" + BASE + scatter + hand)
    body, least = made.bodies[0], least_approach(made.bodies[0])
    assert least is not None
    assert least.gap == pytest.approx(body.clearance, abs=1e-3)
    sampled = [(approach_at(body, k / 500).gap, k / 500) for k in range(1501)]
    assert min(sampled)[0] >= body.clearance - 0.001
    # The first instant: before it, nothing was as near.
    assert all(gap > least.gap - 0.02 for gap, at in sampled)
    assert all(gap > body.clearance + 0.005 for gap, at in sampled if at < least.at - 0.002)
    place = least.pose.forward, least.pose.side
    assert dist(place, least.thing) - body.radius == pytest.approx(least.gap, abs=1e-6)
    assert pose_at(body, 3.0) == body.pose


def test_a_silent_controller_has_a_lane_and_a_long_name_a_title() -> None:
    made = trial(
        BASE + HAND + OTHERS + SILENT + GOAL.format(TOO_FAR), SPECIFICATION.format(long=LONG)
    )
    picture = drawn(made)
    lanes = [e.get("data-name") for e in picture.iterfind(".//{*}rect") if e.get("class") == "lane"]
    assert lanes == ["C", "Mute", LONG]
    assert texts(picture).count("silent") == 1
    (title,) = [e.text for each in picture.iterfind(".//{*}text") for e in each]
    assert title == LONG
    assert_apart(picture)


def boxes(picture: Element) -> list[tuple[str, float, float, float, float]]:
    """Return each text with left, right, top and bottom of it; groups move theirs."""
    found = []
    for parent in picture.iter():
        moved = re.match(r"translate\(([-\d.]+) ([-\d.]+)\)", parent.get("transform", ""))
        dx, dy = map(float, moved.groups()) if moved else (0.0, 0.0)
        for each in parent.findall("{*}text"):
            text = (each.text or "") + "".join(part.tail or "" for part in each)
            wide = text_width(text, float(each.get("font-size", 12)))
            x, y = (
                float(each.attrib["x" if "x" in each.attrib else "y"]) + dx,
                float(each.attrib["y"]) + dy,
            )
            x -= {"end": wide, "middle": wide / 2}.get(each.get("text-anchor", ""), 0.0)
            found.append((text, x, x + wide, y - 10, y + 3))
    return found


def assert_apart(picture: Element) -> None:
    every = boxes(picture)
    assert len(every) > 5
    for number, (one, left, right, top, bottom) in enumerate(every):
        assert left >= 0, one
        assert right <= float(picture.attrib["width"]), one
        assert bottom <= float(picture.attrib["height"]), one
        for other, start, end, high, low in every[:number]:
            assert right <= start or end <= left or bottom <= high or low <= top, (one, other)


@pytest.mark.parametrize("duration", ["0.003", "1", "12.5", "1005"])
def test_no_text_covers_another_however_long_a_run_is(duration: str) -> None:
    text = (BASE + HAND + OTHERS + SILENT).replace("duration = 3", f"duration = {duration}")
    made = trial(text + GOAL.format(TOO_FAR), SPECIFICATION.format(long=LONG))
    picture = drawn(made)
    assert_apart(picture)
    assert f"{float(duration):g} s" in texts(picture)


def test_a_scale_is_a_bar_of_a_round_length() -> None:
    made = trial(BASE + HAND + WALL)
    signs = Signs(made, judge(made))
    for scale in (3.0, 0.16, 0.01, 1e-4):
        _, _, bar, text = signs.listed(scale)[0]
        found = re.search(r"M-8 0h([\d.]+)", bar)
        result = re.search(r">([\d.]+) (mm|m|km)<", text)
        assert found
        assert result
        length = float(result[1]) * {"mm": 1, "m": 1000, "km": 1_000_000}[result[2]]
        assert float(found[1]) == pytest.approx(length * scale, abs=0.1)
        assert 60 < float(found[1]) <= 160
        assert result[1].replace(".", "").strip("0") in ("1", "2", "5")


@pytest.mark.parametrize(
    ("least", "step"),
    [(0.3, 0.5), (1.0, 1), (1.01, 2), (2.5, 5), (6, 10), (360, 500), (3e-4, 5e-4)],
)
def test_a_step_is_the_least_round_one(least: float, step: float) -> None:
    assert round_step(least) == pytest.approx(step)


#: Two robots face to face, each with a place to reach, and a wall at the side of one.
TWO = """\
duration = 3
[[robot]]
name = "left"
module = "left/P"
radius = 100
reach = { at = [400, 0], radius = 10 }
[[robot]]
name = "right"
module = "right/P"
radius = 100
start = [{start}, 180]
reach = { at = [0, 0], within = 2 }
[world]
walls = [[[-500, -160], [100, -160]]]
[devices]
"left/C" = { kind = "joystick", script = [[0, "Trans_Z", 200]] }
"right/C" = { kind = "joystick", script = [[0, "Trans_Z", 100]] }
"""
DRIVES = """\
@specification
@modules left/P, left/C, right/P, right/C
left/P is_controlled_by left/C
right/P is_controlled_by right/C
"""


def two(start: str) -> Trial:
    return trial(TWO.replace("{start}", start), DRIVES)


def test_the_picture_of_two_robots_shows_each_goal_and_their_clearance() -> None:
    # They pass side by side, 230 mm apart, and the wall is 60 mm from the rim of `left`.
    made = two("500, 230")
    picture, result = drawn(made), texts(drawn(made))
    assert "goal of left: 10 mm around (400, 0), reached at 1.95 s" in result
    assert "goal of right: 200 mm around (0, 0), not reached" in result
    assert f"nearest to it: {round(hypot(300, 230))} mm, at 2.00 s" in result
    # Of 500 mm, 300 pass in each second.
    assert "least clearance of left and right: 30 mm, at 1.67 s" in result
    (line,) = [e for e in picture.iterfind(".//{*}path") if e.get("class") == "least"]
    frame, x = framed(made, judge(made))[0], 1000 / 3
    ends = [float(number) for number in re.findall(r"[\d.]+", line.attrib["d"])]
    # `left` came to it first, or `right` did: the line goes from one rim to the other.
    assert sorted([ends[:2], ends[2:]]) == [
        pytest.approx(each, abs=0.6) for each in sorted([frame.at(x, 100), frame.at(x, 130)])
    ]
    lanes = [e.get("data-name") for e in picture.iterfind(".//{*}rect") if e.get("class") == "lane"]
    assert lanes == ["left/C", "right/C"]
    ways = [e.get("stroke") for e in picture.iterfind(".//{*}polyline")]
    assert ways == list(frame.colours.values())
    robots = [e for e in picture.iterfind(".//{*}g") if e.get("id", "").startswith("robot")]
    assert [each.findtext("{*}title") for each in robots] == ["left", "right"]
    assert_apart(picture)


def test_a_contact_of_two_robots_is_one_sign_between_them() -> None:
    made = two("1000, 0")
    result = texts(drawn(made))
    assert "contact of left and right: at 2.67 s" in result
    assert not [each for each in result if each.startswith("least clearance")]
    x, y = framed(made, judge(made))[0].at(1600 / 3 + 100, 0)
    title = "contact of left and right at 2.67 s"
    (found,) = re.findall(
        rf'translate\(([\d.]+) ([\d.]+)\)"><title>{title}<', plot_run(made, judge(made))
    )
    assert [float(each) for each in found] == pytest.approx([x, y], abs=0.1)
    assert_apart(drawn(made))


def test_of_several_robots_the_least_clearance_may_be_to_a_wall() -> None:
    result = texts(drawn(two("2000, 900")))
    assert "least clearance of left: 60 mm, at 0.00 s" in result


@pytest.mark.parametrize("seed", seeds(2, 16))
def test_the_nearest_instant_of_two_robots_agrees_with_fine_sampling(seed: int) -> None:
    random = Random(seed)
    bodies = Fleet(
        [
            Body(
                World(),
                Pose(random.uniform(-900, 900), 900 * k, random.uniform(-180, 180)),
                100,
                name=f"r{k}",
                command={"Trans_Z": random.uniform(50, 400), "Rotn_Y": random.uniform(-40, 40)},
            )
            for k in range(3)
        ]
    ).bodies
    bodies[0].advance(4)
    for body in bodies:
        if body.contacts:
            continue
        least, others = least_approach(body), [b for b in bodies if b is not body]
        assert least is not None
        sampled = [
            min(approach_at(body, k / 200, other.name).gap for other in others) for k in range(801)
        ]
        # A hundredth of a millimetre is as exact as the instant is looked for.
        assert least.gap == pytest.approx(body.clearance, abs=0.011)
        assert min(sampled) >= body.clearance - 0.001
        assert all(
            gap > body.clearance + 0.001
            for k, gap in enumerate(sampled)
            if k / 200 < least.at - 0.02
        )


def test_many_contacts_of_many_robots_are_listed_in_few_lines() -> None:
    made = trial(
        "duration = 35\n"
        + "".join(
            f'[[robot]]\nname = "r{k}{"o" * 40}"\nmodule = "P{k}"\nradius = 50\n'
            f"start = [{250 * k}, 0, {180 * (k % 2)}]\n"
            for k in range(8)
        )
        + "[devices]\n"
        + "".join(
            f'C{k} = {{ kind = "joystick", script = [[0, "Trans_Z", 100], [5, "Trans_Z", -100],'
            ' [10, "Trans_Z", 100], [20, "Trans_Z", -100], [30, "Trans_Z", 100]] }\n'
            for k in range(8)
        ),
        "@specification\n@modules "
        + ", ".join(f"P{k}, C{k}" for k in range(8))
        + "\n"
        + "".join(f"P{k} is_controlled_by C{k}\n" for k in range(8)),
    )
    entries = [each for each in texts(drawn(made)) if "contact" in each]
    assert len(entries) == 7
    assert entries[-1].endswith(" of others")
    assert_apart(drawn(made))


def test_a_run_that_goes_on_has_a_picture_without_a_verdict(tmp_path: Path) -> None:
    made = trial(BASE + HAND + WALL + GOAL.format(TOO_FAR), folder=tmp_path)
    assert texts(fromstring(plot_run(made)))[0] == "running: 3.0 of 3 s"
