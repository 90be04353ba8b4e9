"""Firings that count over the same elements share them, and each has its own premises."""

import random
import time

import clingo
import pytest

from mars_asp.asp.trace import Derived, Underivable, explainer
from mars_asp.asp.trace.absence import explain_absence
from mars_asp.asp.trace.firings import Firing, read_firings
from tests.asp.trace.test_explainer import wrong_derivations, wrong_explanations
from tests.support.fixtures import Patch
from tests.support.programs import explainer_of
from tests.support.trace_checker import faults

_A = clingo.Function("a")

#: `v` is derived, so that elements have premises to wait for; `w` is given.
_VALUES = "v(X) :- w(X). w(1..{size}). "
_BODIES = [
    "v(_), 2 <= #count {{ X : v(X) }}.",
    "v(_), N = #count {{ X : v(X) }}.",
    "v(_), {size} <= #sum {{ X : v(X) }}.",
    "v(_), N = #sum {{ X : v(X) }}.",
    "v(_), #sum {{ 2 - X,X : v(X) }} < 2.",
    "v(_), #min {{ X : v(X) }} <= 2.",
    "v(_), N = #min {{ X : v(X) }}.",
    "v(_), {size} <= #max {{ X : v(X) }}.",
    "v(_), N = #max {{ X : v(X) }}.",
    "v(_), 2 {{ v(X) }}.",
    "v(_), {{ v(X) : w(X) }} {size}.",
    "v(_), v(X) : w(X).",
    "v(_), not v(-X) : w(X).",
    "v(Y), N = 2..3, N <= #count {{ X : v(X), X <= Y }}.",
    "w(N), N - 1 <= #count {{ X : v(X) }}, #count {{ X : v(X) }} > 1.",
    "v(_), 1..2 <= #count {{ X : v(X) }}.",
    "v(_), w((1;2)), (2;{size}) <= #count {{ X : v(X), X != (1;2) }}.",
    "w((X;Y)), X = 1..2, Y = 1..2, 1 <= #count {{ Z : v(Z), Z != X }}.",
]
#: More elements are reached through the aggregate itself; firings differ in their bounds.
_RECURSIVE = [
    "on(1..2). on(X) :- w(X), w(_), 2 <= #count {{ Y : on(Y) }}. a :- on({size}).",
    "on(1). on(X) :- w(X), w(_), X - 1 <= #count {{ Y : on(Y) }}. a :- on({size}).",
    "on(1). on(X) :- w(X), w(_), X - 1 <= #sum {{ Y : on(Y) }}. a :- on({size}).",
    "on(1). on(X) :- w(X), w(_), X - 1 <= #max {{ Y : on(Y) }}. a :- on({size}).",
    "on({size}). on(X) :- w(X), w(_), #min {{ Y : on(Y) }} <= X + 1. a :- on(1).",
    "on({size}). on(X) :- w(X), w(_), #min {{ Y : on(Y) }} < X + 2. a :- on(1).",
    "on(1). on(X) :- w(X), w(_), 2 <= #count {{ Y : on(Y) }}. on(2) :- on(1). a :- on({size}).",
    "on(1). on(X) :- w(X), w(_), on(Y) : w(Y), Y < X. a :- on({size}).",
]
_PROGRAMS = [f"a :- {body}" for body in _BODIES] + _RECURSIVE


@pytest.mark.parametrize("program", _PROGRAMS)
def test_traces_are_true_and_none_is_missing(program: str) -> None:
    text = (program + _VALUES).format(size=4)
    assert wrong_explanations(text, (), random.Random(1)) == []
    assert wrong_derivations(text, ()) == []


@pytest.mark.parametrize("program", [f"a :- {body}" for body in _BODIES if "v(_)" in body])
def test_counted_elements_are_found_once_for_all_firings(program: str, monkeypatch: Patch) -> None:
    sizes: list[int] = []

    def read(control: clingo.Control, question: int) -> list[Firing]:
        sizes.append(len(control.symbolic_atoms))
        return read_firings(control, question)

    monkeypatch.setattr(explainer, "read_firings", read)
    for size in (10, 20):
        found = explainer_of((program + _VALUES).format(size=size))
        assert found is not None
        trace = found[0].why([_A])[_A]
        assert isinstance(trace, Derived)
    assert sizes[1] <= 2 * sizes[0]


#: Bodies that fail for each value and each element, by the obstacle to sharing these failures.
_FAILING = [
    "v(_), u(X) : w(X).",
    "v(Y), u(X) : w(X).",
    "v(_), not v(X) : w(X).",
    "v(Y), u(X) : w(X), X < Y + {size}, w(1).",
    "v(_), w(_), u(X) : w(X).",
    "v(_), w(_), u.",
    "v(Y), not w(_).",
    "v(Y), u(X) : w(X); 2 <= #count {{ X : v(X) }}.",
    "v(Y), v(X) : w(X); u(X) : w(X).",
]


@pytest.mark.parametrize("body", _FAILING)
def test_the_failing_literal_is_found_once_for_all_values(body: str, monkeypatch: Patch) -> None:
    sizes: list[int] = []

    def read(control: clingo.Control, question: int) -> list[Firing]:
        if question == 1:
            sizes.append(len(control.symbolic_atoms))
        return read_firings(control, question)

    monkeypatch.setattr(explainer, "read_firings", read)
    for size in (10, 20):
        found = explainer_of((f"a :- {body}" + _VALUES).format(size=size))
        assert found is not None
        assert isinstance(explain_absence(found[0], _A, 1), Underivable)
    assert sizes[1] <= 2 * sizes[0]


def test_a_count_is_tested_once_for_all_values() -> None:
    seconds = [min(_seconds_of_why_not(size) for _ in range(3)) for size in (500, 2000)]
    # Four times as much where growth is linear, 16 times where each value counts anew.
    assert seconds[1] < 8 * seconds[0]


def _seconds_of_why_not(size: int) -> float:
    """Return the processor time of asking why a rule does not hold that counts beside a value."""
    body = "v(Y), {size} - 1 <= #count {{ X : v(X) }}, u(X) : w(X)."
    found = explainer_of((f"a :- {body}" + _VALUES).format(size=size))
    assert found is not None
    begin = time.process_time()
    assert isinstance(explain_absence(found[0], _A, 1), Underivable)
    return time.process_time() - begin


@pytest.mark.parametrize(
    ("body", "value"),
    [
        ("v(_), {size} < #count {{ X : v(X) }}.", "4"),
        ("v(_), #sum {{ X : v(X) }} < {size}.", "10"),
        ("v(_), 1 < #min {{ X : v(X) }}.", "1"),
        ("v(_), {{ v(X) }} 3.", "4"),
        ("v(_), v(X+1) : w(X).", None),
        ("v(_), 2 <= #count {{ X : v(X) }}, not v(1).", None),
    ],
)
def test_a_literal_that_fails_for_several_values_is_reported_once(
    body: str, value: str | None
) -> None:
    text = (f"a :- {body}" + _VALUES).format(size=4)
    found = explainer_of(text)
    assert found is not None
    missing = explain_absence(found[0], _A, 9)
    assert isinstance(missing, Underivable)
    (attempt,) = missing.attempts
    assert attempt.value == (None if value is None else clingo.parse_term(value))
    assert faults([missing], frozenset(), found[1]) == []
