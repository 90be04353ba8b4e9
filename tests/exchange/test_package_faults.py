"""Faults of packages of ROS 2 that show when they are built or started, not in their sources."""

from pathlib import Path

import pytest

from mars_asp.cli import run_here
from mars_asp.exchange.ros2 import import_ros2
from mars_asp.exchange.ros2.read import workspace_around
from mars_asp.language import Parsed
from tests.support.fixtures import Captured, Patch
from tests.support.packages import write_package

MANIFEST = "<package><name>mine</name><export><build_type>{}</build_type></export></package>"
PARAMETERS = (
    '<launch><node pkg="joy" exec="joy_node" name="joy">'
    '<param from="$(find-pkg-share mine)/config/p.yaml"/></node></launch>'
)
FILE = "joy:\n  ros__parameters:\n    rate: 1\n"
EMPTY = '<launch><node pkg="{}" exec="q"/></launch>'
SETUP = "from glob import glob\nfrom setuptools import setup\nname = 'mine'\n"


def read(written: dict[str, str], folder: Path, built_by: str = "ament_cmake") -> Parsed:
    write_package({"package.xml": MANIFEST.format(built_by), **written}, folder)
    return import_ros2([("", str(folder))])


def lacking(parsed: Parsed) -> list[tuple[str, str]]:
    return [(each.sort, each.name) for tree in parsed.trees for each in tree.missing]


LEFT_OUT = [("not installed", "config/p.yaml")]


@pytest.mark.parametrize(
    ("commands", "found"),
    [
        ("install(DIRECTORY launch DESTINATION share/mine)", LEFT_OUT),
        ("install(DIRECTORY launch config DESTINATION share/${PROJECT_NAME})", []),
        ("install(DIRECTORY config/ DESTINATION share/mine/config)", []),
        ("install(DIRECTORY config/ DESTINATION share/mine)", LEFT_OUT),
        ("install(FILES config/p.yaml DESTINATION share/mine/config)", []),
        ("install(DIRECTORY launch DESTINATION share/mine)\ninstall(FILES ${X} DESTINATION d)", []),
        ("install(DIRECTORY ${DIRS} DESTINATION share/mine)", []),
        ("file(GLOB FOUND config/*.rviz)\ninstall(FILES ${FOUND} DESTINATION share/mine)", []),
        ("install_launch_files()", []),
        ("install(CODE x)", []),
        ("add_custom_command(OUTPUT config/p.yaml)", []),
        ("include(all)", []),
        ("include(GNUInstallDirs)", LEFT_OUT),
        ("include(../build/all.cmake)", []),
        ("set_flags()", LEFT_OUT),
        ("finish()", []),
        ("macro(finish)\nendmacro()\nfinish()", LEFT_OUT),
        ("ament_auto_package(INSTALL_TO_SHARE config launch)", []),
        ("ament_auto_package(INSTALL_TO_SHARE launch)", LEFT_OUT),
        # A quote in a word does not begin a text.
        (r"add_definitions(-DX=\"a\")" + "\ninstall(DIRECTORY config DESTINATION share/mine)", []),
    ],
)
def test_cmake_installs_a_file_or_leaves_it_out(
    commands: str, found: list[tuple[str, str]], tmp_path: Path
) -> None:
    written = {
        "config/p.yaml": FILE,
        "x.launch.xml": PARAMETERS,
        "cmake/all.cmake": "install(DIRECTORY config DESTINATION share/mine)",
        "cmake/end.cmake": "macro(Finish)\n  install(DIRECTORY config DESTINATION a)\nendmacro()",
        "cmake/flags.cmake": "function(set_flags)\nendfunction()",
    }
    parsed = read({**written, "CMakeLists.txt": f"project(mine)\n{commands}\n"}, tmp_path)
    assert lacking(parsed) == found


@pytest.mark.parametrize(
    ("listed", "found"),
    [
        ("[]", LEFT_OUT),
        ("[('share/' + name + '/launch', glob('launch/*'))]", LEFT_OUT),
        ("[(f'share/{name}/config', glob('config/*.yaml'))]", []),
        ("[(f'share/{name}/config', ['config/p.yaml'])]", []),
        ("[(f'share/{name}', ['config/p.yaml'])]", LEFT_OUT),
        ("[(f'share/{name}', glob('**/*', recursive=True))]", []),
        ("[*found()]", []),
        ("found()", []),
    ],
)
def test_setup_py_installs_a_file_or_leaves_it_out(
    listed: str, found: list[tuple[str, str]], tmp_path: Path
) -> None:
    written = {
        "config/p.yaml": FILE,
        "x.launch.xml": PARAMETERS,
        "setup.py": f"{SETUP}setup(data_files={listed})\n",
    }
    assert lacking(read(written, tmp_path, "ament_python")) == found


@pytest.mark.parametrize(
    ("commands", "is_found"),
    [
        ("install(DIRECTORY config DESTINATION share/mine)", True),
        ("install(DIRECTORY config launch DESTINATION share/mine)", False),
        # Launching finds it in any of the shared folders.
        ("install(FILES launch/x.launch.xml DESTINATION share/mine)", False),
        ("install(DIRECTORY launch DESTINATION share/mine/launch)", False),
        ("install(DIRECTORY config ${X} DESTINATION share/mine)", False),
        ("", False),
    ],
)
def test_a_launch_file_is_installed_with_others(
    commands: str, is_found: bool, tmp_path: Path
) -> None:
    written = {
        "config/p.yaml": FILE,
        "launch/x.launch.xml": "<launch/>",
        "launch/x-Copy1.launch.xml": "<launch/>",
        "launch/y.launch.xml": PARAMETERS.replace("$(find-pkg-share mine)/config/p.yaml", "x"),
        "CMakeLists.txt": f"project(mine)\n{commands}\n",
    }
    found = lacking(read(written, tmp_path))
    assert (("not installed", "launch/x.launch.xml") in found) == is_found
    assert ("not installed", "launch/x-Copy1.launch.xml") not in found


def test_a_file_elsewhere_is_missing_where_all_files_are_listed(tmp_path: Path) -> None:
    written = {"config/real/p.yaml": FILE, "launch/x.launch.xml": PARAMETERS}
    folders = "install(DIRECTORY config {} DESTINATION share/mine)"
    build = "project(mine)\n" + folders.format("launch")
    assert lacking(read({**written, "CMakeLists.txt": build}, tmp_path)) == [
        ("file", "config/p.yaml")
    ]
    build = "project(mine)\n" + folders.format("${X}")
    assert lacking(read({**written, "CMakeLists.txt": build}, tmp_path)) == []


@pytest.mark.parametrize(
    ("name", "text", "built_by", "is_found"),
    [
        ("setup.cfg", "", "ament_python", True),
        ("setup.cfg", "[install]\ninstall_scripts=$base/lib/mine\n", "ament_python", False),
        ("setup.cfg", "[install]\ninstall-scripts=$base/lib/mine\n", "ament_python", False),
        (".gitignore", "setup.cfg\n", "ament_python", False),
        ("setup.cfg", "", "ament_cmake", False),
    ],
)
def test_programs_are_where_ros2_looks(
    name: str, text: str, built_by: str, is_found: bool, tmp_path: Path
) -> None:
    written = {
        "setup.py": f"{SETUP}setup(entry_points={{'console_scripts': ['n = mine.n:main']}})\n",
        "mine/n.py": "def main(): ...\n",
        "launch/x.launch.xml": '<launch><node pkg="joy" exec="joy_node"/></launch>',
        name: text,
    }
    found = lacking(read(written, tmp_path, built_by))
    assert found == ([("programs", "mine")] if is_found else [])


@pytest.mark.parametrize(
    ("entry", "found"),
    [("mine.n:main", [("file", "mine/n.py")]), ("mine.n", []), ("mine.__init__.py", [])],
)
def test_an_entry_without_a_function_lacks_no_module(
    entry: str, found: list[tuple[str, str]], tmp_path: Path
) -> None:
    written = {
        "setup.py": f"{SETUP}setup(entry_points={{'console_scripts': ['n = {entry}']}})\n",
        "setup.cfg": "[install]\ninstall_scripts=$base/lib/mine\n",
        "mine/__init__.py": "",
        "x.launch.xml": '<launch><node pkg="joy" exec="joy_node"/></launch>',
    }
    assert lacking(read(written, tmp_path, "ament_python")) == found


@pytest.mark.parametrize(
    ("module", "is_found"),
    [
        ("def run(): ...\n", True),
        ("def main(): ...\n", False),
        ("from mine.other import main\n", False),
        ("from mine.other import *\n", False),
        ("try:\n  main = print\nexcept E: ...\n", False),
        ("class A:\n  def main(self): ...\n", True),
        ("def main(:\n", False),
    ],
)
def test_functions_of_console_scripts_are_there(
    module: str, is_found: bool, tmp_path: Path
) -> None:
    written = {
        "setup.py": f"{SETUP}setup(entry_points={{'console_scripts': ['n = mine.n:main']}})\n",
        "setup.cfg": "[install]\ninstall_scripts=$base/lib/mine\n",
        "mine/n.py": module,
        "launch/x.launch.xml": '<launch><node pkg="joy" exec="joy_node"/></launch>',
    }
    found = lacking(read(written, tmp_path, "ament_python"))
    assert found == ([("function", "mine.n:main")] if is_found else [])


def test_a_package_of_cmake_needs_no_setup_py(tmp_path: Path) -> None:
    written = {
        "setup.py": f"{SETUP}setup(entry_points={{'console_scripts': ['n = mine.n:main']}})\n",
        "mine/__init__.py": "",
        "x.launch.xml": '<launch><node pkg="joy" exec="joy_node"/></launch>',
    }
    assert lacking(read(written, tmp_path, "ament_cmake")) == []
    assert ("file", "mine/n.py") in lacking(read(written, tmp_path, "ament_python"))


@pytest.mark.parametrize(
    ("inner", "built_by", "is_found"),
    [
        ("<<<<<<< HEAD\n", "ament_python", True),
        ("<<<<<<< HEAD\n", "catkin", False),
        ("x = 1\n", "ament_python", False),
        # Python 3.12.
        ("type A = int\n", "ament_python", False),
        ("a = f'{b['c']}'\n", "ament_python", False),
        ("a = f'{b('08')}'\n", "ament_python", False),
        ("a = f'{{}} {b('x)')}'\n", "ament_python", False),
        ("a = f'{b}' '08' 08\n", "ament_python", True),
        ("a = f'{\nb}'\n", "ament_python", False),
    ],
)
def test_sources_that_are_not_python_are_findings(
    inner: str, built_by: str, is_found: bool, tmp_path: Path
) -> None:
    written = {
        "setup.py": f"{SETUP}setup(entry_points={{'console_scripts': ['n = mine.n:main']}})\n",
        "mine/__init__.py": "",
        "mine/n.py": "from mine.inner import f\ndef main(): f()\n",
        "mine/inner.py": f"def f(): ...\n{inner}",
        "launch/x.launch.xml": '<launch><node pkg="mine" exec="n"/></launch>',
    }
    broken = [each for tree in read(written, tmp_path, built_by).trees for each in tree.broken]
    assert [(Path(span.path).name, span.line) for _, span in broken] == [("inner.py", 2)] * is_found


def test_a_source_that_is_not_python_is_found_from_another_folder(
    tmp_path: Path, monkeypatch: Patch
) -> None:
    written = {
        "package.xml": MANIFEST.format("ament_cmake"),
        "scripts/n.py": "<<<<<<< HEAD\n",
        "launch/x.launch.xml": '<launch><node pkg="mine" exec="n.py"/></launch>',
    }
    write_package(written, tmp_path / "workspace")
    monkeypatch.chdir(tmp_path)
    [tree] = import_ros2([("", "workspace")]).trees
    assert [span.path for _, span in tree.broken] == ["workspace/scripts/n.py"]


@pytest.mark.parametrize(
    ("manifest", "found"),
    [
        (
            "<package>\n<name>mine</na",
            ":2:11: warning: the file is not XML: unclosed token, expected `</name>`",
        ),
        (
            "<package>\n<name>mine",
            ":2:11: warning: the file is not XML: no element found, expected `</name>`",
        ),
        (
            "<package><name>mine</name></pack>",
            ":1:29: warning: the file is not XML: mismatched tag, expected `</package>`",
        ),
        ("<package><nam>mine</nam></package>", ":1:1: warning: `package` has no `<name>`"),
        ("<package><name> </name></package>", ":1:10: warning: `package` has an empty `<name>`"),
        ("", ":1:1: warning: the file is not XML: no element found"),
        ("\0", ": the file is not a text"),
        # The name of a template is made by a program.
        ("<package><name>{{ name }}</name></package>", None),
    ],
)
@pytest.mark.parametrize("named", [".", "mine/launch/x.launch.xml"])
def test_a_broken_manifest_leaves_the_package_the_name_of_its_folder(
    manifest: str, found: str | None, named: str, tmp_path: Path, capsys: Captured
) -> None:
    node = '<node pkg="joy" exec="joy_node" name="joy"/>'
    include = '<include file="$(find-pkg-share mine)/launch/in.xml"/>'
    files = {
        "package.xml": manifest,
        "launch/x.launch.xml": f"<launch>{node}{include}</launch>",
        "launch/in.xml": f"<launch>{node}</launch>",
    }
    write_package(files, tmp_path / "mine")
    (tmp_path / ".git").mkdir()
    run_here(["check", str(tmp_path / named)])
    output = capsys.readouterr().out
    assert output.count("[broken_file]") == (found is not None)
    assert found is None or f"mine/package.xml{found} [broken_file]" in output
    assert ("[duplicate_node]" in output) == (found is not None)


def test_a_launch_file_is_not_judged_by_packages_that_it_does_not_need(
    tmp_path: Path, capsys: Captured
) -> None:
    """A folder whose packages are all ignored does not count as a workspace."""
    write_package(
        {"package.xml": MANIFEST, "launch/r.launch.xml": EMPTY.format("q")}, tmp_path / "a"
    )
    for folder in ("b", "far/c"):
        write_package({"package.xml": "<package></package>"}, tmp_path / folder)
    for needed, found in (("q", 0), ("b", 1)):
        (tmp_path / "a/launch/r.launch.xml").write_text(EMPTY.format(needed))
        run_here(["check", "-q", str(tmp_path / "a/launch/r.launch.xml")])
        assert capsys.readouterr().out.count("package.xml:1:1") == found
    (tmp_path / "b/COLCON_IGNORE").touch()
    assert workspace_around(tmp_path / "a/launch/r.launch.xml") == tmp_path / "a"


@pytest.mark.parametrize(
    ("text", "built_by", "found"),
    [
        ("rate: 1\n", "ament_cmake", 1),
        (FILE, "ament_cmake", 0),
        ("other:\n  ros__parameters:\n    rate: 1\n", "ament_cmake", 0),
        # A second document is read as well.
        ("rate: 1\n---\njoy:\n  ros__parameters:\n    rate: 1\n", "ament_cmake", 0),
        ("", "ament_cmake", 0),
        ("rate: 1\n", "catkin", 0),
    ],
)
def test_a_parameter_file_has_parameters_for_ros2(
    text: str, built_by: str, found: int, tmp_path: Path, capsys: Captured
) -> None:
    read({"config/p.yaml": text, "launch/x.launch.xml": PARAMETERS}, tmp_path, built_by)
    run_here(["check", str(tmp_path)])
    assert capsys.readouterr().out.count("has no `ros__parameters` [broken_file]") == found


def test_a_mux_of_ros2_does_not_take_the_file_of_one_of_ros1(
    tmp_path: Path, capsys: Captured
) -> None:
    file = "topics:\n- {name: joy, topic: joy_vel, timeout: 0.5, priority: 100}\n"
    launch = PARAMETERS.replace("joy_node", "twist_mux").replace("joy", "twist_mux")
    read({"config/p.yaml": file, "launch/x.launch.xml": launch}, tmp_path)
    run_here(["check", str(tmp_path)])
    assert "given to `/twist_mux` as a parameter file" in " ".join(capsys.readouterr().out.split())


@pytest.mark.parametrize(("folder", "found"), [("launch", ["speed"]), ("mine", [])])
def test_a_launch_file_reads_no_parameter_of_a_program(
    folder: str, found: list[str], tmp_path: Path
) -> None:
    parsed = read(
        {
            "launch/x.launch.xml": '<launch><node pkg="mine" exec="e">'
            '<param name="speed" value="1"/></node></launch>',
            f"{folder}/more.py": "speed = 1",
            "src/e.cpp": 'int main() { n->create_publisher<A>("t", 1); }',
            "CMakeLists.txt": "add_executable(e src/e.cpp)\ninstall(TARGETS e DESTINATION lib)",
        },
        tmp_path,
    )
    assert [name for sort, name in lacking(parsed) if sort == "parameter"] == found


LAUNCH = (
    "from launch import LaunchDescription\nfrom launch_ros.actions import Node\n{}\n"
    "def generate_launch_description():\n  {}\n"
    "  return LaunchDescription([Node(package='joy', executable='joy_node')])\n{}"
)


@pytest.mark.parametrize(
    ("outer", "inner", "after", "found"),
    [
        ("", "print(os.sep)", "", ["`os` is not defined"]),
        (
            "",
            "print(os.sep, math.pi, os.sep, json)",
            "",
            ["`json`, `math` and `os` are not defined"],
        ),
        # Launching does not call the function, or calls it through another.
        ("def f():\n  print(os.sep)", "pass", "", []),
        ("def f():\n  print(os.sep)\ndef g():\n  f()", "g()", "", ["`os` is not defined"]),
        ("import os", "print(os.sep)", "", []),
        ("import a.os as os", "print(os.sep)", "", []),
        ("from os import *", "print(sep)", "", []),
        ("from __future__ import annotations", "a: Absent = 1", "", []),
        ("", "print(__file__, __name__)", "", []),
        ("", "print([each for each, *rest in []])", "", []),
        ("", "x = lambda a, *b, **c: (a, b, c)", "", []),
        ("", "try: unicode\n  except NameError as error: print(error)", "", []),
        (
            "",
            "match 1:\n    case {'a': b, **c}: print(b, c)\n    case [d, *e]: print(d, e)",
            "",
            [],
        ),
        ("", "pass", "if __name__ == '__main__':\n  main()\n", []),
    ],
)
def test_names_of_launch_files_are_defined(
    outer: str, inner: str, after: str, found: list[str], tmp_path: Path
) -> None:
    parsed = read({"launch/x.launch.py": LAUNCH.format(outer, inner, after)}, tmp_path)
    broken = [message for tree in parsed.trees for message, _ in tree.broken]
    assert [each.rpartition(": ")[2] for each in broken] == found


NODE = '<node pkg="robot_state_publisher" exec="robot_state_publisher">{}</node>'
MISSING = [("file", "urdf/robot.urdf")]


@pytest.mark.parametrize(
    ("name", "text", "found"),
    [
        ("x.launch.py", "Command(['xacro ', share + '/urdf/robot.urdf', ' a:=1'])", MISSING),
        ("x.launch.py", "Command(['xacro ', share + '/urdf/', name])", []),
        ("x.launch.py", "xacro.process_file(os.path.join(share, 'urdf/robot.urdf'))", MISSING),
        ("x.launch.py", "open(share + '/urdf/robot.urdf')", MISSING),
        ("x.launch.py", "open(share + '/urdf/robot.urdf', 'w')", []),
        (
            "x.launch.xml",
            '<param name="d" value="$(command \'xacro $(find-pkg-share mine)/urdf/robot.urdf\')"/>',
            MISSING,
        ),
        ("x.launch", '<param name="d" command="xacro $(find mine)/urdf/robot.urdf"/>', MISSING),
        ("x.launch", '<param name="d" textfile="$(find mine)/urdf/robot.urdf"/>', MISSING),
    ],
)
def test_files_that_launching_reads_are_there(
    name: str, text: str, found: list[tuple[str, str]], tmp_path: Path
) -> None:
    if name.endswith(".py"):
        text = LAUNCH.format(
            "from launch.substitutions import Command\nimport os, xacro",
            f"share = get_package_share_directory('mine')\n  d = {text}",
            "from ament_index_python.packages import get_package_share_directory\nname = os.name\n",
        )
    else:
        text = f"<launch>{NODE.format(text)}</launch>"
    built_by = "catkin" if name.endswith(".launch") else "ament_cmake"
    assert lacking(read({f"launch/{name}": text}, tmp_path, built_by)) == found
    written = {"urdf/robot.urdf": "<robot/>", "CMakeLists.txt": "install(CODE x)"}
    assert lacking(read({f"launch/{name}": text, **written}, tmp_path, built_by)) == []


def test_the_meshes_of_a_description_are_there(tmp_path: Path) -> None:
    written = {
        "launch/x.launch": "<launch>"
        '<param name="d" textfile="$(find mine)/urdf/robot.urdf"/></launch>',
        "urdf/robot.urdf": "<robot>\n"
        '<!-- <mesh filename="package://mine/meshes/old.stl"/>\n-->\n'
        '<mesh filename="package://mine/meshes/there.stl"/>\n'
        '<mesh filename="package://mine/meshes/absent.stl"/>\n'
        '<mesh filename="package://other/meshes/absent.stl"/>\n'
        '<mesh filename="package://mine/meshes/${side}.stl"/>\n'
        '<xacro:include filename="$(find mine)/urdf/robot.urdf"/>\n'
        '<xacro:include filename="$(find mine)/urdf/arm.xacro"/></robot>',
        "urdf/arm.xacro": '<robot><mesh scale="1 1 1"\n filename="package://mine/arm.dae"/></robot>',
        "meshes/there.stl": "",
    }
    [tree] = read(written, tmp_path, "catkin").trees
    places = [(each.name, Path(each.span.path).name, each.span.line) for each in tree.missing]
    assert places == [("meshes/absent.stl", "robot.urdf", 5), ("arm.dae", "arm.xacro", 2)]


INCLUDED = '<launch><arg name="speed"/>{}<node pkg="joy" exec="joy_node" type="joy_node"/></launch>'


@pytest.mark.parametrize(
    ("name", "inner", "found"),
    [
        ("a.launch.xml", "", ["sped"]),
        ("a.launch", "", ["sped"]),
        # It may be of what is included, but for ROS 1.
        ("a.launch.xml", '<include file="$(find-pkg-share other)/b.launch.xml"/>', []),
        ("a.launch", '<include file="$(find other)/b.launch"/>', ["sped"]),
        ("a.launch.xml", '<include file="$(find-pkg-share mine)/launch/b.launch.xml"/>', []),
    ],
)
def test_arguments_that_are_passed_are_read(
    name: str, inner: str, found: list[str], tmp_path: Path
) -> None:
    include = "<launch><include file='$({} mine)/launch/{}'>{}</include></launch>"
    passed = '<arg name="speed" value="1"/><arg name="sped" value="1"/>'
    find = "find" if name.endswith(".launch") else "find-pkg-share"
    written = {
        f"launch/{name}": INCLUDED.format(inner),
        "launch/b.launch.xml": '<launch><node pkg="joy" exec="$(var sped)"/></launch>',
        f"launch/top{name[1:]}": include.format(find, name, passed),
        "CMakeLists.txt": "install(CODE x)",
    }
    parsed = read(written, tmp_path, "catkin" if find == "find" else "ament_cmake")
    [tree] = [each for each in parsed.trees if Path(each.path).name.startswith("top")]
    sort = "refused argument" if find == "find" else "argument"
    assert [each.name for each in tree.missing if each.sort == sort] == found


def test_arguments_whose_names_are_put_together_may_be_read(tmp_path: Path) -> None:
    inner = LAUNCH.format(
        "from launch.substitutions import LaunchConfiguration",
        "names = [LaunchConfiguration(f'{side}_speed') for side in ('left', 'right')]",
        "",
    )
    outer = (
        "<launch><include file='$(find-pkg-share mine)/launch/a.launch.py'>"
        '<arg name="left_speed" value="1"/></include></launch>'
    )
    written = {"launch/a.launch.py": inner, "launch/top.launch.xml": outer}
    assert lacking(read({**written, "CMakeLists.txt": "install(CODE x)"}, tmp_path)) == []
    plain = {"launch/a.launch.py": inner.replace("f'{side}_speed'", "'speed'")}
    assert lacking(read({**written, **plain}, tmp_path)) == [("argument", "left_speed")]


def test_scripts_that_launching_runs_are_there(tmp_path: Path) -> None:
    launch = (
        '<launch><executable cmd="python3 $(find-pkg-share mine)/tools/{}.py -o '
        "$(find-pkg-share mine)/out.py\"/><node pkg='joy' exec='joy_node'/></launch>"
    )
    written = {"tools/there.py": "", "CMakeLists.txt": "install(CODE x)"}
    assert lacking(read({**written, "x.launch.xml": launch.format("there")}, tmp_path)) == []
    found = lacking(read({**written, "x.launch.xml": launch.format("absent")}, tmp_path))
    assert found == [("file", "tools/absent.py")]


@pytest.mark.parametrize(("condition", "is_found"), [("", True), ("if='$(var again)'", False)])
def test_a_launch_file_that_always_includes_itself_is_broken(
    condition: str, is_found: bool, tmp_path: Path
) -> None:
    launch = (
        "<launch><arg name='again'/><node pkg='joy' exec='joy_node'/>"
        f"<include file='$(find-pkg-share mine)/x.launch.xml' {condition}/></launch>"
    )
    [tree] = read({"x.launch.xml": launch, "CMakeLists.txt": "install(CODE x)"}, tmp_path).trees
    assert [message.rpartition(": ")[2] for message, _ in tree.broken] == [
        "the file always includes itself"
    ] * is_found


def test_a_launch_file_in_newer_python_is_not_read_and_not_broken(
    tmp_path: Path, capsys: Captured
) -> None:
    launch = LAUNCH.format("", "a = f'{\n1}'", "")
    [tree] = read({"launch/x.launch.py": launch}, tmp_path).trees
    assert (tree.broken, len(tree.unread)) == ((), 1)
    assert run_here(["check", str(tmp_path)]) == 0
    assert "launch files in a newer Python than this one not read" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("test", "found"),
    [
        ("if unknown():", []),
        ("if LaunchConfiguration('a') == 'b':", [("file", "urdf/robot.urdf")]),
    ],
)
def test_a_file_of_a_branch_that_may_never_be_taken_is_not_missing(
    test: str, found: list[tuple[str, str]], tmp_path: Path
) -> None:
    launch = LAUNCH.format(
        "from launch.substitutions import LaunchConfiguration",
        f"share = get_package_share_directory('mine')\n  {test}\n"
        "    open(share + '/urdf/robot.urdf')",
        "from ament_index_python.packages import get_package_share_directory\n"
        "from mine import unknown\n",
    )
    assert lacking(read({"launch/x.launch.py": launch}, tmp_path)) == found


def test_bridges_without_a_name_are_not_of_one_name(tmp_path: Path, capsys: Captured) -> None:
    bridge = (
        '<node pkg="ros_gz_bridge" exec="parameter_bridge" args="/{0}@std_msgs/msg/Bool[gz.B"/>'
    )
    launch = f"<launch>{bridge.format('a')}{bridge.format('b')}</launch>"
    read({"x.launch.xml": launch}, tmp_path)
    assert run_here(["check", str(tmp_path)]) == 0
    assert "duplicate_node" not in capsys.readouterr().out


@pytest.mark.parametrize(("name", "is_partly_read"), [("", False), ("name='mavros'", True)])
def test_nodes_of_mavros_may_be_named_alike(
    name: str, is_partly_read: bool, tmp_path: Path
) -> None:
    launch = f"<launch><node pkg='mavros' exec='mavros_node' {name} namespace='/mavros'/></launch>"
    [tree] = read({"x.launch.xml": launch}, tmp_path).trees
    assert [node.unread for node in tree.nodes] == [is_partly_read]


@pytest.mark.parametrize(
    ("key", "source", "found"),
    [
        ("rat", "self.declare_parameter('rate', 1)", ["rat"]),
        ("rate", "self.declare_parameter('rate', 1)", []),
        ("use_sim_time", "self.declare_parameter('rate', 1)", []),
        ("filter.rat", "self.declare_parameter('rate', 1)", []),
        ("rat", "allow_undeclared_parameters = True", []),
        # Its source puts a name together.
        ("rate_min", "self.declare_parameter(name + '_min', 1)", []),
        ("left_rate", "self.declare_parameter(f'left_{name}', 1)", []),
        ("rate_min", "self.declare_parameter('{}_max'.format(name), 1)", ["rate_min"]),
        ("rate2", "self.declare_parameter('rate%d' % 2, 1)", []),
        ("rates", "self.declare_parameter('rate%d' % 2, 1)", ["rates"]),
        ("rate_min", "self.declare_parameter(f'{name}_{each}', 1)", ["rate_min"]),
        ("rate_min", "key = f'{name}_min'; self.declare_parameter(key, 1)", []),
        ("rate_min", "self.get_parameter('a'); print(f'{name}_min')", ["rate_min"]),
        # A node that is not wholly read may declare any.
        ("rat", "self.create_publisher(String, sys.argv[1], 1)", []),
    ],
)
def test_parameters_that_are_given_are_named_by_the_source(
    key: str, source: str, found: list[str], tmp_path: Path
) -> None:
    launch = '<launch><node pkg="mine" exec="n.py"><param name="{}" value="1"/></node></launch>'
    node = (
        "import rclpy, sys\nclass N(Node):\n  def __init__(self):\n    super().__init__('n')\n    "
    )
    written = {
        "scripts/n.py": f"{node}{source}\n",
        "x.launch.xml": launch.format(key),
        "CMakeLists.txt": "install(PROGRAMS scripts/n.py DESTINATION lib/mine)",
    }
    [tree] = read(written, tmp_path).trees
    assert [each.name for each in tree.missing if each.sort == "parameter"] == found


def test_a_parameter_for_all_nodes_need_not_be_for_each(tmp_path: Path) -> None:
    node = '<node pkg="mine" exec="n.py">{}</node>'
    written = {
        "scripts/n.py": "import rclpy\nclass N(Node):\n  def f(self): super().__init__('n')\n",
        "x.launch.xml": f"<launch><set_parameter name='rate' value='1'/>{node.format('')}"
        + node.format('<param name="size" value="1"/>')
        + "</launch>",
        "CMakeLists.txt": "install(PROGRAMS scripts/n.py DESTINATION lib/mine)",
    }
    [tree] = read(written, tmp_path).trees
    assert [each.name for each in tree.missing if each.sort == "parameter"] == ["size"]


def test_very_many_names_are_one_finding(tmp_path: Path, capsys: Captured) -> None:
    passed = "".join(f'<arg name="a{number}" value="1"/>' for number in range(600))
    mesh = '<mesh filename="package://mine/absent.stl"/>'
    written = {
        "top.launch": f"<launch><include file='$(find mine)/in.launch'>{passed}</include>"
        "<param name='d' textfile='$(find mine)/a.urdf'/></launch>",
        "in.launch": "<launch><node pkg='joy' type='joy_node' name='joy'/></launch>",
        "a.urdf": f"<robot>{mesh * 600}<!-- {mesh} {'<!--' * 600}",
    }
    read(written, tmp_path, "catkin")
    assert run_here(["check", str(tmp_path)]) == 0
    assert "2 warnings in 1 folder" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("package", "topics"), [("mine", []), ("elsewhere", ["/scan"])], ids=["here", "elsewhere"]
)
def test_a_missing_parameter_file_of_a_package_here_hides_the_defaults(
    package: str, topics: list[str], tmp_path: Path
) -> None:
    """A file of another package is assumed to give the defaults of its programs."""
    source = (
        "from rclpy.node import Node\n"
        "class Watch(Node):\n"
        "    def __init__(self):\n"
        "        super().__init__('watch')\n"
        "        topic = self.declare_parameter('topic', '/scan').value\n"
        "        self.create_subscription(LaserScan, topic, self.on_scan, 10)\n"
        "def main():\n"
        "    Watch()\n"
    )
    launch = (
        '<launch><node pkg="mine" exec="watch" name="watch">'
        f'<param from="$(find-pkg-share {package})/config/lost.yaml"/></node></launch>'
    )
    setup = "setup(entry_points={'console_scripts': ['watch = mine.watch:main']})"
    written = {"setup.py": SETUP + setup, "mine/watch.py": source, "x.launch.xml": launch}
    (tree,) = read(written, tmp_path, "ament_python").trees
    assert [end.topic for node in tree.nodes for end in node.subscribed] == topics


SCRIPTS = {
    "listed": "setup(entry_points={'console_scripts': ['talk = mine.talk:main']})",
    "in a variable": "s = ['talk = mine.talk:main']\nsetup(entry_points={'console_scripts': s})",
    "by a loop": "s = []\nfor f in names:\n    s.append(f + ' = mine:main')\n"
    "setup(entry_points={'console_scripts': s})",
    "by a call": "setup(entry_points={'console_scripts': found()})",
}


@pytest.mark.parametrize("scripts", SCRIPTS)
def test_a_program_is_missing_only_where_the_scripts_are_known(
    scripts: str, tmp_path: Path
) -> None:
    launch = '<launch><node pkg="mine" exec="tlk"/></launch>'
    written = {"setup.py": SETUP + SCRIPTS[scripts], "mine/talk.py": "", "x.launch.xml": launch}
    found = lacking(read(written, tmp_path, "ament_python"))
    is_known = scripts in ("listed", "in a variable")
    assert (("program", "tlk") in found) is is_known


@pytest.mark.parametrize(
    "loading",
    [
        "yaml.safe_load(open(path))",
        "yaml.load(open(path), Loader=yaml.Loader)",
        "load_file(path)",
    ],
)
def test_values_of_a_file_that_is_loaded_are_unknown(loading: str, tmp_path: Path) -> None:
    launch = (
        "path = os.path.join(get_package_share_directory('mine'), 'car.yaml')\n"
        f"config = {loading}\n"
        "def generate_launch_description():\n"
        "    chosen = config['car']['algorithm']\n"
        "    return LaunchDescription([Node(package='mine', executable=f'{chosen}_policy')])\n"
    )
    setup = SETUP + SCRIPTS["listed"]
    written = {"setup.py": setup, "mine/talk.py": "", "x.launch.py": launch, "car.yaml": "a: 1"}
    sorts = [sort for sort, _ in lacking(read(written, tmp_path, "ament_python"))]
    assert "program" not in sorts


UNDECLARED = {
    "read": ('<node pkg="joy" type="joy_node" name="joy" if="$(arg u)"/>', ["u"]),
    "read twice": ('<param name="a" value="$(arg u)"/><param name="b" value="$(arg u)"/>', ["u"]),
    "declared": ('<arg name="u"/><param name="a" value="$(arg u)"/>', []),
    "declared in a group": ('<group><arg name="u" default="1"/></group><x y="$(arg u)"/>', []),
    "passed to another": (
        '<include file="b"><arg name="u" value="1"/></include><x y="$(arg u)"/>',
        ["u"],
    ),
    "behind a condition": ('<group if="0"><param name="a" value="$(arg u)"/></group>', []),
    "in an expression": ('<param name="a" value="$(eval arg(\'u\'))"/>', []),
    "in a comment": ("<!-- $(arg u) -->", []),
}


@pytest.mark.parametrize("name", UNDECLARED)
def test_roslaunch_refuses_arguments_that_the_file_does_not_declare(
    name: str, tmp_path: Path
) -> None:
    body, found = UNDECLARED[name]
    node = '<node pkg="joy" type="joy_node" name="joy_2"/>'
    parsed = read({"launch/a.launch": f"<launch>{node}{body}</launch>"}, tmp_path, "catkin")
    assert [each for sort, each in lacking(parsed) if sort == "undeclared argument"] == found


def test_an_include_hands_on_all_arguments_where_it_states_so(tmp_path: Path) -> None:
    include = '<include file="$(find mine)/b.launch" pass_all_args="{}"/>'
    inner = '<launch><node pkg="joy" type="joy_node" name="joy" output="$(arg u)"/></launch>'
    for passed, found in (("true", []), ("false", ["u"])):
        outer = f'<launch><arg name="u" default="log"/>{include.format(passed)}</launch>'
        written = {"a.launch": outer, "b.launch": inner}
        parsed = read(written, tmp_path / passed, "catkin")
        assert [name for sort, name in lacking(parsed) if "undeclared" in sort] == found


def test_ros2_reads_arguments_of_including_files(tmp_path: Path) -> None:
    text = '<launch><node pkg="joy" exec="joy_node" name="$(arg u)"/></launch>'
    assert lacking(read({"launch/a.launch": text}, tmp_path)) == []


@pytest.mark.parametrize(
    ("topic", "further", "is_border"),
    [
        ("/uav1/mavros/state", "", True),
        ("/mavros/state", "", True),
        ("/mavros/stat", "", False),
        ("/uav1/autopilot/state", "", False),
        ("/uav1/mavros/state", '<node pkg="mavros" exec="mavros_node" name="fcu"/>', False),
    ],
)
def test_a_topic_of_a_known_node_that_nothing_starts_is_the_border_of_the_robot(
    topic: str, further: str, is_border: bool, tmp_path: Path
) -> None:
    source = (
        "from rclpy.node import Node\n"
        "class Watch(Node):\n"
        "    def __init__(self):\n"
        "        super().__init__('watch')\n"
        f"        self.create_subscription(State, '{topic}', self.on_state, 10)\n"
        "def main():\n"
        "    Watch()\n"
    )
    setup = SETUP + SCRIPTS["listed"].replace("talk", "watch")
    node = '<node pkg="mine" exec="watch" name="watch"/>'
    launch = f"<launch>{node}{further}</launch>"
    written = {"setup.py": setup, "mine/watch.py": source, "x.launch.xml": launch}
    (tree,) = read(written, tmp_path, "ament_python").trees
    [end] = [end for each in tree.nodes for end in each.subscribed if each.name == "/watch"]
    assert (end.driver is not None) is is_border and not end.optional


@pytest.mark.parametrize(
    ("name", "attributes", "is_reported"),
    [
        ("'drive'", ("", ""), True),
        ("sys.argv[1]", ("", ""), False),
        ("sys.argv[1]", ("name='n'", "name='n'"), True),
        ("'drive'", ("name=os.environ['A']", "name=os.environ['B']"), False),
        ("'drive'", ("namespace=os.environ['A']", "namespace=os.environ['B']"), False),
        (
            "'drive'",
            tuple(f"arguments=['--ros-args', '-r', '__node:=' + os.environ['{x}']]" for x in "AB"),
            False,
        ),
    ],
)
def test_nodes_whose_names_only_a_run_knows_are_not_of_one_name(
    name: str, attributes: tuple[str, str], is_reported: bool, tmp_path: Path, capsys: Captured
) -> None:
    program = f"import sys, rclpy\nfrom rclpy.node import Node\nnode = Node({name})\n"
    started = "".join(f"Node(package='mine', executable='drive.py', {x})," for x in attributes)
    launch = (
        "import os\nfrom launch import LaunchDescription\nfrom launch_ros.actions import Node\n"
        f"def generate_launch_description():\n    return LaunchDescription([{started}])\n"
    )
    read({"scripts/drive.py": program, "launch/x.launch.py": launch}, tmp_path)
    run_here(["check", str(tmp_path)])
    assert ("duplicate_node" in capsys.readouterr().out) is is_reported


def test_nodes_in_namespaces_that_only_a_run_knows_are_not_of_one_name(
    tmp_path: Path, capsys: Captured
) -> None:
    group = (
        '<group><push-ros-namespace namespace="$(env {0})"/>'
        '<node pkg="mine" exec="drive.py" name="n"/></group>'
    )
    launch = f"<launch>{group.format('A')}{group.format('B')}</launch>"
    read({"launch/x.launch.xml": launch}, tmp_path)
    run_here(["check", str(tmp_path)])
    assert "duplicate_node" not in capsys.readouterr().out
