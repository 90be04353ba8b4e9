"""Why an atom is absent: the nearest instance of each rule and the premise that fails."""

import clingo
import pytest

from mars_asp.asp.trace import NearMiss, Underivable
from mars_asp.asp.trace.absence import explain_absence
from mars_asp.asp.trace.patterns import hole
from tests.support.programs import explainer_of


def attempts(program: str, atom: str) -> list[NearMiss]:
    found = explainer_of(program)
    assert found is not None
    trace = explain_absence(found[0], clingo.parse_term(atom), 9)
    assert isinstance(trace, Underivable)
    return list(trace.attempts)


@pytest.mark.parametrize(
    ("program", "fails", "cause", "value"),
    [
        ("q(1..3). p(X) :- q(X), r(X).", "r(X)", "r(5)", None),
        ("q(5). r(5). p(X) :- q(X), not r(X).", "not r(X)", "r(5)", None),
        ("q(5). r(7). p(X) :- q(X), not not r(X).", "not not r(X)", "r(5)", None),
        ("q(5). p(X) :- q(X), X > 7.", "X > 7", None, None),
        ("q(4). p(X + 1) :- q(X), r(X, Y).", "r(X,Y)", "r(4,Y)", None),
        ("q(5). s(1..2). p(X) :- q(X), 3 <= #count { Y : s(Y) }.", None, None, "2"),
        ("q(5). s(1..2). p(X) :- q(X), 3 { s(Y) }.", None, None, "2"),
        ("q(5). s(1..2). p(X) :- q(X), #sum { Y : s(Y) } < 3.", None, None, "3"),
        ("q(5). s(1..2). t(1). p(X) :- q(X), t(Y) : s(Y).", "t(Y): s(Y)", "t(2)", None),
        ("q(5). p(X) :- q(X), r(1..2).", "r((1..2))", "r(1)", None),
        ("q(5). p(X) :- q(X), r(f(X, Y), _).", "r(f(X,Y),_)", "r(f(5,Y),_)", None),
        ("q(5). { p(X) } :- q(X), r(X).", "r(X)", "r(5)", None),
        ("q(5). { p(X) : r(X) } :- q(X).", "r(X)", "r(5)", None),
        ("q(5). { p(X) } :- q(X). :- p(X).", None, None, None),
        # Of several it is the least, in whatever order they are given.
        ("q(5). s(3). s(1..2). p(X) :- q(X), t(Y) : s(Y).", "t(Y): s(Y)", "t(1)", None),
        ("q(5). s(3). s(1..2). p(X) :- q(X), not s(Y) : s(Y).", "not s(Y): s(Y)", "s(1)", None),
        ("q(5). s(3). s(1..2). p(X) :- q(X), not s(_).", "not s(_)", "s(1)", None),
        ("q(5). s(3). s(1..2). p(X) :- q(X), t(Y,_) : s(Y).", "t(Y,_): s(Y)", "t(1,_)", None),
        ("q(5). s(1). p(X) :- q(X), t((1;2)) : s(Y).", "t(1): s(Y)", "t(1)", None),
        ("q(5). s(1). { u }. :- u. p(X) :- q(X), u : s(Y).", "u: s(Y)", "u", None),
        ("q(5). s(1). { u }. :- not u. p(X) :- q(X), not u : s(Y).", "not u: s(Y)", "u", None),
        ("q(5). s(1). p(X) :- q(X), t(Y,Z) : s(Y).", "t(Y,Z): s(Y)", None, None),
        # What computes with a constant has no value, so that nothing satisfies it.
        ("q(5,a). p(X) :- q(X,Y), r(Y + 1).", "r((Y+1))", None, None),
        ("q(5,a). p(X) :- q(X,Y), not r(Y + 1).", "not r((Y+1))", None, None),
        ("q(5,a). p(X) :- q(X,Y), s(Z) : r(Z); r(Y + 1).", "r((Y+1))", None, None),
        ("q(5). s(1). p(X) :- q(X), t(2 * Y + 1), s(Y).", "t(((2*Y)+1))", "t(3)", None),
        ("q(5). s(1). t(3). p(X) :- q(X), t(2 * Y + 1), r(Y).", "r(Y)", "r(Y)", None),
        ("q(5). s(1). p(X) :- q(X), s(Z), t(1 - Y * 2).", "t((1-(Y*2)))", "t((1-(Y*2)))", None),
    ],
)
def test_the_failing_literal_has_its_cause_and_value(
    program: str, fails: str | None, cause: str | None, value: str | None
) -> None:
    (attempt,) = attempts(program, "p(5)")
    if fails is not None:
        assert attempt.fails == fails
    assert (None if attempt.cause is None else attempt.cause.atom) == cause
    assert (None if attempt.value is None else str(attempt.value)) == value


def test_a_premise_alone_is_nearer_than_two() -> None:
    (attempt,) = attempts("q(5,1..2). r(2). s(3). p(X) :- q(X,Y), r(Y), s(Y).", "p(5)")
    assert attempt.fails == "s(Y)"
    assert attempt.cause is not None
    assert attempt.cause.atom == "s(2)"


def test_absence_is_followed_through_rules_and_ends_where_it_turns_in_a_circle() -> None:
    (attempt,) = attempts("p(X) :- q(X). q(X) :- r(X). r(X) :- p(X).", "p(1)")
    names = []
    cause = attempt.cause
    while isinstance(cause, Underivable):
        names.append(cause.atom)
        cause = cause.attempts[0].cause
    assert names == ["q(1)", "r(1)"]
    assert cause is not None
    assert cause.atom == "p(1)"


def test_holes_of_one_name_are_one_value() -> None:
    found = explainer_of("q(1,2). p(X,Y) :- q(X,Y).")
    assert found is not None
    trace = explain_absence(found[0], clingo.Function("p", [hole("X"), hole("X")]), 3)
    assert isinstance(trace, Underivable)
    assert trace.attempts[0].fails == "X = Y"
