"""The rules that the cases fire, and the rules that they make fail by one premise.

A rule *fires* in a case if its body holds in an expected answer set; it is *near* if all literals
except one hold. A constraint fires if another answer exists without it.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import clingo

from mars_asp.asp.cases.probes import FIRED, NEAR, fired, probes
from mars_asp.asp.fragments import Fragment, able_to_fire, joined
from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.rulebook import Rulebook

#: The external atom, with the number of a constraint, that disables the constraint.
LEFT_OUT = "_left_out"
#: The maximal number of answer sets of a case that are examined.
_MOST_ANSWERS = 100


class Case(NamedTuple):
    """A file of cases: their facts, the stages of their rules, and a function that runs them."""

    path: Path
    texts: tuple[str, ...]
    stages: tuple[str, ...]
    passes: Callable[[Rulebook], bool]


class Measure(NamedTuple):
    """The functions that run cases: `held` finds probes that hold, `refusing` finds constraints.

    Probes are rules as texts by stage; a result is the probe's predicate with the number of its
    rule. `refusing` returns the numbers of the constraints that exclude an answer.
    """

    held: Callable[[Mapping[str, Sequence[str]], Rulebook, Sequence[Case]], set[tuple[str, int]]]
    refusing: Callable[[Mapping[int, Rule], Rulebook, Sequence[Case]], set[int]]


@dataclass(frozen=True)
class Coverage:
    """The examined rules: `silent` ones never fire, `never_near` ones never fail by one premise.

    Rules without premises are not examined, because they always fire.
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
    """Return which of `rules` the cases fire, and which they make fail by one premise.

    `rulebook` contains all rules; `measure` replaces the way in which cases are run.
    """
    measure = measure or Measure(_one_by_one, _refusing)
    looked_at = [rule for rule in rules if rule.node.body]
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
            if (NEAR, number) not in held and any(name == NEAR for name, _ in probed[number])
        ),
    )


def is_constraint(rule: Rule) -> bool:
    """Whether a rule has no head."""
    return str(rule.node.head) == "#false"


def watched(rules: str, constraints: Mapping[int, Rule]) -> str:
    """Return the text `rules`, in which constraints derive `_fired` with their number instead."""
    for number, rule in constraints.items():
        rules = rules.replace(rule.text, fired(number, rule))
    return rules


def _refusing(
    constraints: Mapping[int, Rule], rulebook: Rulebook, cases: Sequence[Case]
) -> set[int]:
    """Return the numbers of constraints that alone exclude an answer in some case."""
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
    """Yield each number whose constraint is all that keeps the atom `name(number)` from holding.

    The program has an external atom `_left_out` for each number.
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
    probe_texts: Mapping[str, Sequence[str]], rulebook: Rulebook, cases: Sequence[Case]
) -> set[tuple[str, int]]:
    held: set[tuple[str, int]] = set()
    for case in cases:
        probes = [text for stage in case.stages for text in probe_texts.get(stage, ())]
        rules = [Fragment("\n".join(probes), "rules")]
        rules += (each for stage in case.stages for each in rulebook.fragments(stage))
        for facts in case.texts:
            held |= _true_probes(joined(able_to_fire([Fragment(facts, "rules"), *rules])))
    return held


def _true_probes(program: str) -> set[tuple[str, int]]:
    """Return the probes that hold in an answer set, in an optimal one if the program minimises."""
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
