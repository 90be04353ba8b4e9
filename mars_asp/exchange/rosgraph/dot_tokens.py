"""The tokens of a graph in DOT, with locations (https://graphviz.org/doc/info/lang.html)."""

import re
from bisect import bisect_right
from collections.abc import Iterator
from typing import NamedTuple

from mars_asp.diagnostic import Diagnostic, MarsError, Span

_TOKEN = re.compile(
    r"(?P<skipped>(?:\s++|//[^\n]*+|(?m:^)#[^\n]*+)++|/\*(?:[^*]|\*(?!/))*+\*/)"
    r'|"(?P<quoted>[^"\\]*+(?:\\(?s:.)[^"\\]*+)*+)"|(?P<html><)'
    r"|(?P<word>[^\W\d]\w*+|-?(?:\.[0-9]++|[0-9]++(?:\.[0-9]*+)?))|(?P<mark>->|--|[{}\[\];,=:+])"
)
_ANGLE = re.compile(r"[<>]")
_CONTINUED = re.compile(r"\\\r?\n")
#: The beginnings of tokens that may have no end, with the error and the help.
_OPEN = {"/*": ("this comment does not end", "write `*/`")}
_OPEN['"'] = ("this text does not end", 'write `"` after it')


class DotToken(NamedTuple):
    """A token: its sort, its text without quotes, and its location.

    Sorts are `word`, `quoted`, `html`, `mark`, and `end` for the end of the text.
    """

    sort: str
    text: str
    span: Span

    def is_mark(self, *marks: str) -> bool:
        """Whether this is one of some marks."""
        return self.sort == "mark" and self.text in marks


def tokens(text: str, path: str) -> Iterator[DotToken]:
    """Yield the tokens of a text without comments, and one for its end.

    Raises:
        MarsError: a text or comment that does not end, or a character that begins no token.
    """
    starts = [0, *(match.end() for match in re.finditer("\n", text))]

    def place(offset: int) -> tuple[int, int]:
        line = bisect_right(starts, offset)
        return line, offset - starts[line - 1] + 1

    at = 0
    while at < len(text):
        match = _TOKEN.match(text, at)
        if match is None:
            opening = next((sign for sign in _OPEN if text.startswith(sign, at)), text[at])
            unknown = f"character U+{ord(text[at]):04X} has no meaning here", "put names in quotes"
            span = Span(path, *place(at), *place(at + len(opening)))
            raise wrong(span, *_OPEN.get(opening, unknown))
        sort, end = match.lastgroup or "", match.end()
        if sort == "html":
            end = _end_of_html(text, at)
            if end == 0:
                span = Span(path, *place(at), *place(at + 1))
                raise wrong(span, "this text in HTML does not end", "write `>` after it")
        if sort != "skipped":
            inner = "" if sort == "html" else _CONTINUED.sub("", match[sort])
            yield DotToken(sort, inner, Span(path, *place(at), *place(end)))
        at = end
    yield DotToken("end", "", Span(path, *place(at), *place(at)))


def _end_of_html(text: str, at: int) -> int:
    """Return the index after the `>` that closes the `<` at an index, or 0 if there is none."""
    depth = 0
    for angle in _ANGLE.finditer(text, at):
        depth += 1 if angle[0] == "<" else -1
        if depth == 0:
            return angle.end()
    return 0


def wrong(span: Span, message: str, help_text: str) -> MarsError:
    """Return an error that ends the reading of a graph."""
    return MarsError((Diagnostic("dot", "error", message, span, help=help_text),))
