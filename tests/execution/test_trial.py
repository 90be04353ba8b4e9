"""A specification in a scenario: bindings, motion, and the effects of faults."""

from math import dist
from pathlib import Path

import pytest

from mars_asp.diagnostic import MarsError
from tests.support.refusals import refusal, refusals
from tests.support.trials import BASE, DRIVE, HAND, trial


def test_a_joystick_drives_a_platform() -> None:
    made = trial(BASE + HAND)
    assert made.bodies[0].driven == pytest.approx(600)
    assert made.control_time == {"C": pytest.approx(3)}


def test_a_world_without_room_for_its_circles_is_reported() -> None:
    with pytest.raises(MarsError, match="finds no room for 100000 circles") as raised:
        trial(f"{BASE}{HAND}[world]\nscatter = {{ count = 100_000, within = 10, free = 900 }}\n")
    (found,) = raised.value.diagnostics
    assert (found.span.line, found.help) == (8, "lower `free` or `radius`, or raise `within`")


def test_scattered_circles_leave_starts_places_and_marks_free() -> None:
    world = "scatter = { count = 12, within = 1500, free = 400 }"
    marks = 'marks = [{ at = [0, 1200], colour = "red" }]'
    required = "[requirements]\nreach = { at = [1200, 0] }\n"
    for seed in range(20):
        text = f"seed = {seed}\n{BASE}{HAND}[world]\n{world}\n{marks}\n{required}"
        made = trial(text.replace("duration = 3", "duration = 0.1"))
        for x, y, radius in made.bodies[0].world.circles:
            for place in ((0, 0), (1200, 0), (0, 1200)):
                assert dist((x, y), place) - radius >= 400


def test_unbound_modules_are_reported_together_before_the_run() -> None:
    assert sorted(
        d.message.split("`")[1]
        for d in refusals(trial, BASE, DRIVE.replace("P, C", "P, C, D") + "P is_controlled_by D\n")
    ) == ["C", "D"]


FAULTS = [
    ('kind = "silent", from = 1, until = 2', 21, 0),
    ('kind = "throwing", from = 1, until = 2', 21, 10),
    ('kind = "stuck", from = 1, until = 2', 31, 0),
    ('kind = "babbling", by = 10', 301, 0),
    ('kind = "late", by = 50', 30, 0),
]


@pytest.mark.parametrize(("fault", "delivered", "failed"), FAULTS)
def test_injected_faults(fault: str, delivered: int, failed: int) -> None:
    made = trial(f"{BASE}{HAND}[faults]\nC = {{ {fault} }}\n")
    link = made.executor.links[0]
    assert (link.delivered, link.dropped["failed"]) == (delivered, failed)


def test_a_scenario_declares_a_processing_delay(tmp_path: Path) -> None:
    (tmp_path / "b.py").write_text("def go():\n    return 'Trans_Z', 100\n")
    binding = '[bindings.C]\npython = "b.py:go"\nperiod = 100\n'
    driven = [
        trial(BASE + binding + delay, folder=tmp_path).bodies[0].driven
        for delay in ("", "delay = 500\n")
    ]
    assert driven == pytest.approx([300, 250])


def test_a_condition_on_a_value_other_than_a_number_fails_the_run() -> None:
    screen = "@specification\n@modules P, S, A\nA uses_data_from S NotifyOnMax(3)\n"
    made = trial(BASE + '[devices.S]\nkind = "odometry"\n', screen)
    assert [failures.count for failures in made.executor.failures.values()] == [31]
    assert list(made.executor.failures) == ["S -> A"]


@pytest.mark.parametrize(
    ("robot", "message"),
    [
        ("S", "the robot's `module` is an effector, and `S` is not (sensor)"),
        ("C", "the robot's `module` is an effector, and `C` is not (control out)"),
        ("G", "the robot's `module` moves, and `G` has no motion function"),
        ("Q", "`Q` is not a module of the specification"),
    ],
)
def test_a_module_that_cannot_move_is_refused_as_a_robot(robot: str, message: str) -> None:
    blocks = "".join(
        f"@module_start\n@module_name {name}\n{annotation}\n@module_end\n"
        for name, annotation in (("S", "@Sense RequestWhenReady\nMap look();"), ("G", "@Grasp"))
    )
    text = DRIVE.replace("P, C", "P, C, S, G") + blocks
    found = refusal(trial, f'duration = 3\n[robot]\nradius = 9\nmodule = "{robot}"\n{HAND}', text)
    assert (found.message, found.span.line, found.span.column) == (message, 4, 1)


def test_a_module_with_nothing_to_run_it_is_reported_where_it_is_named() -> None:
    found = refusal(trial, BASE)
    assert (found.span.line, found.span.column) == (2, 13)


@pytest.mark.parametrize(("name", "message"), [("P", "run by a Python"), ("Cc", "a module of")])
def test_a_fault_that_nothing_has_is_refused(name: str, message: str) -> None:
    with pytest.raises(MarsError, match=f"is not {message}") as raised:
        trial(f'{BASE}{HAND}[faults.{name}]\nkind = "silent"\n')
    assert raised.value.diagnostics[0].span.line == 7


def test_a_device_without_a_kind_is_refused() -> None:
    with pytest.raises(MarsError, match="`C` has no `kind`"):
        trial(BASE + "[devices.C]\nperiod = 3\n")
