"""Topics with parameters in their names, and nodes that a user may start beside a launch tree."""

from pathlib import Path

import pytest

from mars_asp.cli import run_here
from mars_asp.exchange.ros2 import import_ros2
from tests.support.fixtures import Captured
from tests.support.packages import write_package

SETUP = "setup(entry_points={'console_scripts': ['hand = mine.hand:main']})\n"
HAND = (
    "class Hand(Node):\n"
    "  def __init__(self):\n"
    "    self.declare_parameter('side', 'left')\n"
    "    self.declare_parameter('number', 1)\n"
    "    self.side = self.get_parameter('side').value\n"
    "    self.number = self.get_parameter('number').value\n"
    "    self.create_publisher(JointState, {}, 1)\n"
    "def main():\n  Hand()\n"
)


@pytest.mark.parametrize(
    ("name", "given", "topic"),
    [
        ("f'/{self.side}/state'", "", "/left/state"),
        ("f'/{self.side}/state'", '<param name="side" value="right"/>', "/right/state"),
        ("'/' + self.side + '/state'", '<param name="side" value="right"/>', "/right/state"),
        ("'/%s/state' % self.side", '<param name="side" value="right"/>', "/right/state"),
        ("'/{}/state'.format(self.side)", '<param name="side" value="right"/>', "/right/state"),
        ("f'/{self.side}_{self.number}'", '<param name="number" value="2"/>', "/left_2"),
        ("f'/{self.side}_{self.number}'", "", "/left_1"),
        ("self.side", '<param name="side" value="right"/>', "/right"),
        ("f'/{self.side}/state'", '<param name="side" value="$(command date)"/>', None),
    ],
)
def test_parameters_within_a_name_are_those_that_are_given(
    name: str, given: str, topic: str | None, tmp_path: Path
) -> None:
    node = f'<launch><node pkg="mine" exec="hand" name="hand">{given}</node></launch>'
    written = {"setup.py": SETUP, "mine/hand.py": HAND.format(name), "launch/x.launch.xml": node}
    write_package(written, tmp_path)
    [tree] = import_ros2([("", str(tmp_path))]).trees
    published = [end.topic for node in tree.nodes for end in node.published]
    assert published == ([] if topic is None else [topic])


def loose(written: dict[str, str], folder: Path, capsys: Captured) -> int:
    """Return how many findings there are of topics that nothing publishes."""
    write_package(written, folder)
    run_here(["check", str(folder)])
    return capsys.readouterr().out.count("[loose_end]")


FILTER = (
    "class N(Node):\n  def __init__(self):\n"
    "    self.create_subscription(LaserScan, '/camera/scan', f, 1)\n"
    "    self.create_publisher(LaserScan, '/{}/scan', 1)\nN()\n"
)
RENAMED = '<remap from="/out/scan" to="/$(var side)/scan"/>'


def test_an_included_launch_file_may_be_launched_by_itself(
    tmp_path: Path, capsys: Captured
) -> None:
    heard = FILTER.replace("    self.create_publisher(LaserScan, '/{}/scan', 1)\n", "")
    sent = FILTER.replace("    self.create_subscription(LaserScan, '/camera/scan', f, 1)\n", "")
    include = '<include file="$(find-pkg-share mine)/launch/lidar.launch.xml">{}</include>'
    given = include.format('<arg name="side" value="front/camera"/>')
    written = {
        "scripts/hear.py": heard,
        "scripts/send.py": sent.format("out"),
        "launch/a.launch.xml": '<launch><node pkg="mine" exec="hear.py" name="h"/></launch>',
        "launch/b.launch.xml": f"<launch>{given}</launch>",
        "launch/lidar.launch.xml": '<launch><arg name="side" default="back"/>'
        f'<node pkg="mine" exec="send.py" name="s">{RENAMED}</node></launch>',
    }
    assert loose(written, tmp_path, capsys) == 1
    lidar = written["launch/lidar.launch.xml"].replace("back", "camera")
    assert loose({**written, "launch/lidar.launch.xml": lidar}, tmp_path, capsys) == 0


def test_a_given_argument_with_a_condition_is_that_of_the_defaults(tmp_path: Path) -> None:
    include = (
        '<launch><arg name="fake" default="false"/>'
        '<include file="$(find mine)/launch/inner.launch">'
        '<arg name="sort" value="real" unless="$(arg fake)"/>'
        '<arg name="sort" value="absent" if="$(arg fake)"/></include></launch>'
    )
    inner = (
        '<launch><arg name="sort"/><include file="$(find mine)/launch/$(arg sort).xml"/></launch>'
    )
    joy = '<launch><node pkg="joy" type="joy_node" name="joy"/></launch>'
    written = {
        "launch/outer.launch": include,
        "launch/inner.launch": inner,
        "launch/real.xml": joy,
    }
    write_package(written, tmp_path)
    [tree] = import_ros2([("", str(tmp_path))]).trees
    assert [node.name for node in tree.nodes] == ["/joy"]
    assert tree.missing == ()


def test_the_action_of_a_bridge_is_the_bridge(tmp_path: Path) -> None:
    launch = (
        "def generate_launch_description():\n"
        "  share = get_package_share_directory('mine')\n"
        "  return LaunchDescription([RosGzBridge(bridge_name='gz',\n"
        "    config_file=os.path.join(share, 'config', 'bridge.yaml'))])\n"
    )
    bridge = (
        "- ros_topic_name: /joint_states\n  gz_topic_name: /j\n  direction: GZ_TO_ROS\n"
        "  ros_type_name: sensor_msgs/msg/JointState\n  gz_type_name: gz.msgs.Model\n"
    )
    write_package({"launch/x.launch.py": launch, "config/bridge.yaml": bridge}, tmp_path)
    [tree] = import_ros2([("", str(tmp_path))]).trees
    [node] = tree.nodes
    assert (node.name, [end.topic for end in node.published]) == ("/gz", ["/joint_states"])


def test_a_result_in_a_folder_that_is_not_there_is_not_missing(tmp_path: Path) -> None:
    node = '<launch><node pkg="x" type="y" name="z" args="$(find mine)/{}"/></launch>'
    write_package({"launch/x.launch": node.format("results/path.txt")}, tmp_path)
    assert [tree.missing for tree in import_ros2([("", str(tmp_path))]).trees] == [()]
    write_package({"launch/x.launch": node.format("launch/path.txt")}, tmp_path)
    [tree] = import_ros2([("", str(tmp_path))]).trees
    assert [each.name for each in tree.missing] == ["launch/path.txt"]
