"""Excerpts of diagrams: the neighbours of a box, relationships of some kinds, and size limits."""

import re
from collections import deque
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mars_asp.cli import run_here
from mars_asp.draw.part import SCREEN, about, fitting, left_out, of_kinds
from mars_asp.draw.picture import Box, Line, LineKind, Picture
from mars_asp.draw.svg import drawn_width, svg_text
from tests.support.campaigns import examples, sample
from tests.support.fixtures import Captured, Patch

ROS2 = Path(__file__).parents[2] / "examples" / "ros2_workspace"
KINDS: tuple[LineKind, ...] = ("mount", "data", "control")
ROBOT = """\
@configuration hierarchical
@modules A, B, "C d", Base, Arm, Lone
B.in uses_data_from A.out
"C d" uses_data_from B
Base is_controlled_by "C d" 1
Arm is_mounted_on Base
"""


@st.composite
def pictures(draw: st.DrawFn) -> Picture:
    count = draw(st.integers(1, 12))
    boxes = tuple(Box(f"M{number}", "", None) for number in range(count))
    ends, ports = st.integers(0, count - 1), st.sampled_from([None, "p", "q"])
    kinds, nothing = st.sampled_from(KINDS), st.just("")
    lines = draw(st.lists(st.builds(Line, kinds, ends, ends, nothing, nothing, ports, ports)))
    return Picture("", boxes, tuple(lines))


def named(picture: Picture) -> set[tuple[str, ...]]:
    """Return the lines by the names of their ends."""
    names = [box.name for box in picture.boxes]
    return {
        (each.kind, names[each.tail], names[each.head], each.outlet or "", each.inlet or "")
        for each in picture.lines
    }


@settings(max_examples=examples(20, 60))
@given(pictures(), st.integers(0, 4), st.sampled_from([None, "p"]))
def test_the_excerpt_holds_the_boxes_that_a_walk_reaches(
    picture: Picture, depth: int, port: str | None
) -> None:
    distance, queue = {"M0": 0}, deque(["M0"])
    joined = named(picture)
    wire = {
        each
        for each in joined
        if port is None or ("M0", port) in ((each[1], each[3]), (each[2], each[4]))
    }
    while queue:
        name = queue.popleft()
        for _, tail, head, *_ in wire if name == "M0" else joined:
            for other in (head,) if tail == name else (tail,) if head == name else ():
                if other not in distance:
                    distance[other] = distance[name] + 1
                    queue.append(other)
    near = {name for name, steps in distance.items() if steps <= depth}
    part = about(picture, "M0", depth, port)
    assert {box.name for box in part.boxes} == near
    drawn = {
        each
        for each in joined
        if {each[1], each[2]} <= near and (depth != 1 or port is None or each in wire)
    }
    assert named(part) == drawn
    # What a box notes is what it lacks.
    for box in part.boxes:
        lacks = sum(box.name in (f"M{each.tail}", f"M{each.head}") for each in picture.lines) - sum(
            box.name in (part.boxes[each.tail].name, part.boxes[each.head].name)
            for each in part.lines
        )
        assert int((re.findall(r"\d+", box.note) or ["0"])[0]) == lacks


@settings(max_examples=examples(15, 30))
@given(pictures(), st.sets(st.sampled_from(KINDS)))
def test_lines_of_some_kinds_bring_their_boxes(picture: Picture, kinds: set[LineKind]) -> None:
    part = of_kinds(picture, kinds)
    assert named(part) == {line for line in named(picture) if line[0] in kinds}
    assert {box.name for box in part.boxes} == {name for line in named(part) for name in line[1:3]}


@pytest.mark.parametrize("count", [31, 400])
@pytest.mark.parametrize("shape", sample(["star", "chain", "apart", "dense"], 3))
def test_a_large_picture_is_as_wide_as_a_screen(shape: str, count: int) -> None:
    ends = {
        "star": [(0, n) for n in range(1, count)],
        "chain": [(n, n + 1) for n in range(count - 1)],
        "apart": [],
        "dense": [(n // 3, (n * n + 1) % count) for n in range(2 * count)],
    }[shape]
    boxes = tuple(Box(f"Module{number}", "", None) for number in range(count))
    lines = tuple(Line("data", tail, head, "10 Hz", "") for tail, head in ends)
    whole = Picture("", boxes, lines)
    shown = fitting(whole, drawn_width)
    assert drawn_width(shown) <= SCREEN
    assert len(shown.boxes) >= (8 if count < 100 else 12 if shape != "chain" else 100)
    assert (left_out(whole, shown) is None) == (len(shown.boxes) == count)
    # Around one that is named, it is among what is shown.
    name = f"Module{count - 2}"
    assert name in {box.name for box in fitting(whole, drawn_width, name).boxes}


def test_a_small_picture_is_drawn_as_it_is() -> None:
    boxes = tuple(Box("M" * 40 + str(number), "", None) for number in range(30))
    lines = tuple(Line("data", 0, number, "", "") for number in range(1, 30))
    whole = Picture("", boxes, lines)
    assert fitting(whole, drawn_width) is whole


@pytest.mark.parametrize(
    ("words", "shown", "message"),
    [
        ([], "A Arm B Base C-d Lone", ""),
        (["--about", "B"], "A B C-d", "left out: 3 of 6 modules and 2 of 4 relationships"),
        (["--about", "B", "--depth", "2"], "A B Base C-d", "left out: 2 of 6 modules and 1 of 4"),
        (["--about", "B", "--depth", "0"], "B", "left out: 5 of 6 modules and 4 of 4"),
        (["--about", '"C d"', "--only", "control"], "Base C-d", "left out: 4 of 6 modules and 3"),
        (["--about", "Lone", "--only", "data"], "Lone", "left out: 5 of 6 modules"),
        (["--only", "control, mounts,control"], "Arm Base C-d", "left out: 3 of 6 modules and 2"),
        (["--about", "B.in"], "A B", "left out: 4 of 6 modules and 3 of 4 relationships"),
        (["--about", "A.out", "--depth", "2"], "A B C-d", "left out: 3 of 6 modules and 2 of 4"),
        (["--about", "A.out", "--only", "control"], "A", "left out: 5 of 6 modules"),
        (
            ["--about", "Bse"],
            "",
            "`Bse` is not a module or port\n    help: did you mean `Base`?",
        ),
        (["--about", "A.uot"], "", "`A` has no port `uot`\n    help: did you mean `A.out`?"),
        (["--about", "B.x"], "", "`B` has no port `x`\n    help: its ports are B.in"),
        (["--about", "Lone.x"], "", "has no port `x`\n    help: no line joins a port of it"),
        (
            ["--about", "out"],
            "",
            "`out` is not a module or port\n    help: did you mean `A.out`?",
        ),
        (["--about", "?"], "", "help: --about takes MODULE, MODULE.PORT or a topic"),
        (["--only", "mount"], "", "found `mount`: did you mean `mounts`?"),
        (["--only", ","], "", "found `,`: expected data, control, mounts"),
        (["--depth", "1"], "", "--depth needs --about NAME"),
        (["--about", "A", "--depth", "-1"], "", "a depth is a number from 0"),
    ],
)
def test_a_part_is_drawn_or_refused(
    words: list[str], shown: str, message: str, tmp_path: Path, monkeypatch: Patch, capsys: Captured
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "300")
    Path("a.mars").write_text(ROBOT)
    for kind, pattern in (
        ("svg", r">([^<>]+)</text>"),
        ("dot", r'label="([^"\\]+)'),
        ("mmd", r'"([^"<]+)'),
    ):
        picture = Path(f"a.{kind}")
        try:
            status = run_here(["draw", "a.mars", "-o", picture.name, *words])
        except SystemExit as ended:
            status = int(ended.code or 0)
        printed = capsys.readouterr().err
        assert (status == 0, picture.exists()) == (bool(shown), bool(shown))
        # The diagram also states the omissions.
        text = picture.read_text() if shown else message
        assert message in printed and message in text and bool(printed) == bool(message)
        drawn = {name.replace(" ", "-") for name in re.findall(pattern, text)}
        assert {name for name in drawn if re.fullmatch(r"A|B|C-d|Base|Arm|Lone", name)} == set(
            shown.split()
        )


def test_a_remark_is_drawn_whole() -> None:
    remark = "left out: " + "1000 of 2000 modules and " * 4
    assert f">{remark}<" in svg_text(Picture("", (Box("A", "", None),), (), remark))


@pytest.mark.parametrize(
    ("name", "depth", "shown"),
    [
        ("/cmd_vel", 1, "/base_driver /dock /velocity_smoother"),
        ("/cmd_vel", 2, "/base_driver /dock /twist_mux /velocity_smoother"),
        ("/base_driver./cmd_vel", 1, "/base_driver /dock /velocity_smoother"),
        ("/dock./cmd_vel", 1, "/base_driver /dock"),
        ("/scan", 1, "/follow /lidar /patrol"),
    ],
)
def test_the_ends_of_a_topic_are_drawn(name: str, depth: int, shown: str, capsys: Captured) -> None:
    words = ["--about", name, "--depth", str(depth), "--as", "mmd", "-q"]
    assert run_here(["draw", str(ROS2), *words]) == 0
    boxes = re.findall(r'n\d+\["(/\w+)', capsys.readouterr().out)
    assert " ".join(sorted(boxes)) == shown


def test_a_topic_that_joins_no_modules_is_refused_with_its_port(capsys: Captured) -> None:
    assert run_here(["draw", str(ROS2), "--about", "/odometry"]) == 2
    message = " ".join(capsys.readouterr().err.split())
    assert "`/odometry` joins no two modules" in message
    assert "did you mean `/patrol./odometry`?" in message
