import pytest

from mars_asp.asp.rules.declarations import (
    Declaration,
    PredicateArgument,
    declarations,
    docstrings,
    wrong_references,
)
from mars_asp.asp.rules.statements import pieces
from mars_asp.diagnostic import Diagnostic


def read(text: str) -> tuple[list[Declaration], list[str]]:
    problems: list[Diagnostic] = []
    found = list(declarations(docstrings(pieces(text)), "a.lp", problems))
    return found, [f"{each.span.line}: {each.message}: {each.help}" for each in problems]


def test_a_declaration_is_read_whole() -> None:
    text = """\
% before
%*! weighs(M: module | part, W: grams,
    K: {net, gross})
M weighs W, which says
what it is worth: nothing.
from: computed
packs: extend
joins: nothing
*%
#defined weighs/3.
"""
    (found,), problems = read(text)
    assert not problems
    assert found.arguments == (
        PredicateArgument("M", frozenset({"module", "part"})),
        PredicateArgument("W", frozenset({"grams"})),
        PredicateArgument("K", constants=("net", "gross")),
    )
    assert found.words == "M weighs W, which says what it is worth: nothing."
    assert (found.origin, found.extensible, found.joins) == ("computed", True, False)
    assert str(found.signature) == "weighs/3"
    assert found.written == "weighs(M: module | part, W: grams, K: {net, gross})"
    assert found.places("part") == (0,)
    assert found.places("grams", "part") == (0, 1)


@pytest.mark.parametrize(
    ("header", "signature"),
    [
        ("it", "it/0"),
        ("p(X)", "p/1"),
        ("-p(X)", "-p/1"),
        ("p(A, (B, C), f(D, E), A')", "p/4"),
        ("  p( _X )  ", "p/1"),
    ],
)
def test_words_and_arguments_are_enough(header: str, signature: str) -> None:
    (found,), problems = read(f"%*! {header}\nWords.\n*%\n")
    assert not problems
    assert str(found.signature) == signature
    assert (found.origin, found.extensible, found.joins) == (None, False, True)


def test_sentences_are_read_in_their_order() -> None:
    (found,), problems = read("""%*! p(X: thing, Y': grams)
Words.
says: {X} weighs
    {Y'}, as {other.X'} says
unless: {X} is not {Y'}
unless: nothing is
from: stated
cited: never
orders: Y'
*%""")
    assert not problems
    assert found.says == ("{X} weighs {Y'}, as {other.X'} says",)
    assert found.unless == ("{X} is not {Y'}", "nothing is")
    assert (found.words, found.origin, found.cited, found.ordering) == (
        "Words.",
        "stated",
        False,
        "Y'",
    )


def test_references_lead_to_an_argument_by_one_that_both_have() -> None:
    found, problems = read("""
%*! p(R, C)
says: {R}
*%
%*! q(R, F)
says: {p.C} {p.D} {pp.C}
*%
%*! r(F)
unless: {p.C}
*%""")
    assert not problems
    assert [(each.message, each.help) for each in wrong_references(found)] == [
        ("`{p.D}` names no argument", "name one of R, C"),
        ("`{pp.C}` names no argument", "did you mean `p`?"),
        (
            "`p` has no argument that `r` also has",
            "call the argument by which its fact is found the same",
        ),
    ]


def test_comments_without_the_mark_are_not_declarations() -> None:
    assert read('%* p(X) *%\n% p(X)\nq("%*! p(X) *%").\n') == ([], [])


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("%*! P(X)\nWords.\n*%", "`P(X)` is not a predicate with its arguments"),
        ("%*! p(X)\nsays: {Y} is\n*%", "`{Y}` names no argument"),
        ("%*! p(X)\nunless: {x} is\n*%", "`{x}` names no argument"),
        ("%*! p(X)\nsays:\n*%", "`says: ` is not a key of a documented predicate"),
        ("%*! p(X)\norders: Y\n*%", "`orders: Y` names no argument"),
        ("%*! p(X)\ncited: always\n*%", "`cited: always` is not a key of a documented predicate"),
        ("%*! p(x)\nWords.\n*%", "`x` is not an argument of a documented predicate"),
        ("%*! p(X:)\nWords.\n*%", "`X:` is not an argument of a documented predicate"),
        ("%*! p(X: Y)\nWords.\n*%", "`Y` is not a sort"),
        ("%*! p(X: a |)\nWords.\n*%", "`` is not a sort"),
        ("%*! p(X)\nfrom: state\n*%", "`from: state` is not a key of a documented predicate"),
        ("%*! p(X)\nfron: stated\n*%", "`fron: stated` is not a key of a documented predicate"),
        ("%*! p(X)\nfrom: stated\nfrom: computed\n*%", "`from` occurs twice"),
        ("%*! p(X)\nWords.\n*%\n%*! p(Y)\nWords.\n*%", "`p/1` is documented twice"),
    ],
)
def test_each_mistake_has_its_message(text: str, problem: str) -> None:
    _, (result,) = read(text)
    assert result.split(": ", 1)[1].startswith(problem)


def test_words_that_look_like_a_line_are_words() -> None:
    (found,), problems = read("%*! p(X)\nWords, as in\nexample: such.\n*%")
    assert not problems
    assert found.words == "Words, as in example: such."


def test_an_endless_declaration_gets_a_short_message() -> None:
    _, (result,) = read("%*! p(" + "X,\n" * 20_000 + "*%")
    assert len(result) < 200
    _, (result,) = read("%*! p" + " " * 100_000 + "q(X)\n*%")
    assert len(result) < 200
