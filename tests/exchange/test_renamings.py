"""Renamings of launch files: which names a node has for them to change."""

import json
from pathlib import Path

import pytest

from mars_asp.cli import run_here
from tests.support.fixtures import Captured
from tests.support.packages import write_package

SETUP = "setup(entry_points={'console_scripts': ['e = mine.node:main']})"
NODE = "class N:\n  def __init__(self):\n    {does}\ndef main():\n  N()\n"


def dead_renamings(written: dict[str, str], folder: Path, capsys: Captured) -> list[str]:
    """Return the messages on dead renamings in a folder with these files."""
    write_package(written, folder)
    run_here(["check", "--format", "json", str(folder)])
    findings = json.loads(capsys.readouterr().out)["findings"]
    return [each["message"] for each in findings if each["kind"] == "dead_remap"]


#: A statement of a node in Python, a name that is renamed, and whether the renaming is dead.
PYTHON = [
    ("rospy.Publisher('~a', A)", "~a", False),
    ("rospy.Publisher('~a', A)", "~b", True),
    ("rospy.set_param('~a', 1)", "~a", False),
    ("x = rospy.get_param('~a')", "~a", False),
    ("x = rospy.has_param('a')", "a", False),
    ("x = rospy.get_param('~a')", "a", True),
    ("rospy.Service('~a', A, f)", "~a", False),
    ("rospy.Service('~a', A, f)", "~b", True),
    ("rospy.ServiceProxy(name='a', service_class=A)", "a", False),
    ("rospy.Service(other(), A, f)", "~b", False),
    ("actionlib.SimpleActionServer('a', A)", "a/goal", False),
    ("actionlib.SimpleActionServer('a', A)", "a/other", True),
    ("[rospy.Service(n, A, f) for n in ('a', 'b')]", "b", False),
    ("self.create_service(A, 'a', f)", "a", False),
    ("self.create_client(A, srv_name='a')", "b", True),
    ("ActionClient(self, A, 'a')", "a", False),
    ("self.create_client(A, other())", "b", False),
]


@pytest.mark.parametrize(("does", "name", "is_dead"), PYTHON)
def test_services_and_parameters_of_python_are_renamed(
    does: str, name: str, is_dead: bool, tmp_path: Path, capsys: Captured
) -> None:
    launch = f'<node pkg="mine" type="e" name="e"><remap from="{name}" to="/to"/></node>'
    written = {
        "setup.py": SETUP,
        "mine/node.py": NODE.format(does=does),
        "launch/x.launch": f"<launch>{launch}</launch>",
    }
    assert bool(dead_renamings(written, tmp_path, capsys)) == is_dead


#: The same in C++.
CPP = [
    ('ros::NodeHandle h("~"); h.getParam("a", x);', "~a", False),
    ('ros::NodeHandle h("~"); h.setParam("a", 1);', "a", True),
    ('ros::NodeHandle h; h.param<int>("a", x, 1);', "a", False),
    ('ros::NodeHandle h("~"); s = h.advertiseService("a", f);', "~a", False),
    ('ros::NodeHandle h; s = h.serviceClient<A>("a");', "b", True),
    ("ros::NodeHandle h; s = h.serviceClient<A>(name);", "b", False),
    ('actionlib::SimpleActionServer<A> server(h, "a", f, false);', "a/result", False),
    ('actionlib::SimpleActionClient<A> client("a", true);', "a/goal", False),
    ('s = node->create_service<A>("a", f);', "a", False),
    ('s = rclcpp_action::create_server<A>(node, "a", f);', "a", False),
    ('s = rclcpp_action::create_client<A>(node, "a");', "b", True),
    ('costmap_2d::Costmap2DROS costmap("costmap", tf);', "map", False),
    ("ros::NodeHandle h; other::Planner p(h);", "a", False),
    ("ros::NodeHandle h; p->initialize(&h, 1);", "a", False),
    ("ros::NodeHandle h; tf::TransformListener p(h);", "a", True),
    ("ros::NodeHandle h; image_transport::ImageTransport it(h);", "a", True),
]


@pytest.mark.parametrize(("does", "name", "is_dead"), CPP)
def test_services_and_parameters_of_cpp_are_renamed(
    does: str, name: str, is_dead: bool, tmp_path: Path, capsys: Captured
) -> None:
    launch = f'<node pkg="mine" type="e" name="e"><remap from="{name}" to="/to"/></node>'
    written = {
        "CMakeLists.txt": "add_executable(e src/e.cpp)",
        "src/e.cpp": f"int main() {{ {does} }}",
        "launch/x.launch": f"<launch>{launch}</launch>",
    }
    assert bool(dead_renamings(written, tmp_path, capsys)) == is_dead
