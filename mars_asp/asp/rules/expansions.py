"""Rules that metadata expand to, so that the body of the rule below is not repeated.

A host defines the rules for a key of metadata. If `who` gives `part(Name, Order, Who)` above a rule
that derives `found(Name, ...)`, the first two lines mean the three rules below:

    %! who: S, C; E@R : helps(R, E, S)
    found(N, S) :- seen(N, S, C).

    part(N, 0, S) :- seen(N, S, C).
    part(N, 1, C) :- seen(N, S, C).
    part(N, R, E) :- seen(N, S, C); helps(R, E, S).

A list has elements between semicolons; each is one term or several, and may have a condition after
a colon. After `@` follows the order of a term, by default its index in the list.

A term may have a label, a message in quotes with holes like those of `because`:

    %! at: R; R' "`{C}` was seen here before" : first(R', C)
"""

import re
from collections.abc import Callable, Iterator, Mapping
from functools import lru_cache
from typing import NamedTuple, TypeAlias

from mars_asp.asp.rules.computed import computations, leaves
from mars_asp.asp.rules.gate import check_text
from mars_asp.asp.rules.rule import HOLE, Rule
from mars_asp.asp.rules.statements import (
    Operation,
    RuleSyntaxError,
    bound_variables,
    operands,
    pieces,
    statements,
)
from mars_asp.asp.rules.trees import names_in
from mars_asp.asp.signature import Signature
from mars_asp.asp.units import UNITS
from mars_asp.diagnostic import Diagnostic, MarsError, Span

_TOKEN = re.compile(r'"(?:\\.|[^"\\])*"|.', re.DOTALL)
_STRING = re.compile(r'"(?:\\.|[^"\\])*"')
_VARIABLE = re.compile(r"(?<!\w)_*[A-Z]\w*'*")
_LABELLED = re.compile(r'(.*\S)\s+"((?:\\.|[^"\\])*)"', re.DOTALL)


#: The maximal number of terms in a list, each of which is a rule.
MOST_ELEMENTS = 2000


class Expansion(NamedTuple):
    """The expansion of a key of metadata above a rule that derives `of`.

    For each listed term, `gives` is derived. Its arguments are those of the head at the positions
    `kept`, the order of the term if the expansion `is_ordered`, and the term. Terms may have labels
    if it `is_labelled`.
    """

    of: Signature
    gives: str
    kept: tuple[int, ...]
    is_ordered: bool
    is_labelled: bool = False


#: The expansions of metadata keys, by key.
Expansions: TypeAlias = Mapping[str, Expansion]


class _Element(NamedTuple):
    """One term of a list in rule metadata, with its order, condition and label as text."""

    term: str
    order: str
    condition: str
    label: str | None


class Label(NamedTuple):
    """The label of a listed term: the message, and the rule's body with the term's condition."""

    term: str
    text: str
    body: str

    @property
    def holes(self) -> tuple[str, ...]:
        """Return the variables that the message names, each once."""
        return tuple(dict.fromkeys(name for name, _ in HOLE.findall(self.text)))


def expanded(
    rule: Rule, key: str, written: str, place: Span, expansion: Expansion
) -> Iterator[Rule]:
    """Yield the rules that a line of metadata expands to; `wrong` must have no objections.

    `written` is the text after the key, `place` its location. The rules have the location of the
    rule above which the line is, and its id followed by the key.
    """
    head, body = rule.statements[0].head, rule.written[1]
    kept = [head.terms[position].text for position in expansion.kept]
    for number, element in enumerate(_elements(written)):
        order = [element.order or str(number)] if expansion.is_ordered else []
        found = f"{expansion.gives}({','.join((*kept, *order, element.term))})"
        text = _rule_text(found, "; ".join(filter(None, (body, element.condition))))
        own = f"{rule.id}:{key}{number + 1 if number else ''}"
        yield Rule(own, None, None, rule.span, text, rule.stage, listed=place)


def labels(rule: Rule, expansions: Expansions) -> Iterator[Label]:
    """Yield the labels in the lists above a rule."""
    for key, written in rule.lists:
        if key in expansions and expansions[key].is_labelled and '"' in written:
            for element in _elements(written):
                if element.label is not None:
                    body = "; ".join(filter(None, (rule.written[1], element.condition)))
                    yield Label(element.term, element.label, body)


def with_conditions(written: str, change: Callable[[str], str]) -> str:
    """Return the list `written` of a key, each condition replaced by `change(condition)`."""
    found = []
    for term, order, condition, label in _elements(written):
        parts = [f"{term}@{order}" if order else term]
        parts += [] if label is None else [f'"{label}"']
        parts += [f": {change(condition)}"] if condition else []
        found.append(" ".join(parts))
    return "; ".join(found)


def _rule_text(head: str, body: str) -> str:
    return f"{head} :- {body}." if body else f"{head}."


def _is_above(rule: Rule, expansion: Expansion) -> bool:
    """Whether a rule derives only the predicate of an expansion.

    Its body may have pools: all variants derive the same.
    """
    first = rule.statements[0]
    return first.forces and all(
        each.forces and each.head.signature == expansion.of and each.head.terms == first.head.terms
        for each in rule.statements
    )


def wrong(
    rule: Rule, key: str, written: str, place: Span, expansion: Expansion
) -> Iterator[Diagnostic]:
    """Yield the errors in a line of metadata, except those that clingo finds in its rules."""
    if not _is_above(rule, expansion):
        message = f"`{key}` is above a rule that does not derive `{expansion.of}` alone"
        advice = f"leave it out, or give the rule a head `{expansion.of}`"
        yield _expansion_error(message, place, advice)
        return
    advice = f"write `%! {key}: NAME, NAME : CONDITION; NAME`"
    for element in _elements(written):
        if not element.term:
            yield _expansion_error(f"`{key}` lists nothing", place, advice)
            return
        if element.order and not expansion.is_ordered:
            yield _expansion_error(f"`{key}` has no order, so `@` has no effect", place, advice)
            return
        if element.label is not None and not expansion.is_labelled:
            yield _expansion_error(f"`{key}` takes no labels", place, advice)
            return
    local = names_in(rule.node) - bound_variables(rule.text)
    for name in sorted(local.intersection(_VARIABLE.findall(_STRING.sub("", written)))):
        message = (
            f"`{name}` of `{key}` is a different variable in an aggregate or negation of the rule"
        )
        yield _expansion_error(message, place, f"give it a name of its own, `{name}'`")
        return
    elements = _elements(written)
    if len(elements) > MOST_ELEMENTS:
        yield _expansion_error(f"`{key}` lists more than {MOST_ELEMENTS} terms", place, advice)
        return
    for element, made in zip(elements, expanded(rule, key, written, place, expansion), strict=True):
        alone = _rule_text(f"x({element.order or 0},{element.term})", element.condition)
        pools = len(rule.statements)
        if not _is_rule(made.text, place.path, pools) or not _is_rule(alone, place.path):
            message = f"`{key}` cannot be read: it means `{made.text}`"
            yield _expansion_error(message, place, advice)
            return
        # Overflows are reported for rules in files, and this one is in no file.
        for operand in operands(alone):
            if isinstance(operand, Operation) and leaves(operand):
                message = f"`{key}` computes `{operand.text}`"
                yield _expansion_error(message, place, "let the body of the rule compute it")
                return
        if computations([alone]).get(alone):
            message = f"`{key}` computes a sum in `{element.condition}`"
            yield _expansion_error(message, place, "let the body of the rule compute it")
            return
        yield from _wrong_label(element, made, key, place)


def _wrong_label(element: _Element, made: Rule, key: str, place: Span) -> Iterator[Diagnostic]:
    """Yield errors for holes of a label that the rule `made` for its element does not bind."""
    holes = HOLE.findall(element.label or "")
    names = {name for name, _ in holes}
    for hole, sort in holes:
        if sort and sort not in UNITS:
            message = f"`{{{hole}:{sort}}}` in a label of `{key}` names no sort with a unit"
            yield _expansion_error(message, place, "name a measure, such as `milliseconds`")
    for hole in sorted(names - bound_variables(made.text) if names else ()):
        message = f"`{{{hole}}}` in a label of `{key}` is not a variable of the rule's body"
        yield _expansion_error(
            message, place, "name a variable of the rule or of the label's condition"
        )


def _is_rule(text: str, shown: str, readings: int = 1) -> bool:
    """Whether a text is exactly one rule, whose pools have `readings` variants."""
    try:
        check_text(text, shown)
        sorts = [piece.sort for piece in pieces(text) if piece.sort != "begin"]
    except (MarsError, RuleSyntaxError):
        return False
    return sorts == ["rule"] and len(statements(text)) == readings


@lru_cache(maxsize=1024)
def _elements(written: str) -> tuple[_Element, ...]:
    return tuple(_elements_of(written))


def _elements_of(written: str) -> Iterator[_Element]:
    for element in split(written, ";"):
        terms, *condition = split(element, ":", 1)
        for term in split(terms, ","):
            match = _LABELLED.fullmatch(term)
            bare, label = (match[1], match[2]) if match else (term, None)
            name, *order = split(bare, "@", 1)
            yield _Element(name, "".join(order), "".join(condition), label)


def split(written: str, sign: str, most: int = -1) -> list[str]:
    """Return a text split at `sign` (at most `most` times) outside brackets and strings."""
    parts, depth = [""], 0
    for match in _TOKEN.finditer(written):
        token = match[0]
        depth += (token in "([{") - (token in ")]}")
        if token == sign and depth == 0 and len(parts) - 1 != most:
            parts.append("")
        else:
            parts[-1] += token
    return [part.strip() for part in parts]


def _expansion_error(message: str, place: Span, advice: str) -> Diagnostic:
    return Diagnostic("rule-metadata", "error", message, place, help=advice)
