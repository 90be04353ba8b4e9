"""A `.mars` text in which everything outside the grammar is blank, with all offsets unchanged."""

import re
from collections.abc import Iterable

from mars_asp.diagnostic import FileText
from mars_asp.model.names import QUOTED

COMMENT = re.compile(r"(?://|#)[^\n]*")
#: Inside quotes, `//` and `#` do not begin a comment.
QUOTED_OR_COMMENT = re.compile(f"(?P<quoted>{QUOTED})|{COMMENT.pattern}")
#: A statement continues after a comma, before one, and before the tuple of a mount. The
#: lookbehind keeps this linear: of several blanks only the first is tried.
_CONTINUED = re.compile(r"(?=\s)(?<=\S)(?:(?<=,)[^\S\n]*+\n\s*+|[^\S\n]*+\n\s*+(?=[,(]))")
#: Necessary for a continued statement; faster to search, as each begins with a literal character.
_GOES_ON = (re.compile(r",[^\S\n]*+\n"), re.compile(r"\n[^\S\n]*+[,(]"))


class Layout(FileText):
    """The original text, and the text that the grammar reads."""

    def __init__(self, path: str, text: str, grammatical: str) -> None:
        """Keep a text, and its grammatical form, in which all else is blank."""
        super().__init__(path, text)
        self.grammatical = grammatical


def lay_out(path: str, text: str, blocks: Iterable[tuple[int, int]]) -> Layout:
    r"""Return the layout of a text: comments, module blocks and line ends in statements are blank.

    `text` has `\n` for every line end; `blocks` are (first, last) lines of module blocks.
    """
    lines = text.split("\n")
    for first, last in blocks:
        lines[first - 1 : last] = [" " * len(line) for line in lines[first - 1 : last]]
    read = "\n".join(lines)
    if any(sign in read for sign in ('"', "//", "#")):
        read = QUOTED_OR_COMMENT.sub(lambda match: match["quoted"] or " " * len(match[0]), read)
    if any(sign.search(read) for sign in _GOES_ON):
        read = _CONTINUED.sub(lambda match: match[0].replace("\n", " "), read)
    return Layout(path, text, read + "\n")
