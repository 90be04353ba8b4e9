"""The files of a workspace: found below its folder and read within limits.

No path and no symbolic link leads to a file outside the folder.
"""

import os
import re
from collections.abc import Iterator, Mapping, Sequence, Set
from contextlib import suppress
from dataclasses import dataclass
from fnmatch import fnmatchcase, translate
from functools import cache, cached_property, partial
from itertools import chain, islice
from pathlib import Path, PurePosixPath
from typing import NamedTuple

from mars_asp.diagnostic import Diagnostic, MarsError, point, whole_file
from mars_asp.exchange.elements import read_elements
from mars_asp.exchange.folders import IGNORE_MARKERS, IsExcluded, nothing_excluded
from mars_asp.exchange.ros2.cmake import (
    Installed,
    Targets,
    installing_macros,
    is_named,
    read_cmake,
    words_of_programs,
)
from mars_asp.exchange.ros2.setup_files import files_of_setup, has_unknown_scripts, lists_all_files
from mars_asp.exchange.unread import MANIFESTS, Unread
from mars_asp.language.parse import decode, plain_lines, read_bytes
from mars_asp.reading import decoded

#: What a launch file or a source may hold, and how many files a workspace.
MOST_BYTES = 1024 * 1024
_MOST_FILES = 100_000
_MOST_PATH = 4096
_SKIPPED = frozenset(
    {"build", "install", "log", "devel", "node_modules", "__pycache__", "templates"}
    | {"test", "tests"}
)
#: The start of a path in the share folder of a package, as launch files write it.
_SHARE = re.compile(
    r"^\$\((?:find-pkg-share|find-pkg-prefix|find) +([^) ]+)\)(?:/share/\1(?=/|$))?/?"
)
_UP_FROM_SHARE = "../../../../"
_SOURCES = frozenset({".py", ".cpp", ".cc", ".cxx", ".c", ".hpp", ".h", ".hh", ".hxx"})
_KEPT = frozenset(
    {*_SOURCES, ".xml", ".yaml", ".yml", ".launch", ".cfg", ".txt", ".test", ".toml", ".cmake"}
)
#: The path of a submodule in `.gitmodules`.
_SUBMODULE = re.compile(r"(?m)^\s*path\s*=\s*(\S.*?)\s*$")
#: The name of a file with an ending, which no folder has.
_FILE_NAME = re.compile(r"[\w+-][\w .+-]*\.\w+")
#: What a folder that adds to the launch files of the catalogue is called.
OWN_LAUNCH_FILES = "mars-launch"
_CATALOGUE = Path(__file__).parent / "launch_catalogue"
_OF_USERS = re.compile(r"(?:^|/)maps?/|\.(?:bag|db3|mcap|pcd|pgm|pbstream|posegraph)$")
_OF_RESULTS = (".txt", ".csv", ".log")
#: Endings of sources of compiled programs, and of files that never are programs.
_COMPILED = frozenset({".cpp", ".cc", ".cxx", ".c", ".cu"})
_NO_PROGRAMS = frozenset(
    {
        ".launch",
        ".xml",
        ".yaml",
        ".yml",
        ".rviz",
        ".urdf",
        ".xacro",
        ".sdf",
        ".world",
        ".md",
        ".txt",
    }
    | {".msg", ".srv", ".action", ".cfg", ".stl", ".dae", ".png", ".jpg", ".h", ".hpp", ".hh"}
)
#: A copy that an editor or a program that synchronises folders has made.
_COPY = re.compile(r"(?i)copy|conflict|backup")
#: Endings of files whose encoding neither compilers nor CMake ask for.
_OF_BYTES = frozenset({*_SOURCES, ".cmake", ".txt"}) - {".py"}
#: The encoding that a file in Python (PEP 263) or XML declares in its first lines.
_OF_PYTHON = re.compile(rb"(?:[ \t\f]*(?:#[^\n]*)?\n)??[ \t\f]*#[^\n]*?coding[:=][ \t]*([\w.-]+)")
_OF_XML = re.compile(
    rb"\s*<\?xml[^>]*?\sencoding\s*=\s*[\"']((?i:latin|iso-8859|windows-125|koi8)[\w.-]*)"
)
#: Codecs of texts whose time grows with the square of the length.
_SLOW = frozenset({"idna", "punycode"})
_BUILD_FILES = frozenset({"CMakeLists.txt", "setup.py", "setup.cfg", "pyproject.toml"})
#: Commands of others that compose the names of programs.
_COMPOSED = re.compile(r"(?i)add_example|add_demo|\bEXECUTABLE\s+[^)\s]*\$\{")
#: An entry of console scripts that puts together the name of its program.
_COMPOSED_ENTRY = r"[fF][\"']\s*\{|[\"']\s*=\s*\w|%s|\.format\("
#: The setting of where the scripts of a package in Python are installed.
_SCRIPT_FOLDER = re.compile(r"\b(?:install[_-]scripts|script[_-]dir)\b|[\"']lib/")
#: Files that a package in Python installs where programs are.
_INSTALLS_SCRIPTS = re.compile(r"(?<![\w-])scripts\s*=|[\"']/?lib\b")
_PROJECT = re.compile(r"(?i)\bproject\s*\(\s*([\w-]+)")
_PROJECT_NAME = re.compile(r"\$\{(?:PROJECT_NAME|CMAKE_PROJECT_NAME)\}")
_WORD = re.compile(r"\w+")
_XML_NAME = re.compile(r"<name>\s*([A-Za-z][\w-]*)\s*</name>")
_NO_NAME = re.compile(r"<name>\s*</name>")
_BUILD_TYPE = re.compile(r"<build_type[^<>]*>\s*(\w+)")
_CATKIN = re.compile(r"<buildtool_depend[^<>]*>\s*(catkin)\b")
#: The name of a module in its annotations.
_MODULE_NAME = re.compile(r"@module_name[ \t]+(\S+)")
_COMMENT = re.compile(r"<!--.*?(?:-->|\Z)", re.DOTALL)


@dataclass(frozen=True, slots=True)
class Package:
    """A package: its name, its folder and its build types, such as `ament_cmake`."""

    name: str
    folder: Path
    build_types: frozenset[str] = frozenset()

    @property
    def is_of_ros1(self) -> bool:
        """Whether the package is built for ROS 1 (catkin)."""
        return "catkin" in self.build_types

    @property
    def is_of_ros2(self) -> bool:
        """Whether the package is built for ROS 2."""
        return any(each.startswith("ament") for each in self.build_types)

    @property
    def is_built_by_cmake(self) -> bool:
        """Whether the package is built for ROS 2 by CMake, even if it has a `setup.py`."""
        return "ament_cmake" in self.build_types

    @property
    def is_of_python(self) -> bool:
        """Whether the package is built for ROS 2 by its `setup.py`."""
        return "ament_python" in self.build_types


class _Contents(NamedTuple):
    """The names of the files of a package, and the texts of its build files of CMake and Python.

    Possible programs are among the names in the form of `_as_program`.
    """

    names: Set[str]
    build: str
    python: str


class Workspace:
    """The files below the folder of a workspace."""

    def __init__(
        self,
        root: Path,
        named: str,
        *,
        deep: bool = True,
        is_excluded: IsExcluded = nothing_excluded,
    ) -> None:
        """Begin with the folder of the workspace; `named` is the user's path of it.

        `deep` is whether packages are also searched in the folders below; `is_excluded` whether
        a path in the workspace is skipped.
        """
        self._is_excluded = is_excluded
        self.root = root.resolve()
        self.named = named
        self.unread: list[Unread] = []
        self._deep = deep
        self._is_absolute = Path(named).is_absolute()
        self._marked: set[Path] = set()
        #: The marker in each folder that is skipped because it is not to be built.
        self._excluding: list[Path] = []
        self._ignoring: list[Path] = []
        #: The files below the folder that are not links.
        self._own: set[Path] = set()
        # Many launch files, and many branches of one, name the same files.
        self.find = cache(self._find)
        self.catalogued = cache(self._catalogued)
        self.lacking = cache(self._lacking)
        self._submodules = cache(self._find_submodules)
        self.not_installed = cache(self._not_installed)
        self.targets = cache(self._read_targets)
        self._package_around = cache(self._find_package)
        self._contents_of = cache(self._read_contents)
        self._installed = cache(self._read_installed)
        #: The words of a file.
        self.words_in = cache(lambda file: frozenset(_WORD.findall(self.readable(file))))
        self._texts: dict[Path, str] = {}
        self._shown: dict[Path, str] = {}

    def given(self, path: str, text: str) -> Path:
        """Return the path of a file or folder named by the user; `text` is a file's content.

        Raises:
            MarsError: the file is too large.
        """
        if len(text) > MOST_BYTES:
            message = f"the file has more than {MOST_BYTES} characters, which no launch file needs"
            help_text = "name the launch file that starts the robot"
            place = whole_file(path)
            raise MarsError((Diagnostic("launch", "error", message, place, help=help_text),))
        there = Path(path).exists()
        # What the user names is read, wherever it is linked to.
        found = Path(path).resolve() if there else self.root / path
        self._shown[found] = path
        if not found.is_dir():
            self._texts[found] = text
        return found

    def shown(self, file: Path) -> str:
        """Return a file's path as the user would write it."""
        if file not in self._shown:
            self._shown[file] = str(file) if self._is_absolute else os.path.relpath(file)
        return self._shown[file]

    @cached_property
    def files(self) -> tuple[Path, ...]:
        """The files of readable kinds, without those of build folders."""
        found: list[Path] = []
        for folder, folders, names in os.walk(self.root):
            at = Path(folder)
            if at != self.root and not IGNORE_MARKERS.isdisjoint(names):
                self._marked.add(at)
                # In a package a marker hides sources from linters alone.
                if not any((each / "package.xml").exists() for each in self._above(at)):
                    self._excluding.append(at / min(IGNORE_MARKERS.intersection(names)))
                    names.clear()
                    folders.clear()
            self._ignoring += [at / ".gitignore"] * (".gitignore" in names)
            if not self._deep:
                folders.clear()
            folders[:] = sorted(
                name
                for name in folders
                if not name.startswith(".")
                and name not in _SKIPPED
                and not self._is_excluded(at / name, True)
            )
            for name in folders:
                self._note_link(at / name)
            for name in sorted(names):
                path = at / name
                is_link = path.is_symlink()
                if is_link and self._note_link(path):
                    continue
                is_kept = path.suffix.lower() in _KEPT or os.access(path, os.X_OK)
                # A pipe would be waited for.
                if is_kept and path.is_file() and not self._is_excluded(path, False):
                    found.append(path)
                    if not is_link:
                        self._own.add(path)
            if len(found) > _MOST_FILES:
                sort = f"files of a folder with more than {_MOST_FILES}, beyond those,"
                self.unread.append(Unread(sort, self.named, whole_file(self.named)))
                break
        return tuple(found)

    def _above(self, path: Path) -> Sequence[Path]:
        """Return the folders of the workspace that contain a path, the innermost first."""
        return path.parents[: len(path.parts) - len(self.root.parts)]

    def _note_link(self, path: Path) -> bool:
        """Whether a path is a broken link or leads out of the workspace; note such a link."""
        if not path.is_symlink() or self._inside(path) is not None:
            return False
        place = whole_file(self.shown(path))
        self.unread.append(Unread("links out of the workspace", path.name, place))
        return True

    def _inside(self, path: Path) -> Path | None:
        """Return the real path of a file or folder, or None if it is outside the workspace."""
        if path in self._own:
            return path
        try:
            real = path.resolve()
        except (OSError, RuntimeError):
            return None
        inside = real == self.root or self.root in real.parents
        return real if inside and (real.is_file() or real.is_dir()) else None

    @cached_property
    def _by_manifest(self) -> Mapping[Path, Package]:
        """The package of each folder with a manifest."""
        manifests = (file for file in self.files if file.name == "package.xml")
        packages = filter(None, map(self._described_by, manifests))
        return {package.folder: package for package in packages}

    def _described_by(self, manifest: Path) -> Package | None:
        """Return the package of a manifest, None for a template, whose name is an expression."""
        text = _COMMENT.sub("", self.readable(manifest))
        match = _XML_NAME.search(text)
        if match is None and "</name>" in text and _NO_NAME.search(text) is None:
            return None
        name = match[1] if match else manifest.parent.name
        built = frozenset(_BUILD_TYPE.findall(text) or _CATKIN.findall(text))
        return Package(name, manifest.parent, built)

    def marker_of(self, path: str) -> Path | None:
        """Return the marker that keeps the package of a shared path from being built, or None."""
        match = _SHARE.match(path)
        if match is None or self.package(match[1]) is not None:
            return None
        return self._markers.get(match[1])

    @cached_property
    def _markers(self) -> Mapping[str, Path]:
        """The markers that keep packages from being built, by the names of these."""
        found: dict[str, Path] = {}
        for marker in self._excluding:
            for folder, _, names in islice(os.walk(marker.parent), _MOST_FILES):
                if "package.xml" in names:
                    package = self._described_by(Path(folder) / "package.xml")
                    found |= {} if package is None else {package.name: marker}
        return found

    def _note_errors(self, manifest: Path) -> None:
        """Note the error of the manifest of a package that no build reads."""
        shown = self.shown(manifest)
        try:
            root = read_elements(self.text(manifest), shown)
        except MarsError as error:
            message, place = error.diagnostics[0].message, error.diagnostics[0].span
        else:
            element = next(root.named("name"), None)
            if element is not None and _NO_NAME.search(self.text(manifest)) is None:
                return
            lack = "has no `<name>`" if element is None else "has an empty `<name>`"
            message, place = f"`{root.name}` {lack}", (element or root).span
        self.unread.append(Unread(MANIFESTS, f"{shown}: {message}", place))

    def is_nested(self, path: Path) -> bool:
        """Whether a path is in a package inside another package, which no build finds.

        The workspace's folder may itself be a package, with others in it.
        """
        around = [path, *self._above(path)]
        first, *others = [each for each in around if each in self._by_manifest] or [self.root]
        is_marked = not self._marked.isdisjoint((first, *self._above(first)))
        return first != self.root and (is_marked or bool({*others} - {self.root}))

    @cached_property
    def packages(self) -> tuple[Package, ...]:
        """The packages that a build finds, the deepest first."""
        found = []
        for folder, package in self._by_manifest.items():
            if self.is_nested(folder):
                place = whole_file(self.shown(folder / "package.xml"))
                sort = "packages in the folders of others, which no build finds,"
                self.unread.append(Unread(sort, package.name, place))
            else:
                self._note_errors(folder / "package.xml")
                found.append(package)
        return tuple(sorted(found, key=lambda package: -len(package.folder.parts)))

    def package(self, name: str) -> Package | None:
        """Return the first package with a name, or None."""
        return next(iter(self._by_name.get(name, ())), None)

    @cached_property
    def _by_name(self) -> Mapping[str, Sequence[Package]]:
        """The packages of each name; there may be several by mistake."""
        found: dict[str, list[Package]] = {}
        for each in self.packages:
            found.setdefault(each.name, []).append(each)
        return found

    def _meant(self, name: str, folder: Path) -> Sequence[Package]:
        """Return the packages that a name in a file of `folder` may mean.

        It is the package around the folder if it has the name, else all of the name.
        """
        named = self._by_name.get(name, ())
        around = [each for each in named if each.folder in (folder, *folder.parents)]
        return around[:1] or named

    def _sole(self, name: str, folder: Path) -> Package | None:
        """Return the package that a name means in a folder, or None if not exactly one."""
        found = self._meant(name, folder)
        return found[0] if len(found) == 1 else None

    def package_of(self, file: Path) -> Package | None:
        """Return the package that contains a file, or None."""
        return self._package_around(file.parent)

    def _find_package(self, folder: Path) -> Package | None:
        """Return the innermost package that contains a folder, or None."""
        found = (self._by_folder[at] for at in (folder, *folder.parents) if at in self._by_folder)
        return next(found, None)

    @cached_property
    def _by_folder(self) -> dict[Path, Package]:
        return {each.folder: each for each in self.packages}

    @cached_property
    def by_package(self) -> dict[Path, list[Path]]:
        """The files of each package, by its folder."""
        found: dict[Path, list[Path]] = {each.folder: [] for each in self.packages}
        for file in self.files:
            package = self.package_of(file)
            if package is not None:
                found[package.folder].append(file)
        return found

    def _find(self, path: str, folder: Path) -> Path | None:
        """Return the file that a path in a launch file of `folder` names, or None."""
        if not path or "\0" in path or len(path) > _MOST_PATH:
            return None
        match = _SHARE.match(path)
        # A relative path begins where the launch file is started: mostly above `src`.
        above = self.root.parent if self.root.name == "src" else self.root
        candidates: Sequence[Path] = (folder / path, above / path)
        if match:
            inner = path[match.end() :].lstrip("/")
            candidates = [
                file
                for package in self._meant(match[1], folder)
                for file in (package.folder / inner, *self._installed_sources(package, inner))
            ]
            # Four folders above `install/PACKAGE/share/PACKAGE` is the workspace.
            if inner.startswith(_UP_FROM_SHARE):
                candidates.append(above / inner.removeprefix(_UP_FROM_SHARE))
        for candidate in candidates:
            try:
                found = self._inside(candidate)
            except (OSError, ValueError):
                continue
            if found is not None and found.is_file():
                return found
        return None

    def _catalogued(self, path: str) -> Path | None:
        """Return the catalogue's form of another package's launch file, or None."""
        match = _SHARE.match(path)
        inside = "" if match is None else path[match.end() :]
        if match is None or not inside or ".." in Path(inside).parts or self.package(match[1]):
            return None
        name = Path(match[1]) / f"{inside}.yaml"
        roots = (self.root, *(package.folder for package in self.packages))
        own = (each / OWN_LAUNCH_FILES for each in roots)
        for folder in (*own, _CATALOGUE):
            file = folder / name
            if folder == _CATALOGUE and file.is_file():
                if file not in self._texts:
                    self._texts[file] = file.read_text(encoding="utf-8")
                    self._shown[file] = f"catalogue/{name.as_posix()}"
                return file
            # To follow the links of a file takes longer than to see that it is not there.
            is_own = folder != _CATALOGUE and file.is_file()
            found = self._inside(file) if is_own else None
            if found is not None and found.is_file():
                return found
        return None

    def _lacking(self, path: str, folder: Path) -> tuple[str, str] | None:
        """Return package and inner path of a file that the package certainly lacks, or None.

        It is not lacking if the build may generate it: from a template, from a file of the same
        name elsewhere, or if the build file names it. In a catkin workspace paths are those of
        sources.
        """
        match = _SHARE.match(path)
        if match is None:
            # A path from the folder of a launch file is that of its package.
            whole = Path(os.path.normpath(path[:_MOST_PATH]))
            package = self.package_of(whole) if whole.is_absolute() else None
            inside = "" if package is None else whole.relative_to(package.folder).as_posix()
        else:
            package = self._sole(match[1], folder)
            inside = PurePosixPath(path[match.end() :].lstrip("/")).as_posix()
        if package is None or (inside.startswith("../") and not package.is_of_ros1):
            return None
        name = inside.rpartition("/")[2]
        is_file = _FILE_NAME.fullmatch(name) is not None and "$(" not in inside
        # Maps and recordings are made by users, and files that git ignores by programs.
        if not is_file or _OF_USERS.search(inside) or self._is_ignored(package, inside):
            return None
        file = package.folder / inside
        if any(file.is_relative_to(each) for each in self._submodules(package.folder)):
            return None
        # A program makes the folder of its results.
        if name.endswith(_OF_RESULTS) and not (package.folder / inside).parent.is_dir():
            return None
        if self._may_have(package, name):
            contents, *texts = self._contents_of(package)
            # What the build file installs from elsewhere would have been found.
            is_elsewhere = (
                name in contents
                and f"{name}.in" not in contents
                and all(name not in text for text in texts)
            )
            if not is_elsewhere or not (package.is_of_ros1 or (match and self._lists_all(package))):
                return None
        return package.name, inside

    def _not_installed(self, path: str, folder: Path) -> tuple[str, str] | None:
        """Return package and inner path of an existing file that is not installed, or None.

        None also means that the path is not in the shared folder of one package of ROS 2 here, or
        that an unread part of the build file may install it.
        """
        match = _SHARE.match(path)
        package = None if match is None else self._sole(match[1], folder)
        if match is None or package is None or not package.is_of_ros2:
            return None
        inside = PurePosixPath(path[match.end() :].lstrip("/")).as_posix()
        file = package.folder / inside
        is_file = ".." not in inside and "/" in inside and file.is_file()
        if not is_file or file in self._installed_sources(package, inside):
            return None
        is_sure = self._lists_all(package) and not self._is_ignored(package, inside)
        return (package.name, inside) if is_sure else None

    def left_out(self, file: Path) -> tuple[str, str] | None:
        """Return package and inner path of a launch file that is not installed, or None.

        It may be in any shared folder. A package of ROS 2 that installs nothing is assumed to be
        launched by paths, so that None is returned.
        """
        package = self.package_of(file)
        if package is None or not package.is_of_ros2:
            return None
        inside = file.relative_to(package.folder).as_posix()
        if self._is_ignored(package, inside):
            return None
        installed = self._installed(package)
        patterns = (f"{at.rstrip('/')}/*" if folder else at for at, _, folder in installed)
        is_left_out = installed and not any(fnmatchcase(inside, pattern) for pattern in patterns)
        is_meant = inside.startswith("launch/") and _COPY.search(file.name) is None
        is_sure = is_left_out and is_meant and self._lists_all(package)
        return (package.name, inside) if is_sure else None

    def _lists_all(self, package: Package) -> bool:
        """Whether the build file of a package lists all shared files, and was fully read."""
        if package.is_of_python:
            configuration = self.readable(package.folder / "setup.cfg")
            setup = self.readable(package.folder / "setup.py")
            return "data_files" not in configuration and lists_all_files(setup)
        has_build_file = (package.folder / "CMakeLists.txt").is_file()
        return has_build_file and self.targets(package).is_whole

    def has_program(self, package: str, executable: str, of_ros2: bool | None) -> bool:
        """Whether a package may have a program; true if it is not here, or is of the other ROS."""
        found = self._by_name.get(package)
        if found is None or self.is_for_other_ros(package, of_ros2):
            return True
        return any(self._may_have_program(each, executable) for each in found)

    def is_for_other_ros(self, package: str, of_ros2: bool | None) -> bool:
        """Whether a package here is for the other ROS version than a launch file naming it.

        The launch file then means a package of the same name elsewhere.
        """
        found = self.package(package)
        if found is None or of_ros2 is None or found.is_of_ros1 == found.is_of_ros2:
            return False
        return of_ros2 != found.is_of_ros2

    def places_scripts(self, package: Package) -> bool:
        """Whether a package need not state, or states, where its scripts are installed."""
        if not package.is_of_python or self._is_ignored(package, "setup.cfg"):
            return True
        files = (package.folder / name for name in ("setup.cfg", "setup.py", "pyproject.toml"))
        return any(map(_SCRIPT_FOLDER.search, map(self.readable, files)))

    def _find_submodules(self, folder: Path) -> tuple[Path, ...]:
        """Return the folders of git submodules around a package, which a clone leaves empty."""
        found: list[Path] = []
        for above in (folder, *self._above(folder), self.root):
            listed = self.readable(above / ".gitmodules")
            found += (above / path for path in _SUBMODULE.findall(listed))
        return tuple(found)

    def _is_ignored(self, package: Package, inside: str) -> bool:
        """Whether git ignores a path inside a package, or a folder above it."""
        file = Path(os.path.normpath(package.folder / inside[:_MOST_PATH]))
        for folder in file.parents:
            parts = file.relative_to(folder).parts if folder in self._ignored else ()
            paths = [f"/{'/'.join(parts[:size])}" for size in range(1, len(parts) + 1)]
            for pattern, is_for_folders in self._ignored.get(folder, ()):
                if any(map(pattern.match, paths[:-1] if is_for_folders else paths)):
                    return True
        return False

    @cached_property
    def _ignored(self) -> Mapping[Path, Sequence[tuple[re.Pattern[str], bool]]]:
        """The patterns of `.gitignore` by its folder, with whether they match folders only."""
        found = {}
        for file in self._ignoring:
            patterns = (line.strip() for line in self.readable(file).split("\n"))
            found[file.parent] = [
                (_pattern_of(each), each.endswith("/"))
                for each in patterns
                if each and each[0] not in "#!"
            ]
        return found

    def _read_contents(self, package: Package) -> _Contents:
        """Return the names of the files of a package, and the texts of its build files."""
        found: dict[str, None] = {}
        python = build = ""
        for folder, folders, names in os.walk(package.folder):
            folders[:] = [each for each in folders if not each.startswith(".")]
            found |= dict.fromkeys(names)
            for each in names:
                text = ""
                if each in _BUILD_FILES or each.endswith(".cmake"):
                    text = self.readable(Path(folder) / each)
                if each.startswith(("setup.", "pyproject.")):
                    python += f"{text}\n"
                else:
                    build += f"{text}\n"
        projects = dict.fromkeys((package.name, *_PROJECT.findall(build)))
        build = "\n".join(_PROJECT_NAME.sub(each, build) for each in projects)
        programs = map(_as_program, chain(found, words_of_programs(build)))
        return _Contents({*found, *programs}, build, python)

    def _may_have(self, package: Package, name: str) -> bool:
        """Whether a package has a file `name` or its template, or its build file names it."""
        contents, build, python = self._contents_of(package)
        stem = name.partition(".")[0]
        templates = (f"{stem}.xacro", f"{name}.xacro") if name.endswith((".urdf", ".sdf")) else ()
        has_file = not contents.isdisjoint((name, f"{name}.in", *templates))
        return has_file or _mentions(build + python, name)

    def _may_have_program(self, package: Package, name: str) -> bool:
        """Whether a package has a script `name`, or its build files name such a program."""
        contents, build, python = self._contents_of(package)
        is_of_cmake = "CMakeLists.txt" in contents
        if "." in name:
            installs_files = is_of_cmake or _INSTALLS_SCRIPTS.search(python) is not None
            # A module of a package in Python does not count.
            is_listed = package.is_of_python and not installs_files and self._lists_all(package)
            return _mentions(python, name) if is_listed else self._may_have(package, name)
        if "console_scripts" in python and not is_of_cmake:
            if has_unknown_scripts(self.readable(package.folder / "setup.py")):
                return True
            # A package of Python has the programs that its build file lists, whatever its files.
            if name == package.name:
                entry = rf"(?m)(?:^|[\"'])[ \t]*{re.escape(name)}[ \t]*="
                return re.search(f"{entry}|{_COMPOSED_ENTRY}", python) is not None
            return _mentions(python, name)
        if _as_program(name) in contents or f"{name}.in" in contents or _mentions(python, name):
            return True
        # A source is built only where the build file names it, but names may be composed.
        if not is_of_cmake:
            return f"{name} (source)" in contents
        targets = self.targets(package)
        is_listed = targets.has_all_names and _COMPOSED.search(build) is None
        return name in targets.executables or not is_listed

    def _installed_sources(self, package: Package, path: str) -> Iterator[Path]:
        """Yield the source files that may be installed as `path` in the shared folder."""
        folder, _, name = path.rpartition("/")
        for source, target, is_folder in self._installed(package):
            above, _, last = source.rpartition("/")
            if not is_folder:
                if folder == target and fnmatchcase(name, last):
                    yield package.folder / above / name
                    if set(above) & set("*?[") or last == "**":
                        yield from self._named_by(source, name, package)
                continue
            # Without a slash at its end a folder keeps its name.
            below = "/".join(filter(None, (target, last)))
            if not below or path.startswith(f"{below}/"):
                inner = path[len(below) :].lstrip("/")
                yield package.folder / source / inner

    def _named_by(self, pattern: str, name: str, package: Package) -> Iterator[Path]:
        """Yield the files of a name in any folder of a package that a pattern names."""
        plain = os.path.normpath(pattern)
        for file in self.by_package[package.folder]:
            inside = file.relative_to(package.folder).as_posix()
            if file.name == name and is_named(inside, plain):
                yield file

    def _read_installed(self, package: Package) -> Sequence[Installed]:
        """Return the shared files that a package installs."""
        found = list(self.targets(package).installed)
        # A path with very many summands is not read.
        with suppress(RecursionError):
            found += files_of_setup(self.readable(package.folder / "setup.py"), package.name)
        return found

    def _read_targets(self, package: Package) -> Targets:
        """Return the targets that CMake builds in a package; empty for other packages."""
        files = {
            file.relative_to(package.folder).as_posix(): partial(self.readable, file)
            for file in self.by_package[package.folder]
        }
        build = files.get("CMakeLists.txt")
        return Targets() if build is None else read_cmake(build(), files, self._macros)

    @cached_property
    def _macros(self) -> frozenset[str]:
        """The macros and functions in CMake modules of the workspace that may install files."""
        modules = (file for file in self.files if file.suffix == ".cmake")
        return frozenset(chain.from_iterable(map(installing_macros, map(self.readable, modules))))

    def annotated_modules(self) -> Iterator[Unread]:
        """Yield the annotated modules of the sources that were read: nothing takes them."""
        sort = "annotations of modules (for `@sources` of a `.mars` file)"
        for file, text in sorted(self._texts.items()):
            if file.suffix in _SOURCES and "@module_start" in text:
                for match in _MODULE_NAME.finditer(text):
                    line = text.count("\n", 0, match.start()) + 1
                    yield Unread(sort, match[1], point(self.shown(file), line, 1))

    def readable(self, file: Path) -> str:
        """Return the text of a file, or "" if it cannot be read."""
        try:
            is_here = file in self._texts or self._inside(file) is not None
            return self.text(file) if is_here else ""
        except MarsError:
            return ""

    def text(self, file: Path) -> str:
        r"""Return the text of a file, with `\n` for every line end.

        Raises:
            MarsError: the file is too large, cannot be read, or is not a text in an encoding that
                what builds or runs it reads.
        """
        if file not in self._texts:
            shown = self.shown(file)
            raw = read_bytes(file, MOST_BYTES)
            text = plain_lines(decode(_in_utf8(raw, file.suffix), shown, MOST_BYTES))
            if "\0" in text:
                message, help_text = "the file is not a text", "name a launch file or a folder"
                place = whole_file(shown)
                raise MarsError((Diagnostic("encoding", "error", message, place, help=help_text),))
            self._texts[file] = text
        return self._texts[file]


def _in_utf8(raw: bytes, suffix: str) -> bytes:
    """Return the content of a file in UTF-8 if what builds or runs the file reads its encoding.

    Python imports files with comments in any encoding.
    """
    is_python = suffix == ".py"
    if raw.isascii():
        return raw
    declared = (_OF_PYTHON if is_python else _OF_XML).match(raw)
    name = "" if declared is None else declared[1].decode()
    with suppress(LookupError, UnicodeError):
        if name and name.lower() not in _SLOW:
            return raw.decode(name.removesuffix("-unix")).encode()
    return decoded(raw).encode() if is_python or suffix in _OF_BYTES else raw


def _pattern_of(line: str) -> re.Pattern[str]:
    """Return the regular expression for a line of `.gitignore`, to match `/PATH` in its folder."""
    inner = line.rstrip("/")
    is_whole = "/" in inner and not inner.startswith("**/")
    return re.compile(
        translate(f"/{inner.lstrip('/')}" if is_whole else f"*/{inner.removeprefix('**/')}")
    )


def _mentions(text: str, name: str) -> bool:
    """Whether the text of a build file contains a name as a word."""
    return re.search(rf"(?<![\w.-]){re.escape(name)}(?![\w-])", text) is not None


def _as_program(file: str) -> str:
    """Return the entry in `_Contents` for a file that may be a program, such as `a (script)`."""
    stem, _, _ = file.partition(".")
    suffix = Path(file).suffix.lower()
    if suffix in _NO_PROGRAMS:
        return file
    return f"{stem} (source)" if suffix in _COMPILED else f"{stem} (script)"
