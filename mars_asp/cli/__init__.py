"""The command line: one file for each verb, imported when it is called.

A verb's file has `configure(parser)`, which adds its arguments, and `run(arguments)`, which
returns the exit status and raises `MarsError` for what is wrong with the input.
"""

import argparse
import importlib
import os
import sys
import time
from collections.abc import Sequence
from typing import TYPE_CHECKING, NoReturn

from mars_asp import __version__
from mars_asp.spelling import nearest

if TYPE_CHECKING:
    from _typeshed import SupportsWrite

VERBS = {
    "check": "parse, extract and analyse; print diagnostics only",
    "extract": "the modules found in annotated sources",
    "analyse": "the consequences of a configuration",
    "synthesise": "the minimal specification that resolves them",
    "explain": "why each consequence and node is there, down to lines",
    "run": "execute a specification on the simulator and judge the run",
    "can": "is the robot able to do something, or several things at one time",
    "diff": "what changed between two configurations, and the lines that caused it",
    "verify": "does a specification realise a configuration, and is it minimal",
    "draw": "picture of a configuration or specification: svg, png, dot or mmd",
    "facts": "the facts, to run clingo itself on them with rules/*.lp",
    "import": "read a robot from `urdf`",
    "export": "write the mount tree as `urdf`",
    "fmt": "canonical layout of `.mars` files, comments kept",
    "rules": "list, show or check the rule base",
    "test": "run rule cases: facts and expected answer sets",
}
ALIASES = {"analyze": "analyse", "synthesize": "synthesise"}

DONE, USAGE, CLOSED_PIPE = 0, 2, 141


def run_command(words: Sequence[str]) -> int:
    """Run one command line; return its exit status, never a traceback for a user's mistake."""
    try:
        try:
            status = _run(words)
        except SystemExit as exit_:  # argparse printed help or what is wrong
            status = int(exit_.code or 0)
        sys.stdout.flush()
    except BrokenPipeError:
        _close_output()
        return CLOSED_PIPE
    except OSError as error:
        _close_output()
        print(f"mars-asp: standard output: {error.strerror or error}", file=sys.stderr)
        return USAGE
    return status


def _close_output() -> None:
    """Give what is left in the buffer a dead end, for it has nowhere to go."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def run_here(words: Sequence[str]) -> int:
    """Run one command line in this process, without the child that contains limits."""
    return _run(words, contained=False)


def _run(words: Sequence[str], contained: bool = True) -> int:
    # What is imported takes of the time that a limit allows, too.
    started = time.monotonic()
    if list(words[:1]) == ["--version"]:
        print(f"mars-asp {__version__}")
        return DONE
    word = words[0] if words else ""
    verb = ALIASES.get(word, word)
    if verb not in VERBS:
        return _no_verb(words)
    module = importlib.import_module(f"mars_asp.cli.{verb}")
    parser = _Parser(prog=f"mars-asp {word}", description=(module.__doc__ or "").partition("\n")[0])
    _common_options(parser, getattr(module, "FORMATS", ("text", "json")))
    module.configure(parser)
    from mars_asp.cli.limits import run_plain
    from mars_asp.cli.worker import run_contained

    arguments = parser.parse_intermixed_args(words[1:])
    arguments.started = started
    return (run_contained if contained else run_plain)(module.run, arguments)


def _no_verb(words: Sequence[str]) -> int:
    parser = _Parser(
        prog="mars-asp",
        description="Consequences, minimal specifications and the reasons for both.",
        epilog="verbs:\n" + "".join(f"  {verb:<12}{text}\n" for verb, text in VERBS.items()),
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--version", action="version", version=f"mars-asp {__version__}")
    parser.add_argument("verb", metavar="VERB", help="see below; `mars-asp VERB --help` for each")
    parser.add_argument("rest", nargs=argparse.REMAINDER, metavar="...", help=argparse.SUPPRESS)
    if words:
        verb = parser.parse_args(list(words)).verb
        near = nearest(verb, (*VERBS, *ALIASES))
        hint = f"did you mean `{near}`?" if near else f"one of {', '.join(VERBS)}"
        parser.error(f"there is no verb `{verb}`: {hint}")
    parser.print_help()
    return DONE


class _Parser(argparse.ArgumentParser):
    """Reports a wrong call in one line, with status 2 and where help is to be found."""

    def error(self, message: str) -> NoReturn:
        from mars_asp.output import visible

        self.exit(USAGE, f"{self.prog}: {visible(message)}; see `{self.prog} --help`\n")

    def _print_message(self, message: str, file: "SupportsWrite[str] | None" = None) -> None:
        """Print, and do not pass over in silence that there is no room for it, as argparse does."""
        (file or sys.stderr).write(message)


def _common_options(parser: argparse.ArgumentParser, formats: Sequence[str]) -> None:
    group = parser.add_argument_group("common options")
    group.add_argument(
        "--rules", metavar="DIR", action="append", default=[], help="more rule files"
    )
    group.add_argument(
        "--sources", metavar="PATH", action="append", default=[], help="more sources"
    )
    group.add_argument("--format", choices=formats, default="text", help="of the output")
    group.add_argument(
        "--time-limit", metavar="SECONDS", type=positive, help="stop after this long (status 3)"
    )
    group.add_argument(
        "--memory-limit",
        metavar="MB",
        type=positive,
        help="stop beyond this much (status 3); by default half of what container or machine have",
    )
    group.add_argument("--color", choices=("auto", "always", "never"), default="auto")
    group.add_argument("--quiet", action="store_true", help="no progress and no notes")
    group.add_argument("--version", action="version", version=f"mars-asp {__version__}")


def positive(text: str) -> float:
    """Read a number above 0 of a command line."""
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 0 < value < 1e9:
        raise argparse.ArgumentTypeError(f"`{text}` is no positive number")
    return value
