"""Which of our own rules the cases fire, measured for many cases in one program."""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import chain
from pathlib import Path
from typing import TypeAlias

import clingo

from mars_asp.asp.cases import coverage, find_cases
from mars_asp.asp.cases.coverage import LEFT_OUT, Case, Coverage, Measure, refusals, watched
from mars_asp.asp.cases.probes import FIRED, NEAR, probed
from mars_asp.asp.fragments import joined
from mars_asp.asp.messages import labelling
from mars_asp.asp.rules.expansions import Label
from mars_asp.asp.rules.read import read_case
from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.rules.statements import shown as shown_in
from mars_asp.asp.rules.trees import SyntaxNode
from mars_asp.asp.signature import Signature
from mars_asp.reasoning.cases import stages_of
from tests.support.cases_at_once import CHOOSING
from tests.support.documents import ROOT
from tests.support.side_by_side import ANY, answered, apart, each_together, printed, together

CASES = find_cases([ROOT / "tests" / "rules"])
#: Cases in one program: more of those that choose take longer together than apart.
_MOST, _MOST_ANY = 150, 400
_PROBES = Signature(FIRED, 2), Signature(NEAR, 2)
#: A probe that holds: its name, the number of the case and that of the rule.
_HOLDS = re.compile(rf"({FIRED}|{NEAR})\((\d+),(\d+)\)")
#: The names and the bodies of the probes of rules, by their numbers.
_Probes: TypeAlias = Mapping[int, Sequence[tuple[str, Sequence[SyntaxNode]]]]
#: The number of a case that has an answer.
_ANSWERS = re.compile(r"\bin_\((\d+)\)")


def covered(rulebook: Rulebook, rules: Sequence[Rule]) -> Coverage:
    """Run all cases at once with probes beside the rules."""
    found = [Case(path, (), ("base", *stages_of(path)), lambda _: True) for path in CASES]
    numbers = {rule: number for number, rule in enumerate(rulebook.rules)}
    at = {numbers[rule]: n for n, rule in enumerate(rule for rule in rules if rule.node.body)}
    held = {(name, at[number]) for name, number in _fired_or_near(rulebook) if number in at}
    return coverage.covered(rules, rulebook, found, Measure(lambda *_: held, _refusing))


def _refusing(
    constraints: Mapping[int, Rule], rulebook: Rulebook, cases: Sequence[Case]
) -> set[int]:
    found = set[int]()
    own = {rule.stage for rule in constraints.values()}
    paths = [case.path for case in cases if own.intersection(case.stages)]
    for stages, part in _parts(paths):
        rest = {
            n: rule for n, rule in constraints.items() if n not in found and rule.stage in stages
        }
        rules = [together(watched(rulebook.text(stage), rest)) for stage in stages]
        for n in rest:
            rules.append(
                f"#external {LEFT_OUT}({n}). :- {FIRED}(C, {n}), in_(C), not {LEFT_OUT}({n})."
            )
            rules.append(f"refused_({n}) :- {FIRED}(C, {n}), in_(C).")
        found.update(refusals("\n".join([*rules, *_facts(part), ANY]), rest, "refused_"))
    return found


def fired_in(rules: Sequence[Rule], rulebook: Rulebook, cases: Iterable[Path]) -> list[list[Path]]:
    """Return the cases that fire each of some rules."""
    numbers = {rule: number for number, rule in enumerate(rulebook.rules)}
    probes: _Probes = {numbers[rule]: [(FIRED, list(rule.node.body))] for rule in rules}
    fired: dict[int, list[Path]] = {numbers[rule]: [] for rule in rules}
    for _, number, path in _holding(probes, rulebook, cases, once=False):
        fired[number].append(path)
    return [fired[numbers[rule]] for rule in rules]


def _fired_or_near(rulebook: Rulebook) -> set[tuple[str, int]]:
    """Return the rules that fire in some case, and those that fail by one premise in some.

    Rules of stages without a case are left out.
    """
    stages = {"base", *chain.from_iterable(map(stages_of, CASES))}
    probes: _Probes = {
        number: list(probed(rule)) if rule.node.body else [(FIRED, [])]
        for number, rule in enumerate(rulebook.rules)
        if rule.stage in stages
    }
    return {(name, number) for name, number, _ in _holding(probes, rulebook, CASES, once=True)}


def _holding(
    bodies: _Probes,
    rulebook: Rulebook,
    cases: Iterable[Path],
    *,
    once: bool,
) -> Iterator[tuple[str, int, Path]]:
    """Yield each probe whose body holds, the number of its rule and the case; `once`: in one."""
    probes: dict[str, list[tuple[tuple[str, int], str]]] = {}
    for number, some in bodies.items():
        keyed = [((name, number), text) for name, text in each_together(some, number)]
        probes.setdefault(rulebook.rules[number].stage, []).extend(keyed)
    found = set[tuple[str, int]]()
    # Those of the base first, as its rules are in every program.
    for stages, part in sorted(_parts(cases), key=lambda each: len(each[0])):
        texts = [
            text
            for stage in stages
            for key, text in probes.get(stage, ())
            if not once or key not in found
        ]
        if texts:
            rules = [together(rulebook.text(stage)) for stage in stages]
            answer = printed([*rules, *texts, *_facts(part)], _PROBES)
            answering = {*_ANSWERS.findall(answer)}
            for name, case, number in _HOLDS.findall(answer):
                if case in answering:
                    found.add((name, int(number)))
                    yield name, int(number), part[int(case)]


def labelled(
    listed: Sequence[tuple[Rule, Label]], rulebook: Rulebook, cases: Iterable[Path]
) -> set[int]:
    """Return the numbers of the labels that apply to some location in a case of the base."""
    rules = [together(rulebook.text("base")), together(joined(labelling("base", listed)))]
    found = set[int]()
    for stages, part in _parts(cases):
        assert stages == ("base",)
        for atom in answered([*rules, *_facts(part)], (Signature("_label_base", 5),)):
            found.add(atom.arguments[1].number)
    return found


def _parts(cases: Iterable[Path]) -> Iterator[tuple[tuple[str, ...], Sequence[Path]]]:
    """Yield cases that are run in one program, with their stages."""
    groups: dict[tuple[str, ...], list[Path]] = {}
    for path in cases:
        groups.setdefault(("base", *stages_of(path)), []).append(path)
    for stages, paths in groups.items():
        most = _MOST_ANY if CHOOSING.isdisjoint(stages) else _MOST
        for begin in range(0, len(paths), most):
            yield stages, paths[begin : begin + most]


def _facts(part: Sequence[Path]) -> Iterator[str]:
    """Yield the facts of cases, and which copies there are of them: one of each."""
    for number, path in enumerate(part):
        yield apart(number, read_case(path)[0])
        yield f"of_({number}, {number})."


def unnoticed(lists: Sequence[Rule], rulebook: Rulebook, cases: Sequence[Path]) -> list[Rule]:
    """Return the listed rules whose omission changes no answer of any case.

    A case notices a missing rule only if the shown atoms of its answers change.
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
        lines = [f"of_({copy}, {paths.index(path)})." for copy, path in copies]
        lines += [f"out_({len(paths) + at}, {out})." for at, (_, out) in enumerate(pairs)]
        names = {each._replace(arity=each.arity + 1) for wanted in shown for each in wanted}
        answers = [set[str]() for _ in copies]
        for atom in answered([*rules, *facts, *lines], sorted(names)):
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
