"""A `.mars` text in which everything outside the grammar is blank, with all offsets unchanged."""

import re
from bisect import bisect_right
from collections.abc import Iterable
from itertools import accumulate
from typing import NamedTuple

from mars_asp.diagnostic import Span
from mars_asp.model.names import QUOTED

COMMENT = re.compile(r"(?://|#)[^\n]*")
#: Inside quotes, `//` and `#` do not begin a comment.
QUOTED_OR_COMMENT = re.compile(f"(?P<quoted>{QUOTED})|{COMMENT.pattern}")
#: A statement continues after a comma, before one, and before the tuple of a mount. The
#: lookbehind keeps this linear: of several blanks only the first is tried.
_CONTINUED = re.compile(r"(?=\s)(?<=\S)(?:(?<=,)[^\S\n]*+\n\s*+|[^\S\n]*+\n\s*+(?=[,(]))")
#: Necessary for a continued statement; faster to search, as each begins with a literal character.
_GOES_ON = (re.compile(r",[^\S\n]*+\n"), re.compile(r"\n[^\S\n]*+[,(]"))


class Layout(NamedTuple):
    """The original text, the text that the grammar reads, and the offsets of lines."""

    path: str
    text: str
    grammatical: str
    starts: tuple[int, ...]

    def position(self, offset: int) -> tuple[int, int]:
        """Return the line and column, from 1, of an offset."""
        line = bisect_right(self.starts, offset)
        return line, offset - self.starts[line - 1] + 1

    def span(self, begin: int, end: int) -> Span:
        """Return the span between two offsets."""
        line, column = self.position(begin)
        # Most spans end on the line where they begin.
        if begin <= end < self.starts[line] if line < len(self.starts) else begin <= end:
            return Span(self.path, line, column, line, column + end - begin)
        return Span(self.path, line, column, *self.position(end))

    def line(self, number: int) -> str:
        """Return a line without its end."""
        end = self.starts[number] if number < len(self.starts) else len(self.text)
        return self.text[self.starts[number - 1] : end].rstrip("\n ")


def lay_out(path: str, text: str, blocks: Iterable[tuple[int, int]]) -> Layout:
    r"""Return the layout of a text: comments, module blocks and line ends in statements are blank.

    `text` has `\n` for every line end; `blocks` are (first, last) lines of module blocks.
    """
    lines = text.split("\n")
    starts = accumulate([len(line) + 1 for line in lines[:-1]], initial=0)
    for first, last in blocks:
        lines[first - 1 : last] = [" " * len(line) for line in lines[first - 1 : last]]
    read = "\n".join(lines)
    if any(sign in read for sign in ('"', "//", "#")):
        read = QUOTED_OR_COMMENT.sub(lambda match: match["quoted"] or " " * len(match[0]), read)
    if any(sign.search(read) for sign in _GOES_ON):
        read = _CONTINUED.sub(lambda match: match[0].replace("\n", " "), read)
    return Layout(path, text, read + "\n", tuple(starts))
