"""The engine's face, on programs of other fields."""

import os
import random
import re
import subprocess
import sys
from collections.abc import Iterable, Iterator
from itertools import combinations, islice
from math import comb
from pathlib import Path
from typing import Any, cast

import clingo
import pytest

from mars_asp import MarsError, asp
from mars_asp.asp.solve import optimum
from mars_asp.asp.trace.tree import Derived, Underivable
from tests.support.documents import ROOT
from tests.support.fixtures import Patch
from tests.support.random_programs import ATOMS, random_program
from tests.support.refusals import refusal
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
        "print(sorted(m for m in sys.modules if m.startswith('mars_asp') and '.asp' not in m))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    names = ("", ".diagnostic", ".output", ".reading", ".spelling")
    assert done.stdout == f"{[f'mars_asp{name}' for name in names]}\n"


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


def test_every_derivation_is_returned() -> None:
    reason = of("reachability").solve().why("reach(b)", every=True)
    assert isinstance(reason.trace, Derived)
    # The edge from `d` gives no second derivation: `d` is reached through `b` alone.
    assert len(reason.trace.others) == 0
    text = "p(1). p(2). q :- p(X)."
    trace = asp.Program.from_text(text).solve().why("q", every=True).trace
    assert isinstance(trace, Derived)
    assert len(trace.others) == 1


def test_a_text_has_the_requested_width() -> None:
    reason = of("points_to").solve().why("points_to(s,objectB)")
    assert max(map(len, reason.text(width=60).splitlines())) <= 60
    assert reason.text(width=200).count("\n") < reason.text(width=60).count("\n")


def test_a_false_atom_has_no_reason() -> None:
    answer = of("reachability").solve()
    with pytest.raises(asp.NotDerived, match="does not hold"):
        answer.why("reach(f)")
    with pytest.raises(asp.NotDerived, match="is not an atom"):
        answer.why("reach(")
    with pytest.raises(asp.NotDerived, match=r"`reach\(d\)` holds"):
        answer.why_not("reach(d)")
    with pytest.raises(asp.NotDerived, match="is not an atom"):
        answer.why_not("reach(")


def test_the_first_of_several_true_atoms_is_named() -> None:
    answer = asp.Program.from_text("p(3..9). p(1).").solve()
    with pytest.raises(asp.NotDerived, match=r"`p\(1\)` holds"):
        answer.why_not("p(_)")


def test_an_absence_names_the_nearest_that_each_rule_comes() -> None:
    reason = of("reachability").solve().why_not("reach(f)")
    assert isinstance(reason.trace, Underivable)
    assert {attempt.rule.id for attempt in reason.trace.attempts} == {
        "reachability/start",
        "reachability/step",
    }
    # No choice could derive the atom, so that no costs are stated.
    assert reason.extra is None
    assert reason.against is None


def test_a_negated_message_is_about_the_instance_of_its_rule() -> None:
    """The messages hold: there is an edge from `e` to `f`, and 4 has a colour."""
    text = of("reachability").solve().why_not("reach(f)").text(width=200)
    assert "reach(f) would hold because an edge leads from `e` to `f`, but" in text
    text = of("colouring").solve().why_not("has(4,blue)").text(width=200)
    assert "has(4,blue) would hold because `4` has one colour, but" in text
    assert "it does not hold that" not in text


@pytest.mark.parametrize(
    ("text", "absent"),
    [
        # Either premise is absent: the search for `q` would go on to `s` and `t`.
        ("p(X) :- q(X,Y), r(Z). q(X,Y) :- s(X,Y). s(X,Y) :- t(X,Y). t(1,2).", "no r(Z)"),
        ("p(X) :- q(X,Y), r(Y,X). q(X,Y) :- s(X,Y). s(X,Y) :- t(X,Y). r(2,3).", "no r(Y,5)"),
        ("p(X+1) :- p(X), r(X+1). r(0..3). p(0).", "no r(5)"),
        ("p(X) :- q(X), not r(X). q(X) :- s(X). s(X) :- t(X). r(5).", "r(5)"),
    ],
)
def test_an_absence_ends_at_the_first_given_fact_that_is_absent(text: str, absent: str) -> None:
    reason = asp.Program.from_text(text).solve().why_not("p(5)")
    lines = [line.strip() for line in reason.text().splitlines()]
    assert lines[2].split("  ")[0] == absent
    assert len(lines) == 3


def test_the_additional_cost_of_an_atom() -> None:
    answer = asp.Program.from_text(COLOURING).solve()
    assert (answer.cost, answer.proven) == ({0: 8}, True)
    assert answer.why_not("has(9,3)").extra == {0: 2}
    assert "an answer would cost 2 more at level 0\n" in f"{answer.why_not('has(9,3)').text()}\n"
    # A variable matches any value: the cheapest counts.
    assert answer.holds("has(9,1)")
    assert not answer.holds("has(9,2)")


def test_constraints_against_an_atom() -> None:
    program = asp.Program.from_text("{ a; b }. c. :- a, c. d :- a.")
    reason = program.solve().why_not("d")
    assert reason.extra is None
    assert reason.against is not None
    assert [each.text for each in reason.against] == ["c.", ":- a, c."]
    assert "no answer has it:" in reason.text()


@pytest.mark.parametrize(
    ("costs", "extra", "words"),
    [
        ("2@20,c : c; -1@10,z : z; 1@5,b : b", {20: 2, 10: -1, 5: 0},
         "2 more at level 20, 1 less at level 10 and as much at level 5"),
        ("0@20,c : c; 3@7,d : d", {20: 0, 7: 0}, "would cost as much"),
        ("", {}, "is as good: nothing is minimised"),
    ],
)  # fmt: skip
def test_the_extra_cost_has_a_number_at_every_level(
    costs: str, extra: dict[int, int], words: str
) -> None:
    text = f"1 {{ a; z }} 1. {{ b; d }}. c :- z. #minimize {{ {costs} }}."
    answer = asp.Program.from_text(text).solve()
    reason = answer.why_not("c")
    assert reason.extra == extra
    assert f"with it, an answer {words}" in reason.text().replace("would cost 2", "2")
    assert reason.json()["extra_cost"] == {str(level): cost for level, cost in extra.items()}


@pytest.mark.parametrize(
    ("text", "atom", "remark", "reasons"),
    [
        ("1 { a; b } 1. #minimize { 1 : b }.", "a", "chosen as the cheapest", []),
        ("1 { a; b } 1. :- b.", "a", "no answer lacks it", ["1 <= { a; b } <= 1.", ":- b."]),
        # The cost of the others does not matter if no answer lacks the atom.
        ("1 { a; b } 1. :- b. #minimize { 1 : a }.", "a", "no answer lacks it",
         ["1 <= { a; b } <= 1.", ":- b."]),
        ("{ a }. #minimize { 1 : b }. { b }.", "a", "chosen freely: another answer lacks it", []),
        ("1 { a; b } 1. #minimize { 1 : a; 1 : b }.", "a",
         "chosen, though an answer without it costs as little", []),
        ("#maximize { 1 : a }. { a }.", "a", "chosen as the cheapest", []),
    ],
)  # fmt: skip
def test_a_choice_is_compared_with_the_answers_that_lack_its_atom(
    text: str, atom: str, remark: str, reasons: list[str]
) -> None:
    reason = asp.Program.from_text(text).solve().why(atom)
    lines = [line.strip() for line in reason.text().splitlines()[1:]]
    assert lines[0].split("  [")[0] == f"{atom}, {remark}"
    assert [line.rpartition("  ")[0] for line in lines[1:] if ".  " in line] == reasons
    shown = cast("list[dict[str, object]]", reason.json()["reasons"])
    assert [each["text"] for each in shown] == reasons


def test_optima_are_counted_on_request_alone(monkeypatch: Patch) -> None:
    program = asp.Program.from_text("{ p(1..10) } 4.")
    models = []
    solve_again = optimum._models

    def counted(*given: Any) -> Iterator[clingo.Model]:
        for model in solve_again(*given):
            models.append(model)
            yield model

    monkeypatch.setattr(optimum, "_models", counted)
    assert program.solve().count is None
    # One answer is found, and at most two in search of another one.
    assert len(models) <= 3
    assert program.solve(count=True).count == sum(comb(10, size) for size in range(5))


def test_constants_replace_those_of_the_program() -> None:
    program = asp.Program.from_text(COLOURING)
    assert program.solve({"n": 5}).holds("colour(5)")
    with pytest.raises(asp.Unsatisfiable):
        program.solve({"n": 2})
    named = asp.Program.from_text("#const who = nobody. p(who).")
    assert named.solve({"who": "me"}).holds("p(me)")


def test_an_invalid_value_of_a_constant_is_refused() -> None:
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
    conflicts = asp.Program.from_text(COLOURING).why_unsatisfiable({"n": 1}, limit=2)
    assert not conflicts.complete
    (first, second) = conflicts
    assert [each.text for each in first] == [
        "edge(1,2).",
        "node(1).",
        "node(2).",
        "1 <= { has(1,C): colour(C) } <= 1 :- node(1).",
        "1 <= { has(2,C): colour(C) } <= 1 :- node(2).",
        ":- edge(1,2), has(1,1), has(2,1).",
    ]
    assert len(second) == 6
    assert conflicts.text().startswith("no answer: 2 minimal conflicts, and there may be more\n")
    assert max(map(len, conflicts.text(width=40).splitlines())) <= 40
    none = asp.Program.from_text(COLOURING).why_unsatisfiable()
    assert (len(none), none.text()) == (0, "the program has an answer")
    alone = asp.Program.from_text("p :- not p. q.").why_unsatisfiable()
    assert [each.text for (conflict) in alone for each in conflict] == ["p :- not p."]


def instances_of(text: str) -> list[tuple[str, str]]:
    """Return the instances of random rules over X = 1..2, and each as it is when left open."""
    found = []
    for rule in text.split("\n"):
        for value in ("1", "2") if "X" in rule else ("",):
            ground = rule.replace("X", value)
            head, _, body = ground.rstrip(".").partition(":- ")
            left_open = f"{{ {head} }} :- {body or '#true'}." if head.strip() else ""
            if head.startswith("1 {"):
                left_open = f"{head[2:]} :- {body or '#true'}."
            found.append((ground, left_open))
    return found


def random_conflicting(seed: int) -> str:
    rng = random.Random(seed)
    atoms = ["a", "b", "p(X)", "q(X)", "p(1)", "q(2)"]
    lines = ["dom(1).", "dom(2)."]
    for _ in range(rng.randint(4, 6)):
        body = [f"{rng.choice(('', '', 'not '))}{each}" for each in rng.sample(atoms, 2)]
        body = body[: rng.randint(1, 2)]
        head = rng.choice(["", "", "", rng.choice(atoms), f"1 {{ {rng.choice(atoms)}; b }}"])
        has_variable = "X" in f"{head}{body}"
        lines.append(f"{head} :- {'; '.join([*body, *(['dom(X)'] if has_variable else [])])}.")
    return "\n".join(dict.fromkeys([*lines, "{ a }.", "p(1).", "q(2)."])).replace("\n :-", "\n:-")


def has_answer(lines: Iterable[str]) -> bool:
    control = clingo.Control(["--warn=none"])
    control.add("base", [], "\n".join(lines))
    control.ground()
    return bool(control.solve().satisfiable)


@pytest.mark.parametrize("seed", (1, 3, 11, 31, 66, 97))
def test_all_minimal_conflicts_are_those_of_brute_force(seed: int) -> None:
    """Each set of instances is tried, the smallest first; all others are left open."""
    text = random_conflicting(seed)
    found = asp.Program.from_text(text).why_unsatisfiable(limit=50)
    assert found.complete
    wanted = minimal_sets(text)
    assert len(found) == len(wanted)
    for conflict in found:
        assert frozenset(map(_plain, (each.text for each in conflict))) in wanted, text


def _plain(text: str) -> str:
    return re.sub(r"[ ,;]|<=|:-$", "", text)


def minimal_sets(text: str) -> set[frozenset[str]]:
    instances = [each for each in instances_of(text) if not each[0].startswith("{")]
    free = [line for line in text.split("\n") if line.startswith("{")]
    found: list[frozenset[int]] = []
    for size in range(1, len(instances) + 1):
        for kept in map(frozenset, combinations(range(len(instances)), size)):
            if any(each <= kept for each in found):
                continue
            lines = (each[at not in kept] for at, each in enumerate(instances))
            if not has_answer([*lines, *free]):
                found.append(kept)
    return {frozenset(_plain(instances[at][0]) for at in each) for each in found}


def test_an_answer_can_be_queried_repeatedly() -> None:
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
        assert isinstance(session.why_not("has(9,2)").trace, Underivable)


def test_all_errors_are_reported_with_their_locations(tmp_path: Path) -> None:
    wrong = "p(X) :- q.\n#script (python) #end.\n"
    found = refusal(asp.Program.from_text, wrong, "wrong.lp")
    assert (found.span.path, found.span.line) == ("wrong.lp", 2)
    with pytest.raises(MarsError):
        asp.Program.from_files(tmp_path / "nothing.lp")


@pytest.mark.parametrize(
    ("text", "places"),
    [
        ("p(X) :- q.", [("X", 1, 3)]),
        ("q.\np(1,\n  Y) :- q,\n  X < Z.", [("Y", 3, 3), ("X", 4, 3), ("Z", 4, 7)]),
        ('q("üü"). p(X) :- q("üü").', [("X", 1, 12)]),
        ("#minimize { W : q }. q.", [("W", 1, 13)]),
    ],
)
def test_each_unsafe_variable_is_reported_at_its_own_place(
    text: str, places: list[tuple[str, int, int]]
) -> None:
    with pytest.raises(MarsError) as raised:
        asp.Program.from_text(text, "wrong.lp")
    expected = [("rule-unsafe", f"nothing in the body binds `{name}`", line, column)
                for name, line, column in places]  # fmt: skip
    found = [(d.code, d.message, d.span.line, d.span.column) for d in raised.value.diagnostics]
    assert found == expected


def solved(text: str) -> tuple[list[frozenset[clingo.Symbol]], list[int]]:
    """Return all minimal answers by clingo alone, and their cost."""
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
    """Answers and costs of random programs equal those that clingo computes alone."""
    rng = random.Random(seed)
    rules, given = random_program(seed)
    weights = [f"{rng.choice((-2, -1, 1, 2, 3))}@{rng.randint(1, 2)},{n} : {atom}" for n, atom in
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
    answer = program.solve(count=True)
    assert answer.atoms in answers
    assert program.solve().atoms == answer.atoms
    assert answer.proven
    if len(answers) < MOST_ANSWERS:
        assert answer.count == len(set(answers))
    assert [value for _, value in sorted(answer.cost.items())[::-1] if value] == [
        value for value in cost if value
    ]
    traces = [answer.why(str(atom)).trace for atom in answer.atoms]
    facts = {clingo.parse_term(leaf) for leaf in answer.spans}
    assert faults(traces, facts, answer.atoms) == []


def test_a_program_includes_files_relative_to_the_including_one(tmp_path: Path) -> None:
    (tmp_path / "sub").mkdir()
    main, inner, last = tmp_path / "main.lp", tmp_path / "sub/inner.lp", tmp_path / "sub/last.lp"
    main.write_text('% #include "nowhere.lp".\na. #include "sub/inner.lp". d :- c(X), X > 1.\n')
    inner.write_text('b.\n#include "last.lp".\n#include "last.lp".\nc(2).\n')
    last.write_text("c(1..2) :-\n b.\n")
    answer = asp.Program.from_files(main).solve()
    assert sorted(map(str, answer.atoms)) == ["a", "b", "c(1)", "c(2)", "d"]
    text = answer.why("d").text(width=200)
    assert "main.lp:2" in text
    assert f"c(2)  {inner}:4" in text
    assert f"[last:1] {last}:1" in answer.why("c(1)").text(width=200)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('a.\n  #include "nope.lp".', "No such file or directory"),
        ('a.\n  #include "circle.lp".', "`circle.lp` includes itself"),
        ('a.\n  #include ".".', "no regular file"),
        ('a.\n  #include "large.lp".', "larger than"),
        ("a.\n  #include <incmode>.", "`#include` names no file"),
        ('a.\n  #include "pipe".', "no regular file"),
    ],
)
def test_an_unreadable_file_is_reported_at_its_include(
    text: str, message: str, tmp_path: Path, monkeypatch: Patch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("circle.lp").write_text('b.\n  #include "circle.lp".')
    os.mkfifo("pipe")
    with Path("large.lp").open("wb") as large:
        large.truncate(9 * 1024 * 1024)
    found = refusal(asp.Program.from_text, text)
    assert message in found.message
    assert (found.span.line, found.span.column) == (2, 3)
    assert found.help is not None


def test_an_include_in_a_string_is_refused_and_in_a_comment_it_means_nothing() -> None:
    text = 'a. %* #include "x.lp". *% b. % #include "x.lp".\n'
    assert len(asp.Program.from_text(text).solve().atoms) == 2
    with pytest.raises(MarsError, match="`#include` is not allowed"):
        asp.Program.from_text('a("#include x").')


def test_externals_are_false_unless_a_value_is_given() -> None:
    text = "q(1..2). #external e(X) : q(X). #external f. [true]\nr(X) :- e(X). s :- not e(1)."
    program = asp.Program.from_text(text)
    assert program.solve(externals={"e(2)": None}, count=True).count == 2
    answer = program.solve(externals={"e(2)": True, "f": False})
    assert not answer.holds("f")
    reason = answer.why("r(2)")
    assert reason.text().splitlines()[2] == "        e(2), external  program.lp:1"
    (leaf,) = cast("list[dict[str, object]]", reason.json()["premises"])
    assert leaf["kind"] == "external"
    assert "no e(1), external and false  program.lp:1" in answer.why("s").text()
    absence = answer.why_not("r(1)").text()
    assert "no e(1), external and false  program.lp:1" in absence
    assert "#external e(1) is false  program.lp:1" in absence
    with pytest.raises(MarsError, match=r"`e\(3\)` is not an external of the program"):
        program.solve(externals={"e(3)": True})
    with pytest.raises(MarsError, match="is not an atom"):
        program.solve(externals={"e(": True})
    conflicts = asp.Program.from_text("#external h. [true] :- h.").why_unsatisfiable()
    assert "#external h is true  program.lp:1" in conflicts.text()
    assert len(asp.Program.from_text("#external h. [true] :- h.").why_unsatisfiable(
        externals={"h": False})) == 0  # fmt: skip


def test_parts_are_grounded_on_request_with_their_arguments() -> None:
    text = "q. #program step(t).\nr(t) :- q,\n not r(t-1). #program base. s."
    program = asp.Program.from_text(text)
    assert sorted(map(str, program.solve().atoms)) == ["q", "s"]
    answer = program.solve(parts=["base", "step(1)", "step(2)", "step(-3)"])
    assert sorted(map(str, answer.atoms)) == ["q", "r(-3)", "r(1)", "s"]
    assert "[program:2] program.lp:2" in answer.why("r(1)").text()
    assert "r(1)  [program:2]" in answer.why_not("r(2)").text()
    with pytest.raises(MarsError, match="`step` is not a part of the program"):
        program.solve(parts=["step"])


def random_files(rng: random.Random, folder: Path) -> list[str]:
    """Write three files that include each other, with parts and externals; return parts of them."""
    names = ["main", "one", "two"]
    for number, name in enumerate(names):
        lines = []
        for _ in range(rng.randint(2, 6)):
            atoms = [rng.choice(("a", "b", "p(k)", "p(1)", "q(k,2)", "q(1,2)")) for _ in range(2)]
            sign, end = rng.choice(("", "not ")), rng.choice(("", " [true]", " [false]"))
            lines.append(rng.choice((f"{atoms[0]}.", f"{atoms[0]} :- {sign}{atoms[1]}.",
                f"#external {atoms[0]}.{end}", f"{{ {atoms[0]} }}.", "#program base.",
                "#program go(k).", "#program on(k).", ":- p(k), not a.")))  # fmt: skip
            if number < 2 and rng.random() < 0.4:
                lines.append(f'#include "{rng.choice(names[number + 1 :])}.lp".')
        (folder / f"{name}.lp").write_text("\n".join(lines))
    return rng.choice((["base"], ["base", "go(1)"], ["base", "go(2)", "on(1)"], ["on(1)"]))


@pytest.mark.parametrize("seed", range(0, 60, 10))
def test_files_parts_and_externals_have_the_meaning_of_clingo(seed: int, tmp_path: Path) -> None:
    for each in range(seed, seed + 10):
        rng = random.Random(each)
        parts = random_files(rng, tmp_path)
        try:
            program = asp.Program.from_files(tmp_path / "main.lp")
            parts = [part for part in parts if program.with_parts([part])]
        except MarsError:
            # Clingo knows any part, and grounds nothing for one that has no statement.
            continue
        control = clingo.Control(["0", "--warn=none"])
        control.load(str(tmp_path / "main.lp"))
        symbols = list(map(clingo.parse_term, parts))
        control.ground([(symbol.name, symbol.arguments) for symbol in symbols])
        known = [atom.symbol for atom in control.symbolic_atoms if atom.is_external]
        values = {str(symbol): rng.choice((True, False)) for symbol in known if rng.random() < 0.5}
        for atom, value in values.items():
            control.assign_external(clingo.parse_term(atom), value)
        with control.solve(yield_=True) as handle:
            wanted = {frozenset(model.symbols(atoms=True)) for model in handle}
        try:
            answer = program.solve(externals=values, parts=parts, count=True)
        except asp.Unsatisfiable:
            assert not wanted, each
            continue
        assert answer.atoms in wanted, each
        assert answer.count == len(wanted), each
