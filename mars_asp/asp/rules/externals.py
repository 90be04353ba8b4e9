"""Externals of a program: atoms whose truth is set from outside, by `#external`."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from mars_asp.asp.fragments import Fragment
from mars_asp.asp.rules.statements import Piece, external_of
from mars_asp.diagnostic import Span, point

_VALUES = {"true": True, "false": False, "free": None}


class External(NamedTuple):
    """A statement `#external atom : body. [value]`; a value of None leaves its atoms free."""

    atom: str
    body: str
    value: bool | None
    span: Span

    def marked(self, predicate: str, number: int) -> str:
        """Return a rule that derives `predicate(number, ...)` for each atom of the external."""
        atom = f"{predicate}({number},{self.atom})"
        return f"{atom} :- {self.body}." if self.body else f"{atom}."

    def fragment(self, predicate: str, number: int) -> Fragment:
        """Return `marked(predicate, number)` as a fragment of a program."""
        return Fragment(self.marked(predicate, number), self.span.path, self.span)


def externals_of(pieces: Sequence[Piece], shown: str) -> Iterator[External]:
    """Yield the externals of a file."""
    for piece in pieces:
        if piece.sort == "external":
            for atom, body, value in external_of(piece.text):
                known = value if value in _VALUES else "false"
                yield External(atom, body, _VALUES[known], point(shown, *piece.begin))
