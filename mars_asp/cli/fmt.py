"""Lay out `.mars` files in one canonical way, comments kept."""

import argparse
import difflib
import sys
from pathlib import Path

from mars_asp.cli.arguments import add_flags, misuse
from mars_asp.cli.deliver import replace_files
from mars_asp.cli.diagnostic_text import report_error
from mars_asp.cli.encode import encoded
from mars_asp.cli.excluded import add_exclusion
from mars_asp.cli.inputs import (
    STANDARD_INPUT,
    add_stdin_filename,
    is_other_file,
    is_passed_over,
    robots_in_folder,
    shown_input,
)
from mars_asp.cli.settings import check_settings
from mars_asp.cli.worker import read_standard_input
from mars_asp.diagnostic import MarsError, refusal
from mars_asp.exchange.recognise import recognised
from mars_asp.language.format import format_text
from mars_asp.language.parse import decode, read_bytes
from mars_asp.output import visible

_NO_END = "\\ No newline at end of file"


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("files", metavar="PATH", nargs="*", default=["."])
    add_stdin_filename(parser)
    add_exclusion(parser)
    add_flags(parser, "--check", "--diff")


def run(arguments: argparse.Namespace) -> int:
    """Format files; return 1 if `--check` or `--diff` shows a change, 2 if a file has errors."""
    if STANDARD_INPUT in arguments.files and len(arguments.files) > 1:
        problem = "`-` must be the only file, because its text goes to standard output"
        return misuse("fmt", problem)
    if arguments.stdin_filename and STANDARD_INPUT not in arguments.files:
        return misuse("fmt", "--stdin-filename names the text of `-`: add `-`")
    check_settings(arguments)
    status = 0
    listed: list[dict[str, object]] = []
    names: list[str] = []
    for path in arguments.files:
        try:
            names += _files_of(path, arguments)
        except MarsError as error:
            report_error(error, arguments)
            status = 2
    is_piped = STANDARD_INPUT in arguments.files and arguments.format != "json"
    if is_piped and not (names or arguments.check or arguments.diff):
        sys.stdout.buffer.write(read_standard_input())
    for name in names:
        shown = shown_input(arguments) if name == STANDARD_INPUT else name
        try:
            is_written = not (arguments.check or arguments.diff)
            changed, before, text = _format(name, shown, is_written=is_written)
        except MarsError as error:
            report_error(error, arguments)
            status = 2
            continue
        except OSError as error:
            print(visible(f"mars-asp: error: `{name}`: {error.strerror or error}"), file=sys.stderr)
            status = 2
            continue
        if changed and (arguments.check or arguments.diff):
            status = max(status, 1)
        if arguments.format == "json":
            piped = {"text": text} if name == STANDARD_INPUT else {}
            listed.append({"path": name, "changed": changed, **piped})
        elif arguments.diff:
            print(unified_diff(shown, before, text), end="")
        elif name == STANDARD_INPUT and not arguments.check:
            sys.stdout.buffer.write(text.encode())
        elif changed and (arguments.check or not arguments.quiet):
            print(visible(shown if arguments.check else f"formatted {name}"))
    if arguments.format == "json":
        print(encoded({"files": listed}))
    return status


def _files_of(path: str, arguments: argparse.Namespace) -> list[str]:
    """Return the `.mars` files of a folder, or a named file itself.

    Raises:
        MarsError: the folder has none, or its settings are wrong.
    """
    if not Path(path).is_dir():
        return [] if is_passed_over(arguments, path) else [path]
    found = [
        str(each) for each in robots_in_folder(arguments, path).paths if each.suffix == ".mars"
    ]
    if not found:
        raise refusal("usage", "the folder has no `.mars` file", path)
    return found


def unified_diff(name: str, before: str, after: str) -> str:
    """Return a unified diff of two texts of a file."""
    lines = difflib.unified_diff(
        before.splitlines(keepends=True), after.splitlines(keepends=True), name, name
    )
    ended = (each if each.endswith("\n") else f"{each}\n{_NO_END}\n" for each in lines)
    return "".join(ended)


def _format(name: str, shown: str, is_written: bool) -> tuple[bool, str, str]:
    """Return whether a file's bytes change, its text and the new text; write if `is_written`."""
    piped = name == STANDARD_INPUT
    raw = read_standard_input() if piped else read_bytes(Path(name))
    before = decode(raw, shown)
    if recognised(before) != "mars":
        message = (
            f"`{shown}` is a file of {recognised(before)}, and `fmt` formats `.mars` files alone"
        )
        help_text = f"`mars-asp import {recognised(before)} FILE` prints it as a `.mars` file"
        raise refusal("usage", message, shown, help_text)
    if is_other_file(shown, before):
        raise refusal("usage", f"`{shown}` is not a `.mars` file", shown)
    text = format_text(before, shown)
    changed = text.encode() != raw
    if changed and not piped and is_written:
        replace_files([(name, text.encode(), raw)])
    return changed, before, text
