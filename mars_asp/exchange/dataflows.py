"""The dataflows of dora in a folder, at any depth."""

import os
import re
from collections import deque
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from mars_asp.diagnostic import Diagnostic, MarsError, point
from mars_asp.exchange.recognise import key_pattern, recognised
from mars_asp.exchange.unread import Unread, notes
from mars_asp.language.parse import read_text

#: Folders of builds, packages, templates and tests; hidden ones and virtual environments are
#: skipped, and so are folders of tests where ROS is read.
_SKIPPED = frozenset(
    "build target node_modules __pycache__ venv template templates test tests fixtures".split()
)
#: A folder with packages of ROS up to this depth is a workspace of ROS.
_NEAR = 2
#: How many entries of folders are listed, how many YAML files are read, and how many are taken.
MOST_ENTRIES = 100_000
MOST_YAML = 5_000
MOST_DATAFLOWS = 300
#: A node of a dataflow has one of these keys; other files have lists of nodes as well.
_OF_NODES = key_pattern("inputs|outputs|path|custom|operators?|ros2|module|hub|git")
#: Beside packages of ROS, which have lists of nodes with paths.
_OF_DORA = key_pattern("inputs|outputs|custom|operators?")
_LAUNCH = (
    ".launch",
    *(f"{mark}launch.{end}" for mark in "._" for end in ("py", "xml", "yaml", "yml")),
)


class Dataflows(NamedTuple):
    """The dataflows in a folder, nearest first, and notes on the rest of the folder.

    `is_ros` is whether the folder is a workspace of ROS as well.
    """

    files: tuple[Path, ...]
    notes: tuple[Diagnostic, ...]
    is_ros: bool = False


def dataflows_in(folder: Path) -> Dataflows:
    """Return the dataflows of dora in a folder; of a workspace of ROS none unless one is near.

    Symbolic links are not followed.
    """
    unread: list[Unread] = []
    yaml: list[tuple[int, Path]] = []
    packages: list[tuple[int, Path]] = []
    has_launch = False
    for depth, path in _entries(folder, unread):
        if path.name == "package.xml":
            packages.append((depth, path))
        has_launch = has_launch or path.name.endswith(_LAUNCH)
        if path.suffix in (".yml", ".yaml"):
            yaml.append((depth, path))
    yaml.sort()
    read = [path for _, path in yaml[:MOST_YAML]]
    sign = _OF_DORA if packages else _OF_NODES
    if packages or has_launch:
        near = (path for depth, path in yaml[:MOST_YAML] if depth <= _NEAR)
        if not any(_is_dataflow(path, sign) for path in near):
            return Dataflows((), ())
    found = [path for path in read if _is_dataflow(path, sign)]
    unread += (_unread("YAML files", path) for _, path in yaml[MOST_YAML:])
    unread += (_unread("dataflows", path) for path in found[MOST_DATAFLOWS:])
    is_ros = has_launch and any(depth <= _NEAR for depth, _ in packages)
    if not is_ros:
        unread += (_unread("packages of ROS", path) for _, path in packages)
    return Dataflows(tuple(found[:MOST_DATAFLOWS]), tuple(notes(unread)), is_ros)


def _entries(folder: Path, unread: list[Unread]) -> Iterator[tuple[int, Path]]:
    """Yield the files in a folder with their depth; note folders that are not searched."""
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
        # A virtual environment.
        if depth and any(entry.name == "pyvenv.cfg" for entry in entries):
            continue
        for entry in entries:
            if entry.is_dir(follow_symlinks=False):
                if entry.name not in _SKIPPED and not entry.name.startswith("."):
                    folders.append((depth + 1, path / entry.name))
            elif entry.is_file(follow_symlinks=False):
                yield depth, path / entry.name


def _unread(sort: str, path: Path) -> Unread:
    return Unread(sort, str(path), point(str(path), 1, 1))


def _is_dataflow(path: Path, sign: str) -> bool:
    try:
        text = read_text(path)
    except MarsError:
        return False
    return recognised(text) == "dora" and re.search(sign, text) is not None
