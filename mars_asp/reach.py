"""Which rules a question can reach: those behind what it asks for, and what they read.

A rule with a premise of which no atom holds cannot have fired.
"""

from collections.abc import Iterable, Mapping, Sequence, Set

from mars_asp.statements import Literal, Signature, Statement, constants


def reachable_rules(
    rules: Sequence[Sequence[Statement]],
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
        for statement in variants:
            if present is None or _names(statement.body.positive) <= present:
                for signature in statement.derives:
                    deriving.setdefault(signature, []).append(number)
                fixed = not replaced or replaced.isdisjoint(constants(statement.text).names)
                if any(_is_asked(head.literal, asked, fixed) for head in statement.heads):
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


def reads(rule: Iterable[Statement]) -> frozenset[Signature]:
    """Return the predicates that a rule reads."""
    return frozenset().union(*(statement.reads for statement in rule))


def _is_asked(head: Literal, asked: Mapping[str, frozenset[str]], fixed: bool) -> bool:
    name, arity = head.signature
    if name not in asked:
        return False
    first = head.terms[0].constant if arity and fixed else None
    return first is None or first in asked[name]


def _names(literals: Iterable[Literal]) -> frozenset[str]:
    return frozenset(literal.signature[0] for literal in literals)
