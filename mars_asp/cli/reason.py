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
from mars_asp.language import Parsed, parse_file, parse_text
from mars_asp.language.parse import MOST_BYTES, decode
from mars_asp.output import visible
from mars_asp.reasoning.analysis import Analysis, analyse
from mars_asp.reasoning.project import Project, load_project, project_facts
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
    """Read a `.mars` file without its sources.

    Raises:
        MarsError: what is wrong with the file.
    """
    with stage(arguments, f"reading {visible(path)}"):
        if path == STANDARD_INPUT:
            return parse_text(read_input(SHOWN_INPUT), SHOWN_INPUT)
        return parse_file(Path(path))


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


def load(arguments: argparse.Namespace, path: str, text: str | None = None) -> Project:
    """Read a project, whose file's content `text` replaces.

    Raises:
        MarsError: what is wrong with its files.
    """
    with stage(arguments, f"reading {visible(path)}"):
        project = load_project(path, arguments.sources, text)
    remember(path, project.text)
    return project


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
    parser.add_argument("file", metavar="FILE", help="a `.mars` file, `-` for standard input")
