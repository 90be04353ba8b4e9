"""The robots in a folder: `.mars` files, workspaces of ROS, dataflows, other files by content."""

import os
import re
from collections import deque
from collections.abc import Callable, Collection, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple, TypeAlias

from mars_asp.diagnostic import Diagnostic, MarsError, whole_file
from mars_asp.exchange.recognise import key_pattern, recognised
from mars_asp.exchange.unread import Unread, notes
from mars_asp.language.parse import read_text
from mars_asp.reading import files_read

#: Files that keep a folder from being built.
IGNORE_MARKERS = frozenset({"COLCON_IGNORE", "CATKIN_IGNORE", "AMENT_IGNORE"})
#: Folders of builds and packages; hidden ones and virtual environments are skipped as well.
_BUILT = frozenset("build target node_modules __pycache__ venv".split())
#: Folders with dataflows for tests alone.
_OF_TESTS = frozenset("template templates test tests fixtures".split())
#: A folder with packages of ROS up to this depth is a workspace of ROS.
_NEAR = 2
#: Files that are neither judged with the robot of their folder nor by themselves.
_OTHERS = "robots of other formats, which `mars-asp check FILE` judges,"
#: How many entries of folders are listed, files are read, and dataflows are taken.
MOST_ENTRIES = 100_000
MOST_READ = 5_000
MOST_DATAFLOWS = 300
#: A node of a dataflow has one of these keys; other files have lists of nodes as well.
_OF_NODES = key_pattern("inputs|outputs|path|custom|operators?|ros2|module|hub|git")
#: Beside packages of ROS, which have lists of nodes with paths.
_OF_DORA = key_pattern("inputs|outputs|custom|operators?")
#: Other YAML files have lists of topics as well.
_OF_MUX = key_pattern("priority")
LAUNCH_ENDINGS = (
    ".launch",
    *(f"{mark}launch.{end}" for mark in "._" for end in ("py", "xml", "yaml", "yml")),
)
_YAML = frozenset({".yml", ".yaml"})
#: Endings of files that may be robots by their content.
_BY_CONTENT = frozenset({*_YAML, ".xml", ".urdf", ".dot", ".gv", ".json", ".txt", ".launch", ".py"})
_ENDINGS = (".mars", *sorted(_BY_CONTENT))

#: Whether a path in a folder, of a folder or not, is passed over.
IsExcluded: TypeAlias = Callable[[Path, bool], bool]


class FolderRobots(NamedTuple):
    """The robots in a folder, in the order of their paths, and notes on its other files.

    A robot is a file, or a folder with packages and launch files of ROS. `passed_over` is the
    number of YAML, XML, Python and text files that are neither a robot nor in one.
    """

    paths: tuple[Path, ...]
    notes: tuple[Diagnostic, ...] = ()
    passed_over: int = 0


def nothing_excluded(path: Path, is_folder: bool) -> bool:
    """Return False: the default of functions that decide which paths to skip."""
    return False


def robots_in(folder: Path, is_excluded: IsExcluded = nothing_excluded) -> FolderRobots:
    """Return the robots in a folder.

    Each `.mars` file is one. A workspace is the outermost folder whose `src` holds packages.
    Outside of ROS each dataflow, mux, dump of a graph and URDF document is one.

    Args:
        folder: The folder; links in it are not followed.
        is_excluded: Whether a path in it, of a folder or not, is skipped.
    """
    unread: list[Unread] = []
    read_before = files_read.copy()
    entries = list(_entries(folder, is_excluded, unread))
    launches = [path for _, path in entries if path.name.endswith(LAUNCH_ENDINGS)]
    packages = [path.parent for _, path in entries if path.name == "package.xml"]
    ros = _ros_in(folder, packages, launches, unread)
    found = [path for _, path in entries if path.suffix == ".mars"]
    if ros == [folder]:
        dataflows = _beside_ros(folder, entries, unread)
        has_packages = any(depth <= _NEAR for depth, path in entries if path.name == "package.xml")
        if dataflows and not (launches and has_packages):
            unread += (_unread("packages of ROS", path / "package.xml") for path in packages)
            ros = []
        found += dataflows
        outside = [path for _, path in entries if not _lies_in(path, packages)]
        texts = "".join(map(_text_of, launches)) if ros else ""
        for path in _by_content(folder, outside, []):
            # Launch files and what they load are judged with the robot of the folder.
            is_own = ros and (path.name in texts or recognised(_text_of(path)) == "ros2")
            if path not in found and not is_own:
                unread.append(_unread(_OTHERS, path))
        passed_over = 0
    else:
        outside = [path for _, path in entries if path not in ros and not _lies_in(path, ros)]
        apart = list(_by_content(folder, outside, unread))
        found += apart
        passed_over = sum(path.suffix in _BY_CONTENT for path in outside) - len(apart)
    # Only the robots are inputs: an output may replace another file, such as an older output.
    files_read.intersection_update(read_before)
    return FolderRobots(tuple(sorted((*found, *ros))), tuple(notes(unread)), passed_over)


def _ros_in(
    folder: Path, packages: Sequence[Path], launches: Sequence[Path], unread: list[Unread]
) -> list[Path]:
    """Return the folders and launch files that are ROS robots.

    Packages without a workspace, and launch files beside a single workspace, belong to one robot:
    the folder. Beside several workspaces each launch file is a robot. `unread` gets the others.
    """
    workspaces: set[Path] = set()
    for package in packages:
        parts = package.relative_to(folder).parts
        inner = parts.index("src") if "src" in parts else 0
        workspaces.add(folder.joinpath(*parts[:inner]))
    workspaces = {each for each in workspaces if not _lies_in(each, workspaces)}
    beside = [each for each in launches if not _lies_in(each, workspaces)]
    if not workspaces or (beside and len(workspaces) == 1):
        return [folder] if packages or launches else []
    started = [each for each in workspaces if any(each in at.parents for at in launches)]
    started += beside
    unread += (
        _unread("workspaces without a launch file", each)
        for each in sorted(workspaces.difference(started or workspaces))
    )
    return sorted(started or workspaces)


def _lies_in(path: Path, folders: Collection[Path]) -> bool:
    return any(each in folders for each in path.parents)


def _beside_ros(
    folder: Path, entries: Sequence[tuple[int, Path]], unread: list[Unread]
) -> list[Path]:
    """Return the dora dataflows in a folder of ROS packages, if at least one is near its top.

    Deeper ones alone do not count. `unread` gets the files not examined.
    """
    yaml = sorted(
        each for each in entries if each[1].suffix in _YAML and not _is_test(folder, each[1])
    )
    has_packages = any(path.name == "package.xml" for _, path in entries)
    sign = _OF_DORA if has_packages else _OF_NODES
    near = (path for depth, path in yaml[:MOST_READ] if depth <= _NEAR)
    if not any(_is_dataflow(path, sign) for path in near):
        return []
    unread += (_unread("YAML files", path) for _, path in yaml[MOST_READ:])
    return _at_most([path for _, path in yaml[:MOST_READ] if _is_dataflow(path, sign)], unread)


def _by_content(folder: Path, paths: Sequence[Path], unread: list[Unread]) -> Iterator[Path]:
    """Yield the files outside of ROS that are robots by their content; note those not examined."""
    possible = [path for path in paths if path.suffix in _BY_CONTENT]
    unread += (_unread("files", path) for path in possible[MOST_READ:])
    dataflows = []
    for path in possible[:MOST_READ]:
        text = _text_of(path)
        match recognised(text):
            case "dora" if not _is_test(folder, path) and re.search(_OF_NODES, text):
                dataflows.append(path)
            case "twist_mux" if re.search(_OF_MUX, text):
                yield path
            case "urdf" | "rosgraph" | "ros2":
                yield path
    yield from _at_most(dataflows, unread)


def _at_most(dataflows: Sequence[Path], unread: list[Unread]) -> list[Path]:
    unread += (_unread("dataflows", path) for path in dataflows[MOST_DATAFLOWS:])
    return list(dataflows[:MOST_DATAFLOWS])


def _entries(
    folder: Path, is_excluded: IsExcluded, unread: list[Unread]
) -> Iterator[tuple[int, Path]]:
    """Yield depth and path of files that may be of robots; add unread ones to `unread`."""
    folders = deque([(0, folder)])
    listed = 0
    while folders:
        depth, path = folders.popleft()
        if listed > MOST_ENTRIES:
            unread.append(_unread("folders", path))
            continue
        try:
            entries = sorted(os.scandir(path), key=lambda entry: entry.name)
        except OSError:
            unread.append(_unread("folders", path))
            continue
        listed += len(entries)
        names = {entry.name for entry in entries}
        # A virtual environment, or a folder that is not to be built.
        if depth and ("pyvenv.cfg" in names or not IGNORE_MARKERS.isdisjoint(names)):
            continue
        for entry in entries:
            is_folder = entry.is_dir(follow_symlinks=False)
            # Most files, such as meshes and headers, are of no kind that matters here.
            if entry.name.startswith(".") or not (is_folder or entry.name.endswith(_ENDINGS)):
                continue
            inner = path / entry.name
            if is_excluded(inner, is_folder):
                continue
            if is_folder and entry.name not in _BUILT:
                folders.append((depth + 1, inner))
            elif entry.is_file(follow_symlinks=False):
                yield depth, inner
            elif inner.suffix == ".mars" and entry.is_symlink() and not entry.is_dir():
                unread.append(_unread("links to `.mars` files", inner))


def _unread(sort: str, path: Path) -> Unread:
    return Unread(sort, str(path), whole_file(str(path)))


def _is_test(folder: Path, path: Path) -> bool:
    return not _OF_TESTS.isdisjoint(path.relative_to(folder).parts)


def _is_dataflow(path: Path, sign: str) -> bool:
    text = _text_of(path)
    return recognised(text) == "dora" and re.search(sign, text) is not None


def _text_of(path: Path) -> str:
    """Return the text of a file, an empty one if it cannot be read."""
    try:
        return read_text(path)
    except MarsError:
        return ""
