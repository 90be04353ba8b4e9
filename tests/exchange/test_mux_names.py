"""The parameters of a mux in ROS 2 are those that a file has for its name."""

import json
from itertools import permutations
from pathlib import Path

import pytest

from mars_asp.cli import run_here
from mars_asp.exchange.ros2 import import_ros2
from mars_asp.language.print import print_relationship
from tests.support.fixtures import Captured, Patch
from tests.support.packages import write_package

LAUNCH = '<launch><node pkg="twist_mux" exec="twist_mux" name="{}">{}</node></launch>'
PARAMETERS = """{}:
  ros__parameters:
    topics:
      joy: {{topic: joy_vel, timeout: 0.5, priority: 10}}
"""


@pytest.mark.parametrize(
    ("node", "key", "is_mux"),
    [
        ("twist_mux", "twist_mux", True),
        ("twist_mux", "/**", True),
        ("twist_mux", "/*", True),
        ("base_mux", "twist_mux", False),
        ("base_mux", "/base_mux", True),
    ],
)
def test_a_mux_takes_the_parameters_for_its_name(
    node: str, key: str, is_mux: bool, tmp_path: Path
) -> None:
    given = '<param from="$(find-pkg-share mine)/config/mux.yaml"/>'
    files = {
        "launch/mux.launch.xml": LAUNCH.format(node, given),
        "config/mux.yaml": PARAMETERS.format(key),
    }
    write_package(files, tmp_path)
    [tree] = import_ros2([("", str(tmp_path))]).trees
    assert [each.name for each in tree.muxes] == [f"/{node}"] * is_mux


@pytest.mark.parametrize("order", [("inputs", "locks"), ("locks", "inputs")])
def test_a_mux_takes_its_locks_from_a_file_of_their_own(
    order: tuple[str, str], tmp_path: Path
) -> None:
    # The package twist_mux is published with two such files.
    lock = "    locks:\n      pause: {topic: pause, timeout: 0.0, priority: 7}\n"
    given = "".join(f'<param from="$(find-pkg-share mine)/config/{name}.yaml"/>' for name in order)
    files = {
        "launch/mux.launch.xml": LAUNCH.format("twist_mux", given),
        "config/inputs.yaml": PARAMETERS.format("twist_mux"),
        "config/locks.yaml": f"twist_mux:\n  ros__parameters:\n{lock}",
    }
    write_package(files, tmp_path)
    found = import_ros2([("", str(tmp_path))])
    assert [print_relationship(line) for line in found.configuration.relationships] == [
        "cmd_vel_out is_controlled_by joy 10 hold 500",
        "cmd_vel_out is_locked_by pause 7",
    ]
    assert not [each for each in found.warnings if each.kind == "not_read"]


@pytest.mark.parametrize(
    ("key", "path"),
    [("twist_mux", "trial.yaml"), ("/**", "trial.yaml"), ("other_mux", "src/mine/config/mux.yaml")],
)
def test_a_file_of_the_user_has_the_place_of_that_of_the_launch_file(
    key: str, path: str, tmp_path: Path, monkeypatch: Patch
) -> None:
    monkeypatch.chdir(tmp_path)
    given = '<param from="$(find-pkg-share mine)/config/mux.yaml"/>'
    renaming = '<remap from="cmd_vel_out" to="wheels"/>'
    files = {
        "launch/mux.launch.xml": LAUNCH.format("twist_mux", given + renaming),
        "config/mux.yaml": PARAMETERS.format("twist_mux"),
    }
    write_package(files, Path("src/mine"))
    launch = "src/mine/launch/mux.launch.xml"
    trial = PARAMETERS.format(key).replace("10", "20")
    found = import_ros2([(Path(launch).read_text(), launch), (trial, "trial.yaml")])
    lines = found.configuration.relationships
    (driving,) = [each for each in lines if print_relationship(each).startswith("wheels")]
    assert driving.span.path == path
    alone = [each.message for each in found.warnings if "starts this mux" in each.message]
    assert len(alone) == len(lines) - 1 == int(key == "other_mux")


def test_the_order_of_files_changes_nothing(
    tmp_path: Path, monkeypatch: Patch, capsys: Captured
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("m.launch.xml").write_text(LAUNCH.format("twist_mux", ""))
    Path("mux.yaml").write_text(PARAMETERS.format("twist_mux"))
    Path("arm.urdf").write_text('<robot name="r"><link name="base"/></robot>')
    printed = set()
    for files in permutations(("m.launch.xml", "mux.yaml", "arm.urdf")):
        assert run_here(["import", *files]) == 0
        printed.add("".join(sorted(capsys.readouterr().out.replace(",", "").split())))
    assert len(printed) == 1


STOP = """class Stop(Node):
  def __init__(self):
    self.create_publisher({}, '{}', 1)
def main():
  Stop()
"""


@pytest.mark.parametrize(
    ("lock", "sent", "type", "finding"),
    [
        ("estop", "e_stop", "Bool", "loose_end"),
        ("safety/stop", "stop", "Bool", "loose_end"),
        ("e_stop", "e_stop", "Bool", None),
        ("pause", "e_stop", "Bool", None),
        ("e_stop", "e_stop", "Empty", "type_mismatch"),
    ],
)
def test_a_mux_subscribes_to_the_topics_of_its_locks(
    lock: str, sent: str, type: str, finding: str | None, tmp_path: Path, capsys: Captured
) -> None:
    locks = f"    locks:\n      hold: {{topic: {lock}, timeout: 0.0, priority: 7}}\n"
    given = '<param from="$(find-pkg-share mine)/config/mux.yaml"/>'
    node = '<node pkg="mine" exec="stop" name="stop"/></launch>'
    files = {
        "setup.py": "setup(entry_points={'console_scripts': ['stop = mine.stop:main']})\n",
        "mine/stop.py": STOP.format(type, sent),
        "launch/mux.launch.xml": LAUNCH.format("twist_mux", given).replace("</launch>", node),
        "config/mux.yaml": PARAMETERS.format("twist_mux") + locks,
    }
    write_package(files, tmp_path)
    assert run_here(["check", str(tmp_path), "--format", "json"]) == 0
    found = {each["kind"] for each in json.loads(capsys.readouterr().out)["findings"]}
    assert found - {"unheard_input"} == {finding} - {None}


def test_a_wrong_mux_file_of_a_workspace_hides_no_other_finding(
    tmp_path: Path, capsys: Captured
) -> None:
    given = '<param from="$(find-pkg-share mine)/config/mux.yaml"/>'
    twin = '<node pkg="joy" exec="joy_node" name="twist_mux"/></launch>'
    files = {
        "launch/mux.launch.xml": LAUNCH.format("twist_mux", given).replace("</launch>", twin),
        "config/mux.yaml": PARAMETERS.format("twist_mux").replace("priority", "prioirty"),
    }
    write_package(files, tmp_path)
    assert run_here(["check", str(tmp_path), "--format", "json"]) == 0
    found = json.loads(capsys.readouterr().out)["findings"]
    assert {each["kind"] for each in found} == {"broken_file", "duplicate_node"}
    assert "input `joy` has no `priority`" in "".join(each["message"] for each in found)


def test_a_mux_is_at_the_node_that_starts_it_and_its_output_at_the_remapping(
    tmp_path: Path, capsys: Captured
) -> None:
    lines = [
        "<launch>",
        '<node pkg="teleop_twist_keyboard" exec="teleop_twist_keyboard"/>',
        '<node pkg="twist_mux" exec="twist_mux">',
        '<param from="$(find-pkg-share mine)/config/mux.yaml"/>',
        '<remap from="cmd_vel_out" to="cmd_vel"/>',
        "</node>",
        "</launch>",
    ]
    files = {
        "launch/mux.launch.xml": "\n".join(lines),
        "config/mux.yaml": PARAMETERS.format("twist_mux"),
    }
    write_package(files, tmp_path)
    assert run_here(["explain", str(tmp_path), "ambiguous_priority", "--depth", "all", "-q"]) == 0
    shown = " ".join(capsys.readouterr().out.split())
    file = f"{tmp_path}/launch/mux.launch.xml"
    assert f"{lines[4]} it is a mux, which publishes `/cmd_vel`" in shown
    assert f"{file}:3 {lines[2]} `{file}` starts `/twist_mux`" in shown
