"""The tokens of a graph in DOT, with locations (https://graphviz.org/doc/info/lang.html)."""

import re
from bisect import bisect_right
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal, TypeAlias

from mars_asp.diagnostic import Diagnostic, MarsError, Span

Sort: TypeAlias = Literal["word", "quoted", "html", "mark"]
_SKIPPED = re.compile(r"(?:\s++|//[^\n]*+|(?m:^)#[^\n]*+)++")
_MARK = re.compile(r"->|--|[{}\[\];,=:+]")
_WORD = re.compile(r"[^\W\d]\w*+|-?(?:\.[0-9]++|[0-9]++(?:\.[0-9]*+)?)")
_QUOTED = re.compile(r'"([^"\\]*+(?:\\.[^"\\]*+)*+)"', re.DOTALL)
_ANGLE = re.compile(r"[<>]")
_CONTINUED = re.compile(r"\\\r?\n")


@dataclass(frozen=True, slots=True)
class DotToken:
    """A token: its text without quotes, and its begin and end in the source."""

    sort: Sort
    text: str
    begin: int
    end: int


class DotPlaces:
    """The lines and columns of offsets in a text."""

    def __init__(self, text: str, path: str) -> None:
        """Find where the lines of a text begin."""
        self.path = path
        self.starts = [0, *(match.end() for match in re.finditer("\n", text))]

    def span(self, begin: int, end: int) -> Span:
        """Return the stretch between two offsets."""
        return Span(self.path, *self._line_and_column(begin), *self._line_and_column(end))

    def _line_and_column(self, offset: int) -> tuple[int, int]:
        line = bisect_right(self.starts, offset)
        return line, offset - self.starts[line - 1] + 1


def tokens(text: str, places: DotPlaces) -> Iterator[DotToken]:
    """Yield the tokens of a text without comments.

    Raises:
        MarsError: a text or comment that does not end, or a character that begins no token.
    """
    at = 0
    while at < len(text):
        skipped = _SKIPPED.match(text, at)
        if skipped is not None:
            at = skipped.end()
            continue
        if text.startswith("/*", at):
            end = text.find("*/", at + 2)
            if end < 0:
                raise wrong(places.span(at, at + 2), "this comment does not end", "write `*/`")
            at = end + 2
            continue
        token = _token(text, at, places)
        yield token
        at = token.end


def _token(text: str, at: int, places: DotPlaces) -> DotToken:
    if text[at] == '"':
        quoted = _QUOTED.match(text, at)
        if quoted is None:
            raise wrong(places.span(at, at + 1), "this text does not end", 'write `"` after it')
        return DotToken("quoted", _CONTINUED.sub("", quoted[1]), at, quoted.end())
    if text[at] == "<":
        return DotToken("html", "", at, _end_of_html(text, at, places))
    word = _WORD.match(text, at)
    if word is not None:
        return DotToken("word", word[0], at, word.end())
    mark = _MARK.match(text, at)
    if mark is None:
        message = f"character U+{ord(text[at]):04X} has no meaning here"
        raise wrong(places.span(at, at + 1), message, "put names in quotes")
    return DotToken("mark", mark[0], at, mark.end())


def _end_of_html(text: str, at: int, places: DotPlaces) -> int:
    depth = 0
    for angle in _ANGLE.finditer(text, at):
        depth += 1 if angle[0] == "<" else -1
        if depth == 0:
            return angle.end()
    raise wrong(places.span(at, at + 1), "this text in HTML does not end", "write `>` after it")


def wrong(span: Span, message: str, help_text: str) -> MarsError:
    """Return the error of a graph that is read no further."""
    return MarsError((Diagnostic("dot", "error", message, span, help=help_text),))
