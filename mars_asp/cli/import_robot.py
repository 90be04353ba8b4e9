"""Read a robot from another format and print it as a configuration."""

import argparse
import os.path
import re
from collections.abc import Iterator, Sequence
from pathlib import Path

from mars_asp.cli.arguments import add_flags, add_output, misuse
from mars_asp.cli.deliver import write_result
from mars_asp.cli.diagnostic_text import report
from mars_asp.cli.inputs import STANDARD_INPUT, add_launch, check_inputs
from mars_asp.cli.lines import remember
from mars_asp.cli.suggested_commands import command
from mars_asp.cli.worker import read_standard_input
from mars_asp.diagnostic import NOT_EXPORTED, Diagnostic, MarsError, refusal, whole_file
from mars_asp.exchange.foreign import READERS, ForeignFile, read_foreign
from mars_asp.exchange.recognise import recognised
from mars_asp.language import Parsed, print_configuration
from mars_asp.language.parse import MOST_BYTES, decode, plain_lines, read_bytes, read_text
from mars_asp.model.declarations import Configuration
from mars_asp.model.graph import LaunchTree
from mars_asp.output import visible

_FORMATS = tuple(READERS)


class _FormatOrFile(tuple[str, ...]):
    """The formats, or any path: the content of most files shows their format."""

    def __contains__(self, word: object) -> bool:
        if super().__contains__(word) or word == STANDARD_INPUT:
            return True
        path = str(word)
        return re.search(r"[./]", path) is not None or os.path.exists(path)  # noqa: PTH110


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument(
        "origin",
        metavar="FORMAT",
        nargs="?",
        choices=_FormatOrFile(_FORMATS),
        help=f"{', '.join(f'`{each}`' for each in _FORMATS[:-1])} or `{_FORMATS[-1]}` "
        "(default: by the content of FILE); alone, the formats are listed",
    )
    parser.add_argument("files", metavar="FILE", nargs="*")
    add_launch(parser, default="the only launch file")
    add_output(parser)
    add_flags(parser, "--contract")


def run(arguments: argparse.Namespace) -> int:
    """Print the configuration; without a format, print the supported formats."""
    if arguments.origin is None:
        print("\n".join(_FORMATS))
        return 0
    is_named = arguments.origin in _FORMATS
    if not is_named:
        first = arguments.origin
        if arguments.files and arguments.files[-1] in _FORMATS:
            return misuse("import", "FORMAT comes before the files")
        if first == STANDARD_INPUT:
            return misuse("import", "name the format of standard input: mars-asp import FORMAT -")
        arguments.files.insert(0, first)
        is_folder = Path(first).is_dir()
        arguments.origin = "ros2" if is_folder else recognised(read_text(Path(first)))
        if arguments.origin == "mars":
            return _unknown(first)
    if not arguments.files:
        return misuse("import", f"name the files: mars-asp import {arguments.origin} FILE")
    check_inputs(*arguments.files)
    if arguments.origin == "urdf" and len(arguments.files) == 1:
        found, printed = _urdf(arguments)
    else:
        files = _files(arguments, is_named)
        unknown = next((each.path for each in files if each.format == "mars"), None)
        if unknown is not None:
            return _unknown(unknown)
        found = read_foreign(files, arguments.launch)
        printed = foreign_text(found.configuration, contract=arguments.contract)
    check_one_tree(found.trees, found.configuration)
    report((*found.warnings, *_left_out(found.trees, arguments)), arguments)
    write_result(arguments.output, printed)
    return 0


def _left_out(trees: Sequence[LaunchTree], arguments: argparse.Namespace) -> Iterator[Diagnostic]:
    """Yield the note that a configuration lacks what findings in launch files need."""
    if any(not tree.is_of_programs for tree in trees):
        message = "launch files have no place in a configuration"
        help_text = f"`{command('check', arguments)}` shows what is found in them"
        place = whole_file(arguments.files[0])
        yield Diagnostic(NOT_EXPORTED, "note", message, place, help=help_text, kind="not_exported")


def _urdf(arguments: argparse.Namespace) -> tuple[Parsed, str]:
    """Return a parsed URDF document, and its `.mars` text.

    Raises:
        MarsError: the document has errors.
    """
    from mars_asp.exchange.urdf import MOST_BYTES as MOST_OF_URDF
    from mars_asp.exchange.urdf import import_urdfs

    found = import_urdfs([_read_text(arguments.files[0], MOST_OF_URDF)])
    return found, print_configuration(found.configuration)


def _files(arguments: argparse.Namespace, is_named: bool) -> Sequence[ForeignFile]:
    """Return the files, in the format of the command if `is_named`, else in that of their content.

    Raises:
        MarsError: a file cannot be read.
    """
    files = []
    for name in arguments.files:
        if (arguments.origin == "ros2" or not is_named) and Path(name).is_dir():
            files.append(ForeignFile(name, "", "ros2"))
            continue
        text, shown = _read_text(name)
        text = plain_lines(text)
        remember(shown, text)
        files.append(ForeignFile(shown, text, arguments.origin if is_named else recognised(text)))
    return files


def _unknown(path: str) -> int:
    message = f"the format of `{visible(path)}` is not known by its content"
    return misuse("import", f"{message}: mars-asp import FORMAT FILE")


def foreign_text(configuration: Configuration, *, contract: bool = False) -> str:
    """Return the `.mars` text of foreign files; with `contract`, without muxes as nodes."""
    from mars_asp.exchange.lift import has_glue, lifted, with_origins

    shape = configuration if contract or not has_glue(configuration) else lifted(configuration)
    return with_origins(shape)


def check_one_tree(trees: Sequence[LaunchTree], configuration: Configuration) -> None:
    """Raise MarsError if several launch files of a folder start a robot; it lists them.

    Raises:
        MarsError: several launch files start a robot; the message lists them.
    """
    if len(trees) > 1:
        message = f"{len(trees)} launch files start a robot each, and one is imported"
        help_text = f"choose with --launch: {', '.join(f'`{tree.path}`' for tree in trees)}"
        span = configuration.span
        raise MarsError([Diagnostic("launch", "error", message, span, help=help_text, excerpt="")])


def _read_text(name: str, most: int = MOST_BYTES) -> tuple[str, str]:
    """Return the text of a file or of standard input, and the shown name of the file.

    Raises:
        MarsError: the input is too large, is not text, or is a `.mars` file.
    """
    piped = name == STANDARD_INPUT
    shown = "<stdin>" if piped else name
    raw = read_standard_input(most + 1) if piped else read_bytes(Path(shown), most)
    if Path(shown).suffix == ".mars":
        advice = "`mars-asp fmt` formats it, and other commands read it"
        raise refusal("format", f"`{shown}` is a `.mars` file already", shown, advice)
    return decode(raw, shown, most), shown
