"""Every key of a scenario can be an axis of a campaign, or is refused with a reason."""

import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from mars_asp.execution.scenario.read import read_scenario
from mars_asp.execution.scenario.schema import SCHEMA
from mars_asp.execution.scenario.vary import changed, read_axis
from mars_asp.execution.trial import make_world
from mars_asp.model.declarations import GRASP, MOTION_FUNCTIONS
from tests.support.refusals import refusal, refusals
from tests.support.trials import BASE, trial

TEXT = """\
duration = 3
[robot]
module = "P"
start = [0, 0, 0]
acceleration = { Trans_X = 500 }
[world]
circles = [[900, 0, 50]]
moving = [
  { from = [0, 900], to = [900, 900], radius = 50, speed = 10 },
  { way = [[0, 900], [900, 900], [0, 0]], radius = 50, speed = 10 },
]
marks = [{ at = [5, 5], colour = "red" }]
[devices]
Hand = { kind = "joystick", script = [[0, "Trans_Z", 200]] }
Ring = { kind = "sonar" }
Eye = { kind = "marks" }
Beam = { kind = "lidar" }
Arm = { kind = "joint", function = "Rotn_Y", low = -90, high = 90 }
[faults]
Hand = { kind = "silent", from = 1, until = 2 }
Ring = { kind = "late", by = 10 }
[[links]]
from = "Hand"
to = "P"
until = 2
[requirements]
reach = { at = [900, 0] }
"""
#: A key, and a value that it has not: in the order of the document.
KEYS = """\
duration = 4
up = "z"
command_timeout = 900
robot.name = "rover"
robot.module = "Q"
robot.radius = 150
robot.start = [1, 2, 90]
robot.start.2 = 45
robot.limits = { Trans_Z = 250 }
robot.limits.Trans_Z = 250
robot.acceleration.Trans_X = 100
robot.deceleration = { Trans_X = 100 }
robot.deceleration.Trans_X = 100
world.walls = [[[0, 0], [0, 5]]]
world.polygons = [[[0, 0], [0, 5], [5, 0]]]
world.circles = [[0, 0, 3], [5, 5, 3]]
world.circles.0.2 = 70
world.moving.0.from = [0, 800]
world.moving.0.to = [0, 800]
world.moving.0.to.1 = 800
world.moving.0.radius = 60
world.moving.0.speed = 0
world.moving.1.way = [[0, 900], [900, 900]]
world.marks.0.at = [9, 9]
world.marks.0.colour = "blue"
world.scatter = { count = 4 }
world.scatter.count = 0
world.scatter.radius = [10, 20]
world.scatter.within = 900
world.scatter.free = 100
world.scatter.moving = 3
world.scatter.speed = 30
devices.Ring.kind = "lidar"
devices.Ring.period = 50
devices.Ring.beams = 8
devices.Ring.cone = 30
devices.Ring.rays = 5
devices.Ring.reach = 900
devices.Ring.sigma = 7
devices.Beam.view = 180
devices.Hand.script = [[1, "release"]]
devices.Hand.script.0.2 = 100
devices.Arm.function = "Rotn_X"
devices.Arm.low = -80
devices.Arm.high = 80
devices.Arm.rate = 5
devices.Arm.value = 7
bindings.C.python = "b.py:go"
bindings.C.period = 50
bindings.C.delay = 20
bindings.C.parameters = { near = 3 }
bindings.C.parameters.near = 3
faults.Hand.kind = "stuck"
faults.Hand.from = 0
faults.Hand.until = 2.5
faults.Ring.by = 30
links.0.from = "Ring"
links.0.to = "C"
links.0.loss = 0.5
links.0.delay = 20
links.0.jitter = 0.5
links.0.since = 1
links.0.until = 3
requirements.no_collision = true
requirements.clearance = 30
requirements.reach.at = [0, 900]
requirements.reach.radius = 10
requirements.reach.within = 2
requirements.exclusive = [["Trans_Z", "Rotn_Y"]]
requirements.coverage = 0.5
"""


@pytest.mark.parametrize("line", KEYS.splitlines())
def test_each_key_can_be_varied(line: str) -> None:
    axis = read_axis(line)
    read_scenario(TEXT, Path("s.toml"), {axis.key: axis.only})
    found: Any = changed(tomllib.loads(TEXT), {axis.key: axis.only})
    for part in axis.key.split("."):
        found = found[int(part) if isinstance(found, list) else part]
    assert found == tomllib.loads(f"value = {line.partition(' = ')[2]}")["value"]


def test_no_key_is_left_out() -> None:
    varied = {part for line in KEYS.splitlines() for part in line.partition(" = ")[0].split(".")}
    assert {*keys(SCHEMA)} - varied - {*MOTION_FUNCTIONS, GRASP} == {"seed"}
    assert refusals(read_axis, "seed=1,2")[0].help == "use --seeds, or --seed for one run"


def keys(schema: dict[str, Any]) -> Iterator[str]:
    """Yield the keys of all tables of a schema."""
    for key, value in schema.get("properties", {}).items():
        yield key
        yield from keys(value)
    items, others = schema.get("items"), schema.get("additionalProperties")
    for inner in (items, others, *schema.get("oneOf", ()), *schema.get("anyOf", ())):
        if isinstance(inner, dict):
            yield from keys(inner)


@pytest.mark.parametrize(("count", "moving"), [(0, 0), (4, 0), (4, 4), (30, 3)])
def test_so_many_obstacles_are_scattered_and_so_many_of_them_move(count: int, moving: int) -> None:
    changes = {"world.scatter.count": count, "world.scatter.moving": moving}
    world = make_world(read_scenario(BASE, Path("s.toml"), changes))
    assert (len(world.circles), len(world.moving)) == (count - moving, moving)


def test_of_more_obstacles_the_first_are_the_same() -> None:
    few, many = (
        make_world(read_scenario(BASE, Path("s.toml"), {"world.scatter.count": count})).circles
        for count in (4, 9)
    )
    assert many[:4].tolist() == few.tolist()


@pytest.mark.parametrize("key", ["bindings.D.period", "faults.D.until", "devices.D.period"])
def test_a_module_that_is_not_there_is_refused_where_it_is_varied(key: str) -> None:
    text = f'{BASE}[devices.C]\nkind = "joystick"\n'
    found = refusal(trial, text, changes={key: 1})
    assert (found.span.path.split()[0], found.severity) == ("--vary", "error")
    assert "`D`" in found.message


def test_a_changed_value_is_placed_at_its_change() -> None:
    text = BASE + "[requirements]\nclearance = 50\nno_collision = true\n"
    places = read_scenario(text, Path("s.toml"), {"requirements.clearance": 900}).places
    assert places["clearance"].location == "--vary requirements.clearance=900"
    assert places["no_collision"].path == "s.toml"
