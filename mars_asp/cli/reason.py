"""What the verbs that reason have in common: read, load the rules, analyse."""

import argparse
from collections.abc import Collection
from pathlib import Path

from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.cli.lines import remember
from mars_asp.cli.progress import stage
from mars_asp.cli.report import report
from mars_asp.cli.worker import read_standard_input
from mars_asp.diagnostic import Diagnostic, MarsError, point
from mars_asp.exchange.recognise import recognised
from mars_asp.language import Parsed, parse_text
from mars_asp.language.parse import MOST_BYTES, decode, plain_lines, read_text
from mars_asp.output import visible
from mars_asp.reasoning.analysis import Analysis, analyse
from mars_asp.reasoning.project import Project, described, project_facts
from mars_asp.reasoning.rules import load_rulebook

STANDARD_INPUT = "-"
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


def read_configuration(arguments: argparse.Namespace, path: str) -> Parsed:
    """Read a robot's file without its sources, one that is not ours as the specification it is.

    Raises:
        MarsError: what is wrong with the file.
    """
    with stage(arguments, f"reading {visible(path)}"):
        text = None
        if path == STANDARD_INPUT:
            path = SHOWN_INPUT
            text = read_input(path)
        parsed, _, foreign = _parse(arguments, path, text)
    if foreign is None:
        return parsed
    from mars_asp.exchange.lift import lifted

    return parsed._replace(configuration=lifted(parsed.configuration))


def read_project(arguments: argparse.Namespace, path: str | None = None) -> Project:
    """Read the project of a verb's FILE; report what is noteworthy about it.

    Raises:
        MarsError: what is wrong with its files.
    """
    path = arguments.file if path is None else path
    text = None
    if path == STANDARD_INPUT:
        path = SHOWN_INPUT
        text = read_input(path)
    project = load(arguments, path, text)
    report(project.diagnostics, arguments)
    return project


def _parse(
    arguments: argparse.Namespace, path: str, text: str | None
) -> tuple[Parsed, str, str | None]:
    """Return what a file says, its text, and the format that it is in where it is not ours.

    Raises:
        MarsError: what is wrong with the file.
    """
    text = read_text(Path(path)) if text is None else plain_lines(text)
    # What is wrong with a file is shown in its own lines.
    remember(path, text)
    found = arguments.from_format or recognised(text)
    if found == "mars":
        return parse_text(text, path), text, None
    from mars_asp.exchange.twist_mux import import_twist_mux

    return import_twist_mux(text, path), text, found


def load(arguments: argparse.Namespace, path: str, text: str | None = None) -> Project:
    """Read a project, whose file's content `text` replaces.

    Raises:
        MarsError: what is wrong with its files.
    """
    with stage(arguments, f"reading {visible(path)}"):
        parsed, text, foreign = _parse(arguments, path, text)
        return described(parsed, text, arguments.sources, foreign)


def rulebook_for(arguments: argparse.Namespace, stages: Collection[str] = ("resolve",)) -> Rulebook:
    """Load the built-in rules and those of `--rules`.

    Raises:
        MarsError: what is wrong with rule files.
    """
    return load_rulebook([Path(path) for path in arguments.rules], stages)


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


def add_file(parser: argparse.ArgumentParser) -> None:
    """Add the FILE argument."""
    parser.add_argument(
        "file", metavar="FILE", help="a `.mars` file, or one of a mux; `-` for standard input"
    )
