"""Which variables a body binds is seen without clingo, and clingo says the same."""

import random
from collections import Counter

import pytest

from mars_asp.asp.rules.binding import _seen_unbound, _told_unbound, conjunct, unbound
from mars_asp.asp.rules.statements import variants

TERMS = ("X", "Y", "Z", "_", "a", "f(X)", "(Y, Z)", "X+1", "-Y", '"Z"', "2*Z", "X'")
INNER = (
    "#sum { Z : p(Z, X) } = Y",
    "Z = #count { X : p(X, Y), not p(Y, 1); Y, 1 : p(Y, X) }",
    "X < #max { Y, V : p(Y, V), V != X }",
    "not 1 = #sum { V : p(V, Z) }",
    "{ p(X, V) : p(V, Z) } = 1",
    "#count { V : not p(V, X) } < 2",
    "p(V, X) : p(V, Y)",
    "not p(X, V) : p(V, V), V < Z",
    "#true",
)


def random_body(chance: random.Random) -> str:
    forms = [
        f"{chance.choice(('', '', 'not ', '-'))}p({', '.join(chance.choices(TERMS, k=2))})"
        for _ in range(3)
    ]
    signs = ("<", "=", "!=", "< 3 =")
    forms += [f"{chance.choice(TERMS)} {sign} {chance.choice(TERMS)}" for sign in signs]
    forms += [f"not {forms[-2]}", *chance.sample(INNER, 3)]
    return f":- {'; '.join(chance.sample(forms, chance.randint(1, 4)))}."


@pytest.mark.parametrize("seed", range(4))
def test_what_is_seen_is_what_clingo_says(seed: int) -> None:
    chance = random.Random(seed)
    seen: Counter[bool] = Counter()
    for _ in range(200):
        text = random_body(chance)
        (rule,) = variants(text)
        body = tuple(map(conjunct, rule.body))
        values = chance.choices(("X", "Y", "Z", "X+Y", "n", "f(X)", "3", '"A"'), k=2)
        found = _seen_unbound(values, body)
        if found is not None:
            result = _told_unbound(values, body)
            assert found - {"_"} == result - {"_"}, (values, text)
            assert bool(found) == bool(result), (values, text)
            seen[bool(found)] += 1
    assert min(seen[True], seen[False]) >= 5


@pytest.mark.parametrize(
    "body",
    [
        "guard(M, N), N < #sum { F, R : feeds(R, M, S), rate(R, F); 1, C : moves(_, M, C) }",
        "guard(N, M), 3 < #count { S : feeds(_, M, S), S != M; C : moves(_, M, C) }",
        "feeds(R, M, N), not rate(R, _), S != M : feeds(R, M, S)",
    ],
)
def test_clingo_is_not_asked_of_what_rules_often_hold(
    body: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delattr("mars_asp.asp.rules.binding.clingo")
    (rule,) = variants(f":- {body}.")
    assert not unbound(("M", "N + 1"), tuple(map(conjunct, rule.body)))
    assert unbound(("M", "K"), tuple(map(conjunct, rule.body))) == {"K"}


def test_elements_get_other_names() -> None:
    (rule,) = variants(':- M = #count { S : p(S, "S", S\'), q(M) }, p(X) : p(X, M).')
    one, other = (conjunct(each).renamed({"S": "S_", "X": "X_"}) for each in rule.body)
    assert one.text == 'M = #count { S_: p(S_,"S",S\'), q(M) }'
    assert one.names == {"M", "S_", "S'"}
    assert other.text == "p(X_): p(X_,M)"
