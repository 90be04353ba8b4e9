"""Read a robot from another format and print it as a configuration."""

import argparse
from pathlib import Path

from mars_asp.cli.deliver import write_file
from mars_asp.cli.reason import STANDARD_INPUT
from mars_asp.cli.report import report
from mars_asp.cli.worker import read_standard_input
from mars_asp.language import print_configuration
from mars_asp.language.parse import decode, read_bytes


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the verb."""
    parser.add_argument("origin", metavar="FORMAT", choices=("urdf",), help="`urdf`")
    parser.add_argument("file", metavar="FILE", help="what to read, `-` for standard input")
    parser.add_argument("-o", "--output", metavar="OUT", default="-", help="where to write it")


def run(arguments: argparse.Namespace) -> int:
    """Print the configuration."""
    from mars_asp.exchange.urdf import MOST_BYTES, import_urdf

    piped = arguments.file == STANDARD_INPUT
    shown = "<stdin>" if piped else arguments.file
    most = MOST_BYTES
    raw = read_standard_input(most + 1) if piped else read_bytes(Path(shown), most)
    found = import_urdf(decode(raw, shown, most), shown)
    report(found.warnings, arguments)
    printed = print_configuration(found.configuration)
    if arguments.output == "-":
        print(printed, end="")
    else:
        write_file(arguments.output, printed)
    return 0
