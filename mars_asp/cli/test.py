"""Run rule cases: facts and expected answer sets in one file."""

import argparse
import sys
from pathlib import Path

from mars_asp.asp.cases import Outcome, find_cases
from mars_asp.cli.encode import encoded
from mars_asp.cli.reason import rulebook_for
from mars_asp.diagnostic import Diagnostic, MarsError
from mars_asp.output import visible
from mars_asp.reasoning.cases import run_case
from mars_asp.reasoning.rules import STAGES


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the verb."""
    parser.add_argument("paths", nargs="+", metavar="PATH", help="case files or folders of them")


def run(arguments: argparse.Namespace) -> int:
    """Print what differs; 1 where a case failed or there was none.

    Raises:
        MarsError: what is wrong with rules or cases, all of it.
    """
    rulebook = rulebook_for(arguments, STAGES)
    cases = find_cases(map(Path, arguments.paths), map(Path, arguments.rules))
    if not cases:
        where = ", ".join(map(visible, arguments.paths))
        print(f"mars-asp test: no case, a `.lp` file besides --rules, in {where}", file=sys.stderr)
    outcomes: list[Outcome] = []
    problems: list[Diagnostic] = []
    for case in cases:
        try:
            outcomes.append(run_case(case, rulebook))
        except MarsError as error:
            problems += error.diagnostics
    if problems:
        raise MarsError(dict.fromkeys(problems))
    failed = [outcome for outcome in outcomes if not outcome.passed]
    passed = len(outcomes) - len(failed)
    if arguments.format == "json":
        listed = [
            {"path": str(o.path), "passed": o.passed, "difference": list(o.difference())}
            for o in outcomes
        ]
        print(encoded({"passed": passed, "failed": len(failed), "cases": listed}))
        return int(bool(failed) or not outcomes)
    for outcome in failed:
        print(f"FAILED {visible(str(outcome.path))}")
        for line in outcome.difference():
            print(visible(line))
    print(f"{passed} passed, {len(failed)} failed")
    return int(bool(failed) or not outcomes)
