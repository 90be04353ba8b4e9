"""A ROS workspace, package or launch file as a configuration."""

import os
import re
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cache, partial
from itertools import chain, takewhile
from pathlib import Path

from mars_asp.diagnostic import Diagnostic, MarsError, Span, point, refusal, whole_file
from mars_asp.exchange.folders import (
    IGNORE_MARKERS,
    LAUNCH_ENDINGS,
    IsExcluded,
    nothing_excluded,
)
from mars_asp.exchange.graph import joined, united
from mars_asp.exchange.recognise import is_launch, recognised
from mars_asp.exchange.ros2.bridges import FILE, bridged, is_bridge
from mars_asp.exchange.ros2.catalogue import OWN, Catalogue, load_catalogue
from mars_asp.exchange.ros2.controllers import MANAGERS, with_controllers
from mars_asp.exchange.ros2.glue import handed_on, steered
from mars_asp.exchange.ros2.interface import (
    AT_RUN_TIME,
    BY_CLIENTS,
    FURTHER_NODES,
    NOT_FOLLOWED,
    SERVICES,
    Interface,
    InterfaceTopic,
)
from mars_asp.exchange.ros2.launch import IN_NEWER, Launch, Started
from mars_asp.exchange.ros2.launch_python import NEWER
from mars_asp.exchange.ros2.muxes import is_mux, mux_of, unbound
from mars_asp.exchange.ros2.names import absolute, renamed
from mars_asp.exchange.ros2.names import joined as name_in
from mars_asp.exchange.ros2.observations import USUAL, observed
from mars_asp.exchange.ros2.parameters import (
    PARAMETERS,
    GivenParameter,
    document_of,
    is_for,
    section_for,
    values_for,
)
from mars_asp.exchange.ros2.programs import Programs, RosProgram
from mars_asp.exchange.ros2.workspace import Workspace
from mars_asp.exchange.topics import configuration_of
from mars_asp.exchange.twist_mux.document import (
    SORTS,
    MuxDocument,
    read_documents,
    read_parameters,
    read_parts,
)
from mars_asp.exchange.unread import BROKEN, CONTAINERS, MANIFESTS, OF_PARAMETERS, Unread, notes
from mars_asp.exchange.yaml_document import Items, Repeat, Scalar, read_yaml
from mars_asp.exchange.yaml_document import Node as YamlNode
from mars_asp.language import Parsed
from mars_asp.model.graph import (
    AbsentFile,
    Endpoint,
    GivenFile,
    Graph,
    GraphNode,
    LaunchTree,
    Mux,
    Relay,
    Renaming,
    RepeatedKey,
)
from mars_asp.output import counted
from mars_asp.spelling import nearest

#: A node of a launch file of ROS 1; in ROS 2 `type` is `exec`.
_TYPE = re.compile(r"<node\b[^>]*\btype\s*=")
#: The start of a script, which may be named like a launch file of another format.
_SCRIPT = re.compile(r"#!.*python")
#: The end of the name of a launch file, which makes all of them alike.
_ENDING = re.compile(r"([._-]?launch)?\..*")
_IN_FOLDER = frozenset({".py", ".xml", ".yaml", ".yml", ".launch"})
#: A folder that does not exist.
_NOWHERE = Path("/dev/null/nowhere")
_NAME = re.compile(r"[^\x00-\x1f\x7f]+")
#: Packages whose programs start something in others, and as what they are noted.
_HELPERS = {
    "rclcpp_components": CONTAINERS,
    "nodelet": CONTAINERS,
    "controller_manager": "controller managers and spawners",
    "ros_gz_sim": "programs of the simulator that a bridge joins",
    "gazebo_ros": "programs of the simulator",
}
#: Parameters that each node of ROS 2 has.
_OF_MIDDLEWARE = frozenset({"use_sim_time", "start_type_description_service"})
#: Packages of which each program publishes what it hears.
_RELAYS = frozenset({"topic_tools"})
_MOST_NAMED = 20
_CONTROLLER_MANAGERS = "controller managers"
#: Sorts of unread things that can neither be a node nor give one another topic.

_HARMLESS = frozenset(
    {
        SERVICES,
        # Controllers are nodes of their own, which spawners load.
        _CONTROLLER_MANAGERS,
        CONTAINERS,
        "nodes that are made but not launched",
        "locks",
        "topics of locks",
        "parameters",
        "topics of markers",
        "rates of throttles",
        "amounts that are delayed, dropped or limited in bytes",
        "topics that a mux of topic_tools can select later",
        "links out of the workspace",
        # A bridge carries its topics, which is read.
        "programs of the simulator that a bridge joins",
    }
)
#: Sorts of unread things with which a node may have further topics.
_OPEN = frozenset({AT_RUN_TIME, BY_CLIENTS, NOT_FOLLOWED})
_TRUTH = ("false", "true")
_NUMBERED = re.compile(r"\d+")


def import_ros2(
    files: Sequence[tuple[str, str]],
    launch: Sequence[str] = (),
    is_excluded: IsExcluded = nothing_excluded,
) -> Parsed:
    """Return the configuration of launch files and folders, which make up one robot.

    Args:
        files: Texts and their paths. The text of a folder is empty; mux files apply to muxes that
            are launched without parameters.
        launch: The launch files to read in folders, each the top of a launch tree; if empty, all
            that no other file includes.
        is_excluded: Whether to skip a path in a folder.

    Raises:
        MarsError: a launch file has errors, there is none, or `launch` names none.
    """
    graphs = []
    trees: list[LaunchTree] = []
    problems: list[Diagnostic] = []
    unread: list[Unread] = []
    launched = [(text, path) for text, path in files if recognised(text) != "twist_mux"]
    if not launched:
        message, path = "this is a file of twist_mux, not a launch file", files[0][1]
        raise refusal("launch", message, path, "name the launch file, or the format `twist_mux`")
    muxes = read_documents([file for file in files if file not in launched])
    by_root = defaultdict[tuple[Path, bool], list[tuple[str, str]]](list)
    for text, path in launched:
        by_root[_root(Path(path))].append((text, path))
    for (root, deep), members in by_root.items():
        workspace = Workspace(root, members[0][1], deep=deep, is_excluded=is_excluded)
        robot = _WorkspaceRobot(workspace, muxes, launch)
        graphs.append(robot.graph([workspace.given(path, text) for text, path in members]))
        trees += robot.trees
        problems += robot.problems
        unread += robot.unread
        absent = [each.name for each in robot.unread if "not in the workspace" in each.sort]
        problems += _only_a_part(root, members[0][1], absent)
    for document in muxes:
        unread += document.unread
        problems += document.warnings
    graph = joined(graphs)
    known = {mux.span for mux in graph.muxes}
    given = (mux for document in muxes for mux in document.muxes)
    # Muxes that no node of the graph is.
    loose = [unbound(mux) for mux in given if mux.span not in known]
    for mux in loose:
        message = f"no launch file starts this mux, so it counts as a node of its own, `{mux.name}`"
        help_text = "name the launch file that starts it, or correct the name of the node"
        problems.append(
            Diagnostic("launch", "note", message, mux.span, help=help_text, kind="launch")
        )
    configuration, left_out = configuration_of(replace(graph, muxes=(*graph.muxes, *loose)))
    remarks = (*dict.fromkeys(problems), *notes(_once((*unread, *left_out))))
    return Parsed(configuration, remarks, trees=tuple(trees))


def _root(path: Path) -> tuple[Path, bool]:
    """Return the folder to search for the files that a path uses, and whether to find packages.

    For a launch file, or a folder `launch`, it is the package, and then each folder above that has
    other packages directly in it or is called `src`; without a package it is the folder of the
    file. The search upwards ends at a folder with `.git` or `COLCON_IGNORE` (or alike), and at a
    package that contains others. Standard input has no folder.
    """
    if path.is_dir():
        folder = path.resolve()
        around, is_in_package = _root_of(folder)
        is_part = is_in_package and "launch" in folder.relative_to(around).parts
        is_part = is_part and next(folder.rglob("package.xml"), None) is None
        return (around if is_part else folder), True
    if not path.is_file():
        return _NOWHERE, False
    return _root_of(path.resolve().parent)


def _root_of(folder: Path) -> tuple[Path, bool]:
    """Return the same as `_root` does, given a folder with a launch file."""
    root = folder
    while not _is_package(root):
        if (root / ".git").exists() or root == root.parent:
            return folder, False
        root = root.parent
    ends = (".git", *IGNORE_MARKERS)
    while root != root.parent and not any((root / each).exists() for each in ends):
        if not _holds(root.parent, root):
            break
        root = root.parent
        if _is_package(root):
            break
    return root, True


def workspace_around(file: Path) -> Path | None:
    """Return the workspace, or the package in none, that a file is a part of; None if in none."""
    around, is_in_package = _root_of(file.resolve().parent)
    return _above_src(around) if is_in_package else None


def _above_src(folder: Path) -> Path:
    return folder.parent if folder.name == "src" else folder


def _only_a_part(folder: Path, named: str, absent: Sequence[str]) -> Iterator[Diagnostic]:
    """Yield a note that files absent from a folder are in the workspace around it.

    `named` is the path that the user gave; there is no note unless it is a folder.
    """
    around, is_deep = _root_of(folder) if absent and Path(named).is_dir() else (folder, False)
    beside = [each.parent.name for each in around.glob("*/package.xml")] if is_deep else []
    words = {word for each in absent for word in re.findall(r"[\w-]+", each)}
    if around != folder and not words.isdisjoint(beside):
        whole = os.path.relpath(_above_src(around))
        message = f"the folder is a part of the workspace `{whole}`; name that to read all of it"
        yield Diagnostic("launch", "note", message, whole_file(named), kind="launch")


def _is_package(folder: Path) -> bool:
    return (folder / "package.xml").is_file()


def _holds(folder: Path, inner: Path) -> bool:
    """Whether a folder is called `src`, or directly contains a package that counts beside `inner`.

    Those with `COLCON_IGNORE` (or alike) do not count.
    """
    if folder.name == "src":
        return True
    try:
        others = (each for each in folder.iterdir() if each != inner and _is_package(each))
        return any(not any((each / mark).exists() for mark in IGNORE_MARKERS) for each in others)
    except OSError:
        return False


def _once(unread: Iterable[Unread]) -> Iterable[Unread]:
    """Return skipped contents without duplicates: files by name, others by name and location."""
    found: dict[tuple[object, ...], Unread] = {}
    for each in unread:
        found.setdefault((each.sort, each.name, "files" in each.sort or each.span), each)
    return found.values()


class _WorkspaceRobot:
    """Brings together the nodes of launch files and the interfaces of their programs."""

    def __init__(
        self,
        workspace: Workspace,
        muxes: Sequence[MuxDocument],
        chosen: Sequence[str] = (),
    ) -> None:
        self.workspace = workspace
        self.chosen = chosen
        self.programs = Programs(workspace)
        self.muxes = muxes
        self.unread: list[Unread] = []
        self.problems: list[Diagnostic] = []
        self.catalogued: dict[str, Span] = {}
        self.conditional: dict[str, Span] = {}
        self.trees: list[LaunchTree] = []
        #: The packages of the programs that launch files start.
        self.packages: set[str] = set()
        self.empty: list[Path] = []
        #: The launch files that others include, each as if it were launched by itself.
        self.parts: list[Launch] = []
        self.document = cache(self._document)
        #: Keys that parameter files have twice.
        self.repeated: dict[Path, tuple[RepeatedKey, ...]] = {}

    def graph(self, paths: Sequence[Path]) -> Graph:
        """Return the nodes, muxes and relays that launch files, or those in folders, start."""
        self.catalogue = self._catalogue()
        launches = list(self._launches(paths))
        self.packages = {each.package for launch in launches for each in launch.started}
        launched = launches
        if not any(launch.started for launch in launches):
            alone = Launch(self.workspace)
            alone.started = list(self._alone(paths))
            if alone.started:
                launched = [alone]
                # The trees are of launch files that are not readable.
                found = "could be read" if self.trees else "was found"
                message = (
                    f"no launch file {'starts a known node' if launches else found}, "
                    "so every program of the packages counts as started"
                )
                place = whole_file(self.workspace.shown(paths[0]))
                self.problems.append(Diagnostic("launch", "note", message, place, kind="launch"))
        for launch in launched:
            tree = self._tree(launch, paths)
            if launch not in launches:
                # Programs with one name may be alternatives of which users start one.
                nodes_of_any_name = tuple(replace(n, is_named=False) for n in tree.nodes)
                tree = replace(tree, nodes=nodes_of_any_name, is_of_programs=True)
            self.trees.append(tree)
        if self.trees:
            self.trees[0] = self._with_faults_of_packages(launches, launched is launches, paths)
        nodes: dict[str, GraphNode] = {}
        for node in chain.from_iterable(tree.nodes for tree in self.trees):
            known = nodes.get(node.name)
            nodes[node.name] = node if known is None else united(known, node)
        muxes = {mux.name: mux for tree in reversed(self.trees) for mux in reversed(tree.muxes)}
        relays = {each.name: each for tree in self.trees for each in tree.relays}
        self._note()
        for launch in launches:
            self.unread += launch.unread
        self.unread = [*map(self._with_marker, self.unread), *self._of_packages(launches, paths)]
        self.unread += self.workspace.annotated_modules()
        if not self.trees:
            raise self._nothing(paths)
        includes = any(len(launch.reached) > 1 for launch in launches)
        if not (nodes or muxes or relays):
            is_wrong = any(tree.broken or tree.missing for tree in self.trees)
            if not (includes or self.unread or is_wrong or launched is not launches):
                raise self._empty(paths)
            message = "no node could be read of what the launch files start"
            place = whole_file(self.workspace.shown(paths[0]))
            self.problems.append(Diagnostic("launch", "note", message, place, kind="launch"))
        name = self.workspace.shown(paths[0])
        return Graph(
            name, tuple(nodes.values()), tuple(muxes.values()), relays=tuple(relays.values())
        )

    def _with_faults_of_packages(
        self, launches: Sequence[Launch], are_launched: bool, paths: Sequence[Path]
    ) -> LaunchTree:
        """Return the first launch tree with the faults of no launch file.

        These are manifests with errors; of a folder all other faults of packages; of launch files
        those of their programs and the packages of these.
        """
        first = self.trees[0]
        unread = self._of_packages(launches, paths)
        manifests = (each for each in unread if each.sort == MANIFESTS)
        broken = [*first.broken, *((each.name, each.span) for each in manifests)]
        missing = list(first.missing)
        broken += self.programs.unreadable_modules()
        is_whole = self.workspace.root in paths and not self.chosen
        entries = self.programs.absent_entries()
        missing += (each for each in entries if is_whole or each.package in self.packages)
        if is_whole:
            # The console scripts have been read as well now.
            broken += self.programs.unreadable_modules()
        if is_whole and are_launched:
            first = replace(first, by_hand=tuple(self._by_hand(launches, paths)))
        return replace(first, missing=tuple(missing), broken=tuple(dict.fromkeys(broken)))

    def _of_packages(self, launches: Sequence[Launch], paths: Sequence[Path]) -> Sequence[Unread]:
        """Return skipped content of packages; of a launch file, the manifests that it needs."""
        if self.workspace.root in paths:
            return self.workspace.unread
        reached = {self.workspace.shown(f) for launch in launches for f in launch.reached}
        absent = {each.package for launch in launches for each in launch.missing}
        found = []
        for each in self.workspace.unread:
            folder = Path(each.span.path).parent
            is_needed = folder.name in self.packages | absent
            if (
                each.sort != MANIFESTS
                or is_needed
                or any(folder in Path(f).parents for f in reached)
            ):
                found.append(each)
        return found

    def _launches(self, paths: Sequence[Path]) -> Iterator[Launch]:
        """Yield the launch trees of folders, and one of all named files together."""
        together = Launch(self.workspace)
        for path in paths:
            if path.is_dir():
                yield from self._launched_in_folder(path)
            else:
                together.launch(path)
                together.path = together.path or path
        if together.path is not None:
            yield together

    def _tree(self, launch: Launch, paths: Sequence[Path]) -> LaunchTree:
        """Return the launch tree of a launch, in which nodes with equal names stay separate."""
        before = len(self.unread)
        missing = dict(launch.missing)
        left_out = None if launch.path is None else self.workspace.left_out(launch.path)
        if launch.path is not None and left_out is not None:
            package, name = left_out
            place = point(self.workspace.shown(launch.path), 1, 1)
            missing[AbsentFile(name, package, place, "not installed")] = None
        for file in launch.passed:
            self.document(file)
        nodes: list[GraphNode] = []
        muxes: list[Mux] = []
        relays: list[Relay] = []
        shared = set(launch.passed)
        files = [path for path in paths if not path.is_dir()] if launch.path in paths else []
        of_ros2 = self._is_for_ros2(files or [launch.path or paths[0]])
        find = partial(self.workspace.find, folder=self.workspace.root)
        for each in with_controllers(launch.started, self._node_parameters, find):
            if isinstance(each, Unread):
                self.unread.append(each)
                continue
            missing |= dict.fromkeys(self._undeclared(each) if of_ros2 else ())
            is_named = each.executable != "" and not each.plugin
            if is_named and not self.workspace.has_program(each.package, each.executable, of_ros2):
                missing[AbsentFile(each.executable, each.package, each.span, "program")] = None
            match self._node(each, of_ros2):
                case Mux() as mux:
                    given = tuple(self._given_files(each, mux.name, of_ros2))
                    muxes.append(replace(mux, given=given))
                case Relay() as relay:
                    relays.append(relay)
                case GraphNode() as node if each.name and not each.is_rewritten:
                    nodes.append(
                        replace(node, given=tuple(self._given_files(each, node.name, of_ros2)))
                    )
                    continue
                case GraphNode() as node:
                    nodes.append(node)
            shared.update(each.files)
        unread = (*launch.unread, *self.unread[before:])
        loaded = dict.fromkeys(
            [*chain.from_iterable(s.files for s in launch.started), *launch.passed]
        )
        rewritten = {file for each in launch.started if each.is_rewritten for file in each.files}
        return LaunchTree(
            self.workspace.shown(launch.path or paths[0]),
            tuple(nodes),
            tuple(muxes),
            tuple(relays),
            tuple(each.span for each in unread if each.sort not in _HARMLESS),
            tuple(each.span for each in unread if each.sort not in _HARMLESS | OF_PARAMETERS),
            tuple(
                (each.name, each.span)
                for each in unread
                # Who has no parameters to give may leave the file empty.
                if each.sort in BROKEN and not each.name.endswith("the file is empty")
            ),
            tuple(missing),
            tuple(launch.defaults.items()),
            tuple(chain.from_iterable(self.repeated.get(file, ()) for file in loaded)),
            tuple(self.workspace.shown(file) for file in loaded if file in rewritten),
            shared=tuple(sorted(map(self.workspace.shown, shared))),
        )

    def _undeclared(self, started: Started) -> Iterator[AbsentFile]:
        """Yield the parameters of a program that its sources do not name, as missing.

        Not checked are files that are rewritten, components (they have the parameters of their
        process), dotted names (libraries read them), and parameters for all nodes.
        """
        program = RosProgram(started.package, started.executable, started.plugin)
        interface = self.programs.interface(program)
        is_read = interface is not None and all(each.sort == SERVICES for each in interface.unread)
        if started.is_rewritten or started.plugin or not is_read:
            return
        for key, given in started.parameters.items():
            is_own = key not in _OF_MIDDLEWARE and "." not in key and not given.is_for_all
            if is_own and not self.programs.names_parameter(started.package, key):
                yield AbsentFile(key, started.executable, given.keys[0].span, "parameter")

    def _catalogue(self) -> Catalogue:
        packages = (package.folder for package in self.workspace.packages)
        folders = dict.fromkeys((self.workspace.root, *packages))
        own = [self.workspace.find(OWN, folder) for folder in folders]
        return load_catalogue(
            tuple((self.workspace.text(f), self.workspace.shown(f)) for f in own if f is not None)
        )

    def _launched_in_folder(self, folder: Path) -> Iterator[Launch]:
        """Yield a launch of each chosen file of a folder; by default, of those not included.

        Raises:
            MarsError: a choice is not a launch file of the folder, or has errors.
        """
        files = [
            file
            for file in self.workspace.files
            if folder in file.parents
            # Nothing finds the files of nested packages by name, but users may choose them.
            and (self.chosen or not self.workspace.is_nested(file))
            and self._is_launch(file)
        ]
        launch = Launch(self.workspace)
        if self.chosen:
            for file in self._chosen(files):
                launch = Launch(self.workspace, launch)
                launch.path = file
                launch.launch(file)
                yield launch
            return
        included: set[Path] = set()
        launches: dict[Path, Launch] = {}
        broken: dict[Path, Diagnostic] = {}
        for file in files:
            launch = Launch(self.workspace, launch)
            launch.path = file
            try:
                launch.launch(file)
            except MarsError as error:
                broken[file] = error.diagnostics[0]
            else:
                launches[file] = launch
            included |= launch.reached - {file}
        for file, wrong in broken.items():
            path = self.workspace.shown(file)
            if file not in included and wrong.code == NEWER:
                self.unread.append(Unread(IN_NEWER, path, wrong.span))
                self.trees.append(LaunchTree(path, unread=(wrong.span,), unstarted=(wrong.span,)))
            elif file not in included:
                name = f"{path}: {wrong.message}"
                self.unread.append(Unread("launch files with errors", name, wrong.span))
                self.trees.append(LaunchTree(path, broken=((name, wrong.span),)))
        tops = [launch for file, launch in launches.items() if file not in included]
        # Files that include each other have no top.
        tops = tops or [*launches.values()][:1]
        self.parts = [launch for launch in launches.values() if launch not in tops]
        for file in self.empty:
            # One that no launch file includes or names is a placeholder.
            is_named = any(file.name in self.workspace.text(each) for each in files)
            path = self.workspace.shown(file)
            place = whole_file(path)
            if file in included or is_named or not files:
                name = f"{path}: the launch file is empty"
                self.trees.append(LaunchTree(path, broken=((name, place),)))
            else:
                self.unread.append(Unread("empty launch files", path, place))
        yield from tops

    def _chosen(self, files: Sequence[Path]) -> Sequence[Path]:
        """Return the launch files that the user chose by (the ends of) their paths.

        Raises:
            MarsError: a choice names no launch file, or several.
        """
        found: dict[Path, None] = {}
        problems: list[Diagnostic] = []
        for name in self.chosen:
            parts = Path(name).parts
            exact = [file for file in files if file == Path(name).resolve()]
            same = exact or [file for file in files if file.parts[-len(parts) :] == parts]
            if len(same) == 1:
                found[same[0]] = None
                continue
            if same:
                listed = ", ".join(f"`{self.workspace.shown(file)}`" for file in same)
                message, help_text = f"`{name}` may be any of {len(same)} launch files", listed
            else:
                stems = {_ENDING.sub("", file.name): file.name for file in files}
                near = nearest(_ENDING.sub("", Path(name).name), stems)
                known = [f"`{each}`" for each in stems.values()]
                known[_MOST_NAMED:] = ["..."] * (len(known) > _MOST_NAMED)
                message = f"`{name}` is not a launch file of `{self.workspace.named}`"
                help_text = f"it has {', '.join(known) or 'none'}"
                help_text = f"did you mean `{stems[near]}`?" if near else help_text
            problems += refusal("launch", message, "--launch", help_text).diagnostics
        if problems:
            raise MarsError(problems)
        return list(found)

    def _is_launch(self, file: Path) -> bool:
        """Whether a file is a launch file, by its name or folder, and by its text."""
        is_named = file.name.endswith(LAUNCH_ENDINGS)
        if not is_named and not (file.suffix in _IN_FOLDER and "launch" in file.parent.parts[-2:]):
            return False
        try:
            text = self.workspace.text(file)
            is_script = file.suffix == ".launch" and _SCRIPT.match(text) is not None
            found = is_launch(text) and not is_script
        except MarsError as error:
            path, wrong = self.workspace.shown(file), error.diagnostics[0]
            name = f"{path}: {wrong.message}"
            self.unread.append(Unread("launch files with errors", name, wrong.span))
            self.trees.append(LaunchTree(path, broken=((name, wrong.span),)))
            return False
        if found and self._is_of_ros1(file):
            place = whole_file(self.workspace.shown(file))
            self.unread.append(
                Unread("launch files of ROS 1 in packages of ROS 2", file.name, place)
            )
            return False
        if not found and is_named:
            path = self.workspace.shown(file)
            place = whole_file(path)
            if not self.workspace.text(file).strip():
                self.empty.append(file)
                return False
            sort = "files that are named as launch files but are none"
            self.unread.append(Unread(sort, file.name, place))
        return found

    def _is_for_ros2(self, files: Iterable[Path]) -> bool | None:
        """Whether launch files are for ROS 2, by their packages or texts; None if unknown."""
        found = set()
        for file in files:
            package = self.workspace.package_of(file)
            if package is not None and package.is_of_ros1 != package.is_of_ros2:
                found.add(package.is_of_ros2)
            elif file.is_file() and _TYPE.search(self.workspace.text(file)) is not None:
                found.add(False)
        return found.pop() if len(found) == 1 else None

    def _is_of_ros1(self, file: Path) -> bool:
        """Whether a file is a launch file of ROS 1 in a package of ROS 2 alone."""
        package = self.workspace.package_of(file)
        if package is None or not _TYPE.search(self.workspace.text(file)):
            return False
        return package.is_of_ros2 and not package.is_of_ros1

    def _alone(self, paths: Sequence[Path]) -> Iterator[Started]:
        """Yield every program of the workspace as if started, as no launch file starts any."""
        if self.workspace.root not in paths:
            return
        here = whole_file(self.workspace.shown(paths[0]))
        found: dict[bool, list[Started]] = {True: [], False: []}
        for program in self.programs.all():
            interface = self.programs.interface(program)
            if interface is not None:
                topics = (*interface.published, *interface.subscribed)
                span = (topics[0].span if topics else None) or here
                started = Started(
                    program.package, program.executable, program.plugin, "", "/", (), {}, (), {},
                    span,
                )  # fmt: skip
                found[bool(topics)].append(started)
        # A package may have programs with services alone.
        yield from found[True] or found[False]

    def _by_hand(self, launches: Sequence[Launch], paths: Sequence[Path]) -> Iterator[GraphNode]:
        """Yield the nodes that users may start beside a launch tree.

        They are programs that no launch file starts, and nodes of launch files that others include.
        A component may be launched in place of its program, so topics of the same lines are left
        out.
        """
        started = {
            RosProgram(each.package, each.executable, each.plugin)
            for launch in launches
            for each in launch.started
        }
        interfaces = filter(None, map(self.programs.interface, started))
        spans = {topic.span for each in interfaces for topic in (*each.published, *each.subscribed)}
        before = self.unread, self.conditional, self.catalogued
        self.unread, self.conditional, self.catalogued = [], {}, {}
        for each in self._alone(paths):
            program = RosProgram(each.package, each.executable, each.plugin)
            node = None if program in started else self._node(each, None)
            if isinstance(node, GraphNode):
                published, subscribed = (
                    tuple(end for end in ends if end.span not in spans)
                    for ends in (node.published, node.subscribed)
                )
                yield GraphNode(node.name, node.span, published, subscribed)
        find = partial(self.workspace.find, folder=self.workspace.root)
        known = {node.name for tree in self.trees for node in tree.nodes}
        for launch in [*self.parts, *launches]:
            for part in with_controllers(launch.started, self._node_parameters, find, is_part=True):
                node = self._node(part, None) if isinstance(part, Started) else None
                # Controllers of a manager elsewhere have no node in any tree.
                is_further = launch in self.parts or (node is not None and node.name not in known)
                if isinstance(node, GraphNode) and is_further:
                    yield GraphNode(node.name, node.span, node.published, node.subscribed)
        self.unread, self.conditional, self.catalogued = before

    def _empty(self, paths: Sequence[Path]) -> MarsError:
        """Return the error that launch files start no node."""
        place = whole_file(self.workspace.shown(paths[0]))
        help_text = "name the launch file that starts the robot"
        return MarsError(
            (Diagnostic("ros2", "error", "the launch file starts no node", place, help=help_text),)
        )

    def _nothing(self, paths: Sequence[Path]) -> MarsError:
        """Return the error that the paths contain neither launch files nor programs."""
        message = "the folder has no launch file and no package with a program"
        help_text = "name a workspace, a package or a launch file"
        place = whole_file(self.workspace.shown(paths[0]))
        found = Diagnostic("ros2", "error", message, place, help=help_text)
        return MarsError((found, *notes(_once(self.unread))))

    def _node(self, started: Started, of_ros2: bool | None) -> GraphNode | Mux | Relay | None:
        """Return the node, mux or relay that is started; None if it is not read, and note it."""
        program = RosProgram(started.package, started.executable, started.plugin)
        key = started.package, started.executable, started.plugin
        known = self.catalogue.interface(*key)
        if started.package in _HELPERS and known is None:
            sort, called = _HELPERS[started.package], started.name or started.executable
            if started.executable in MANAGERS:
                sort = _CONTROLLER_MANAGERS
            self.unread.append(Unread(sort, called, started.span))
            return None
        is_here = not self.workspace.is_for_other_ros(started.package, of_ros2)
        source = self.programs.interface(program) if is_here else None
        interface, is_catalogued = source or known, source is None and known is not None
        if interface is not None and interface.namespace and started.namespace == "/":
            started = replace(started, namespace=name_in("/", interface.namespace))
        name = (
            started.name
            or (interface and interface.node)
            or re.split("::|/", program.executable)[-1]
        )
        if not _NAME.fullmatch(f"{started.namespace}{name}"):
            self.unread.append(Unread("names made at run time", "?", started.span))
            return None
        full = name_in(started.namespace, name)
        if started.conditions:
            self.conditional.setdefault(full, started.span)
        if is_mux(program):
            given = tuple(self._parameters_of_mux(started, full))
            mux = mux_of(started, name, full, given)
            if mux is not None:
                renamed_topics = self._renamed(started, name)
                return replace(mux, conditions=started.conditions, renamed=renamed_topics)
        values = self._node_parameters(started, full)
        is_source = interface is not None and not is_catalogued
        relay = self._relay(program, started, name, values)
        if relay is not None:
            return replace(relay, conditions=started.conditions)
        interface = interface or steered(program, started.arguments, values)
        if interface is None and is_bridge(program):
            interface = bridged(
                program, started.arguments, self._bridge_file(started, values), started.span
            )
        if interface is None:
            return self._without_source(started, full, name, values)
        if is_catalogued:
            self.catalogued.setdefault(full, started.span)
        before = len(self.unread)
        self._note_unread(interface, started, full)
        if interface.spread and not started.name and started.namespace != "/":
            name = ""
        published = tuple(self._endpoints(interface.published, started, name, values))
        heard = (*interface.subscribed, *self._observed(interface, started, name, values))
        subscribed = tuple(self._endpoints(heard, started, name, values))
        unread = any(each.sort in _OPEN for each in self.unread[before:])
        names = frozenset(
            absolute(written, started.namespace, name)
            for topic in (*interface.names, *interface.published, *interface.subscribed)
            for written in self._names_by_parameter(topic, started, values)
        )
        # Of several nodes of a program any may be there when others of their names are.
        # A source whose node name is an expression may name each of its nodes differently.
        is_named = (
            is_source
            and bool(interface.node)
            and all(each.sort != FURTHER_NODES for each in interface.unread)
        )
        is_whole = is_source and not (unread or interface.unnamed)
        guard = started.span if interface.guard else None
        relays = program.package in _RELAYS
        return GraphNode(
            full,
            started.span,
            published,
            subscribed,
            guard,
            relays,
            unread,
            started.conditions,
            renamed=(
                *self._renamed(started, name),
                *_set_by_parameters(interface, started, name, values),
            ),
            # Without its source, a name is mostly a habit of its program.
            is_named=(is_named or bool(started.name) or interface.is_name_sure)
            and not started.is_name_open,
            is_whole=is_whole and all(each.sort == SERVICES for each in interface.unread),
            package=started.package,
            manages=tuple(self._managed(started)),
            listens=interface.listens,
            names=names,
        )

    def _note_unread(self, interface: Interface, started: Started, full: str) -> None:
        """Note the contents of a program that were not read; `full` is the node's name."""
        self.unread += interface.unread
        if interface.clients:
            self.unread.append(Unread(BY_CLIENTS, full, started.span))
        if interface.spread and started.name and started.namespace != "/":
            # The launch file names all of its nodes alike.
            self.unread.append(Unread(AT_RUN_TIME, full, started.span))

    def _with_marker(self, each: Unread) -> Unread:
        """Return skipped contents, of a package that is not to be built with the marker for it."""
        marker = self.workspace.marker_of(each.name)
        if marker is None:
            return each
        sort = f"files of packages in a folder that `{self.workspace.shown(marker)}` excludes"
        return each._replace(sort=sort)

    def _without_source(
        self, started: Started, full: str, name: str, values: Mapping[str, GivenParameter]
    ) -> GraphNode:
        """Return the node `full` of a program whose source is unknown, without topics."""
        sort = "nodes (no readable source here, no entry in the catalogue)"
        marker = self.workspace.marker_of(f"$(find-pkg-share {started.package})")
        if marker is not None:
            sort = f"nodes of packages in a folder that `{self.workspace.shown(marker)}` excludes"
        self.unread.append(Unread(sort, full, started.span))
        return GraphNode(
            full,
            started.span,
            unread=True,
            conditions=started.conditions,
            # A program whose source is not known may name its node apart.
            is_named=bool(started.name) and not started.is_name_open,
            renamed=self._renamed(started, name),
            package=started.package,
            manages=tuple(self._managed(started)),
            names=frozenset(self._given_topics(started, name, values)),
        )

    def _given_topics(
        self, started: Started, name: str, values: Mapping[str, GivenParameter]
    ) -> Iterator[str]:
        """Yield the topic names among the parameters of a node without source."""
        for key, given in values.items():
            for text in given.texts if given.is_known else ():
                if _NAME.fullmatch(text) and (text.startswith("/") or "topic" in key):
                    yield absolute(text, started.namespace, name)

    def _renamed(self, started: Started, name: str) -> tuple[Renaming, ...]:
        """Return the remappings of a node with full names."""
        return tuple(
            Renaming(
                renamed(rule[0], started.namespace, name, ()),
                renamed(rule[0], started.namespace, name, (rule,)),
                started.spans[rule],
            )
            for rule in started.remaps
        )

    def _managed(self, started: Started) -> Iterator[tuple[str, Span]]:
        """Yield full name and location of each node that a lifecycle manager manages."""
        given = started.parameters.get("node_names")
        if started.package != "nav2_lifecycle_manager" or given is None or not given.is_known:
            return
        nodes = given.value.nodes if isinstance(given.value, Items) else (given.value,)
        for each in nodes:
            if isinstance(each, Scalar):
                yield name_in(started.namespace, each.text), each.span

    def _relay(
        self, program: RosProgram, started: Started, name: str, values: Mapping[str, GivenParameter]
    ) -> Relay | None:
        """Return the relay that a node is, or None if it is none or a topic is unknown."""
        # A nodelet has two words before its own.
        skipped = 2 if started.arguments[:1] in (("load",), ("standalone",)) else 0
        words = tuple(takewhile(lambda word: not word.startswith("--"), started.arguments))
        found = handed_on(program, words[skipped:], values)
        if found is None:
            return None
        full, source, target = (
            renamed(topic, started.namespace, name, started.remaps)
            for topic in ("~/", found.source, found.target)
        )
        if not _NAME.fullmatch(source + target):
            return None
        self.unread += (Unread(sort, each, started.span) for sort, each in found.left_out)
        return Relay(full, started.span, source, target, found.hz)

    def _given_files(
        self, started: Started, full: str, of_ros2: bool | None
    ) -> Iterator[GivenFile]:
        """Yield the parameter files of a node of ROS 2; `full` is the node's name."""
        for file in started.files:
            document = self.document(file)
            if document is not None:
                first, is_for_it = section_for(document, full, started.plugin)
                # A launch file reads the files of components, and takes nothing from such a one.
                is_refused = is_for_it is None and of_ros2 and not started.plugin
                if first is not None and (is_for_it is not None or is_refused):
                    yield GivenFile(self.workspace.shown(file), first.span, is_for_it)

    def _node_parameters(self, started: Started, full: str) -> Mapping[str, GivenParameter]:
        """Return the parameters of a node by name; `full` is the node's name."""
        return {**self._file_parameters(started, full), **started.parameters}

    def _file_parameters(self, started: Started, full: str) -> Mapping[str, GivenParameter]:
        """Return the parameters that the files of a node have for the name `full`."""
        found: dict[str, GivenParameter] = {}
        for file in started.files:
            document = self.document(file)
            if document is not None:
                found |= values_for(document, full)
        return found

    def _observed(
        self,
        interface: Interface,
        started: Started,
        name: str,
        values: Mapping[str, GivenParameter],
    ) -> Iterator[InterfaceTopic]:
        """Yield the topics that parameters name as sources of observation of a node.

        `values` are its own parameters. A file that cannot be read is taken to name what that of
        Nav2 does.
        """
        if interface.observes:
            full = absolute(interface.observes, started.namespace, name)
            is_own = interface.observes == "~"
            yield from observed(values if is_own else self._file_parameters(started, full))
            # A launch file of Nav2 that is given no file takes its own.
            is_usual = started.is_rewritten and not started.files
            if is_usual or self._is_partly_known(started):
                yield USUAL

    def _is_partly_known(self, started: Started) -> bool:
        """Whether a node has parameter files that cannot be read, or values of a run."""
        documents = map(self.document, started.files)
        return started.has_further_files or any(each is None for each in documents)

    def _bridge_file(
        self, started: Started, values: Mapping[str, GivenParameter]
    ) -> YamlNode | None:
        """Return the parsed file that lists a bridge's topics, None without one."""
        if FILE not in values:
            return None
        named = values[FILE].text
        file = self.workspace.find(named, self.workspace.root)
        if file is None:
            sort = "parameter files that are not in the workspace"
            self.unread.append(Unread(sort, named, started.span))
        return None if file is None else self.document(file)

    def _document(self, file: Path) -> YamlNode | None:
        shown = self.workspace.shown(file)
        repeated: list[Repeat] = []
        try:
            text = self.workspace.text(file)
            return read_yaml(text, shown, repeated=repeated, merges=PARAMETERS in text)
        except MarsError as error:
            first = error.diagnostics[0]
            self.unread.append(
                Unread("parameter files with errors", f"{shown}: {first.message}", first.span)
            )
            return None
        finally:
            self.repeated[file] = tuple(
                RepeatedKey(each.key.text, each.key.span, each.is_merged, each.within)
                for each in repeated
            )

    def _endpoints(
        self,
        topics: Sequence[InterfaceTopic],
        started: Started,
        name: str,
        values: Mapping[str, GivenParameter],
    ) -> Iterator[Endpoint]:
        """Yield a node's ends of topics with full names; note unknown names."""
        for topic in topics:
            if _is_off(topic, values):
                continue
            for written in self._names_by_parameter(topic, started, values):
                full = renamed(written, started.namespace, name, started.remaps)
                if topic.image and full == renamed(written, started.namespace, name, ()):
                    image = renamed(topic.image, started.namespace, name, started.remaps)
                    full = f"{image.rpartition('/')[0]}/{written.rpartition('/')[2]}"
                if not written or not _NAME.fullmatch(full):
                    span = topic.span or started.span
                    called = written
                    if topic.parameter:
                        called = f"{name_in(started.namespace, name)}.{topic.parameter}"
                    self.unread.append(Unread(AT_RUN_TIME, called, span))
                    continue
                # Of a source its own line counts, of the catalogue what the user renames.
                span = topic.span or self._renaming(written, full, started, name) or started.span
                # Such a topic is the border of a robot whose launch files start no such node.
                package = self.catalogue.package_of_topic(full)
                driver = None if package in self.packages else package
                marks = topic.optional, topic.measured, topic.last
                yield Endpoint(full, topic.type, span, topic.hz, *marks, driver)

    def _names_by_parameter(
        self, topic: InterfaceTopic, started: Started, values: Mapping[str, GivenParameter]
    ) -> Iterator[str]:
        """Yield the names that parameters give a topic, empty if unknown."""
        # A file that cannot be read, or a value of a run, may replace a default.
        is_hidden = self._is_partly_known(started)
        if topic.parts:
            texts = [
                text if of is None else _value_of(values.get(of), None if is_hidden else text)
                for text, of in topic.parts
            ]
            yield "" if None in texts else "".join(filter(None, texts))
        elif topic.parameter is None:
            yield topic.name
        elif topic.parameter.endswith("#"):
            stem = topic.parameter[:-1]
            for key, value in values.items():
                if key.startswith(stem) and _NUMBERED.fullmatch(key[len(stem) :]):
                    yield value.text
        elif topic.parameter.endswith("[]"):
            listed = values.get(topic.parameter[:-2])
            yield from () if listed is None else listed.texts
        else:
            default = None if is_hidden else topic.name
            yield _value_of(values.get(topic.parameter), default) or ""

    def _renaming(self, written: str, full: str, started: Started, name: str) -> Span | None:
        """Return the location of the remapping from `written` to `full`, None without one."""
        for rule in started.remaps:
            if (
                renamed(written, started.namespace, name, (rule,))
                == full
                != renamed(written, started.namespace, name, ())
            ):
                return started.spans.get(rule)
        return None

    def _parameters_of_mux(self, started: Started, full: str) -> Iterator[Mux]:
        """Yield the muxes in a node's parameters: launch file, else files, else the user's.

        A mux of the user with the name of the node has the place of the files.
        """
        found: list[Mux] = []
        users = [mux for document in self.muxes for mux in document.muxes]
        values = self._node_parameters(started, full)
        sorts = {key: each for key, each in values.items() if key.partition(".")[0] in SORTS}
        # A file that alone describes the mux is read as written, with what ROS refuses in it.
        files_of_sorts = {each.keys[0].span.path for each in sorts.values()}
        if len(files_of_sorts) > 1 or sorts.keys() & started.parameters.keys():
            given = document_of((each for each in values.values() if each.is_known), started.span)
            found += self._muxes(lambda: read_parameters(given, full))
        found = found or [each for each in users if each.name and is_for(each.name, full)]
        # cmd_vel_mux names its file in a parameter.
        named = started.parameters.get("yaml_cfg_file")
        of_its_own = named and self.workspace.find(named.text, self.workspace.root)
        files = () if found else (*started.files, *filter(None, (of_its_own,)))
        for file in files:
            if self.document(file) is None:
                continue
            text, shown = self.workspace.text(file), self.workspace.shown(file)
            muxes = self._muxes(partial(read_parts, text, shown))
            # A node of ROS 2 takes the parameters for its name; a launch file may take others.
            takes_all = started.is_rewritten or PARAMETERS not in text
            found += (each for each in muxes if takes_all or is_for(each.name, full))
        yield from found or users

    def _muxes(self, read: Callable[[], MuxDocument]) -> Sequence[Mux]:
        """Return the muxes that `read` reads; note its errors and skipped contents."""
        try:
            document = read()
        except MarsError as error:
            # The rest of the workspace is judged without the mux.
            for each in error.diagnostics:
                name = f"{each.span.path}: {each.message}"
                self.unread.append(Unread("parameter files with errors", name, each.span))
            return ()
        self.unread += document.unread
        self.problems += document.warnings
        return document.muxes

    def _note(self) -> None:
        """Note the nodes with conditions, and those with topics from the catalogue."""
        if self.conditional:
            first, *_ = self.conditional.values()
            verb = "depends" if len(self.conditional) == 1 else "depend"
            message = (
                f"{counted(len(self.conditional), 'node')} {verb} on conditions, "
                "of which every branch was read"
            )
            self.problems.append(Diagnostic("launch", "note", message, first, kind="launch"))
        if self.catalogued:
            spans = self.catalogued
            names = ", ".join(f"`{name}`" for name in list(spans)[:_MOST_NAMED])
            more = ", ..." if len(spans) > _MOST_NAMED else ""
            described = counted(len(spans), "node")
            message = f"the topics of {described} are from the catalogue: {names}{more}"
            first = next(iter(spans.values()))
            self.problems.append(Diagnostic("catalogue", "note", message, first, kind="catalogue"))


def _is_off(topic: InterfaceTopic, values: Mapping[str, GivenParameter]) -> bool:
    """Whether a parameter has a value that switches a topic of the program off."""
    return any(
        name in values and values[name].is_known and values[name].text.lower() == _TRUTH[not wanted]
        for name, wanted in topic.switches
    )


def _set_by_parameters(
    interface: Interface, started: Started, name: str, values: Mapping[str, GivenParameter]
) -> Iterator[Renaming]:
    """Yield the topics to which parameters give another name than the program's default."""
    for topic in (*interface.published, *interface.subscribed):
        value = values.get(topic.parameter or "")
        if value is not None and value.is_known and value.text and topic.name:
            before = renamed(topic.name, started.namespace, name, ())
            after = renamed(value.text, started.namespace, name, started.remaps)
            yield Renaming(before, after, value.keys[0].span, is_by_parameter=True)


def _value_of(given: GivenParameter | None, default: str | None) -> str | None:
    """Return the value of a parameter: `default` if not set, None if not known."""
    if given is None:
        return default
    return given.text if given.is_known else None
