"""The rules that an atom can depend on: those that derive it, and recursively their premises.

A rule with a premise of which no atom holds cannot have fired.
"""

from collections.abc import Iterable, Mapping, Sequence, Set
from pathlib import Path
from typing import NamedTuple

from mars_asp.asp.cache import memoized
from mars_asp.asp.rules.statements import FILES, Statement, constants, statements
from mars_asp.asp.signature import Signature


class Dependencies(NamedTuple):
    """The predicates that a rule without pools derives and reads.

    `heads` are the names of the predicates in its head, each with its first argument if constant;
    `needs` are the names of its positive premises, without which it cannot fire; `constants` are
    the names of its constants.
    """

    heads: tuple[tuple[str, str | None], ...]
    needs: frozenset[str]
    derives: frozenset[Signature]
    reads: frozenset[Signature]
    constants: frozenset[str]


def dependencies_of(texts: Iterable[str]) -> list[tuple[Dependencies, ...]]:
    """Return the dependencies of each rule: one entry for each variant without pools."""
    keys = tuple(texts)
    made = memoized(
        "dependencies",
        (Path(__file__), *FILES),
        keys,
        lambda text: tuple(map(_dependencies, statements(text))),
    )
    return [made[text] for text in keys]


def reachable_rules(
    rules: Sequence[Sequence[Dependencies]],
    queried: Mapping[str, frozenset[str]],
    present: Set[str] | None,
    replaced: Set[str] = frozenset(),
) -> tuple[int, ...]:
    """Return the numbers of the rules that atoms can depend on, by their predicates' names.

    `queried` maps each name to the texts of the first arguments of the atoms: a rule whose head
    begins with another constant is left out. `present` are the names of the predicates with atoms,
    or None if any predicate may have some; `replaced` are constants with other values.
    """
    deriving: dict[Signature, list[int]] = {}
    waiting: list[int] = []
    for number, variants in enumerate(rules):
        for each in variants:
            if present is None or each.needs <= present:
                for signature in each.derives:
                    deriving.setdefault(signature, []).append(number)
                fixed = replaced.isdisjoint(each.constants)
                if any(
                    name in queried and (first is None or not fixed or first in queried[name])
                    for name, first in each.heads
                ):
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


def reads(rule: Iterable[Dependencies]) -> frozenset[Signature]:
    """Return the predicates that the variants of a rule read."""
    return frozenset().union(*(each.reads for each in rule))


def _dependencies(statement: Statement) -> Dependencies:
    heads = (head.literal for head in statement.heads)
    return Dependencies(
        tuple(
            (each.signature.signed, each.terms[0].constant if each.terms else None)
            for each in heads
        ),
        frozenset(literal.signature.signed for literal in statement.body.positive),
        statement.derives,
        statement.reads,
        constants(statement.text).names,
    )
