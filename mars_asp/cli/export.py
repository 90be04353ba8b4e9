"""Write the mount tree of a configuration in another format."""

import argparse

from mars_asp.cli.deliver import write_file
from mars_asp.cli.inputs import add_file, read_project


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("to", metavar="FORMAT", choices=("urdf",), help="`urdf`")
    add_file(parser)
    parser.add_argument("-o", "--output", metavar="OUT", default="-", help="where to write it")


def run(arguments: argparse.Namespace) -> int:
    """Print the mount tree."""
    project = read_project(arguments)
    from mars_asp.exchange.urdf import export_urdf

    written = export_urdf(project.configuration, project.modules)
    if arguments.output == "-":
        print(written, end="")
    else:
        write_file(arguments.output, written)
    return 0
