"""Pictures of robots from other formats, and the parts of a picture that words describe."""

import json
import shutil
from pathlib import Path
from xml.etree.ElementTree import Element, fromstring

import pytest

from mars_asp.cli import run_here
from tests.support.documents import run
from tests.support.fixtures import Captured, Patch

SVG = "{http://www.w3.org/2000/svg}"
MUX = """\
twist_mux:
  ros__parameters:
    topics:
      joystick: {topic: joy_vel, timeout: 0.5, priority: 100}
      autonomy: {topic: nav_vel, timeout: 0.5, priority: 10}
"""
RANKED = """\
@configuration hierarchical
@modules Base, Zed, Eve, Amy, Camera
Base is_controlled_by Zed 1
Base is_controlled_by Eve 3
Base is_controlled_by Amy 2
Zed uses_data_from Camera
Eve uses_data_from Camera
Amy uses_data_from Camera
"""


def drawn(words: str, folder: Path) -> Element:
    return fromstring(run(f"mars-asp draw {words} --quiet", folder))


def parts(root: Element, name: str = "module") -> dict[str, list[str]]:
    """Return the texts of the boxes or lines of a class by their titles."""
    picture = next(each for each in root if each.get("class") == "picture")
    return {
        str(group[0].text): [str(each.text) for each in group.iter(f"{SVG}text")]
        for group in picture.iter(f"{SVG}g")
        if group.get("class", "").split()[0] == name
    }


def test_a_mux_is_a_box_of_its_own_name_and_lines_have_topics(tmp_path: Path) -> None:
    root = drawn("examples/ros2_workspace", Path.cwd())
    assert "/twist_mux" in parts(root)
    assert not parts(root, "arbitration_node")
    assert parts(root, "control") == {
        "/base_driver is_controlled_by /dock": ["/cmd_vel", "1"],
        "/base_driver is_controlled_by /velocity_smoother": ["/cmd_vel"],
        "/velocity_smoother is_controlled_by /twist_mux": ["/cmd_vel_raw"],
        "/twist_mux is_controlled_by /teleop_twist_joy_node 100 hold 500": [
            "/joy_vel",
            "priority 100 hold 500 ms",
        ],
        "/twist_mux is_controlled_by /patrol 10 hold 500": [
            "/nav_vel",
            "priority 10 hold 500 ms",
            "2",
        ],
        "/twist_mux is_controlled_by /follow 10 hold 500": [
            "/nav_vel",
            "priority 10 hold 500 ms",
            "2",
        ],
    }
    # Both ends of a topic have one name.
    assert set(map(tuple, parts(root, "data").values())) == {("/scan",), ("/joy",)}


def test_a_mux_file_alone_has_its_mux(tmp_path: Path) -> None:
    (tmp_path / "mux.yaml").write_text(MUX, encoding="utf-8")
    root = drawn("mux.yaml", tmp_path)
    assert set(parts(root)) == {"cmd_vel_out", "joystick", "autonomy", "twist_mux"}
    assert ["joy_vel", "priority 100 hold 500 ms"] in parts(root, "control").values()


def test_muxes_of_several_files_are_boxes_of_their_own(tmp_path: Path) -> None:
    for name, text in (("a", MUX), ("b", MUX.replace("joystick", "pad"))):
        (tmp_path / f"{name}.yaml").write_text(text, encoding="utf-8")
    boxes = {"a/twist_mux", "b/twist_mux"}
    assert boxes < set(parts(drawn("a.yaml b.yaml", tmp_path)))
    page = run("mars-asp explain a.yaml b.yaml --quiet -o -", tmp_path)
    shown = fromstring(page[page.index("<svg") : page.index("</svg>") + 6])
    assert boxes < set(parts(shown))


def test_a_specification_names_the_mux_that_realises_a_node(tmp_path: Path) -> None:
    printed = run("mars-asp synthesise examples/ros2_workspace --format json --quiet")
    found = json.loads(printed[printed.index('{"architecture"') :].partition("\n")[0])
    realised = {each["name"]: each.get("realised_by") for each in found["modules"]}
    assert {name: mux for name, mux in realised.items() if mux} == {
        "ArbitrationNode2": "/twist_mux"
    }
    specification = tmp_path / "specification.mars"
    run(f"mars-asp synthesise examples/ros2_workspace --quiet -o {specification}")
    root = drawn("specification.mars", tmp_path)
    assert "/twist_mux" in parts(root)
    # The output of the smoother and of the dock meet where no file has a mux.
    assert list(parts(root, "arbitration_node")) == ["ArbitrationNode"]


def test_the_page_has_the_mux_as_the_picture_has_it(tmp_path: Path) -> None:
    (tmp_path / "mux.yaml").write_text(MUX, encoding="utf-8")
    page = run("mars-asp explain mux.yaml --quiet -o -", tmp_path)
    svg = page[page.index("<svg") : page.index("</svg>")]
    assert ">twist_mux</text>" in svg
    assert "ArbitrationNode" not in svg
    assert "ArbitrationNode</b>, which <code>twist_mux</code> realises" in page


def test_a_cascade_has_both_muxes_with_their_own_priorities() -> None:
    assert list(parts(drawn("tests/ros2/chained", Path.cwd()), "control")) == [
        "kart/low/mux/output is_controlled_by /kart/low/mux",
        "/kart/low/mux is_controlled_by /kart/high/mux 5",
        "/kart/low/mux is_controlled_by pedals 10 hold 200",
        "/kart/high/mux is_controlled_by planner 20 hold 200",
        "/kart/high/mux is_controlled_by /kart/zero 1 hold 1000",
    ]


def test_classes_are_shown_on_request(tmp_path: Path) -> None:
    block = "@module_start\n@module_name Camera\n@Sense NotifyWhenReady\nImage image();\n"
    text = "@configuration\n@modules Camera, Screen\nScreen uses_data_from Camera\n"
    text += f"{block}@module_end\n"
    (tmp_path / "robot.mars").write_text(text, encoding="utf-8")
    assert list(parts(drawn("robot.mars", tmp_path))) == ["Camera", "Screen"]
    assert "Camera: sensor" in parts(drawn("robot.mars --classes", tmp_path))


def test_modules_without_lines_are_small_and_together(tmp_path: Path) -> None:
    text = RANKED.replace("Camera\n", "Camera, Spare, Lamp\n", 1)
    (tmp_path / "robot.mars").write_text(text, encoding="utf-8")
    root = drawn("robot.mars", tmp_path)
    boxes = {
        str(group[0].text).partition(",")[0]: group[1]
        for group in root.iter(f"{SVG}g")
        if group.get("class", "").startswith("module")
    }
    tops = {name: float(box.get("y", "0")) for name, box in boxes.items()}
    assert tops["Spare"] == tops["Lamp"] > max(tops[name] for name in ("Base", "Zed", "Camera"))
    assert {boxes[name].get("height") for name in ("Spare", "Lamp")} == {"22"}
    assert boxes["Spare"].get("fill") != boxes["Base"].get("fill")
    words = [each.text for each in root.iter(f"{SVG}text")]
    assert "Without lines: nothing is connected to them" in words


def test_a_node_has_the_reason_that_the_catalogue_lacks_it(tmp_path: Path) -> None:
    launch = tmp_path / "robot.launch.xml"
    node = '<node pkg="{0}" exec="{0}" name="{0}"/>'
    names = ("unheard_of", "joy", "teleop_twist_joy")
    launch.write_text(f"<launch>{''.join(map(node.format, names))}</launch>", encoding="utf-8")
    words = [each.text for each in drawn(launch.name, tmp_path).iter(f"{SVG}text")]
    assert words.index("Without lines: not in the catalogue") > words.index("/unheard_of")


@pytest.mark.parametrize("order", ["Zed, Amy, Eve", "Eve, Amy, Zed"])
def test_controllers_are_in_the_order_of_their_priorities(order: str, tmp_path: Path) -> None:
    text = RANKED.replace("Zed, Eve, Amy", order)
    (tmp_path / "robot.mars").write_text(text, encoding="utf-8")
    root = drawn("robot.mars", tmp_path)
    places = {
        str(group[0].text): float(group[1].get("x", "0"))
        for group in root.iter(f"{SVG}g")
        if group.get("class") == "module"
    }
    assert places["Zed"] < places["Amy"] < places["Eve"]


@pytest.mark.parametrize(
    ("written", "words"),
    [
        ("(_,_,_,_,250,_,_)", ["250 mm along x"]),
        ("(y,90,_,_,_,-20,1.5)", ["90° about y", "-20 mm along y, 1.5 mm along z"]),
        ("1 (z,11.4591559,x,45,_,_,_)", ["vertex 0 on 1", "11.46° about z, 45° about x"]),
        ("(_,_,_,_,_,_,_)", []),
    ],
)
def test_a_mount_is_described_in_words(written: str, words: list[str], tmp_path: Path) -> None:
    text = f"@configuration\n@modules Arm, Base\nArm is_mounted_on Base {written}\n"
    (tmp_path / "robot.mars").write_text(text, encoding="utf-8")
    [shown] = parts(drawn("robot.mars", tmp_path), "mount").values()
    assert shown == words


@pytest.mark.skipif(shutil.which("dot") is None, reason="Graphviz is not installed")
def test_dot_lays_out_the_same_parts(tmp_path: Path) -> None:
    (tmp_path / "robot.mars").write_text(RANKED, encoding="utf-8")
    own, other = drawn("robot.mars", tmp_path), drawn("robot.mars --layout dot", tmp_path)
    for name in ("module", "control", "data"):
        assert parts(own, name) == parts(other, name)


def test_without_graphviz_its_layout_is_refused(
    tmp_path: Path, monkeypatch: Patch, capsys: Captured
) -> None:
    robot = tmp_path / "robot.mars"
    robot.write_text(RANKED, encoding="utf-8")
    monkeypatch.setenv("PATH", str(tmp_path))
    assert run_here(["draw", str(robot), "--layout", "dot"]) == 2
    output = capsys.readouterr()
    assert not output.out
    assert "program `dot` is not installed" in " ".join(output.err.split())
    assert run_here(["draw", str(robot), "--layout", "dot", "--as", "mmd"]) == 2
    assert "--layout has no effect on .mmd" in capsys.readouterr().err
