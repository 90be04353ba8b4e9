"""Mutants of the built-in rules, tried on the cases of `tests/rules` and on stronger checks."""

from collections.abc import Iterator, Sequence
from functools import cache
from pathlib import Path

from mars_asp.asp.cases.killers import Bench, judge
from mars_asp.asp.cases.mutants import Mutant, MutantVerdict, MutatedFile, rule_file
from mars_asp.asp.contained import limit_time
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.reasoning.cases import cases_of
from mars_asp.reasoning.cases.run import DETERMINISTIC, tried
from mars_asp.reasoning.findings import EXPANSIONS
from mars_asp.reasoning.rules import STAGES, load_rulebook
from tests.mutate.stronger import CHECKS
from tests.support.documents import ROOT

CASES = ROOT / "tests" / "rules"


@cache
def rule_files(folder: Path = ROOT / "rules") -> tuple[MutatedFile, ...]:
    """Return all rule files, those of the base first."""
    paths = [*sorted(folder.glob("*.lp")), *sorted(folder.glob("*/*.lp"))]
    return tuple(_read(path, folder) for path in paths)


def _read(path: Path, folder: Path) -> MutatedFile:
    below = path.relative_to(folder)
    stage = "base" if len(below.parts) == 1 else below.parts[0]
    return rule_file(f"{folder.name}/{below.as_posix()}", stage, path.read_bytes())


def judge_rules(
    files: Sequence[MutatedFile],
    mutants: Sequence[Mutant],
    jobs: int,
    cases: Path = CASES,
    stronger: bool = True,
) -> Iterator[MutantVerdict]:
    """Yield the verdict on each mutant of the files, in no order."""
    found = [tried(each.path, built_in()) for each in cases_of([cases])]
    check = _killing_check if stronger else None
    bench = Bench(built_in(), found, DETERMINISTIC, EXPANSIONS, check)
    return judge(files, mutants, bench, jobs)


@cache
def built_in() -> Rulebook:
    """Return the built-in rules of all stages, with all checks."""
    return load_rulebook(stages=STAGES, strict=True)


def _killing_check(stage: str, rulebook: Rulebook) -> str | None:
    for check in CHECKS:
        if stage in check.stages:
            limit_time(check.seconds)
            try:
                check.run(rulebook)
            except Exception:
                return check.name
    return None
