"""Programs and files that a package installs elsewhere than they are in its sources."""

from pathlib import Path

import pytest

from mars_asp.exchange.ros2 import import_ros2
from mars_asp.language import Parsed
from tests.support.packages import write_package

NODE = "class N(Node):\n  def __init__(self):\n    self.create_publisher(A, 't', 1)\nN()\n"


def read(written: dict[str, str], folder: Path) -> Parsed:
    """Return the configuration of a folder with these files."""
    write_package(written, folder)
    return import_ros2([("", str(folder))])


#: The commands of a package, and where its program is.
PROGRAMS = [
    ("install(PROGRAMS ${PROJECT_NAME}/n.py DESTINATION lib/${PROJECT_NAME})", "mine/n.py"),
    ("install(PROGRAMS mine/deep/n.py\n  mine/m.py DESTINATION lib/mine)", "mine/deep/n.py"),
    ("set(ALL tools/n.py)\ninstall(PROGRAMS ${ALL} DESTINATION lib/mine)", "tools/n.py"),
    ("catkin_install_python(PROGRAMS tools/n.py DESTINATION lib)", "tools/n.py"),
    ("", "mine/n.py"),
]


@pytest.mark.parametrize(("commands", "place"), PROGRAMS)
def test_installed_programs_are_found(commands: str, place: str, tmp_path: Path) -> None:
    written = {
        "CMakeLists.txt": f"project(mine)\n{commands}\n",
        place: NODE,
        "launch/x.launch.xml": '<launch><node pkg="mine" exec="n.py" name="n"/></launch>',
    }
    [module] = read(written, tmp_path).configuration.declared
    assert [service.port for service in module.services] == ["/t"]


SETUP = "from setuptools import setup\nfrom glob import glob\nimport os\npackage_name = 'mine'\n"
SHARE = "os.path.join('share', package_name, 'launch')"
#: How a package installs `robot/a.launch.xml` as `launch/a.launch.xml`.
INSTALLED = [
    ("setup.py", f"{SETUP}setup(data_files=[({SHARE}, glob('robot/*.launch.xml'))])"),
    ("setup.py", f"{SETUP}setup(data_files=[({SHARE}, ['robot/a.launch.xml'])])"),
    (
        "setup.py",
        f"{SETUP}files = [({SHARE}, glob(os.path.join('robot', '*launch.[pxy]*')))]\n"
        "setup(data_files=files)",
    ),
    (
        "setup.py",
        f"{SETUP}setup(data_files=[('share/' + package_name + '/launch/',"
        " ['x'] + glob('robot/*.xml'))])",
    ),
    (
        "setup.py",
        f"{SETUP}setup(data_files=[(f'share/{{package_name}}/launch', ('robot/a.launch.xml',))])",
    ),
    ("setup.py", f"{SETUP}setup(data_files=[({SHARE}, glob('*/*.launch.*'))])"),
    ("setup.py", f"{SETUP}setup(data_files=[({SHARE}, glob('**/*.xml', recursive=True))])"),
    ("setup.py", f"{SETUP}setup(data_files=[({SHARE}, glob('robot/**', recursive=True))])"),
    (
        "CMakeLists.txt",
        "project(mine)\nfile(GLOB FILES */*.xml)\n"
        "install(FILES ${FILES} DESTINATION share/${PROJECT_NAME}/launch)",
    ),
    (
        "CMakeLists.txt",
        "project(mine)\ninstall(FILES robot/a.launch.xml DESTINATION share/${PROJECT_NAME}/launch)",
    ),
    (
        "CMakeLists.txt",
        "project(mine)\ninstall(DIRECTORY robot/ DESTINATION share/${PROJECT_NAME}/launch)",
    ),
    (
        "CMakeLists.txt",
        "project(mine)\ninstall(DIRECTORY robot/\n"
        "  DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION}/launch)",
    ),
]  # fmt: skip


@pytest.mark.parametrize(("name", "text"), INSTALLED)
def test_installed_launch_files_are_found(name: str, text: str, tmp_path: Path) -> None:
    inner = '<launch><node pkg="joy" exec="joy_node" name="pad"/></launch>'
    outer = '<launch><include file="$(find-pkg-share mine)/launch/a.launch.xml"/></launch>'
    written = {name: text, "robot/a.launch.xml": inner, "top/b.launch.xml": outer}
    found = read(written, tmp_path)
    assert [name.text for name in found.configuration.modules] == ["/pad"]
    assert [tree.path.rpartition("/")[2] for tree in found.trees] == ["b.launch.xml"]


@pytest.mark.parametrize("pattern", ["*/*/*.xml", "**/*.xml", "robot/**"])
def test_a_pattern_installs_files_at_its_own_depth(pattern: str, tmp_path: Path) -> None:
    setup = f"{SETUP}setup(data_files=[({SHARE}, glob('{pattern}'))])"
    outer = '<launch><include file="$(find-pkg-share mine)/launch/a.launch.xml"/></launch>'
    deep = "robot/a.launch.xml" if pattern == "*/*/*.xml" else "robot/x/a.launch.xml"
    written = {"setup.py": setup, deep: "<launch/>", "top/b.launch.xml": outer}
    found = read(written, tmp_path)
    assert any("a.launch.xml" in note.message for note in found.warnings)


def test_a_folder_is_installed_by_its_own_name(tmp_path: Path) -> None:
    build = "project(mine)\ninstall(DIRECTORY robot/launch robot/config DESTINATION share/mine)"
    file = "$(find-pkg-share mine)/config/p.yaml"
    node = f'<node pkg="joy" exec="joy_node"><param from="{file}"/></node>'
    outer = '<launch><include file="$(find-pkg-share mine)/launch/a.launch.xml"/></launch>'
    written = {
        "CMakeLists.txt": build,
        "robot/config/p.yaml": "joy_node: {ros__parameters: {rate: 5}}",
        "robot/launch/a.launch.xml": f"<launch>{node}</launch>",
        "top/b.launch.xml": outer,
    }
    found = read(written, tmp_path)
    assert [name.text for name in found.configuration.modules] == ["/joy_node"]
    assert not [note for note in found.warnings if "not in the workspace" in note.message]


def test_nothing_outside_of_the_package_is_installed(tmp_path: Path) -> None:
    (tmp_path / "a.launch.xml").write_text("<launch/>")
    build = "project(mine)\ninstall(DIRECTORY ../ DESTINATION share/mine/launch)"
    outer = '<launch><include file="$(find-pkg-share mine)/launch/a.launch.xml"/></launch>'
    found = read({"CMakeLists.txt": build, "b.launch.xml": outer}, tmp_path / "ws")
    assert any("their packages lack" in note.message for note in found.warnings)
