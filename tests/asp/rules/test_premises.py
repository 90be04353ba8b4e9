"""Rules that cannot fire are left out, and nothing else of a program changes."""

import clingo
import pytest

from mars_asp.asp.fragments import Fragment, Premises, able_to_fire, fact_fragment, joined
from mars_asp.asp.rules.premises import read_premises
from mars_asp.asp.rules.statements import pieces
from tests.support.campaigns import seeds
from tests.support.random_programs import random_program


def premises(text: str) -> Premises:
    found = read_premises(text)
    assert found is not None
    return found


def left(text: str, *present: str) -> str:
    """Return the rules that can fire if only some predicates have atoms, in one line."""
    fragment = Fragment(text, "rules.lp", premises=premises(text))
    return " ".join(joined(able_to_fire([fragment], present)).split())


@pytest.mark.parametrize(
    "kept",
    [
        "p :- not q.",
        "p(X) :- X = 1..3, not q(X).",
        "p :- not not q.",
        "p :- 0 { q(X) } 0.",
        "p(N) :- N = #count { X : q(X) }.",
        "p :- q : r.",
        "{ p(X) : q(X) }.",
        "p : q :- r.",
        "a | b.",
        ":- not q.",
        "p(1;2).",
        "p :- (r;q) != r.",
        "p :- q(1;2), not r. q(2).",
        "p(N) :- N = #sum { X : q(X); 1 : s }, r.",
        "-p :- r.",
        "p :- -r. -r.",
        "p :- q, q. q :- r.",
        "#minimize { 1,X : q(X) }.",
        "#maximize { 1@2 : q }. :~ q. [1]",
        "#const r = 3.",
        "#show q/1.",
    ],
)
def test_rules_that_can_fire_stay(kept: str) -> None:
    assert left(kept, "r") == kept


@pytest.mark.parametrize(
    "idle",
    [
        "p :- q.",
        "p :- r, q, not s.",
        "{ p(X) : r(X) } :- q.",
        ":- q.",
        "a | b :- q.",
        "p :- q. q :- p.",
        "q :- p(1;2). p(3) :- q.",
        "p :- -q.",
        "p :- q, #count { X : r(X) } > 0.",
        "p :- q; r : not s.",
    ],
)
def test_rules_that_cannot_fire_are_left_out(idle: str) -> None:
    assert left(idle, "r") == ""


def test_kept_rules_keep_their_locations() -> None:
    text = 'a :- no,\n  "%*" != 1.\n% a note\n  b :- yes. c :- no. #show b/0. %* more\n *% d.\n'
    fragment = Fragment(text, "rules.lp", premises=premises(text))
    (found,) = able_to_fire([fragment], {"yes"})
    kept = [(piece.text, piece.begin) for piece in pieces(found.text) if piece.sort != "begin"]
    whole = [(piece.text, piece.begin) for piece in pieces(text) if piece.text in dict(kept)]
    assert kept == whole and [name for name, _ in kept] == ["b :- yes.", "#show b/0.", "d."]
    assert found.text.count("\n") == text.count("\n")


def test_external_and_program_statements_are_not_read() -> None:
    for text in ("#external q.", "#external q(X) : r(X).", "#program more(n)."):
        assert read_premises(f"p :- q. {text}") is None


def test_whatever_a_text_names_that_was_not_read_may_hold() -> None:
    rules = "p :- q. s :- t."
    known = Fragment(rules, "rules.lp", premises=premises(rules))
    unread = Fragment("{ q }. % t", "pack.lp")
    assert joined(able_to_fire([known, unread])) == "p :- q. s :- t.\n{ q }. % t"
    assert (
        joined(able_to_fire([known, Fragment("{ q' }.", "pack.lp")])).split() == "{ q' }.".split()
    )
    assert "p :- q." in joined(able_to_fire([known, fact_fragment("q.\n", {"q"})]))


def test_random_programs_have_the_same_answers() -> None:
    idle = 0
    tried = seeds(60, 250)
    for seed in tried:
        text, given = random_program(seed)
        facts = fact_fragment(
            "".join(f"{atom}.\n" for atom in given), {a.partition("(")[0] for a in given}
        )
        whole = [Fragment(text, "rules.lp", premises=premises(text)), facts]
        able = able_to_fire(whole)
        assert answers(joined(able)) == answers(joined(whole)), text
        idle += premises(text).rules != premises(able[0].text).rules
    assert idle * 5 > len(tried)


def answers(program: str) -> tuple[frozenset[str], frozenset[frozenset[str]]]:
    """Return the facts and the answer sets."""
    control = clingo.Control(["0", "--warn=none"])
    control.add("base", [], program)
    control.ground()
    found = set[frozenset[str]]()
    control.solve(on_model=lambda model: found.add(frozenset(map(str, model.symbols(atoms=True)))))
    facts = frozenset(str(each.symbol) for each in control.symbolic_atoms if each.is_fact)
    return facts, frozenset(found)
