"""Branches, loops and functions of launch files in Python: the nodes started on each path."""

from pathlib import Path

import pytest

from mars_asp.exchange.ros2.read import import_ros2
from mars_asp.exchange.ros2.source_cpp import read_cpp
from mars_asp.language import Parsed
from mars_asp.model.declarations import Control, Data

START = """
import os
from launch import LaunchDescription
from launch_ros.actions import Node

def eye(name, **more):
    return Node(package="v4l2_camera", executable="v4l2_camera_node", name=name, **more)

"""
ENTRY = "def generate_launch_description():\n"


def launched(body: str) -> Parsed:
    lines = "".join(f"    {line}\n" for line in body.strip().splitlines())
    return import_ros2([(START + ENTRY + lines, "robot.launch.py")])


def nodes(found: Parsed) -> list[str]:
    return [name.text for name in found.configuration.modules]


def notes_of(found: Parsed) -> list[str]:
    return [note.message for note in found.warnings]


#: The body of the description, the nodes of all its branches, and how many depend on conditions.
BODIES = [
    # Entries of a dictionary are replaced, chosen by their keys, and taken out.
    (
        "x = {'a': 'one', 'b': 'two', 'c': 'three'}\nkept = ('a', 'b')\n"
        "y = {k: v for k, v in x.items() if k in kept}\ny['b'] = 'new'\n"
        "if 'a' in y:\n    y['d'] = y.pop('a')\nif 'c' in y:\n    y['c'] = 'x'\n"
        "y.update({'e': 'five'})\n"
        "return LaunchDescription([eye(k + v) for k, v in y.items()])",
        ["/bnew", "/done", "/efive"],
        0,
    ),
    # A value before the condition is one of those that it may have.
    (
        "x = 'a'\nif os.environ.get('B'):\n    x = 'b'\nreturn LaunchDescription([eye(x)])",
        ["/b", "/a"],
        2,
    ),
    (
        "x = [eye('a')]\nif os.environ.get('B'):\n    x = [eye('b')]\nreturn LaunchDescription(x)",
        ["/b", "/a"],
        2,
    ),
    # A list grows in one branch alone; what is in it before depends on nothing.
    (
        "x = [eye('a')]\nif os.environ.get('B'):\n    x.append(eye('b'))\n"
        "return LaunchDescription(x)",
        ["/a", "/b"],
        1,
    ),
    # `and` has its last value only if all before it are true, which a run may decide.
    ("return LaunchDescription('' and [eye('a')] or [eye('b')])", ["/b"], 0),
    (
        "more = os.environ.get('B') and [eye('a')]\nreturn LaunchDescription(more or [eye('b')])",
        ["/a", "/b"],
        2,
    ),
    (
        "x = [eye('a')] and os.environ.get('B') and [eye('b')]\nreturn LaunchDescription(x)",
        ["/b"],
        1,
    ),
    # Two names that one condition sets go together.
    (
        "if os.environ.get('B'):\n    x, y = 'a', 'one'\nelse:\n    x, y = 'b', 'two'\n"
        "return LaunchDescription([eye(x, namespace=y)])",
        ["/one/a", "/two/b"],
        2,
    ),
    (
        "k = os.environ['K']\nif k == '1':\n    x = 'a'\nelif k == '2':\n    x = 'b'\n"
        "else:\n    x = 'c'\nreturn LaunchDescription([eye(x)])",
        ["/a", "/b", "/c"],
        3,
    ),
    (
        "match os.environ['K']:\n    case '1':\n        x = 'a'\n    case _:\n        x = 'b'\n"
        "return LaunchDescription([eye(x)])",
        ["/a", "/b"],
        2,
    ),
    # What neither branch changes is started either way.
    ("if os.environ.get('B'):\n    x = 'b'\nreturn LaunchDescription([eye('a')])", ["/a"], 0),
    (
        "if os.environ.get('B'):\n    return LaunchDescription([eye('a')])\n"
        "return LaunchDescription([eye('b')])",
        ["/a", "/b"],
        2,
    ),
    # A way that raises an exception, or lacks a name, starts nothing.
    (
        "if os.environ.get('B'):\n    x = 'a'\nelse:\n    raise RuntimeError\n"
        "return LaunchDescription([eye(x)])",
        ["/a"],
        0,
    ),
    ("if os.environ.get('B'):\n    x = 'a'\nreturn LaunchDescription([eye(x)])", ["/a"], 0),
    (
        "try:\n    x = 'a'\nexcept KeyError:\n    x = 'b'\nreturn LaunchDescription([eye(x)])",
        ["/a", "/b"],
        2,
    ),
    # Loops and comprehensions.
    (
        "x = [eye(a + b) for a in ['l', 'r'] for b in ('1', '2')]\nreturn LaunchDescription(x)",
        ["/l1", "/l2", "/r1", "/r2"],
        0,
    ),
    (
        "x = [eye(a) for a in ['l', 'r'] if a in os.environ]\n"
        "return LaunchDescription([*x, eye('z')])",
        ["/l", "/r", "/z"],
        2,
    ),
    (
        "x = []\nfor a in ['l', 'r']:\n    if a in os.environ:\n        continue\n"
        "    x.append(eye(a))\nreturn LaunchDescription([*x, eye('z')])",
        ["/z", "/l", "/r"],
        2,
    ),
    (
        "d = {k: k + '_eye' for k in ['l', 'r']}\nx = [eye(d[k]) for k in d]\n"
        "return LaunchDescription([*x, *(eye(v + '2') for v in d.values())])",
        ["/l_eye", "/r_eye", "/l_eye2", "/r_eye2"],
        0,
    ),
    # Functions inside of others, and those without a name.
    (
        "side = 'left'\ndef setup(context):\n    return [eye(side)]\n"
        "return LaunchDescription([OpaqueFunction(function=setup),"
        " OpaqueFunction(function=lambda context: [eye('right')])])",
        ["/left", "/right"],
        0,
    ),
    (
        "return LaunchDescription([eye('{}_{name}'.format('a', name='b')),"
        " eye('{0}{0}'.format('c'))])",
        ["/a_b", "/cc"],
        0,
    ),
]  # fmt: skip


@pytest.mark.parametrize(("body", "expected", "conditional"), BODIES)
def test_each_branch_is_taken(body: str, expected: list[str], conditional: int) -> None:
    found = launched(body)
    assert nodes(found) == expected
    noted = [note for note in notes_of(found) if "condition" in note]
    verb = "node depends" if conditional == 1 else "nodes depend"
    text = f"{conditional} {verb} on conditions, of which every branch was read"
    assert noted == ([text] if conditional else [])


def test_a_node_of_two_branches_has_the_topics_of_both() -> None:
    found = launched(
        "to = '/a'\nif os.environ.get('B'):\n    to = '/b'\n"
        "keys = Node(package='teleop_twist_keyboard', executable='teleop_twist_keyboard',"
        " remappings=[('cmd_vel', to)])\nreturn LaunchDescription([keys])"
    )
    lines = [each for each in found.configuration.relationships if isinstance(each, Control)]
    assert {(each.controlled, each.controller) for each in lines} == {
        ("a", "/teleop_twist_keyboard"),
        ("b", "/teleop_twist_keyboard"),
    }


def test_where_every_way_raises_the_file_is_read_as_if_none_did() -> None:
    found = launched("raise RuntimeError\nreturn LaunchDescription([eye('a')])")
    assert nodes(found) == ["/a"]


def test_more_branches_than_a_file_is_read_for_are_noted() -> None:
    body = "x = []\n" + "".join(
        f"if '{n}' in os.environ: x.append(eye('n{n}'))\n" for n in range(80)
    )
    found = launched(body + "return LaunchDescription(x)")
    assert any(note.startswith("branches of conditions not read") for note in notes_of(found))
    assert len(nodes(found)) == 80


def test_a_published_joint_state_may_come_from_a_list_of_topics() -> None:
    found = launched(
        "arm = Node(package='joint_state_publisher', executable='joint_state_publisher',"
        " name='arm', remappings=[('joint_states', 'arm/joints')])\n"
        "all = Node(package='joint_state_publisher', executable='joint_state_publisher',"
        " parameters=[{'source_list': ['arm/joints', 'wheels/joints']}])\n"
        "return LaunchDescription([arm, all])"
    )
    [line] = [each for each in found.configuration.relationships if isinstance(each, Data)]
    assert (line.client, line.source) == ("/joint_state_publisher", "/arm")
    inputs = {
        parameter
        for module in found.configuration.declared
        if module.name == "/joint_state_publisher"
        for service in module.services
        for parameter in service.parameters or ()
    }
    assert "/wheels/joints" in str(inputs)


@pytest.mark.parametrize(
    ("period", "hz"),
    [
        ("std::chrono::duration<double>(1.0 / 20)", 20),
        ("std::chrono::duration<double, std::milli>(50)", 20),
        ("std::chrono::duration<int, std::ratio<1, 30>>(1)", None),
    ],
)
def test_a_duration_counts_in_its_own_unit(period: str, hz: int | None) -> None:
    text = (
        'class A : public rclcpp::Node { A() : Node("a") {'
        ' p_ = create_publisher<A>("t", 1);'
        f" t_ = create_wall_timer({period}, std::bind(&A::tick, this)); }}"
        " void tick() { p_->publish(m); } };"
    )
    [topic] = read_cpp([(text, "a.cpp")]).published
    assert topic.hz == hz


CHAINED = """
import os
from launch import LaunchDescription
from launch.actions import IncludeLaunchDescription, OpaqueFunction
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch_ros.actions import Node

def setup(context):
    file = os.path.join(os.path.dirname(__file__), '{next}.launch.py')
    path = '{passed}'
    if os.environ.get('B'):
        path = '{other}'
    source = PythonLaunchDescriptionSource(file)
    return [IncludeLaunchDescription(source, launch_arguments={{'at{number}': path}}.items())]

def generate_launch_description():
    return LaunchDescription([
        Node(package="some", executable="thing", name="n{number}"), OpaqueFunction(function=setup)])
"""


@pytest.mark.parametrize(("other", "is_cut"), [("a", False), ("b", True)])
def test_branches_that_include_one_file_do_not_multiply(
    other: str, is_cut: bool, tmp_path: Path
) -> None:
    depth = 24
    for number in range(depth):
        text = CHAINED.format(next=number + 1, passed="a", other=other, number=number)
        (tmp_path / f"{number}.launch.py").write_text(text)
    (tmp_path / f"{depth}.launch.py").write_text(START + ENTRY + "    return LaunchDescription([])")
    found = import_ros2([("", str(tmp_path))])
    assert len(nodes(found)) == depth
    assert any("includes beyond the first" in each for each in notes_of(found)) == is_cut


def test_a_reading_may_end_before_the_entry_function() -> None:
    lidar = "try:\n    device = Device()\nexcept KeyError:\n    rate = '1'\nport = device.port\n"
    found = import_ros2(
        [(START + lidar + ENTRY + "    return LaunchDescription([eye('a')])", "a.launch.py")]
    )
    assert nodes(found) == ["/a"]


def test_unread_contents_of_one_place_keep_their_order() -> None:
    bridge = "Node(package='ros_gz_bridge', executable='parameter_bridge', name='b', "
    found = launched(f"return LaunchDescription([{bridge}arguments=['/b@x', '/a@y', '/b@x'])])")
    message = "topics named at run time not read: 2 (`/b@x`, `/a@y`)"
    assert [note for note in notes_of(found) if "run time" in note] == [message]
