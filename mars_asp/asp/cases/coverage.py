"""Which rules the cases fire, and which they let fail by one premise alone.

A rule *fires* in a case where its body holds in a wanted answer set; it *just does not* where the
body holds but for one premise. A constraint fires where leaving it out gives another answer.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple, TypeAlias

import clingo

from mars_asp.asp.cases.probes import FIRED, NEAR, fired, probes
from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.rulebook import Rulebook

#: Answers which probes, of each stage, hold in the cases: the name and the number of each.
Measure: TypeAlias = Callable[
    [Mapping[str, Sequence[str]], Rulebook, Sequence["Case"]], set[tuple[str, int]]
]
#: Answer sets of a case that are looked at.
_MOST_ANSWERS = 100


class Case(NamedTuple):
    """A file of cases: their facts, the stages of their rules, and what runs them all."""

    path: Path
    texts: tuple[str, ...]
    stages: tuple[str, ...]
    passes: Callable[[Rulebook], bool]


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
    looked_at = [rule for rule in rules if rule.ast.body]
    probed = {number: tuple(probes(number, rule)) for number, rule in enumerate(looked_at)}
    told: dict[str, list[str]] = {}
    for number, rule in enumerate(looked_at):
        told.setdefault(rule.stage, []).extend(text for _, text in probed[number])
    held = (measure or _one_by_one)(told, rulebook, cases)
    numbered = tuple(enumerate(looked_at))
    silent = (rule for number, rule in numbered if (FIRED, number) not in held)
    return Coverage(
        tuple(looked_at),
        tuple(r for r in silent if not (is_constraint(r) and refuses(r, rulebook, cases))),
        tuple(
            rule
            for number, rule in numbered
            # What metadata lists has the body of its rule, where each premise is tried.
            if rule.listed is None
            and (NEAR, number) not in held
            and any(name == NEAR for name, _ in probed[number])
        ),
    )


def is_constraint(rule: Rule) -> bool:
    """Whether a rule derives nothing, and forbids."""
    return str(rule.ast.head) == "#false"


def refuses(rule: Rule, rulebook: Rulebook, cases: Sequence[Case]) -> bool:
    """Whether a constraint refuses a candidate in some case."""
    instead = f"{fired(0, rule)} :- not {FIRED}(_)."
    for case in cases:
        if rule.stage not in case.stages:
            continue
        rules = "\n".join(map(rulebook.text, case.stages))
        for facts in case.texts:
            control = clingo.Control(["--opt-mode=ignore", "--warn=none"])
            control.add("base", [], "\n".join([facts, rules.replace(rule.text, instead)]))
            control.ground()
            if control.solve().satisfiable:
                return True
    return False


def _one_by_one(
    told: Mapping[str, Sequence[str]], rulebook: Rulebook, cases: Sequence[Case]
) -> set[tuple[str, int]]:
    held: set[tuple[str, int]] = set()
    for case in cases:
        rules = [*map(rulebook.text, case.stages)]
        rules += [text for stage in case.stages for text in told.get(stage, ())]
        for facts in case.texts:
            held |= _held("\n".join([facts, *rules]))
    return held


def _held(program: str) -> set[tuple[str, int]]:
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
