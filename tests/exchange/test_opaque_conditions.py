"""Conditions in the code of launch files, decided by the arguments that other files pass."""

import json
from pathlib import Path

import pytest

from mars_asp.cli import run_here
from tests.support.fixtures import Captured
from tests.support.packages import write_package

INNER = """
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

def setup(context):
    arm = LaunchConfiguration('arm')
    hand = LaunchConfiguration('hand', default=arm)
    value = arm.perform(context)
    nodes = [Node(package='some', executable='thing', name='twin')]
    if {condition}:
        nodes.append(Node(package='some', executable='thing', name='twin', namespace='/'))
    return nodes

def generate_launch_description():
    return LaunchDescription([
        DeclareLaunchArgument('arm', default_value='false'), OpaqueFunction(function=setup)])
"""
OUTER = """<launch>
  <include file="$(find-pkg-share mine)/launch/inner.launch.py">{passed}</include>
</launch>"""


def effects(condition: str, passed: str | None, folder: Path, capsys: Captured) -> list[str]:
    """Return the effects of the findings on two nodes of one name."""
    written = {
        "launch/inner.launch.py": INNER.format(condition=condition),
    }
    if passed is not None:
        arguments = f'<arg name="arm" value="{passed}"/>'
        written["launch/outer.launch.xml"] = OUTER.format(passed=arguments)
    write_package(written, folder)
    # What does not hold by default is a note, which `check` does not print.
    run_here(["explain", "--format", "json", str(folder)])
    topics = json.loads(capsys.readouterr().out)["topics"]
    return [
        each["notes"][0].replace(", as it is by default", "")
        for each in topics
        if each["name"].startswith("duplicate_node")
    ]


#: A condition, the words for it, a value with which it holds, and one with which it does not.
CONDITIONS = [
    ("value == 'true'", "`arm` is `true`", "true", "false"),
    ("value.lower() == 'true'", "`arm` is `true`", "true", "false"),
    ("value in ('True', 'true')", "`arm` is `true`", "True", "false"),
    ("not (value in ('True', 'true'))", "`arm` is not `true`", "false", "true"),
    ("value != 'left'", "`arm` is not `left`", "right", "left"),
    ("arm.perform(context) == 'left'", "`arm` is `left`", "left", "right"),
    ("context.launch_configurations['arm'] == 'left'", "`arm` is `left`", "left", "right"),
    ("context.launch_configurations.get('arm') == 'left'", "`arm` is `left`", "left", "right"),
    ("context.perform_substitution(arm) == 'left'", "`arm` is `left`", "left", "right"),
    ("IfCondition(arm).evaluate(context)", "`arm` is `true`", "true", "false"),
    ("arm.perform(context)", "`arm` is not empty", "left", ""),
]


@pytest.mark.parametrize(("condition", "words", "holds", "fails"), CONDITIONS)
def test_a_condition_of_an_argument_is_decided_by_its_value(
    condition: str, words: str, holds: str, fails: str, tmp_path: Path, capsys: Captured
) -> None:
    [effect] = effects(condition, None, tmp_path / "open", capsys)
    assert f"It is so when {words} (inner.launch.py:12)." in effect
    [effect] = effects(condition, holds, tmp_path / "holds", capsys)
    assert "It is so when" not in effect
    assert effects(condition, fails, tmp_path / "fails", capsys) == []


def test_a_conjunction_names_all_its_arguments(tmp_path: Path, capsys: Captured) -> None:
    condition = "value == 'true' and hand.perform(context) == 'left'"
    [effect] = effects(condition, None, tmp_path, capsys)
    at = "(inner.launch.py:12)"
    assert f"It is so when `arm` is `true` {at} and `hand` is `left` {at}." in effect
    assert effects(condition, "false", tmp_path, capsys) == []


def test_a_condition_of_anything_else_is_named_by_its_place(
    tmp_path: Path, capsys: Captured
) -> None:
    [effect] = effects("os.path.exists(value)", None, tmp_path, capsys)
    assert "It is so when the condition at " in effect
    assert "launch/inner.launch.py:12 holds." in effect


TWIN = "return [Node(package='some', executable='thing', name='twin', namespace='/')]"


@pytest.mark.parametrize(
    "condition", ["value == 'true'", "value == 'true' and hand", "os.path.exists(value)"]
)
def test_the_branches_of_a_condition_exclude_each_other(
    condition: str, tmp_path: Path, capsys: Captured
) -> None:
    branches = f"{condition}:\n        return nodes\n    else:\n        {TWIN}\n    if value"
    assert effects(branches, None, tmp_path, capsys) == []
