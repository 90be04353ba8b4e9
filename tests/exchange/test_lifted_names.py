"""`import` and `synthesise` print one name for the same node."""

import re
from collections import defaultdict

import pytest

from mars_asp.exchange.lift import with_own_muxes
from mars_asp.language import parse_text
from mars_asp.language.print import print_configuration, print_relationship
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


def test_a_mux_is_numbered_where_a_module_has_its_name() -> None:
    text = "@configuration hierarchical\n@modules A, mux, B\n// imported from ros2\n"
    text += (
        "// A: commands pass a twist_mux, mux\nA is_controlled_by mux 1\nA is_controlled_by B 2\n"
    )
    shown = with_own_muxes(parse_text(text, "robot.mars").configuration)
    assert [print_relationship(line) for line in shown.relationships] == [
        'A is_controlled_by "mux#2"',
        '"mux#2" is_controlled_by mux 1',
        '"mux#2" is_controlled_by B 2',
    ]
    text = "@specification hierarchical\n@modules A, mux, B, ArbitrationNode\n"
    text += "// imported from ros2\n// ArbitrationNode: commands pass a twist_mux, mux\n"
    text += "A is_controlled_by ArbitrationNode\nArbitrationNode is_controlled_by mux 1\n"
    text += "ArbitrationNode is_controlled_by B 2\n"
    again = with_own_muxes(parse_text(text, "robot.mars").configuration)
    assert list(map(print_relationship, again.relationships)) == list(
        map(print_relationship, shown.relationships)
    )


def test_a_mux_that_something_goes_past_is_one_module() -> None:
    text = "@specification hierarchical\n@modules Base, mux, A, B, ArbitrationNode\n"
    text += "// imported from ros2\n// ArbitrationNode: commands pass a twist_mux, mux\n"
    text += "mux is_controlled_by ArbitrationNode\nArbitrationNode is_controlled_by A 1\n"
    text += "ArbitrationNode is_controlled_by B 2\nBase is_controlled_by mux\n"
    shown = with_own_muxes(parse_text(text, "robot.mars").configuration)
    assert [name.text for name in shown.modules] == ["Base", "mux", "A", "B"]
    assert [print_relationship(line) for line in shown.relationships] == [
        "mux is_controlled_by A 1",
        "mux is_controlled_by B 2",
        "Base is_controlled_by mux",
    ]
