"""Commands that messages suggest for further questions about the same robot."""

import argparse
import shlex

from mars_asp.output import visible
from mars_asp.reading import SHOWN_INPUT


def command(verb: str, arguments: argparse.Namespace, *words: str) -> str:
    """Return a command line about the files that were read, quoted for a shell.

    `words` follow the files; the options for reading the robot follow the words.
    """
    return visible(shlex.join(["mars-asp", verb, *arguments.files, *words, *_readings(arguments)]))


def command_on_one(verb: str, arguments: argparse.Namespace, *words: str) -> str | None:
    """Return a command line whose words precede its only file; None for several files.

    None as well for chosen launch files, as not every command can choose them.
    """
    if len(arguments.files) > 1 or _chosen(arguments):
        return None
    lines = ["mars-asp", verb, *words, *arguments.files, *_readings(arguments)]
    return visible(shlex.join(lines))


def command_on(path: str, verb: str, arguments: argparse.Namespace, *words: str) -> str:
    """Return a command line about one file, where `-` is standard input."""
    name = "-" if path == SHOWN_INPUT else path
    return command(verb, argparse.Namespace(**vars(arguments) | {"files": [name]}), *words)


def _readings(arguments: argparse.Namespace) -> list[str]:
    """Return the options for reading the robot: launch files, sources, packs, format, settings."""
    given = (
        ("--launch", _chosen(arguments)),
        ("--sources", arguments.sources),
        ("--rules", arguments.rules),
        ("--from", [arguments.from_format] if arguments.from_format else []),
        ("--config", [arguments.config] if arguments.config else []),
    )
    words = [word for option, values in given for value in values for word in (option, value)]
    return [*words, "--isolated"] if arguments.isolated else words


def _chosen(arguments: argparse.Namespace) -> list[str]:
    """Return the chosen launch files; not every command can choose some."""
    return list(arguments.launch) if "launch" in arguments else []
