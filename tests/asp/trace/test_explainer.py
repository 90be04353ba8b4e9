"""Traces and absences of random programs are true, well-founded and of least height.

`python -m tests.asp.trace.test_explainer FIRST LAST` tries the programs of as many
seeds as you like.
"""

import random
import re
import sys
import textwrap
from collections import Counter
from collections.abc import Iterable
from dataclasses import replace

import clingo
import pytest

from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.solve.term_ids import TermId, as_term
from mars_asp.asp.trace import Absent, Derived, Given
from mars_asp.asp.trace.absence import explain_absence
from mars_asp.asp.trace.document import trace_json
from mars_asp.asp.trace.text import traces_text, wrapped
from mars_asp.diagnostic import Span
from tests.support.campaigns import seeds
from tests.support.programs import explainer_of, rulebook_of
from tests.support.random_programs import atoms_besides, random_program
from tests.support.trace_checker import (
    all_steps,
    could_give,
    faults,
    height,
    least_heights,
    standing_firings,
)

#: So many absent atoms of a program are asked about, each over so many levels.
_QUERIES, _LEVELS = 2, 9


def wrong_in(seed: int) -> list[str] | None:
    """Return the faults of explanations of a random program, or None without an answer set."""
    return wrong_explanations(*random_program(seed), random.Random(seed))


def wrong_explanations(text: str, facts: Iterable[str], rng: random.Random) -> list[str] | None:
    """Return the faults of explanations of a program with facts; `rng` picks absent atoms."""
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
    for atom in rng.sample(absent, min(_QUERIES, len(absent))):
        missing = explain_absence(explainer, atom, _LEVELS)
        wrong += faults([missing], given, true)
        entries = {id(attempt.rule) for attempt in getattr(missing, "attempts", ())}
        wrong += [
            f"nothing is said of {rule.text} for {atom}"
            for rule in explainer.rules
            if id(rule) not in entries and could_give(rule, atom)
        ]
    return wrong + faults(traces.values(), given, true)


def wrong_in_others(seed: int) -> list[str] | None:
    """Return the faults of all derivations of a random program, or None without an answer set."""
    return wrong_derivations(*random_program(seed))


def wrong_derivations(text: str, facts: Iterable[str]) -> list[str] | None:
    """Return the faults of all derivations of a program with facts."""
    found = explainer_of(text, facts)
    if found is None:
        return None
    explainer, true = found
    given = frozenset(map(clingo.parse_term, facts))
    traces = explainer.why(sorted(true), every=True)
    steps = all_steps(traces.values())
    wrong = faults(traces.values(), given, true)
    numbers = {id(rule): number for number, rule in enumerate(explainer.rules)}
    entries = {
        (numbers[id(step.rule)], frozenset(step.bindings.items()), clingo.parse_term(step.atom))
        for step in steps
    }
    standing = standing_firings(explainer.rules, given, true)
    wrong += [f"{firing} is no derivation" for firing in entries - standing]
    wrong += [f"{firing} is missing" for firing in standing - entries]
    alike = Counter(
        (
            step.atom,
            id(step.rule),
            *map(str, step.bindings.items()),
            frozenset(premise.atom for premise in step.premises),
        )
        for step in steps
    )
    wrong += [f"{firing} is told twice" for firing, count in alike.items() if count > 1]
    return wrong


@pytest.mark.parametrize("first", [20 * each for each in seeds(1, 8)])
def test_all_derivations_of_random_programs(first: int) -> None:
    answered = 0
    for seed in range(first, first + 20):
        wrong = wrong_in_others(seed)
        assert not wrong, f"{random_program(seed)}\n{wrong}"
        answered += wrong is not None
    assert answered > 10


@pytest.mark.parametrize("first", [20 * each for each in seeds(1, 8)])
def test_random_programs(first: int) -> None:
    answered = 0
    for seed in range(first, first + 20):
        wrong = wrong_in(seed)
        assert not wrong, f"{random_program(seed)}\n{wrong}"
        answered += wrong is not None
    assert answered > 10


def step(atom: str, rule: Rule, *premises: Given | Derived | Absent, **values: int) -> Derived:
    return Derived(as_term(clingo.parse_term(atom)), rule, bound(**values), premises)


def bound(**values: int) -> TermId:
    names = clingo.Function("n", [clingo.String(name) for name in values])
    return as_term(clingo.Function("v", [names, *map(clingo.Number, values.values())]))


def test_the_checker_finds_faults() -> None:
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


def derivations(program: str, atom: str) -> Derived:
    """Return an atom's trace with all derivations."""
    found = explainer_of(program)
    assert found is not None
    symbol = clingo.parse_term(atom)
    trace = found[0].why([symbol], every=True)[symbol]
    assert isinstance(trace, Derived)
    return trace


#: `c` has a derivation without `a`, through atoms that lead to each other but not to `a`.
_TWO_CIRCLES = "g. x :- g. y :- x. z :- y. x :- z. a :- g. b :- a. c :- b. c :- z. a :- c."
_GATHERED = """
g. q(1). q(2) :- a. a :- g. b :- 2 <= #count { V : q(V) }. a :- b.
"""
#: In the end there are two elements to count even without `a`.
_GATHERED_OTHERWISE = _GATHERED + "c :- g. d :- c. e :- d. q(3) :- e."


@pytest.mark.parametrize(
    ("program", "atom", "rules"),
    [
        ("a. a :- a.", "a", ["a."]),
        ("a. b :- a. a :- b.", "a", ["a."]),
        ("a. b :- a. c :- b. c. a :- c.", "a", ["a.", "a :- c."]),
        ("g. a :- g. b :- a. c :- b. b :- d. d :- e. e :- g. a :- c.", "a", ["a :- g.", "a :- c."]),
        (_TWO_CIRCLES, "a", ["a :- g.", "a :- c."]),
        (_GATHERED, "a", ["a :- g."]),
        (_GATHERED_OTHERWISE, "a", ["a :- g.", "a :- b."]),
    ],
)
def test_a_derivation_counts_if_it_does_not_need_its_own_atom(
    program: str, atom: str, rules: list[str]
) -> None:
    trace = derivations(program, atom)
    assert sorted(step.rule.text for step in (trace, *trace.others)) == sorted(rules)


@pytest.mark.parametrize(("entrances", "count"), [("n(0).", 1), ("n(0). n(302).", 2)])
def test_a_road_is_walked_from_each_entrance_alone(entrances: str, count: int) -> None:
    """All places lead to each other, but only with two entrances there are two ways to one."""
    both_ways = "n(X+1) :- n(X), X < 301. n(X-1) :- n(X), X > 1."
    steps = all_steps([derivations(entrances + both_ways, "n(301)")])
    counts = Counter(step.atom for step in steps)
    assert {counts[f"n({x})"] for x in range(1, 302)} == {count}


def test_several_derivations_are_numbered() -> None:
    program = "t :- p. p :- q(X). p :- r. q(1..2). r :- p. r."
    lines = traces_text(
        [("t", derivations(program, "t"))], lambda span: "", depth=None, folded=False
    )
    assert [re.sub(r"  \[.*", "", line) for line in lines] == [
        "t",
        "    t :- p.",
        "        (1) p :- q(X)., derivation 1 of 3 for X = 1",
        "            q((1..2)).",
        "        p :- q(X)., derivation 2 of 3 for X = 2",
        "            q((1..2)).",
        "        p :- r., derivation 3 of 3",
        "            r., derivation 1 of 2",
        "            r :- p., derivation 2 of 2",
        "                p :- q(X)., as in (1)",
    ]


def test_derivations_that_rest_on_the_same_are_one() -> None:
    trace = derivations("p(1..3). two :- p(_), 2 <= #count { X : p(X) }.", "two")
    assert not trace.others
    trace = derivations("p(1..3). some :- p(_).", "some")
    assert [p.atom for one in (trace, *trace.others) for p in one.premises if p.atom] == [
        "p(1)",
        "p(2)",
        "p(3)",
    ]


def test_a_long_atom_wraps_after_a_comma() -> None:
    atom = f"p({','.join(str(n) * 9 for n in range(1, 10))})"
    lines = list(wrapped(f"{atom}, as in (1)", 1))
    assert max(map(len, lines)) <= 80
    assert "".join(lines).replace(" ", "") == f"{atom},asin(1)"


def test_lines_are_broken_as_textwrap_breaks_them() -> None:
    rng = random.Random(5)
    parts = ("a ", "  ", "\t", "\n", "bc-d ", "é\x00", ", ", " {x} ", "{x}{x} ")
    for _ in range(3000):
        words = rng.choices(parts, k=rng.randrange(1, 30))
        text = "".join(words).replace("{x}", "x" * rng.randrange(1, 60)).expandtabs().strip()
        indent = "    " * rng.randrange(11)
        assert list(wrapped(text, len(indent) // 4)) == textwrap.wrap(
            text,
            80,
            initial_indent=indent,
            subsequent_indent=indent + "  ",
            break_long_words=False,
            break_on_hyphens=False,
        )


def test_json_of_several_derivations() -> None:
    found = trace_json(derivations("p :- q(X). q(1..2). p :- r. r.", "p"))
    others = found["others"]
    assert isinstance(others, list)
    assert [other["bindings"] for other in others] == [{"X": "2"}, {}]
    assert [other["premises"][0]["atom"] for other in others] == ["q(2)", "r"]
    assert "others" not in others[0]


def test_each_derivation_of_a_lattice_is_rendered_once() -> None:
    """It has 2 ** (2 ** 31) proofs."""
    sides = "".join(f"n(L+1,{s}) :- n(L,S), side(S), L < 31. n(1,{s})." for s in "ab")
    trace = derivations(f"{sides} side(a). side(b).", "n(31,a)")
    assert len(list(traces_text([("top", trace)], lambda span: "", depth=None))) < 800
    assert str(trace_json(trace)).count("'others'") == 59


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


def test_a_variable_of_a_head_is_another_one_than_that_of_an_aggregate() -> None:
    """Moved into the body, the condition `V = 1..2` must not bind the variable of the aggregate."""
    found = explainer_of("q(1..2). 1 { s(X) : V = 1..2 } :- q(X), 2 <= #count { V : q(V) }.")
    assert found is not None
    explainer, true = found
    query = clingo.parse_term("s(2)")
    trace = explainer.why([query])[query]
    assert isinstance(trace, Derived)
    assert {premise.atom for premise in trace.premises} == {"q(1)", "q(2)"}
    assert set(trace.bindings) == {"X"}
    assert faults([trace], frozenset(), true) == []
    assert wrong_in(4566) == []


if __name__ == "__main__":
    results: dict[int, list[str] | None] = {}
    for seed in range(int(sys.argv[1]), int(sys.argv[2])):
        wrong, others = wrong_in(seed), wrong_in_others(seed)
        results[seed] = None if wrong is None or others is None else wrong + others
    faulty = {seed: wrong for seed, wrong in results.items() if wrong}
    for seed, wrong in faulty.items():
        print(seed, *random_program(seed), *wrong, sep="\n")
    unanswered = sum(wrong is None for wrong in results.values())
    print(f"{len(results)} programs, {unanswered} without answer set, {len(faulty)} with faults")
