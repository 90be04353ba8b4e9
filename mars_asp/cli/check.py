"""Parse, extract and analyse; print what warns or stops, and nothing else."""

import argparse

from mars_asp.cli.reason import add_file, analyse_project, read_project, rulebook_for
from mars_asp.cli.report import report
from mars_asp.reasoning.analysis import findings


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the verb."""
    add_file(parser)


def run(arguments: argparse.Namespace) -> int:
    """Report the findings; 1 where one is an error."""
    project = read_project(arguments)
    analysis = analyse_project(project, rulebook_for(arguments), arguments)
    report(findings(analysis), arguments)
    return int(analysis.has_errors)
