"""What is seen of one part among others is what is seen of it alone."""

import random
from collections.abc import Iterable, Mapping, Sequence, Set

import clingo
import pytest

from mars_asp.asp.rules.statements import program_of
from mars_asp.asp.signature import Signature
from mars_asp.asp.slice.seen import UNSEEN, Seen, Sight, seen_apart, sights

#: `e(R,A,B)`: line R is A's, and B is of other lines, too; `m` states something of a line, and `p`
#: of what is A or B.
E, M, P, Q = (Signature(*each) for each in (("e", 3), ("m", 2), ("p", 2), ("q", 2)))
ISLANDS = {E: (0, 1, 2), M: (0,), P: (0,)}
PARTS: Mapping[Signature, tuple[int, ...]] = {E: (0, 1), M: (0,), P: ()}


def seen(rules: str, reading: str) -> Sequence[Seen] | None:
    """Return what rules see of parts that read what others derive."""
    base, readers = program_of(rules), program_of(reading)
    assert base is not None
    assert readers is not None
    return seen_apart(base.statements, sights(readers.statements), ISLANDS, PARTS)


@pytest.mark.parametrize(
    ("rules", "is_apart"),
    [
        ("q(R, N) :- m(R, N).", True),
        ("q(R, N) :- e(R, _, B), p(B, N).", True),
        ("q(R, N) :- e(R, A, _), e(R', A, _), m(R', N).", True),
        # B is of several lines.
        ("q(R, N) :- e(R, _, B), e(R', _, B), m(R', N).", False),
        ("q(R, N) :- m(R, N), not m(_, 7).", False),
        ("q(R, N) :- e(R, _, B), N = #count { R' : e(R', _, B) }.", False),
        ("q(R, N) :- e(R, A, _), N = #count { R' : e(R', A, _) }.", True),
        # What rests on several lines is not to be read of one of them, but of none.
        ("s(B) :- e(_, _, B). q(R, N) :- m(R, N), e(R, _, B), s(B).", False),
        ("s(B) :- e(_, _, B). q(R, N) :- m(R, N).", True),
        ("s(B) :- e(_, _, B). t(B) :- s(B). q(R, N) :- m(R, N), e(R, _, B), not t(B).", False),
        ("s(B) :- p(B, 1). q(R, N) :- m(R, N), e(R, _, B), not s(B).", True),
        # The order of rules makes no difference.
        ("q(R, N) :- e(R, _, B), t(B, N). t(B, N) :- p(B, N).", True),
    ],
)
def test_rules_are_told_to_derive_of_one_part_what_rests_on_it_alone(
    rules: str, is_apart: bool
) -> None:
    assert (seen(rules, "x :- q(R, N).") is not None) == is_apart


@pytest.mark.parametrize(
    ("reading", "terms"),
    [
        ("x :- q(R, N).", (None, None)),
        ("x :- q(R, _).", (None, UNSEEN)),
        ("x :- c, not q(R, _), p(R, _).", (None, UNSEEN)),
        ("x :- q(R, 3).", (None, "3")),
        ("x :- p(R, N), c(R) : q(R, _).", (None, UNSEEN)),
        ("{ x(R) : q(R, _) } :- p(R, N).", (None, UNSEEN)),
        ("x :- 2 <= #count { R : q(R, _) }.", (None, UNSEEN)),
        # Each of these counts by itself.
        ("x :- 2 <= { q(R, _) }.", (None, None)),
        ("x :- 2 <= { c(R) : q(R, _) }.", (None, UNSEEN)),
    ],
)
def test_a_value_without_a_name_is_seen_where_it_counts(
    reading: str, terms: tuple[str | None, ...]
) -> None:
    found = seen("q(R, N) :- m(R, N).", reading)
    assert found == (Seen(Sight(Q, terms), 0, (0,)),)


def test_what_is_about_no_part_looks_at_parts_itself() -> None:
    found = seen("q(R, N) :- m(R, N). s(B) :- e(R, _, B), q(R, 3).", "x :- s(B).")
    assert found is not None
    assert [each.sight for each in found] == [
        Sight(E, (None, UNSEEN, None)),
        Sight(Q, (None, "3")),
    ]
    assert found[0].names == (0, 1, 2)


# ---- Random programs -----------------------------------------------------------------------------

LINES = ("e(R, A, B)", "e(R, A, B)", "e(R, _, B)", "m(R, N)", "e(R', A, _)", "e(R', _, B)")
OTHERS = ("p(A, N)", "p(B, N)", "p(B, _)", "m(R, N)", "not m(R, 1)", "not p(B, 2)", "not m(_, 1)")
COUNTS = ("2 <= #count { X : e(X, _, B) }", "1 <= #count { X : m(R, X) }", "1 <= { e(_, A, X) }")


def random_rules(rng: random.Random) -> str:
    """Return rules that leave nothing open, of which clingo can ground each."""
    rules: list[str] = []
    names = ["q", "r", "s", "t"]
    while len(rules) < len(names):
        name = names[len(rules)]
        known = names[: len(rules)]
        read = [f"{each}({rng.choice('RABN')}, {rng.choice('RBN')})" for each in known]
        body = [*rng.choices(LINES, k=2), rng.choice(OTHERS)]
        body += rng.sample(read, min(len(read), rng.randint(0, 2)))
        body += rng.choices(COUNTS, k=rng.random() < 0.2)
        rule = f"{name}({rng.choice('RRABN')}, {rng.choice('NNB')}) :- {', '.join(body)}."
        if derived(rule, ()) is not None:
            rules.append(rule)
    return "\n".join(rules)


def derived(rules: str, facts: Iterable[str]) -> Set[str] | None:
    control = clingo.Control(["--warn=none"], logger=lambda *_: None)
    try:
        control.add("base", [], "\n".join((rules, *facts)))
        control.ground([("base", [])])
    except RuntimeError:
        return None
    return {str(atom.symbol) for atom in control.symbolic_atoms if atom.is_fact}


def test_what_is_seen_of_a_part_is_what_is_seen_of_it_alone() -> None:
    rng = random.Random(5)
    kept = looked = 0
    for _ in range(200):
        rules = random_rules(rng)
        found = seen(rules, "x :- q(V, W), r(V', W'), s(X, Y), t(X', Y').")
        if found is None:
            continue
        kept += 1
        of_others = [f'p("{rng.choice(("a0", "a1", "b0", "b1"))}",{n}).' for n in range(3)]
        parts = [
            [f'e({10 + n},"a{n}","b{rng.randrange(2)}").', f"m({10 + n},{rng.randrange(3)})."]
            for n in range(3)
        ]
        whole = derived(rules, [*of_others, *(fact for part in parts for fact in part)])
        assert whole is not None
        for number, part in enumerate(parts):
            alone = derived(rules, [*of_others, *part])
            assert alone is not None
            for each in found:
                one, other = (_of(number, each, told) for told in (alone, whole))
                assert one == other, rules
                looked += len(one)
    assert kept > 15
    assert looked > 100


def _of(number: int, each: Seen, told: Set[str]) -> Set[str]:
    """Return the atoms of a part."""
    own = {str(10 + number), f'"a{number}"'}
    symbols = map(clingo.parse_term, told)
    name = each.sight.signature.name
    return {str(s) for s in symbols if s.name == name and str(s.arguments[each.at]) in own}
