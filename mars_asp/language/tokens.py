"""The statements of a `.mars` text as tokens with their offsets."""

import re
from collections.abc import Iterator
from dataclasses import dataclass

from mars_asp.language.layout import Layout
from mars_asp.model.names import QUOTED, read_end

#: A name and its port are one token.
_TOKEN = re.compile(rf"[(),=:]|(?:{QUOTED}|[^\s(),=:])+")
_PATH = re.compile(r",|[^\s,](?:[^,\n]*[^\s,])?")
_LIST = re.compile(r"\s*(@sources|@include|@modules)")


@dataclass(frozen=True, slots=True)
class Token:
    """A token of a statement: its text, and where it begins and ends in the file."""

    text: str
    begin: int
    end: int

    @property
    def name(self) -> str:
        """Return the module name in the token, unquoted and without a port."""
        found = read_end(self.text)
        return self.text if found is None else found[0]


def statements(layout: Layout) -> Iterator[tuple[Token, ...]]:
    """Yield the tokens of each statement, in the order of the file."""
    begin = 0
    for piece in layout.grammatical.removesuffix("\n").split("\n"):
        if piece.strip():
            yield tuple(tokens_of(layout, begin, begin + len(piece)))
        begin += len(piece) + 1


def tokens_of(layout: Layout, begin: int, end: int) -> list[Token]:
    """Return the tokens of the statement between two offsets."""
    text = layout.grammatical
    head = _LIST.match(text, begin, end)
    spans = [] if head is None else [head.span(1)]
    names = _PATH if head is not None and head[1] != "@modules" else _TOKEN
    rest = names.finditer(text, head.end() if head else begin, end)
    spans += (match.span() for match in rest)
    # In the grammar's text a line end or a comment inside a path is blank, so use the original.
    return [Token(layout.text[begin:end], begin, end) for begin, end in spans]
