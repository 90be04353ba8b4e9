"""Write the mount tree of a configuration in another format."""

import argparse

from mars_asp.cli.arguments import add_output
from mars_asp.cli.deliver import write_result
from mars_asp.cli.diagnostic_text import report
from mars_asp.cli.inputs import add_file, read_project


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("to", metavar="FORMAT", choices=("urdf",))
    add_file(parser)
    add_output(parser)


def run(arguments: argparse.Namespace) -> int:
    """Print the mount tree in the requested format."""
    project = read_project(arguments)
    from mars_asp.exchange.urdf import export_urdf, left_out

    exported = export_urdf(project.configuration, project.modules)
    report(left_out(project.configuration, project.modules), arguments)
    write_result(arguments.output, exported)
    return 0
