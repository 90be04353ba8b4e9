"""Which rules a question can reach.

Predicates are told apart by name and arity, but not by sign, so a few rules too many may be found,
never one too few. A rule with a premise of which no atom holds cannot have fired.
"""

import re
from collections.abc import Iterator, Mapping, Sequence, Set
from functools import lru_cache
from typing import TypeAlias

from mars_asp.rulebook import Rule

#: A predicate's name and arity.
Predicate: TypeAlias = tuple[str, int]

_STRING = re.compile(r'"(?:[^"\\]|\\.)*"')
_COMMENT = re.compile(r"%[^\n]*")
_NAME = re.compile(r"[a-z_][\w']*")
_SIGN = re.compile(r"[(){}\[\],;:]")
_ATOM = re.compile(r"\s*([a-z_][\w']*)\s*(?:\([^=<>!]*\))?[\s.]*")
_FIRST = re.compile(r"\s*([a-z_]\w*)\(\s*([a-z]\w*)\s*,")


def reachable_rules(
    rules: Sequence[Rule], asked: Mapping[str, frozenset[str]], present: Set[str]
) -> tuple[int, ...]:
    """Return the numbers of the rules behind atoms, by their predicates' names.

    `asked` maps each name to the texts of the atoms' first arguments: a rule whose head begins
    with a constant that is none of them says nothing about the question. `present` are the names
    of the predicates that have any atom.
    """
    by_head: dict[Predicate, list[int]] = {}
    for number, rule in enumerate(rules):
        if _premises(rule.text) <= present:
            for head in rule.heads:
                by_head.setdefault(head, []).append(number)
    found: set[int] = set()
    demanded: set[Predicate] = set()
    waiting = []
    for (name, _), numbers in by_head.items():
        for number in numbers if name in asked else ():
            match = _FIRST.match(rules[number].text)
            if match is None or match[1] != name or match[2] in asked[name]:
                waiting.append(number)
    while waiting:
        number = waiting.pop()
        if number in found:
            continue
        found.add(number)
        for predicate in rules[number].reads - demanded:
            demanded.add(predicate)
            waiting += by_head.get(predicate, ())
    return tuple(sorted(found))


@lru_cache(maxsize=4096)
def names_read(text: str) -> frozenset[str]:
    """Return every name that a rule reads, those of function terms too."""
    head, body = _parts(text)
    # What a choice offers and the conditions of its elements are not told apart.
    return _names(body) | (_names(head) if "{" in head else frozenset())


@lru_cache(maxsize=4096)
def _premises(text: str) -> frozenset[str]:
    """Return the names of the positive literals that stand by themselves in a body."""
    return frozenset(_alone(_parts(text)[1]))


def _parts(text: str) -> tuple[str, str]:
    """Return head and body, without what strings and comments say."""
    head, _, body = _COMMENT.sub("", _STRING.sub('""', text)).partition(":-")
    return head, body


def _alone(body: str) -> Iterator[str]:
    depth = start = 0
    conditional = False
    for sign in _SIGN.finditer(f"{body};"):
        if sign[0] in "({[":
            depth += 1
        elif sign[0] in ")}]":
            depth -= 1
        elif depth:
            continue
        elif sign[0] == ":":
            conditional = True
        else:
            atom = None if conditional else _ATOM.fullmatch(body[start : sign.start()])
            if atom is not None:
                yield atom[1]
            # A comma behind a `:` goes on with its condition.
            conditional = conditional and sign[0] == ","
            start = sign.end()


def _names(text: str) -> frozenset[str]:
    return frozenset(_NAME.findall(text))
