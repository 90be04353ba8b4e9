"""Keys that parameter files have twice: merged by ROS 2, or lost where a file is read as YAML."""

from pathlib import Path

import pytest

from mars_asp.exchange.ros2 import import_ros2
from mars_asp.exchange.yaml_document import Pairs, Repeat, read_yaml
from mars_asp.model.graph import RepeatedKey
from tests.support.packages import write_package

LAUNCH = """
from launch import LaunchDescription
from launch_ros.actions import Node
from launch.substitutions import LaunchConfiguration
from nav2_common.launch import RewrittenYaml
from ament_index_python.packages import get_package_share_directory

def generate_launch_description():
    given = get_package_share_directory('mine') + '/config/arm.yaml'
    return LaunchDescription([
        Node(package='some', executable='thing', name='arm', parameters=[{parameters}])])
"""
SECTIONS = """{}:
  ros__parameters:
    rate: 10
    joints: {{a: 1}}
{}:
  ros__parameters:
    rate: {}
    joints: {{b: 2}}
"""


@pytest.mark.parametrize(
    ("parameters", "second", "rate", "found"),
    [
        # The parser of ROS 2 makes one map of two: only a value that differs is lost.
        ("given", "hand", 20, []),
        ("given", "arm", 10, [("arm", "merged")]),
        ("given", "arm", 20, [("arm", "merged"), ("rate", "within")]),
    ],
)
@pytest.mark.parametrize("is_rewritten", [False, True])
def test_maps_of_one_node_are_merged(
    parameters: str,
    second: str,
    rate: int,
    found: list[tuple[str, str]],
    is_rewritten: bool,
    tmp_path: Path,
) -> None:
    if is_rewritten:
        parameters = f"RewrittenYaml(source_file={parameters}, param_rewrites={{}})"
    files = {
        "launch/arm.launch.py": LAUNCH.format(parameters=parameters),
        "config/arm.yaml": SECTIONS.format("arm", second, rate),
    }
    write_package(files, tmp_path)
    [tree] = import_ros2([("", str(tmp_path))]).trees
    assert [(each.name, sort_of(each)) for each in tree.repeated] == found
    assert [Path(file).name for file in tree.rewritten] == ["arm.yaml"] * is_rewritten


def test_a_file_of_ros_1_is_read_as_yaml(tmp_path: Path) -> None:
    launch = '<launch><rosparam file="$(find mine)/config/arm.yaml"/>{}</launch>'
    files = {
        "launch/arm.launch": launch.format('<node pkg="some" type="thing" name="arm"/>'),
        "config/arm.yaml": "arm: {a: 1}\narm: {b: 2}\n",
    }
    write_package(files, tmp_path)
    [tree] = import_ros2([("", str(tmp_path))]).trees
    assert [(each.name, sort_of(each)) for each in tree.repeated] == [("arm", "lost")]


def sort_of(key: RepeatedKey) -> str:
    return "merged" if key.is_merged else "within" if key.within else "lost"


def test_thousands_of_maps_of_one_node_are_joined_once() -> None:
    count = 5000
    text = "".join(f"arm: {{a{at}: 1, same: {at}}}\n" for at in range(count))
    repeated: list[Repeat] = []
    root = read_yaml(text, "arm.yaml", repeated=repeated, merges=True)
    assert isinstance(root, Pairs)
    [(_, arm)] = root.pairs
    assert isinstance(arm, Pairs)
    assert len(arm.pairs) == count + 1
    assert sum(each.within for each in repeated) == count - 1


@pytest.mark.parametrize(
    ("first", "second", "count"),
    [
        ("False", "false", 0),
        ("False", "'false'", 1),
        ("false", "true", 1),
        ("1", "1.0", 1),
        ("[a, {b: True}]", "[a, {b: true}]", 0),
        ("[a, b]", "[a]", 1),
        ("{a: 1}", "{a: 2}", 1),
    ],
)
def test_a_key_with_the_same_value_again_loses_nothing(first: str, second: str, count: int) -> None:
    repeated: list[Repeat] = []
    read_yaml(f"a: {first}\na: {second}\n", "arm.yaml", repeated=repeated)
    assert len(repeated) == count
