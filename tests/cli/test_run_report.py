"""The HTML report of `run --report` has the content of the JSON of the same run."""

import json
import re
from html import escape
from pathlib import Path
from typing import Any

import pytest

from mars_asp.cli.run_report import MOST_ROWS, replay_seen_from, report_page
from mars_asp.cli.winners import in_turn
from mars_asp.output import visible
from tests.support.documents import ROOT, run
from tests.support.pages import Page

LEVEL1 = ROOT / "examples" / "level1"
HOSTILE = "</td></script><img src=x onerror=alert(1)>\u202e"


def test_a_report_agrees_with_json(tmp_path: Path) -> None:
    words = f"run {LEVEL1}/config.mars --scenario {LEVEL1}/scenario.toml --duration 3 --quiet"
    output = run(
        f"mars-asp {words} --format json --report out.html --replay 'play it.html'", tmp_path
    )
    known = json.loads(output.strip().splitlines()[-1])
    text = (tmp_path / "out.html").read_text(encoding="utf-8")
    page = Page(text)
    tables = [[cell.text for cell in each.all("td")] for each in page.top.all("table")]
    requirements, shares, *winners = tables
    assert f": {known['verdict']}" in next(page.top.all("h1")).text
    words_of = {True: "holds", False: "violated", None: "not decided"}
    for each in known["requirements"]:
        assert [words_of[each["holds"]], each["name"], each["message"]] in triples(requirements[2:])
    assert [name for name, *_ in triples(shares)] == sorted(
        known["control_time"], key=lambda name: -known["control_time"][name]
    )
    assert [row for table in winners for row in triples(table)] == [
        [f"{held['seconds']:.3f} s", held["holder"] or "no controller", held["why"]]
        for held in known["control"]
    ]
    (link,) = page.top.all("a")
    assert link.attributes["href"] == "play%20it.html"
    assert (tmp_path / "play it.html").is_file()
    assert set(re.findall(r"https?://[^\"]*", text)) == {"http://www.w3.org/2000/svg"}


def triples(cells: list[str]) -> list[list[str]]:
    return [cells[begin : begin + 3] for begin in range(0, len(cells), 3)]


def made(**keys: Any) -> dict[str, Any]:
    run_ = {
        "verdict": "fail",
        "requirements": [],
        "warnings": [],
        "seconds": 2.0,
        "seed": 1,
        "collisions": 1,
    }
    return {
        **run_,
        "min_clearance_mm": None,
        "driven_mm": 0.0,
        "control_time": {},
        "control": [],
        "failures": [],
        "robots": [],
        **keys,
    }


def test_a_report_has_the_effects_of_side_lines(tmp_path: Path) -> None:
    robot = Path(LEVEL1).parent / "twist_robot"
    words = f"run {robot}/robot.mars --scenario {robot}/scenario.toml --quiet"
    run(f"mars-asp {words} --report out.html", tmp_path)
    *_, message, place = Page((tmp_path / "out.html").read_text("utf-8")).top.all("td")
    assert "had been silent for 0.5 s" in message.text
    assert place.text == f"{robot}/mux.mars:7"


def test_no_text_of_others_becomes_markup() -> None:
    known = made(
        requirements=[{"name": HOSTILE, "holds": None, "message": HOSTILE}],
        control_time={HOSTILE: 1.0},
        control=[{"seconds": 0, "node": HOSTILE, "holder": HOSTILE, "why": HOSTILE}],
        failures=[{"name": HOSTILE, "count": 2, "seconds": 0.5, "first": HOSTILE}],
    )
    text = report_page(known, "", HOSTILE, HOSTILE, [(HOSTILE, HOSTILE)])
    names = {each.name for each in Page(text).top.all()}
    assert not names & {"img", "script"}
    assert "\u202e" not in text.replace(escape(HOSTILE), "")
    assert "not decided" in text


@pytest.mark.parametrize(
    ("verdict", "states", "words"),
    [
        ("pass", (True, True), "✔ Passed: 2 of 2 requirements hold"),
        ("pass", (True,), "✔ Passed: 1 of 1 requirement holds"),
        ("fail", (True, False), "✖ Failed: 1 of 2 requirements violated: r1"),
        ("not decided", (None, True), "? Undecided: 1 of 2 requirements not decided: r0"),
    ],
)
def test_the_verdict_is_first_and_then_the_picture(
    verdict: str, states: tuple[bool | None, ...], words: str
) -> None:
    requirements = [
        {"name": f"r{number}", "holds": holds, "message": ""} for number, holds in enumerate(states)
    ]
    text = report_page(made(verdict=verdict, requirements=requirements), "<svg></svg>", "t", None)
    (shown,) = Page(text).top.all("p", "verdict")
    assert shown.text == words
    assert text.index(">" + words) < text.index("<svg>") < text.index("<table>")


def test_each_robot_of_a_fleet_has_a_row() -> None:
    alone: dict[str, Any] = {
        "collisions": [],
        "min_clearance_mm": None,
        "nearest": None,
        "reached_s": None,
    }
    alone |= {"nearest_to_place_mm": None, "driven_mm": 0.0, "control_time": {}}
    struck = [{"seconds": 0.5, "with": HOSTILE}, {"seconds": 1.25, "with": None}]
    robots = [
        {**alone, "name": "rests"},
        {
            **alone,
            "name": HOSTILE,
            "collisions": struck,
            "min_clearance_mm": 12.4,
            "nearest": "rests",
            "driven_mm": 99.7,
            "nearest_to_place_mm": 850.2,
            "control_time": {"Nav": 0.5, "Joy": 1.5},
        },
        {**alone, "name": "arrives", "reached_s": 1.5, "nearest_to_place_mm": 3.0},
    ]
    (table,) = Page(report_page(made(robots=robots), "", "t", None)).top.all("table")
    cells = [cell.text for cell in table.all("td")]
    assert [cells[begin : begin + 6] for begin in range(0, len(cells), 6)] == [
        ["rests", "none", "", "0 mm", "", ""],
        [
            visible(HOSTILE),
            "2, first at 0.50 s",
            "12 mm from rests",
            "100 mm",
            "nearest 850 mm",
            "Joy 75.0 %, Nav 25.0 %",
        ],
        ["arrives", "none", "", "0 mm", "reached at 1.50 s", ""],
    ]
    assert "Robots" not in report_page(made(robots=robots[:1]), "", "t", None)


def test_a_long_table_is_cut_with_a_note() -> None:
    held = {"node": "A", "holder": None, "why": "alone"}
    control = [{**held, "seconds": each, "why": f"alone {each}"} for each in range(MOST_ROWS + 1)]
    text = report_page(made(control=control), "", "t", None)
    assert text.count("no controller") == MOST_ROWS
    assert f"the first {MOST_ROWS} of {MOST_ROWS + 1}" in text


def test_a_replay_is_found_from_the_folder_of_the_report(tmp_path: Path) -> None:
    report, replay = tmp_path / "a" / "r.html", tmp_path / "b" / "p#1.html"
    assert replay_seen_from(str(report), str(replay)) == "../b/p%231.html"


def test_alternating_winners_are_listed_once() -> None:
    first, second = ("A", "later than B"), ("B", "later than A")
    turns = [(float(at), *((first, second)[at % 2])) for at in range(24)]
    assert list(in_turn([*turns, (24.0, "C", "alone")])) == [
        (0.0, *first),
        (1.0, *second),
        (2.0, "...", "and so on in turn, 22 more times until 23.000 s"),
        (24.0, "C", "alone"),
    ]
    assert list(in_turn(turns[:19])) == turns[:19]
