"""Lines that differ are known by what they are under, not by their text or number alone."""

from collections.abc import Sequence
from pathlib import Path
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mars_asp.cli import run_here
from mars_asp.reasoning.questions.diff_lines import differing_lines, file_lines
from tests.support.fixtures import Captured
from tests.support.strategies import few

INPUTS = {
    "nav": ["topic: nav_vel", "timeout: 0.5", "priority: 10"],
    "dock": ["topic: dock_vel", "timeout: 0.5", "priority: 10"],
    "joy": ["topic: joy_vel", "timeout: 0.0", "priority: 100"],
}
blocks = st.dictionaries(
    st.sampled_from("abc"), st.lists(st.sampled_from(["x: 1", "y: 2"]), max_size=3)
)


def mux(inputs: dict[str, list[str]]) -> list[str]:
    lines = ["topics:"]
    for name, values in inputs.items():
        lines += [f"  {name}:", *(f"    {value}" for value in values)]
    return lines


def differing(old: Sequence[str], new: Sequence[str]) -> tuple[list[int], list[int]]:
    gone, come = differing_lines(file_lines("old", "", old), file_lines("new", "", new))
    return [line.span.line for line in gone], [line.span.line for line in come]


def test_an_equal_line_under_another_name_is_another_line() -> None:
    dock = ["topic: dock_vel", "timeout: 0.5", "priority: 20"]
    joy = ["topic: joy_vel", "timeout: 0.5", "priority: 100"]
    new = {"nav": INPUTS["nav"], "dock": dock, "joy": joy}
    assert differing(mux(INPUTS), mux(new)) == ([9, 12], [9, 12])


def test_swapped_values_are_changes() -> None:
    new = {**INPUTS, "nav": [*INPUTS["nav"][:2], "priority: 100"]}
    new["joy"] = [*INPUTS["joy"][:2], "priority: 10"]
    assert differing(mux(INPUTS), mux(new)) == ([5, 13], [5, 13])


def test_below_a_changed_name_only_changed_lines_differ() -> None:
    new = {"nav": INPUTS["nav"], "docking": INPUTS["dock"], "joy": INPUTS["joy"]}
    assert differing(mux(INPUTS), mux(new)) == ([6], [6])


def test_a_line_that_comes_is_not_one_that_goes_elsewhere() -> None:
    head = [*mux(INPUTS), "locks:"]
    lock = ["  stop:", "    topic: stop", "    timeout: 9.0"]
    added = {**INPUTS, "c": ["topic: c_vel", "timeout: 9.0", "priority: 7"]}
    assert differing([*head, *lock], mux(added)) == ([14, 15, 16, 17], [14, 15, 16, 17])


@pytest.mark.parametrize("name", ["A", "B"])
def test_a_line_of_an_annotation_is_of_its_module(name: str) -> None:
    def robot(rate: dict[str, int]) -> list[str]:
        lines = []
        for module, number in rate.items():
            lines += ["@module_start", f"@module_name {module}", f"@Rate {number}", "@module_end"]
        return lines

    old = {"A": 5, "B": 5, "C": 7}
    at = 3 + 4 * list(old).index(name)
    assert differing(robot(old), robot({**old, name: 7})) == ([at], [at])


@settings(few)
@given(blocks, st.randoms())
def test_blocks_in_another_order_do_not_differ(
    inputs: dict[str, list[str]], random: Random
) -> None:
    names = sorted(inputs, key=lambda _: random.random())
    assert differing(mux(inputs), mux({name: inputs[name] for name in names})) == ([], [])


@settings(few)
@given(blocks, blocks)
def test_a_line_that_is_not_there_before_differs(
    old: dict[str, list[str]], new: dict[str, list[str]]
) -> None:
    gone, come = differing(mux(old), mux(new))
    before, after = ({name: sorted(each[name]) for name in each} for each in (old, new))
    assert (gone == come == []) == (before == after)


def test_the_changed_lines_of_two_mux_files_are_shown(tmp_path: Path, capsys: Captured) -> None:
    head = ["twist_mux:", "  ros__parameters:"]
    for name, joy in (("old", "timeout: 0.0"), ("new", "timeout: 0.5")):
        inputs = {**INPUTS, "joy": ["topic: joy_vel", joy, "priority: 100"]}
        lines = head + [f"    {line}" for line in mux(inputs)]
        (tmp_path / f"{name}.yaml").write_text("\n".join(lines) + "\n")
    run_here(["diff", str(tmp_path / "old.yaml"), str(tmp_path / "new.yaml"), "-q"])
    out = capsys.readouterr().out
    lines = [line for line in out.splitlines() if ".yaml:" in line]
    changed = {line.split(str(tmp_path))[-1] for line in lines}
    assert changed == {"/old.yaml:14: timeout: 0.0", "/new.yaml:14: timeout: 0.5"}


def test_topics_of_a_mux_file_are_lines_that_differ(tmp_path: Path, capsys: Captured) -> None:
    head = ["twist_mux:", "  ros__parameters:"]
    for name, topic in (("old", "joy_vel"), ("new", "cmd_vel_joy")):
        inputs = {**INPUTS, "joy": [f"topic: {topic}", "timeout: 0.5", "priority: 100"]}
        lines = head + [f"    {line}" for line in mux(inputs)]
        (tmp_path / f"{name}.yaml").write_text("\n".join(lines) + "\n")
    run_here(["diff", str(tmp_path / "old.yaml"), str(tmp_path / "new.yaml")])
    out = capsys.readouterr().out
    lines = [line.split(str(tmp_path))[-1] for line in out.splitlines() if ".yaml:" in line]
    assert lines == ["/old.yaml:13: topic: joy_vel", "/new.yaml:13: topic: cmd_vel_joy"]
