"""What the verbs that reason have in common: read, load the rules, analyse."""

import argparse
import sys
from collections.abc import Collection, Iterator, Sequence
from dataclasses import replace
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.cli.lines import remember
from mars_asp.cli.progress import stage
from mars_asp.cli.report import report
from mars_asp.cli.settings import settings_for
from mars_asp.cli.worker import read_standard_input
from mars_asp.diagnostic import Diagnostic, MarsError, point
from mars_asp.exchange.foreign import File, read_foreign
from mars_asp.exchange.recognise import recognised
from mars_asp.language import Parsed, parse_text
from mars_asp.language.parse import MOST_BYTES, decode, plain_lines, read_text
from mars_asp.model.declarations import PackKind
from mars_asp.output import visible
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

if TYPE_CHECKING:
    from mars_asp.exchange.dataflows import Dataflows

STANDARD_INPUT = "-"
#: The stages of rules that judge a robot.
JUDGING = ("resolve", "launch")
#: Where verbs keep what they read first.
_FILES = ("files", "file", "old", "specification")
#: What standard input is called in places.
SHOWN_INPUT = "<stdin>"


def read_input(shown: str) -> str:
    """Return the text of standard input, which `shown` stands for in places.

    Raises:
        MarsError: it is too large, or no text.
    """
    return decode(read_standard_input(MOST_BYTES + 1), shown)


def check_inputs(*paths: str) -> None:
    """Check that standard input is read for one file alone.

    Raises:
        MarsError: it is asked for twice.
    """
    if paths.count(STANDARD_INPUT) > 1:
        message = "standard input was read for another file already"
        place = point(STANDARD_INPUT, 1, 1)
        help_text = "give all files but one by their names"
        raise MarsError((Diagnostic("usage", "error", message, place, help=help_text),))


def read_specification(arguments: argparse.Namespace, path: str) -> Project:
    """Read a specification with its own sources, a foreign file as the specification it is.

    A source that is missing is a warning: the configuration may describe the modules.

    Raises:
        MarsError: what is wrong with its files.
    """
    with stage(arguments, f"reading {visible(path)}"):
        text = None
        if path == STANDARD_INPUT:
            path = SHOWN_INPUT
            text = read_input(path)
        parsed, text, foreign = _parse(arguments, path, text)
        parsed = _with_kinds(parsed, arguments)
        if foreign is None:
            return described(parsed, text, optional=True)
    from mars_asp.exchange.lift import lifted

    return Project(lifted(parsed.configuration), {}, parsed.warnings, text)


def read_project(
    arguments: argparse.Namespace, path: str | None = None, *, quietly: bool = False
) -> Project:
    """Read the project of a verb's FILE, or of all of them, and report the messages on that.

    Args:
        arguments: The words of the command.
        path: The file, if not those of the command.
        quietly: Whether the verb reports the messages itself, as far as they are selected. Other
            verbs take all launch trees for one robot, which is a message.

    Raises:
        MarsError: what is wrong with its files.
    """
    path, *further = arguments.files if path is None else (path,)
    check_inputs(path, *further)
    text = None
    if path == STANDARD_INPUT:
        path = SHOWN_INPUT
        text = read_input(path)
    project = load(arguments, path, text, further)
    if project.trees:
        apart = chain.from_iterable(map(_unread_dataflows, (path, *further)))
        project = replace(project, diagnostics=(*project.diagnostics, *apart))
    if not quietly:
        report((*project.diagnostics, *one_of_several(project)), arguments)
    return project


def _unread_dataflows(path: str) -> Iterator[Diagnostic]:
    """Yield the note that a folder was taken for a workspace of ROS alone, if it has dataflows."""
    dataflows = _dataflows(path)
    if dataflows is not None and dataflows.files:
        first, *others = map(str, dataflows.files)
        number = "1 dataflow" if not others else f"{1 + len(others)} dataflows"
        message = f"{number} beside the packages of ROS not read"
        help_text = f"name one, such as `{first}`; `mars-asp check {path}` judges all"
        yield Diagnostic(
            "dora", "note", message, point(first, 1, 1), (), help_text, kind="not_read"
        )


def one_of_several(project: Project) -> Iterator[Diagnostic]:
    """Yield the note that several launch trees were taken for one robot, if they were."""
    if len(project.trees) > 1:
        number = len(project.trees)
        message = f"the nodes of {number} launch files were taken for one robot"
        help_text = "`--launch LAUNCHFILE` takes one of them; `check -v` lists them"
        span = project.configuration.span
        yield Diagnostic("launch", "note", message, span, help=help_text, excerpt="", kind="launch")


def _with_kinds(parsed: Parsed, arguments: argparse.Namespace) -> Parsed:
    """Return what was parsed, with the kinds of nodes that packs bring.

    Raises:
        MarsError: it names nodes of packs that are not given.
    """
    brought = _brought(arguments, bool(parsed.configuration.pack_nodes))
    kinds = tuple(each for each in brought if isinstance(each, PackKind))
    return parsed._replace(configuration=with_kinds(parsed.configuration, kinds))


def _brought(arguments: argparse.Namespace, is_asked: bool) -> tuple[object, ...]:
    """Return what packs bring besides rules: kinds of nodes, and attributes where it `is_asked`.

    Otherwise no rules are read here, and the faults of packs come later.

    Raises:
        MarsError: what is wrong with packs, where it is asked.
    """
    packs = packs_of(arguments)
    return brought_by(packs) if is_asked else kinds_of(find_packs(packs, []))


def _parse(
    arguments: argparse.Namespace, path: str, text: str | None, further: Sequence[str] = ()
) -> tuple[Parsed, str, str | None]:
    """Return what a file says, its text, and the format that it is in where it is not ours.

    `further` are files of others that say more of the same robot.

    Raises:
        MarsError: what is wrong with the file.
    """
    files = [_read(arguments, path, text), *(_read(arguments, each) for each in further)]
    first = files[0]
    ours = [file for file in files if file.format == "mars"]
    if not ours:
        found = read_foreign(files, getattr(arguments, "launch", ()))
        return found, first.text, found.configuration.origin
    if further:
        message = f"`{ours[0].path}` is a robot of its own, and so is each `.mars` file"
        help_text = "give it alone, or several to `mars-asp check`; only files of others are one"
        place = point(ours[0].path, 1, 1)
        raise MarsError((Diagnostic("usage", "error", message, place, help=help_text),))
    return parse_text(first.text, path), first.text, None


def _read(arguments: argparse.Namespace, path: str, text: str | None = None) -> File:
    """Read a file, if that was not done, and see which format it is in.

    Raises:
        MarsError: it cannot be read.
    """
    if text is None and path == STANDARD_INPUT:
        path = SHOWN_INPUT
        text = read_input(path)
    if text is None and Path(path).is_dir():
        dataflow = _only_dataflow(path)
        if dataflow is None:
            return File(path, "", "ros2")
        path = dataflow
    if text is None:
        # What comes through a pipe comes once.
        streamed: dict[str, str] = vars(arguments).setdefault("streamed", {})
        text = streamed.get(path) or read_text(Path(path))
        if not Path(path).is_file():
            streamed[path] = text
    else:
        text = plain_lines(text)
    # What is wrong with a file is shown in its own lines.
    remember(path, text)
    return File(path, text, arguments.from_format or recognised(text))


def _only_dataflow(path: str) -> str | None:
    """Return the dataflow of dora in a folder; None where there is none, or a workspace of ROS.

    Raises:
        MarsError: there are several.
    """
    dataflows = _dataflows(path)
    if dataflows is None or not dataflows.files or dataflows.is_ros:
        return None
    first, *others = map(str, dataflows.files)
    if others:
        number = len(dataflows.files)
        message = f"the folder has {number} dataflows, and each is a robot of its own"
        named = ", ".join(f"`{each}`" for each in (first, *others[:2]))
        help_text = f"name one of them: {named}{', ...' if number > 3 else ''}"
        raise MarsError((Diagnostic("dora", "error", message, point(path, 1, 1), (), help_text),))
    return first


class RobotFiles(NamedTuple):
    """The files of a robot; `is_found` is whether they were found in a folder.

    `notes` are about that folder.
    """

    paths: list[str]
    is_found: bool = False
    notes: tuple[Diagnostic, ...] = ()


def robots(arguments: argparse.Namespace, paths: Sequence[str]) -> list[RobotFiles]:
    """Return the files of each robot: those of others are one, at the place of the first.

    Each dataflow of dora in a folder is a robot of its own, and so is a workspace of ROS beside it.
    """
    found: list[RobotFiles] = []
    foreign: list[str] = []
    for path in paths:
        dataflows = _dataflows(path)
        if dataflows is not None and dataflows.files and not getattr(arguments, "launch", ()):
            found += (RobotFiles([str(each)], is_found=True) for each in dataflows.files)
            found[-1] = found[-1]._replace(notes=dataflows.notes)
            if dataflows.is_ros:
                found.append(RobotFiles([path]))
            continue
        if len(paths) == 1 or path == STANDARD_INPUT or not _is_foreign(arguments, path):
            found.append(RobotFiles([path]))
        else:
            if not foreign:
                found.append(RobotFiles(foreign))
            foreign.append(path)
    return found


def _dataflows(path: str) -> "Dataflows | None":
    """Return the dataflows of dora in a folder; None if the path is not a folder."""
    if not Path(path).is_dir():
        return None
    from mars_asp.exchange.dataflows import dataflows_in

    return dataflows_in(Path(path))


def _is_foreign(arguments: argparse.Namespace, path: str) -> bool:
    """Whether a file, folder or pipe can be read and is not ours."""
    if not Path(path).exists():
        return False
    try:
        return _read(arguments, path).format != "mars"
    except MarsError:
        return False


def load(
    arguments: argparse.Namespace, path: str, text: str | None = None, further: Sequence[str] = ()
) -> Project:
    """Read a project, whose file's content `text` replaces; `further` say more of it.

    Raises:
        MarsError: what is wrong with its files.
    """
    with stage(arguments, f"reading {visible(path)}"):
        parsed, text, foreign = _parse(arguments, path, text, further)
        project = described(parsed, text, arguments.sources, foreign)
        is_asked = has_attributes(project) or bool(project.configuration.pack_nodes)
        project = with_brought(project, _brought(arguments, is_asked))
    if getattr(arguments, "verbose", False):
        for tree in project.trees:
            print(visible(f"mars-asp: launch file {tree.path}"), file=sys.stderr)
    return project


def rulebook_for(arguments: argparse.Namespace, stages: Collection[str] = ("resolve",)) -> Rulebook:
    """Load the built-in rules, and the packs of `--rules` and of the settings.

    Raises:
        MarsError: what is wrong with rule files.
    """
    return load_rulebook(packs_of(arguments), stages, trusted=arguments.trust)


def packs_of(arguments: argparse.Namespace) -> list[Path]:
    """Return the packs that the settings of the first file name, and then those of `--rules`.

    Raises:
        MarsError: what is wrong with the settings.
    """
    named = (getattr(arguments, each, None) for each in _FILES)
    first = next((each for each in named if each), ".")
    path = Path(first if isinstance(first, str) else first[0])
    folder = path if path.is_dir() else path.parent
    settings = settings_for(folder)
    for number, each in enumerate(settings.rules):
        settings.check_named(each, "rules", number)
    return [Path(each) for each in (*settings.rules, *arguments.rules)]


def analyse_project(
    project: Project, rulebook: Rulebook, arguments: argparse.Namespace
) -> Analysis:
    """Return the consequences of a project.

    Raises:
        MarsError: rules that clingo refuses.
    """
    with stage(arguments, "analysing"):
        facts = project_facts(project)
        return analyse(facts, rulebook, project.configuration.span, with_labels=True)


def judge_project(project: Project, rulebook: Rulebook, arguments: argparse.Namespace) -> Analysis:
    """Return the findings in a project: in its launch trees, or else its consequences.

    Raises:
        MarsError: rules that clingo refuses.
    """
    if not project.trees:
        return analyse_project(project, rulebook, arguments)
    with stage(arguments, "analysing"):
        return analyse_trees(project, rulebook)


def unapplied_packs(project: Project, rulebook: Rulebook) -> Iterator[Diagnostic]:
    """Yield the note that rule packs do not judge the launch trees of a project, if it has some."""
    if project.trees and rulebook.packs:
        message = "rule packs judge configurations, so they were not applied to the launch trees"
        help_text = "write one with `mars-asp import ros2 FILE -o robot.mars`, and check that"
        span = project.configuration.span
        yield Diagnostic("launch", "note", message, span, help=help_text, excerpt="", kind="launch")


def add_file(parser: argparse.ArgumentParser) -> None:
    """Add the argument of the files of a robot."""
    parser.add_argument(
        "files",
        metavar="FILE",
        nargs="+",
        help="a `.mars` file, or files of others that are one robot: URDF, muxes, graphs, "
        "dataflows; `-` for standard input",
    )
    add_launch(parser)


def add_launch(parser: argparse.ArgumentParser) -> None:
    """Add the choice among the launch trees of a folder."""
    parser.add_argument(
        "--launch",
        metavar="LAUNCHFILE",
        action="append",
        default=[],
        help="of a folder, the robot that this launch file starts; repeatable"
        " (default: each launch file that no other includes)",
    )
