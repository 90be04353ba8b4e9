from collections.abc import Iterator

import pytest

from mars_asp.asp.lint.clauses import Clause, clauses_of
from mars_asp.asp.lint.sorts import wrong_values
from mars_asp.asp.lint.values import KnownValue
from mars_asp.asp.rules.read import read_rules
from mars_asp.asp.signature import Signature
from mars_asp.diagnostic import Diagnostic
from tests.support.fixtures import Patch

#: Cities and roads between them.
DECLARED = """\
%*! city(C: city)
C is one.
*%
#defined city/1.
%*! road(R: road, C: city, D: city, K: {paved, gravel})
R leads from C to D.
*%
#defined road/4.
%*! place(X: city | road, L: line)
X stands in line L.
*%
#defined place/2.
"""


def found_in(rules: str, replaced: frozenset[str] = frozenset()) -> list[str]:
    problems: list[Diagnostic] = []
    file = read_rules(DECLARED + rules, "a.lp", "base", problems)
    assert file is not None
    assert not problems
    declared = {each.signature: each for each in file.documented.declarations}
    clauses = [clause for of in clauses_of(file.rules).values() for clause in of]
    known = KnownValue(clauses, declared, {}, replaced)
    found = (each for clause in clauses for each in wrong_values(clause, known, declared))
    first = DECLARED.count("\n")
    entries = {
        f"{each.span.line - first}:{each.span.column} {each.message}"
        for each in (one.diagnostic for one in found)
    }
    return sorted(entries)


@pytest.mark.parametrize(
    "rules",
    [
        "near(C, D) :- road(_, C, D, paved).",
        "told(X) :- place(X, _), city(X).\ntold(X) :- place(X, _), road(X, _, _, _).",
        # What is derived for both is either.
        "thing(X) :- city(X).\nthing(X) :- road(X, _, _, _).\np(X) :- thing(X), road(X, _, _, _).",
        # Each condition has variables of its own.
        "p :- city(X) : city(X); road(X, _, _, _) : road(X, _, _, _).",
        "p(N) :- N = #count { X : city(X) ; X : road(X, _, _, _) }.",
        # What may be of the sort can be negated.
        "thing(X) :- city(X).\nthing(X) :- road(X, _, _, _).\np(X) :- thing(X), not city(X).",
        "{ p(X) : city(X); q(X) : road(X, _, _, _) }.",
        # Computed values and predicates without rules have no known sort.
        "#defined other/1.\np(X) :- city(X), other(X).",
        "q(f(X)) :- city(X).\np(X) :- q(X), road(X, _, _, _).",
        "q(X) :- X = 1..2.\np(X) :- q(X), road(X, _, _, _).",
        # A predicate that reads itself is of what it begins with.
        "on(C) :- city(C).\non(D) :- on(C), road(_, C, D, _).\np(C) :- on(C), city(C).",
    ],
)
def test_values_of_one_sort_are_as_they_should_be(rules: str) -> None:
    assert found_in(rules) == []


@pytest.mark.parametrize(
    ("rules", "problem"),
    [
        ("p(C) :- city(C), road(C, _, _, _).", "1:18 `C` is a city in `city/1` and a road in"),
        ("p :- city(C), #count { D : road(C, _, D, _) } > 1.", "1:28 `C` is a city in `city/1`"),
        ("q(R) :- road(R, _, _, _).\np(R) :- q(R), city(R).", "2:15 `R` is a road in `q/1` and"),
        (
            "q(R) :- road(R, _, _, _).\nr(R) :- q(R).\nq(R) :- r(R).\np(R) :- r(R), city(R).",
            "4:15 `R` is a road in `r/1` and a city in `city/1`",
        ),
        ("p(L) :- place(_, L), city(L).", "1:22 `L` is a line in `place/2` and a city in"),
        ("p(C) :- road(_, C, _, dirt).", "1:23 `K` of `road/4` is never `dirt`"),
        ("{ road(C, D, D, paved) : city(D) } :- city(C).", "1:3 `C` is a city, and the head gives"),
        # A negated literal that never holds is always true.
        ("p(C) :- city(C), not road(C, _, _, _).", "1:18 `C` is a city, and never a road, as in"),
        ("p :- city(C), road(C, D, D, _) : city(D).", "1:15 `C` is a city, and never a road, as"),
    ],
)
def test_a_value_of_two_sorts_is_reported(rules: str, problem: str) -> None:
    (result,) = found_in(rules)
    assert result.startswith(problem)


def test_a_constant_that_is_replaced_may_be_any() -> None:
    assert found_in("p(C) :- road(_, C, _, dirt).", frozenset({"dirt"})) == []


def test_a_long_chain_of_rules_takes_no_square_of_steps(monkeypatch: Patch) -> None:
    count = 300
    chain = [f"p{n}(X) :- p{n - 1}(X)." for n in range(count, 0, -1)]
    steps: list[Clause] = []
    own = KnownValue._handed_on

    def counted(known: KnownValue, clause: Clause) -> Iterator[Signature]:
        steps.append(clause)
        return own(known, clause)

    monkeypatch.setattr(KnownValue, "_handed_on", counted)
    assert found_in("\n".join([*chain, "p0(X) :- city(X)."])) == []
    assert len(steps) < 4 * count
