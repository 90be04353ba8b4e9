"""Scenarios that cannot be read: each mistake at its place, all of them at once."""

import re
from pathlib import Path

import pytest

from mars_asp.diagnostic import MarsError
from mars_asp.execution.scenario.read import read_scenario
from tests.support.refusals import refusal, refusals
from tests.support.trials import BASE


def test_all_errors_of_a_scenario_come_at_once_with_their_lines() -> None:
    found = [
        (d.span.line, d.message, d.help)
        for d in refusals(
            read_scenario, 'sed = 1\nduration = "x"\n[robot]\nmodul = "P"\n', Path("s.toml")
        )
    ]
    assert (1, "unknown key `sed`", "did you mean `seed`?") in found
    assert (2, "`duration` must be a number", None) in found
    assert (4, "unknown key `modul`", "did you mean `module`?") in found


#: A marker `^` precedes each reported location, in the order of the messages.
WRONG_FORMS = """\
duration = 1
[robot]
module = "P"
^start = [0, 0]
[world]
walls = [
  [[0, 0], [1, 1]],  # ], [
  ^[], ^[0, 1],
  ^"a], [",
]
polygons = [[[0, 0], [1, 0], [0, 1]], ^[[0, 0], [1, 0]], ^[[0, "b"]], ^3]
circles = [[0, 0, 10], ^[0, 0], ^[0, 0, -5], ^{ x = 1 }]
marks = [{ at = [1, 2], colour = "red" }, { ^at = [1], ^colour = 4 }, ^{ at = [3, 4] }]
scatter = { count = 3, ^radius = 4 }
[[world.moving]]
from = [0, 0]
to = [1, 1]
radius = 10
speed = 5
^[[world.moving]]
^from = [0]
radius = 10
speed = 5
[devices.D]
kind = "joystick"
script = [[0, "Trans_Z", 100], ^[1, "Trans_Q", 100], ^[2, "Trans_Z"], [0.5, "release"], ^[[]]]
[requirements]
^reach = { radius = 3 }
exclusive = [["Trans_Z", "Rotn_Y"], ^["Trans_Z"], ^["Trans_Z", "Turn"]]
^coverage = 2
"""


def test_values_of_a_wrong_form_are_reported_at_their_locations() -> None:
    lines = WRONG_FORMS.splitlines()
    marked = [
        (number, match.start() - index + 1)
        for number, line in enumerate(lines, 1)
        for index, match in enumerate(re.finditer(r"\^", line))
    ]
    found = refusals(read_scenario, WRONG_FORMS.replace("^", ""), Path("s.toml"))
    assert sorted({(d.span.line, d.span.column) for d in found}) == marked
    entries = {d.span.line: d.message for d in found}
    assert entries[4] == "`start` must be `[forward, side, heading]`"
    assert entries[8] == "an entry of `walls` must be a list of 2 or more points `[forward, side]`"
    form = "`{ from, to, radius, speed }`, or `{ way, radius, speed }` with a way of points"
    assert entries[20] == f"an entry of `moving` must be a table {form}"
    assert entries[28] == "`reach` has no `at`"


@pytest.mark.parametrize("key", ["a", '"a b"', "'a.b'"])
def test_a_key_of_very_many_parts_is_refused_before_it_is_read(key: str) -> None:
    found = refusal(
        read_scenario, f"duration = 1\n{'. '.join([key] * 100_000)} = 1\n", Path("s.toml")
    )
    assert (found.span.line, found.message) == (2, "a key with more than 100 parts")


def test_broken_toml_is_placed() -> None:
    assert refusals(read_scenario, "seed = 1\nduration = = 2\n", Path("s.toml"))[0].span.line == 2


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ("low = 90\nhigh = -90", "`low` is 90, above `high`, which is -90"),
        ("high = 10\nvalue = 11.5", "`value` is 11.5, above `high`, which is 10"),
        ("value = -1\nlow = 0", "`low` is 0, above `value`, which is -1"),
        ("\nlow = inf\nhigh = inf\nvalue = 0", "`low` is inf, above `value`, which is 0"),
    ],
)
def test_bounds_of_a_joint_are_in_order(wrong: str, message: str) -> None:
    found = refusal(read_scenario, f'{BASE}[devices.J]\nkind = "joint"\n{wrong}\n', Path("s.toml"))
    assert found.message == message
    lines = f"{BASE}[devices.J]\n\n{wrong}\n".split("\n")
    assert lines[found.span.line - 1].startswith(message.split("`")[1])


def test_a_fault_ends_after_it_began() -> None:
    fault = '[faults.C]\nkind = "silent"\nuntil = 2\nfrom = 3\n'
    with pytest.raises(MarsError, match="`from` is 3, above `until`, which is 2"):
        read_scenario(BASE + fault, Path("s.toml"))


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ("command_timeout = 0", "`0` is out of range for `command_timeout`"),
        ("command_timeout = inf", "`inf` is out of range for `command_timeout`"),
        ("command_timeout = -1e308", "`-1e+308` is out of range for `command_timeout`"),
        (f"seed = {2**63}", f"`{2**63}` is out of range for `seed`"),
        ("world.circles = [[0, nan, 1]]", "`nan` is out of range for `circles`"),
        ("world.scatter = { count = 1000000 }", "`1000000` is out of range for `count`"),
        ("faults.C = { kind = 'babbling', by = 0 }", "`0` is out of range for `by`"),
        ("robot.limits = { Trans_Q = 3 }", "unknown key `Trans_Q`"),
        ("a = " + "[" * 5000 + "]" * 5000, "its lists and tables are nested too deep"),
        ("seed = " + "9" * 5000, "a number with more than 4300 digits"),
    ],
)
def test_numbers_beyond_reason_are_refused_before_the_run(wrong: str, message: str) -> None:
    text = f'{wrong}\nduration = 3\n[robot]\nmodule = "P"\n'
    if wrong.startswith("robot"):
        text = f'{wrong}\nrobot.module = "P"\nduration = 3\n'
    found = refusal(read_scenario, text, Path("s.toml"))
    assert found.message.startswith(message)
    assert found.span.line == 1
    # What may be open stays open.
    moving = "[world]\nmoving = [{ from = [-9, -9], to = [0, 0], radius = 1, speed = 1 }]\n"
    assert read_scenario(BASE + moving, Path("s.toml")).world["moving"][0]["from"] == [-9, -9]
    joint = '[devices.J]\nkind = "joint"\nlow = -inf\nhigh = inf\nrate = inf\n'
    assert read_scenario(BASE + joint, Path("s.toml")).devices["J"]["low"] < 0


def test_only_some_mistakes_of_a_scenario_are_reported() -> None:
    wrong = "".join(f"key{number} = 1\n" for number in range(5000))
    assert len(refusals(read_scenario, wrong, Path("s.toml"))) == 200
