"""Findings for other programs: all of them on standard output, when everything was read."""

import argparse
from collections.abc import Callable, Sequence

from mars_asp.cli.results import Result
from mars_asp.diagnostic import MarsError

#: What the verbs print that list findings and nothing else.
FINDING_FORMATS = ("text", "json", "sarif", "github")


def is_published(arguments: argparse.Namespace) -> bool:
    """Whether results go to standard output, all of them when everything was read."""
    return arguments.format in ("sarif", "github")


def publish(results: Sequence[Result], arguments: argparse.Namespace, status: int) -> int:
    """Print results; return the exit status."""
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
    """Whether a result is a note about reading, and no finding."""
    return result.diagnostic.severity == "note" and result.consequence is None


def published(
    run: Callable[[argparse.Namespace], int],
) -> Callable[[argparse.Namespace], int]:
    """Return a verb's `run` that prints what is wrong with the input as results, too."""

    def running(arguments: argparse.Namespace) -> int:
        try:
            return run(arguments)
        except MarsError as error:
            if not is_published(arguments):
                raise
            return publish([Result(each) for each in error.diagnostics], arguments, 2)

    return running
