"""What the values in rules are: sorts that predicates declare, handed on from rule to rule.

A name, or what identifies a thing, is of one sort alone, so a variable that stands for two never
has a value; a number that stands for two measures compares what cannot be compared.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from typing import NamedTuple, TypeAlias

from mars_asp.asp.rules.checks import placed
from mars_asp.asp.rules.declarations import Declaration
from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.statements import Literal, Scope, Statement, statements_of
from mars_asp.asp.signature import Signature
from mars_asp.diagnostic import Diagnostic, Span
from mars_asp.spelling import nearest

#: The sorts of values: `None` where they can be of any.
Sorts: TypeAlias = frozenset[str] | None
_Known: TypeAlias = Mapping[Signature, Sequence[Sorts]]


class _Use(NamedTuple):
    """Where a variable stands, and the sorts that its values have there."""

    literal: Literal
    sorts: frozenset[str]


def wrong_sorts(
    rules: Iterable[Rule], declared: Mapping[Signature, Declaration], constants: Set[str]
) -> Iterator[Diagnostic]:
    """Yield the variables of rules that stand for values of two sorts, and unknown constants.

    `constants` are those that `#const` replaces by other values.
    """
    rules = tuple(rules)
    read = statements_of(rule.text for rule in rules)
    known = _inferred([each for variants in read.values() for each in variants], declared)
    for rule in rules:
        found: dict[tuple[Span, str], Diagnostic] = {}
        for statement in read[rule.text]:
            for each in (
                *_contradictions(statement, known, rule.span),
                *_unknown_constants(statement, declared, constants, rule.span),
            ):
                found.setdefault((each.span, each.message), each)
        yield from found.values()


def _inferred(
    rules: Sequence[Statement], declared: Mapping[Signature, Declaration]
) -> Mapping[Signature, Sequence[Sorts]]:
    """Return the sorts of the arguments of all predicates.

    What is declared holds. Other arguments have what the rules that derive them give: at first
    nothing, and more until nothing changes.
    """
    known: dict[Signature, list[Sorts]] = {
        signature: [argument.sorts or None for argument in each.arguments]
        for signature, each in declared.items()
    }
    open_places: dict[Signature, list[int]] = {}
    for statement in rules:
        for head in statement.heads:
            signature = head.literal.signature.unsigned
            if signature not in open_places:
                sorts = known.setdefault(signature, [None] * signature.arity)
                open_places[signature] = [at for at, each in enumerate(sorts) if each is None]
                for at in open_places[signature]:
                    sorts[at] = frozenset()
    reading: dict[Signature, list[int]] = {}
    for number, statement in enumerate(rules):
        for signature in {literal.signature.unsigned for literal in statement.read}:
            reading.setdefault(signature, []).append(number)
    # Once each in the order in which they were asked for, so that a long chain takes no longer.
    waiting = dict.fromkeys(range(len(rules)))
    while waiting:
        number = next(iter(waiting))
        del waiting[number]
        for signature in _handed_on(rules[number], known, open_places):
            waiting.update(dict.fromkeys(reading.get(signature, ())))
    return known


def _handed_on(
    statement: Statement,
    known: dict[Signature, list[Sorts]],
    open_places: Mapping[Signature, Sequence[int]],
) -> Iterator[Signature]:
    """Note what a rule hands on to its heads, and yield the predicates of which more is known."""
    for head in statement.heads:
        signature = head.literal.signature.unsigned
        scope = (*statement.body.positive, *head.condition.positive)
        for at in open_places[signature]:
            before = known[signature][at]
            term = head.literal.terms[at]
            given = _meet(_uses(term.text, scope, known)) if term.is_variable else None
            if before is not None and (given is None or not given <= before):
                known[signature][at] = None if given is None else before | given
                yield signature


def _uses(variable: str, literals: Iterable[Literal], known: _Known) -> Iterator[_Use]:
    """Yield where a variable stands in literals as an argument that has sorts."""
    for literal in literals:
        sorts = known.get(literal.signature.unsigned, ())
        for term, each in zip(literal.terms, sorts, strict=False):
            if term.is_variable and term.text == variable and each is not None:
                yield _Use(literal, each)


def _meet(uses: Iterable[_Use]) -> Sorts:
    """Return the sorts that a variable has wherever it stands."""
    found: Sorts = None
    for use in uses:
        found = use.sorts if found is None else found & use.sorts
    return found


def _contradictions(statement: Statement, known: _Known, span: Span) -> Iterator[Diagnostic]:
    # What is negated holds of what is another sort, and nothing that a head gives keeps it back.
    conditions = (head.condition for head in statement.heads)
    for scope in (Scope(()), *statement.inner, *conditions):
        literals = (*statement.body.positive, *scope.positive)
        names = {t.text for each in literals for t in each.terms if t.is_variable}
        for name in sorted(names):
            first: _Use | None = None
            for use in _uses(name, literals, known):
                if not use.sorts:
                    continue
                if first is not None and not first.sorts & use.sorts:
                    message = f"`{name}` is a {_in_words(first)} and a {_in_words(use)}"
                    advice = (
                        "these are two things: use two variables, and state how they are related"
                    )
                    place = placed(span, use.literal.place)
                    yield Diagnostic("rule-sort", "warning", message, place, help=advice)
                    break
                first = use if first is None else _Use(first.literal, first.sorts & use.sorts)


def _in_words(use: _Use) -> str:
    return f"{' or '.join(sorted(use.sorts))} in `{use.literal.signature.unsigned}`"


def _unknown_constants(
    statement: Statement,
    declared: Mapping[Signature, Declaration],
    replaced: Set[str],
    span: Span,
) -> Iterator[Diagnostic]:
    """Yield the constants in arguments that are declared to be one of some others."""
    for literal in statement.literals:
        declaration = declared.get(literal.signature.unsigned)
        if declaration is None:
            continue
        for term, argument in zip(literal.terms, declaration.arguments, strict=True):
            written = term.constant
            if not argument.constants or written is None:
                continue
            if written not in argument.constants and written not in replaced:
                near = nearest(written, argument.constants)
                known = ", ".join(argument.constants)
                message = f"`{argument.name}` of `{declaration.signature}` is never `{written}`"
                advice = f"did you mean `{near}`?" if near else f"one of {known}"
                place = placed(span, literal.place)
                yield Diagnostic("rule-sort", "warning", message, place, help=advice)
