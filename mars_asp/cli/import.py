"""Read a robot from another format and print it as a configuration."""

import argparse
from pathlib import Path

from mars_asp.cli.deliver import write_file
from mars_asp.cli.lines import remember
from mars_asp.cli.reason import STANDARD_INPUT
from mars_asp.cli.report import report
from mars_asp.cli.worker import read_standard_input
from mars_asp.language import Parsed, print_configuration
from mars_asp.language.parse import MOST_BYTES, decode, plain_lines, read_bytes


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the verb."""
    parser.add_argument(
        "origin", metavar="FORMAT", choices=("urdf", "twist_mux"), help="`urdf` or `twist_mux`"
    )
    parser.add_argument("file", metavar="FILE", help="what to read, `-` for standard input")
    parser.add_argument("-o", "--output", metavar="OUT", default="-", help="where to write it")
    parser.add_argument(
        "--contract",
        action="store_true",
        help="print the configuration that each mux realises, not the mux as a node",
    )


def run(arguments: argparse.Namespace) -> int:
    """Print the configuration."""
    found, printed = (_urdf if arguments.origin == "urdf" else _twist_mux)(arguments)
    report(found.warnings, arguments)
    if arguments.output == "-":
        print(printed, end="")
    else:
        write_file(arguments.output, printed)
    return 0


def _urdf(arguments: argparse.Namespace) -> tuple[Parsed, str]:
    """Return what a URDF document says, and how that is printed.

    Raises:
        MarsError: what is wrong with the document.
    """
    from mars_asp.exchange.urdf import MOST_BYTES as MOST_OF_URDF
    from mars_asp.exchange.urdf import import_urdf

    found = import_urdf(*_text(arguments.file, MOST_OF_URDF))
    return found, print_configuration(found.configuration)


def _twist_mux(arguments: argparse.Namespace) -> tuple[Parsed, str]:
    """Return what the parameters of a mux say, and how that is printed.

    Raises:
        MarsError: what is wrong with the file.
    """
    from mars_asp.exchange.lift import lifted, with_origins
    from mars_asp.exchange.twist_mux import import_twist_mux

    text, shown = _text(arguments.file)
    text = plain_lines(text)
    remember(shown, text)
    found = import_twist_mux(text, shown)
    shape = found.configuration if arguments.contract else lifted(found.configuration)
    return found, with_origins(shape)


def _text(name: str, most: int = MOST_BYTES) -> tuple[str, str]:
    """Return the text of a file or of standard input, and how the file is shown.

    Raises:
        MarsError: it is too large, or no text.
    """
    piped = name == STANDARD_INPUT
    shown = "<stdin>" if piped else name
    raw = read_standard_input(most + 1) if piped else read_bytes(Path(shown), most)
    return decode(raw, shown, most), shown
