"""Which variables a body binds is seen without clingo where atoms alone bind them."""

import random

import pytest

from mars_asp.asp.rules import computed
from mars_asp.asp.rules.statements import variants


@pytest.mark.parametrize("seed", range(60))
def test_what_is_seen_in_atoms_is_what_clingo_says(
    seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    chance = random.Random(seed)
    terms = ("X", "Y", "Z", "_", "a", "f(X)", "(Y, Z)", "X+1", "-Y", '"s"', "2*Z")
    forms = [
        f"{chance.choice(('', 'not ', '-'))}p({', '.join(chance.choices(terms, k=2))})"
        for _ in range(3)
    ]
    forms += [f"{chance.choice(terms)} {sign} {chance.choice(terms)}" for sign in ("<", "=", "!=")]
    forms += ["#sum { Z : p(Z, X) } = Y", "#true"]
    text = f":- {'; '.join(chance.sample(forms, 3))}."
    (rule,) = variants(text)
    values = chance.choices(("X", "Y", "Z", "X+Y", "n", "f(X)"), k=2)
    quick = computed._unbound(values, rule.body)
    monkeypatch.setattr(computed, "_are_plain", lambda _: False)
    assert bool(quick) == bool(computed._unbound(values, rule.body)), text
    if quick:
        assert quick == computed._unbound(values, rule.body)
