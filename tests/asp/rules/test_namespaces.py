"""Names of name spaces: predicates alone are called otherwise, wherever they are."""

import clingo
import pytest

from mars_asp.asp.rules.expansions import with_conditions
from mars_asp.asp.rules.namespaces import spaced
from mars_asp.asp.rules.statements import renamed
from mars_asp.asp.signature import Signature, plain

SEEN, NEAR = Signature("seen", 1), Signature("near", 2)
NAMES = {each: spaced(each, "my-pack") for each in (SEEN, NEAR)}
TEXTS = [
    'seen(X) :- near(X, seen(X)), not seen("seen(é)").',
    "-seen(X) :- near(X, _), 1 { seen(Y) : near(Y, X) } 2.",
    "{ seen(X) : near(X, _) } :- #count { Y : seen(Y) } > 1.",
    ":- seen(1; 2), near(1..2, 3).  % seen(X)",
    "#show seen/1. #defined near/2. #minimize { 1@2,X : seen(X) }.",
    "near(A, B) :- near(B, A). near(A) :- seen(A, 1).",
]


@pytest.mark.parametrize("text", TEXTS)
def test_predicates_are_renamed_and_shown_as_they_were(text: str) -> None:
    found = renamed(text, NAMES)
    assert found != text
    assert plain(found) == text


def test_terms_strings_comments_and_other_arities_stay() -> None:
    assert renamed(TEXTS[0], NAMES) == (
        "seen''my_pack(X) :- near''my_pack(X, seen(X)), not seen''my_pack(\"seen(é)\")."
    )
    assert renamed("near(A) :- seen(A, 1). % near(A, B)", NAMES) == (
        "near(A) :- seen(A, 1). % near(A, B)"
    )


def test_an_answer_is_the_same_but_for_names() -> None:
    text = "near(1, 2). near(2, 3). seen(1). seen(Y) :- seen(X), near(X, Y). -seen(9)."
    answers = []
    for each in (text, renamed(text, NAMES)):
        control = clingo.Control()
        control.add("base", [], each)
        control.ground()
        answers.append(sorted(plain(str(atom.symbol)) for atom in control.symbolic_atoms))
    assert answers[0] == answers[1]


def test_conditions_of_lists_are_renamed_with_their_labels() -> None:
    written = 'M; R@1 "`{C}`: here; and there" : seen(R), near(R, C); X'
    found = with_conditions(written, lambda text: text.replace("seen", "found"))
    assert found == 'M; R@1 "`{C}`: here; and there" : found(R), near(R, C); X'
