"""Which rules the cases fire, and which they let fail by one premise alone.

A rule *fires* in a case where its body holds in a wanted answer set; it *just does not* where the
body holds but for one premise. A constraint fires where leaving it out gives another answer.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import clingo

from mars_asp.asp.cases.probes import FIRED, NEAR, fired, probes
from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.rulebook import Rulebook

#: Of the number of a constraint, whether it refuses nothing.
LEFT_OUT = "_left_out"
#: Answer sets of a case that are looked at.
_MOST_ANSWERS = 100


class Case(NamedTuple):
    """A file of cases: their facts, the stages of their rules, and what runs them all."""

    path: Path
    texts: tuple[str, ...]
    stages: tuple[str, ...]
    passes: Callable[[Rulebook], bool]


class Measure(NamedTuple):
    """How cases are run: which probes hold in them, and which constraints refuse a candidate.

    Probes are texts by stage, and answered by the name and the number of each; constraints have
    numbers.
    """

    held: Callable[[Mapping[str, Sequence[str]], Rulebook, Sequence[Case]], set[tuple[str, int]]]
    refusing: Callable[[Mapping[int, Rule], Rulebook, Sequence[Case]], set[int]]


@dataclass(frozen=True)
class Coverage:
    """The rules that were looked at; of these, who fire in no case, and who never just do not.

    What has no premise is not looked at, and never does not fire.
    """

    rules: tuple[Rule, ...]
    silent: tuple[Rule, ...]
    never_near: tuple[Rule, ...]


def covered(
    rules: Sequence[Rule],
    rulebook: Rulebook,
    cases: Sequence[Case],
    measure: Measure | None = None,
) -> Coverage:
    """Run every case with probes beside the rules of its stages, as `measure` does it."""
    measure = measure or Measure(_one_by_one, _refusing)
    looked_at = [rule for rule in rules if rule.ast.body]
    probed = {number: tuple(probes(number, rule)) for number, rule in enumerate(looked_at)}
    entries: dict[str, list[str]] = {}
    for number, rule in enumerate(looked_at):
        entries.setdefault(rule.stage, []).extend(text for _, text in probed[number])
    held = measure.held(entries, rulebook, cases)
    silent = {n: rule for n, rule in enumerate(looked_at) if (FIRED, n) not in held}
    constraints = {n: rule for n, rule in silent.items() if is_constraint(rule)}
    refusing = measure.refusing(constraints, rulebook, cases)
    return Coverage(
        tuple(looked_at),
        tuple(rule for number, rule in silent.items() if number not in refusing),
        tuple(
            rule
            for number, rule in enumerate(looked_at)
            # What metadata lists has the body of its rule, where each premise is tried.
            if rule.listed is None
            and (NEAR, number) not in held
            and any(name == NEAR for name, _ in probed[number])
        ),
    )


def is_constraint(rule: Rule) -> bool:
    """Whether a rule derives nothing, and forbids."""
    return str(rule.ast.head) == "#false"


def watched(rules: str, constraints: Mapping[int, Rule]) -> str:
    """Return rules in which `_fired` holds, of its number, instead of each of some constraints."""
    for number, rule in constraints.items():
        rules = rules.replace(rule.text, fired(number, rule))
    return rules


def _refusing(
    constraints: Mapping[int, Rule], rulebook: Rulebook, cases: Sequence[Case]
) -> set[int]:
    """Return which constraints alone refuse a candidate in some case."""
    rest = dict(constraints)
    for case in cases:
        mine = {number: rule for number, rule in rest.items() if rule.stage in case.stages}
        if not mine:
            continue
        rules = [watched(rulebook.text(stage), mine) for stage in case.stages]
        rules += (f"#external {LEFT_OUT}({n}). :- {FIRED}({n}), not {LEFT_OUT}({n})." for n in mine)
        for facts in case.texts:
            for number in refusals("\n".join([facts, *rules]), mine, FIRED):
                rest.pop(number, None)
    return set(constraints) - set(rest)


def refusals(program: str, numbers: Iterable[int], name: str) -> Iterator[int]:
    """Yield the numbers of which the atom `name` can hold where they alone are left out.

    The program holds an external atom for each of them, `_left_out`.
    """
    control = clingo.Control(["--opt-mode=ignore", "--warn=none"])
    control.add("base", [], program)
    control.ground()
    for number in numbers:
        arguments = [clingo.Number(number)]
        left_out = clingo.Function(LEFT_OUT, arguments)
        control.assign_external(left_out, True)
        if control.solve([(clingo.Function(name, arguments), True)]).satisfiable:
            yield number
        control.assign_external(left_out, False)


def _one_by_one(
    told: Mapping[str, Sequence[str]], rulebook: Rulebook, cases: Sequence[Case]
) -> set[tuple[str, int]]:
    held: set[tuple[str, int]] = set()
    for case in cases:
        rules = [*map(rulebook.text, case.stages)]
        rules += [text for stage in case.stages for text in told.get(stage, ())]
        for facts in case.texts:
            held |= _true_probes("\n".join([facts, *rules]))
    return held


def _true_probes(program: str) -> set[tuple[str, int]]:
    """Return the probes that hold in an answer set, least where something is minimised."""
    control = clingo.Control(["--opt-mode=optN", f"--models={_MOST_ANSWERS}", "--warn=none"])
    control.add("base", [], program)
    control.ground()
    found: set[tuple[str, int]] = set()

    def keep(model: clingo.Model) -> None:
        if model.cost and not model.optimality_proven:
            return
        for symbol in model.symbols(atoms=True):
            if symbol.name in (FIRED, NEAR):
                found.add((symbol.name, symbol.arguments[0].number))

    control.solve(on_model=keep)
    return found
