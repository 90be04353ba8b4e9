"""Run rule cases: facts and expected answer sets in one file."""

import argparse
from pathlib import Path

from mars_asp.cli.reason import rulebook_for
from mars_asp.rule_cases import STAGES, find_cases, run_case
from mars_asp.visible import visible


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the verb."""
    parser.add_argument("paths", nargs="+", metavar="PATH", help="case files or folders of them")


def run(arguments: argparse.Namespace) -> int:
    """Print what differs; 1 where a case failed or there was none."""
    rulebook = rulebook_for(arguments, STAGES)
    cases = find_cases(map(Path, arguments.paths))
    failed = 0
    for case in cases:
        outcome = run_case(case, rulebook)
        if not outcome.passed:
            failed += 1
            print(f"FAILED {visible(str(case))}")
            for line in outcome.difference():
                print(visible(line))
    print(f"{len(cases) - failed} passed, {failed} failed")
    return int(failed > 0 or not cases)
