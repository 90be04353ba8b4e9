"""Read the sources of programs, and the installed files, from a `CMakeLists.txt`."""

import posixpath
import re
from collections.abc import Callable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from itertools import pairwise
from typing import NamedTuple, TypeAlias

#: Comments and strings, brackets and words; one pattern that any text fits.
_TOKEN = re.compile(
    r"#\[(?P<eq>=*)\[.*?(?:\](?P=eq)\]|\Z)|#[^\n]*|\[(?P<raw>=*)\[.*?(?:\](?P=raw)\]|\Z)"
    r'|"(?:\\.|[^"\\])*"?|[()]|(?:\\.|[^\s()#"\\])+|\\',
    re.DOTALL,
)
_VARIABLE = re.compile(r"\$\{([\w-]+)\}")
_EXECUTABLES = frozenset({"add_executable", "ament_auto_add_executable", "cuda_add_executable"})
_LIBRARIES = frozenset({"add_library", "ament_auto_add_library", "cuda_add_library"})
#: Commands that make files, which another command may install.
_MAKING = frozenset({"configure_file", "add_custom_command", "execute_process", "file"})
#: Commands that install something, but no shared files of the package that are not read.
_INSTALLING = frozenset(
    {
        "install",
        "catkin_install_python",
        "ament_python_install_package",
        "ament_python_install_module",
    }
)
#: Commands that name no programs, or only those that another command makes.
_WITHOUT_PROGRAMS = _LIBRARIES | frozenset(
    "add_compile_options add_definitions add_dependencies add_message_files add_service_files"
    " add_action_files add_subdirectory ament_auto_package ament_package"
    " ament_python_install_package ament_target_dependencies catkin_package catkin_python_setup"
    " else elseif endif endfunction endmacro get_target_property if include include_directories"
    " install link_directories link_libraries message project set_property set_target_properties"
    " rclcpp_components_register_node rclcpp_components_register_nodes string".split()
)
_WITHOUT_PROGRAM = (
    "ament_add_",
    "ament_export_",
    "find_",
    "generate_",
    "pluginlib_",
    "rosidl_",
    "target_",
)
#: Commands that change variables in ways that are not followed.
_CHANGING = frozenset({"get_filename_component", "list", "math", "string"})
#: Commands that name programs, or repeat those that do.
_NAMING = _EXECUTABLES | {
    "catkin_install_python",
    "foreach",
    "rclcpp_components_register_node",
    "set_target_properties",
}
#: Words before the name of a program.
_PROGRAM_KEYS = frozenset({"EXECUTABLE", "OUTPUT_NAME", "RENAME"})
_FILE_WORD = re.compile(r"[\w.+-]+")
_BLOCKS = frozenset({"macro", "function", "foreach"})
_DEFINITION = re.compile(r"(?im)^[ \t]*(?:macro|function)[ \t]*\([ \t]*([\w-]+)")
_MAY_INSTALL = re.compile(r"(?i)(?:install\w*|\binclude)[ \t]*\(")
#: The folder of the package at the start of absolute paths.
_PACKAGE = "/package"
_MOST_WORDS = 10_000
_MOST_COMMANDS = 10_000
_DEEPEST = 20

#: A command and its words, and the words of variables.
_Command: TypeAlias = tuple[str, list[str]]
_Values: TypeAlias = dict[str, list[str]]


class Installed(NamedTuple):
    """Files or a folder of a package that are installed below a folder of its shared files.

    `source` may be a pattern; a folder is installed by its own name, or with a slash at its end by
    its content.
    """

    source: str
    target: str
    is_folder: bool = False


@dataclass(slots=True)
class Targets:
    """Sources of targets, the targets that they link, and which are programs and components.

    `programs` are files that are installed as they are, `started` the components that programs
    start; `installed` are the shared files, and `is_whole` is false if unread commands may install
    more. `has_all_names` is false if the name of a program depends on what was not read.
    """

    sources: dict[str, list[str]] = field(default_factory=dict)
    links: dict[str, list[str]] = field(default_factory=dict)
    executables: dict[str, str] = field(default_factory=dict)
    plugins: dict[str, str] = field(default_factory=dict)
    started: dict[str, str] = field(default_factory=dict)
    programs: list[str] = field(default_factory=list)
    installed: list[Installed] = field(default_factory=list)
    is_whole: bool = True
    has_all_names: bool = True

    def of(self, target: str) -> list[str]:
        """Return the sources of a target and, transitively, of the targets that it links."""
        found: list[str] = []
        waiting, seen = [target], set[str]()
        while waiting:
            each = waiting.pop()
            if each not in seen:
                seen.add(each)
                found += self.sources.get(each, ())
                waiting += self.links.get(each, ())
        return found


def installing_macros(text: str) -> Iterator[str]:
    """Yield the names of macros and functions defined in a CMake text that may install files."""
    if _MAY_INSTALL.search(text):
        yield from map(str.lower, _DEFINITION.findall(text))


def words_of_programs(text: str) -> Iterator[str]:
    """Yield the words of CMake commands that may be names of programs or of their files."""
    commands = list(_cmake_commands(text))
    libraries = {words[0] for name, words in commands if name in _LIBRARIES and words}
    for name, words in commands:
        named = [word for key, word in pairwise(words) if key in _PROGRAM_KEYS]
        is_installing = name == "install" and words[:1] in (["PROGRAMS"], ["TARGETS"])
        if is_installing or not (name in _WITHOUT_PROGRAMS or name.startswith(_WITHOUT_PROGRAM)):
            used = (w for key, w in pairwise(("", *words)) if key != "DESTINATION")
            named += (word for word in used if word not in libraries)
        for word in named:
            yield from _FILE_WORD.findall(word.rpartition("/")[2])


def read_cmake(
    text: str,
    files: Mapping[str, Callable[[], str]] | None = None,
    elsewhere: Set[str] = frozenset(),
) -> Targets:
    """Return the targets of a `CMakeLists.txt`; all branches of conditions are read.

    `files` are the files of the package by their paths in it, each with a function that returns
    its text: included files and those of subfolders are read, and patterns name their files.
    Paths are relative to the package. `elsewhere` are the macros and functions of other
    packages that may install something.
    """
    reader = _CMakeReader(files or {}, elsewhere)
    reader.follow(list(_cmake_commands(text)), "", {"CMAKE_INSTALL_DATADIR": ["share"]})
    reader.targets.is_whole &= reader.left > 0
    return reader.targets


class _CMakeReader:
    """Follows the commands of a package, through loops, macros and the files they name."""

    def __init__(self, files: Mapping[str, Callable[[], str]], elsewhere: Set[str]) -> None:
        self.files = files
        self.elsewhere = elsewhere
        #: The files that an include names by the name of a module.
        self.modules = {posixpath.basename(path).removesuffix(".cmake"): path for path in files}
        self.targets = Targets()
        self.macros: dict[str, tuple[Sequence[str], Sequence[_Command]]] = {}
        self.automatic: list[str] = []
        self.read: dict[str, Sequence[_Command]] = {}
        #: The variables whose values are not known in full.
        self.changed = set[str]()
        self.depth = 0
        self.left = _MOST_COMMANDS

    def follow(self, commands: Sequence[_Command], folder: str, values: _Values) -> None:
        """Execute the commands of a file in `folder`, which may change the variables."""
        if self.depth > _DEEPEST:
            return
        self.depth += 1
        values["CMAKE_CURRENT_SOURCE_DIR"] = values["CMAKE_CURRENT_LIST_DIR"] = [
            posixpath.join(_PACKAGE, folder).rstrip("/")
        ]
        values["CMAKE_SOURCE_DIR"] = values["PROJECT_SOURCE_DIR"] = [_PACKAGE]
        at = 0
        while at < len(commands) and self.left > 0:
            name, words = commands[at]
            at += 1
            self.left -= 1
            given = _expanded(words, values)
            self.note_names(name, words, values)
            if name == "install" and given[:1] in (["FILES"], ["DIRECTORY"]):
                named = {match[1] for word in words if (match := _VARIABLE.fullmatch(word))}
                self.targets.is_whole &= named <= values.keys()
            if name in _BLOCKS:
                end = _end_of_block(commands, at, name)
                body = commands[at:end]
                at = end + 1
                if name == "foreach":
                    self.follow_loop(given, body, folder, values)
                elif given:
                    self.macros[given[0].lower()] = given[1:], body
            elif name in self.macros:
                # A call copies the variables and has one for each of its words.
                self.left -= (len(values) + len(given)) // 100
                parameters, body = self.macros[name]
                arguments: _Values = {f"ARGV{at}": [each] for at, each in enumerate(given)}
                arguments |= {name: [each] for name, each in zip(parameters, given, strict=False)}
                arguments |= {"ARGV": given, "ARGN": given[len(parameters) :]}
                inner = {**values, **arguments}
                self.follow(body, folder, inner)
                values |= {key: inner[key] for key in inner.keys() - arguments.keys()}
            else:
                # Commands of other packages, and scripts, may install more.
                is_script = name == "install" and given[:1] in (["CODE"], ["SCRIPT"])
                may_install = is_script or ("install" in name and name not in _INSTALLING)
                is_making = name in _MAKING and given[:1] not in (["GLOB"], ["GLOB_RECURSE"])
                is_unread = name in self.elsewhere
                self.targets.is_whole &= not (may_install or is_making or is_unread)
                if given:
                    self.take_command(name, given, folder, values)
        self.depth -= 1

    def note_names(self, name: str, words: Sequence[str], values: _Values) -> None:
        """Note whether a command names programs by variables that are not known."""
        used = {match[1] for word in words for match in _VARIABLE.finditer(word)}
        if name == "foreach":
            used |= {*words[1:]} & self.changed
        is_followed = name == "list" and words[:1] == ["APPEND"]
        if name in _CHANGING and not is_followed:
            self.changed.update(words)
        elif name == "set" and words:
            # Of two branches, the last one alone is in the values.
            is_other = values.get(words[0], words[1:]) != words[1:]
            if is_other or used & self.changed or not used <= values.keys():
                self.changed.add(words[0])
        elif name in _NAMING or (name == "install" and words[:1] == ["PROGRAMS"]):
            is_known = used <= values.keys() and not used & self.changed
            self.targets.has_all_names &= is_known and not (used and "RENAME" in words)

    def follow_loop(
        self, given: Sequence[str], body: Sequence[_Command], folder: str, values: _Values
    ) -> None:
        """Execute the body of a `foreach` for each of its items, which are in `given`."""
        read = (*_NAMING, *_WITHOUT_PROGRAMS, *self.macros, "set", "list")
        names = {name for name, _ in body} - {*read}
        self.targets.has_all_names &= all(name.startswith(_WITHOUT_PROGRAM) for name in names)
        variable, *items = given or [""]
        if items[:1] == ["IN"]:
            named = {word for word in items if word in values}
            listed = [
                each for word in items for each in (values[word] if word in named else [word])
            ]
            items = [each for each in listed if each not in ("IN", "LISTS", "ITEMS")]
        for item in items[:_MOST_WORDS]:
            if self.left <= 0:
                return
            values[variable] = [item]
            self.follow(body, folder, values)

    def take_command(self, name: str, given: Sequence[str], folder: str, values: _Values) -> None:
        """Execute a command that is neither a block nor a macro; `given` are its words."""
        first, *others = given
        match name:
            case "set":
                values[first] = others[:_MOST_WORDS]
            case "list" if others and first == "APPEND":
                values[others[0]] = [*values.get(others[0], ()), *others[1:]][:_MOST_WORDS]
            case "file" if others and first in ("GLOB", "GLOB_RECURSE"):
                values[others[0]] = list(self.matching(first, others[1:], folder))
                # Files that no reader needs are not among those of the package.
                self.targets.is_whole &= bool(values[others[0]])
            case "aux_source_directory" if others:
                patterns = [f"{first}/*{suffix}" for suffix in (".cpp", ".cc", ".cxx", ".c")]
                values[others[0]] = list(self.matching("GLOB", patterns, folder))
            case "project":
                values["PROJECT_NAME"] = [first]
                values["CATKIN_PACKAGE_SHARE_DESTINATION"] = [f"share/{first}"]
            case "include":
                path = self.modules.get(first) or _in_package(first, folder)
                # A name alone is mostly of a module of CMake, which installs nothing.
                is_module = "/" not in first and not first.endswith(".cmake")
                self.targets.is_whole &= path in self.files or is_module
                self.follow(self.commands_of(path), folder, values)
            case "add_subdirectory":
                inner = _in_package(first, folder)
                self.follow(self.commands_of(f"{inner}/CMakeLists.txt"), inner, dict(values))
            case "install" if first in ("DIRECTORY", "FILES"):
                installed = _installed(first == "DIRECTORY", others, folder, values)
                self.targets.installed += installed
                self.targets.is_whole &= "DESTINATION" in others and "${" not in "".join(others)
            case "ament_auto_package":
                shared = (*given, "INSTALL_TO_SHARE")
                folders = shared[shared.index("INSTALL_TO_SHARE") + 1 :]
                shared = tuple(_in_package(each, folder) for each in folders)
                self.targets.installed += (Installed(each, "", is_folder=True) for each in shared)
            case _:
                self.take_of_target(name, first, others, folder)

    def take_of_target(self, name: str, first: str, others: Sequence[str], folder: str) -> None:
        """Execute a command about a target, or about a sort of files, named by its first word."""
        targets = self.targets
        match name:
            case _ if name in _EXECUTABLES:
                targets.sources[first] = [_in_package(each, folder) for each in others]
                targets.executables[first] = first
                if name.startswith("ament_auto"):
                    targets.links.setdefault(first, []).extend(self.automatic)
            case _ if name in _LIBRARIES and others[:1] == ["ALIAS"]:
                targets.links[first] = [*others[1:]]
            case _ if name in _LIBRARIES:
                targets.sources[first] = [_in_package(each, folder) for each in others]
                self.automatic += [first] * name.startswith("ament_auto")
            case "target_sources":
                targets.sources.setdefault(first, []).extend(
                    _in_package(each, folder) for each in others
                )
            case "target_link_libraries":
                targets.links.setdefault(first, []).extend(others)
            case "rclcpp_components_register_node":
                named = dict(pairwise(others))
                if "PLUGIN" in named:
                    targets.plugins[named["PLUGIN"]] = first
                if "EXECUTABLE" in named:
                    targets.executables[named["EXECUTABLE"]] = first
                    targets.started[named["EXECUTABLE"]] = named.get("PLUGIN", "")
            case "rclcpp_components_register_nodes":
                targets.plugins |= dict.fromkeys(others, first)
            case "install" | "catkin_install_python" if first == "PROGRAMS":
                programs = (
                    others[: others.index("DESTINATION")] if "DESTINATION" in others else others
                )
                targets.programs += [_in_package(each, folder) for each in programs]
            case "set_target_properties":
                for key, value in pairwise(others):
                    if key == "OUTPUT_NAME":
                        targets.executables[value] = first

    def commands_of(self, path: str) -> Sequence[_Command]:
        """Return the commands of a file of the package; none if the file does not exist."""
        if path not in self.read:
            text = self.files.get(path)
            self.read[path] = () if text is None else tuple(_cmake_commands(text()))
        return self.read[path]

    def matching(self, command: str, words: Sequence[str], folder: str) -> Iterator[str]:
        """Yield the absolute paths of package files that match the patterns in `words`."""
        options = {word for word, _ in pairwise(words) if word in ("RELATIVE", "LIST_DIRECTORIES")}
        skipped = {at + 1 for at, word in enumerate(words) if word in options}
        for at, word in enumerate(words):
            pattern = _in_package(word, folder)
            above, _, name = pattern.rpartition("/")
            if at in skipped or word in options or word.isupper() or "*" not in name:
                continue
            self.left -= 1 + len(self.files) // 100
            for path in self.files if self.left > 0 else ():
                last = path.rpartition("/")[2]
                is_below = command == "GLOB_RECURSE" and path.startswith(f"{above}/" * bool(above))
                if (is_below and fnmatchcase(last, name)) or is_named(path, pattern):
                    yield f"{_PACKAGE}/{path}"


def is_named(path: str, pattern: str) -> bool:
    """Whether a pattern names the path of a file; `**` in it is any number of folders."""
    has_any_depth = "**" in pattern or path.count("/") == pattern.count("/")
    return has_any_depth and fnmatchcase(path, pattern.replace("**/", "*"))


def _in_package(path: str, folder: str) -> str:
    """Return a path of a file in a folder of the package, relative to the package."""
    whole = path if path.startswith(_PACKAGE) else posixpath.join(_PACKAGE, folder, path)
    normal = posixpath.normpath(whole)
    return normal.removeprefix(_PACKAGE).lstrip("/") if normal.startswith(_PACKAGE) else path


def _end_of_block(commands: Sequence[_Command], at: int, name: str) -> int:
    """Return the index of the command that ends the block around `at`, `len(commands)` if none."""
    depth = 1
    while at < len(commands):
        depth += (commands[at][0] == name) - (commands[at][0] == f"end{name}")
        if depth == 0:
            break
        at += 1
    return at


def _installed(
    is_folder: bool, words: Sequence[str], folder: str, values: Mapping[str, Sequence[str]]
) -> Iterator[Installed]:
    """Yield the files or folders that `install` copies to the package's shared folder."""
    if "DESTINATION" not in words[:-1]:
        return
    at = words.index("DESTINATION")
    share = f"share/{' '.join(values.get('PROJECT_NAME', ()))}"
    target = words[at + 1].rstrip("/")
    if target == share or target.startswith(f"{share}/"):
        for word in words[:at]:
            # With a slash at its end a folder is installed by its content.
            source = _in_package(word, folder) + "/" * word.endswith("/")
            yield Installed(source, target.removeprefix(share).lstrip("/"), is_folder)


def _cmake_commands(text: str) -> Iterator[_Command]:
    """Yield the commands of a CMake text: the name in lower case, and the arguments."""
    before, words, depth = "", list[str](), 0
    for match in _TOKEN.finditer(text):
        token = match[0]
        if token.startswith("#"):
            continue
        if token == "(":
            depth += 1
            if depth == 1:
                words = []
        elif token == ")":
            depth = max(0, depth - 1)
            if not depth and before:
                yield before.lower(), words
                before = ""
        elif depth:
            words.append(token[1:-1] if token.startswith('"') and len(token) > 1 else token)
        else:
            before = token


def _expanded(words: Sequence[str], values: _Values) -> list[str]:
    """Return words with variables replaced; a word that is one variable becomes all its words."""
    found: list[str] = []
    for word in words:
        whole = _VARIABLE.fullmatch(word)
        if whole:
            found += values.get(whole[1], ())
        else:
            found.append(_VARIABLE.sub(lambda m: " ".join(values.get(m[1], (m[0],)))[:4096], word))
        if len(found) > _MOST_WORDS:
            break
    return found
