"""Launch files of packages elsewhere, as the catalogue or a folder of the workspace states them."""

from pathlib import Path

import pytest

from mars_asp.exchange.ros2 import import_ros2
from mars_asp.exchange.ros2.launch_markup import read_markup
from mars_asp.model.graph import LaunchTree
from tests.support.documents import ROOT

CATALOGUE = ROOT / "mars_asp" / "exchange" / "ros2" / "launch_catalogue"


def tree(folder: Path, *lines: str) -> LaunchTree:
    """Return the launch tree of lines of a launch file."""
    file = folder / "robot.launch.xml"
    text = "<launch>\n" + "\n".join(lines) + "\n</launch>\n"
    file.write_text(text)
    [found] = import_ros2([(text, str(file))]).trees
    return found


@pytest.mark.parametrize("file", sorted(CATALOGUE.rglob("*.yaml")), ids=lambda file: file.name)
def test_each_file_can_be_read_and_names_its_source(file: Path) -> None:
    text = file.read_text(encoding="utf-8")
    assert text.startswith("# Source: ")
    assert read_markup(text, file.name)


def test_an_included_navigation_is_at_the_line_that_includes_it(tmp_path: Path) -> None:
    (tmp_path / "nav.yaml").write_text(
        "controller_server:\n  ros__parameters:\n    odom_topic: /base/odom\n"
    )
    found = tree(
        tmp_path,
        '<include file="$(find-pkg-share nav2_bringup)/launch/bringup_launch.py">',
        '  <arg name="params_file" value="nav.yaml"/>',
        '  <arg name="namespace" value="robot"/>',
        "</include>",
    )
    nodes = {node.name: node for node in found.nodes}
    assert {"/robot/controller_server", "/robot/amcl", "/robot/slam_toolbox"} <= nodes.keys()
    assert {(node.span.path.rpartition("/")[2], node.span.line) for node in found.nodes} == {
        ("robot.launch.xml", 2)
    }
    controller = nodes["/robot/controller_server"]
    assert controller.published[0].topic == "/robot/cmd_vel_nav"
    assert "/base/odom" in [end.topic for end in controller.subscribed]
    assert not found.unread
    # Without a choice of the user the map is not made anew.
    [test] = nodes["/robot/slam_toolbox"].conditions
    assert (test.variable, test.value, test.wanted) == ("slam", "true", True)
    assert dict(found.defaults)["slam"] == "False"


@pytest.mark.parametrize(("value", "is_known"), [("nav.yaml", True), ("$(eval a)", False)])
def test_an_unknown_file_of_parameters_is_not_the_default(
    value: str, is_known: bool, tmp_path: Path
) -> None:
    (tmp_path / "nav.yaml").write_text("a: {ros__parameters: {odom_topic: base}}\n")
    (tmp_path / "inner.launch.xml").write_text(
        '<launch><arg name="file" default="nav.yaml"/><node pkg="nav2_controller" name="a" '
        'exec="controller_server"><param from="$(var file)"/></node></launch>'
    )
    passed = f'<arg name="file" value="{value}"/>'
    [node] = tree(tmp_path, f'<include file="inner.launch.xml">{passed}</include>').nodes
    assert ("/base" in [end.topic for end in node.subscribed]) == is_known
    assert node.unread != is_known


def test_a_file_of_the_workspace_wins(tmp_path: Path) -> None:
    own = tmp_path / "mars-launch" / "nav2_bringup" / "launch"
    own.mkdir(parents=True)
    (own / "navigation_launch.py.yaml").write_text(
        "launch:\n- node: {pkg: mine, exec: navigator, name: navigator}\n"
    )
    include = '<include file="$(find-pkg-share nav2_bringup)/launch/navigation_launch.py"/>'
    assert [node.name for node in tree(tmp_path, include).nodes] == ["/navigator"]


def test_a_mux_of_another_package_has_the_inputs_of_the_user(tmp_path: Path) -> None:
    (tmp_path / "mux.yaml").write_text(
        "twist_mux:\n  ros__parameters:\n    topics:\n"
        "      joy: {topic: joy_vel, timeout: 0.5, priority: 10}\n"
    )
    found = tree(
        tmp_path,
        '<include file="$(find-pkg-share twist_mux)/launch/twist_mux_launch.py">',
        '  <arg name="config_topics" value="mux.yaml"/>',
        '  <arg name="cmd_vel_out" value="/drive"/>',
        "</include>",
    )
    [mux] = found.muxes
    assert (mux.output, [each.topic for each in mux.inputs]) == ("/drive", ["/joy_vel"])


def test_an_unknown_launch_file_leaves_the_tree_open(tmp_path: Path) -> None:
    found = tree(tmp_path, '<include file="$(find-pkg-share other)/launch/x.launch.py"/>')
    assert found.unread
