"""Lay out `.mars` files in one canonical way, comments kept."""

import argparse
import sys
from pathlib import Path

from mars_asp.cli.deliver import write_file
from mars_asp.cli.encode import encoded
from mars_asp.cli.reason import STANDARD_INPUT
from mars_asp.cli.report import report_error
from mars_asp.cli.worker import read_standard_input
from mars_asp.diagnostic import Diagnostic, MarsError, point
from mars_asp.exchange.recognise import recognised
from mars_asp.language.format import format_text
from mars_asp.language.parse import decode, read_bytes
from mars_asp.output import visible


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the verb."""
    parser.add_argument(
        "files", metavar="FILE", nargs="+", help="a `.mars` file; `-` is standard input, to output"
    )
    parser.add_argument(
        "--check", action="store_true", help="write nothing; list the files that would change"
    )
    parser.epilog = (
        "A file with syntax errors is left alone, and the others are laid out all the same. "
        "Files are written whole or not at all, as UTF-8 with line feeds."
    )


def run(arguments: argparse.Namespace) -> int:
    """Lay out each file; 1 where `--check` finds one to change, 2 where one has errors."""
    if STANDARD_INPUT in arguments.files and len(arguments.files) > 1:
        print(
            "mars-asp fmt: `-` must be the only file, because its text goes to standard output",
            file=sys.stderr,
        )
        return 2
    status = 0
    listed: list[dict[str, object]] = []
    for name in arguments.files:
        try:
            changed, text = _format(name, arguments.check)
        except MarsError as error:
            report_error(error, arguments)
            status = 2
            continue
        except OSError as error:
            print(visible(f"mars-asp: `{name}`: {error.strerror or error}"), file=sys.stderr)
            status = 2
            continue
        if changed and arguments.check:
            status = max(status, 1)
        if arguments.format == "json":
            piped = {"text": text} if name == STANDARD_INPUT else {}
            listed.append({"path": name, "changed": changed, **piped})
        elif name == STANDARD_INPUT and not arguments.check:
            sys.stdout.buffer.write(text.encode())
        elif changed:
            print(visible(name if arguments.check else f"formatted {name}"))
    if arguments.format == "json":
        print(encoded({"files": listed}))
    return status


def _format(name: str, check: bool) -> tuple[bool, str]:
    """Return whether a file's bytes change, and its text; write it where that is wanted."""
    piped = name == STANDARD_INPUT
    raw = read_standard_input() if piped else read_bytes(Path(name))
    shown = "<stdin>" if piped else name
    before = decode(raw, shown)
    if recognised(before) != "mars":
        message = (
            f"`{shown}` is a file of {recognised(before)}, and `.mars` files alone are laid out"
        )
        help_text = f"`mars-asp import {recognised(before)} FILE` prints it as a `.mars` file"
        place = point(shown, 1, 1)
        raise MarsError((Diagnostic("usage", "error", message, place, help=help_text),))
    text = format_text(before, shown)
    changed = text.encode() != raw
    if changed and not piped and not check:
        write_file(name, text, raw)
    return changed, text
