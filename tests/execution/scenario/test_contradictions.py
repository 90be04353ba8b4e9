"""Scenarios that contradict themselves: each contradiction at its place, all of them at once."""

import re
from pathlib import Path

import pytest

from mars_asp.diagnostic import MarsError
from mars_asp.execution.scenario.read import read_scenario
from tests.support.refusals import refusals

#: A marker `^` is before each place that is reported; what is reported there follows in a comment.
CONTRADICTIONS = """\
duration = 10
[robot]
module = "P"
[world]
walls = [
  [[0, 0], [1, 1]],
  ^[[2, 3], [2, 3], [2, 3]],  # an entry of `walls` has fewer than 2 different points
  ^[[0, 0]],  # an entry of `walls` must be a list of 2 or more points
]
polygons = [
  [[0, 0], [1, 0], [0, 1]],
  ^[[0, 0], [1, 0], [0, 0]],  # an entry of `polygons` has fewer than 3 different points
  ^[[0, 0], [1, 0]],  # an entry of `polygons` must be a list of 3 or more points
]
[[world.moving]]
from = [0, 1]
to = [0, 2]
radius = 1
speed = 1
^[[world.moving]]  # an obstacle of `moving` ends where it begins
from = [0, 1]
to = [0, 1.0]
radius = 1
speed = 1
[[world.moving]]
from = [0, 1]
to = [0, 2]
radius = 1
speed = 1000
^[[world.moving]]  # an obstacle of `moving` turns more than 1000 times a second
way = [[0, 0], [0, 1], [1, 1], [0, 0]]
radius = 1
speed = 1140
[world.scatter]
^speed = 2e7  # `20000000.0` is out of range for `speed`
^moving = 11  # `moving` is 11, and `scatter` makes 10 obstacles
^radius = [30, 20.5]  # the least `radius` is 30, above the greatest, which is 20.5
[devices.Bump]
kind = "bumper"
^beams = 3  # `beams` is not a key of the kind `bumper`
^beems = 3  # unknown key `beems`
[devices.Arm]
kind = "joint"
^period = 3  # `period` is not a key of the kind `joint`
[devices.Base]
kind = "platform"
^reach = 3  # `reach` is not a key of the kind `platform`
[devices.Late]
kind = "joystick"
script = [
  [0, "Trans_Z", 1],
  [2, "release"],
  ^[1, "Trans_Z", 1],  # the script of `Late` has an entry at 1 s after one at 2 s
  ^[1, "Rotn_Y", 1],  # the script of `Late` has an entry at 1 s after one at 1 s
  ^[3, "let go"],  # an entry of `script` must be `[second, function, rate]`
  ^[-1, "release"],  # an entry of `script` must be `[second, function, rate]`
  [10, "release"],
  ^[10.5, "release"],  # the script of `Late` has an entry at 10.5 s, and the run ends at 10 s
]
[bindings]
^Arm.period = 3  # `Arm` has a binding and a device
^Bump = { python = "b.py:f" }  # `Bump` has a binding and a device
Other.^python = "b.py"  # `python` must be `"FILE.py:FUNCTION"`
[faults.Soon]
from = 9
until = 11
[faults.Silent]
^from = 10  # the fault of `Silent` begins at 10 s, and the run ends at 10 s
[faults.Never]
from = 3
^until = 3  # the fault of `Never` ends at 3 s, when it begins
[faults.Stuck]
kind = "stuck"
^by = 3  # `by` is not a key of the kind `stuck`
[faults.Slow]
kind = "late"
^from = 1  # `from` is not a key of the kind `late`
"""


def test_each_contradiction_is_reported_where_it_is() -> None:
    expected = {}
    for number, line in enumerate(CONTRADICTIONS.splitlines(), 1):
        if "^" in line:
            result = re.search(r"  # (.*)", line)
            assert result is not None
            expected[number, line.index("^") + 1] = result[1]
    with pytest.raises(MarsError) as raised:
        read_scenario(CONTRADICTIONS.replace("^", ""), Path("s.toml"))
    found = {(d.span.line, d.span.column): d.message for d in raised.value.diagnostics}
    assert len(found) == len(raised.value.diagnostics)
    assert found.keys() == expected.keys()
    for place, message in found.items():
        assert message.startswith(expected[place])
        help_texts = [d.help for d in raised.value.diagnostics if d.span.line == place[0]]
        assert None not in help_texts or "must be" in message


def test_a_key_of_another_kind_names_the_kinds_that_have_it() -> None:
    text = 'duration = 1\nrobot.module = "P"\n[devices.B]\nkind = "bumper"\nbeams = 3\n'
    assert [d.help for d in refusals(read_scenario, text, Path("s.toml"))] == [
        "it belongs to sonar, lidar"
    ]


def test_an_invalid_value_contradicts_nothing() -> None:
    text = 'duration = "x"\nrobot.module = "P"\nfaults.C = { from = 3, until = "x" }\n'
    text += 'world.scatter = { radius = [9, "x"], moving = 99, count = "x" }\n'
    assert [d.message.split("`")[1] for d in refusals(read_scenario, text, Path("s.toml"))] == [
        "duration",
        "until",
        "radius",
        "count",
    ]
