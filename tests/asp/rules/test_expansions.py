"""Lines of metadata that expand to rules, in programs about graphs."""

from collections.abc import Iterator

import clingo
import pytest

from mars_asp.asp.messages import labelling
from mars_asp.asp.messages import labels as labelled
from mars_asp.asp.rules.checks import refused_rules
from mars_asp.asp.rules.expansions import Expansion, labels
from mars_asp.asp.rules.read import read_rules
from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.signature import Signature
from mars_asp.asp.solve.term_ids import as_symbol
from mars_asp.diagnostic import Diagnostic
from tests.support.fixtures import Patch

#: What is found is loop(Name, Start); `via` lists nodes in an order, `near` those beside it.
KEYS = {
    "via": Expansion(Signature("loop", 2), "through", (0,), True),
    "near": Expansion(Signature("loop", 2), "beside", (0, 1), False, is_labelled=True),
}


def read(text: str) -> tuple[Rulebook, list[Diagnostic]]:
    """Return the rules of a text and its problems."""
    problems: list[Diagnostic] = []
    file = read_rules(text, "g.lp", "base", problems, KEYS)
    rules = () if file is None else file.rules
    return Rulebook(rules, (("base", text),), paths=("g.lp",)), problems


def made(text: str) -> list[Rule]:
    book, problems = read(text)
    assert problems == []
    return [rule for rule in book.rules if rule.listed is not None]


def wrong(text: str) -> tuple[str, int, int]:
    """Return the one thing that is wrong with a text, and where."""
    _, problems = read(text)
    (found,) = problems
    return found.message, found.span.line, found.span.column


RULE = "loop(N, X) :- name(N, X), edge(X, Y)."


def test_a_list_expands_to_rules_with_the_body_of_the_next_rule() -> None:
    listed = "%! via: X, Y; Z@K : weight(Y, Z, K)\n%! near: Y\n"
    assert [rule.text for rule in made(listed + RULE)] == [
        "through(N,0,X) :- name(N,X); edge(X,Y).",
        "through(N,1,Y) :- name(N,X); edge(X,Y).",
        "through(N,K,Z) :- name(N,X); edge(X,Y); weight(Y, Z, K).",
        "beside(N,X,Y) :- name(N,X); edge(X,Y).",
    ]


def test_the_body_of_a_rule_may_have_pools() -> None:
    listed = "%! via: X, Y; Z@K : weight(Y, Z, K)\n"
    rule = "loop(N, X) :- name(N, (X; Y)), edge(X, Y), K' = (1; 2)."
    (first, second, third) = made(listed + rule)
    assert first.text == "through(N,0,X) :- name(N,(X;Y)); edge(X,Y); K' = (1;2)."
    assert len(second.statements) == len(third.statements) == 4


def test_a_listed_rule_has_the_location_and_id_of_its_rule() -> None:
    rules = made(f"\n%! id: g/loop\n%! via: X, Y\n{RULE} p.\n%! near: Y\n  {RULE}")
    assert [(rule.id, rule.span.line, rule.span.column) for rule in rules] == [
        ("g/loop:via", 4, 1),
        ("g/loop:via2", 4, 1),
        ("g:6:near", 6, 3),
    ]
    assert [rule.listed and rule.listed.line for rule in rules] == [3, 3, 5]
    assert {(rule.because, rule.help) for rule in rules} == {(None, None)}


def test_lines_of_other_rules_stay_where_they_are() -> None:
    book, _ = read(f"%! via: X\n{RULE}\np(1).\nq(1).\n")
    assert [(rule.id, rule.span.line) for rule in book.rules][-2:] == [("g:3", 3), ("g:4", 4)]


def test_clingo_gets_the_listed_rules() -> None:
    facts = 'name(l,a). edge(a,b). weight(b,"x, y; z: @",7).\n'
    listed = '%! via: X; Z@(K, "a;b") : weight(Y, Z, K), Z = "x, y; z: @"\n%! near: f(X, Y)\n'
    book, problems = read(facts + listed + RULE)
    assert problems == []
    control = clingo.Control(["--warn=none"])
    control.add("base", [], book.text("base"))
    control.ground()
    found = {
        str(a.symbol) for a in control.symbolic_atoms if a.symbol.name in ("through", "beside")
    }
    assert found == {
        "through(l,0,a)",
        'through(l,(7,"a;b"),"x, y; z: @")',
        "beside(l,a,f(a,b))",
    }
    assert book.fragments("base")[1].rule == book.rules[3].span


def test_a_list_of_a_rule_without_a_body_has_no_conditions() -> None:
    assert [rule.text for rule in made("%! via: a; X : node(X)\nloop(n, a).")] == [
        "through(n,0,a).",
        "through(n,1,X) :- node(X).",
    ]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("%! via: X\npath(X) :- edge(X, _).", "`via` is above a rule that does not derive"),
        ("%! via: X\n{ loop(N, X) } :- name(N, X).", "`via` is above a rule that does not"),
        ("%! via: X\n-loop(N, X) :- name(N, X).", "`via` is above a rule that does not"),
        ("%! via: X\nloop(N, X) : p(N) :- name(N, X).", "`via` is above a rule that does not"),
        ("%! via: X\nloop(N, (X; Y)) :- name(N, X), edge(X, Y).", "`via` is above a rule"),
        ("%! via: X\n:- name(N, X).", "`via` is above a rule that does not derive `loop/2`"),
        (f"%! via: \n{RULE}", "`via` lists nothing"),
        (f"%! via: X, , Y\n{RULE}", "`via` lists nothing"),
        (f"%! via: X;\n{RULE}", "`via` lists nothing"),
        (f"%! via: : p(X)\n{RULE}", "`via` lists nothing"),
        (f"%! near: Y@3\n{RULE}", "`near` has no order, so `@` has no effect"),
        (f"%! via: X) :- p(X). q(X\n{RULE}", "`via` cannot be read: it means `through(N,0,X)"),
        (f"%! via: X : p(X). q(X)\n{RULE}", "`via` cannot be read"),
        (f"%! via: (X\n{RULE}", "`via` cannot be read"),
        (f'%! via: "X\n{RULE}', "`via` cannot be read"),
        (f"%! via: X % Y\n{RULE}", "`via` cannot be read"),
        (f"%! via: X %* Y\n{RULE}", "`via` cannot be read"),
        (f"%! via: X@1@2\n{RULE}", "`via` cannot be read"),
        (f"%! via: (X; Y)\n{RULE}", "`via` cannot be read"),
        (f"%! via: {'f(' * 300}X{')' * 300}\n{RULE}", "`via` cannot be read"),
        (f"%! via: X\N{GREEK SMALL LETTER ALPHA}\n{RULE}", "`via` cannot be read"),
        (f"%! via: X@-1, X@(K + 1) : weight(X, Y, K)\n{RULE}", "`via` computes `K + 1`"),
        (f"%! near: Z : weight(Y, Z, K), K > 2 * K\n{RULE}", "`near` computes `2 * K`"),
        (f"%! via: Q\n{RULE}", "nothing in the body binds `Q`"),
        (f"%! via: X@99999999999\n{RULE}", "`99999999999` does not fit into 32 bits"),
        (
            "%! via: Y : edge(X, Y)\nloop(N, X) :- name(N, X), 1 #count { Y : edge(X, Y) }.",
            "`Y` of `via` is a different variable in an aggregate or negation of the rule",
        ),
        (f"%! vai: X\n{RULE}", "`vai` is not a metadata key"),
        (f"%! via: X\n%! via: Y\n{RULE}", "`via` occurs twice above one rule"),
        (f"%! via: X\n\n{RULE}", "`via` is not directly above a rule"),
    ],
)
def test_an_error_in_a_list_is_reported_at_its_location(text: str, message: str) -> None:
    result, line, column = wrong(text)
    assert result.startswith(message)
    assert (line, column) == (2 if "twice" in message else 1, 1)


def test_clingo_is_called_once_for_lists_without_faults(
    monkeypatch: Patch,
) -> None:
    parsed: list[str] = []

    def refused(text: str, shown: str) -> Iterator[Diagnostic]:
        parsed.append(text)
        return refused_rules(text, shown)

    monkeypatch.setattr("mars_asp.asp.rules.read.refused_rules", refused)
    assert len(made(f"%! via: X, Y\n{RULE}\n" * 3)) == 6
    assert len(parsed) == 1
    assert wrong(f"%! via: X\n{RULE}\n%! via: Q\n{RULE}")[1] == 3
    assert len(parsed) == 6


def test_without_a_host_no_key_lists_anything() -> None:
    problems: list[Diagnostic] = []
    assert read_rules("%! who: X\np(X) :- q(X).", "g.lp", "base", problems) is not None
    assert [each.message for each in problems] == ["`who` is not a metadata key"]


def test_a_term_may_have_a_label_that_the_rule_of_its_body_fills() -> None:
    listed = '%! near: X "from {X}, {Y}"; Z "by: {K:milliwatts}; {N}" : weight(Y, Z, K); Y\n'
    book, problems = read(f"{listed}{RULE}")
    assert problems == []
    assert [rule.text for rule in book.rules[1:]] == [
        "beside(N,X,X) :- name(N,X); edge(X,Y).",
        "beside(N,X,Z) :- name(N,X); edge(X,Y); weight(Y, Z, K).",
        "beside(N,X,Y) :- name(N,X); edge(X,Y).",
    ]
    entries = [(each, label) for each in book.rules for label in labels(each, KEYS)]
    assert [label.holes for _, label in entries] == [("X", "Y"), ("K", "N")]
    control = clingo.Control(["--warn=none"])
    facts = "name(l,a). edge(a,b). weight(b,c,7)."
    made = "\n".join(each.text for each in labelling("base", entries))
    control.add("base", [], f"{facts}\n{book.text('base')}\n{RULE}\n{made}")
    control.ground()
    found = [(str(as_symbol(f.term)), f.text) for f in labelled(control, "base", entries)]
    assert found == [("a", "from a, b"), ("c", "by: 0.007 W; l")]


@pytest.mark.parametrize(
    ("listed", "message"),
    [
        (
            '%! near: Y "seen by {Z}"',
            "`{Z}` in a label of `near` is not a variable of the rule's body",
        ),
        ('%! via: Y "seen"', "`via` takes no labels"),
    ],
)
def test_a_wrong_label_is_reported(listed: str, message: str) -> None:
    assert wrong(f"{listed}\n{RULE}") == (message, 1, 1)
