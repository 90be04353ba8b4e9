"""Predicates that rules read and nothing gives, in programs about anything."""

from mars_asp.asp.lint.clauses import clauses_of
from mars_asp.asp.lint.predicates import unknown
from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.signature import Signature
from mars_asp.diagnostic import point


def test_each_rule_that_reads_a_predicate_of_no_rule_and_no_input_is_reported() -> None:
    texts = (
        "far(X) :- edge(X, Y), gone(Y).",
        "near(X) :- edge(X, X), not far(X).",
        "lone :- not gone(1), -far(2), missing.",
    )
    rules = [
        Rule(f"r:{line}", None, None, point("r.lp", line, 1), text, "base")
        for line, text in enumerate(texts, 1)
    ]
    clauses = [clause for read in clauses_of(rules).values() for clause in read]
    found = [each.diagnostic for each in unknown(clauses, {Signature("edge", 2)})]
    assert [(each.span.line, each.message) for each in found] == [
        (1, "nothing gives or derives `gone/1`"),
        (3, "nothing gives or derives `gone/1`"),
        (3, "nothing gives or derives `missing/0`"),
    ]
