"""Signatures of predicates, as they are used in rules, atoms and facts."""

import re
from typing import NamedTuple

import clingo

#: The separator between the name of a predicate and its name space.
SPACE = "''"
_SPACED = re.compile(r"(?<=\w)''[A-Za-z]\w*")


def plain(text: str) -> str:
    """Return a text about atoms without the name spaces of their predicates."""
    return _SPACED.sub("", text) if SPACE in text else text


class Signature(NamedTuple):
    """A predicate: its name, its arity, and whether it is not classically negated."""

    name: str
    arity: int
    positive: bool = True

    @property
    def signed(self) -> str:
        """Return its name, with `-` before if it is classically negated."""
        return self.name if self.positive else f"-{self.name}"

    @property
    def unsigned(self) -> "Signature":
        """Return the predicate without the sign of classical negation."""
        return self if self.positive else Signature(self.name, self.arity)

    def __str__(self) -> str:
        return f"{plain(self.signed)}/{self.arity}"


def signature_of(symbol: clingo.Symbol) -> Signature:
    """Return the predicate of an atom."""
    return Signature(symbol.name, len(symbol.arguments), symbol.positive)
