"""Which rules a question can reach: those behind what it asks for, and what they read.

A rule with a premise of which no atom holds cannot have fired.
"""

from collections.abc import Iterable, Mapping, Sequence, Set
from pathlib import Path
from typing import NamedTuple

from mars_asp.asp.cache import made_of
from mars_asp.asp.rules import statements as reader
from mars_asp.asp.rules.statements import Statement, constants, statements
from mars_asp.asp.signature import Signature


class Outline(NamedTuple):
    """What decides whether a question reaches a rule without pools: what it derives and reads.

    `heads` are the names of the predicates in its head, each with the first argument where that is
    a constant; `needs` are those of the predicates without which it cannot fire; `constants` those
    of the constants that it names.
    """

    heads: tuple[tuple[str, str | None], ...]
    needs: frozenset[str]
    derives: frozenset[Signature]
    reads: frozenset[Signature]
    constants: frozenset[str]


def outlines_of(texts: Iterable[str]) -> list[tuple[Outline, ...]]:
    """Return the outlines of rules: most of what they say is not asked."""
    asked = tuple(texts)
    files = map(Path, (__file__, reader.__file__))
    made = made_of("outlines", files, asked, lambda text: tuple(map(_outline, statements(text))))
    return [made[text] for text in asked]


def reachable_rules(
    rules: Sequence[Sequence[Outline]],
    asked: Mapping[str, frozenset[str]],
    present: Set[str] | None,
    replaced: Set[str] = frozenset(),
) -> tuple[int, ...]:
    """Return the numbers of the rules behind atoms, by their predicates' names.

    `asked` maps each name to the texts of the atoms' first arguments: a rule whose head begins
    with a constant that is none of them says nothing about the question. `present` are the names
    of the predicates that have any atom, `None` where each may have some; `replaced` are constants
    that stand for other values.
    """
    deriving: dict[Signature, list[int]] = {}
    waiting: list[int] = []
    for number, variants in enumerate(rules):
        for outline in variants:
            if present is None or outline.needs <= present:
                for signature in outline.derives:
                    deriving.setdefault(signature, []).append(number)
                fixed = replaced.isdisjoint(outline.constants)
                if any(_is_asked(head, asked, fixed) for head in outline.heads):
                    waiting.append(number)
    found: set[int] = set()
    demanded: set[Signature] = set()
    while waiting:
        number = waiting.pop()
        if number not in found:
            found.add(number)
            for signature in reads(rules[number]) - demanded:
                demanded.add(signature)
                waiting += deriving.get(signature, ())
    return tuple(sorted(found))


def reads(rule: Iterable[Outline]) -> frozenset[Signature]:
    """Return the predicates that a rule reads."""
    return frozenset().union(*(outline.reads for outline in rule))


def _outline(statement: Statement) -> Outline:
    heads = (head.literal for head in statement.heads)
    return Outline(
        tuple(
            (each.signature.signed, each.terms[0].constant if each.terms else None)
            for each in heads
        ),
        frozenset(literal.signature.signed for literal in statement.body.positive),
        statement.derives,
        statement.reads,
        constants(statement.text).names,
    )


def _is_asked(
    head: tuple[str, str | None], asked: Mapping[str, frozenset[str]], fixed: bool
) -> bool:
    name, first = head
    return name in asked and (first is None or not fixed or first in asked[name])
