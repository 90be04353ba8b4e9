"""`import` and `synthesise` print one name for the same node."""

import re
from collections import defaultdict

import pytest

from mars_asp.language import parse_text
from mars_asp.language.print import print_configuration
from tests.support.documents import run

ROBOTS = (
    *("ros2 examples/ros2_workspace", "ros2 tests/ros2/commands", "ros2 tests/ros2/controllers"),
    *("ros2 tests/ros2/sweeper", "twist_mux tests/twist_mux/ros2_tied.yaml"),
)


def inputs(text: str) -> dict[str, set[str]]:
    """Return the controllers of each arbiter in a specification."""
    found: dict[str, set[str]] = defaultdict(set)
    for arbiter, controller in re.findall(r"(?m)^(Arb\w+) is_controlled_by (\S+)", text):
        found[arbiter].add(controller)
    return found


@pytest.mark.parametrize("robot", ROBOTS)
def test_arbiters_have_the_names_that_synthesis_gives(robot: str) -> None:
    form, path = robot.split()
    imported = inputs(run(f"mars-asp import {form} {path} --quiet"))
    assert imported == inputs(run(f"mars-asp synthesise {path} --from {form} --quiet"))


@pytest.mark.parametrize(
    ("written", "name"),
    [
        ("a twist_mux, /mine/mux", "/mine/mux"),
        ('a twist_mux, "my mux"', "my mux"),
        ("a cmd_vel_mux", "cmd_vel_mux"),
    ],
)
def test_the_name_of_a_mux_is_kept_in_a_comment(written: str, name: str) -> None:
    text = "@configuration hierarchical\n@modules A, B\n// imported from ros2\n"
    text += f"// A: commands pass {written}\nA is_controlled_by B 1\n"
    configuration = parse_text(text, "robot.mars").configuration
    assert [mux.name for mux in configuration.muxes] == [name]
    assert print_configuration(configuration) == text
