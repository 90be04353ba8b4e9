"""The consequences of a configuration: what the rules derive, with their messages and places.

Nothing is decided here: a consequence is an atom `consequence(Kind, Severity, Subject, Case)` of
the answer set, its message the metadata of the rule that derives it.
"""

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TypeAlias

import clingo

from mars_asp.atom import Fact
from mars_asp.conflict import check_packs
from mars_asp.diagnostic import Diagnostic, Severity
from mars_asp.facts import facts_text
from mars_asp.rulebook import Rule, Rulebook
from mars_asp.solve import Grounding
from mars_asp.source import Span

Key: TypeAlias = tuple[clingo.Symbol, clingo.Symbol, clingo.Symbol]
_SEVERITIES: tuple[Severity, ...] = ("note", "warning", "error")
_CONSEQUENCE = ("consequence", 4)
_HOLE = re.compile(r"\{([^{}]*)\}")


@dataclass(frozen=True, slots=True)
class Consequence:
    """One consequence; `spans` are the places it concerns, in the order of the file."""

    kind: str
    severity: Severity
    subject: str
    participants: tuple[str, ...]
    message: str
    help: str | None
    rule: Rule
    spans: tuple[Span, ...]
    atom: clingo.Symbol


@dataclass(frozen=True)
class Analysis:
    """All consequences, sorted by place, and the grounding they were read from."""

    consequences: tuple[Consequence, ...]
    unchecked: tuple[str, ...]
    grounding: Grounding

    @property
    def has_errors(self) -> bool:
        """Say whether a consequence is an error."""
        return any(consequence.severity == "error" for consequence in self.consequences)


def analyse(facts: Iterable[Fact], rulebook: Rulebook, configuration: Span) -> Analysis:
    """Ground the rules over facts and read off the consequences.

    `configuration` is where a consequence is placed that concerns no line.

    Raises:
        MarsError: clingo refuses the rules, or rule packs leave no answer.
    """
    facts = tuple(facts)
    speakers = [rule for rule in rulebook.rules if _speaks(rule)]
    said = "\n".join(_saying(number, rule) for number, rule in enumerate(speakers))
    text = facts_text(facts)
    grounding = Grounding(f"{rulebook.text('base')}\n{said}", text)
    check_packs(grounding.control, rulebook, text)
    places = {fact.atom.arguments[0]: fact.span for fact in facts if fact.atom.name == "place"}
    participants = _collect(grounding, "participant", 5)
    concerned = _collect(grounding, "concerns", 4)
    first: dict[clingo.Symbol, tuple[int, clingo.Symbol]] = {}
    for symbol in grounding.symbols("_said", 3):
        number, head, values = symbol.arguments
        told = (number.number, values)
        if head not in first or told < first[head]:
            first[head] = told
    consequences = []
    for head, (speaker, spoken) in first.items():
        kind, severity, subject, case = head.arguments
        key = (kind, subject, case)
        rule = speakers[speaker]
        named = dict(zip(rule.holes, spoken.arguments, strict=True))
        spans = {
            places[_plain(row[0])] for row in concerned.get(key, ()) if _plain(row[0]) in places
        }
        consequences.append(
            Consequence(
                str(kind),
                _severity(severity),
                shown(subject),
                _in_order(participants.get(key, ())),
                fill(rule.because, named) or str(head),
                fill(rule.help, named),
                rule,
                tuple(sorted(spans)) or (configuration,),
                head,
            )
        )
    consequences.sort(key=lambda c: (c.spans[0], c.kind, c.subject, c.message))
    unchecked = sorted(symbol.arguments[0].string for symbol in grounding.symbols("unchecked", 1))
    return Analysis(tuple(consequences), tuple(unchecked), grounding)


def diagnostic(consequence: Consequence) -> Diagnostic:
    """Return a consequence as a diagnostic."""
    labels = tuple((span, "this takes part") for span in consequence.spans[1:])
    return Diagnostic(
        consequence.rule.id,
        consequence.severity,
        consequence.message,
        consequence.spans[0],
        labels,
        consequence.help,
    )


def fill(text: str | None, values: Mapping[str, clingo.Symbol]) -> str | None:
    """Fill the `{Variable}` holes of a message."""
    if text is None:
        return None
    return _HOLE.sub(lambda hole: shown(values[hole[1]]) if hole[1] in values else hole[0], text)


def shown(symbol: clingo.Symbol) -> str:
    """Return a term as a message shows it: a string without its quotes."""
    return symbol.string if symbol.type == clingo.SymbolType.String else str(symbol)


def _speaks(rule: Rule) -> bool:
    name = _CONSEQUENCE[0]
    return name in rule.text and _CONSEQUENCE in rule.heads


def _saying(number: int, rule: Rule) -> str:
    """Return a rule that holds whenever `rule` does and keeps the values of its holes."""
    body = "; ".join(str(literal) for literal in rule.ast.body)
    values = "".join(f"{hole}," for hole in rule.holes)
    return f"_said({number},{rule.ast.head},v({values.rstrip(',')})) :- {body}."


def _collect(grounding: Grounding, name: str, arity: int) -> dict[Key, list[list[clingo.Symbol]]]:
    rows: dict[Key, list[list[clingo.Symbol]]] = {}
    for symbol in grounding.symbols(name, arity):
        kind, subject, case, *rest = symbol.arguments
        rows.setdefault((kind, subject, case), []).append(rest)
    return rows


def _in_order(rows: Iterable[list[clingo.Symbol]]) -> tuple[str, ...]:
    ordered = sorted(rows, key=lambda row: (row[0], str(row[1])))
    return tuple(dict.fromkeys(shown(name) for _, name in ordered))


def _plain(symbol: clingo.Symbol) -> int | str:
    if symbol.type == clingo.SymbolType.Number:
        return symbol.number
    return shown(symbol)


def _severity(symbol: clingo.Symbol) -> Severity:
    name = str(symbol)
    return next((severity for severity in _SEVERITIES if severity == name), "warning")
