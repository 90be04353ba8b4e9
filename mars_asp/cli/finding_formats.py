"""Findings in formats for other programs, printed together after everything was read."""

import argparse
from collections.abc import Callable, Sequence

from mars_asp.cli.results import Result
from mars_asp.diagnostic import MarsError

#: The formats of commands that list findings only.
FINDING_FORMATS = ("text", "json", "sarif", "github")


def is_published(arguments: argparse.Namespace) -> bool:
    """Whether the requested format is one for other programs, printed after all reading."""
    return arguments.format in ("sarif", "github")


def publish(results: Sequence[Result], arguments: argparse.Namespace, status: int) -> int:
    """Print results in the requested format; return the exit status."""
    print(published_text(results, arguments, status), end="")
    return status


def published_text(results: Sequence[Result], arguments: argparse.Namespace, status: int) -> str:
    """Return results in a format for other programs; `--quiet` leaves out notes about reading."""
    kept = [each for each in results if not (arguments.quiet and is_note(each))]
    if arguments.format == "sarif":
        import json

        from mars_asp.cli.sarif import sarif_log

        return f"{json.dumps(sarif_log(kept, status), indent=1)}\n"
    from mars_asp.cli.github import workflow_commands

    return "".join(f"{line}\n" for line in workflow_commands(kept))


def is_note(result: Result) -> bool:
    """Whether a result is a note about reading, and not a finding."""
    return result.diagnostic.severity == "note" and result.consequence is None


def published(
    run: Callable[[argparse.Namespace], int],
) -> Callable[[argparse.Namespace], int]:
    """Return the function `run` of a command, which then prints errors of the input as results."""

    def running(arguments: argparse.Namespace) -> int:
        try:
            return run(arguments)
        except MarsError as error:
            if not is_published(arguments):
                raise
            return publish([Result(each) for each in error.diagnostics], arguments, 2)

    return running
