"""Topics that the costmaps and monitors of Nav2 take from their parameter files."""

from pathlib import Path

import pytest

from mars_asp.cli import run_here
from mars_asp.exchange.ros2 import import_ros2
from tests.support.fixtures import Captured
from tests.support.packages import write_package

MANIFEST = (
    "<package><name>mine</name><export><build_type>ament_cmake</build_type></export></package>"
)
COSTMAP = """\
local_costmap:
  local_costmap:
    ros__parameters:
      plugins: [obstacles, static, sonar]
      obstacles:
        plugin: nav2_costmap_2d::ObstacleLayer
        observation_sources: front rear cloud
        front: {topic: /scan, data_type: LaserScan}
        cloud: {topic: depth/points, data_type: PointCloud2}
      static: {plugin: "nav2_costmap_2d::StaticLayer"}
      sonar: {plugin: "nav2_costmap_2d::RangeSensorLayer", topics: [/left, right]}
      old: {observation_sources: gone}
"""
MONITOR = """\
/**:
  ros__parameters:
    observation_sources: [front, side]
    front: {type: scan, topic: scan}
    side: {type: range, topic: /side}
"""
SERVER = '<node pkg="nav2_controller" exec="controller_server" namespace="{}">{}</node>'
FILE = '<param from="$(find-pkg-share mine)/config/p.yaml"/>'


def heard(node: str, parameters: str, folder: Path) -> dict[str, str | None]:
    files = {
        "package.xml": MANIFEST,
        "config/p.yaml": parameters,
        "launch/a.launch.xml": f"<launch>{node}</launch>",
    }
    write_package(files, folder)
    [tree] = import_ros2([("", str(folder))]).trees
    [found] = tree.nodes
    return {end.topic: end.type for end in found.subscribed if not end.optional}


@pytest.mark.parametrize("namespace", ["", "robot"])
def test_the_layers_of_a_costmap_hear_their_sources(namespace: str, tmp_path: Path) -> None:
    place = f"/{namespace}" if namespace else ""
    assert heard(SERVER.format(namespace, FILE), COSTMAP, tmp_path) == {
        f"{place}/odom": "nav_msgs/msg/Odometry",
        "/scan": "sensor_msgs/msg/LaserScan",
        f"{place}/rear": "sensor_msgs/msg/LaserScan",
        f"{place}/depth/points": "sensor_msgs/msg/PointCloud2",
        f"{place}/map": "nav_msgs/msg/OccupancyGrid",
        "/left": "sensor_msgs/msg/Range",
        f"{place}/right": "sensor_msgs/msg/Range",
    }


def test_a_monitor_hears_its_own_sources(tmp_path: Path) -> None:
    node = f'<node pkg="nav2_collision_monitor" exec="collision_detector">{FILE}</node>'
    expected = {"/scan": "sensor_msgs/msg/LaserScan", "/side": "sensor_msgs/msg/Range"}
    assert heard(node, MONITOR, tmp_path) == expected


NODE = """\
from rclpy.node import Node
from sensor_msgs.msg import LaserScan


class Watch(Node):
    def __init__(self):
        super().__init__("watch")
        self.create_subscription(LaserScan, "scan_rear", print, 1)
"""
INCLUDED = '<include file="$(find-pkg-share nav2_bringup)/launch/navigation_launch.py"/>'
LIDAR = '<node pkg="rplidar_ros" exec="rplidar_composition" name="lidar"/>'


@pytest.mark.parametrize(
    ("server", "found"),
    [("", ["loose_end"]), (SERVER.format("", FILE), []), (INCLUDED, [])],
    ids=["without", "with-its-file", "with-the-usual-file"],
)
def test_a_topic_that_only_a_costmap_hears_has_a_subscriber(
    server: str, found: list[str], tmp_path: Path, capsys: Captured
) -> None:
    watch = '<node pkg="mine" exec="watch.py" name="watch"/>'
    files = {
        "package.xml": MANIFEST,
        "CMakeLists.txt": "install(PROGRAMS scripts/watch.py DESTINATION lib/mine)\n"
        "install(DIRECTORY launch config DESTINATION share/mine)\n",
        "scripts/watch.py": f"#!/usr/bin/env python3\n{NODE}",
        "config/p.yaml": COSTMAP,
        "launch/a.launch.xml": f"<launch>{LIDAR}{watch}{server}</launch>",
    }
    write_package(files, tmp_path)
    assert run_here(["check", str(tmp_path), "-q", "--select", "loose_end"]) == 0
    out = capsys.readouterr().out
    assert [line.rpartition("[")[2].rstrip("]") for line in out.splitlines()] == found
