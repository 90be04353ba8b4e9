"""Pictures: everything is drawn once, names are text and nothing else, bytes are the same."""

import os
import re
import struct
import subprocess
import sys
from collections import Counter
from itertools import pairwise
from pathlib import Path
from xml.etree.ElementTree import Element, fromstring

import pygraphviz
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mars_asp.cli import run_here
from mars_asp.cli.suggested_commands import way_to_install
from mars_asp.diagnostic import Severity
from mars_asp.draw import Picture, depict
from mars_asp.draw.dot import dot_text
from mars_asp.draw.mermaid import mermaid_text
from mars_asp.draw.picture import Box, Line, LineKind, NumberedFinding, numbers
from mars_asp.draw.svg import svg_text
from mars_asp.language.print import print_relationship
from mars_asp.reasoning.project import load_project
from tests.support.campaigns import examples
from tests.support.documents import ROOT
from tests.support.fixtures import Captured, Patch

PICTURES = ROOT / "docs" / "pictures"
#: Pictures that were looked at, with what they show.
GOLDEN = {
    "figure04": "examples/figure04-divergence/config.mars",
    "figure05": "tests/specifications/figure04-divergence.mars",
    "level0": "examples/level0/config.mars",
    "level0-specification": "tests/specifications/level0.mars",
    "mobile-camera": "examples/mobile-camera/config.mars",
    "side-lines": "tests/draw/side-lines.mars",
    "figure07-specification": "tests/specifications/figure07-representation.mars",
}
FILES = sorted(
    str(path.relative_to(ROOT))
    for folder in ("examples/*/*.mars", "tests/specifications/*.mars", "tests/*.mars")
    for path in ROOT.glob(folder)
)
KINDS: tuple[LineKind, ...] = ("mount", "data", "control")
LINE_KINDS: tuple[LineKind, ...] = (*KINDS, "reset", "lock", "limit")
NODES = (
    None,
    "data_splitter",
    "data_transformer",
    "arbitration_node",
    "control_splitter",
    "gate_node",
)
SVG = "{http://www.w3.org/2000/svg}"


def picture_of(path: str) -> Picture:
    project = load_project(str(ROOT / path), ())
    return depict(project.configuration, project.modules)


def titles(root: Element, *classes: str) -> list[str]:
    picture = next(group for group in root if group.get("class") == "picture")
    return [
        group[0].text or ""
        for group in picture
        if group.get("class", "").partition(" ")[0] in classes
    ]


@st.composite
def pictures(draw: st.DrawFn) -> Picture:
    text = st.text(st.characters(exclude_categories=("Cc", "Cs", "Cf", "Co", "Zl", "Zp")))
    words = text.map(lambda found: " ".join(found.split()))
    severities: list[Severity] = ["error", "warning"]
    finding = st.builds(NumberedFinding, st.integers(1, 9), st.sampled_from(severities), words)
    findings = st.lists(finding, max_size=2, unique_by=lambda each: each.number).map(tuple)
    names = words.map(lambda name: f"A{name}")
    boxes = draw(
        st.lists(
            st.builds(Box, names, words, st.sampled_from(NODES), findings=findings),
            min_size=1,
            max_size=5,
        )
    )
    box = st.integers(0, len(boxes) - 1)
    lines = st.builds(Line, st.sampled_from(LINE_KINDS), box, box, words, words, findings=findings)
    return Picture(draw(words), tuple(boxes), tuple(draw(st.lists(lines, max_size=6))))


@pytest.mark.parametrize("name", GOLDEN)
def test_picture_is_the_one_that_was_looked_at(name: str, update_golden: bool) -> None:
    golden = PICTURES / f"{name}.svg"
    drawn = svg_text(picture_of(GOLDEN[name]))
    if update_golden:
        golden.write_text(drawn, encoding="utf-8")
    assert drawn == golden.read_text(encoding="utf-8")


@pytest.mark.parametrize("path", FILES)
def test_each_module_and_relationship_is_drawn_once(path: str) -> None:
    configuration = load_project(str(ROOT / path), ()).configuration
    picture = picture_of(path)
    root = fromstring(svg_text(picture))
    names = {name.text for name in configuration.modules}
    boxes = [title.partition(":")[0] for title in titles(root, "module", *filter(None, NODES))]
    boxes += [title.partition(":")[0] for title in titles(root, "inheritance_node")]
    assert names <= set(boxes)
    assert max(Counter(boxes).values()) == 1
    written = sorted(map(print_relationship, configuration.relationships))
    assert sorted(titles(root, *LINE_KINDS)) == written
    graph = pygraphviz.AGraph(string=dot_text(picture))
    assert len(graph.nodes()) == len(boxes)
    assert len(graph.edges()) == len(written)
    lines = mermaid_text(picture).splitlines()
    assert sum(bool(re.match(r"  n\d+ (===|-->|-\.->)", line)) for line in lines) == len(written)


def test_the_kinds_of_relationship_are_drawn_differently() -> None:
    root = fromstring(svg_text(picture_of("examples/level0/config.mars")))
    looks = {
        (group.get("class"), group[1].get("stroke"), group[1].get("stroke-dasharray"))
        for group in root.iter(f"{SVG}g")
        if group.get("class") in KINDS
    }
    assert len(looks) == len({look[0] for look in looks}) == len({look[1:] for look in looks}) == 3


def test_lines_follow_the_flow_and_are_labelled_with_their_mode() -> None:
    project = load_project(
        "robot.mars",
        (),
        "@configuration hierarchical\n@modules A, B, C\nA 1 is_mounted_on B 2 (_,_,_,1,2,3)\n"
        "B is_controlled_by C 4 hold 250\nC uses_data_from A NotifyOnMin(300, of=nearest)\n"
        "B uses_data_from A NotifyAtFrequency 12.5\n",
    )
    picture = depict(project.configuration, project.modules)
    assert [box.name for box in picture.boxes] == ["A", "B", "C"]
    assert [(line.kind, line.tail, line.head, line.label) for line in picture.lines] == [
        ("mount", 0, 1, "vertex 1 on 2\n1 mm along x, 2 mm along y, 3 mm along z"),
        ("control", 2, 1, "priority 4 hold 250 ms"),
        ("data", 0, 2, "NotifyOnMin(300, of=nearest)"),
        ("data", 0, 1, "12.5 Hz"),
    ]


def test_side_lines_have_their_signs_and_words() -> None:
    picture = picture_of("tests/draw/side-lines.mars")
    boxes = {box.name: box for box in picture.boxes}
    assert (boxes["Gate1"].note, boxes["Gate1"].carries) == ("S/I", "data")
    assert (boxes["Gate2"].note, boxes["Gate2"].carries) == ("I", "control")
    assert boxes["ArbitrationNode"].note == "weighted arbitration, period 100 ms"
    lines = [line for line in picture.lines if line.end != "top"]
    assert [(line.kind, line.end, line.label) for line in lines] == [
        ("data", "side", "S 150 ms"),
        ("data", "side", "loud\nI 250 ms"),
        ("reset", "foot", ""),
        ("control", "side", "200 ms"),
        ("lock", "side", "locks below 200\nhold 500 ms"),
        ("lock", "side", "locks"),
        ("limit", "side", "limits\nhold 100 ms"),
        ("reset", "foot", "done"),
    ]


def test_a_suppression_of_a_configuration_leads_to_the_suppressed_module() -> None:
    project = load_project(
        "robot.mars",
        (),
        "@configuration\n@modules A, B, C\nB uses_data_from A\nA is_suppressed_by C.wish 300\n",
    )
    (_, line) = depict(project.configuration, project.modules).lines
    assert (line.tail, line.head, line.label) == (2, 0, "wish\nsuppresses 300 ms")


def test_a_transformer_shows_its_conversion_and_a_module_may_have_the_name_of_a_node() -> None:
    boxes = {box.name: box for box in picture_of(GOLDEN["figure07-specification"]).boxes}
    assert boxes["DataTransformer1"].node == "data_transformer"
    assert boxes["DataTransformer1"].note == "RawImage → LineDescriptions"
    text = "@configuration\n@modules DataSplitter1, A\nDataSplitter1 uses_data_from A\n"
    project = load_project("robot.mars", (), text)
    assert {box.node for box in depict(project.configuration, project.modules).boxes} == {None}


@settings(max_examples=examples(30, 100), deadline=None)
@given(pictures())
def test_svg_holds_the_text_and_nothing_else(picture: Picture) -> None:
    root = fromstring(svg_text(picture))
    inert = {"svg", "title", "defs", "marker", "path", "rect", "g", "text", "circle"}
    assert {element.tag.removeprefix(SVG) for element in root.iter()} <= inert
    assert not [name for element in root.iter() for name in element.attrib if "href" in name]
    kept = str.maketrans(dict.fromkeys("\ufffe\uffff", "\ufffd"))
    entries = [
        line.text.translate(kept) for kind in KINDS for line in picture.lines if line.kind == kind
    ]
    assert titles(root, *KINDS) == entries
    assert root[0].text == (picture.title.translate(kept) or None)


@settings(max_examples=examples(30, 100), deadline=None)
@given(pictures())
def test_graphviz_reads_the_names(picture: Picture) -> None:
    graph = pygraphviz.AGraph(string=dot_text(picture))
    for index, box in enumerate(picture.boxes):
        words = [text for text in (box.name, box.note, numbers(box.findings)) if text]
        escaped = [text.replace("\\", "\\\\").replace("&", "&amp;") for text in words]
        assert graph.get_node(f"n{index}").attr["label"] == "\\n".join(escaped)
    assert len(graph.edges()) == len(picture.lines)


def test_graphviz_shows_hostile_names_as_they_are() -> None:
    names = ['"]; evil [label="', "&quot;", "\\N \\G", "<b>bold</b>", "{a|b}", "#12;"]
    picture = Picture("", tuple(Box(name, "", None) for name in names), ())
    shown = pygraphviz.AGraph(string=dot_text(picture)).draw(format="svg", prog="dot")
    texts = [element.text for element in fromstring(shown).iter(f"{SVG}text")]
    assert [text.replace("\xa0", " ") for text in texts if text] == names


@settings(max_examples=examples(30, 100), deadline=None)
@given(pictures())
def test_mermaid_sees_only_letters_digits_and_plain_signs(picture: Picture) -> None:
    body = mermaid_text(picture).partition("\n")[2]
    for line in body.splitlines():
        if line.startswith("  %% "):
            assert not set('"<>`%\\|&$@!?') & set(line.removeprefix("  %% "))
        elif not line.startswith(("  style ", "  linkStyle ")):
            before, _, rest = line.partition('"')
            text, _, after = rest.rpartition('"')
            text = text.replace("<br/>", "")
            assert not set('"<>`%\\|&$@!?') & set(text)
            assert set(before + after) <= set("n0123456789 ()[]|=-.>")


def mars(
    *words: str, seed: str = "0", text: str | None = None
) -> subprocess.CompletedProcess[bytes]:
    return subprocess.run(
        [sys.executable, "-m", "mars_asp", *words],
        cwd=ROOT,
        input=None if text is None else text.encode(),
        capture_output=True,
        check=False,
        env={**os.environ, "PYTHONHASHSEED": seed},
    )


def test_png_is_twice_the_size_and_shows_the_names(tmp_path: Path) -> None:
    root = fromstring(svg_text(picture_of("examples/level0/config.mars")))
    config = (ROOT / "examples/level0/config.mars").read_text()
    pngs = []
    for name in ("SonarMap", "SnoarMap"):
        target = tmp_path / f"{name}.png"
        text = config.replace("SonarMap", name)
        assert mars("draw", "-", "-o", str(target), text=text).returncode == 0
        pngs.append(target.read_bytes())
    assert pngs[0].startswith(b"\x89PNG\r\n\x1a\n")
    width, height = struct.unpack(">II", pngs[0][16:24])
    assert abs(width - 2 * float(root.attrib["width"])) <= 1
    assert abs(height - 2 * float(root.attrib["height"])) <= 1
    assert pngs[0] != pngs[1]


def test_without_the_extra_a_png_is_refused_and_all_else_works(
    tmp_path: Path, capsys: Captured, monkeypatch: Patch
) -> None:
    monkeypatch.setitem(sys.modules, "resvg_py", None)
    config, target = str(ROOT / "examples/level0/config.mars"), tmp_path / "a.png"
    assert run_here(["draw", config, "-o", str(target)]) == 2
    output = " ".join(capsys.readouterr().err.split())
    message = (
        f"mars-asp: error: {config}: a PNG needs the package `resvg_py`, which is not installed"
    )
    assert output.startswith(message)
    assert way_to_install("png") in output
    assert not target.exists()
    assert run_here(["draw", config, "-o", str(tmp_path / "a.svg")]) == 0


def test_a_wide_picture_is_a_smaller_png(tmp_path: Path) -> None:
    names = [f"Module{index}" for index in range(250)]
    text = f"@configuration\n@modules {', '.join(names)}\n" + "".join(
        f"{name} uses_data_from Module0\n" for name in names[1:]
    )
    target = tmp_path / "wide.png"
    assert mars("draw", "-", "-o", str(target), "--whole", text=text).returncode == 0
    width, height = struct.unpack(">II", target.read_bytes()[16:24])
    assert width * height <= 41_000_000


def test_standard_output_takes_each_format() -> None:
    path = "examples/level0/config.mars"
    assert mars("draw", path, "-o", "-").stdout.startswith(b"<svg")
    assert mars("draw", path, "-o", "-", "--as", "dot").stdout.startswith(b"digraph")
    assert mars("draw", path, "-o", "-", "--as", "png").stdout.startswith(b"\x89PNG")


def test_a_diagram_that_is_too_large_is_reported(tmp_path: Path) -> None:
    names = [f"M{index}" for index in range(400)]
    lines = [f"{b} uses_data_from {a}" for a, b in pairwise(names)]
    lines += [f"M399 uses_data_from M0 NotifyAtFrequency {hz}" for hz in range(1, 200)]
    text = "\n".join(["@configuration", f"@modules {', '.join(names)}", *lines, ""])
    done = mars("draw", "-", "-o", str(tmp_path / "x.svg"), "--whole", text=text)
    assert done.returncode == 2
    assert b"too large" in done.stderr
    assert not list(tmp_path.iterdir())
    assert mars("draw", "-", "-o", str(tmp_path / "x.dot"), text=text).returncode == 0
