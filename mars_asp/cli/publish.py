"""Findings for other programs: all of them on standard output, when everything was read."""

import argparse
from collections.abc import Callable, Sequence

from mars_asp.cli.results import Result
from mars_asp.diagnostic import NOT_READ, MarsError

#: What the verbs print that list findings and nothing else.
FINDING_FORMATS = ("text", "json", "sarif", "github")


def is_published(arguments: argparse.Namespace) -> bool:
    """Whether results go to standard output, all of them when everything was read."""
    return arguments.format in ("sarif", "github")


def publish(results: Sequence[Result], arguments: argparse.Namespace, status: int) -> int:
    """Print results; return the exit status. `--quiet` leaves out notes that no rule finds."""
    told = [each for each in results if not arguments.quiet or not _is_remark(each)]
    if arguments.format == "sarif":
        import json

        from mars_asp.cli.sarif import sarif_log

        print(json.dumps(sarif_log(told, status), indent=1))
    else:
        from mars_asp.cli.github import workflow_commands

        for line in workflow_commands(told):
            print(line)
    return status


def _is_remark(result: Result) -> bool:
    found = result.diagnostic
    # What was not read of a file no program may miss.
    return found.severity == "note" and found.kind is None and found.code != NOT_READ


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
