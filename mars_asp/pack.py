"""What clingo would say of a rule pack too late, or without the place, or not at all."""

import re
from collections.abc import Iterable, Iterator, Sequence, Set

import clingo

from mars_asp.diagnostic import Diagnostic, Severity
from mars_asp.source import Span, point
from mars_asp.spelling import nearest
from mars_asp.statements import Place, Signature, Statement, argument_place, masked, unsigned

_PLACE = re.compile(r"<block>:(\d+):(\d+)(?:-[\d:]+)?: error: (.*)", re.DOTALL)
_UNSAFE = re.compile(r"note: '(\w+)' is unsafe")

SEVERITIES: tuple[Severity, ...] = ("note", "warning", "error")

#: What rules find: kind, severity, subject and case.
CONSEQUENCE: Signature = ("consequence", 4)
#: What a rule pack from elsewhere may derive besides predicates of its own.
EXTENSIBLE: frozenset[Signature] = frozenset(
    {CONSEQUENCE, ("participant", 5), ("concerns", 4), ("edit", 5)}
)


def refused_rules(text: str, shown: str) -> Iterator[Diagnostic]:
    """Yield what clingo says against the rules of a text; none of them is grounded here."""
    notes: list[str] = []
    control = clingo.Control(["--warn=none"], lambda _, note: notes.append(note))
    try:
        # Clingo's columns count bytes, and it cuts what it says of a text between them.
        control.add("base", [], masked(text))
        control.ground([("nothing", [])])
    except RuntimeError:
        for match in filter(None, map(_PLACE.match, notes)):
            place = point(shown, int(match[1]), int(match[2]))
            unsafe = [f"`{name}`" for name in _UNSAFE.findall(match[3])]
            if unsafe:
                message = f"nothing in the body binds {' and '.join(dict.fromkeys(unsafe))}"
                advice = "name it in a literal of the body that is not negated"
                yield Diagnostic("rule-unsafe", "error", message, place, help=advice)
            else:
                yield Diagnostic("rule-syntax", "error", " ".join(match[3].split()), place)


def unknown_predicates(
    rule: Iterable[Statement], known: Set[Signature], span: Span
) -> Iterator[Diagnostic]:
    """Yield the predicates of a rule that nobody gives or derives: a misspelt rule never fires.

    `span` is where the rule stands, for the places of what it says count from its beginning.
    """
    literals = {(each.place, unsigned(each.signature)) for one in rule for each in one.literals}
    for place, (name, arity) in sorted(literals):
        if (name, arity) not in known:
            near = nearest(name, sorted({other for other, _ in known}))
            others = sorted(f"`{other}/{n}`" for other, n in known if other == near)
            yield Diagnostic(
                "rule-unknown",
                "error",
                f"nothing gives or derives `{name}/{arity}`",
                placed(span, place),
                help=f"did you mean {' or '.join(others)}?"
                if others
                else f"`rules/vocabulary.lp` says what is given; write `#defined {name}/{arity}.` "
                "where only some facts hold it",
            )


def misused_heads(rule: Sequence[Statement], text: str, span: Span) -> Iterator[Diagnostic]:
    """Yield what is wrong with a head that tells of a consequence: a choice, or no severity.

    `text` is that of the rule, `span` where it stands, for the places of what it says count from
    its beginning.
    """
    for number, statement in enumerate(rule):
        told = sorted({unsigned(each) for each in statement.derives} & EXTENSIBLE)
        if told and not statement.forces:
            name, arity = told[0]
            negated = len(statement.heads) == 1 and not statement.head.binds
            where = "behind `not`" if negated else "in a choice, disjunction or condition"
            yield Diagnostic(
                "rule-head",
                "error",
                f"`{name}/{arity}` stands {where}",
                placed(span, statement.place),
                help="what is found follows from the facts: write a rule with this head alone",
            )
            return
        if told and statement.head.is_negated:
            name, arity = told[0]
            yield Diagnostic(
                "rule-head",
                "error",
                f"`-{name}/{arity}` says what is not found",
                placed(span, statement.place),
                help="only what is found is reported: leave out the rule",
            )
        elif statement.derives == {CONSEQUENCE}:
            term = statement.head.terms[1]
            if not term.variables and term.text not in SEVERITIES:
                yield no_severity(term.text, severity_place(text, span, number))


def no_severity(written: str, place: Span, excerpt: str | None = None) -> Diagnostic:
    """Return what is said of a severity that is none."""
    near = nearest(written, SEVERITIES)
    advice = f"did you mean `{near}`?" if near else f"one of {', '.join(SEVERITIES)}"
    message = f"`{written}` is no severity"
    return Diagnostic("rule-severity", "error", message, place, help=advice, excerpt=excerpt)


def severity_place(rule: str, span: Span, variant: int = 0) -> Span:
    """Return where the head of a rule that stands at `span` says how severe a consequence is.

    Of a rule with pools, `variant` is the number of the one that is meant.
    """
    return placed(span, argument_place(rule, variant, 1))


def placed(span: Span, place: Place) -> Span:
    """Return where something stands in a file that has a place in the rule at `span`."""
    line, column = place
    return point(span.path, span.line + line - 1, column + (span.column - 1) * (line == 1))
