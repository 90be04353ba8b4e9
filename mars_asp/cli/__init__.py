"""The command line: one file for each command, imported when it is called.

A command's file has `configure(parser)`, which adds its arguments, and `run(arguments)`, which
returns the exit status and raises `MarsError` for wrong input.
"""

import os
import sys
import time
from collections.abc import Sequence
from typing import TextIO

from mars_asp import __version__
from mars_asp.cli.arguments import USAGE, help_text, ordered, parser_of

DONE, CLOSED_PIPE = 0, 141


def run_command(words: Sequence[str]) -> int:
    """Run one command line; return its exit status, never a traceback for a user's mistake."""
    try:
        try:
            status = _run(words)
        except SystemExit as exit_:  # argparse printed help or an error
            status = int(exit_.code or 0)
        sys.stdout.flush()
        sys.stderr.flush()
    except BrokenPipeError:
        _discard(sys.stdout)
        return CLOSED_PIPE
    except OSError as error:
        _discard(sys.stdout)
        try:
            print(f"mars-asp: error: standard output: {error.strerror or error}", file=sys.stderr)
        except OSError:  # it is standard error that is full
            _discard(sys.stderr)
        return USAGE
    return status


def _discard(stream: TextIO) -> None:
    """Redirect a stream to the null device, as its unwritten buffer would fail again at exit."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


def run_here(words: Sequence[str]) -> int:
    """Run one command line in this process, without the child that contains limits."""
    return _run(words, contained=False)


def _without_double_dash(words: Sequence[str]) -> list[str]:
    """Return the words without the first `--`; later words with a dash begin with `./`."""
    if "--" not in words:
        return list(words)
    at = words.index("--")
    paths = (
        f"./{each}" if each.startswith("-") and each != "-" else each for each in words[at + 1 :]
    )
    return [*words[:at], *paths]


def _run(words: Sequence[str], contained: bool = True) -> int:
    # A time limit includes the imports.
    started = time.monotonic()
    word, *further = ordered(words)
    if word == "--version":
        print(f"mars-asp {__version__}")
        return DONE
    if word == "--help":
        print(help_text(), end="")
        return DONE
    module, parser = parser_of(word)
    from mars_asp.cli.limits import run_plain
    from mars_asp.cli.worker import run_contained

    arguments = parser.parse_intermixed_args(_without_double_dash(further))
    arguments.started = started
    contained = contained and getattr(module, "IS_CONTAINED", True)
    return (run_contained if contained else run_plain)(module.run, arguments)
