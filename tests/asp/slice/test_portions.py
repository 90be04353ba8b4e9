"""Whether rules keep parts apart: then the answers of the parts are those of the whole."""

import random
import re
from collections.abc import Iterable, Sequence
from itertools import product

import clingo
import pytest

from mars_asp.asp.signature import Signature
from mars_asp.asp.slice.portions import kept_apart

#: `e(R,A,B)` connects A and B by R; what `p` and `c` say of anything connects nothing.
GIVEN = {Signature("e", 3): (0, 1, 2), Signature("p", 2): (0,), Signature("c", 1): ()}


@pytest.mark.parametrize(
    ("rules", "is_apart"),
    [
        ("q(A) :- e(R, A, B).", True),
        ("q(A, B) :- e(R, A, B), p(B, N).", True),
        ("q(f(A), N) :- p(A, N). t(X) :- q(X, N), q(X, M), N < M.", True),
        # Two parts in one instance.
        ("q(A, B) :- p(A, N), p(B, N).", False),
        ("q(A) :- p(A, N), not e(_, A, _).", True),
        ("q(A) :- p(A, N), not e(_, _, _).", False),
        ("q(A) :- p(A, N). :- q(A), q(B), A != B.", False),
        # A value is no link where it is not said whose it is.
        ("q(N) :- p(A, N). t(N) :- q(N).", False),
        ("q(N, A) :- p(A, N). t(A, B) :- q(N, A), q(N, B).", False),
        # The number of a line is not the number that a fact states.
        ("q(A) :- e(R, A, B), p(C, R).", False),
        # Aggregates and conditions reach no further than their rule.
        ("q(A, N) :- p(A, _), N = #count { M : p(A, M) }.", True),
        ("q(A, N) :- p(A, _), N = #count { M : p(_, M) }.", False),
        ("q(A) :- p(A, _), p(B, N) : e(_, A, B), p(A, N).", True),
        ("q(A) :- p(A, _), p(B, N) : p(B, N).", False),
        # The least of tuples is one of them, the least of values may be none.
        (
            "q(A, B) :- p(A, _), (B, N) = #min { (C, M) : e(_, A, C), p(C, M) }. t(B) :- q(A, B).",
            True,
        ),
        ("q(A) :- p(A, _). t(A) :- q(A), B = #min { C : e(_, A, C) }, q(B).", False),
        # What belongs to nobody is the same everywhere only if nobody decides it.
        ("s :- c(N). q(A) :- p(A, N), s.", True),
        ("{ s } :- c(N). q(A) :- p(A, N), s.", False),
        ("s :- p(A, N). q(A) :- e(R, A, B), not s.", False),
        ("q(A, ()) :- p(A, _). q(A, (B, L)) :- q(A, L), e(_, A, B). t(L) :- q(A, L).", False),
        ("q(A, (A, ())) :- p(A, _). q(A, (B, L)) :- q(A, L), e(_, A, B). t(L) :- q(A, L).", True),
        ("{ q(A) } :- p(A, N). #minimize { 1@1, A : q(A) }.", True),
        ("{ q(A) } :- p(A, N). #minimize { 1@1 : q(A) }.", False),
        ("{ q(A) } :- p(A, N). #minimize { N@1, N : q(A), p(A, N) }.", False),
        ("{ q(A) } :- p(A, N). #minimize { 1@1, A, x : q(A); 1@1, x, A : q(A) }.", False),
        # Sorts of statements that are not known are not taken for granted.
        ("q(A) :- p(A, N). #external q(A) : p(A, N).", False),
        ("q(A) ; t(A) :- p(A, N).", False),
    ],
)
def test_rules_are_told_to_keep_parts_apart(rules: str, is_apart: bool) -> None:
    assert (kept_apart("", rules, GIVEN) is not None) == is_apart


@pytest.mark.parametrize(
    ("rules", "settled"),
    [
        ("q(A) :- p(A, N). r(A) :- q(A).", "qr"),
        ("q(A) :- p(A, N). q(B) :- q(A), e(_, A, B).", "q"),
        ("q(A) :- p(A, N). { r(A) } :- q(A). s(A) :- r(A). t(A) :- q(A), not s(A).", "q"),
        ("q(A) :- p(A, N). r(A) :- p(A, N), not q(A). { s(A) } :- r(A).", "qr"),
        ("q(A) :- p(A, N), not r(A). r(A) :- p(A, N), not q(A).", ""),
        ("q(A) :- p(A, N), not not q(A). r(A) :- q(A). s(A) :- p(A, N).", "s"),
        ("q(A) :- p(A, N). r(A) :- p(A, N), 2 { q(A) }. s(A) :- p(A, N), 1 { s(A) }.", "qr"),
        ("q(A) :- p(A, N). { q(A) } :- p(A, N). r(A) :- p(A, N), p(A, M) : q(A).", ""),
        ("{ q(A) } :- p(A, N). r(A) :- p(A, N), #count { B : q(B), e(_, A, B) } > 1.", ""),
    ],
)
def test_what_no_choice_has_an_influence_on_is_settled(rules: str, settled: str) -> None:
    apart = kept_apart("", rules, GIVEN)
    assert apart is not None
    assert "".join(sorted(set(re.findall(r"^(\w)", apart.whole.settled, re.MULTILINE)))) == settled


# ---- Random programs -----------------------------------------------------------------------------

DERIVED = {"q": 1, "r": 2, "s": 1, "t": 2}
POSITIVE = ("e(R, {0}, {1})", "e(_, {0}, {1})", "p({0}, N)", "p({0}, _)", "e(_, {0}, _)")


def random_rule(rng: random.Random, known: Sequence[str]) -> str:
    """Return a rule that may read derived predicates that are `known`; most are about one part."""

    def variable() -> str:
        return rng.choice("AAAABBBC")

    def atom(name: str) -> str:
        first = rng.choice(["A", "A", "B", "f(A)", variable(), f"f({variable()})"])
        second = rng.choice(["A", "B", "N", f"f({variable()})"])
        return f"{name}({', '.join((first, second)[: DERIVED[name]])})"

    body = [rng.choice(["e(R, A, B), p(A, N)", "e(_, A, B), p(B, N)", "p(A, N), e(_, B, A)"])]
    body += [rng.choice(POSITIVE).format(variable(), variable()) for _ in range(rng.randint(0, 1))]
    body += [atom(rng.choice(known)) for _ in range(rng.randint(0, 2)) if known]
    if known and rng.random() < 0.3:
        body.append(f"not {atom(rng.choice(known))}")
    if rng.random() < 0.2:
        body.append(f"2 <= #count {{ X : {rng.choice(POSITIVE).format(variable(), 'X')} }}")
    if rng.random() < 0.2:
        body.append(f"(C, D) = #max {{ (X, Y) : e(Y, {variable()}, X) }}")
    head = atom(rng.choice([*DERIVED]))
    if rng.random() < 0.3:
        head = f"{{ {head} }}"
    elif rng.random() < 0.1:
        head = ""
    return f"{head} :- {', '.join(body)}."


def random_program(rng: random.Random) -> str:
    """Return a program that clingo can ground."""
    rules: list[str] = []
    while len(rules) < 4:
        known = [name for name in DERIVED if any(f"{name}(" in r.split(":-")[0] for r in rules)]
        rule = random_rule(rng, known)
        try:
            control = clingo.Control(["--warn=none"], logger=lambda *_: None)
            control.add("base", [], rule)
            control.ground([("base", [])])
        except RuntimeError:
            continue
        rules.append(rule)
    return "\n".join(rules)


def random_part(rng: random.Random, number: int) -> str:
    """Return the facts of one part; its lines have numbers that are values in others, too."""
    names = [f'"{letter}{number}"' for letter in "abc"]
    lines = [2 * number, 2 * number + 1]
    facts = [f"e({line},{rng.choice(names)},{rng.choice(names)})." for line in lines]
    facts += [f"e({lines[0]},{names[0]},{names[1]})."]
    facts += [f"p({rng.choice(names)},{rng.randint(0, 3)})." for _ in range(2)]
    return " ".join(facts)


def answers(program: str) -> set[frozenset[str]] | None:
    """Return the answer sets, without those of too many."""
    control = clingo.Control(["--models=200", "--warn=none"])
    control.add("base", [], program)
    control.ground([("base", [])])
    found: set[frozenset[str]] = set()
    result = control.solve(
        on_model=lambda model: found.add(frozenset(map(str, model.symbols(atoms=True))))
    )
    return found if result.exhausted else None


def compare_program(seed: int) -> bool | None:
    """Say whether the answers of the whole are those of its parts; `None` where they may not be."""
    rng = random.Random(seed)
    program = random_program(rng)
    apart = kept_apart("", program, GIVEN)
    if apart is None:
        return None
    parts = [random_part(rng, number) for number in range(2)]
    common = "c(1)."
    whole = answers("\n".join((program, common, *parts)))
    each = [answers("\n".join((program, common, part))) for part in parts]
    if whole is None or None in each:
        return None
    together = {one | other for one, other in product(*(found or () for found in each))}
    settled = answers("\n".join((apart.whole.settled, common, *parts)))
    split = "\n".join((apart.whole.settled, apart.whole.choosing, common, *parts))
    sure = frozenset.intersection(*whole) if whole else None
    return (
        whole == together == answers(split)
        and settled is not None
        and len(settled) == 1
        and (sure is None or next(iter(settled)) <= sure)
    )


def test_parts_of_random_programs_have_the_answers_of_the_whole() -> None:
    results = [compare_program(seed) for seed in range(100)]
    assert False not in results
    assert results.count(True) > 30


# ---- What is needed everywhere -------------------------------------------------------------------

READ = (
    "e(R, A, B)",
    "e(_, A, _)",
    "p(A, N)",
    "p(_, N)",
    "p(B, _)",
    "p(B, N)",
    "e(_, _, B)",
    "c(N)",
)
COUNTED = ("X, Y : p(X, Y)", "Y : p(_, Y)", "X : p(X, _)", "X : p(X, _), e(_, _, X)")
MADE = {"q": ("A", "N"), "r": ("N",), "s": ("A",), "t": ("B", "A")}


def random_base(rng: random.Random) -> str:
    """Return rules that leave nothing open, each of which may read what earlier ones derive."""
    known: list[str] = []
    rules = []
    for name in rng.sample([*MADE], 4):
        head = f"{name}({', '.join(MADE[name])})"
        body = rng.sample([*READ, *known], 2)
        if rng.random() < 0.3:
            body.append(f"N = #count {{ {rng.choice(COUNTED)} }}")
        missing = [v for v in MADE[name] if not any(v in atom for atom in body)]
        body += {"A": ["p(A, _)"], "B": ["p(B, _)"], "N": ["p(_, N)"]}.get("".join(missing), [])
        if len(missing) < 2:
            rules.append(f"{head} :- {', '.join(body)}.")
            known.append(head)
    return "\n".join(rules)


def facts_of(part: str) -> list[tuple[str, tuple[str, ...]]]:
    """Return the predicates and arguments of facts."""
    told = (fact.strip("() ").partition("(") for fact in part.split("."))
    return [(name, tuple(inside.split(","))) for name, _, inside in told if name]


def compare_base(seed: int) -> bool | None:
    """Say whether a part has of a base what the whole has of it, with what it needs of others."""
    rng = random.Random(seed)
    base = random_base(rng)
    apart = kept_apart(base, "x(A) :- p(A, N).", GIVEN)
    if apart is None:
        return None
    own, *others = (random_part(rng, number) for number in range(3))
    alike: dict[tuple[str, tuple[str, ...]], str] = {}
    for name, told in facts_of(" ".join((own, *others))):
        looked = apart.everywhere.get(Signature(name, len(told)))
        if looked is not None:
            seen = name, tuple(told[at] for at in looked)
            alike.setdefault(seen, f"{name}({','.join(told)}).")
    whole, part = (
        answers("\n".join((base, own, *more))) or set() for more in (others, alike.values())
    )
    names, lines = re.compile(r'"[abc][12]"'), re.compile(r"^[ep]\(")

    def about_it(found: Iterable[frozenset[str]]) -> list[set[str]]:
        return [{x for x in each if not names.search(x) and not lines.search(x)} for each in found]

    return about_it(whole) == about_it(part) != []


def test_a_part_needs_of_others_one_fact_of_those_that_look_alike() -> None:
    results = [compare_base(seed) for seed in range(300)]
    assert False not in results
    assert results.count(True) > 100


def test_what_no_rule_looks_at_makes_no_difference() -> None:
    apart = kept_apart("q(A) :- p(A, N), p(_, M), M < N.", "x(A) :- q(A).", GIVEN)
    assert apart is not None
    assert apart.everywhere == {Signature("p", 2): (0, 1)}
    apart = kept_apart("r(N) :- p(_, N).", "x(A) :- p(A, N), r(N).", GIVEN)
    assert apart is not None
    assert apart.everywhere == {Signature("p", 2): (1,)}
