"""Names that two predicates share, in programs about anything."""

from mars_asp.asp.lint.names import shared_names
from mars_asp.asp.rules.read import read_rules
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.diagnostic import Diagnostic, by_place


def found(*texts: str) -> list[tuple[str, tuple[str, int, int], tuple[str, int, int]]]:
    """Return the findings of files, with the locations of both predicates."""
    problems: list[Diagnostic] = []
    files = [read_rules(text, f"{n}.lp", "base", problems) for n, text in enumerate(texts)]
    read = [file for file in files if file is not None]
    assert not problems and len(read) == len(texts)
    rules = tuple(rule for file in read for rule in file.rules)
    book = Rulebook(rules, tuple(("base", t) for t in texts), paths=tuple(f.shown for f in read))
    return [
        (
            each.message,
            (each.span.path, each.span.line, each.span.column),
            (each.labels[0][0].path, each.labels[0][0].line, each.labels[0][0].column),
        )
        for each in by_place(each.diagnostic for each in shared_names(book))
    ]


def test_one_name_for_two_predicates_is_reported_at_the_first_use_of_the_later() -> None:
    text = "`edge/3` shares its name with `edge/2`"
    graph = "edge(a, b). path(X, Y) :- edge(X, Y).\n"
    assert found(graph, "near(X) :- edge(X, _, 1).\nedge(a, b, 1).") == [
        (text, ("1.lp", 1, 12), ("0.lp", 1, 1))
    ]
    assert found(graph, "p :- 1 { edge(X, Y, 1) }.") == [(text, ("1.lp", 1, 10), ("0.lp", 1, 1))]
    assert found(graph, "p :- not -edge(a, b, c).") == [(text, ("1.lp", 1, 10), ("0.lp", 1, 1))]


def test_declarations_come_in_the_order_of_the_files() -> None:
    text = "`edge/3` shares its name with `edge/2`"
    assert found("#defined edge/2.", "p :- edge(1, 2, 3).") == [
        (text, ("1.lp", 1, 6), ("0.lp", 1, 1))
    ]
    assert found("p :- edge(1, 2).", "\n#defined edge/3.") == [
        (text, ("1.lp", 2, 1), ("0.lp", 1, 6))
    ]


def test_functions_strings_and_comments_name_no_predicate() -> None:
    assert (
        found('edge(a, b). p(edge(1, 2, 3)) :- q("edge(1)"). q(X) :- X = edge(1).  % edge(1)\n')
        == []
    )
