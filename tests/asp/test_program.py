"""The engine's face, on programs of other fields."""

import random
import subprocess
import sys
from itertools import islice
from pathlib import Path

import clingo
import pytest

from mars_asp import MarsError, asp
from mars_asp.asp.trace.tree import Derived, Missing
from tests.support.documents import ROOT
from tests.support.random_programs import ATOMS, random_program
from tests.support.trace_checker import faults

EXAMPLES = ROOT / "examples" / "engine"
COLOURING = """
#const n = 3.
colour(1..n).
edge(1,2;2,3;3,1;3,4).
node(1..4). node(9).
1 { has(X,C) : colour(C) } 1 :- node(X).
:- edge(X,Y), has(X,C), has(Y,C).
#minimize { C,X : has(X,C) }.
"""
MOST_ANSWERS = 200


def of(name: str) -> asp.Program:
    return asp.Program.from_files(EXAMPLES / f"{name}.lp")


def test_the_engine_loads_nothing_of_mars() -> None:
    code = (
        "import sys; from mars_asp import asp; asp.Program\n"
        "print([m for m in sys.modules if m.startswith('mars_asp') and '.asp' not in m])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    loaded = "['mars_asp', 'mars_asp.diagnostic', 'mars_asp.reading', 'mars_asp.spelling']\n"
    assert done.stdout == loaded


def test_a_reason_goes_down_to_the_facts_of_the_file() -> None:
    reason = of("reachability").solve().why("reach(d)")
    assert isinstance(reason.trace, Derived)
    assert reason.height == 4
    places = [(leaf.atom, leaf.span and leaf.span.line, leaf.span and leaf.span.column) for leaf in
              reason.leaves()]  # fmt: skip
    assert places == [
        ("start(a)", 1, 1),
        ("edge(a,b)", 2, 1),
        ("edge(b,c)", 2, 12),
        ("edge(c,d)", 2, 23),
    ]
    json = reason.json()
    assert (json["atom"], json["kind"]) == ("reach(d)", "derived")


def test_every_derivation_is_told() -> None:
    reason = of("reachability").solve().why("reach(b)", every=True)
    assert isinstance(reason.trace, Derived)
    # There is the edge from `d`, too, but `d` is reached through `b` alone.
    assert len(reason.trace.others) == 0
    text = "p(1). p(2). q :- p(X)."
    trace = asp.Program.from_text(text).solve().why("q", every=True).trace
    assert isinstance(trace, Derived)
    assert len(trace.others) == 1


def test_a_text_has_the_width_that_is_asked_for() -> None:
    reason = of("points_to").solve().why("points_to(s,objectB)")
    assert max(map(len, reason.text(width=60).splitlines())) <= 60
    assert reason.text(width=200).count("\n") < reason.text(width=60).count("\n")


def test_what_does_not_hold_has_no_reason() -> None:
    answer = of("reachability").solve()
    with pytest.raises(asp.NotDerived, match="does not hold"):
        answer.why("reach(f)")
    with pytest.raises(asp.NotDerived, match="is not an atom"):
        answer.why("reach(")
    with pytest.raises(asp.NotDerived, match=r"`reach\(d\)` holds"):
        answer.why_not("reach(d)")
    with pytest.raises(asp.NotDerived, match="is not an atom"):
        answer.why_not("reach(")


def test_an_absence_names_the_nearest_that_each_rule_comes() -> None:
    reason = of("reachability").solve().why_not("reach(f)")
    assert isinstance(reason.trace, Missing)
    assert {attempt.rule.id for attempt in reason.trace.attempts} == {
        "reachability/start",
        "reachability/step",
    }
    # No choice could give it, so nothing is said of costs.
    assert reason.extra is None
    assert reason.against is None


def test_what_an_atom_would_cost() -> None:
    answer = asp.Program.from_text(COLOURING).solve()
    assert (answer.cost, answer.proven) == ({0: 8}, True)
    assert answer.why_not("has(9,3)").extra == {0: 2}
    assert "costs 2 at priority 0 more" in answer.why_not("has(9,3)").text()
    # A variable stands for any value: the cheapest counts.
    assert answer.holds("has(9,1)")
    assert not answer.holds("has(9,2)")


def test_what_stands_against_an_atom() -> None:
    program = asp.Program.from_text("{ a; b }. c. :- a, c. d :- a.")
    reason = program.solve().why_not("d")
    assert reason.extra is None
    assert reason.against is not None
    assert [rule.text for rule in reason.against] == ["{ a; b }.", "c.", ":- a, c.", "d :- a."]
    assert "no answer has it:" in reason.text()


def test_constants_replace_those_of_the_program() -> None:
    program = asp.Program.from_text(COLOURING)
    assert program.solve({"n": 5}).holds("colour(5)")
    with pytest.raises(asp.Unsatisfiable):
        program.solve({"n": 2})
    named = asp.Program.from_text("#const who = nobody. p(who).")
    assert named.solve({"who": "me"}).holds("p(me)")


def test_what_is_no_value_of_a_constant_is_refused() -> None:
    with pytest.raises(MarsError, match="is not a value for the constant `n`"):
        asp.Program.from_text("p(n).").solve({"n": "x) q(1"})


def test_costs_that_do_not_fit_are_refused() -> None:
    text = "{ a; b }. c :- a, b. #minimize { 2147483647,1 : a; 2147483647,2 : b; 1,3 : c }."
    with pytest.raises(MarsError, match="add up to 4294967295"):
        asp.Program.from_text(text).solve()


def test_facts_with_signs_and_underscores_are_leaves_like_others() -> None:
    answer = asp.Program.from_text("-p(1). _r(2). q :- -p(1), _r(2).").solve()
    assert answer.holds("_r(2)")
    assert [leaf.atom for leaf in answer.why("q").leaves()] == ["-p(1)", "_r(2)"]


def test_a_conflict_holds_no_rule_too_many() -> None:
    conflict = asp.Program.from_text(COLOURING).why_unsatisfiable({"n": 2})
    assert [rule.text for rule in conflict] == [
        "colour(1..n).",
        "edge(1,2;2,3;3,1;3,4).",
        "node(1..4).",
        "1 { has(X,C) : colour(C) } 1 :- node(X).",
        ":- edge(X,Y), has(X,C), has(Y,C).",
    ]
    assert asp.Program.from_text(COLOURING).why_unsatisfiable() == ()
    alone = asp.Program.from_text("p :- not p. q.").why_unsatisfiable()
    assert [rule.text for rule in alone] == ["p :- not p."]


def test_an_answer_can_be_asked_again_and_again() -> None:
    answer = asp.Program.from_text(COLOURING).solve()
    before = (answer.atoms, answer.cost, answer.count)
    first = answer.why("has(9,1)").text()
    answer.why_not("has(9,2)")
    assert answer.why("has(9,1)").text() == first
    assert (answer.atoms, answer.cost, answer.count) == before
    assert answer.why_not("has(9,2)").extra == {0: 1}


def test_a_session_finds_each_answer_once() -> None:
    with asp.Program.from_text(COLOURING).session() as session:
        assert session.solve() is session.solve()
        assert session.solve({"n": 4}) is not session.solve()
        assert session.why("node(9)").leaves()[0].atom == "node(9)"
        assert isinstance(session.why_not("has(9,2)").trace, Missing)


def test_everything_that_is_wrong_is_told_with_its_place(tmp_path: Path) -> None:
    wrong = "p(X) :- q.\n#script (python) #end.\n"
    with pytest.raises(MarsError) as raised:
        asp.Program.from_text(wrong, "wrong.lp")
    (found,) = raised.value.diagnostics
    assert (found.span.path, found.span.line) == ("wrong.lp", 2)
    with pytest.raises(MarsError) as raised:
        asp.Program.from_text("p(X) :- q.", "wrong.lp").solve()
    (found,) = raised.value.diagnostics
    assert (found.span.path, found.span.line) == ("wrong.lp", 1)
    with pytest.raises(MarsError):
        asp.Program.from_files(tmp_path / "nothing.lp")


def solved(text: str) -> tuple[list[frozenset[clingo.Symbol]], list[int]]:
    """Return all least answers by clingo alone, and what they cost."""
    control = clingo.Control(["--opt-mode=optN", "--models=0", "--warn=none"])
    control.add("base", [], text)
    control.ground([("base", [])])
    found: list[frozenset[clingo.Symbol]] = []
    cost: list[int] = []
    with control.solve(yield_=True) as handle:
        for model in islice(handle, MOST_ANSWERS):
            if not model.cost or model.optimality_proven:
                found.append(frozenset(model.symbols(atoms=True)))
                cost = list(model.cost)
    return found, cost


@pytest.mark.parametrize("seed", range(36))
def test_answers_are_clingos_own(seed: int) -> None:
    """Random programs, of which clingo says on its own what is least, and all of it."""
    rng = random.Random(seed)
    rules, given = random_program(seed)
    weights = [f"{rng.randint(1, 3)}@{rng.randint(1, 2)},{n} : {atom}" for n, atom in
               enumerate(rng.sample(ATOMS, 4))]  # fmt: skip
    costs = f"#minimize {{ {'; '.join(weights)} }}." if rng.random() < 0.6 else ""
    text = "\n".join((rules, *(f"{atom}." for atom in given), costs))
    answers, cost = solved(text)
    program = asp.Program.from_text(text)
    if not answers:
        with pytest.raises(asp.Unsatisfiable):
            program.solve()
        assert program.why_unsatisfiable()
        return
    answer = program.solve()
    assert answer.atoms in answers
    assert answer.proven
    if len(answers) < MOST_ANSWERS:
        assert answer.count == len(set(answers))
    assert [value for _, value in sorted(answer.cost.items())[::-1] if value] == [
        value for value in cost if value
    ]
    traces = [answer.why(str(atom)).trace for atom in answer.atoms]
    facts = {clingo.parse_term(leaf) for leaf in answer.spans}
    assert faults(traces, facts, answer.atoms) == []
