"""Rules that others make superfluous are found without comparing each with each."""

import random
from collections.abc import Iterator, Sequence
from typing import Any

import pytest

from mars_asp.asp.lint import copies
from mars_asp.asp.lint.clauses import Clause, clauses_of
from mars_asp.asp.lint.copies import superfluous
from mars_asp.asp.lint.found import LintFinding
from mars_asp.asp.rules.rule import Rule
from mars_asp.diagnostic import Diagnostic, point
from tests.support.fixtures import Patch


def clauses(texts: Sequence[str]) -> list[Clause]:
    rules = [
        Rule(f"r:{line}", None, None, point("r.lp", line, 1), text, "base")
        for line, text in enumerate(texts, 1)
    ]
    read = clauses_of(rules)
    return [clause for number in range(len(rules)) for clause in read[number]]


def found(read: Sequence[Clause], judged: frozenset[int]) -> list[Diagnostic]:
    return [each.diagnostic for each in superfluous(read, judged)]


def one_by_one(read: Sequence[Clause], judged: frozenset[int]) -> Iterator[Diagnostic]:
    """Yield the findings of comparing all pairs of rules, those of an equal constant first."""
    plain = [number for number, each in enumerate(read) if each.sort in ("rule", "constraint")]
    for number in sorted(judged.intersection(plain)):
        about = copies._head_pattern(read[number])
        for general in dict.fromkeys((about, (*about[:-1], ""))):
            others = [o for o in plain if copies._head_pattern(read[o]) == general]
            result = (copies._subsumed(read, number, other) for other in others if other != number)
            if first := next(filter(None, result), None):
                yield first.diagnostic
                break


def random_rule(chance: random.Random) -> str:
    terms = ("X", "Y", "_", "a", "b", "1", "X+1", "f(X)", '"s"')
    atoms = [f"{chance.choice('pqr')}({', '.join(chance.choices(terms, k=2))})" for _ in range(3)]
    more = ["not s(X)", "X < Y", "X != a", "#count { Z : p(Z, a) } > 1", "p(Z, b) : q(Z, X)"]
    body = chance.sample(atoms + more, chance.randint(1, 4))
    head = chance.choice(("h(X, Y)", "h(a, X)", "h(b, X)", "h(a, b)", "", "{ h(X, Y) }"))
    return f"{head} :- {'; '.join(body)}."


@pytest.mark.parametrize("seed", range(40))
def test_findings_equal_those_of_comparing_all_pairs(seed: int) -> None:
    chance = random.Random(seed)
    read = clauses([random_rule(chance) for _ in range(40)])
    judged = frozenset(range(chance.randint(0, 20), len(read)))
    assert set(found(read, judged)) == set(one_by_one(read, judged))


@pytest.mark.parametrize(
    "form",
    [
        'p(M) :- module(M), feeds(_, M, "s{}").',
        'p(M) :- module(M), not feeds(M, S) : module(S), S != "s{}".',
        "p(M) :- at{}(M).",
        "p(k{}) :- at(M, _).",
        "p(k, M, f{}(S)) :- feeds(_, M, S).",
        "p(k, M, S) :- feeds(_, M, f{}(S)).",
    ],
)
def test_rules_with_one_head_are_compared_with_few_others(form: str, monkeypatch: Patch) -> None:
    read = clauses([form.format(number) for number in range(200)])
    compared, compare = [], copies._subsumed

    def counted(*each: Any) -> LintFinding | None:
        compared.append(each)
        return compare(*each)

    monkeypatch.setattr(copies, "_subsumed", counted)
    assert not found(read, frozenset(range(200)))
    assert len(compared) <= 200
