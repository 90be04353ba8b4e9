"""Files and programs that launch files name and packages of the workspace do not have."""

from pathlib import Path

import pytest

from mars_asp.cli import run_here
from mars_asp.exchange.ros2 import import_ros2
from tests.support.fixtures import Captured
from tests.support.packages import write_package

PACKAGE = "<package><name>{}</name></package>"


def missing(folder: Path, files: dict[str, str]) -> list[tuple[str, str, bool]]:
    """Return the missing files of a workspace of two packages: name, package, program."""
    given = {"arm/package.xml": PACKAGE.format("arm"), "base/package.xml": PACKAGE.format("base")}
    for name, text in {**given, **files}.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    trees = import_ros2([("", str(folder))]).trees
    return [
        (each.name, each.package, each.sort == "program") for tree in trees for each in tree.missing
    ]


def launch(*lines: str) -> dict[str, str]:
    return {"base/launch/base.launch.xml": "<launch>\n" + "\n".join(lines) + "\n</launch>\n"}


def test_a_broken_file_of_a_mux_is_reported_once(tmp_path: Path, capsys: Captured) -> None:
    mux = '<node pkg="twist_mux" exec="twist_mux" name="{}"><param from="{}"/></node>'
    file = tmp_path / "base" / "launch" / "mux.yaml"
    lines = launch(mux.format("a", file), mux.format("b", file))
    missing(tmp_path, {"base/launch/mux.yaml": "a: [\n", **lines})
    # As any part of a workspace, it is a warning.
    assert run_here(["check", str(tmp_path)]) == 0
    output = "".join(capsys.readouterr())
    assert output.count("this is not YAML") == output.count("warning: this is not YAML") == 1


def test_a_file_elsewhere_in_a_package_of_catkin_is_missing(tmp_path: Path) -> None:
    catkin = PACKAGE.format("arm").replace(
        "</package>", "<buildtool_depend>catkin</buildtool_depend>"
    )
    files = {"arm/config/other/arm.yaml": "a: 1\n", **launch(PARAMETERS)}
    assert missing(tmp_path, files) == []
    files["arm/package.xml"] = f"{catkin}</package>"
    assert missing(tmp_path, files) == [("config/arm.yaml", "arm", False)]
    files["arm/CMakeLists.txt"] = "install(FILES config/other/arm.yaml DESTINATION config)"
    assert missing(tmp_path, files) == []


def test_a_package_of_the_other_ros_is_not_the_one_that_is_named(tmp_path: Path) -> None:
    node = '<node pkg="arm" type="arm_node" name="arm"/>'
    files = {"base/launch/base.launch": f"<launch>{node}</launch>"}
    assert missing(tmp_path, files) == [("arm_node", "arm", True)]
    ament = "<export><build_type>ament_cmake</build_type></export></package>"
    files["arm/package.xml"] = PACKAGE.format("arm").replace("</package>", ament)
    assert missing(tmp_path, files) == []


def test_a_folder_of_a_package_may_be_called_share(tmp_path: Path) -> None:
    lines = launch(PARAMETERS.replace("config/arm.yaml", "share/config/arm.yaml"))
    assert missing(tmp_path, {"arm/share/config/arm.yaml": "a: 1\n", **lines}) == []
    lines = launch(PARAMETERS.replace("config/arm.yaml", "share/arm/config/arm.yaml"))
    assert missing(tmp_path, {"arm/config/arm.yaml": "a: 1\n", **lines}) == []


def test_a_file_beside_a_launch_file_may_be_missing(tmp_path: Path) -> None:
    text = (
        "def generate_launch_description():\n"
        "    return LaunchDescription([IncludeLaunchDescription(\n"
        "        [ThisLaunchFileDir(), '/arm.launch.py']), Node(package='joy', executable='x')])\n"
    )
    files = {"base/launch/base.launch.py": text}
    assert missing(tmp_path, files) == [("launch/arm.launch.py", "base", False)]
    files["base/launch/arm.launch.py"] = text.replace("arm.launch", "base.launch")
    assert missing(tmp_path, files) == []


@pytest.mark.parametrize(("size", "name"), [(2, "launch/x.launch.py"), (3, "x.launch.py")])
def test_the_folder_above_the_folder_above_is_another(size: int, name: str, tmp_path: Path) -> None:
    above = "p.dirname(" * (size - 1) + "p.abspath(p.dirname(__file__))" + ")" * (size - 1)
    text = (
        "import os.path as p\ndef generate_launch_description():\n"
        f"    return LaunchDescription([IncludeLaunchDescription(p.join({above}, 'x.launch.py')),\n"
        "        Node(package='joy', executable='x')])\n"
    )
    files = {"base/launch/robot/base.launch.py": text}
    assert missing(tmp_path, files) == [(name, "base", False)]


def test_a_path_of_very_many_folders_is_not_looked_for(tmp_path: Path) -> None:
    text = "<launch><include file='" + "/a" * 200_000 + ".launch.xml'/></launch>"
    assert missing(tmp_path, {"base/launch/base.launch.xml": text}) == []


def test_templates_of_launch_files_are_not_read(tmp_path: Path) -> None:
    text = "<launch> <param [PARAMETERS]/> </launch>"
    node = '<launch><node pkg="joy" type="joy_node" name="joy"/></launch>'
    write_package({"templates/x.launch": text, "launch/y.launch": node}, tmp_path)
    trees = import_ros2([("", str(tmp_path))]).trees
    assert [each.broken for each in trees if each.broken] == []


def test_a_script_that_is_named_like_a_launch_file_is_none(tmp_path: Path) -> None:
    script = "#! /usr/bin/env python3\ndef generate_launch_description():\n    return 1\n"
    node = '<launch><node pkg="joy" exec="joy_node" name="joy"/></launch>'
    write_package({"launch/run.launch": script, "launch/y.launch.xml": node}, tmp_path)
    parsed = import_ros2([("", str(tmp_path))])
    assert [tree.broken for tree in parsed.trees] == [()]
    noted = "files that are named as launch files but are none not read: 1 (`run.launch`)"
    assert noted in [each.message for each in parsed.warnings]


PASSED = (
    '<include file="$(find-pkg-share elsewhere)/launch/x.launch.xml">'
    '<arg name="world" value="$(find-pkg-share arm)/worlds/home.world"/></include>'
)
INCLUDE = '<include file="$(find-pkg-share arm)/launch/arm.launch.xml"/>'
PARAMETERS = '<node pkg="x" exec="y"><param from="$(find-pkg-share arm)/config/arm.yaml"/></node>'
SHOWN = '<node pkg="rviz2" exec="rviz2" args="-d $(find-pkg-share arm)/rviz/arm.rviz"/>'
DEFAULT = (
    '<arg name="model" default="$(find-pkg-share arm)/urdf/arm.urdf"/><node pkg="x" exec="y"/>'
)


@pytest.mark.parametrize(
    ("line", "name"),
    [
        (PASSED, "worlds/home.world"),
        (INCLUDE, "launch/arm.launch.xml"),
        (PARAMETERS, "config/arm.yaml"),
        (SHOWN, "rviz/arm.rviz"),
        (DEFAULT, "urdf/arm.urdf"),
    ],
)
def test_a_file_that_a_package_lacks_is_found(tmp_path: Path, line: str, name: str) -> None:
    assert missing(tmp_path, launch(line)) == [(name, "arm", False)]
    assert missing(tmp_path, launch(line.replace("arm)/", "arm)//"))) == [(name, "arm", False)]


@pytest.mark.parametrize("line", [INCLUDE, PARAMETERS])
def test_a_missing_file_is_reported_once(tmp_path: Path, capsys: Captured, line: str) -> None:
    missing(tmp_path, launch(line, line, "<include file='elsewhere.launch.xml'/>"))
    run_here(["check", str(tmp_path)])
    output = " ".join("".join(capsys.readouterr()).split())
    assert output.count("the package `arm` has no file") == 1
    assert "not read: 1 (`elsewhere.launch.xml`)" in output
    assert "`$(find-pkg-share arm)" not in output


@pytest.mark.parametrize(
    "files",
    [
        {"arm/urdf/arm.urdf": "<robot/>"},
        {"arm/urdf/arm.urdf.xacro": "<robot/>"},
        {"arm/urdf/arm.urdf.in": "<robot/>"},
        {"arm/models/arm.urdf": "<robot/>"},
        {"arm/CMakeLists.txt": "xacro_add_files(x OUTPUT arm.urdf)"},
        {".gitignore": "*.urdf\n"},
        {"arm/.gitignore": "# made by a program\narm.urdf\n"},
        {"arm/.gitignore": "urdf/\n"},
        {"arm/urdf/.gitignore": "*\n!.gitignore\n"},
        {".gitignore": "arm/urdf\n"},
        {".gitignore": "**/urdf/*.urdf\n"},
    ],
)
def test_a_file_that_may_be_made_is_not_missing(tmp_path: Path, files: dict[str, str]) -> None:
    assert missing(tmp_path, {**launch(DEFAULT), **files}) == []


def test_a_template_of_a_model_makes_no_other_file(tmp_path: Path) -> None:
    files = {**launch(SHOWN), "arm/urdf/arm.urdf.xacro": "<robot/>"}
    assert missing(tmp_path, files) == [("rviz/arm.rviz", "arm", False)]


@pytest.mark.parametrize(
    "pattern", ["build/*", "/urdf/", "arm.urdf/", "base/urdf", "config/*.urdf"]
)
def test_a_pattern_of_another_folder_ignores_no_file(tmp_path: Path, pattern: str) -> None:
    files = {**launch(DEFAULT), ".gitignore": f"{pattern}\n"}
    assert missing(tmp_path, files) == [("urdf/arm.urdf", "arm", False)]


@pytest.mark.parametrize(
    "line",
    [
        '<include file="$(find-pkg-share elsewhere)/launch/arm.launch.xml"/>',
        '<arg name="map" default="$(find-pkg-share arm)/maps/home.yaml"/><node pkg="x" exec="y"/>',
        '<arg name="to" default="$(find-pkg-share arm)/logs"/><node pkg="x" exec="y"/>',
    ],
)
def test_packages_elsewhere_maps_and_folders_are_not_judged(tmp_path: Path, line: str) -> None:
    assert missing(tmp_path, launch(line)) == []


SETUP = "setup(entry_points={'console_scripts': ['gripper = arm.gripper:main']})"


@pytest.mark.parametrize(
    ("files", "is_missing"),
    [
        ({"arm/setup.py": SETUP}, True),
        (
            {"arm/setup.py": SETUP, "arm/arm/wrist.py": "", "arm/arm/gripper.py": "main = print"},
            True,
        ),
        ({"arm/setup.py": SETUP.replace("gripper =", "wrist =")}, False),
        ({"arm/CMakeLists.txt": "add_executable(gripper a.cpp)"}, True),
        ({"arm/CMakeLists.txt": "add_executable(wrist a.cpp)"}, False),
        ({"arm/CMakeLists.txt": "add_executable(${name} a.cpp)"}, False),
        ({"arm/CMakeLists.txt": "project(arm)", "arm/scripts/wrist": "#!/bin/sh"}, False),
    ],
)
def test_a_program_that_a_package_lacks_is_found(
    tmp_path: Path, files: dict[str, str], is_missing: bool
) -> None:
    found = missing(tmp_path, {**launch('<node pkg="arm" exec="wrist"/>'), **files})
    assert found == ([("wrist", "arm", True)] if is_missing else [])


@pytest.mark.parametrize(
    ("build", "setup", "is_missing"),
    [
        ("ament_python", SETUP, True),
        ("ament_python", SETUP.replace("gripper =", "wrist.py ="), False),
        ("ament_python", "setup(scripts=glob('arm/*'))", False),
        ("ament_python", "setup(data_files=[('lib/arm', ['arm/wrist.py'])])", False),
        ("ament_python", "setup(data_files=[('lib/arm', glob('arm/*'))])", False),
        ("ament_python", "setup(data_files=found())", False),
        ("ament_cmake", SETUP, False),
    ],
)
def test_modules_of_a_package_in_python_are_not_programs(
    build: str, setup: str, is_missing: bool, tmp_path: Path
) -> None:
    export = f"<export><build_type>{build}</build_type></export></package>"
    files = {
        "arm/package.xml": PACKAGE.format("arm").replace("</package>", export),
        "base/package.xml": PACKAGE.format("base").replace("</package>", export),
        "arm/setup.py": setup,
        "arm/setup.cfg": "[install]\ninstall-scripts=$base/lib/arm\n",
        "arm/arm/wrist.py": "",
        "arm/arm/gripper.py": "def main(): ...\n",
    }
    found = missing(tmp_path, {**launch('<node pkg="arm" exec="wrist.py"/>'), **files})
    assert found == ([("wrist.py", "arm", True)] if is_missing else [])


def test_a_file_that_a_program_writes_is_not_missing(tmp_path: Path) -> None:
    record = '<node pkg="rosbag" exec="record" args="-O $(find arm)/data/run.bag"/>'
    output = '<node pkg="x" exec="y" args="--output $(find arm)/data/run.csv"/>'
    assert missing(tmp_path, launch(record, output)) == []


def test_a_launch_file_that_asks_for_a_file_does_without_it(tmp_path: Path) -> None:
    text = """\
import os
from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description():
    shown = os.path.join(get_package_share_directory("arm"), "rviz", "arm.rviz")
    arguments = ["-d", shown]{}
    return LaunchDescription([Node(package="rviz2", executable="rviz2", arguments=arguments)])
"""
    for end, lacking in ("", ["rviz/arm.rviz"]), (" if os.path.exists(shown) else []", []):
        folder = tmp_path / str(len(end))
        found = missing(folder, {"base/launch/base.launch.py": text.format(end)})
        assert [name for name, _, _ in found] == lacking


LOOP = "foreach({})\n add_executable({} src/a.cpp)\nendforeach()"
BRANCHES = "if(A)\n set(X g)\nelse()\n set(X h)\nendif()\n"
CHANGED = "set(ALL a b)\nlist(TRANSFORM ALL APPEND rip)\n"


@pytest.mark.parametrize(
    ("file", "build", "is_there"),
    [
        ("arm/launch/grip.launch", "", False),
        ("arm/scripts/grip.py", "", True),
        ("arm/src/grip.cpp", "", False),
        ("arm/src/grip.cpp", "add_executable(grip src/grip.cpp)", True),
        ("arm/src/grip.cpp", "project(gr)\nadd_executable(${PROJECT_NAME}ip src/grip.cpp)", True),
        ("arm/src/grip.cpp", "foreach(name ${NAMES})", True),
        ("arm/src/grip.cpp", LOOP.format("name IN ITEMS a b", "${name}"), False),
        ("arm/src/grip.cpp", LOOP.format("name IN ITEMS g h", "${name}rip"), True),
        ("arm/src/grip.cpp", "set(ALL g h)\n" + LOOP.format("x ${ALL}", "${x}rip"), True),
        ("arm/src/grip.cpp", "set(ALL a b)\n" + LOOP.format("x IN LISTS ALL", "${x}rip"), False),
        ("arm/src/grip.cpp", BRANCHES + "add_executable(${X}rip a.cpp)", True),
        ("arm/src/grip.cpp", CHANGED + LOOP.format("x ${ALL}", "${x}"), True),
        ("arm/src/grip.cpp", CHANGED + LOOP.format("x IN LISTS ALL", "${x}"), True),
        ("arm/src/grip.cpp", LOOP.format("x a b", "${x}${SUFFIX}"), True),
        ("arm/src/grip.cpp", "foreach(x a b)\n add_node(${x})\nendforeach()", True),
        ("arm/src/grip.cpp", "add_executable(arm_grip src/grip.cpp)", False),
        ("arm/src/grip.cpp", "# add_executable(grip src/a.cpp)", False),
        ("arm/src/grip.cpp", "set(NODES grip)\nadd_nodes(${NODES})", True),
        ("arm/src/grip/a.cpp", "add_subdirectory(src/grip)\nfind_package(grip)", False),
        ("arm/src/a.cpp", "add_library(grip a.cpp)\ninstall(TARGETS grip DESTINATION lib)", False),
        ("arm/src/a.cpp", "set_target_properties(a PROPERTIES OUTPUT_NAME grip)", True),
        ("arm/src/a.cpp", "install(PROGRAMS a.py DESTINATION lib/arm RENAME grip)", True),
        ("arm/src/a.cpp", 'register_node(a PLUGIN "A" EXECUTABLE ${NAME}_exe)', True),
        ("arm/src/a.cpp", 'register_node(a PLUGIN "A" EXECUTABLE ${PROJECT_NAME}_exe)', False),
    ],
)
def test_a_program_is_a_script_or_named_in_the_build_file(
    tmp_path: Path, file: str, build: str, is_there: bool
) -> None:
    files = {file: "# grip\n", "arm/CMakeLists.txt": build}
    lines = launch('<node pkg="arm" exec="grip"/>')
    expected = [] if is_there else [("grip", "arm", True)]
    assert missing(tmp_path, {**files, **lines}) == expected


@pytest.mark.parametrize(
    ("file", "build", "is_there"),
    [
        ("CMakeLists.txt", "project(arm)\nadd_executable(grip a.cpp)", False),
        ("CMakeLists.txt", "project(arm)\nadd_executable(${PROJECT_NAME} a.cpp)", True),
        ("CMakeLists.txt", "project(arm)\nadd_all_of(${PROJECT_NAME})", True),
        ("CMakeLists.txt", "install(PROGRAMS a.py DESTINATION lib/arm)", False),
        ("setup.py", SETUP, False),
        ("setup.py", SETUP.replace("gripper =", "arm ="), True),
        ("setup.py", SETUP.replace("'gripper =", "f'{name} ="), True),
        ("setup.py", SETUP.replace("'gripper =", "name + ' ="), True),
        ("setup.cfg", "[options.entry_points]\nconsole_scripts =\n  arm = arm.a:main\n", True),
    ],
)
def test_a_program_that_is_named_like_its_package_is_built(
    tmp_path: Path, file: str, build: str, is_there: bool
) -> None:
    lines = launch('<node pkg="arm" exec="arm"/>')
    found = missing(tmp_path, {f"arm/{file}": build, "arm/arm/gripper.py": "main = 1", **lines})
    assert found == ([] if is_there else [("arm", "arm", True)])


def test_angles_of_rosparam_are_read(tmp_path: Path) -> None:
    files = {"arm/config/arm.yaml": "a: !degrees 60.0\nb: !radians 1\n", **launch(PARAMETERS)}
    for name, text in {"base/package.xml": PACKAGE.format("base"), **files}.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    (tmp_path / "arm/package.xml").write_text(PACKAGE.format("arm"))
    [tree] = import_ros2([("", str(tmp_path))]).trees
    assert not tree.broken


def test_files_of_submodules_are_elsewhere(tmp_path: Path) -> None:
    lines = launch('<include file="$(find-pkg-share base)/third/launch/other.launch.xml"/>')
    assert missing(tmp_path, lines) == [("third/launch/other.launch.xml", "base", False)]
    (tmp_path / ".gitmodules").write_text('[submodule "third"]\n\tpath = base/third\n')
    assert missing(tmp_path, lines) == []


def test_a_default_counts_for_nothing_where_the_argument_is_passed(tmp_path: Path) -> None:
    """A value that only a run knows is a value as well."""
    inner = (
        '<launch><arg name="file" default="$(find arm)/config/no.yaml"/>'
        '<rosparam command="load" file="$(arg file)"/></launch>'
    )
    include = '<launch><include file="$(find base)/launch/inner.launch">{}</include></launch>'
    passed = '<arg name="file" value="$(find arm)/config/$(env ROBOT)/yes.yaml"/>'
    files = {"base/launch/inner.launch": inner, "base/launch/base.launch": include.format("")}
    assert missing(tmp_path, files) == [("config/no.yaml", "arm", False)]
    files["base/launch/base.launch"] = include.format(passed)
    assert missing(tmp_path, files) == []


def test_a_script_of_a_shell_is_not_read_as_python(tmp_path: Path, capsys: Captured) -> None:
    script = '#!/bin/bash\nif [ -f /dev/x ]; then\n  echo "SUBSYSTEM==" >x\nfi\n'
    cmake = "install(PROGRAMS scripts/create_rules DESTINATION lib/base)\n"
    built = "<export><build_type>ament_cmake</build_type></export></package>"
    files = {
        "base/package.xml": PACKAGE.format("base").replace("</package>", built),
        "base/scripts/create_rules": script,
        "base/CMakeLists.txt": cmake,
        **launch('<node pkg="base" exec="create_rules"/>'),
    }
    missing(tmp_path, files)
    (tmp_path / "base/scripts/create_rules").chmod(0o755)
    run_here(["check", str(tmp_path)])
    assert "broken_file" not in "".join(capsys.readouterr())


def test_a_path_out_of_the_share_folder_may_lead_to_the_sources(tmp_path: Path) -> None:
    up = "$(find-pkg-share arm)/../../../../src/arm/config/{}.yaml"
    node = '<node pkg="joy" exec="joy_node"><param from="{}"/></node>'
    files = launch(node.format(up.format("arm")), node.format(up.format("other")))
    within = {f"src/{name}": text for name, text in files.items()}
    within |= {"src/arm/package.xml": PACKAGE.format("arm"), "src/arm/config/arm.yaml": "a: [\n"}
    for name, text in within.items():
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    [tree] = import_ros2([("", str(tmp_path))]).trees
    assert not tree.missing
    assert [Path(span.path).name for _, span in tree.broken] == ["arm.yaml"]
