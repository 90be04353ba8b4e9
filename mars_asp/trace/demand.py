"""Which rules a question can reach, read from their texts.

Names of predicates and of function terms are not told apart, so a few rules too many may be
found, never one too few.
"""

import re
from collections.abc import Iterable, Mapping, Sequence
from functools import lru_cache

from mars_asp.rulebook import Rule

_STRING = re.compile(r'"(?:[^"\\]|\\.)*"')
_COMMENT = re.compile(r"%[^\n]*")
_NAME = re.compile(r"[a-z_][\w']*")
_FIRST = re.compile(r"\s*([a-z_]\w*)\(\s*([a-z]\w*)\s*,")


def reachable_rules(rules: Sequence[Rule], asked: Mapping[str, frozenset[str]]) -> tuple[int, ...]:
    """Return the numbers of the rules behind atoms, by their predicates' names.

    `asked` maps each name to the texts of the atoms' first arguments: a rule whose head begins
    with a constant that is none of them says nothing about the question.
    """
    by_head: dict[str, list[int]] = {}
    for number, rule in enumerate(rules):
        for name in _parts(rule.text)[0]:
            by_head.setdefault(name, []).append(number)
    found: set[int] = set()
    demanded = set()
    waiting = []
    for name, firsts in asked.items():
        for number in by_head.get(name, ()):
            match = _FIRST.match(rules[number].text)
            if match is None or match[1] != name or match[2] in firsts:
                waiting.append(number)
    while waiting:
        number = waiting.pop()
        if number in found:
            continue
        found.add(number)
        for name in _parts(rules[number].text)[1]:
            if name not in demanded:
                demanded.add(name)
                waiting += by_head.get(name, ())
    return tuple(sorted(found))


@lru_cache(maxsize=4096)
def _parts(text: str) -> tuple[frozenset[str], frozenset[str]]:
    """Return the names in a rule's head, and in its body and the conditions of its head."""
    bare = _COMMENT.sub("", _STRING.sub("", text))
    head, _, body = bare.partition(":-")
    # What a choice offers and the conditions of its elements are not told apart.
    return _names(head), _names(body) | (_names(head) if "{" in head else frozenset())


def _names(text: str) -> frozenset[str]:
    return frozenset(_NAME.findall(text))


def first_arguments(atoms: Iterable[tuple[str, str]]) -> dict[str, frozenset[str]]:
    """Group (name, first argument) pairs by name."""
    grouped: dict[str, set[str]] = {}
    for name, first in atoms:
        grouped.setdefault(name, set()).add(first)
    return {name: frozenset(firsts) for name, firsts in grouped.items()}
