"""The HTML report that replays a run: its content, and its behaviour in a browser."""

import argparse
import json
import re
from base64 import b64encode
from functools import cache
from hashlib import sha256
from pathlib import Path

import pytest

from mars_asp.cli.output_files import write_outputs
from mars_asp.execution.executor.arbitration import Holding
from mars_asp.execution.executor.link import Observer
from mars_asp.execution.judgement import Judgement, judge
from mars_asp.execution.recording.frame import Frame
from mars_asp.execution.recording.picture import framed, plot_run
from mars_asp.execution.recording.replay import replay_json, replay_page
from mars_asp.execution.scenario.read import read_scenario
from mars_asp.execution.simulator import Circle, Pose
from mars_asp.execution.trial import Trial, stage_trial
from mars_asp.language import parse_text
from tests.support.browser import Browser, in_a_browser

#: `High` is silent from 1 to 2 s; `Low` always speaks. Holds are 2.5 periods of 100 ms.
SPECIFICATION = """@specification hierarchical
@modules P, Low, High, ArbitrationNode
P is_controlled_by ArbitrationNode
ArbitrationNode is_controlled_by Low 3
ArbitrationNode is_controlled_by High 7
"""
SCENARIO = """duration = 3
[robot]
module = "P"
[world]
walls = [[[2000, -900], [2000, 900], [-900, 900]]]
circles = [[1000, -700, 100]]
moving = [{ from = [0, 800], to = [1000, 800], radius = 50, speed = 500 }]
marks = [{ at = [500, 0], colour = "red" }]
[devices.Low]
kind = "joystick"
script = [[0, "Trans_Z", 200]]
[devices.High]
kind = "joystick"
script = [[0, "Rotn_Y", 10]]
[faults.High]
kind = "silent"
from = 1
until = 2
"""
HOSTILE = """</script></svg>"'><img src=x onerror=alert(1)>&\u202e\x00"""


def trial(scenario: str = SCENARIO, observe: Observer | None = None) -> Trial:
    made = stage_trial(
        parse_text(SPECIFICATION, "x.mars").configuration,
        {},
        read_scenario(scenario, Path("s.toml")),
        observe,
    )
    made.run_until(3.0)
    return made


def judged() -> tuple[Trial, Judgement]:
    made = trial()
    return made, judge(made)


@cache
def page() -> str:
    return replay_page(*judged(), "a title")


def hostile_page() -> str:
    """Return a replay page in which every text tries to inject markup."""
    made = trial(SCENARIO.replace('"red"', json.dumps(HOSTILE)))
    judgement, arbiter = judge(made), made.executor.arbiters["ArbitrationNode"]
    arbiter.holdings.append(Holding("ArbitrationNode", HOSTILE, 0, HOSTILE, HOSTILE))
    made.executor.effectors["P"].applied.insert(0, (0, HOSTILE, {HOSTILE: 1.0}))
    return replay_page(made, judgement, HOSTILE)


def test_a_page_holds_the_path_the_commands_and_each_winner_with_reason() -> None:
    result = replay_json(*judged())
    assert result["robots"][0]["poses"][0] == [0, 0, 0, 0]
    assert result["robots"][0]["poses"][-1][0] == 3
    assert result["moving"] == [{"round": ((0, 800), (1000, 800), (0, 800)), "speed": 500}]
    (arbiter,) = result["arbiters"]
    assert arbiter["holdings"] == [
        [0, "Low", "Low", "alone in force"],
        [0, "High", "High", "priority 7 outranks Low (3)"],
        [1.15, "Low", "Low", "the hold of High ran out; alone in force"],
        [2, "High", "High", "priority 7 outranks Low (3)"],
    ]
    low, high = arbiter["inputs"]
    assert (low["name"], low["priority"], low["in_force"]) == ("Low", 3, [[0, 3.25]])
    assert (high["name"], high["priority"]) == ("High", 7)
    assert high["in_force"] == [[0, 1.15], [2, 3.25]]
    assert [c[1] for c in result["robots"][0]["commands"]] == ["High", "Low", "High"]


def test_a_page_fetches_nothing_and_lets_only_its_own_script_run() -> None:
    text = page()
    assert re.findall(r"https?://[^\"]*", text) == ["http://www.w3.org/2000/svg"] * 2
    assert not re.search(r"\b(src|href|action)\s*=|@import|url\((?!#)|fetch\(|import\(", text)
    policy = re.search(r'Content-Security-Policy" content="([^"]*)"', text)
    assert policy
    script = re.findall(r"<script>(.*?)</script>", text, re.DOTALL)
    digest = b64encode(sha256(script[0].encode()).digest()).decode()
    assert len(script) == 1
    assert policy[1].startswith("default-src 'none'; base-uri 'none'; form-action 'none'; ")
    assert policy[1].endswith(f"script-src 'sha256-{digest}'")
    assert "unsafe" not in policy[1]


def test_no_text_of_others_becomes_markup() -> None:
    text, plain = hostile_page(), page()
    assert "<img" not in text
    for tag in ("script", "svg", "body", "g"):
        assert text.count(f"</{tag}>") == plain.count(f"</{tag}>")
    assert not re.search("[\u202e\x00]", text)
    (data,) = re.findall(r'id="run">(.*?)</script>', text, re.DOTALL)
    assert json.loads(data)["robots"][0]["commands"][0][2] == {HOSTILE: 1.0}


def test_the_same_run_gives_the_same_page() -> None:
    assert page() == replay_page(*judged(), "a title")


def test_a_picture_is_seen_from_above_forward_up_and_side_left() -> None:
    made = trial()
    made.bodies[0].pose = Pose(0, 0, 30)
    at = [Frame(made).at(*point) for point in ((0, 0), (100, 0), (0, 100))]
    assert at[1][1] < at[0][1]
    assert at[2][0] < at[0][0]
    assert "rotate(-30.0)" in plot_run(made)


def test_lanes_show_requests_and_holders_of_control() -> None:
    picture = plot_run(trial())
    assert re.findall(r'class="lane" data-name="(\w+)"', picture) == ["High", "Low"]
    wanted, held = re.findall(r"<g opacity.*?</g>", picture, re.DOTALL)
    spans = {
        name: [float(width) for width in re.findall(rf'width="([\d.]+)"[^>]*"{colour}"', held)]
        for name, colour in (("High", "#0072b2"), ("Low", "#d55e00"))
    }
    second = 530 / 3
    assert spans["High"] == pytest.approx([1.15 * second, second], abs=0.01)
    assert spans["Low"] == pytest.approx([0.85 * second], abs=0.01)
    assert f'width="{3 * second:.2f}"' in wanted


def test_a_plot_is_written_as_png_too(tmp_path: Path) -> None:
    made = trial()
    arguments = argparse.Namespace(plot=str(tmp_path / "a.png"), replay=None)
    write_outputs(made, judge(made), arguments)
    content = (tmp_path / "a.png").read_bytes()
    assert content.startswith(b"\x89PNG\r\n\x1a\n")
    found = re.match(r'<svg [^>]*width="(\d+)" height="(\d+)"', plot_run(made, judge(made)))
    assert found
    size = [int.from_bytes(content[k : k + 4]) for k in (16, 20)]
    assert size == [2 * int(found[1]), 2 * int(found[2])]


def shown(browser: Browser, path: Path, text: str) -> None:
    path.write_text(text, encoding="utf-8")
    browser.show(path)


def text_of(browser: Browser, *selectors: str) -> list[str]:
    return [
        browser.run(f"document.querySelector({json.dumps(each)}).textContent") for each in selectors
    ]


@in_a_browser
def test_the_script_runs_under_its_policy_and_names_stay_text(
    browser: Browser, tmp_path: Path
) -> None:
    shown(browser, tmp_path / "run.html", hostile_page())
    assert text_of(browser, "#time") == ["0.00 s"]
    assert "The robot obeys" in text_of(browser, "#state")[0]
    assert browser.run("document.querySelectorAll('img, script').length") == 2
    assert not browser.complaints
    assert not browser.fetched


#: Clicks a lane, some share along it.
CLICK = """((name, share) => {
  const lane = document.querySelector(`.lane[data-name="${name}"]`);
  const box = lane.getBoundingClientRect();
  lane.dispatchEvent(new MouseEvent("click", {
    bubbles: true, clientX: box.left + share * box.width, clientY: box.top + 3 }));
})"""


@in_a_browser
def test_a_click_on_a_lane_shows_the_winner_and_the_reason(
    browser: Browser, tmp_path: Path
) -> None:
    shown(browser, tmp_path / "run.html", page())

    def shown_after_click(name: str, share: float) -> list[str]:
        browser.run(f"{CLICK}({json.dumps(name)}, {share})")
        *result, state = text_of(browser, "#time", ".told", ".verdict", ".asked", ".wins", "#state")
        return [*result, state.split(".")[0]]

    assert shown_after_click("Low", 0.25) == [
        "0.75 s",
        "High holds control since 0.00 s: priority 7 outranks Low (3)",
        "Low lost to High: priority 3 against 7.",
        "Lowpriority 3in force until 3.25 s",
        "High",
        "The robot obeys High: Rotn_Y 10",
    ]
    assert shown_after_click("Low", 0.5) == [
        "1.50 s",
        "Low holds control since 1.15 s: the hold of High ran out; alone in force",
        "Low won: the hold of High ran out; alone in force.",
        "Lowpriority 3in force until 3.25 s",
        "Low",
        "The robot obeys Low: Trans_Z 200",
    ]
    assert shown_after_click("High", 0.5)[2:4] == [
        "High did not want control.",
        "Highpriority 7silent since 1.15 s",
    ]


@in_a_browser
def test_a_name_is_entered_by_keyboard_and_keeps_the_focus(
    browser: Browser, tmp_path: Path
) -> None:
    shown(browser, tmp_path / "run.html", page())
    # Play, speed, the slider, and the names.
    browser.press("Tab", 4)
    assert text_of(browser, ":focus") == ["Low"]
    browser.press("Enter")
    assert text_of(browser, ".verdict", ":focus") == [
        "Low lost to High: priority 3 against 7.",
        "Low",
    ]
    assert browser.run("document.activeElement.getAttribute('aria-pressed')") == "true"


@in_a_browser
def test_scrubbing_and_playing_move_the_robot_and_the_obstacles(
    browser: Browser, tmp_path: Path
) -> None:
    shown(browser, tmp_path / "run.html", page())

    def scrubbed(seconds: float) -> list[float]:
        found: list[float] = browser.run(
            f"""(() => {{
              const slider = document.querySelector("#slider");
              slider.value = {seconds};
              slider.dispatchEvent(new Event("input"));
              const place = document.querySelector("#robot").getAttribute("transform");
              const circle = document.querySelector(".moving").getAttribute("cy");
              return [...place.match(/-?[\\d.]+/g), circle].map(Number);
            }})()"""
        )
        return found

    start, middle, end = scrubbed(0), scrubbed(1.5), scrubbed(3)
    scale = browser.run("run.view.scale")
    scrubbed(0)
    for key in ("ArrowRight", "ArrowRight", "ArrowLeft"):
        browser.press(key)
    assert text_of(browser, "#time") == ["0.10 s"]
    browser.click("#play")
    assert text_of(browser, "#play") == ["Stop"]
    browser.wait("parseFloat(document.querySelector('#time').textContent) > 0.3")
    browser.press("Enter")
    assert text_of(browser, "#play") == ["Play"]
    # Seen from above with forward up, side is left and a heading grows counter-clockwise.
    made = trial()
    assert start[2] == 0
    assert [(start[1] - end[1]) / scale, (start[0] - end[0]) / scale, -end[2]] == pytest.approx(
        [made.bodies[0].pose.forward, made.bodies[0].pose.side, made.bodies[0].pose.heading],
        abs=0.01,
    )
    # 750 mm ahead after 1.5 s, and back to 500 mm of 1,000 after 3 s.
    moved = [(start[3] - each[3]) / scale for each in (middle, end)]
    assert moved == pytest.approx([750, 500], abs=0.01)


TWO = """duration = 3
[[robot]]
name = "one"
module = "P"
[[robot]]
name = "two"
module = "Q"
start = [3000, 0, 180]
[devices]
A = { kind = "joystick", script = [[0, "Trans_Z", 200]] }
B = { kind = "joystick", script = [[0, "Trans_Z", 100]] }
"""


@in_a_browser
def test_a_page_moves_each_of_two_robots_and_tells_of_both(
    browser: Browser, tmp_path: Path
) -> None:
    lines = "@specification\n@modules P, Q, A, B\nP is_controlled_by A\nQ is_controlled_by B\n"
    specification = parse_text(lines, "x.mars").configuration
    made = stage_trial(specification, {}, read_scenario(TWO, Path("s.toml")))
    made.run_until(3.0)
    shown(browser, tmp_path / "run.html", replay_page(made, judge(made), "two"))
    browser.run("show(2)")
    assert text_of(browser, "#state") == [
        "one obeys A: Trans_Z 200. It is at (400, 0) mm, heads 0 degrees, and has collided 0 times."
        " two obeys B: Trans_Z 100. It is at (2800, 0) mm, heads 180 degrees, and has collided"
        " 0 times."
    ]
    places = browser.run(
        """[...robots].map((each) =>
          each.getAttribute("transform").match(/-?[\\d.]+/g).slice(0, 2).map(Number))"""
    )
    frame = framed(made, judge(made))[0]
    assert places == [pytest.approx(frame.at(x, 0), abs=1e-3) for x in (400, 2800)]
    assert not browser.complaints


#: There and back, past points, in a circuit, past one point twice, and off at once.
ROUNDS = (
    Circle((0, 0), 50, ((1000, 0),), 333),
    Circle((0, 0), 50, ((1000, 0), (1000, 500), (-200, 500)), 410),
    Circle((0, 0), 50, ((700, 0), (700, 700), (0, 0)), 125),
    Circle((0, 0), 50, ((300, 0), (300, 0), (300, 300)), 80),
    Circle((5, 5), 50, ((5, 6),), 900),
)


@in_a_browser
def test_obstacles_go_their_rounds_as_the_simulator_moves_them(
    browser: Browser, tmp_path: Path
) -> None:
    made = trial()
    made.bodies[0].world.moving = ROUNDS
    shown(browser, tmp_path / "run.html", replay_page(made, judge(made), "rounds"))
    times = [0, 0.1, 1, 2.5, 3.0030030030030033, 7.25, 60.1, 1234.5]
    found = browser.run(f"run.moving.map((circle) => {times}.map((time) => placeAt(circle, time)))")
    frame = framed(made, judge(made))[0]
    for circle, places in zip(ROUNDS, found, strict=True):
        for time, place in zip(times, places, strict=True):
            assert place == pytest.approx(frame.at(*circle.at(time)), abs=1e-6), (circle, time)
    # The slider moves what is drawn, each its own.
    browser.run("show(2.5)")
    drawn = browser.run(
        "[...moving].map((each) => ['cx', 'cy'].map((name) => Number(each.getAttribute(name))))"
    )
    assert drawn == [pytest.approx(frame.at(*circle.at(2.5)), abs=1e-6) for circle in ROUNDS]
    assert not browser.complaints


@in_a_browser
def test_the_page_shows_the_verdict_without_overlapping_texts(
    browser: Browser, tmp_path: Path
) -> None:
    shown(browser, tmp_path / "run.html", page())
    shown_texts = browser.run(
        "[...document.querySelectorAll('#picture text')].map((each) => each.textContent)"
    )
    assert shown_texts[0] == "pass: all 6 requirements hold"
    assert any(each.startswith("least clearance: ") for each in shown_texts)
    # No two texts touch, as a browser draws them.
    assert browser.run(
        """(() => {
          const boxes = [...document.querySelectorAll("#picture text")].map(
            (each) => each.getBoundingClientRect());
          return boxes.every((a, k) => boxes.slice(0, k).every((b) =>
            a.right <= b.left || b.right <= a.left || a.bottom <= b.top || b.bottom <= a.top));
        })()"""
    )
