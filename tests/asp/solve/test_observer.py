"""Both ways to record a ground program note the same."""

import clingo
import pytest

from mars_asp.asp.solve.observer import Recorded, plain_record, raw_recorder
from tests.support.fixtures import Patch

BEFORE = "a(1..3). {b(X)} :- a(X)."
PROGRAM = """
fact(7). c(X) :- b(X), not d. {d}. :- b(1), b(2). :- not b(3), d.
x | y :- b(2). 1 { pick(X) : a(X) } 2 :- d. wide :- 3 #sum { X : b(X) }. sure :- 0 { b(X) }.
#minimize { X@2 : b(X) }. :~ d. [-1@1] #project c/1.
"""


def recorded(record: object) -> Recorded:
    assert callable(record)
    control = clingo.Control()
    control.add("base", [], BEFORE)
    control.ground()
    noted = record(control)
    assert isinstance(noted, Recorded)
    control.add("more", [], PROGRAM)
    control.ground([("more", [])])
    return noted


def rules(noted: Recorded) -> list[tuple[int, ...]]:
    """Return the rules, sorted; rules with weight bodies are recorded separately."""
    found, at = [], 0
    while at < len(noted.rules):
        _, heads, bodies, _ = noted.rules[at : at + 4]
        end = at + 4 + heads + bodies
        found.append(tuple(noted.rules[at:end]))
        at = end
    return sorted(found)


def test_both_recorders_note_the_same() -> None:
    raw_record = raw_recorder()
    # Where this fails, another clingo was installed, and all works on, more slowly.
    assert raw_record is not None
    raw, plain = recorded(raw_record), recorded(plain_record)
    assert rules(raw) == rules(plain)
    assert (raw.facts, raw.costs, raw.projected) == (plain.facts, plain.costs, plain.projected)
    shapes = {(choice, heads, bound > 0) for choice, heads, _, bound in (r[:4] for r in rules(raw))}
    assert {(0, 0, False), (0, 2, False), (1, 1, False), (0, 1, True)} <= shapes
    assert len(raw.projected) == len(raw.costs) - 1 == 3
    assert len(raw.facts) == 2


def test_an_exception_in_a_recorder_is_raised_by_the_call_of_clingo(
    monkeypatch: Patch,
) -> None:
    class Full(list[int]):
        def extend(self, *_: object) -> None:
            raise KeyboardInterrupt

    def full() -> Recorded:
        return Recorded(rules=Full())  # type: ignore[arg-type]

    monkeypatch.setattr("mars_asp.asp.solve.observer.Recorded", full)
    for record in (raw_recorder(), plain_record):
        with pytest.raises(KeyboardInterrupt):
            recorded(record)
