"""What rules find: consequences, how severe they are, and what packs may say of them."""

from collections.abc import Iterable, Iterator, Sequence

from mars_asp.asp.messages import RenderedMessage
from mars_asp.asp.rules.checks import Contract, placed
from mars_asp.asp.rules.expansions import Expansion
from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.rules.statements import Statement, argument_place
from mars_asp.asp.signature import Signature
from mars_asp.asp.solve.term_ids import arguments, as_symbol
from mars_asp.diagnostic import Diagnostic, MarsError, Severity, Span
from mars_asp.spelling import nearest

#: Below this level packs may minimise what they like: the lines of a specification come above it.
LEAST_COST = 10
SEVERITIES: tuple[Severity, ...] = ("note", "warning", "error")
#: What rules find: kind, severity, subject and case.
CONSEQUENCE = Signature("consequence", 4)
#: What is wrong with a specification: the number of the clause that fails, and what tells apart.
VIOLATION = Signature("violation", 2)
#: A preference of a pack that a specification does not meet: level, weight and subject.
PREFERENCE = Signature("preference", 3)
#: The clauses below are ours.
FIRST_CLAUSE = 100


def kinds_of(rule: Rule) -> frozenset[str] | None:
    """Return the kinds of consequence that a rule names, or None if it can derive any."""
    return rule.firsts.get(CONSEQUENCE) if CONSEQUENCE in rule.heads else frozenset()


def consequence_kinds(rulebook: Rulebook) -> frozenset[str]:
    """Return the kinds of consequence that rules name in their heads."""
    return frozenset().union(*(kinds_of(rule) or () for rule in rulebook.rules))


def wrong_constants(rule: Sequence[Statement], text: str, span: Span) -> Iterator[Diagnostic]:
    """Yield the severities in the heads of a rule that are none, and clauses and levels not free.

    `text` is that of the rule, `span` where it stands.
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
#: What metadata of a rule lists that finds a consequence: `who` takes part, `at` which places, and
#: `in` which launch trees it holds, each with its kind, subject and case. `lines` are the places
#: that the reason of an absence speaks of.
EXPANSIONS = {
    "lines": Expansion(ABSENT, "cites", (0, 1, 2), False),
    "who": Expansion(CONSEQUENCE, "participant", (0, 2, 3), True),
    "at": Expansion(CONSEQUENCE, "concerns", (0, 2, 3), False, is_labelled=True),
    "in": Expansion(CONSEQUENCE, "holds_in", (0, 2, 3), False),
}
#: What a rule pack from elsewhere may do.
CONTRACT = Contract(
    CONSEQUENCE,
    "consequences",
    wrong_constants,
    EXPANSIONS,
    choosing=frozenset({"resolve"}),
    free_below=LEAST_COST,
    folders={"base": "consequences"},
)


def check_severities(said: Iterable[RenderedMessage]) -> None:
    """Check that how severe a consequence is, is one of the words for that.

    A rule may take the word from its body, and a `#const` of a pack may replace it.

    Raises:
        MarsError: it is another word; the rules with places.
    """
    words = {(each.number, each.rule, str(as_symbol(arguments(each.head)[1]))) for each in said}
    wrong = sorted((number, word, rule) for number, rule, word in words if word not in SEVERITIES)
    if wrong:
        raise MarsError(
            no_severity(word, severity_place(rule.text, rule.span), rule.text.partition("\n")[0])
            for _, word, rule in wrong
        )


def no_severity(written: str, place: Span, excerpt: str | None = None) -> Diagnostic:
    """Return the diagnostic for an unknown severity."""
    near = nearest(written, SEVERITIES)
    advice = f"did you mean `{near}`?" if near else f"one of {', '.join(SEVERITIES)}"
    message = f"`{written}` is not a severity"
    return Diagnostic("rule-severity", "error", message, place, help=advice, excerpt=excerpt)


def severity_place(rule: str, span: Span, variant: int = 0) -> Span:
    """Return where the head of a rule that stands at `span` says how severe a consequence is.

    Of a rule with pools, `variant` is the number of the one that is meant.
    """
    return placed(span, argument_place(rule, variant, 1))
