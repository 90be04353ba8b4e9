"""The sentences of declarations for facts and absences, and the leaves rendered with them."""

import textwrap

import clingo
import pytest

from mars_asp.asp.program import Program
from mars_asp.asp.rules.declarations import declarations, docstrings
from mars_asp.asp.rules.statements import pieces
from mars_asp.asp.rules.symbols import term_of
from mars_asp.asp.solve.atoms import Atom, Fact
from mars_asp.asp.trace.sentences import Sentences
from mars_asp.asp.trace.text import traces_text
from mars_asp.diagnostic import Span

DECLARED = """\
%*! wants(R: line, C: thing, S: thing)
says: `{C}` wants `{S}`
unless: `{C}` does not want `{S}`
unless: `{C}` wants nothing
from: stated
*%
%*! rate(R: line, F: millihertz)
says: `{wants.C}` wants `{wants.S}` at
  {F}
says: a line states {F}
unless: `{wants.C}` states no rate
from: stated
orders: F
*%
%*! spelt(S: thing, T: text)
from: stated
cited: never
*%
%*! far(S: thing, L: micrometres, K: {very_near, away})
says: `{S}` is {L} {K}
from: computed
*%
%*! seen(S: thing, T: instant)
says: `{S}` was seen
from: observed
*%
"""


def atom(text: str) -> Atom:
    found = term_of(clingo.parse_term(text))
    assert isinstance(found, Atom)
    return found


def sentences(*facts: str) -> Sentences:
    place = Span("c", 1, 1, 1, 1)
    given: dict[str, list[Fact]] = {}
    for fact in map(atom, facts):
        given.setdefault(fact.name, []).append(Fact(fact, place))
    declared = declarations(docstrings(pieces(DECLARED)), "a.lp", [])
    return Sentences({each.signature: each for each in declared}, given)


@pytest.mark.parametrize(
    ("fact", "expected"),
    [
        ('wants(1,"A","B")', "`A` wants `B`"),
        ("rate(1,12500)", "`A` wants `B` at 12.5 Hz"),
        ("rate(2,7000)", "a line states 7 Hz"),
        ('far("B",350000,very_near)', "`B` is 350 mm very near"),
        ('spelt("B","b")', None),
        ('unknown("B")', None),
        ('wants(1,"A")', None),
    ],
)
def test_a_fact_is_rendered_by_the_first_form_that_can_be_filled(
    fact: str, expected: str | None
) -> None:
    result = sentences('wants(1,"A","B")').says(atom(fact))
    assert (result.sentence if result else None) == expected


@pytest.mark.parametrize(
    ("pattern", "expected"),
    [
        ('wants(_any("_"),"A","B")', "`A` does not want `B`"),
        ('wants(_any("_"),"A",_any("X"))', "`A` wants nothing"),
        ('wants(_any("_"),_any("_"),"B")', None),
        ('rate(1,_any("_"))', "`A` states no rate"),
        ('rate(2,_any("_"))', None),
    ],
)
def test_an_absence_is_rendered_without_its_unbound_arguments(
    pattern: str, expected: str | None
) -> None:
    assert sentences('wants(1,"A","B")').unless(atom(pattern)) == expected


def test_a_number_orders_atoms_about_the_same_thing() -> None:
    result = sentences('wants(1,"A","B")', "rate(1,12500)")
    ranks = [result.rank(atom(each)) for each in ('wants(1,"A","B")', 'wants(2,"A","B")', "x(1)")]
    assert ranks == [12500, None, None]


def test_leaves_are_rendered_with_facts_sources_and_meaning() -> None:
    rules = """\
wants(1,"A","B"). rate(1,500).
wants(2,"C","B").
wants(3,"D","B"). rate(3,9000).
far("B",2500,away).
seen("B",1250).
spelt("B","b").
%! because: {N} want `{S}`
many(S) :- thing(S), N = #count { R : wanted(R,S) }, far(S,_,_), seen(S,_), not odd(S).
thing(S) :- spelt(S,_).
%! because: `{C}` wants `{S}`
wanted(R,S) :- wants(R,C,S).
odd(S) :- rate(R,1), wants(R,_,S).
"""
    program = Program.from_text(f"{DECLARED}{rules}", "c.lp")
    trace = program.solve().why('many("B")').trace
    lines = traces_text([("many", trace)], program.line_at)
    expected = """\
many
    3 want `B`  [c:34]
        `B` is 2.5 mm away  (computed from c.lp:30)
        `B` was seen  (observed at 1.25 s)
        `D` wants `B`  [c:37]
            c.lp:29  wants(3,"D","B"). rate(3,9000).
        `A` wants `B`  [c:37]
            c.lp:27  wants(1,"A","B"). rate(1,500).
        `C` wants `B`  [c:37]
            c.lp:28  wants(2,"C","B").
"""
    assert "\n".join(lines) == textwrap.dedent(expected).rstrip("\n")


def test_children_are_indented_more_than_continuation_lines() -> None:
    chain = "\n".join(f"%! because: {'step ' * 30}\np{n + 1} :- p{n}." for n in range(4))
    answer = Program.from_text(f"p0.\n{chain}", "c.lp").solve()
    lines = list(traces_text([("p4", answer.why("p4").trace)], lambda span: "p0.", depth=None))
    starts = [len(line) - len(line.lstrip()) for line in lines]
    first = [at for at, line in zip(starts, lines, strict=True) if line.strip().startswith("step")]
    assert max(map(len, lines)) <= 80
    assert sorted(set(first)) == [4, 6, 8, 10, 12, 14, 16, 18]
    assert all(not line.strip().startswith("[") for line in lines)
