"""The outline of a file of rules: its purpose, and the predicates that it reads, derives and shows.

A file begins with comments: `%# Name: subject`, and `% Purpose: ...` over one line or several. The
predicates are read from its rules.
"""

import re
from collections.abc import Iterable
from typing import NamedTuple

from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.statements import read_by_costs, shown
from mars_asp.asp.signature import Signature

_TITLE = re.compile(r"%#\s*(.*)")
_PURPOSE = re.compile(r"%\s*Purpose:\s*(.*)")
#: A further line of a purpose is indented.
_CONTINUED = re.compile(r"% {3,}(\S.*)")


class Outline(NamedTuple):
    """The outline of a file of rules; predicates are sorted.

    `given` are predicates that rules and costs read without any rule that has them in its head,
    `decides` the predicates that a choice offers.
    """

    title: str
    purpose: str
    given: tuple[Signature, ...]
    derives: tuple[Signature, ...]
    decides: tuple[Signature, ...]
    shows: tuple[Signature, ...]


def outline(text: str, rules: Iterable[Rule]) -> Outline:
    """Return the outline of a file; `rules` are all of its text."""
    derived: set[Signature] = set()
    decided: set[Signature] = set()
    read = set(read_by_costs(text))
    for rule in rules:
        (decided if rule.is_choice else derived).update(rule.heads)
        read |= rule.reads
    title, purpose = _header(text)
    named = (read - derived - decided, derived - decided, decided, set(shown(text)))
    return Outline(title, purpose, *(tuple(sorted(each)) for each in named))


def _header(text: str) -> tuple[str, str]:
    """Return the title and the purpose in the header of a file, or "" without them."""
    title, purpose = "", list[str]()
    for line in text.split("\n"):
        if not line.startswith("%") or line.startswith("%*"):
            break
        if match := _TITLE.match(line):
            title = match[1].strip()
        elif match := _PURPOSE.match(line):
            purpose = [match[1].strip()]
        elif purpose and (match := _CONTINUED.match(line)):
            purpose.append(match[1].strip())
        elif purpose:
            break
    return title, " ".join(purpose)
