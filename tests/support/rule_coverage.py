"""Which of our own rules the cases fire, measured for many cases in one program."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import clingo

from mars_asp.asp.cases import coverage
from mars_asp.asp.cases.coverage import Case, Coverage
from mars_asp.asp.cases.probes import fired
from mars_asp.asp.rules.read import read_case
from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.rules.statements import shown as shown_in
from mars_asp.asp.signature import Signature
from mars_asp.reasoning.cases import stages_of
from mars_asp.reasoning.cases.run import tried
from tests.support.side_by_side import answered, apart, batched, together


def covered(rulebook: Rulebook, cases: Sequence[Path]) -> Coverage:
    """Run all cases at once with probes beside the rules."""
    found = [tried(each, rulebook) for each in cases]
    return coverage.covered(rulebook.rules, rulebook, found, _together)


def _together(
    told: Mapping[str, Sequence[str]], rulebook: Rulebook, cases: Sequence[Case]
) -> set[tuple[str, int]]:
    paths = [case.path for case in cases]
    return {(name, number) for _, name, number in _held(rulebook, told, paths)}


def fired_in(rules: Sequence[Rule], rulebook: Rulebook, cases: Sequence[Path]) -> list[list[Path]]:
    """Return the cases that fire each of some rules."""
    told = dict[str, list[str]]()
    for number, rule in enumerate(rules):
        told.setdefault(rule.stage, []).append(fired(number, rule))
    found: list[list[Path]] = [[] for _ in rules]
    for path, _, number in sorted(_held(rulebook, told, cases)):
        found[number].append(path)
    return found


def _held(
    rulebook: Rulebook, probes: Mapping[str, Iterable[str]], cases: Iterable[Path]
) -> set[tuple[Path, str, int]]:
    """Return each case with the probes, by stage, that hold in one of its answers."""
    groups: dict[tuple[str, ...], list[Path]] = {}
    for path in cases:
        groups.setdefault(("base", *stages_of(path)), []).append(path)
    found = set[tuple[Path, str, int]]()
    for stages, paths in groups.items():
        rules = [together(rulebook.text(stage)) for stage in stages]
        rules += [together("\n".join(probes.get(stage, ()))) for stage in stages]
        for part in batched(paths):
            facts = [apart(number, read_case(path)[0]) for number, path in enumerate(part)]
            facts += [f"of_({number}, {number})." for number in range(len(part))]
            for atom in answered([*rules, *facts], ("_fired", "_near")):
                case, number = (argument.number for argument in atom.arguments)
                found.add((part[case], atom.name, number))
    return found


def unnoticed(lists: Sequence[Rule], rulebook: Rulebook, cases: Sequence[Path]) -> list[Rule]:
    """Return what metadata lists and may be left out without another answer of any case.

    A case notices it by what it shows, so that an answer is as it is expected only with it.
    """
    number = {rule: at for at, rule in enumerate(lists)}
    left = replace(
        rulebook,
        rules=tuple(
            replace(rule, text=f"{rule.text.rstrip().removesuffix('.')}, not out_({number[rule]}).")
            if rule in number
            else rule
            for rule in rulebook.rules
        ),
    )
    groups: dict[tuple[str, ...], list[tuple[Path, int]]] = {}
    for rule, paths in zip(lists, fired_in(lists, rulebook, cases), strict=True):
        for path in paths:
            groups.setdefault(("base", *stages_of(path)), []).append((path, number[rule]))
    noticed = set[int]()
    for stages, pairs in groups.items():
        rules = [together(left.text(stage)) for stage in stages]
        paths = sorted({path for path, _ in pairs})
        shown = [_shown(path) for path in paths]
        facts = [apart(at, read_case(path)[0]) for at, path in enumerate(paths)]
        # Those without anything left out have the numbers of their cases, the others follow.
        copies = [
            *enumerate(paths),
            *((len(paths) + at, path) for at, (path, _) in enumerate(pairs)),
        ]
        told = [f"of_({copy}, {paths.index(path)})." for copy, path in copies]
        told += [f"out_({len(paths) + at}, {out})." for at, (_, out) in enumerate(pairs)]
        names = {each.name for wanted in shown for each in wanted}
        answers = [set[str]() for _ in copies]
        for atom in answered([*rules, *facts, *told], sorted(names)):
            copy, *rest = atom.arguments
            wanted = shown[paths.index(copies[copy.number][1])]
            if Signature(atom.name, len(rest), atom.positive) in wanted:
                answers[copy.number].add(str(clingo.Function(atom.name, rest, atom.positive)))
        for at, (path, out) in enumerate(pairs):
            if answers[len(paths) + at] != answers[paths.index(path)]:
                noticed.add(out)
    return [rule for rule in lists if number[rule] not in noticed]


def _shown(path: Path) -> frozenset[Signature]:
    pieces = (piece for piece in read_case(path)[1] if piece.sort == "shown")
    return frozenset(each for piece in pieces for each in shown_in(piece.text))


def places(rules: Iterable[Rule]) -> str:
    """Return rules with their places, a line each."""
    return "\n".join(f"{r.span.path}:{r.span.line}: {' '.join(r.text.split())}" for r in rules)
