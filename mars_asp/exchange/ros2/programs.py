"""Programs of a workspace: the interface of a package's executable, read from its sources."""

import re
from collections.abc import Collection, Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cache, cached_property
from itertools import chain
from pathlib import Path

from mars_asp.diagnostic import MarsError, Span
from mars_asp.exchange.ros2.interface import Interface
from mars_asp.exchange.ros2.setup_files import scripts_of_configuration, scripts_of_setup
from mars_asp.exchange.ros2.source_cpp import REGISTERS, parsed_file, read_cpp
from mars_asp.exchange.ros2.source_python import PythonPrograms
from mars_asp.exchange.ros2.workspace import Package, Workspace
from mars_asp.model.graph import AbsentFile

_CPP = frozenset({".cpp", ".cc", ".cxx", ".c"})
_HEADERS = frozenset({".hpp", ".h", ".hh", ".hxx"})
_CODE = _CPP | _HEADERS | {".py"}
_INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*[<"]([^>"\n]+)[>"]', re.MULTILINE)
#: A word that each source of a node has, or one of the headers that it includes.
_OF_ROS = re.compile(
    r"\bros|\brcl|nodelet|pluginlib|image_transport|advertise|subscribe|create_|class_loader|Node"
)
#: A source of a program or component of its own.
_STARTS = re.compile(rf"\b(?:int\s+main\s*\(|{'|'.join(REGISTERS)})")
_MOST_FILES = 100
#: The first two arguments of a function for parameters, and variables with values.
_ARGUMENT = r"(?:[^,;()]|\([^()]*\))*"
_NAMING = re.compile(
    r"[Pp]aram\w{0,60}(?:<[^;()]{0,200}>)?"
    rf"\s*\(\s*({_ARGUMENT})(?:,\s*({_ARGUMENT}))?"
)
_ASSIGNED = re.compile(r"\b(\w+)\s*=(?!=)([^;\n]*)")
_HOLE = r"\{[^{}\"']*\}|%[sdi]"
#: A text that is added to another, or has places for others.
_COMPOSED = re.compile(rf"(\+\s*)?([\"'])((?:\w|{_HOLE})+)\2(\s*\+)?")
_PACKAGE_NAME = re.compile(r"[\w-]+")
_LAUNCHES = re.compile(r"[._]launch\.py$|/launch/[^/]*\.py$")
#: Options with which a node takes parameters that it does not declare.
_TAKES_ANY = frozenset(
    {"automatically_declare_parameters_from_overrides", "allow_undeclared_parameters"}
)
#: Folders of scripts whose installation states only their name.
_SCRIPTS = ("scripts", "nodes", "src", "bin", ".")


@dataclass(frozen=True, slots=True)
class RosProgram:
    """A program that launch files can start; a `plugin` is a component, named by its class."""

    package: str
    executable: str
    plugin: bool


class Programs:
    """Finds and reads the sources of programs, each once."""

    def __init__(self, workspace: Workspace) -> None:
        """Begin with a workspace whose programs are read on request."""
        self.workspace = workspace
        self._python = PythonPrograms(self._module_source)
        self.interface = cache(self._find_interface)
        # Many programs share headers.
        self._included = cache(self._headers_of)
        self._words = cache(
            lambda package: frozenset(
                chain.from_iterable(map(self.workspace.words_in, self._sources_for(package)))
            )
        )
        self._composed = cache(self._composed_names)
        self._is_of_ros = cache(
            lambda file: _OF_ROS.search(self.workspace.readable(file)) is not None
        )

    def all(self) -> Iterator[RosProgram]:
        """Yield every program that the build files of the workspace's packages declare."""
        for package in self.workspace.packages:
            for name in self._scripts.get(package.folder, {}):
                yield RosProgram(package.name, name, False)
            targets = self.workspace.targets(package)
            for name in targets.executables:
                yield RosProgram(package.name, name, False)
            for path in targets.programs:
                yield RosProgram(package.name, Path(path).name, False)
            started = set(targets.executables.values())
            for plugin, target in targets.plugins.items():
                if target not in started:
                    yield RosProgram(package.name, plugin, True)

    def unreadable_modules(self) -> Iterator[tuple[str, Span]]:
        """Yield the modules of ROS 2 programs that are not valid Python, with the errors."""
        broken = self._python.broken
        files = {self.workspace.shown(file): file for file in self.workspace.files if broken}
        for place, error in broken:
            path = place.path
            package = self.workspace.package_of(files[path]) if path in files else None
            if package is not None and package.is_of_ros2:
                yield f"{path}: this is not Python: {error}", place

    def absent_entries(self) -> Iterator[AbsentFile]:
        """Yield the modules and functions of console scripts that their packages do not have.

        Scripts of a package in Python are installed in `bin` unless its `setup.cfg` sets another
        folder, and `ros2 run` and launch files look for them in `lib/PACKAGE`. A package that
        CMake builds needs no `setup.py`.
        """
        for package in self.workspace.packages:
            if package.is_built_by_cmake:
                continue
            setup = package.folder / "setup.py"
            text = self.workspace.readable(setup)
            has_scripts = self._scripts.get(package.folder) and "console_scripts" in text
            if has_scripts and not self.workspace.places_scripts(package):
                place = self._span_of(setup, text, "console_scripts")
                yield AbsentFile(package.name, package.name, place, "programs")
            for entry in self._scripts.get(package.folder, {}).values():
                module, _, function = (part.strip() for part in entry.partition(":"))
                path = module.replace(".", "/")
                places = [package.folder / above / path for above in ("", "src")]
                at = text.find(module)
                is_own = (package.folder / path.partition("/")[0]).is_dir()
                is_here = any(each.is_dir() or each.with_suffix(".py").is_file() for each in places)
                # An entry without a function names no module whose file could be added.
                is_name = function and all(part.isidentifier() for part in module.split("."))
                if not (is_name and is_own and at >= 0 and "/" in path):
                    continue
                if not is_here:
                    place = self._span_of(setup, text, module)
                    yield AbsentFile(f"{path}.py", package.name, place)
                elif function.isidentifier() and not self._python.defines(module, function):
                    place = self._span_of(setup, text, module)
                    yield AbsentFile(f"{module}:{function}", package.name, place, "function")

    def names_parameter(self, package: str, name: str) -> bool:
        """Whether a source of a package, or of one it depends on, contains a parameter's name.

        Of a name with slashes only the last word is searched; it may be composed in the source. It
        is also true if nodes of the package accept any parameter, or if the package is not here.
        """
        found = self.workspace.package(package)
        if found is None:
            return True
        words = self._words(found)
        last = name.rpartition("/")[2]
        is_known = last in words or not words.isdisjoint(_TAKES_ANY)
        return is_known or any(re.fullmatch(form, last) for form in self._composed(found))

    def _composed_names(self, package: Package) -> frozenset[str]:
        """Return regular expressions for names composed in the sources, as `name + "_min"`."""
        found: set[str] = set()
        for text in map(self.workspace.readable, self._sources_for(package)):
            names = set(chain.from_iterable(_NAMING.findall(text)))
            names.update(value for name, value in _ASSIGNED.findall(text) if name in names)
            for before, _, inner, after in chain.from_iterable(map(_COMPOSED.findall, names)):
                literals = re.split(_HOLE, inner)
                part = r"\w+" if any("_" in each for each in literals) else r"\d+"
                form = f"{before and part}{part.join(literals)}{after and part}"
                if form != inner and any(each.strip("_") for each in literals):
                    found.add(form)
        return frozenset(found)

    def _sources_for(self, package: Package) -> Iterator[Path]:
        """Return the sources of the packages that are named in the manifest of a package."""
        manifest = self.workspace.readable(package.folder / "package.xml")
        named = set(_PACKAGE_NAME.findall(manifest))
        used = (each for each in self.workspace.packages if each.name in named)
        files = chain.from_iterable(self.workspace.by_package[each.folder] for each in used)
        # A launch file gives parameters, and reads none.
        return (f for f in files if f.suffix in _CODE and not _LAUNCHES.search(f.as_posix()))

    def _span_of(self, file: Path, text: str, word: str) -> Span:
        """Return the location of the first occurrence of a word in a file."""
        at = text.find(word)
        line = text.count("\n", 0, at) + 1
        column = at - text.rfind("\n", 0, at)
        return Span(self.workspace.shown(file), line, column, line, column + len(word))

    # ---- From a program to its sources

    def _find_interface(self, program: RosProgram) -> Interface | None:
        """Return the topics of a program, or None if its source is not in the workspace."""
        if program.plugin:
            return self._component(program.executable)
        package = self.workspace.package(program.package)
        if package is None:
            return None
        entry = self._scripts.get(package.folder, {}).get(program.executable)
        if entry is not None:
            module, _, function = entry.partition(":")
            return self._python.interface(module.strip(), function.strip() or None)
        targets = self.workspace.targets(package)
        if program.executable in targets.executables:
            target = targets.executables[program.executable]
            plugin = targets.started.get(program.executable)
            return (self._component(plugin) if plugin else None) or self._compiled(
                package, targets.sources.get(target, ()), targets.of(target)
            )
        return self._by_name(package, program.executable)

    def _by_name(self, package: Package, executable: str) -> Interface | None:
        """Return the interface of a script or single source file called `executable`, or None."""
        installed = self.workspace.targets(package).programs
        paths = [path for path in installed if Path(path).name == executable]
        # Programs of ROS 2 may be in the folder of the modules.
        paths += [
            f"{folder}/{executable}{suffix}"
            for folder in (*_SCRIPTS, package.name)
            for suffix in ("", ".py")
        ]
        for path in paths:
            found = self.workspace.find(str(package.folder / path), package.folder)
            if found is not None and found.suffix in ("", ".py"):
                first = self.workspace.text(found).partition("\n")[0]
                if first.startswith("#!") and "python" not in first:
                    continue
                module = f"{package.name}.{found.stem}"
                is_inner = self._modules.get(module) == found
                return self._python.interface(module if is_inner else f"file:{found}", None)
        stems = [
            file
            for file in self._sources.get(package.folder, ())
            if file.stem == executable and file.suffix in _CPP
        ]
        return self._compiled(package, [str(stems[0])]) if stems else None

    def _compiled(
        self, package: Package, sources: Iterable[str], linked: Iterable[str] = ()
    ) -> Interface | None:
        """Return the interface of C++ sources and their headers; None if no file can be read.

        A `linked` file counts only if its own header is among these: a library may also hold
        other nodes.
        """
        files = list(self._existing_sources(package, sources))
        return self._with_headers(package, files, list(self._existing_sources(package, linked)))

    def _existing_sources(self, package: Package, sources: Iterable[str]) -> Iterator[Path]:
        for source in sources:
            path = source.replace("${CMAKE_CURRENT_SOURCE_DIR}", str(package.folder))
            found = self.workspace.find(path, package.folder)
            if found is not None and found.suffix in _CPP | _HEADERS:
                yield found

    def _with_headers(
        self,
        package: Package,
        files: Sequence[Path],
        linked: Sequence[Path] = (),
        component: str = "",
        others: Collection[str] = (),
    ) -> Interface | None:
        """Return the interface of C++ files and their headers; None if no file can be read.

        The classes `others` are ignored. A `linked` file counts only if its own header is included.
        """
        texts: dict[Path, str] = {}
        waiting = list(reversed(files))
        # Headers are reached if a source includes them.
        left = [file for file in linked if file not in files and file.suffix in _CPP]
        while (waiting or left) and len(texts) < _MOST_FILES:
            if not waiting:
                reached = []
                for file in left:
                    # A library may have a source and a header for each of its nodes.
                    headers = self._included(package, file)
                    own = [header for header in headers if header.stem == file.stem]
                    if any(header in texts for header in own or headers):
                        reached.append(file)
                left = [file for file in left if file not in reached]
                if not reached:
                    break
                waiting = reached[::-1]
            file = waiting.pop()
            text = "" if file in texts else self.workspace.readable(file)
            if text:
                texts[file] = text
                waiting += self._included(package, file)
        if not texts:
            return None
        if not any(map(self._is_of_ros, texts)):
            # Libraries bring programs that have nothing to do with ROS.
            return Interface(unnamed=True)
        shown = ((text, self.workspace.shown(file)) for file, text in texts.items())
        return read_cpp(shown, component, others)

    def _with_library(self, package: Package, file: Path, component: str) -> Interface | None:
        """Return the interface of the class `component` in a file, with its library's sources.

        Without a target for the file, these are all sources of the package that start no program.
        Sources that register other components are left out, as are the classes of these.
        """
        targets = self.workspace.targets(package)
        libraries = [
            list(self._existing_sources(package, targets.of(target)))
            for target, sources in targets.sources.items()
            if any(source.endswith(file.name) for source in sources)
        ]
        others = [each for each in libraries if file in each]
        if not others:
            others = [
                [
                    each
                    for each in self._sources.get(package.folder, ())
                    if each.suffix in _CPP and not _STARTS.search(self.workspace.readable(each))
                ]
            ]
        linked = [each for files in others for each in files if each != file]
        rivals = self._components_in.get(file, set()) - {component}
        # A component may be derived from another one, or make it.
        own = (file, *self._included(package, file))
        for each in linked:
            found = self._components_in.get(each, set())
            is_used = any(not found.isdisjoint(self.workspace.words_in(file)) for file in own)
            rivals |= set() if is_used else found
        linked = [each for each in linked if rivals.isdisjoint(self._components_in.get(each, ()))]
        return self._with_headers(package, [file], linked, component, rivals)

    def _headers_of(self, package: Package, file: Path) -> Sequence[Path]:
        """Return the headers of a package that one of its files includes."""
        found: list[Path] = []
        for name in _INCLUDE.findall(self.workspace.readable(file)):
            last = name.rpartition("/")[2]
            headers = self._headers.get(last, {}).get(package.folder)
            if headers is None:
                continue
            # A header beside the file wins, then headers whose path ends with the name.
            beside = file.parent / name
            parts = Path(name).parts
            ending = [each for each in headers if each.parts[-len(parts) :] == parts]
            found += [beside] if beside in headers else ending or headers
        return found

    def _component(self, plugin: str) -> Interface | None:
        """Return the interface of a component by its class, or None if no file registers it."""
        last = re.split(r"::|/", plugin)[-1]
        file = self._registered.get(plugin) or self._registered.get(last)
        if file is not None:
            package = self.workspace.package_of(file)
            return None if package is None else self._with_library(package, file, last)
        for package in self.workspace.packages:
            targets = self.workspace.targets(package)
            if plugin in targets.plugins:
                return self._compiled(package, targets.of(targets.plugins[plugin]))
        return None

    def _module_source(self, module: str) -> tuple[str, str] | None:
        """Return text and path of a Python module of the workspace, or None."""
        name = module.removeprefix("file:")
        file = Path(name) if name != module else self._modules.get(module)
        if file is None:
            return None
        try:
            return self.workspace.text(file), self.workspace.shown(file)
        except MarsError:
            return None

    # ---- What is where

    @cached_property
    def _sources(self) -> dict[Path, list[Path]]:
        return {
            folder: [file for file in files if file.suffix in _CPP | _HEADERS]
            for folder, files in self.workspace.by_package.items()
        }

    @cached_property
    def _headers(self) -> dict[str, dict[Path, list[Path]]]:
        """The header files of each name, by the folders of their packages."""
        found: dict[str, dict[Path, list[Path]]] = {}
        for folder, files in self._sources.items():
            for file in files:
                if file.suffix in _HEADERS:
                    found.setdefault(file.name, {}).setdefault(folder, []).append(file)
        return found

    @cached_property
    def _modules(self) -> dict[str, Path]:
        """The files of Python modules, by their names in their packages."""
        found: dict[str, Path] = {}
        for folder, files in self.workspace.by_package.items():
            for file in files:
                if file.suffix != ".py":
                    continue
                parts = list(file.relative_to(folder).with_suffix("").parts)
                if parts[-1] == "__init__":
                    parts.pop()
                if len(parts) > 1 and parts[0] in ("src", "scripts", "nodes", "include"):
                    found.setdefault(".".join(parts[1:]), file)
                found.setdefault(".".join(parts), file)
        return found

    @cached_property
    def _scripts(self) -> dict[Path, dict[str, str]]:
        """The console scripts of each package by its folder, each with its module and function."""
        found: dict[Path, dict[str, str]] = {}
        for package in self.workspace.packages:
            scripts: dict[str, str] = {}
            # A name with very many summands is not read.
            with suppress(RecursionError):
                setup = self.workspace.readable(package.folder / "setup.py")
                scripts |= dict(scripts_of_setup(setup))
            configured = self.workspace.readable(package.folder / "setup.cfg")
            found[package.folder] = scripts | dict(scripts_of_configuration(configured))
        return found

    @cached_property
    def _registrations(self) -> Sequence[tuple[str, Path, bool]]:
        """Each registered class, with the file that registers it and whether it is a node."""
        found: list[tuple[str, Path, bool]] = []
        for files in self._sources.values():
            for file in files:
                text = self.workspace.readable(file)
                if any(word in text for word in REGISTERS):
                    for call in parsed_file(text, self.workspace.shown(file)).calls:
                        if call.name in REGISTERS:
                            name, *kinds = ("".join(t.text for t in a) for a in call.arguments)
                            is_node = not kinds or kinds[0].endswith("Nodelet")
                            found.append((name, file, is_node))
        return found

    @cached_property
    def _registered(self) -> dict[str, Path]:
        """The file that registers each component, by the class of the component."""
        found: dict[str, Path] = {}
        for name, file, _ in self._registrations:
            found[name] = file
            # ROS 1 names the package where C++ names the namespace.
            found.setdefault(name.rpartition("::")[2], file)
        return found

    @cached_property
    def _components_in(self) -> dict[Path, set[str]]:
        """The classes of the components that each file registers, by file."""
        found: dict[Path, set[str]] = {}
        for name, file, is_node in self._registrations:
            if is_node:
                found.setdefault(file, set()).add(name.rpartition("::")[2])
        return found
