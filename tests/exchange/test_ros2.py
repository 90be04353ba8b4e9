"""Launch files, packages and workspaces: trees with expected imports, and hostile ones."""

import json
import os
from collections.abc import Iterator
from pathlib import Path

import pytest

from mars_asp.cli import run_here
from mars_asp.diagnostic import Diagnostic, MarsError
from mars_asp.exchange.recognise import recognised
from mars_asp.exchange.ros2 import import_ros2
from mars_asp.exchange.ros2.actions import LaunchArgument
from mars_asp.exchange.ros2.launch_markup import substituted
from mars_asp.exchange.ros2.names import absolute, renamed
from mars_asp.exchange.ros2.source_cpp import read_cpp
from mars_asp.exchange.ros2.source_python import PythonPrograms
from mars_asp.language import Parsed
from mars_asp.language.print import print_relationship
from mars_asp.model.declarations import Control
from tests.support.documents import ROOT
from tests.support.fixtures import Captured
from tests.support.packages import write_package
from tests.support.processes import takes_at_most
from tests.support.refusals import refusals

FOLDER = ROOT / "tests" / "ros2"
TREES = [
    *sorted(path for path in FOLDER.iterdir() if path.is_dir()),
    ROOT / "examples/ros2_workspace",
]
_NAV2 = "shared/cases/imports/ros_launch/nav2_navigation_launch.py"
NAV2 = next((path for up in ROOT.parents if (path := up / _NAV2).exists()), ROOT / _NAV2)


def place(path: str, line: int, column: int, root: Path) -> str:
    return f"{Path(path).resolve().relative_to(root)}:{line}:{column}"


def golden_lines(found: Parsed, root: Path) -> Iterator[str]:
    """Yield the modules of a tree, their relationships and the warnings, with locations."""
    configuration = found.configuration
    yield f"modules: {', '.join(name.text for name in configuration.modules)}"
    for mux in configuration.muxes:
        yield f"{place(*mux.span[:3], root)}: {mux.engine} before {mux.module}"
    for line in configuration.relationships:
        yield f"{place(*line.span[:3], root)}: {print_relationship(line)}"
    for module in configuration.declared:
        guard = "" if module.guard is None else " (guard)"
        yield f"{place(*module.span[:3], root)}: {module.name}{guard}"
        for service in module.services:
            port = service.port or ", ".join(filter(None, service.parameters))
            kind = service.output or service.inputs or ""
            rate = "" if service.hz is None else f" {service.hz} Hz"
            at = place(*service.span[:3], root)
            yield f"  {at}: {service.kind} {port} {kind}{rate}".rstrip()
    for note in found.warnings:
        yield f"{place(*note.span[:3], root)}: {note.severity}: {note.message}"


@pytest.mark.parametrize("tree", TREES, ids=lambda path: path.stem)
def test_each_tree_gives_the_expected_output(tree: Path, update_golden: bool) -> None:
    found = "\n".join(golden_lines(import_ros2([("", str(tree))]), tree)) + "\n"
    golden = FOLDER / f"{tree.stem}.txt"
    if update_golden:
        golden.write_text(found, encoding="utf-8")
    assert golden.read_text(encoding="utf-8") == found


@pytest.mark.skipif(not NAV2.exists(), reason="the file of others is not beside the checkout")
def test_docking_and_following_reach_the_base_of_nav2_past_its_guards() -> None:
    found = import_ros2([(NAV2.read_text(encoding="utf-8"), str(NAV2))])
    modules = [name.text for name in found.configuration.modules]
    assert len(modules) == 13
    assert modules[-1] == "cmd_vel"
    lines = [line for line in found.configuration.relationships if isinstance(line, Control)]
    assert {(line.controlled, line.controller, line.priority) for line in lines} == {
        ("cmd_vel", "/collision_monitor", 0),
        ("cmd_vel", "/docking_server", 0),
        ("cmd_vel", "/following_server", 0),
        ("/collision_monitor", "/velocity_smoother", 0),
        ("/velocity_smoother", "/controller_server", 0),
        ("/velocity_smoother", "/behavior_server", 0),
    }
    guards = [module.name for module in found.configuration.declared if module.guard]
    assert guards == ["/velocity_smoother", "/collision_monitor"]
    assert any("12 nodes depend on conditions" in note.message for note in found.warnings)


def launched(text: str, path: str = "robot.launch.py") -> Parsed:
    return import_ros2([(text, path)])


PYTHON = """
from launch import LaunchDescription
from launch_ros.actions import Node
def generate_launch_description():
    {before}
    return LaunchDescription([{nodes}])
"""
JOY = 'Node(package="joy", executable="joy_node")'
#: The code before the return, the returned nodes, and the expected modules.
DESCRIPTIONS = [
    ("pass", JOY, ["/joy_node"]),
    ("n = " + JOY, "n, n", ["/joy_node"]),
    ("n = [" + JOY + "]", "*n", ["/joy_node"]),
    ("x = LaunchConfiguration('unknown')", JOY.replace(")", ", namespace=x)"), ["/joy_node"]),
    (
        "x = LaunchConfiguration('a', default='b')",
        JOY.replace(")", ", namespace=x)"),
        ["/b/joy_node"],
    ),
    (
        "def made(context):\n"
        "        x = context.launch_configurations['n']\n"
        "        return [" + JOY.replace(")", ", name=x)") + "]",
        "DeclareLaunchArgument('n', default_value='b'), OpaqueFunction(function=made)",
        ["/b"],
    ),
    (
        "def made(context):\n"
        "        x = context.launch_configurations.get('n', 'c')\n"
        "        return [" + JOY.replace(")", ", name=x)") + "]",
        "OpaqueFunction(function=made)",
        ["/c"],
    ),
    ("x = 'a' if y else 'c'", JOY.replace(")", ", name=x)"), ["/a", "/c"]),
    ("x = ['a', '_', 'b']", JOY.replace(")", ", name=x)"), ["/a_b"]),
    ("x = {'name': 'k'}", JOY.replace(")", ", **x)"), ["/k"]),
    ("x = f'r{1}'", JOY.replace(")", ", name=x)"), ["/r1"]),
    ("x = TextSubstitution(text='a')", JOY.replace(")", ", namespace=x)"), ["/a/joy_node"]),
    ("x = [" + JOY.replace(")", ", name=i)") + " for i in ('p', 'q')]", "*x", ["/p", "/q"]),
    (
        "x = []\n    for i in ('p', 'q'):\n        x.append(" + JOY.replace(")", ", name=i)") + ")",
        "*x",
        ["/p", "/q"],
    ),
    ("x = range(2)", "*[" + JOY.replace(")", ", name=f'n{i}')") + " for i in x]", ["/n0", "/n1"]),
    (
        "d = [DeclareLaunchArgument(p['n'], default_value=p['d']) for p in [{'n': 'a', 'd': 'b'}]]",
        "*d, " + JOY.replace(")", ", name=LaunchConfiguration('a'))"),
        ["/b"],
    ),
    (
        "def start(event, context): return [" + JOY + "]",
        "RegisterEventHandler(OnProcessStart(target_action=None, on_start=start))",
        ["/joy_node"],
    ),
    (
        "def again(event, context): return restarted()\n"
        "    def restarted():\n"
        "        return [" + JOY + ", RegisterEventHandler(OnProcessExit(on_exit=again))]",
        "*restarted()",
        ["/joy_node"],
    ),
    (
        "s = [Node(package='controller_manager', executable='spawner') for i in 'ab']",
        "*s, TimerAction(period=1.0, actions=[" + JOY + "])",
        ["/joy_node"],
    ),
    ("pass", JOY.replace(")", ", arguments=['--ros-args', '-r', '__ns:=/a'])"), ["/a/joy_node"]),
    ("pass", JOY.replace(")", ", name='n', ros_arguments=['-r', '__node:=m'])"), ["/m"]),
    ("x = '/g/'", JOY.replace(")", ", namespace=x)"), ["/g/joy_node"]),
    ("pass", "Node(package='x', executable='y', name='z')", ["/z"]),
]  # fmt: skip


@pytest.mark.parametrize(("before", "nodes", "modules"), DESCRIPTIONS)
def test_descriptions_are_read_as_they_would_be_built(
    before: str, nodes: str, modules: list[str]
) -> None:
    found = launched(PYTHON.format(before=before, nodes=nodes))
    assert [name.text for name in found.configuration.modules] == modules


NAMES = [
    ("scan", "/", "n", (), "/scan"),
    ("~/scan", "/a", "n", (), "/a/n/scan"),
    ("/scan", "/a", "n", (("scan", "x"),), "/scan"),
    ("scan", "/a", "n", (("scan", "x"), ("scan", "y")), "/a/x"),
    ("scan", "/a", "n", (("/a/scan", "~/y"),), "/a/n/y"),
    ("/scan", "/", "n", (("scan", "/y"),), "/y"),
    ("~/scan", "/", "n", (("~/scan", "scan"),), "/scan"),
    ("scan", "/", "n", (("other:scan", "y"),), "/scan"),
    ("scan", "/", "n", (("n:scan", "y"),), "/y"),
]


@pytest.mark.parametrize(("name", "namespace", "node", "rules", "full"), NAMES)
def test_topics_are_named_and_renamed_as_in_ros(
    name: str, namespace: str, node: str, rules: tuple[tuple[str, str], ...], full: str
) -> None:
    assert renamed(name, namespace, node, rules) == full
    assert renamed(full, namespace, node, ()) == absolute(full, namespace, node)


CPP = [
    ('create_publisher<A>("t", 1);', ["t"]),
    ('this->create_publisher<a::msg::B<int>>("t", 1);', ["t"]),
    ('// create_publisher<A>("t", 1);', []),
    ('auto s = "create_publisher<A>(\\"t\\", 1)";', []),
    ('\n#if 0\ncreate_publisher<A>("t", 1);\n#endif\n', []),
    ('create_publisher<A>(R"(t)", 1);', ["t"]),
    ('const char* n = "t"; create_publisher<A>(n, 1);', ["t"]),
    ('rclcpp::create_publisher<A>(node, "t", 1);', ["t"]),
    ('declare_parameter("p", "d"); get_parameter("p", n_); create_publisher<A>(n_, 1);', ["d"]),
    ("create_publisher<A>(name(), 1);", []),
    ('std::string n = "t"; create_publisher<A>(n.c_str(), 1);', ["t"]),
    ('std::string n = "t"; create_publisher<A>((n), 1);', ["t"]),
    ('std::string n = "t"; create_publisher<A>(std::string{n} + "/s", 1);', ["t/s"]),
    ('std::string n{"t"}; create_publisher<A>((std::string("s/") + n).c_str(), 1);', ["s/t"]),
    ('create_publisher<A>(("s" "/t"), 1);', ["s/t"]),
    ("create_publisher<A>(other.c_str(), 1);", []),
    ("create_publisher<A>(", []),
    ("a < b; create_publisher < c;", []),
]


@pytest.mark.parametrize(("text", "topics"), CPP)
def test_publishers_in_cpp_are_found_by_tokens(text: str, topics: list[str]) -> None:
    found = read_cpp([(f"void f() {{ {text} }}", "x.cpp")])
    assert [topic.name for topic in found.published] == topics


PROGRAMS = [
    ("self.create_publisher(A, 't', 1)", ["t"]),
    ("self.create_publisher(msg_type=A, topic='t', qos_profile=1)", ["t"]),
    ("'''self.create_publisher(A, 't', 1)'''", []),
    ("n = 'a'; self.create_publisher(A, n + '/b', 1)", ["a/b"]),
    ("self.create_publisher(A, self.declare_parameter('p', 'd').value, 1)", ["d"]),
    ("self.create_publisher(A, other(), 1)", []),
    ("rospy.Publisher('t', A)", ["t"]),
]


@pytest.mark.parametrize(("statement", "topics"), PROGRAMS)
def test_publishers_in_python_are_found_by_the_tree(statement: str, topics: list[str]) -> None:
    text = f"class N:\n    def __init__(self):\n        {statement}\ndef main():\n    N()\n"
    found = PythonPrograms(lambda _: (text, "x.py")).interface("x", "main")
    assert found is not None
    assert [topic.name for topic in found.published] == topics


def refused(text: str, path: str) -> tuple[Diagnostic, ...]:
    return refusals(launched, text, path)


def test_a_launch_file_that_only_includes_others_is_read() -> None:
    text = "launch:\n  - include:\n      file: $(find-pkg-share arm)/launch/arm.launch.yaml\n"
    found = import_ros2([(text, "x.launch.yaml")])
    assert found.configuration.modules == ()
    assert "no node could be read of what the launch files start" in messages(found)
    assert refused("launch: []\n", "x.launch.yaml")[0].message == "the launch file starts no node"


def messages(found: Parsed) -> list[str]:
    return [note.message for note in found.warnings]


#: A node, what its program does where we have its source, and whether it may have other topics.
STARTED = [
    ("x", "pass", True),
    ("mine", "self.create_publisher(A, other(), 1); self.create_publisher(A, 'a', 1)", True),
    ("mine", "self.create_publisher(A, 'a', 1)", False),
    ("tf2_ros", "pass", False),
    ("mine", "self.create_publisher(A, other(), 1)", True),
    ("mine", "self.create_service(A, 'ask', other)", False),
    ("mine", "self.create_publisher(A, '/rosout', 1)", False),
]


@pytest.mark.parametrize(("package", "does", "is_opaque"), STARTED)
def test_a_node_known_to_have_no_topics_is_not_one_whose_topics_could_not_be_read(
    package: str, does: str, is_opaque: bool, tmp_path: Path
) -> None:
    executable = "static_transform_publisher"
    start = f"Node(package='{package}', executable='{executable}', name='started')"
    written = {
        "package.xml": "<package><name>mine</name></package>",
        "setup.py": f"setup(entry_points={{'console_scripts': ['{executable} = mine.n:main']}})",
        "mine/n.py": f"class N(Node):\n  def __init__(self):\n    {does}\ndef main():\n  N()\n",
        "launch/robot.launch.py": PYTHON.format(before="pass", nodes=start),
    }
    for name, text in written.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text, encoding="utf-8")
    found = import_ros2([("", str(tmp_path))]).configuration
    assert [name.text for name in found.modules] == ["/started"]
    assert [name.text for name in found.opaque] == ["/started"] * is_opaque


#: What a launch file gives for a parameter, and the topic that a node of our source then has.
GIVEN = [
    ("{'out': '/b'}", ["/b"]),
    ("{'out': LaunchConfiguration('unknown')}", []),
    ("{'other': LaunchConfiguration('unknown')}", ["/a"]),
]


@pytest.mark.parametrize(("given", "topics"), GIVEN)
def test_a_default_holds_where_nothing_else_is_given(
    given: str, topics: list[str], tmp_path: Path
) -> None:
    (tmp_path / "package.xml").write_text("<package><name>mine</name></package>")
    (tmp_path / "setup.py").write_text("setup(entry_points={'console_scripts': ['e = n:main']})")
    declared = "self.declare_parameter('out', 'a').value"
    (tmp_path / "n.py").write_text(
        "class N(Node):\n  def __init__(self):\n"
        f"    self.create_publisher(A, {declared}, 1)\ndef main():\n  N()\n"
    )
    node = f"Node(package='mine', executable='e', name='n', parameters=[{given}])"
    (tmp_path / "x.launch.py").write_text(PYTHON.format(before="pass", nodes=node))
    found = import_ros2([("", str(tmp_path))]).configuration
    assert [s.port for module in found.declared for s in module.services] == topics
    assert bool(found.opaque) == (not topics)


#: How launch files give a program remappings among its arguments.
ARGUED = [
    ("x.launch.py", "arguments=['--ros-args', '-r', 'joy:=a']"),
    ("x.launch.py", "arguments=['--ros-args -r joy:=a']"),
    ("x.launch.py", "ros_arguments=['-r', 'joy:=a']"),
    ("x.launch.xml", 'args="--ros-args --remap joy:=a"'),
    ("x.launch.xml", 'args="--device 0" ros_args="--remap joy:=a"'),
    ("x.launch", 'args="joy:=a _rate:=5"'),
]


@pytest.mark.parametrize(("path", "given"), ARGUED)
def test_remappings_among_arguments_are_read(path: str, given: str) -> None:
    text = f'<launch><node pkg="joy" exec="joy_node" {given}/></launch>'
    if path.endswith(".py"):
        text = PYTHON.format(before="pass", nodes=JOY.replace(")", f", {given})"))
    [joy] = launched(text, path).configuration.declared
    assert [service.port for service in joy.services] == ["/a"]


BOMB = '<!DOCTYPE x [<!ENTITY a "b">]>\n<launch><node pkg="&a;" exec="x"/></launch>'
HOSTILE = [
    ("x.launch.py", "def generate_launch_description(:\n", "1:33: this is not Python: "),
    ("x.launch.py", "x = " + "(" * 5000 + ")" * 5000, "1:"),
    ("x.launch.py", "x = " + "-" * 100_000 + "1", "0:0: this Python is nested too deeply"),
    ("x.launch.py", "x = 1" + " + 1" * 20_000, "0:0: this Python is nested too deeply"),
    ("x.launch.py", "import os\n", "0:0: the file has no function `generate_launch_description`"),
    ("x.launch.py", PYTHON.format(before="1", nodes=""), "0:0: the launch file starts no node"),
    ("x.launch.xml", BOMB, "1:1: a document type, which is refused"),
    ("x.launch.xml", "<launch>" + "<group>" * 5000, "1:"),
    ("x.launch.xml", "<launch><node></launch>", "1:"),
    ("x.launch.xml", "<robot/>", "1:1: the document is `robot`, not `launch`"),
    ("x.launch.yaml", "launch: *a\n", "1:9: "),
    ("x.launch.yaml", "launch: " + "[" * 5000, "1:"),
    ("x.launch.py", "# x\n" * 300_000, "0:0: the file has more than 1048576 characters"),
    ("x.launch.yaml", "nodes: []\n", "1:1: the file has no `launch:`"),
]  # fmt: skip


@pytest.mark.parametrize(("path", "text", "first"), HOSTILE)
def test_hostile_files_end_with_a_located_error(path: str, text: str, first: str) -> None:
    with takes_at_most(10):
        span, message = (found := refused(text, path)[0]).span, found.message
    assert f"{span.line}:{span.column}: {message}".startswith(first)


@pytest.mark.parametrize(
    "before",
    [
        "x = ['a']\n    for i in range(9): x = x + x\n    for i in x: x += x",
        "x = 'a'\n" + "    x = x + x\n" * 100,
        "x = []\n" + "    x = [x, x]\n" * 100,
        "x = {}\n" + "    x = {'a': x, 'b': x}\n" * 60,
        "def f(): return [f(), f(), f()]\n    x = f()",
        "x = 1" + " + 1" * 500,
    ],
)
def test_evaluation_stops_at_values_that_grow_without_end(before: str) -> None:
    nodes = JOY.replace(")", ", parameters=[x], remappings=x)")
    with takes_at_most(5):
        found = launched(PYTHON.format(before=before, nodes=f"{nodes}, x, *x"))
    assert "/joy_node" in [name.text for name in found.configuration.modules]


def test_a_launch_file_is_not_run(tmp_path: Path) -> None:
    marker = tmp_path / "marker"
    file = tmp_path / "evil.launch.py"
    evil = f"open({str(marker)!r}, 'w').write('x')\n"
    file.write_text(evil + PYTHON.format(before=evil, nodes=JOY), encoding="utf-8")
    for name in ("joy.py", "launch.py", "setup.py"):
        (tmp_path / name).write_text(evil, encoding="utf-8")
    for path in (file, tmp_path):
        assert run_here(["check", str(path)]) == 0
    assert not marker.exists()


def test_nothing_outside_of_the_workspace_is_read(tmp_path: Path) -> None:
    inside, outside = tmp_path / "ws", tmp_path / "out"
    for folder in (inside, outside):
        folder.mkdir()
    secret = '<launch><node pkg="joy" exec="joy_node" name="secret"/></launch>'
    (outside / "secret.launch.xml").write_text(secret, encoding="utf-8")
    (inside / "linked.launch.xml").symlink_to(outside / "secret.launch.xml")
    (inside / "folder").symlink_to(outside)
    (inside / "self").symlink_to(inside)
    paths = ("../out/secret.launch.xml", str(outside / "secret.launch.xml"), "linked.launch.xml")
    includes = "".join(f'<include file="{path}"/>' for path in paths)
    text = f'<launch>{includes}<node pkg="joy" exec="joy_node" name="own"/></launch>'
    (inside / "main.launch.xml").write_text(text, encoding="utf-8")
    found = import_ros2([("", str(inside))])
    assert [name.text for name in found.configuration.modules] == ["/own"]
    messages = [note.message for note in found.warnings]
    assert any(m.startswith("links out of the workspace not read: 2") for m in messages)
    assert any("that are not in the workspace not read: 3" in m for m in messages)


def test_broken_files_of_a_folder_are_noted(tmp_path: Path) -> None:
    (tmp_path / "a.launch.py").write_bytes(b"\xff\xfe\x00binary\x00")
    (tmp_path / "b.launch.xml").write_bytes("<!-- caf\xe9 --><launch/>\n".encode("latin-1"))
    (tmp_path / "c.launch.xml").write_text("<launch>", encoding="utf-8")
    for pipe in ("p.launch.py", "package.xml", "setup.py", "mars-catalogue.toml"):
        os.mkfifo(tmp_path / pipe)
    with (tmp_path / "d.launch.py").open("wb") as large:
        large.truncate(100 * 1024 * 1024)
    (tmp_path / "e.launch.py").write_text(PYTHON.format(before="pass", nodes=JOY), encoding="utf-8")
    with takes_at_most(10):
        found = import_ros2([("", str(tmp_path))])
    assert [name.text for name in found.configuration.modules] == ["/joy_node"]
    messages = [note.message for note in found.warnings]
    assert any(m.startswith("launch files with errors not read: 3") for m in messages)
    assert any("named as launch files but are none not read: 1" in m for m in messages)


def test_a_broken_file_that_another_includes_is_broken_once(tmp_path: Path) -> None:
    files = {
        "launch/inner.launch.py": "def generate_launch_description(:\n",
        "launch/outer.launch.xml": "<launch><include"
        ' file="$(find-pkg-share mine)/launch/inner.launch.py"/></launch>',
    }
    write_package(files, tmp_path)
    trees = import_ros2([("", str(tmp_path))]).trees
    assert [Path(tree.path).name for tree in trees] == ["outer.launch.xml"]
    [(text, _)] = trees[0].broken
    assert text.endswith("launch/inner.launch.py: this is not Python: invalid syntax")


@pytest.mark.parametrize(
    ("launch", "words"), [("", "was found"), ("<launch><node", "could be read")]
)
def test_programs_count_as_started_without_a_readable_launch_file(
    launch: str, words: str, tmp_path: Path
) -> None:
    files = {
        "package.xml": "<package><name>mine</name>"
        "<export><build_type>ament_python</build_type></export></package>",
        "setup.py": "setup(entry_points={'console_scripts': ['drive = mine.drive:main']})",
        "mine/drive.py": "import rclpy\nnode = rclpy.create_node('drive')\n",
        **({"launch/a.launch.xml": launch} if launch else {}),
    }
    write_package(files, tmp_path)
    messages = [note.message for note in import_ros2([("", str(tmp_path))]).warnings]
    expected = f"no launch file {words}, so every program of the packages counts as started"
    assert expected in messages


def test_a_broken_source_is_placed_at_its_error(tmp_path: Path) -> None:
    files = {
        "package.xml": "<package><name>mine</name>"
        "<export><build_type>ament_python</build_type></export></package>",
        "setup.py": "setup(entry_points={'console_scripts': ['drive = mine.drive:main']})",
        "mine/drive.py": "def main():\n    x = ((1, 2)\n",
        "launch/a.launch.xml": '<launch><node pkg="mine" exec="drive"/></launch>',
    }
    write_package(files, tmp_path)
    [tree] = import_ros2([("", str(tmp_path))]).trees
    assert [(place.line, place.column) for _, place in tree.broken] == [(2, 9)]


def test_a_namespace_made_at_run_time_is_noted_as_it_is_written() -> None:
    push = '<push_ros_namespace namespace="$(var robot)"/>'
    node = '<node pkg="joy" exec="joy_node" name="own"/>'
    found = launched(f"<launch><group>{push}{node}</group></launch>", "robot.launch.xml")
    messages = [note.message for note in found.warnings]
    assert any("namespaces made at run time not read: 1 (`$(var robot)`)" in m for m in messages)


def test_a_list_in_brackets_is_a_list(tmp_path: Path) -> None:
    manager = '<node pkg="nav2_lifecycle_manager" exec="lifecycle_manager" name="m">{}</node>'
    given = '<param name="node_names" value="[a, \'b\']"/>'
    write_package({"launch/x.launch.xml": f"<launch>{manager.format(given)}</launch>"}, tmp_path)
    [tree] = import_ros2([("", str(tmp_path))]).trees
    [node] = tree.nodes
    assert [name for name, _ in node.manages] == ["/a", "/b"]


@pytest.mark.parametrize(
    ("space", "topic"), [("", "/camera/camera"), (' ns="left"', "/left/camera")]
)
def test_a_node_of_the_catalogue_may_have_a_namespace(
    space: str, topic: str, tmp_path: Path
) -> None:
    node = f'<node pkg="realsense2_camera" exec="realsense2_camera_node"{space}/>'
    write_package({"launch/x.launch.xml": f"<launch>{node}</launch>"}, tmp_path)
    [tree] = import_ros2([("", str(tmp_path))]).trees
    assert f"{topic}/color/image_raw" in [end.topic for end in tree.nodes[0].published]


MADE = (
    "import rospy, sys\nclass N:\n  def __init__(self, name):\n"
    "    rospy.Publisher('/' + name + '/cmd', Twist)\n{}"
)


@pytest.mark.parametrize(
    ("calls", "topics"),
    [
        ("N('a')\n", ["/a/cmd"]),
        ("N('a')\nN('b')\n", ["/a/cmd", "/b/cmd"]),
        ("if sys.argv: N(sys.argv[1])\nelse: N('a')\n", []),
        ("if sys.argv: N('a')\nelse: N('b')\n", []),
        ("if sys.argv: N('a')\nelse: N('a')\n", ["/a/cmd"]),
        ("if sys.argv: N('a')\n", ["/a/cmd"]),
    ],
)
def test_arguments_of_a_constructor_may_depend_on_a_condition(
    calls: str, topics: list[str], tmp_path: Path
) -> None:
    launch = '<launch><node pkg="mine" type="n.py" name="n"/></launch>'
    write_package({"scripts/n.py": MADE.format(calls), "launch/x.launch": launch}, tmp_path)
    [tree] = import_ros2([("", str(tmp_path))]).trees
    assert [end.topic for node in tree.nodes for end in node.published] == topics


def test_programs_count_as_started_where_no_launch_file_is() -> None:
    folder = ROOT / "examples/ros2_workspace/src/scout_base/src"
    package = folder.parent
    assert import_ros2([("", str(package))]).configuration.modules
    assert "no launch file and no package" in refusals(import_ros2, [("", str(folder))])[0].message


def test_a_mux_that_is_named_beside_a_launch_file_is_its_mux() -> None:
    mux = "m:\n  ros__parameters:\n    topics:\n      a: {topic: t, timeout: 0.5, priority: 7}\n"
    nodes = (
        "Node(package='twist_mux', executable='twist_mux', remappings=[('cmd_vel_out', 'go')]),"
        "Node(package='teleop_twist_keyboard', executable='teleop_twist_keyboard',"
        " remappings=[('cmd_vel', 't')])"
    )
    launch = PYTHON.format(before="pass", nodes=nodes)
    found = import_ros2([(launch, "x.launch.py"), (mux, "mux.yaml")])
    [line] = found.configuration.relationships
    assert print_relationship(line) == "go is_controlled_by /teleop_twist_keyboard 7 hold 500"
    assert (line.span.path, line.span.line) == ("mux.yaml", 4)


def test_a_users_catalogue_wins(tmp_path: Path) -> None:
    (tmp_path / "x.launch.py").write_text(PYTHON.format(before="pass", nodes=JOY), encoding="utf-8")
    own = tmp_path / "mars-catalogue.toml"
    own.write_text('[joy.joy_node]\nnode = "mine"\npublishes = { a = "p/msg/A" }\n', "utf-8")
    [module] = import_ros2([("", str(tmp_path))]).configuration.declared
    assert (module.name, module.services[0].port) == ("/mine", "/a")
    own.write_text("[joy]\njoy_node = 3\n", encoding="utf-8")
    with pytest.raises(MarsError, match="is not a table"):
        import_ros2([("", str(tmp_path))])
    own.write_text("[joy\n", encoding="utf-8")
    with pytest.raises(MarsError, match="this is not TOML"):
        import_ros2([("", str(tmp_path))])


#: Where each starts MAVROS: the topics of ROS 2 are below the namespace, where one is given.
STARTING = [
    ("x.launch.xml", '<node pkg="mavros" exec="mavros_node"/>', "/mavros"),
    ("x.launch.xml", '<node pkg="mavros" exec="mavros_node" namespace="uav/a"/>', "/uav/a"),
    (
        "x.launch",
        '<group ns="uav"><node pkg="mavros" type="mavros_node" name="fcu"/></group>',
        "/uav/fcu",
    ),
]


@pytest.mark.parametrize(("path", "node", "below"), STARTING)
def test_an_autopilot_is_commanded_by_setpoints_and_commands_by_no_measurement(
    path: str, node: str, below: str, tmp_path: Path
) -> None:
    (tmp_path / "package.xml").write_text("<package><name>mine</name></package>")
    (tmp_path / "setup.py").write_text("setup(entry_points={'console_scripts': ['a = n:main']})")
    (tmp_path / "n.py").write_text(
        "class N(Node):\n  def __init__(self):\n"
        f"    self.create_publisher(TwistStamped, '{below}/setpoint_velocity/cmd_vel', 1)\n"
        f"    self.create_subscription(TwistStamped, '{below}/local_position/velocity_body', f)\n"
        "def main():\n  N()\n"
    )
    word = "type" if path == "x.launch" else "exec"
    (tmp_path / "launch").mkdir()
    text = f'<launch>{node}<node pkg="mine" {word}="a" name="a"/></launch>'
    (tmp_path / "launch" / path).write_text(text)
    found = import_ros2([("", str(tmp_path))]).configuration
    [fcu, _] = [name.text for name in found.modules]
    assert set(map(print_relationship, found.relationships)) == {
        f"{fcu} is_controlled_by /a 0",
        f"/a.{below}/local_position/velocity_body uses_data_from"
        f" {fcu}.{below}/local_position/velocity_body",
    }


def test_bridges_have_topics_that_only_their_clients_know() -> None:
    nodes = "Node(package='foxglove_bridge', executable='foxglove_bridge')"
    found = launched(PYTHON.format(before="pass", nodes=f"{nodes}, {JOY}"))
    assert [name.text for name in found.configuration.opaque] == ["/foxglove_bridge"]
    assert any(
        note.message == "topics chosen by clients not read: 1 (`/foxglove_bridge`)"
        for note in found.warnings
    )


def test_an_unknown_topic_is_named_by_its_node_and_parameter() -> None:
    nodes = "".join(f'<node pkg="topic_tools" exec="throttle" name="{name}"/>' for name in "ab")
    found = launched(f"<launch>{nodes}</launch>", "robot.launch.xml")
    named = "4 (`/a.output_topic`, `/a.input_topic`, `/b.output_topic`, `/b.input_topic`)"
    assert f"topics named at run time not read: {named}" in [m.message for m in found.warnings]


def test_a_component_of_the_catalogue_is_found_by_its_plugin(tmp_path: Path) -> None:
    plugin = "nav2_map_server::CostmapFilterInfoServer"
    node = f'<composable_node pkg="nav2_map_server" plugin="{plugin}" name="filter"/>'
    container = '<node_container pkg="rclcpp_components" exec="component_container" name="c">'
    text = f"<launch>{container}{node}</node_container></launch>"
    write_package({"launch/x.launch.xml": text}, tmp_path)
    [tree] = import_ros2([("", str(tmp_path))]).trees
    assert "/costmap_filter_info" in [end.topic for at in tree.nodes for end in at.published]


def test_substitutions_are_parts_of_a_text() -> None:
    assert substituted("a$(env X b)c") == ("a", LaunchArgument("env X", default=("b",)), "c")
    assert substituted("$(arg a") == substituted("$(eval 1)")


def test_launch_files_are_recognised() -> None:
    assert recognised(PYTHON) == "ros2"
    assert recognised("<?xml version='1.0'?>\n<!-- <robot> -->\n<launch/>") == "ros2"
    assert recognised("<!DOCTYPE launch>\n<launch/>") == "ros2"
    assert recognised('<!DOCTYPE a [<!ENTITY b "c">]>\n<launch name="&b;"/>') == "ros2"
    assert recognised("launch:\n- node: {}\n") == "ros2"
    assert recognised("# launch: no\n@configuration\n") == "mars"


def test_files_that_come_through_pipes_are_one_robot(tmp_path: Path, capsys: Captured) -> None:
    topics = "m: {ros__parameters: {topics: {a: {topic: t, timeout: 0.5, priority: 0}}}}\n"
    nodes = "Node(package='twist_mux', executable='twist_mux')"
    texts = PYTHON.format(before="pass", nodes=nodes), topics
    names = []
    for number, text in enumerate(texts):
        reading, writing = os.pipe()
        os.write(writing, text.encode())
        os.close(writing)
        names.append(tmp_path / f"pipe{number}")
        names[-1].symlink_to(f"/dev/fd/{reading}")
    run_here(["check", "--format", "json", *map(str, names)])
    [robot] = json.loads(capsys.readouterr().out)["files"]
    assert (robot["path"], robot["further"]) == (str(names[0]), [str(names[1])])


def test_ackermann_mux_and_opened_files_are_read(tmp_path: Path) -> None:
    mux = "mux:\n  ros__parameters:\n    topics:\n      a: {topic: t, timeout: 0.5, priority: 7}\n"
    (tmp_path / "mux.yaml").write_text(mux, encoding="utf-8")
    opened = "with open('mux.yaml') as f:\n        x = yaml.safe_load(f)['mux']['ros__parameters']"
    nodes = "Node(package='ackermann_mux', executable='ackermann_mux', name='m', parameters=[x])"
    launch = tmp_path / "x.launch.py"
    launch.write_text(PYTHON.format(before=opened, nodes=nodes), encoding="utf-8")
    found = import_ros2([(launch.read_text(encoding="utf-8"), str(launch))])
    [line] = found.configuration.relationships
    assert print_relationship(line) == "ackermann_cmd is_controlled_by a 7 hold 500"


PRIVATE = """<launch>
  <node pkg="nodelet" type="nodelet" name="mux" args="load yocs_cmd_vel_mux/CmdVelMuxNodelet m">
    <rosparam>
      subscribers:
        - {name: nav, topic: input/nav, timeout: 0.5, priority: 3}
    </rosparam>
    <remap from="mux/output" to="wheels"/>
  </node>
  <node pkg="move_base" type="move_base" name="nav">
    <remap from="cmd_vel" to="mux/input/nav"/>
  </node>
</launch>"""


def test_a_nodelet_mux_names_its_topics_privately() -> None:
    found = launched(PRIVATE, "x.launch")
    lines = [line for line in found.configuration.relationships if isinstance(line, Control)]
    assert [print_relationship(line) for line in lines] == [
        "wheels is_controlled_by /nav 3 hold 500"
    ]


def test_a_relative_path_begins_where_the_robot_is_launched(tmp_path: Path) -> None:
    mux = "Node(package='twist_mux', executable='twist_mux', parameters=['src/arm/mux.yaml'])"
    written = {
        "src/arm/package.xml": "<package><name>arm</name></package>",
        "src/arm/launch/robot.launch.py": PYTHON.format(before="pass", nodes=mux),
        "src/arm/mux.yaml": (ROOT / "tests/twist_mux/ros2_tied.yaml").read_text(encoding="utf-8"),
    }
    for name, text in written.items():
        (tmp_path / name).parent.mkdir(exist_ok=True, parents=True)
        (tmp_path / name).write_text(text, encoding="utf-8")
    for root in (tmp_path, tmp_path / "src", tmp_path / "src/arm/launch/robot.launch.py"):
        text = "" if root.is_dir() else root.read_text(encoding="utf-8")
        [found] = import_ros2([(text, str(root))]).configuration.muxes
        assert found.span.path.endswith("mux.yaml")


def test_programs_that_cannot_be_read_as_nodes_are_noted() -> None:
    manager = "Node(package='controller_manager', executable='ros2_control_node')"
    found = import_ros2([(PYTHON.format(before="pass", nodes=manager), "x.launch.py")])
    assert messages(found) == [
        "no node could be read of what the launch files start",
        "controller managers not read: 1 (`ros2_control_node`)",
    ]
