"""Traces and absences of random programs are true, well-founded and of least height.

`python -m tests.test_traces FIRST LAST` tries the programs of as many seeds as you like.
"""

import random
import re
import sys
from collections.abc import Iterable
from dataclasses import replace

import clingo
import pytest

from mars_asp.rulebook import Rule
from mars_asp.source import Span
from mars_asp.term import Term, as_term
from mars_asp.trace import Absent, Derived, Given
from mars_asp.trace.absence import why_not
from mars_asp.trace.text import trace_json, traces_text
from tests.programs import explainer_of, rulebook_of
from tests.random_programs import atoms_besides, random_program
from tests.trace_checker import could_give, faults, height, least_heights

#: So many absent atoms of a program are asked about, each over so many levels.
_ASKED, _LEVELS = 2, 9


def wrong_in(seed: int) -> list[str] | None:
    """Return what is wrong with the explanations of a random program; `None` without answer set."""
    text, facts = random_program(seed)
    found = explainer_of(text, facts)
    if found is None:
        return None
    explainer, true = found
    given = frozenset(map(clingo.parse_term, facts))
    traces = explainer.why(sorted(true))
    least = least_heights(explainer.rules, given, true)
    wrong = [
        f"{atom} has a trace of height {height(trace)}, least is {least.get(atom)}"
        for atom, trace in traces.items()
        if height(trace) != least.get(atom)
    ]
    absent = [clingo.parse_term(atom) for atom in atoms_besides(map(str, true))]
    rng = random.Random(seed)
    for atom in rng.sample(absent, min(_ASKED, len(absent))):
        missing = why_not(explainer, atom, _LEVELS)
        wrong += faults([missing], given, true)
        said = {id(attempt.rule) for attempt in getattr(missing, "attempts", ())}
        wrong += [
            f"nothing is said of {rule.text} for {atom}"
            for rule in explainer.rules
            if id(rule) not in said and could_give(rule, atom)
        ]
    return wrong + faults(traces.values(), given, true)


@pytest.mark.parametrize("first", range(0, 160, 20))
def test_random_programs(first: int) -> None:
    answered = 0
    for seed in range(first, first + 20):
        wrong = wrong_in(seed)
        assert not wrong, f"{random_program(seed)}\n{wrong}"
        answered += wrong is not None
    assert answered > 10


def step(atom: str, rule: Rule, *premises: Given | Derived | Absent, **values: int) -> Derived:
    return Derived(as_term(clingo.parse_term(atom)), rule, bound(**values), premises)


def bound(**values: int) -> Term:
    pairs = ([clingo.String(name), clingo.Number(value)] for name, value in values.items())
    return as_term(clingo.Function("v", [clingo.Function("", pair) for pair in pairs]))


def test_the_checker_finds_what_is_wrong() -> None:
    rules = rulebook_of("p(X) :- q(X), not r(X). r(X) :- r(X). q(1..2).").rules
    true = frozenset(map(clingo.parse_term, ["p(1)", "q(1)", "q(2)", "r(2)"]))
    q1, q2 = (step(f"q({n})", rules[2]) for n in (1, 2))
    good = step("p(1)", rules[0], q1, Absent("r(1)"), X=1)
    assert faults([good], frozenset(), true) == []
    bad: Iterable[Derived | Given | Absent] = [
        replace(good, premises=(q2,)),
        replace(good, head=as_term(clingo.parse_term("p(2)")), premises=(q2,), values=bound(X=2)),
        replace(good, premises=(Given("q(1)", Span("x", 1, 1, 1, 1)),)),
        replace(good, rule=rules[2], premises=()),
        Absent("q(_)"),
        step("r(2)", rules[1], step("r(2)", rules[1], X=2), X=2),
    ]
    assert all(faults([trace], frozenset(), true) for trace in bad)


def test_a_chain_of_ten_thousand_steps_needs_no_deep_recursion() -> None:
    found = explainer_of("n(0). n(X+1) :- n(X), X < 10000.")
    assert found is not None
    last = clingo.Function("n", [clingo.Number(10000)])
    trace = found[0].why([last])[last]
    lines = list(traces_text([("n(10000)", trace)], lambda span: "", depth=None))
    assert sum("[program/1]" in line for line in lines) == 10000
    steps, below = 0, trace_json(trace)
    while below["premises"]:
        premises = below["premises"]
        assert isinstance(premises, list)
        steps, below = steps + 1, premises[0]
    assert steps == 10000


def test_a_lattice_of_thirty_layers_prints_each_shared_step_once() -> None:
    """It unfolds to a tree of 2 ** 31 steps."""
    sides = "".join(f"n(L+1,{side}) :- n(L,a), n(L,b), L < 31. n(1,{side})." for side in "ab")
    found = explainer_of(sides)
    assert found is not None
    tops = [clingo.parse_term(f"n(31,{side})") for side in "ab"]
    traces = found[0].why(tops)
    topics = [(str(top), traces[top]) for top in tops]
    lines = list(traces_text(topics, lambda span: "", depth=None))
    numbered = [line for line in lines if re.match(r" *\(\d+\) ", line)]
    assert len(numbered) == 60
    assert len(lines) < 300


if __name__ == "__main__":
    results = {seed: wrong_in(seed) for seed in range(int(sys.argv[1]), int(sys.argv[2]))}
    faulty = {seed: wrong for seed, wrong in results.items() if wrong}
    for seed, wrong in faulty.items():
        print(seed, *random_program(seed), *wrong, sep="\n")
    unanswered = sum(wrong is None for wrong in results.values())
    print(f"{len(results)} programs, {unanswered} without answer set, {len(faulty)} with faults")
