"""Which packages of a folder count: those that a build of the workspace finds."""

from collections.abc import Mapping
from pathlib import Path

import pytest

from mars_asp.exchange.ros2 import import_ros2
from mars_asp.language import Parsed
from mars_asp.model.graph import LaunchTree

PACKAGE = "<package><name>{}</name></package>"
NODE = '<launch><node pkg="joy" type="joy_node" name="{}"/></launch>'


def read(written: Mapping[str, str], folder: Path, named: str = ".") -> Parsed:
    """Return the configuration of a path in a folder with these files."""
    for name, text in written.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)
    path = folder / named
    return import_ros2([("" if path.is_dir() else path.read_text(), str(path))])


def launched(parsed: Parsed) -> list[str]:
    """Return the names of the launch files, without their folders and ends."""
    return [Path(tree.path).stem for tree in parsed.trees]


def lacking(trees: tuple[LaunchTree, ...]) -> list[tuple[str, str]]:
    """Return the files and programs that packages lack, each with its package."""
    return [(each.package, each.name) for tree in trees for each in tree.missing]


@pytest.mark.parametrize("marker", ["COLCON_IGNORE", "CATKIN_IGNORE", "AMENT_IGNORE"])
def test_a_folder_that_is_not_to_be_built_holds_no_packages(tmp_path: Path, marker: str) -> None:
    include = '<launch><include file="$(find arm)/launch/wrist.launch"/></launch>'
    written = {
        "src/old/arm/package.xml": PACKAGE.format("arm"),
        "src/old/arm/launch/arm.launch": include,
        "src/base/package.xml": PACKAGE.format("base"),
        "src/base/launch/base.launch": NODE.format("pad"),
    }
    assert launched(read(written, tmp_path / "built")) == ["base", "arm"]
    written[f"src/old/{marker}"] = ""
    assert launched(read(written, tmp_path / "marked")) == ["base"]
    # A folder or file that the user names is read.
    for named in "src/old", "src/old/arm/launch/arm.launch":
        parsed = read(written, tmp_path / "marked", named)
        assert lacking(parsed.trees) == [("arm", "launch/wrist.launch")]


def test_a_note_names_the_marker_of_a_package_that_is_launched(tmp_path: Path) -> None:
    needed = (
        '<include file="$(find arm)/launch/arm.launch"/>'
        '<include file="$(find leg)/launch/leg.launch"/>'
        '<node pkg="arm" type="n" name="n"/>'
    )
    written = {
        "src/old/COLCON_IGNORE": "",
        "src/old/arm/package.xml": PACKAGE.format("arm"),
        "src/base/package.xml": PACKAGE.format("base"),
        "src/base/launch/base.launch": f"<launch>{needed}</launch>",
    }
    notes = [each.message for each in read(written, tmp_path).warnings]
    marker = tmp_path / "src/old/COLCON_IGNORE"
    assert notes == [
        f"files of packages in a folder that `{marker}` excludes not read: 1 "
        "(`$(find-pkg-share arm)/launch/arm.launch`)",
        "included launch files that are not in the workspace not read: 1 "
        "(`$(find-pkg-share leg)/launch/leg.launch`)",
        f"nodes of packages in a folder that `{marker}` excludes not read: 1 (`/n`)",
    ]


def test_in_a_package_a_marked_folder_has_its_sources_and_launch_files(tmp_path: Path) -> None:
    source = "int main() { n.advertise<A>('/t', 1); }".replace("'", '"')
    written = {
        "package.xml": PACKAGE.format("base"),
        "CMakeLists.txt": "file(GLOB ALL src/*.cpp)\nadd_executable(n ${ALL})",
        "src/AMENT_IGNORE": "",
        "src/n.cpp": source,
        "launch/AMENT_IGNORE": "",
        "launch/base.launch": '<launch><node pkg="base" type="n" name="n"/></launch>',
    }
    for folder, named in ("alone", "alone"), ("src/base", "."):
        moved = {f"{folder}/{name}": text for name, text in written.items()}
        [tree] = read(moved, tmp_path / folder.replace("/", "-"), named).trees
        assert [end.topic for node in tree.nodes for end in node.published] == ["/t"]
    # The packages in it are none.
    inner = {"old/COLCON_IGNORE": "", "old/arm/package.xml": PACKAGE.format("arm")}
    launch = {"old/arm/launch/arm.launch": NODE.format("pad")}
    assert launched(read({**written, **inner, **launch}, tmp_path / "more")) == ["base"]


def test_a_package_in_the_folder_of_another_is_none(tmp_path: Path) -> None:
    include = '<launch><include file="$(find arm)/launch/wrist.launch"/></launch>'
    written = {
        "src/old/package.xml": PACKAGE.format("old"),
        "src/old/deep/launch/own.launch": NODE.format("pad"),
        "src/old/parts/arm/package.xml": PACKAGE.format("arm"),
        "src/old/parts/arm/launch/arm.launch": include,
        "src/old/parts/arm/launch/empty.launch": "",
    }
    parsed = read(written, tmp_path)
    assert launched(parsed) == ["own"]
    assert lacking(parsed.trees) == []
    [note] = [each for each in parsed.warnings if "in the folders of others" in each.message]
    assert note.message.endswith("which no build finds, not read: 1 (`arm`)")
    # The folder that the user names may be a package with others in it.
    assert lacking(read(written, tmp_path, "src/old").trees) == [("arm", "launch/wrist.launch")]
    named = "src/old/parts/arm/launch/arm.launch"
    assert lacking(read(written, tmp_path, named).trees) == [("arm", "launch/wrist.launch")]
    chosen = import_ros2([("", str(tmp_path / "src"))], ["arm.launch"])
    assert "arm" in launched(chosen)


def test_a_launch_file_named_in_a_package_below_another_has_both(tmp_path: Path) -> None:
    written = {
        "src/robot/package.xml": PACKAGE.format("robot"),
        "src/robot/arm/package.xml": PACKAGE.format("arm"),
        "src/robot/arm/arm.launch": '<launch><include file="$(find base)/a.launch"/></launch>',
        "src/robot/base/package.xml": PACKAGE.format("base"),
    }
    [tree] = read(written, tmp_path, "src/robot/arm/arm.launch").trees
    assert lacking((tree,)) == [("base", "a.launch")]


def test_of_two_packages_of_one_name_that_of_the_launch_file_is_meant(tmp_path: Path) -> None:
    include = '<launch><include file="$(find arm)/launch/{}.launch"/></launch>'
    program = '<launch><node pkg="arm" type="{}" name="n"/></launch>'
    written = {
        **{f"src/{each}/arm/package.xml": PACKAGE.format("arm") for each in ("left", "right")},
        "src/left/arm/launch/wrist.launch": NODE.format("wrist"),
        "src/left/arm/scripts/turn.py": "",
        "src/left/arm/launch/arm.launch": include.format("wrist"),
        "src/right/arm/launch/arm.launch": include.format("wrist"),
        "src/base/package.xml": PACKAGE.format("base"),
        "src/base/launch/a.launch": include.format("wrist"),
        "src/base/launch/b.launch": include.format("absent"),
        "src/base/launch/c.launch": program.format("turn"),
        "src/base/launch/d.launch": program.format("bend"),
    }
    trees = {Path(tree.path).stem: tree for tree in read(written, tmp_path).trees if tree.missing}
    assert list(trees) == ["d", "arm"]
    assert "right" in trees["arm"].path
    assert lacking((trees["arm"],)) == [("arm", "launch/wrist.launch")]
    # Neither of them has the program.
    assert lacking((trees["d"],)) == [("arm", "bend")]


def test_console_scripts_are_of_the_package_in_their_folder(tmp_path: Path) -> None:
    setup = "setup(entry_points={'console_scripts': ['n = arm.n:main']})"
    python = "</name><export><build_type>ament_python</build_type></export>"
    manifest = PACKAGE.format("arm").replace("</name>", python)
    written = {
        "a/arm/package.xml": manifest,
        "a/arm/setup.py": setup,
        "a/arm/setup.cfg": "[install]\ninstall_scripts=$base/lib/arm",
        "a/arm/arm/m.py": "",
        "a/arm/launch/x.launch.xml": NODE.format("pad").replace("type", "exec"),
        "b/arm/package.xml": manifest,
        "b/arm/setup.py": "setup()",
    }
    assert lacking(read(written, tmp_path).trees) == [("arm", "arm/n.py")]
