"""URDF: what a document says as mounts, and the same frames after a round trip."""

import math
import random

import numpy as np
import pytest

from mars_asp.diagnostic import MarsError
from mars_asp.frames import Matrix
from mars_asp.model import Configuration, Mount
from mars_asp.physical import frames
from mars_asp.urdf import export_urdf, import_urdf
from tests.documents import run
from tests.robots import HERE, module, random_placement, robot

PAN = """<robot name="pan">
  <link name="base"/><link name="head"/><link name="camera-1"/>
  <joint name="pan" type="revolute">
    <parent link="base"/><child link="head"/>
    <origin xyz="0 0 0.25" rpy="0 0 1.5707963267948966"/><axis xyz="0 1 0"/>
    <limit lower="-1.5707963267948966" upper="1" velocity="2" effort="5"/>
  </joint>
  <joint name="plate" type="fixed">
    <parent link="head"/><child link="camera-1"/><origin xyz="0.1 0 0" rpy="0.1 0.2 0.3"/>
  </joint>
</robot>"""

SLIDE = """<robot name="slide">
  <link name="rail"/><link name="sled"/><link name="wheel"/>
  <joint name="push" type="prismatic">
    <parent link="rail"/><child link="sled"/><axis xyz="1 1 0"/>
    <limit lower="0" upper="0.5" velocity="0.2" effort="1"/>
  </joint>
  <joint name="roll" type="continuous"><parent link="sled"/><child link="wheel"/></joint>
</robot>"""


def poses(configuration: Configuration) -> dict[str, Matrix]:
    return {name: matrix for name, (_, matrix) in frames(configuration, {}).items()}


def test_joints_become_modules_with_functions_and_limits() -> None:
    found = import_urdf(PAN, "pan.urdf")
    assert [name.text for name in found.modules] == ["base", "head", "camera_1", "pan"]
    (function,) = next(m for m in found.declared if m.name == "pan").functions
    assert function.name == "Rotn_Z"
    assert function.min == -90
    assert float(function.max or 0) == pytest.approx(math.degrees(1))
    assert float(function.rate or 0) == pytest.approx(math.degrees(2))


def test_frames_are_those_of_the_document() -> None:
    found = poses(import_urdf(PAN, "pan.urdf"))
    assert found["head"].tolist() == [[0, -1, 0, 0], [1, 0, 0, 0], [0, 0, 1, 250]]
    assert found["pan"][:, 2].tolist() == [-1, 0, 0], "the joint's z is its axis"
    sx, cx, sy, cy = math.sin(0.1), math.cos(0.1), math.sin(0.2), math.cos(0.2)
    turned = math.pi / 2 + 0.3  # the head's turn and the plate's yaw are about one axis
    first = [math.cos(turned) * cy, math.sin(turned) * cy, -sy]
    assert found["camera_1"][:, 0] == pytest.approx(first)
    assert found["camera_1"][2] == pytest.approx([-sy, cy * sx, cy * cx, 250])
    assert found["camera_1"][:, 3] == pytest.approx([0, 100, 250])


@pytest.mark.parametrize("text", [PAN, SLIDE])
def test_a_document_survives_the_round_trip(text: str) -> None:
    first = import_urdf(text, "a.urdf")
    second = import_urdf(export_urdf(first, {}), "b.urdf")
    before, after = poses(first), poses(second)
    assert before
    for name, matrix in before.items():
        assert np.abs(after[name] - matrix).max() < 1e-9
    bounds, again = (
        sorted(
            [float(number) for number in (f.min, f.max, f.rate) if number is not None]
            for m in configuration.declared
            for f in m.functions
        )
        for configuration in (first, second)
    )
    assert any(bounds)
    assert [x for one in again for x in one] == pytest.approx([x for one in bounds for x in one])


def test_random_configurations_survive_the_round_trip() -> None:
    chooser = random.Random(11)
    for _ in range(50):
        mounts = [
            Mount(f"M{n}", f"M{n + 1}", HERE, transformation=random_placement(chooser, True))
            for n in range(5)
        ]
        before = robot(mounts, [module("M2", "Rotn_Y", "Trans_X"), module("M4", "Rotn_X")])
        after = poses(import_urdf(export_urdf(before, {}), "b.urdf"))
        for name, matrix in poses(before).items():
            assert np.abs(after[name] - matrix).max() < 1e-9


@pytest.mark.parametrize(
    "text",
    [
        '<!DOCTYPE r [<!ENTITY a "b">]><robot>&a;</robot>',
        '<!DOCTYPE robot SYSTEM "file:///etc/passwd"><robot/>',
        "<robot>",
        '<robot><joint name="j" type="planar"><parent link="a"/><child link="b"/></joint></robot>',
        '<robot><joint name="j" type="fixed"><parent link="a"/></joint></robot>',
        PAN.replace("0 0 0.25", "0 0"),
        PAN.replace("0 0 0.25", "0 0 nan"),
        PAN.replace('<link name="base"/>', ""),
        PAN.replace('<axis xyz="0 1 0"/>', '<axis xyz="0 0 0"/>'),
        PAN.replace('lower="-1.5707963267948966"', 'lower="low"'),
    ],
)
def test_what_is_refused(text: str) -> None:
    with pytest.raises(MarsError):
        import_urdf(text, "bad.urdf")


def test_urdf_has_one_root() -> None:
    with pytest.raises(MarsError, match="2 roots"):
        export_urdf(robot([Mount("A", "B", HERE), Mount("C", "D", HERE)], ()), {})


def test_the_verb_exports_an_example() -> None:
    exported = run("mars-asp export urdf examples/gripper-arm/config.mars")
    found = poses(import_urdf(exported, "arm.urdf"))
    assert found["Gripper"].tolist() == [[0, 0, 1, 350], [0, 1, 0, 250], [-1, 0, 0, 150]]
