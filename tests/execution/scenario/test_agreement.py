"""A scenario and a specification that are about different modules."""

import pytest

from tests.support.refusals import refusals
from tests.support.trials import BASE, trial

ROBOT = """\
@specification
@modules P, Sonar, C, Arm, Map
Map uses_data_from Sonar
C uses_data_from Map
P is_controlled_by C
Arm is_controlled_by Turner
@module_start
@module_name Camera
@Sense NotifyWhenReady
Image image();
@Sense NotifyWhenReady
Depth depth();
@module_end
"""
GOOD = {
    "Sonar": '[devices.Sonar]\nkind = "sonar"\n',
    "Arm": '[devices.Arm]\nkind = "joint"\n',
    "Turner": '[devices.Turner]\nkind = "joystick"\n',
    "Map": '[bindings.Map]\npython = "b.py:f"\n',
    "C": '[bindings.C]\npython = "b.py:f"\n',
}


def remarks(robot: str = ROBOT, **changed: str) -> list[tuple[int, str, str, str | None]]:
    """Return line, severity, message and help of all that is reported of a scenario."""
    text = BASE + "".join({**GOOD, **changed}.values())
    return [(d.span.line, d.severity, d.message, d.help) for d in refusals(trial, text, robot)]


@pytest.mark.parametrize(
    ("name", "table", "message", "help_text"),
    [
        (
            "Sonar",
            '[devices.Sonr]\nkind = "sonar"\n',
            "`devices` names `Sonr`, which is not a module of the specification",
            "did you mean `Sonar`?",
        ),
        (
            "Map",
            '[bindings.Mapp]\npython = "b.py:f"\n',
            "`bindings` names `Mapp`, which is not a module of the specification",
            "did you mean `Map`?",
        ),
        (
            "Arm",
            '[devices.Arm]\nkind = "sonar"\n',
            "`Arm` obeys commands, and a sonar does not",
            "use a joint or a gripper",
        ),
        (
            "Sonar",
            '[devices.Sonar]\nkind = "joint"\n',
            "a joint obeys commands, and `Sonar` does not (sensor)",
            "give it another kind",
        ),
        (
            "Map",
            '[devices.Map]\nkind = "lidar"\n',
            "`Map` uses data from `Sonar`, and a lidar has no inputs",
            "bind `Map` to a function",
        ),
        (
            "Turner",
            '[devices.Turner]\nkind = "bumper"\n',
            "`Turner` sends commands, and a bumper measures",
            "describe `Turner` with `@Sense`, or bind it to a function",
        ),
        (
            "Arm",
            '[devices.Arm]\nkind = "platform"\n',
            "`Arm` is a platform, and `P` moves the robot",
            "give it another kind",
        ),
        (
            "more",
            '[devices.P]\nkind = "joint"\n',
            "`P` moves the robot, and a joint does not",
            "remove the device",
        ),
        (
            "more",
            '[faults.Mao]\nkind = "silent"\n',
            "`Mao` is not a module of the specification",
            "did you mean `Map`?",
        ),
    ],
)
def test_tables_that_do_not_fit_the_robot_are_errors(
    name: str, table: str, message: str, help_text: str
) -> None:
    ((line, *found),) = remarks(**{name: table})
    assert found == ["error", message, help_text]
    text = (BASE + "".join({**GOOD, name: table}.values())).splitlines()
    assert text[line - 1] == table.splitlines()[0]


def test_all_are_reported_at_once() -> None:
    wrong = {"Sonar": '[devices.Sonr]\nkind = "sonar"\n', "Map": '[devices.Map]\nkind = "lidar"\n'}
    assert len(remarks(**wrong, more='[faults.Mao]\nkind = "silent"\n')) == 3


def test_modules_of_other_specifications_are_warnings(tmp_path: object) -> None:
    made = trial(BASE + '[devices.C]\nkind = "joystick"\n[devices.Far]\nkind = "lidar"\n')
    (found,) = made.remarks
    assert (found.severity, found.span.line, found.help) == (
        "warning",
        6,
        "remove it, or add the module",
    )


def test_the_parts_of_a_module_are_named() -> None:
    robot = ROBOT.replace("Arm, Map", "Arm, Map, Camera, Log").replace(
        "C uses", "Log uses_data_from Camera.image\nC uses"
    )
    ((_, severity, message, help_text),) = remarks(robot, more='[devices.Camera]\nkind = "marks"\n')
    assert (severity, message.split("`")[3]) == ("error", "Camera")
    assert help_text == "it runs in parts: Camera.depth, Camera.image"
