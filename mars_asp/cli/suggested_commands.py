"""Commands that people are shown, to ask about the same robot again."""

import argparse
import shlex

from mars_asp.output import visible


def command(verb: str, arguments: argparse.Namespace, *words: str) -> str:
    """Return the command of a verb on the files that were read, as a shell takes it.

    `words` come after the files, then what was given to read the robot by.
    """
    return visible(shlex.join(["mars-asp", verb, *arguments.files, *words, *_readings(arguments)]))


def command_on_one(verb: str, arguments: argparse.Namespace, *words: str) -> str | None:
    """Return the command of a verb that takes its words before its file; `None` for several."""
    if len(arguments.files) > 1:
        return None
    lines = ["mars-asp", verb, *words, *arguments.files, *_readings(arguments)]
    return visible(shlex.join(lines))


def _readings(arguments: argparse.Namespace) -> list[str]:
    """Return the options that say what a robot is read by: its sources, packs and format."""
    given = (("--sources", arguments.sources), ("--rules", arguments.rules))
    words = [word for option, values in given for value in values for word in (option, value)]
    return [*words, "--from", arguments.from_format] if arguments.from_format else words
