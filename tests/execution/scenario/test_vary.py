"""Keys of a scenario with other values, as `--vary` states them."""

from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mars_asp import MarsError
from mars_asp.execution.scenario.read import read_scenario
from mars_asp.execution.scenario.vary import read_axes, read_axis, written_change
from tests.support.refusals import refusal, refusals
from tests.support.trials import DRIVE, trial

TEXT = """\
duration = 3
[robot]
module = "P"
[world]
moving = [{ from = [0, 900], to = [900, 900], radius = 50, speed = 10 }]
[devices."the hand"]
kind = "joystick"
[devices.C]
kind = "joystick"
script = [[0, "Trans_Z", 200]]
[requirements]
clearance = 5
"""


def varied(*words: str) -> Any:
    changes = {axis.key: axis.only for axis in read_axes(words)}
    return read_scenario(TEXT, Path("s.toml"), changes)


@pytest.mark.parametrize(
    ("words", "value"),
    [
        ("robot.radius=150", lambda s: s.robots[0].radius == 150),
        ("duration = 1.5", lambda s: s.duration == 1.5),
        ('up="z"', lambda s: s.up == "z"),
        ("world.moving.0.speed=80", lambda s: s.world["moving"][0]["speed"] == 80),
        ("world.moving=[]", lambda s: s.world["moving"] == []),
        ("world.scatter={ count = 3 }", lambda s: s.world["scatter"] == {"count": 3}),
        ("world.scatter.count=3", lambda s: s.world["scatter"] == {"count": 3}),
        ('devices."the hand".period=20', lambda s: s.devices["the hand"]["period"] == 20),
        ("requirements.clearance=7", lambda s: s.requirements == {"clearance": 7}),
        ("modules.C=on", lambda s: s.faults == {}),
        ("modules.C=off", lambda s: s.faults["C"]["kind"] == "silent"),
    ],
)
def test_a_key_has_another_value(words: str, value: Any) -> None:
    assert value(varied(words))
    assert read_scenario(TEXT, Path("s.toml")).devices["C"]["script"] == [[0, "Trans_Z", 200]]


@pytest.mark.parametrize(
    ("words", "message", "help_text"),
    [
        ("robot.raduis=1", "unknown key `raduis`", "did you mean `radius`?"),
        ("robt.radius=1", "unknown key `robt`", "did you mean `robot`?"),
        ('robot.radius="1"', "`radius` must be a number", None),
        (
            "devices.D.sigma=1",
            "`devices.D.sigma`: the scenario has no device `D`",
            "one of the hand, C",
        ),
        ("duration.x=1", "`duration.x`: `duration` is 3, not a table", None),
        (
            "world.moving.1.speed=1",
            "`world.moving.1.speed`: `1` is not an entry of the list `world.moving`",
            "its one entry is 0",
        ),
        ("modules.C=1", "`modules.C=1` does not switch a module", None),
        ("modules=off", "`modules=off` does not switch a module", None),
        ("seed=1", "the seed is not a key to vary", "use --seeds, or --seed for one run"),
        ("duration=1,2", "`duration` has 2 values", None),
        ("duration=1,2,1", "`duration` has the value 1 twice", None),
        ("duration=1,2,1.0", "`duration` has the value 1.0 twice", None),
        ("robot.radius=inf", "`robot.radius=inf` has a value without an end", None),
        ("duration", "`duration` is not a key and its values", None),
        ("duration=", "`duration=` is not a key and its values", None),
        ("=3", "`=3` is not a key and its values", None),
        ("up=z", "`up=z` is not a key and its values", None),
        ("a..b=1", "`a..b=1` is not a key and its values", None),
        ("up=1]\nx = [2", "`up=1]\nx = [2` is not a key and its values", None),
    ],
)
def test_keys_and_values_that_cannot_vary_are_refused(
    words: str, message: str, help_text: str | None
) -> None:
    found = refusal(varied, words)
    assert (found.span.path, found.message) == ("--vary", message)
    assert help_text is None or found.help == help_text


def test_a_key_is_varied_once() -> None:
    with pytest.raises(MarsError, match="is varied twice"):
        varied("robot.radius=1", 'robot."radius"=2')


FLEET = """\
duration = 3
[[robot]]
name = "a"
module = "P"
[[robot]]
module = "b/Q"
start = [900, 0, 0]
"""


@pytest.mark.parametrize(
    ("key", "number"),
    [("a", 0), ("0", 0), ('"b/Q"', 1), ("1", 1)],
    ids=["name", "0", "module", "1"],
)
def test_a_robot_of_several_is_named_or_counted(key: str, number: int) -> None:
    radii = [200, 200]
    radii[number] = 99
    changed = read_scenario(FLEET, Path("s.toml"), {f"robot.{key}.radius": 99})
    assert [robot.radius for robot in changed.robots] == radii


@pytest.mark.parametrize(
    ("keys", "message", "help_text"),
    [
        (
            ["robot.radius"],
            "`robot.radius`: there are several robots, and none is named `radius`",
            'one of a, "b/Q", as in `robot.a.radius`',
        ),
        (
            ["robot.b.radius"],
            "`robot.b.radius`: there are several robots, and none is named `b`",
            'one of a, "b/Q", as in `robot.a.radius`',
        ),
        (["robot.a.raduis"], "unknown key `raduis`", "did you mean `radius`?"),
        (
            ["robot.a.radius", "robot.0.radius"],
            "`robot.0.radius`: this is the same key as `robot.a.radius`",
            "state it once",
        ),
    ],
)
def test_how_to_name_one_of_several_robots_is_reported(
    keys: list[str], message: str, help_text: str
) -> None:
    found = refusal(read_scenario, FLEET, Path("s.toml"), dict.fromkeys(keys, 99))
    assert (found.message, found.help) == (message, help_text)


def test_a_mistake_of_the_scenario_itself_is_at_its_line() -> None:
    assert [
        d.span[:2]
        for d in refusals(read_scenario, TEXT + "x = 1\n", Path("s.toml"), {"robot.raduis": 1})
    ] == [("s.toml", 13)]


def test_a_module_that_is_off_sends_nothing_from_the_first_instant_to_the_last() -> None:
    text = 'duration = 1\n[robot]\nmodule = "P"\n[devices.C]\nkind = "joystick"\n'
    text += 'script = [[0, "Trans_Z", 200]]\n'
    assert sum(link.delivered for link in trial(text, DRIVE).executor.links) == 11
    silent = trial(text, DRIVE, changes={"modules.C": "off"})
    assert sum(link.delivered for link in silent.executor.links) == 0


KEYS = st.text(min_size=1, max_size=4)
VALUES = st.recursive(
    st.booleans() | st.integers(-(2**63), 2**63 - 1) | st.text(st.characters(codec="utf-8")),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(KEYS, inner, max_size=3),
    max_leaves=6,
) | st.floats(allow_nan=False, allow_infinity=False)


@given(VALUES)
def test_a_written_value_reads_back(value: Any) -> None:
    (axis,) = read_axes([written_change("robot.x", value)])
    assert axis.values == (value,)
    assert type(axis.only) is type(value)


def test_switches_are_words() -> None:
    axis = read_axis("modules.Collide = on, off")
    assert axis.values == ("on", "off")
    assert written_change(axis.key, "off") == "modules.Collide=off"
