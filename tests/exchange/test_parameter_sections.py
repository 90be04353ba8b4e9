"""Parameter files of ROS 2 without a section for the node that is given them."""

from pathlib import Path

import pytest

from mars_asp.cli import run_here
from mars_asp.exchange.ros2 import import_ros2
from tests.support.fixtures import Captured
from tests.support.packages import write_package

FILE = "$(find-pkg-share mine)/config/p.yaml"
NODE = '<node pkg="x" exec="lidar_node" name="lidar"{}><param from="' + FILE + '"/></node>'
OTHER = '<node pkg="x" exec="lidar_node" name="other"><param from="' + FILE + '"/></node>'
UNNAMED = '<node pkg="x" exec="lidar_node"><param from="' + FILE + '"/></node>'
SECTION = "{}:\n  ros__parameters:\n    rate: 10\n"


def findings(nodes: str, file: str, folder: Path, capsys: Captured) -> int:
    """Return how many findings there are of files without a section for a node."""
    launch = f"<launch>{nodes}</launch>"
    write_package({"launch/x.launch.xml": launch, "config/p.yaml": file}, folder)
    run_here(["check", str(folder)])
    return capsys.readouterr().out.count("[unused_parameters]")


@pytest.mark.parametrize(
    ("nodes", "section", "found"),
    [
        (NODE.format(""), "lidar", 0),
        (NODE.format(""), "lidar_node", 1),
        (NODE.format(""), "/**", 0),
        (NODE.format(""), "/*", 0),
        (NODE.format(' namespace="left"'), "lidar", 1),
        (NODE.format(' namespace="left"'), "/left/lidar", 0),
        (NODE.format(' namespace="left"'), "/**/lidar", 0),
        (NODE.format("") + OTHER, "other", 0),
        (NODE.format("") + UNNAMED, "lidar_node", 0),
    ],
)
def test_a_file_has_a_section_for_its_node(
    nodes: str, section: str, found: int, tmp_path: Path, capsys: Captured
) -> None:
    assert findings(nodes, SECTION.format(section), tmp_path, capsys) == found


def test_files_of_ros1_have_no_sections(tmp_path: Path, capsys: Captured) -> None:
    assert findings(NODE.format(""), "rate: 10\n", tmp_path, capsys) == 0


SETUP = (
    "from setuptools import setup\n"
    "setup(entry_points={{'console_scripts': [\n  'n = {}:main',\n]}})\n"
)


@pytest.mark.parametrize(
    ("module", "absent"),
    [
        ("mine.node", []),
        ("mine.inner", []),
        ("mine.nodes", [("mine/nodes.py", 3)]),
        ("mine.inner.x", [("mine/inner/x.py", 3)]),
        ("elsewhere.node", []),
        ("/etc.absent", []),
        ("...", []),
    ],
)
def test_modules_of_console_scripts_are_there(
    module: str, absent: list[tuple[str, int]], tmp_path: Path
) -> None:
    files = {
        "setup.py": SETUP.format(module),
        "mine/node.py": "def main(): ...",
        "mine/inner/__init__.py": "from mine.node import main",
        "launch/x.launch.xml": '<launch><node pkg="joy" exec="joy_node"/></launch>',
    }
    write_package(files, tmp_path)
    [tree] = import_ros2([("", str(tmp_path))]).trees
    assert [(each.name, each.span.line) for each in tree.missing] == absent
