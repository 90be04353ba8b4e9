"""Source code with its comments and strings blanked.

Every pattern is total: an alternative that could match an unterminated comment or string does match
it, so lexing is linear for any text.
"""

import re
from collections.abc import Iterator
from functools import cache

from mars_asp.annotations.skim import nested_end

_BLOCK = r"/\*[\s\S]*?(?:\*/|\Z)"
_LINE = r"//(?:\\\n|[^\n])*+"
_STRING = r'"(?:\\[\s\S]|[^"\\\n])*+"?'
_CHARACTER = r"'(?:\\.|[^'\\\n])*+'?"
_NUMBER = r"(?<![\w])\d(?:'?\w)*+"
_TRIPLE = r'"""(?:\\[\s\S]|(?!""")[\s\S])*+(?:"""|\Z)'
_RAW = r'(?:u8|[uUL])?R"(?P<tag>[^()\\\s"]{0,16}+)\([\s\S]*?(?:\)(?P=tag)"|\Z)'
_C = rf"(?P<comment>{_BLOCK}|{_LINE})|{_RAW}|{_STRING}|(?P<kept>{_NUMBER})|{_CHARACTER}"
_PATTERNS = {
    # The look ahead fails at most characters, which is faster than to try each alternative.
    "c": rf"(?=[/\"'uULR\d])(?:{_C})",
    "mars": rf"(?P<blank>(?m:^)[ \t]*+@[A-Za-z](?:[^\n/#]|/(?!/))*+|\#[^\n]*+)|{_C}",
    "java": rf"(?P<comment>{_BLOCK}|{_LINE})|{_TRIPLE}|{_STRING}|{_CHARACTER}",
    "go": rf"(?P<comment>{_BLOCK}|{_LINE})|`[^`]*+`?|{_STRING}|{_CHARACTER}",
    "rust": (
        rf"(?P<comment>{_BLOCK}|{_LINE})|b?r(?P<hash>\#{{0,8}}+)\"[\s\S]*?(?:\"(?P=hash)|\Z)"
        rf"|b?{_STRING}|b?'(?:\\[^\n']*+'|[^'\\\n]')"
    ),
    "python": (
        r"(?P<comment>\#[^\n]*+)"
        r"|[A-Za-z]{0,2}+(?:'''(?:\\[\s\S]|(?!''')[\s\S])*+(?:'''|\Z)|" + _TRIPLE + ")"
        r"|'(?:\\[\s\S]|[^'\\\n])*+'?|" + _STRING
    ),
    "matlab": (
        r"(?P<comment>(?m:^)[ \t]*+%\{[ \t]*+(?=\n)[\s\S]*?(?:\n[ \t]*+%\}[ \t]*+(?=\n|\Z)|\Z)"
        r"|%[^\n]*+)|(?P<blank>\.\.\.[^\n]*+)|(?P<kept>(?<=[\w)\]}.'])')|'(?:''|[^'\n])*+'?"
        r"|\"(?:\"\"|[^\"\n])*+\"?"
    ),
}
#: Patterns of languages with nested block comments: the opening mark, and all marks.
_NEST = {
    "rust": (re.compile(r"/\*"), re.compile(r"(/\*)|\*/")),
    "matlab": (
        re.compile(r"(?m)^[ \t]*+%\{[ \t]*+\n"),
        re.compile(r"(?m)^[ \t]*+(?:(%\{)|%\})[ \t]*+$"),
    ),
}


@cache
def _pattern(language: str) -> re.Pattern[str]:
    return re.compile(_PATTERNS[language])


def tokens(language: str, text: str) -> Iterator[tuple[int, int, str | None]]:
    """Yield the begin, the end and the kind of each comment and string.

    The kind is `comment`, `blank` for other text without code, `kept` for code that resembles a
    string, and `None`, `tag` or `hash` for a string.
    """
    if language not in _NEST:
        for each in _pattern(language).finditer(text):
            yield *each.span(), each.lastgroup
        return
    opening, marks = _NEST[language]
    search = _pattern(language).search
    at = 0
    while match := search(text, at):
        begin, end = match.span()
        if opening.match(text, begin):
            end = nested_end(marks.finditer(text, begin), len(text))
        yield begin, end, match.lastgroup
        at = max(end, begin + 1)


def blanked(language: str, text: str) -> str:
    r"""Return a text, whose lines end with `\n`, with spaces for all comments and strings.

    A string remains a string of spaces, `"   "`. Nothing moves.
    """
    pieces: list[str] = []
    last = 0
    for begin, end, kind in tokens(language, text):
        if kind == "kept" or text[begin:end] == "'":
            continue
        pieces.append(text[last:begin])
        blank = "\n".join(" " * len(line) for line in text[begin:end].split("\n"))
        string = kind not in ("comment", "blank") and end - begin > 1
        pieces.append(f'"{blank[1:-1]}"' if string else blank)
        last = end
    pieces.append(text[last:])
    return "".join(pieces)
