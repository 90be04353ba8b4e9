"""Coverage of rules by cases, and mutants of rules that the cases notice."""

import argparse
import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from operator import attrgetter
from pathlib import Path
from typing import TypeAlias

from mars_asp.asp.cases.coverage import Case, covered
from mars_asp.asp.cases.mutants import Mutant, MutatedFile, rule_file, rule_mutants
from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.signature import plain
from mars_asp.cli.lines import rule_location_json
from mars_asp.output import visible
from mars_asp.reasoning.cases import FoundCase
from mars_asp.reasoning.cases.run import DETERMINISTIC, tried
from mars_asp.reasoning.findings import EXPANSIONS

#: The results of a pack as lines and as JSON.
_Measured: TypeAlias = tuple[list[str], dict[str, object]]


def measured(
    books: Mapping[FoundCase, Rulebook], arguments: argparse.Namespace
) -> tuple[Mapping[str, object], Sequence[str], int]:
    """Return the coverage and mutants of the rules of each pack as JSON, as lines, and the status.

    The status is 1 if a rule or a mutant is missed. `books` has the rules of each case.
    """
    requested = {"coverage": arguments.coverage, "mutants": arguments.mutate}
    result: dict[str, list[dict[str, object]]] = {name: [] for name in requested if requested[name]}
    lines: list[str] = []
    together: dict[tuple[Path | None, int], list[FoundCase]] = {}
    for each, rulebook in books.items():
        together.setdefault((each.pack, id(rulebook)), []).append(each)
    for (pack, _), found in together.items():
        rulebook = books[found[0]]
        cases = [tried(each.path, rulebook) for each in found]
        of = "the given rules" if pack is None else visible(str(pack))
        entries: dict[str, _Measured] = {}
        if arguments.coverage:
            rules = rulebook.of_packs if rulebook.packs else rulebook.rules
            own = tuple(rule for rule in rules if _is_of(rule.span.path, pack))
            entries["coverage"] = _coverage(of, own, rulebook, cases)
        if arguments.mutate:
            files = tuple(_mutated_files(pack, rulebook))
            entries["mutants"] = _mutants(of, files, rulebook, cases, arguments.jobs)
        for name, (of_pack, entry) in entries.items():
            lines += of_pack
            result[name].append({"pack": None if pack is None else str(pack), **entry})
    every = (entry for of_name in result.values() for entry in of_name)
    is_missed = any(entry.get("silent") or entry.get("survivors") for entry in every)
    return result, lines, int(is_missed)


def _is_of(path: str, pack: Path | None) -> bool:
    return pack is None or Path(path).is_relative_to(pack)


def _mutated_files(pack: Path | None, rulebook: Rulebook) -> Iterator[MutatedFile]:
    packs = rulebook.packs
    texts = zip(rulebook.texts, rulebook.paths, strict=True)
    for (stage, text), path in list(texts)[len(rulebook.texts) - packs if packs else 0 :]:
        if _is_of(path, pack):
            yield rule_file(path, stage, text.encode())


def _coverage(
    of: str, rules: Sequence[Rule], rulebook: Rulebook, cases: Sequence[Case]
) -> _Measured:
    found = covered(rules, rulebook, cases)
    fire = len(found.rules) - len(found.silent)
    near = len(found.rules) - len(found.silent) - len(found.never_near)
    lines = [f"coverage of {of}: {fire} of {len(found.rules)} rules fire in a case"]
    lines += [f"  fires in no case: {_rule_location(rule)}" for rule in found.silent]
    lines += [
        f"  never fails by one premise alone: {_rule_location(rule)}" for rule in found.never_near
    ]
    entry: dict[str, object] = {
        "rules": len(found.rules),
        "fired": fire,
        "near": max(near, 0),
        "silent": [rule_location_json(rule) for rule in found.silent],
        "never_near": [rule_location_json(rule) for rule in found.never_near],
    }
    return lines, entry


def _rule_location(rule: Rule) -> str:
    return visible(f"{rule.span.path}:{rule.span.line}: {rule.id}")


def _mutants(
    of: str,
    files: Sequence[MutatedFile],
    rulebook: Rulebook,
    cases: Sequence[Case],
    jobs: int | None,
) -> _Measured:
    mutants = [mutant for file in files for mutant in rule_mutants(file)]
    survivors = _survivors(files, mutants, rulebook, cases, jobs)
    alive = sorted(survivors, key=attrgetter("path", "line", "change"))
    killed = len(mutants) - len(alive)
    lines = [f"mutants of {of}: {killed} of {len(mutants)} are noticed by a case"]
    for mutant in alive:
        lines += [
            f"  survives: {visible(f'{mutant.path}:{mutant.line}')}: {_visible_rule(mutant.change)}"
        ]
        lines += [f"    - {_visible_rule(mutant.before)}", f"    + {_visible_rule(mutant.after)}"]
    entry: dict[str, object] = {
        "tried": len(mutants),
        "killed": killed,
        "survivors": [_mutant_json(mutant) for mutant in alive],
    }
    return lines, entry


def _survivors(
    files: Sequence[MutatedFile],
    mutants: Sequence[Mutant],
    rulebook: Rulebook,
    cases: Sequence[Case],
    jobs: int | None,
) -> Iterable[Mutant]:
    from mars_asp.asp.cases.killers import Bench, judge

    bench = Bench(rulebook, cases, DETERMINISTIC, EXPANSIONS)
    verdicts = judge(files, mutants, bench, jobs or os.cpu_count() or 1)
    return (verdict.mutant for verdict in verdicts if verdict.killer is None)


def _visible_rule(text: str) -> str:
    return visible(plain(text))


def _mutant_json(mutant: Mutant) -> dict[str, object]:
    return {
        "path": mutant.path,
        "line": mutant.line,
        "change": plain(mutant.change),
        "before": plain(mutant.before),
        "after": plain(mutant.after),
    }
