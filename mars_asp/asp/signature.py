"""What names a predicate, wherever rules, atoms and facts are spoken of."""

from typing import NamedTuple

import clingo


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
        return f"{self.signed}/{self.arity}"


def signature_of(symbol: clingo.Symbol) -> Signature:
    """Return the predicate of an atom."""
    return Signature(symbol.name, len(symbol.arguments), symbol.positive)
