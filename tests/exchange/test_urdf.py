"""URDF: documents as mounts and functions, and the same frames after a round trip."""

import json
import math
import re
from decimal import Decimal
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pytransform3d.urdf import UrdfTransformManager

from mars_asp.cli import run_here
from mars_asp.diagnostic import MarsError, point
from mars_asp.exchange.recognise import recognised
from mars_asp.exchange.urdf import MOST_BYTES, export_urdf, import_urdf, left_out
from mars_asp.exchange.urdf.angles import rotation_of, turns_of
from mars_asp.kinematics.frames import Joint, Matrix, build_robot, take_posture
from mars_asp.language import parse_text, print_configuration
from mars_asp.model.declarations import MOTION_FUNCTIONS, Configuration, Function, Module, Mount
from mars_asp.reasoning.facts.motion import frames
from tests.support.campaigns import examples
from tests.support.documents import ROOT, run
from tests.support.fixtures import Captured
from tests.support.processes import mars
from tests.support.refusals import refusals
from tests.support.robots import HERE, module, placed, robot

FOLDER = ROOT / "tests" / "urdf"
FILES = sorted(FOLDER.glob("*.urdf"))
thorough = settings(max_examples=examples(20, 60), deadline=None, derandomize=True)


def imported(text: str) -> Configuration:
    """Return the configuration of a document, printed and read again, as a user gets it."""
    return parse_text(
        print_configuration(import_urdf(text, "a.urdf").configuration), "a.mars"
    ).configuration


def poses(configuration: Configuration) -> dict[str, Matrix]:
    return {name: matrix for name, (_, matrix) in frames(configuration, {}).items()}


def functions(configuration: Configuration) -> dict[str, tuple[object, ...]]:
    return {
        f"{m.name} {f.name}": (f.min, f.max, f.rate)
        for m in configuration.declared
        for f in m.functions
    }


# ---- what a document means: the frames that pytransform3d finds, at rest and in motion ----

AXES = {"1 0 0": "X", "0 2 0": "Y", "0 0 1": "Z"}
angles = st.one_of(
    st.sampled_from([0.0, math.pi / 2, -math.pi / 2, math.pi, 1.5707963267948961, 1e-5]),
    st.floats(-7, 7),
)
lengths = st.sampled_from([0.0, 0.25, -0.0375]) | st.floats(-2, 2)
threes = st.tuples(lengths, lengths, lengths)
directions = st.sampled_from([*AXES, "-1 0 0", "0 -1 0", "0 0 -0.5", "1 1 0", "0.3 -0.4 1.2"])


@st.composite
def documents(draw: st.DrawFn) -> tuple[str, dict[str, tuple[str, str, float]]]:
    """Return a document and, for each joint that moves, its kind, axis and a value."""
    count = draw(st.integers(1, 6))
    parts, moving = [f'<link name="L{n}"/>' for n in range(count + 1)], {}
    for n in range(count):
        kind = draw(st.sampled_from(["fixed", "revolute", "continuous", "prismatic"]))
        axis = draw(directions)
        xyz, rpy = draw(threes), draw(st.tuples(angles, angles, angles))
        parts.append(
            f'<joint name="J{n}" type="{kind}"><parent link="L{draw(st.integers(0, n))}"/>'
            f'<child link="L{n + 1}"/><axis xyz="{axis}"/>'
            f'<origin xyz="{xyz[0]!r} {xyz[1]!r} {xyz[2]!r}"'
            f' rpy="{rpy[0]!r} {rpy[1]!r} {rpy[2]!r}"/></joint>'
        )
        if kind != "fixed":
            moving[f"J{n}"] = (kind, axis, draw(st.floats(-3, 3)))
    return f'<robot name="r">{"".join(parts)}</robot>', moving


def pose(oracle: UrdfTransformManager, name: str, root: str) -> Matrix:
    found = np.array(oracle.get_transform(name, root)[:3])
    found[:, 3] *= 1000
    return found


@thorough
@given(documents())
def test_frames_are_those_that_pytransform3d_finds(
    document: tuple[str, dict[str, tuple[str, str, float]]],
) -> None:
    text, moving = document
    oracle = UrdfTransformManager()
    oracle.load_urdf(text)
    found = imported(text)
    known = {m.name: m for m in found.declared}
    mounts = [r for r in found.relationships if isinstance(r, Mount)]
    values: dict[Joint, float] = {}
    for turned in (False, True):
        for joint, (kind, axis, value) in moving.items() if turned else ():
            oracle.set_joint(joint, value)
            slides = kind == "prismatic"
            owner = f"L{int(joint[1:]) + 1}" if axis in AXES else joint
            function = f"{'Trans' if slides else 'Rotn'}_{AXES.get(axis, 'Z')}"
            values[Joint(owner, function)] = value * 1000 if slides else math.degrees(value)
        posture = take_posture(build_robot(mounts, known), values)
        moved = {f"L{int(j[1:]) + 1}" for j, (_, axis, _) in moving.items() if axis in AXES}
        for name in (n.text for n in found.modules if n.text.startswith("L")):
            should = pose(oracle, name, "L0")
            if not (turned and name in moved):  # its own function moves the modules on it
                assert np.abs(posture.poses[name][:3] - should).max() < 1e-9


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.name)
def test_frames_of_files_agree_with_pytransform3d(path: Path) -> None:
    text = path.read_text()
    oracle = UrdfTransformManager()
    oracle.load_urdf(text)
    found = import_urdf(text, path.name).configuration
    root = found.modules[0].text
    for name, matrix in poses(found).items():
        if name in oracle.nodes:
            assert np.abs(matrix - pose(oracle, name, root)).max() < 1e-9


# ---- what becomes of joints ----


def test_joints_become_functions_with_limits() -> None:
    text = (FOLDER / "pan_tilt.urdf").read_text()
    found = imported(text)
    names = [name.text for name in found.modules]
    assert names == ["base", "pan", "tilt", "camera_eye", "_2nd_eye"]
    assert functions(found) == {
        "pan Rotn_Y": (-90, Decimal("57.2957795130823"), Decimal("114.5915590261646")),
        "tilt Rotn_X": (None, None, Decimal("85.9436692696235")),
    }
    mounts = {r.mounting: r for r in found.relationships if isinstance(r, Mount)}
    assert mounts["pan"].transformation == placed([("y", 90)], 0, 250, 0)
    assert mounts["tilt"].transformation == placed((), 0, 50, 100)
    assert mounts["camera_eye"].mounting_vertex == 1, "three turns need a vertex"
    assert mounts["_2nd_eye"].mounting_vertex is None


def test_angles_have_no_more_digits_than_the_document(update_golden: bool) -> None:
    text, expected = (FOLDER / "digits.urdf").read_text(), FOLDER / "digits.mars"
    printed = print_configuration(import_urdf(text, "digits.urdf").configuration)
    if update_golden:
        expected.write_text(printed)
    assert printed == expected.read_text()


def test_other_axes_become_modules_of_their_own() -> None:
    found = imported((FOLDER / "slide.urdf").read_text())
    names = [name.text for name in found.modules]
    assert names == ["rail", "sled", "wheel", "push", "push_2", "roll"]
    assert functions(found) == {
        "push_2 Trans_Z": (-100, 500, 200),
        "roll Rotn_Z": (None, None, None),
        "push Trans_Z": (None, None, None),
    }


def test_omitted_attributes_have_the_defaults_of_urdf() -> None:
    parsed = import_urdf((FOLDER / "gripper.urdf").read_text(), "g.urdf")
    assert functions(parsed.configuration) == {
        "left Trans_Y": (0, 40, None),
        "right Trans_Y": (0, 40, None),
    }
    mimic, angle = sorted(parsed.warnings, key=lambda d: d.code, reverse=True)
    assert (mimic.code, mimic.span.line, mimic.span.column) == ("urdf-mimic", 10, 3)
    assert angle.code == "urdf-angle"
    assert "3.141592653589793" in (angle.help or "")


#: A joint that moves in more than one way, and the motions that it gives its child.
SEVERAL = [
    ("planar", "0 0 1", {"pan": ["Trans_X", "Trans_Y", "Rotn_Z"]}),
    ("planar", "0 1 0", {"pan": ["Trans_X", "Trans_Z", "Rotn_Y"]}),
    ("planar", "0 0 -1", {"slide": ["Trans_X", "Trans_Y", "Rotn_Z"]}),
    ("floating", "1 1 0", {"pan": [f"{k}_{a}" for k in ("Trans", "Rotn") for a in "XYZ"]}),
]


@pytest.mark.parametrize(("kind", "axis", "motions"), SEVERAL)
def test_joints_that_move_in_several_ways(
    kind: str, axis: str, motions: dict[str, list[str]]
) -> None:
    text = (
        '<robot name="r"><link name="base"/><link name="pan"/>'
        f'<joint name="slide" type="{kind}"><parent link="base"/><child link="pan"/>'
        f'<axis xyz="{axis}"/><limit lower="0" upper="1" velocity="1"/></joint></robot>'
    )
    found = imported(text).declared
    assert {m.name: [f.name for f in m.functions] for m in found} == motions
    assert all((f.min, f.max, f.rate) == (None, None, None) for m in found for f in m.functions)


def test_repetitions_by_exporters_are_remarked_once() -> None:
    joints = "".join(
        f'<link name="l{n}"/><joint name="j{n}" type="revolute"><parent link="l{n - 1}"/>'
        f'<child link="l{n}"/><origin rpy="1.5708 0 -1.5708"/><mimic joint="j1"/></joint>'
        for n in range(1, 8)
    )
    found = import_urdf(f'<robot name="r"><link name="l0"/>{joints}</robot>', "a.urdf").warnings
    assert [warning.message for warning in found] == [
        "7 joints follow others, but are imported as independent",
        "14 angles are nearly quarter turns, and are used as written",
    ]
    assert [[label for _, label in warning.labels] for warning in found] == [
        ["`j2` follows `j1`", "`j3` follows `j1`", "`j4` follows `j1`, and 3 more"],
        ["`-1.5708`", "`1.5708`", "`-1.5708`, and 10 more"],
    ]


def test_a_document_is_a_robot_to_every_verb(tmp_path: Path, capsys: Captured) -> None:
    arm = tmp_path / "arm.xml"
    joint = '<parent link="base"/><child link="arm"/><axis xyz="0 0 1"/>'
    arm.write_text(
        '<?xml version="1.0"?><!-- by xacro --><robot name="r"><link name="base"/>\n'
        '<link name="arm"/><link name="tip"/>\n'
        f'<joint name="a" type="continuous">{joint}</joint>\n'
        '<joint name="b" type="fixed"><parent link="tip"/><child link="base"/></joint></robot>\n',
        encoding="utf-8",
    )
    assert run_here(["analyse", str(arm), "--format", "json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert sorted(found["frames"]) == ["arm", "base", "tip"]
    assert run_here(["synthesise", str(arm)]) == 0
    assert "arm is_mounted_on base" in capsys.readouterr().out
    assert run_here(["check", str(arm), str(FILES[0])]) == 2
    assert "is a second document" in capsys.readouterr().out


# ---- round trips ----


def bounds_of(configuration: Configuration) -> list[float | None]:
    listed = sorted(functions(configuration).items())
    return [None if x is None else float(str(x)) for _, three in listed for x in three]


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.name)
def test_files_survive_the_round_trip(path: Path) -> None:
    first = imported(path.read_text())
    second = imported(export_urdf(first, {}))
    assert {n.text for n in second.modules} == {n.text for n in first.modules}
    before, after = poses(first), poses(second)
    for name, matrix in before.items():
        assert np.abs(after[name] - matrix).max() < 1e-9
    assert functions(first).keys() == functions(second).keys()
    for one, other in zip(bounds_of(first), bounds_of(second), strict=True):
        assert one == other if one is None else other == pytest.approx(one, rel=1e-12)


turns = st.tuples(
    st.sampled_from("xyz"),
    st.sampled_from([90, -90, 180, 270, 0]).map(Decimal)
    | st.decimals(-400, 400, places=6)
    | st.floats(-1e-5, 1e-5).map(lambda small: round(Decimal(90 + small), 12)),
)
shifts = st.decimals(-3000, 3000, places=4) | st.just(Decimal(0))
placements = st.builds(
    lambda around, shift: placed(around, *shift),
    st.lists(turns, max_size=2),
    st.tuples(shifts, shifts, shifts),
)


@st.composite
def trees(draw: st.DrawFn) -> Configuration:
    count = draw(st.integers(1, 7))
    mounts, modules = [], []
    for n in range(count + 1):
        names = draw(st.lists(st.sampled_from(MOTION_FUNCTIONS), max_size=3, unique=True))
        bound = draw(st.sampled_from([(None, None), (-90, 45), (-20, None), (None, 7.5)]))
        low, high = (None if x is None else Decimal(str(x)) for x in bound)
        own = tuple(
            Function(name, HERE, low, high, draw(st.none() | st.decimals("0.001", 3000, places=4)))
            for name in names
        )
        at = module("M", v1=draw(placements), v3=draw(placements)).vertices
        modules.append(Module(f"M{n}", HERE, functions=own, vertices=at))
        if n:
            carrier, vertices = draw(st.integers(0, n - 1)), st.sampled_from([None, 0, 1, 3])
            mounts.append(
                Mount(
                    f"M{n}", f"M{carrier}", HERE, draw(vertices), draw(vertices), draw(placements)
                )
            )
    return robot(mounts, modules)


@thorough
@given(trees())
def test_configurations_survive_the_round_trip(first: Configuration) -> None:
    text = export_urdf(first, {})
    second = imported(text)
    third = imported(export_urdf(second, {}))
    before = poses(first)
    for after in (poses(second), poses(third)):
        for name, matrix in before.items():
            assert np.abs(after[name] - matrix).max() < 1e-9
    given_functions = [f for m in first.declared for f in m.functions]
    assert sorted(f.name for f in given_functions) == sorted(
        f.name for m in third.declared for f in m.functions
    )
    assert sum(f.min is None for f in given_functions) == sum(
        f.min is None for m in third.declared for f in m.functions
    )


@thorough
@given(st.lists(turns, max_size=4))
def test_turns_make_up_the_rotation_they_were_found_from(around: list[tuple[str, Decimal]]) -> None:
    matrix = rotation_of(tuple(around))
    found = turns_of(matrix)
    assert np.abs(rotation_of(found) - matrix).max() < 1e-12
    assert len(found) <= 3
    if all(degrees % 90 == 0 for _, degrees in around):
        assert len(found) <= 2
        assert (rotation_of(found) == matrix).all()


def test_exported_links_have_names_of_their_own() -> None:
    table = [module("A", "Trans_X", "Trans_Y"), module("A__0", "Rotn_X", "Rotn_Y")]
    text = export_urdf(robot([Mount("A__0", "A", HERE)], table), {})
    found = imported(text)
    assert len({name.text for name in found.modules}) == 5


# ---- what is refused ----

GOOD = """<robot name="r">
  <link name="base"/><link name="head"/>
  <joint name="pan" type="revolute">
    <parent link="base"/>
    <child link="head"/>
    <origin xyz="0 0 0.25"/>
    <axis xyz="0 1 0"/>
    <limit lower="-1" upper="1" velocity="2"/>
  </joint>
</robot>"""


DAMAGE = [
    "",
    '"',
    "<",
    ">",
    "/",
    "&",
    "&lt;",
    "\0",
    "\r",
    "é",
    "-",
    "1e400",
    "0x1",
    " ",
    "<link/>",
    "]]>",
]


@pytest.mark.parametrize(
    ("change", "place", "message"),
    [
        (("<robot", '<!DOCTYPE r [<!ENTITY a "b">]><robot'), (1, 1), "document type"),
        (("<robot", '<!DOCTYPE r SYSTEM "file:///etc/passwd"><robot'), (1, 1), "document type"),
        (("</robot>", ""), (10, 1), "not XML"),
        (('"revolute"', '"screw"'), (3, 3), "joint `pan` is `screw`"),
        (('"revolute"', '"revolut"'), (3, 3), "did you mean `revolute`"),
        ((' type="revolute"', ""), (3, 3), "has no type"),
        (('    <parent link="base"/>\n', ""), (3, 3), "has no parent"),
        (('child link="head"', 'child link="haed"'), (5, 5), "did you mean `head`"),
        (("0 0 0.25", "0 0"), (6, 5), "three numbers"),
        (("0 0 0.25", "0 0 nan"), (6, 5), "three numbers"),
        (("0 0 0.25", "0 0 1e9"), (6, 5), "three numbers"),
        (("0 0 0.25", "0 0 1_0"), (6, 5), "three numbers"),
        (("0 0 0.25", "0 " * 10**6), (6, 5), "three numbers"),
        (("0 1 0", "0 0 0"), (7, 5), "length zero"),
        (('"-1"', '"low"'), (8, 5), '`lower="low"` is not a number'),
        (('"-1"', '"7"'), (8, 5), "above the upper"),
        (('"2"', '"-2"'), (8, 5), "below 0"),
        (('name="head"', 'name="base"'), (2, 22), "a second link named `base`"),
        (('name="pan"', 'name=""'), (3, 3), "a joint without a name"),
        (("</robot>", "<xacro:arm/></robot>"), (10, 1), "macro"),
        ((GOOD, '<!-- empty -->\n<robot name="r"/>'), (2, 1), "no links"),
        (('parent link="base"', 'parent link="head"'), (3, 3), "lead back to `head`"),
    ],
)
def test_each_fault_is_refused_at_its_location(
    change: tuple[str, str], place: tuple[int, int], message: str
) -> None:
    text = GOOD.replace(*change, 1)
    assert text != GOOD
    entries = {
        (d.span.line, d.span.column): f"{d.message} {d.help}"
        for d in refusals(import_urdf, text, "bad.urdf")
    }
    assert message in entries[place]
    assert all(len(line) < 500 for line in entries.values())


#: Texts that may precede the root or make a document unreadable: it is detected as URDF still.
BEGINNINGS = [
    "\ufeff",
    "<?xml version='1.0'?>\n",
    "<!-- <launch> - -->",
    "<!DOCTYPE robot>",
    "\ufeff<?xml version='1.0'?><!-- x -->\n<!DOCTYPE r SYSTEM 'file:///etc/passwd'>",
    "<!DOCTYPE r [<!-- it's --><!ENTITY a '<b>'>]>\n<!-- b -->",
    "<!DOCTYPE r [" + "<!--" * 60_000,
]


@pytest.mark.parametrize("beginning", BEGINNINGS, ids=range(len(BEGINNINGS)))
def test_documents_are_recognised_whatever_they_begin_with(beginning: str) -> None:
    assert recognised(f"{beginning}{GOOD}") == "urdf"
    assert recognised(f"{beginning}<launch/>") == "ros2"
    assert recognised(f"{beginning}<html/>") == "mars"


def test_all_errors_are_reported_at_once() -> None:
    text = GOOD.replace("0 0 0.25", "far").replace("0 1 0", "0 0 0").replace('"-1"', '"low"')
    assert [
        d.span.line
        for d in refusals(
            import_urdf,
            text.replace("<robot", "<roboter").replace("</robot", "</roboter"),
            "bad.urdf",
        )
    ] == [1, 6, 7, 8]


@thorough
@given(st.data())
def test_a_damaged_document_is_refused_or_read(data: st.DataObject) -> None:
    """A damaged text gives documented errors only."""
    text = GOOD
    for _ in range(data.draw(st.integers(1, 4))):
        begin = data.draw(st.integers(0, len(text)))
        end = begin + data.draw(st.sampled_from([0, 1, 1, 5, 40]))
        text = text[:begin] + data.draw(st.sampled_from(DAMAGE)) + text[end:]
    try:
        found = import_urdf(text, "bad.urdf").configuration
    except MarsError as error:
        lines = text.count("\n") + text.count("\r") + 1
        assert all(1 <= d.span.line <= lines and d.span.column > 0 for d in error.diagnostics)
    else:
        parse_text(print_configuration(found), "a.mars")


def test_loops_of_joints_are_refused() -> None:
    joint = '<joint name="{}" type="fixed"><parent link="{}"/><child link="{}"/></joint>'
    links = "".join(f'<link name="{name}"/>' for name in "abc")
    ring = [joint.format(name, *ends) for name, ends in zip("xyz", ("ab", "bc", "ca"), strict=True)]
    with pytest.raises(MarsError, match="lead back to `a`"):
        import_urdf(f"<robot>{links}{''.join(ring)}</robot>", "ring.urdf")
    twice = [joint.format("x", "a", "c"), joint.format("y", "b", "c")]
    with pytest.raises(MarsError, match="`c` is the child of `x` and of `y`"):
        import_urdf(f"<robot>{links}{''.join(twice)}</robot>", "twice.urdf")


def test_depth_and_many_entities_cost_nothing() -> None:
    deep = "<a>" * 100_000 + "</a>" * 100_000
    [note] = import_urdf(f'<robot><link name="l"/>{deep}</robot>', "deep.urdf").warnings
    assert note.message == "elements besides links and joints not read: 1 (`a`)"
    laughs = "".join(f'<!ENTITY l{n} "&l{n - 1};&l{n - 1};">' for n in range(1, 60))
    with pytest.raises(MarsError, match="document type"):
        import_urdf(f'<!DOCTYPE r [<!ENTITY l0 "ha">{laughs}]><robot>&l59;</robot>', "l.urdf")


def test_export_needs_one_tree() -> None:
    with pytest.raises(MarsError, match="2 roots, `B`, `D`"):
        export_urdf(robot([Mount("A", "B", HERE), Mount("C", "D", HERE)], ()), {})
    with pytest.raises(MarsError, match="nothing is mounted"):
        export_urdf(Configuration("a.mars", point("a.mars", 1, 1)), {})
    ring = [Mount("A", "B", HERE), Mount("B", "A", HERE), Mount("C", "D", HERE)]
    with pytest.raises(MarsError, match="do not lead to a root"):
        export_urdf(robot(ring, ()), {})
    with pytest.raises(MarsError, match="mounted twice"):
        export_urdf(robot([Mount("A", "B", HERE), Mount("A", "B", HERE)], ()), {})


def test_zeros_have_no_sign() -> None:
    written = "@configuration\n@modules B, A, C\nA is_mounted_on B (x,180,_,_,-0.0,-0,5)\n"
    written += "C is_mounted_on A (x,-90,z,-180,0,-0.0,0)\n"
    written += "@module_start\n@module_name A\n@Rotn_Z -0.0 5\n@Trans_X -5 -0\n@module_end\n"
    configuration = parse_text(written, "z.mars").configuration
    exported = export_urdf(configuration, {m.name: m for m in configuration.declared})
    assert not re.search(r"-0(\.0)?[ \"]", exported)
    assert "@Rotn_Z 0 5" in print_configuration(configuration)
    negative = exported.replace('"0 0 0.005"', '"-0.0 -0 0.005"').replace('"0"', '"-0.0"')
    assert negative != exported
    assert not re.search(r"-0(\.0)?[ ,)\n]", print_configuration(imported(negative)))


def test_an_export_lists_the_lines_that_it_leaves_out(update_golden: bool) -> None:
    file, expected = FOLDER / "left_out.mars", FOLDER / "left_out.txt"
    configuration = parse_text(file.read_text(), file.name).configuration
    notes = (*left_out(configuration, {}),)
    text = "".join(f"{d.span}: {d.message} [{d.kind}]\n" for d in notes)
    if update_golden:
        expected.write_text(text)
    assert text == expected.read_text()


# ---- the verbs ----


def test_an_export_prints_its_notes_unless_it_is_quiet(capsys: Captured) -> None:
    words = ["export", "urdf", str(ROOT / "examples" / "gripper-arm" / "config.mars")]
    assert run_here(words) == 0
    output = capsys.readouterr()
    assert output.out.startswith("<robot")
    shown = " ".join(output.err.split())
    assert "config.mars:10:1: note: annotations `@Grasp` not exported: 1 (`Gripper`)" in shown
    assert run_here([*words, "--quiet"]) == 0
    assert capsys.readouterr() == (output.out, "")


def test_the_verbs_export_and_import_an_example(tmp_path: Path) -> None:
    exported = run("mars-asp export urdf examples/gripper-arm/config.mars --quiet")
    found = poses(imported(exported))
    assert found["Gripper"].tolist() == [[0, 0, 1, 350], [0, 1, 0, 250], [-1, 0, 0, 150]]
    target = tmp_path / "arm.mars"
    done = mars("import", "urdf", "-", "-o", str(target), text=exported)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    assert mars("check", str(target)).returncode == 0


@pytest.mark.parametrize(
    ("words", "text", "mentions"),
    [
        (["import", "urdf", "-"], "<robot>", "<stdin>:1:8: error: the file is not XML"),
        (["import", "urdf", "missing.urdf"], None, "missing.urdf"),
        (["import", "urdf", "-"], "<robot>" + " " * MOST_BYTES, f"larger than {MOST_BYTES}"),
        (["export", "urdf", "-"], "@configuration\n@modules A\n", "nothing is mounted"),
    ],
)
def test_mistakes(words: list[str], text: str | None, mentions: str) -> None:
    done = mars(*words, text=text)
    assert done.returncode == 2
    assert mentions in done.stderr
    assert "Traceback" not in done.stderr


TURNTABLE = """\
<?xml version="1.0"?>
<!-- A plate that turns under a sensor. -->
<robot name="r">
  <link name="base"/>
  <link name="plate"/>
  <joint name="turn" type="continuous">
    <parent link="base"/><child link="plate"/><axis xyz="0 0 1"/>
  </joint>
  <link name="loose"/>
</robot>
"""
MUX = """\
twist_mux:
  ros__parameters:
    topics:
      joy: {topic: a, priority: 2, timeout: 0.5}
      nav: {topic: b, priority: 1, timeout: 0.5}
"""


def test_a_document_is_a_file_of_every_verb(tmp_path: Path, capsys: Captured) -> None:
    file, other, mux = (tmp_path / name for name in ("r.urdf", "other.xml", "mux.yaml"))
    file.write_text(TURNTABLE)
    other.write_text(TURNTABLE)
    mux.write_text(MUX)
    assert run_here(["analyse", str(file), "--format", "json"]) == 0
    (found,) = json.loads(capsys.readouterr().out)["consequences"]
    assert (found["kind"], found["subject"]) == ("unused_module", "loose")
    assert found["locations"][0]["path"] == str(file)
    assert run_here(["can", str(file), "Rotn_Z of plate"]) == 0
    assert f"{file.name}:6" in capsys.readouterr().out
    assert run_here(["synthesise", str(file)]) == 0
    assert capsys.readouterr().out.endswith("@module_name plate\n@Rotn_Z\n@module_end\n")
    for files in ([file, mux], [mux, file]):
        assert run_here(["synthesise", *map(str, files), "--quiet"]) == 0
        specified = capsys.readouterr().out
        assert specified.startswith("@specification hierarchical\n")
        assert "plate is_mounted_on base\n" in specified
    assert run_here(["check", str(file), str(other)]) == 2
    assert "is a second document" in " ".join(capsys.readouterr().out.split())


def test_a_file_of_xacro_is_refused_once() -> None:
    joint = '<joint name="{0}" type="fixed"><parent link="a"/><child link="{0}"/>{1}</joint>'
    origin = '<origin xyz="0 0 ${h}"/>'
    links = "".join(f'<link name="{name}"/>' for name in "abc")
    text = f"<robot name='r'>{links}{joint.format('b', origin)}{joint.format('c', origin)}</robot>"
    with pytest.raises(MarsError) as refused:
        import_urdf(text, "r.urdf")
    (found,) = refused.value.diagnostics
    assert found.message == '`xyz="0 0 ${h}"` is not expanded: this is a file of xacro'
    assert found.help == "expand it first: `xacro FILE > robot.urdf`"
