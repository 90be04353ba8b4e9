"""Count the mutants that the tests notice: see `tests/mutate/__init__.py`."""

import argparse
import os
import sys
import time
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from mars_asp.asp.cases.mutants import Mutant, MutantVerdict, drawn, rule_mutants
from tests.mutate.mutant import known_survivors
from tests.mutate.python_killers import TESTS, judge_python
from tests.mutate.python_mutants import python_mutants
from tests.mutate.rules import CASES, judge_rules, rule_files


def main() -> int:
    """Judge the mutants that the command line selects; return 1 if an unknown one survives."""
    arguments = _arguments()
    begun = time.monotonic()
    verdicts: list[MutantVerdict] = []
    for verdict in _judged(arguments):
        verdicts.append(verdict)
        if len(verdicts) % 50 == 0:
            print(f"{len(verdicts)} mutants", file=sys.stderr)
    _report(verdicts)
    print(f"{time.monotonic() - begun:.0f} s")
    known = {survivor.key for survivor in known_survivors()}
    alive = sorted(
        (v.mutant for v in verdicts if v.killer is None), key=lambda m: (m.path, m.line, m.change)
    )
    _list("survives", (mutant for mutant in alive if mutant.key not in known))
    if arguments.list_survivors:
        _list("survives, and is known to be equivalent", (m for m in alive if m.key in known))
    _list("is listed as equivalent, and killed", _wrongly_listed(verdicts, known))
    return int(any(mutant.key not in known for mutant in alive))


def _judged(arguments: argparse.Namespace) -> Iterator[MutantVerdict]:
    everything = arguments.rules is None and arguments.python is None
    if everything or arguments.rules is not None:
        files = rule_files()
        named = [file for file in files if _named(file.path, arguments.rules)]
        chosen = [m for file in named for m in _sample(rule_mutants(file), arguments)]
        cases, stronger = arguments.cases, not arguments.cases_only
        yield from judge_rules(files, chosen, arguments.jobs, cases, stronger)
    if everything or arguments.python is not None:
        modules = [path for path in TESTS if _named(path, arguments.python)]
        chosen = [m for path in modules for m in _sample(python_mutants(path), arguments)]
        yield from judge_python(chosen, arguments.jobs, arguments.seconds)


def _sample(mutants: Iterable[Mutant], arguments: argparse.Namespace) -> list[Mutant]:
    if arguments.sample is None:
        return list(mutants)
    return drawn(mutants, arguments.sample, arguments.seed)


def _wrongly_listed(
    verdicts: Iterable[MutantVerdict], known: set[tuple[str, str, str]]
) -> list[Mutant]:
    return [v.mutant for v in verdicts if v.killer is not None and v.mutant.key in known]


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m tests.mutate", description=__doc__)
    parser.add_argument("--rules", nargs="*", metavar="FILE", help="mutate these rule files alone")
    parser.add_argument("--python", nargs="*", metavar="FILE", help="mutate these modules alone")
    parser.add_argument("--cases", type=Path, default=CASES, help="a folder of cases")
    parser.add_argument("--cases-only", action="store_true", help="let only cases judge")
    parser.add_argument(
        "--sample", type=int, metavar="N", help="try N mutants of each file, by chance"
    )
    parser.add_argument("--seed", type=int, default=0, help="for the choice (default 0)")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), metavar="N")
    parser.add_argument(
        "--seconds",
        type=float,
        default=60.0,
        metavar="S",
        help="ask of a mutant of Python the shortest tests that take so long (default 60)",
    )
    parser.add_argument("--list-survivors", action="store_true", help="list equivalent ones, too")
    return parser.parse_args()


def _named(path: str, names: Sequence[str] | None) -> bool:
    return not names or any(path.endswith(name) for name in names)


def _report(verdicts: Iterable[MutantVerdict]) -> None:
    total: Counter[str] = Counter()
    killed: Counter[str] = Counter()
    for verdict in verdicts:
        total[verdict.mutant.path] += 1
        killed[verdict.mutant.path] += verdict.killer is not None
    for path in sorted(total):
        print(f"{path:32} {killed[path]:4} of {total[path]:4}  {killed[path] / total[path]:6.1%}")
    if total:
        share = killed.total() / total.total()
        print(f"{'all':32} {killed.total():4} of {total.total():4}  {share:6.1%}")


def _list(what: str, mutants: Iterable[Mutant]) -> None:
    found = list(mutants)
    if found:
        print(f"\n{len(found)} that {what}:" if len(found) > 1 else f"\nOne that {what}:")
    for mutant in found:
        print(mutant)


if __name__ == "__main__":
    sys.exit(main())
