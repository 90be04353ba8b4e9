"""The linter `ament_mars`: `mars-asp check` with the words of linters of ament."""

import sys
from collections.abc import Sequence

from mars_asp.__main__ import main
from mars_asp.cli.arguments import Parser


def run_ament(words: Sequence[str] | None = None) -> int:
    """Run a command line, that of the process by default; return the exit status."""
    parser = Parser(
        prog="ament_mars",
        usage="%(prog)s [-h] [--xunit-file FILE] [PATH...]",
        description="Check the robots in files and folders, by default in the current folder.",
        epilog="Options of `mars-asp check` are allowed as well.",
    )
    parser.add_argument("--xunit-file", metavar="FILE", help="write the result as JUnit XML there")
    arguments, further = parser.parse_known_args(sys.argv[1:] if words is None else words)
    return main(check_words(arguments.xunit_file, further))


def check_words(xunit_file: str | None, further: Sequence[str]) -> list[str]:
    """Return the words of `mars-asp check`; the result goes to `xunit_file` if one is named."""
    written = () if xunit_file is None else ("--format", "junit", "-o", xunit_file)
    return ["check", *written, *further]
