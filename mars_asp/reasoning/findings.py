"""Findings of rules: consequences, their severities, and the limits for rule packs."""

from collections.abc import Iterable, Iterator, Sequence
from functools import lru_cache

from mars_asp.asp.messages import RenderedMessage
from mars_asp.asp.rules.checks import Contract, placed
from mars_asp.asp.rules.expansions import Expansion
from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.rules.statements import Statement, argument_place
from mars_asp.asp.signature import Signature
from mars_asp.asp.solve.term_ids import arguments, as_symbol
from mars_asp.diagnostic import Diagnostic, MarsError, Severity, Span
from mars_asp.spelling import suggestion

#: Packs may minimise freely below this level; the relationships of a specification are on it.
LEAST_COST = 10
SEVERITIES: tuple[Severity, ...] = ("note", "warning", "error")
#: A consequence: kind, severity, subject and case.
CONSEQUENCE = Signature("consequence", 4)
#: A violated clause of `verify`: its number, and a term that distinguishes several violations.
VIOLATION = Signature("violation", 2)
#: A preference of a pack that a specification does not meet: level, weight and subject.
PREFERENCE = Signature("preference", 3)
#: Lower numbers are built-in clauses.
FIRST_CLAUSE = 100
#: Predicates whose reasons show no path, but only which output a name means.
MEANINGS = (
    *(Signature(name, 2) for name in ("sends", "aside_sort", "sort_of_end", "sort_of_trigger")),
    *(Signature("goes_by", 3), Signature("with_side_lines", 0)),
)


def kinds_of(rule: Rule) -> frozenset[str] | None:
    """Return the kinds of consequence that a rule names, or None if a variable is the kind."""
    return rule.firsts.get(CONSEQUENCE) if CONSEQUENCE in rule.heads else frozenset()


@lru_cache(maxsize=64)
def consequence_kinds(rulebook: Rulebook) -> frozenset[str]:
    """Return the kinds of consequence that rules name in their heads."""
    return frozenset().union(*(kinds_of(rule) or () for rule in rulebook.rules))


def wrong_constants(rule: Sequence[Statement], text: str, span: Span) -> Iterator[Diagnostic]:
    """Yield errors for unknown severities, reserved clauses and reserved levels in heads of a rule.

    `text` is the text of the rule, `span` its location.
    """
    for number, statement in enumerate(rule):
        if statement.derives == {CONSEQUENCE}:
            term = statement.head.terms[1]
            if not term.variables and term.text not in SEVERITIES:
                yield no_severity(term.text, severity_place(text, span, number))
        elif statement.derives == {VIOLATION}:
            term = statement.head.terms[0]
            if not term.variables and not (
                term.text.isdecimal() and int(term.text) >= FIRST_CLAUSE
            ):
                message = f"`{term.text}` is not a clause of a rule pack"
                advice = f"number the clauses of a pack from {FIRST_CLAUSE} on"
                place = placed(span, argument_place(text, number, 0))
                yield Diagnostic("rule-clause", "error", message, place, help=advice)
        elif statement.derives == {PREFERENCE}:
            level = statement.head.terms[0].text
            if not (level.isdecimal() and 0 < int(level) < LEAST_COST):
                message = f"`{level}` is not a level of a preference"
                advice = f"write a number from 1 to {LEAST_COST - 1}"
                place = placed(span, argument_place(text, number, 0))
                yield Diagnostic("rule-cost", "error", message, place, help=advice)


#: Why there is no consequence or node of a kind for a subject.
ABSENT = Signature("absent", 3)
#: Lists in the metadata of a rule that finds a consequence: `who` has the participants, `at` the
#: locations, and `in` the launch trees in which the consequence holds, each with its kind, subject
#: and case. `lines` has the locations that the reason of an absence cites.
EXPANSIONS = {
    "lines": Expansion(ABSENT, "cites", (0, 1, 2), False),
    "who": Expansion(CONSEQUENCE, "participant", (0, 2, 3), True),
    "at": Expansion(CONSEQUENCE, "concerns", (0, 2, 3), False, is_labelled=True),
    "in": Expansion(CONSEQUENCE, "holds_in", (0, 2, 3), False),
}
#: The limits for rule packs.
CONTRACT = Contract(
    CONSEQUENCE,
    "consequences",
    wrong_constants,
    EXPANSIONS,
    choosing=frozenset({"resolve"}),
    free_below=LEAST_COST,
    folders={"base": "consequences"},
)


def check_severities(messages: Iterable[RenderedMessage]) -> None:
    """Check that each consequence has a known severity.

    A rule may take the severity from its body, and a `#const` of a pack may replace it.

    Raises:
        MarsError: a severity is unknown; with the locations of the rules.
    """
    words = {(each.number, each.rule, str(as_symbol(arguments(each.head)[1]))) for each in messages}
    wrong = sorted((number, word, rule) for number, rule, word in words if word not in SEVERITIES)
    if wrong:
        raise MarsError(
            no_severity(word, severity_place(rule.text, rule.span), rule.text.partition("\n")[0])
            for _, word, rule in wrong
        )


def no_severity(written: str, place: Span, excerpt: str | None = None) -> Diagnostic:
    """Return the diagnostic for an unknown severity."""
    advice = suggestion(written, SEVERITIES, f"one of {', '.join(SEVERITIES)}")
    message = f"`{written}` is not a severity"
    return Diagnostic("rule-severity", "error", message, place, help=advice, excerpt=excerpt)


def severity_place(rule: str, span: Span, variant: int = 0) -> Span:
    """Return the location of the severity in the head of a rule whose text is `rule`, at `span`.

    `variant` is the index of the instance, if the rule has pools.
    """
    return placed(span, argument_place(rule, variant, 1))
