"""Print the facts of a configuration, so that clingo itself can be run on them."""

import argparse

from mars_asp.cli.inputs import add_file, read_project
from mars_asp.reasoning.facts.compile import facts_text
from mars_asp.reasoning.project import project_facts

#: Facts are a program for clingo, whatever reads it.
RESULT_FORMATS = ("text",)


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    add_file(parser)


def run(arguments: argparse.Namespace) -> int:
    """Print one fact a line."""
    print(facts_text(project_facts(read_project(arguments))), end="")
    return 0
