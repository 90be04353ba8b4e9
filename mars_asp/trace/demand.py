"""Which rules a question can reach, read from their texts.

Names of predicates and of function terms are not told apart, so a few rules too many may be
found, never one too few. A rule with a premise of which no atom holds cannot have fired.
"""

import re
from collections.abc import Iterator, Mapping, Sequence, Set
from functools import lru_cache
from typing import NamedTuple

from mars_asp.rulebook import Rule

_STRING = re.compile(r'"(?:[^"\\]|\\.)*"')
_COMMENT = re.compile(r"%[^\n]*")
_NAME = re.compile(r"[a-z_][\w']*")
_SIGN = re.compile(r"[(){}\[\],;:]")
_ATOM = re.compile(r"\s*([a-z_][\w']*)\s*(?:\([^=<>!]*\))?[\s.]*")
_FIRST = re.compile(r"\s*([a-z_]\w*)\(\s*([a-z]\w*)\s*,")


class _Names(NamedTuple):
    """The names in a rule: of its head, of all it reads, and of its premises."""

    head: frozenset[str]
    read: frozenset[str]
    premises: frozenset[str]


def reachable_rules(
    rules: Sequence[Rule], asked: Mapping[str, frozenset[str]], present: Set[str]
) -> tuple[int, ...]:
    """Return the numbers of the rules behind atoms, by their predicates' names.

    `asked` maps each name to the texts of the atoms' first arguments: a rule whose head begins
    with a constant that is none of them says nothing about the question. `present` are the names
    of the predicates that have any atom.
    """
    by_head: dict[str, list[int]] = {}
    for number, rule in enumerate(rules):
        names = _names_of(rule.text)
        if not names.premises <= present:
            continue
        for name in names.head:
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
        for name in _names_of(rules[number].text).read:
            if name not in demanded:
                demanded.add(name)
                waiting += by_head.get(name, ())
    return tuple(sorted(found))


def names_read(text: str) -> frozenset[str]:
    """Return every name that a rule reads, those of function terms too."""
    return _names_of(text).read


@lru_cache(maxsize=4096)
def _names_of(text: str) -> _Names:
    bare = _COMMENT.sub("", _STRING.sub('""', text))
    head, _, body = bare.partition(":-")
    # What a choice offers and the conditions of its elements are not told apart.
    read = _names(body) | (_names(head) if "{" in head else frozenset())
    return _Names(_names(head), read, frozenset(_premises(body)))


def _premises(body: str) -> Iterator[str]:
    """Yield the names of the positive literals that stand by themselves in a body."""
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
