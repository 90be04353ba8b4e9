"""Which constraints refuse a candidate in a case."""

from pathlib import Path

from mars_asp.asp.cases.coverage import Case, covered
from tests.support.programs import rulebook_of

#: A candidate is one number; 3 is refused by two constraints, so that neither alone decides.
RULES = """\
1 <= { chosen(N): given(N) } <= 1.
#false :- chosen(1).
#false :- chosen(N); N > 5.
#false :- chosen(3).
#false :- chosen(3); given(3).
#false :- chosen(7); not given(7).
#minimize { N@1: chosen(N) }.
"""


def silent(*cases: str) -> list[str]:
    book = rulebook_of(RULES)
    entries = [
        Case(Path(f"{n}.lp"), (text,), ("base",), lambda _: True) for n, text in enumerate(cases)
    ]
    return [rule.text for rule in covered(book.rules, book, entries).silent]


def test_a_constraint_fires_where_it_alone_refuses_a_candidate() -> None:
    never = ["#false :- chosen(7); not given(7)."]
    twice = ["#false :- chosen(3).", "#false :- chosen(3); given(3)."]
    one, most = "#false :- chosen(1).", "#false :- chosen(N); N > 5."
    assert silent("given(2).") == [one, most, *twice, *never]
    assert silent("given(1..4).") == [most, *twice, *never]
    assert silent("given(2).", "given(2). given(9).") == [one, *twice, *never]
    assert silent("given(1).", "given(6).", "given(3).") == [*twice, *never]


def test_cases_of_other_stages_are_not_run() -> None:
    book = rulebook_of(RULES)
    case = Case(Path("run.lp"), ("given(1..9).",), ("run",), lambda _: True)
    assert len(covered(book.rules, book, [case]).silent) == 5
