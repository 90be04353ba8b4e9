"""The input of the commands that reason: read files, load rules, analyse."""

import argparse
import os
import re
import shlex
from collections.abc import Collection, Iterable, Iterator, Sequence
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.cli.diagnostic_text import report
from mars_asp.cli.lines import remember
from mars_asp.cli.progress import detail, stage
from mars_asp.cli.settings import packs_for, settings_of
from mars_asp.cli.suggested_commands import command
from mars_asp.cli.worker import read_standard_input
from mars_asp.diagnostic import Diagnostic, MarsError, refusal, whole_file
from mars_asp.exchange.folders import IsExcluded, nothing_excluded
from mars_asp.exchange.foreign import ForeignFile, read_foreign
from mars_asp.exchange.recognise import recognised
from mars_asp.language import Parsed, parse_text
from mars_asp.language.parse import MOST_BYTES, decode, plain_lines, read_text, unreadable
from mars_asp.model.declarations import VERBS, PackKind
from mars_asp.output import counted, visible
from mars_asp.reading import SHOWN_INPUT
from mars_asp.reasoning.analysis import Analysis, analyse
from mars_asp.reasoning.launch_trees import analyse_trees
from mars_asp.reasoning.packs import find_packs, kinds_of
from mars_asp.reasoning.project import (
    Project,
    described,
    has_attributes,
    project_facts,
    with_brought,
    with_kinds,
)
from mars_asp.reasoning.rules import brought_by, load_rulebook
from mars_asp.spelling import nearest

if TYPE_CHECKING:
    from mars_asp.exchange.folders import FolderRobots

STANDARD_INPUT = "-"
#: The suffixes of files that belong to robots, but are not robots by themselves.
_PARTS = frozenset(
    ".c .cc .cpp .cxx .h .hpp .py .rs .java .go .m .xml .urdf .launch .yaml .yml .json .toml .md "
    ".cmake".split()
)
#: A relationship, or `@` at the start of the first line that is not a comment.
_STATEMENT = re.compile(rf"\b(?:{'|'.join(VERBS)})\b|\A(?:\s*+(?:(?://|#).*+)?+)*+@")
_CONFIGURATION = re.compile(r"(?m)^\s*@(?:configuration|specification|modules)\b")
#: The files and folders that are robots.
ROBOTS = (
    "robots are `.mars` files, packages and launch files of ROS, twist_mux files, "
    "dataflows of dora, dumps of ROS graphs and URDF documents"
)
#: The stages of rules that judge a robot.
JUDGING = ("resolve", "launch")
#: The arguments of commands that may name the first input.
_FILES = ("files", "file", "old", "specification")
#: More notes on reading than these are counted beside an answer, not printed.
_FEW_NOTES = 3
#: Of a missing file, so many names beside it are compared, and one this similar is proposed.
_MOST_NAMES, _ALIKE = 1000, 0.7
#: A message names at most so many robots of a folder.
_MOST_NAMED = 10


def read_input(shown: str) -> str:
    """Return the text of standard input; `shown` is its name in messages.

    Raises:
        MarsError: the input is too large, or is not text.
    """
    return decode(read_standard_input(MOST_BYTES + 1), shown)


def shown_input(arguments: argparse.Namespace) -> str:
    """Return the name of standard input in locations: `--stdin-filename`, else `<stdin>`."""
    return getattr(arguments, "stdin_filename", None) or SHOWN_INPUT


def add_stdin_filename(parser: argparse.ArgumentParser) -> None:
    """Add the option that names standard input."""
    parser.add_argument("--stdin-filename", metavar="NAME")


def check_inputs(*paths: str) -> None:
    """Raise MarsError if standard input is named twice, or a path is empty.

    Raises:
        MarsError: standard input is named twice, or a path is empty.
    """
    if "" in paths:
        help_text = "name a file or folder; `.` is this folder"
        raise refusal("usage", "a path is empty", "PATH", help_text)
    if paths.count(STANDARD_INPUT) > 1:
        message = "standard input was read for another file already"
        help_text = "give all files but one by their names"
        raise refusal("usage", message, STANDARD_INPUT, help_text)


def beside(arguments: argparse.Namespace, path: str, other: str) -> argparse.Namespace:
    """Return the arguments to read one of two robots with: of these, `--from` is the foreign one's.

    A `.mars` file beside it needs no format.
    """
    if Path(path).suffix != ".mars" or Path(other).suffix == ".mars":
        return arguments
    return argparse.Namespace(**vars(arguments) | {"from_format": None})


def read_specification(arguments: argparse.Namespace, path: str) -> Project:
    """Read a specification with its own sources; a foreign file is read as a specification.

    A missing source is a warning: the configuration may describe the modules.

    Raises:
        MarsError: the files have errors.
    """
    with stage(arguments, f"reading {visible(path)}"):
        text = None
        if path == STANDARD_INPUT:
            path = SHOWN_INPUT
            text = read_input(path)
        parsed, text, foreign = _parse(arguments, only_robot(arguments, path), text)
        brought = _brought(arguments, bool(parsed.configuration.pack_nodes))
        kinds = tuple(each for each in brought if isinstance(each, PackKind))
        parsed = parsed._replace(configuration=with_kinds(parsed.configuration, kinds))
        if foreign is None:
            return described(parsed, text, optional=True)
    from mars_asp.exchange.lift import lifted

    return Project(lifted(parsed.configuration), {}, parsed.warnings, text)


def read_project(
    arguments: argparse.Namespace, path: str | None = None, *, quietly: bool = False
) -> Project:
    """Read the project of FILE, or of all FILE arguments, and report the messages on reading.

    Args:
        arguments: The words of the command.
        path: The file, if not those of the command.
        quietly: Whether the command reports the messages itself, if they are selected. Other
            commands merge all launch trees into one robot, and report that.

    Raises:
        MarsError: the files have errors.
    """
    path, *further = arguments.files if path is None else (path,)
    check_inputs(path, *further)
    text = None
    if path == STANDARD_INPUT:
        path = shown_input(arguments)
        text = read_input(path)
    if not os.path.isdir(path):  # noqa: PTH112 -- never raises
        print_settings(arguments, Path(path).parent)
    path, *further = (only_robot(arguments, each) for each in (path, *further))
    project = load(arguments, path, text, further)
    if not quietly:
        report_project(project, arguments, [path, *further])
    return project


def report_project(project: Project, arguments: argparse.Namespace, paths: Sequence[str]) -> None:
    """Report the messages on reading a project; of many notes only their number."""
    if sum(each.severity == "note" for each in project.diagnostics) > _FEW_NOTES:
        report_reading(project, argparse.Namespace(**vars(arguments) | {"files": list(paths)}))
    else:
        report((*project.diagnostics, *one_of_several(project, arguments)), arguments)


def report_reading(project: Project, arguments: argparse.Namespace) -> None:
    """Report the messages on reading a project beside an answer: of notes only their number.

    JSON has each of them.
    """
    found: Sequence[Diagnostic] = project.diagnostics
    notes = [each for each in found if each.severity == "note"]
    if notes and arguments.format != "json":
        path = project.configuration.path
        message = f"{counted(len(notes), 'note')} on reading: see `{command('check', arguments)}`"
        found = [each for each in found if each.severity != "note"]
        found.append(Diagnostic("reading", "note", message, whole_file(path)))
    report((*found, *one_of_several(project, arguments)), arguments)


def one_of_several(project: Project, arguments: argparse.Namespace) -> Iterator[Diagnostic]:
    """Yield the note that several launch trees were taken for one robot, if they were."""
    if len(project.trees) > 1:
        number = len(project.trees)
        message = f"the nodes of {number} launch files were taken for one robot"
        way = "`--launch LAUNCHFILE` takes one of them"
        if not hasattr(arguments, "launch"):
            way = "name one of them in place of the folder to take it alone"
        help_text = f"{way}; `check -v` lists them"
        span = whole_file(project.configuration.path)
        yield Diagnostic("launch", "note", message, span, help=help_text, kind="launch")


def _brought(arguments: argparse.Namespace, with_attributes: bool) -> tuple[object, ...]:
    """Return the kinds of nodes that packs declare and, if requested, the attributes.

    Without attributes no rules are read, and errors of packs are raised later.

    Raises:
        MarsError: packs are wrong, if attributes are requested.
    """
    packs = packs_of(arguments)
    return brought_by(packs) if with_attributes else kinds_of(find_packs(packs, []))


def _parse(
    arguments: argparse.Namespace, path: str, text: str | None, further: Sequence[str] = ()
) -> tuple[Parsed, str, str | None]:
    """Return a parsed file, its text, and its format if it is foreign.

    `further` are foreign files of the same robot.

    Raises:
        MarsError: the file has errors.
    """
    if getattr(arguments, "launch", ()) and os.path.isfile(path):  # noqa: PTH113 -- never raises
        message = "--launch chooses a robot of a folder, and this is a file"
        raise refusal("usage", message, path, "name the folder of the workspace")
    files = [_read_file(arguments, path, text), *(_read_file(arguments, each) for each in further)]
    first = files[0]
    ours = [file for file in files if file.format == "mars"]
    if not ours:
        excluded: IsExcluded = nothing_excluded
        if Path(path).is_dir():
            from mars_asp.cli.excluded import excluded_in

            excluded = excluded_in(arguments, Path(path))
        found = read_foreign(files, getattr(arguments, "launch", ()), excluded)
        return found, first.text, found.configuration.origin
    if further:
        message = f"`{ours[0].path}` is a robot of its own, and so is each `.mars` file"
        help_text = "give it alone, or several to `mars-asp check`; foreign files are one robot"
        raise refusal("usage", message, ours[0].path, help_text)
    try:
        return parse_text(first.text, path), first.text, None
    except MarsError as error:
        # A text of one line may be a statement that is misspelt, unless its file is plain text.
        is_long = len(error.diagnostics) > 1 or Path(path).suffix == ".txt"
        is_other = is_long and _STATEMENT.search(first.text) is None
        is_meant = arguments.from_format == "mars" or Path(path).suffix == ".mars"
        if is_meant or not is_other:
            raise
    message = f"`{path}` is not a robot: no line is a statement of a `.mars` file"
    help_text = f"{ROBOTS}; a source is read with the workspace that it lies in"
    if Path(path).suffix == ".lp":
        help_text = "`mars-asp rules lint FILE` checks rules, and `mars-asp test FILE` runs cases"
    raise refusal("unreadable", message, path, help_text)


def _read_file(arguments: argparse.Namespace, path: str, text: str | None = None) -> ForeignFile:
    """Read a file, unless `text` is its content, and detect its format.

    Raises:
        MarsError: the file cannot be read, or is not a robot by itself.
    """
    if text is None and path == STANDARD_INPUT:
        path = shown_input(arguments)
        text = read_input(path)
    if text is None and os.path.isdir(path):  # noqa: PTH112 -- never raises
        return ForeignFile(path, "", "ros2")
    if text is None and (package := package_named(path)) is not None:
        raise MarsError([unreadable(path, "no such file", f"the package is in `{package}`")])
    if text is None and ":=" in path and not os.path.lexists(path):
        help_text = "leave the argument out: every branch of a launch file is read"
        raise MarsError([unreadable(path, "no such file", help_text)])
    if text is None and not os.path.lexists(path) and (near := _file_like(path)) is not None:
        raise MarsError([unreadable(path, "no such file", f"did you mean `{near}`?")])
    if text is None:
        # A pipe can be read only once.
        streamed: dict[str, str] = vars(arguments).setdefault("streamed", {})
        text = streamed.get(path) or read_text(Path(path))
        if not Path(path).is_file():
            streamed[path] = text
    else:
        text = plain_lines(text)
    # Messages about a file quote its lines.
    remember(path, text)
    format = arguments.from_format or recognised(text)
    if arguments.from_format not in (None, "mars") and _CONFIGURATION.search(text) is not None:
        message = f"`{path}` is a `.mars` file, and --from names another format"
        raise refusal("format", message, path, "leave out --from")
    if format == "mars" and arguments.from_format is None and is_other_file(path, text):
        if not text.strip():
            place, help_text = whole_file(path), "write the file, or name another"
            raise MarsError(
                [Diagnostic("empty", "error", "the file is empty", place, help=help_text)]
            )
        message = f"`{path}` is not a robot by itself"
        help_text = "name the workspace, package or launch file that uses it"
        if Path(path).suffix.lower() in (".md", ".toml", ".json"):
            help_text = ROBOTS
        elif (workspace := workspace_of(path)) is not None:
            help_text = f"name its workspace, `{workspace}`"
        raise refusal("unreadable", message, path, help_text)
    return ForeignFile(path, text, format)


def _file_like(path: str) -> str | None:
    """Return the robot of `.mars` beside a missing path whose name is similar, or None."""
    folder, name = os.path.split(path)
    stem, suffix = os.path.splitext(name)  # noqa: PTH122 -- as it was written
    beside = (each.stem for each in islice(Path(folder).glob("*.mars"), _MOST_NAMES))
    near = nearest(stem, beside, _ALIKE) if suffix == ".mars" else None
    return None if near is None else os.path.join(folder, near + suffix)  # noqa: PTH118


def package_named(path: str) -> Path | None:
    """Return the folder near this one of the ROS package that a path is the name of, or None."""
    if re.fullmatch(r"\w+", path) is None or os.path.lexists(path):
        return None
    near = (Path().glob(f"{above}/{path}/package.xml") for above in ("src", "src/*", "*"))
    return next((each.parent for found in near for each in found), None)


def is_other_file(path: str, text: str) -> bool:
    """Whether a file is a source, a document or the like instead of a robot."""
    suffix = Path(path).suffix.lower()
    if "\0" in text or suffix not in _PARTS:
        return False
    return suffix == ".md" or _CONFIGURATION.search(text) is None


def workspace_of(path: str) -> str | None:
    """Return the workspace or package of ROS that a file lies in, or None if it lies in none."""
    from mars_asp.exchange.ros2.read import workspace_around

    found = workspace_around(Path(path))
    if found is None:
        return None
    return str(found) if Path(path).is_absolute() else os.path.relpath(found)


def only_robot(arguments: argparse.Namespace, path: str) -> str:
    """Return the path of the only robot in a folder; any other path unchanged.

    Raises:
        MarsError: there is no robot, or there are several.
    """
    if not os.path.isdir(path):  # noqa: PTH112 -- never raises
        return path
    found = robots_in_folder(arguments, path)
    first, *others = found.paths or (None,)
    if first is None:
        raise MarsError([_nothing_in(path, found.notes)])
    if others:
        number = len(found.paths)
        message = f"the folder has {number} robots"
        # The folder itself may be one of them, and its name does not choose that one.
        inner = [each for each in found.paths if each != Path(path)]
        named = ", ".join(f"`{each}`" for each in inner[:_MOST_NAMED])
        rest = f" and {len(inner) - _MOST_NAMED} more" if len(inner) > _MOST_NAMED else ""
        way = visible(shlex.join(["mars-asp", "check", path]))
        help_text = f"name one of them: {named}{rest}; `{way}` judges all"
        if len(inner) < number:
            help_text += f"; `--from ros2` takes `{path}` for a workspace alone"
        raise refusal("usage", message, path, help_text)
    return str(first)


def robots_in_folder(arguments: argparse.Namespace, path: str) -> "FolderRobots":
    """Return the robots in a folder; with `--launch` or `--from ros2`, one workspace of ROS.

    Raises:
        MarsError: the folder cannot be read; its settings are wrong, or exclude each robot.
    """
    from mars_asp.cli.excluded import excluded_in
    from mars_asp.exchange.folders import FolderRobots, robots_in

    if not os.access(path, os.R_OK | os.X_OK):
        raise MarsError([unreadable(path, "permission denied")])
    if arguments.from_format not in (None, "ros2"):
        message = f"`--from {arguments.from_format}` is the format of files, and this is a folder"
        raise refusal("usage", message, path, "name the files, or leave out --from")
    excluded = excluded_in(arguments, Path(path))
    launch = [Path(each).resolve() for each in getattr(arguments, "launch", ())]
    if launch or arguments.from_format == "ros2":
        # Of several workspaces in the folder, take the one with the launch files.
        is_path = launch and all(each.is_file() for each in launch)
        robots = robots_in(Path(path), excluded).paths if is_path else ()
        folders = [
            each for each in robots if all(file.is_relative_to(each.resolve()) for file in launch)
        ]
        robot = folders[0] if len(folders) == 1 else Path(path)
        print_settings(arguments, Path(path))
        detail(arguments, f"robot {robot}")
        return FolderRobots((robot,))
    passed_over: list[Path] = []

    def is_excluded(each: Path, is_folder: bool) -> bool:
        hit = excluded(each, is_folder)
        if hit:
            passed_over.append(each)
        return hit

    found = robots_in(Path(path), is_excluded)
    print_settings(arguments, Path(path))
    for each in found.paths:
        detail(arguments, f"robot {each}")
    for each in passed_over[:_MOST_NAMED]:
        detail(arguments, f"excluded {each}")
    if len(passed_over) > _MOST_NAMED:
        detail(arguments, f"excluded {len(passed_over) - _MOST_NAMED} more paths")
    if found.passed_over:
        others = counted(found.passed_over, "other file")
        detail(arguments, f"{others} in {path} passed over (no robot by content)")
    if not found.paths and passed_over and robots_in(Path(path)).paths:
        message = "each robot in the folder is excluded"
        help_text = "see `.gitignore`, `--exclude` and `exclude` of mars.toml; `-v` lists the paths"
        raise refusal("usage", message, path, help_text)
    return found


def print_settings(arguments: argparse.Namespace, *folders: Path) -> None:
    """Print with `--verbose` the paths of the settings that apply to folders, each once."""
    if arguments.verbose:
        for path in dict.fromkeys(settings_of(arguments, each).path for each in folders):
            detail(arguments, f"settings {path}" if path else "no settings")


def _nothing_in(path: str, notes: Iterable[Diagnostic]) -> Diagnostic:
    message = "; ".join(("the folder has nothing to read", *(each.message for each in notes)))
    workspace = workspace_of(path)
    help_text = ROBOTS if workspace is None else f"name its workspace, `{workspace}`"
    return Diagnostic("unreadable", "error", message, whole_file(path), help=help_text)


class RobotFiles(NamedTuple):
    """The files of a robot with notes about their folder, or the problems of reading them."""

    paths: list[str]
    notes: tuple[Diagnostic, ...] = ()
    problems: tuple[Diagnostic, ...] = ()


def robots(arguments: argparse.Namespace, paths: Sequence[str]) -> list[RobotFiles]:
    """Return the files of each robot that the paths name or contain.

    Each robot in a folder is separate. Named foreign files are one robot together, in the order
    of the first.
    """
    found: list[RobotFiles] = []
    foreign: list[str] = []
    for path in paths:
        if is_passed_over(arguments, path):
            continue
        if os.path.isdir(path):  # noqa: PTH112 -- never raises
            try:
                within = robots_in_folder(arguments, path)
            except MarsError as error:
                found.append(RobotFiles([path], problems=error.diagnostics))
                continue
            if not within.paths:
                found.append(RobotFiles([path], problems=(_nothing_in(path, within.notes),)))
                continue
            if within.paths != (Path(path),):
                found += (RobotFiles([str(each)]) for each in within.paths)
                found[-1] = found[-1]._replace(notes=within.notes)
                continue
            found.append(RobotFiles([path], notes=within.notes))
            continue
        if len(paths) == 1 or path == STANDARD_INPUT or not _is_foreign(arguments, path):
            found.append(RobotFiles([path]))
        else:
            if not foreign:
                found.append(RobotFiles(foreign))
            foreign.append(path)
    # A file may be named, and also be in a named folder.
    first: dict[tuple[str, ...], RobotFiles] = {}
    for robot in found:
        first.setdefault(tuple(map(os.path.realpath, robot.paths)), robot)
    for robot in first.values():
        path = robot.paths[0]
        # Those in folders are listed with their folder.
        if path in paths and not os.path.isdir(path):  # noqa: PTH112 -- never raises
            shown = shown_input(arguments) if path == STANDARD_INPUT else path
            print_settings(arguments, Path(shown).parent)
            detail(arguments, f"robot {', '.join(robot.paths)}")
    return list(first.values())


def is_passed_over(arguments: argparse.Namespace, path: str) -> bool:
    """Whether `--force-exclude` is given, and settings or options exclude a named path.

    Standard input has the path of `--stdin-filename`.

    Raises:
        MarsError: the settings of its folder are wrong.
    """
    from mars_asp.cli.excluded import excluded_in

    path = shown_input(arguments) if path == STANDARD_INPUT else path
    if not arguments.force_exclude or path == SHOWN_INPUT:
        return False
    shown = os.path.relpath(path)
    file = Path(path if shown.startswith(os.pardir) else shown)
    # Seen from the current folder, patterns name folders above the file as well.
    root = file.parent if file.is_absolute() else Path()
    excluded = excluded_in(arguments, root, file.parent)
    folders = (each for each in file.parents if each not in (root, *root.parents))
    return excluded(file, os.path.isdir(file)) or any(excluded(each, True) for each in folders)  # noqa: PTH112 -- never raises


def _is_foreign(arguments: argparse.Namespace, path: str) -> bool:
    """Whether a file, folder or pipe can be read and is foreign."""
    if not os.path.exists(path):  # noqa: PTH110 -- never raises
        return False
    try:
        return _read_file(arguments, path).format != "mars"
    except MarsError:
        return False


def load(
    arguments: argparse.Namespace, path: str, text: str | None = None, further: Sequence[str] = ()
) -> Project:
    """Read the project at a path; `text` replaces its content, `further` are more foreign files.

    Raises:
        MarsError: the files have errors.
    """
    with stage(arguments, f"reading {visible(path)}"):
        parsed, text, foreign = _parse(arguments, path, text, further)
        project = described(parsed, text, arguments.sources, foreign)
        with_attributes = has_attributes(project) or bool(project.configuration.pack_nodes)
        project = with_brought(project, _brought(arguments, with_attributes))
    for tree in project.trees:
        detail(arguments, f"launch file {tree.path}")
    return project


def rulebook_for(arguments: argparse.Namespace, stages: Collection[str] = ("resolve",)) -> Rulebook:
    """Load the built-in rules, and the packs of a command.

    Raises:
        MarsError: the rule files have errors.
    """
    return load_rulebook(packs_of(arguments), stages, trusted=arguments.trust)


def packs_of(arguments: argparse.Namespace) -> list[Path]:
    """Return the packs for the folder of the first file, and then those of `--rules`.

    Raises:
        MarsError: the settings have errors.
    """
    named = (getattr(arguments, each, None) for each in _FILES)
    first = next((each for each in named if each), ".")
    name = first if isinstance(first, str) else first[0]
    path = Path(shown_input(arguments) if name == STANDARD_INPUT else name)
    folder = path if os.path.isdir(path) else path.parent  # noqa: PTH112 -- never raises
    return [*packs_for(arguments, folder), *map(Path, arguments.rules)]


def analyse_project(
    project: Project, rulebook: Rulebook, arguments: argparse.Namespace
) -> Analysis:
    """Return the consequences of a project.

    Raises:
        MarsError: clingo refuses the rules.
    """
    with stage(arguments, "analysing"):
        facts = project_facts(project)
        return analyse(facts, rulebook, project.configuration.span, with_labels=True)


def judge_project(project: Project, rulebook: Rulebook, arguments: argparse.Namespace) -> Analysis:
    """Return the findings in a project: in its launch trees, or else its consequences.

    Raises:
        MarsError: clingo refuses the rules.
    """
    if not project.trees:
        return analyse_project(project, rulebook, arguments)
    with stage(arguments, "analysing"):
        return analyse_trees(project, rulebook)


def unapplied_packs(project: Project, rulebook: Rulebook) -> Iterator[Diagnostic]:
    """Yield the note that rule packs do not judge launch trees, if a project has some."""
    if project.trees and rulebook.packs:
        message = "rule packs judge configurations, so they were not applied to the launch trees"
        help_text = "write one with `mars-asp import ros2 FILE -o robot.mars`, and check that"
        span = whole_file(project.configuration.path)
        yield Diagnostic("launch", "note", message, span, help=help_text, kind="launch")


def add_file(parser: argparse.ArgumentParser) -> None:
    """Add the argument of the files of a robot."""
    parser.add_argument("files", metavar="FILE", nargs="+")
    add_launch(parser)


def add_launch(parser: argparse.ArgumentParser, default: str = "each launch file") -> None:
    """Add the choice among the launch trees of a folder, with `default` in the help."""
    parser.add_argument(
        "--launch",
        metavar="LAUNCHFILE",
        action="append",
        default=[],
        help="of a folder, the robot that this launch file starts; repeatable"
        f" (default: {default} that no other includes)",
    )
