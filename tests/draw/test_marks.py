"""Findings in pictures: their class and number, at the boxes and lines that they are about."""

import json
import re
from pathlib import Path
from xml.etree.ElementTree import Element, fromstring

import pytest

from tests.support.documents import ROOT, run

SVG = "{http://www.w3.org/2000/svg}"
#: Two controllers of one priority, and a module that takes part in nothing.
TIE = """\
@configuration hierarchical
@modules Base, Joystick, Planner, Spare, Camera
Base is_controlled_by Joystick 2
Base is_controlled_by Planner 2
Planner uses_data_from Camera
"""
#: A cycle of mounts, which is an error, and a tie.
CYCLE = """\
@configuration hierarchical
@modules Base, Arm, Joystick, Planner
Arm is_mounted_on Base
Base is_mounted_on Arm
Base is_controlled_by Joystick 2
Base is_controlled_by Planner 2
"""
CLEAN = """\
@configuration hierarchical
@modules Base, Joystick, Planner
Base is_controlled_by Joystick 2
Base is_controlled_by Planner 1
"""


def picture(text: str, folder: Path, words: str = "") -> Element:
    """Return the picture that `draw` writes of a configuration."""
    (folder / "robot.mars").write_text(text, encoding="utf-8")
    return fromstring(run(f"mars-asp draw robot.mars --quiet {words}", folder))


def marks(root: Element) -> dict[str, tuple[str, str]]:
    """Return the classes and numbers of findings by the titles of their boxes and lines."""
    return {
        str(group[0].text).partition(",")[0]: (group.get("class", ""), group.attrib["data-finding"])
        for group in root.iter(f"{SVG}g")
        if "data-finding" in group.attrib
    }


def legend(root: Element) -> list[str]:
    group = next(each for each in root.iter(f"{SVG}g") if each.get("class") == "legend")
    return [str(each.text) for each in group.iter(f"{SVG}text")]


def test_boxes_and_lines_of_a_finding_have_its_class_and_number(tmp_path: Path) -> None:
    root = picture(TIE, tmp_path)
    assert marks(root) == {
        "Spare": ("module finding warning", "1"),
        "Base": ("module finding warning", "2"),
        "Joystick": ("module finding warning", "2"),
        "Planner": ("module finding warning", "2"),
        "Base is_controlled_by Joystick 2": ("control finding warning", "2"),
        "Base is_controlled_by Planner 2": ("control finding warning", "2"),
    }
    marked = [each for each in root.iter(f"{SVG}g") if "data-finding" in each.attrib]
    for group in marked:
        assert group.attrib["data-finding"] in [each.text for each in group.iter(f"{SVG}text")]
    shown = legend(root)
    first, second = shown.index("1"), shown.index("2")
    assert shown[first + 1] == "warning: `Spare` takes part in no relationship [unused_module]"
    assert shown[second + 1].startswith("warning: `Joystick` and `Planner` control `Base`")


def test_errors_are_numbered_first_and_a_box_has_its_gravest_class(tmp_path: Path) -> None:
    found = marks(picture(CYCLE, tmp_path))
    assert found["Base"] == ("module finding error", "1 2")
    assert found["Arm is_mounted_on Base"] == ("mount finding error", "1")
    assert found["Joystick"] == ("module finding warning", "2")


def test_errors_and_warnings_differ_without_colours(tmp_path: Path) -> None:
    def badge(title: str, root: Element) -> str | None:
        group = next(
            each
            for each in root.iter(f"{SVG}g")
            if len(each) and each[0].text == title and "data-finding" in each.attrib
        )
        return list(group.iter(f"{SVG}rect"))[-1].get("rx")

    root = picture(CYCLE, tmp_path)
    assert badge("Arm", root) != badge("Joystick", root)


@pytest.mark.parametrize("words", ["", "--about Base --depth 2", "--as mmd", "--as dot"])
def test_a_clean_robot_has_no_mark(words: str, tmp_path: Path) -> None:
    (tmp_path / "robot.mars").write_text(CLEAN, encoding="utf-8")
    drawn = run(f"mars-asp draw robot.mars --quiet {words}", tmp_path)
    assert not re.search('finding|warning|error|stroke-width[=:]"?3', drawn)


def test_a_finding_that_is_not_reported_has_no_mark(tmp_path: Path) -> None:
    found = marks(picture(TIE, tmp_path, "--ignore unused_module"))
    assert "Spare" not in found
    assert found["Base"][1] == "1"
    commented = TIE.replace("Spare, Camera", "Spare, Camera // mars: ignore[unused_module] later")
    assert "Spare" not in marks(picture(commented, tmp_path))


def test_a_finding_about_a_port_marks_its_module(tmp_path: Path) -> None:
    block = "@module_start\n@module_name Camera\n@Sense NotifyWhenReady\nImage image();\n"
    block += "@Sense NotifyWhenReady\nDepth depth();\n@module_end\n"
    text = f"@configuration\n@modules Camera, Screen\nScreen uses_data_from Camera\n{block}"
    found = marks(picture(text, tmp_path))
    assert found["Camera"][0].startswith("module finding")
    assert found["Screen uses_data_from Camera"][0].startswith("data finding")


def test_a_part_has_the_numbers_of_the_whole(tmp_path: Path) -> None:
    root = picture(TIE, tmp_path, "--about Joystick")
    assert {number for _, number in marks(root).values()} == {"2"}
    assert "1" not in legend(root)


def test_other_formats_have_the_numbers(tmp_path: Path) -> None:
    (tmp_path / "robot.mars").write_text(TIE, encoding="utf-8")
    mermaid = run("mars-asp draw robot.mars --quiet --as mmd", tmp_path)
    assert '["Base<br/>warning 2"]' in mermaid
    assert '|"priority 2<br/>warning 2"|' in mermaid
    assert "%% 1 warning: Spare takes part in no relationship [unused_module]" in mermaid
    dot = run("mars-asp draw robot.mars --quiet --as dot", tmp_path)
    assert r'label="Base\nwarning 2"' in dot


def test_marks_are_the_findings_of_check() -> None:
    place = "examples/ros2_workspace"
    known = json.loads(run(f"mars-asp check {place} --format json --quiet").partition("\n")[0])
    shown = " ".join(legend(fromstring(run(f"mars-asp draw {place} --quiet"))))
    for finding in known["findings"]:
        assert f"{finding['severity']}: {finding['message']} [{finding['kind']}]" in shown


def test_findings_in_launch_files_mark_nodes_and_topics() -> None:
    found = marks(fromstring(run(f"mars-asp draw {ROOT}/examples/ros2_workspace --quiet")))
    assert found["/dock"] == ("module finding warning", "1")
    assert found["/base_driver is_controlled_by /dock"] == ("control finding warning", "1")
    assert found["/patrol"] == ("module finding warning", "2 3")
    assert "/twist_mux" not in found


def test_a_box_shows_few_numbers_and_has_all(tmp_path: Path) -> None:
    names = [f"P{number}" for number in range(14)]
    ties = "".join(f"Base is_controlled_by {name} {at // 2}\n" for at, name in enumerate(names))
    text = f"@configuration hierarchical\n@modules Base, {', '.join(names)}\n{ties}"
    root = picture(text, tmp_path)
    assert marks(root)["Base"][1] == "1 2 3 4 5 6 7"
    assert "1, 2, 3, 4, 5, …" in [each.text for each in root.iter(f"{SVG}text")]


def test_the_specification_on_the_page_marks_the_lines_of_controllers(tmp_path: Path) -> None:
    (tmp_path / "robot.mars").write_text(TIE, encoding="utf-8")
    page = run("mars-asp explain robot.mars --quiet -o -", tmp_path)
    found = marks(fromstring(page[page.index("<svg") : page.index("</svg>") + 6]))
    assert "ArbitrationNode is_controlled_by Joystick 2" in found
    assert "ArbitrationNode is_controlled_by Planner 2" in found
    assert "Base is_controlled_by ArbitrationNode" not in found
