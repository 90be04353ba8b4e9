"""Comments and strings of a source: those with an annotation, and code with all of them blanked.

Every pattern is total: an alternative that could match an unterminated comment or string does match
it, so lexing is linear for any text.
"""

import re
from collections.abc import Iterable, Iterator
from functools import cache

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


#: A word that may be an annotation word, other than frequent words of documentation.
_CANDIDATE = re.compile(
    r"(?a)@(?!(?:param|returns?|brief|throws|see|since|note)\b)"
    r"[A-Za-z](?:\w{2,20}+(?![\w(.])|\w{0,20}+[^\x00-\x7f])"
)
#: An annotation without comment marks; in quotes, `#` and `//` begin no comment.
_UNMARKED = re.compile(r'(?:[^\n/#"]++|"(?:[^"\\\n]|\\.)*+"|"|/(?!/))*+')
_UNMARKED_BEGIN = re.compile(r"(?m)^[ \t]*+(?=@)")


@cache
def _pattern(language: str) -> re.Pattern[str]:
    return re.compile(_PATTERNS[language])


def tokens(language: str, text: str, at: int = 0) -> Iterator[tuple[int, int, str | None]]:
    """Yield the begin, the end and the kind of each comment and string from `at` on.

    The kind is `comment`, `blank` for other text without code, `kept` for code that resembles a
    string, and `None`, `tag` or `hash` for a string. `at` is outside of all strings and comments.
    """
    if language not in _NEST:
        for each in _pattern(language).finditer(text, at):
            yield *each.span(), each.lastgroup
        return
    opening, marks = _NEST[language]
    search = _pattern(language).search
    while match := search(text, at):
        begin, end = match.span()
        if opening.match(text, begin):
            end = _nested_end(marks.finditer(text, begin), len(text))
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


def annotated_comments(language: str, text: str) -> Iterator[tuple[int, int]]:
    """Yield the begin and end of each comment with a word that may be an annotation.

    In module blocks of a configuration they are annotations, without comment marks.
    """
    if language == "mars":
        for match in _UNMARKED_BEGIN.finditer(text):
            yield match.end(), annotation_end(text, match.end())
        return
    last = text.rfind("@")
    for begin, end, kind in tokens(language, text):
        if begin > last:
            return
        if kind == "comment" and _CANDIDATE.search(text, begin, end):
            # A block comment of MATLAB has its line to itself.
            yield end - len(text[begin:end].lstrip(" \t")), end


def annotation_end(text: str, at: int) -> int:
    """Return the end of the unmarked annotation, or its continuation line, that begins at `at`."""
    found = _UNMARKED.match(text, at)
    return found.end() if found else at


def inner_comments(language: str, text: str, begin: int, end: int) -> Iterator[tuple[int, int]]:
    """Yield the begin and end of each comment that is nested in a block comment, in order."""
    if language not in _NEST:
        return
    depth = opened = 0
    line = begin if language == "rust" else text.rfind("\n", 0, begin) + 1
    for mark in _NEST[language][1].finditer(text, line, end):
        depth += 1 if mark.lastindex else -1
        if depth == 2 and mark.lastindex:
            opened = mark.start()
        elif depth == 1 and not mark.lastindex:
            yield opened, mark.end()
    if depth > 1:
        yield opened, end


def _nested_end(marks: Iterable[re.Match[str]], last: int) -> int:
    """Return the end of a block comment of Rust or MATLAB, which can contain others.

    Args:
        marks: The marks of block comments from its own on; those that open have a group.
        last: The end of the text, which ends an unclosed comment.
    """
    depth = 0
    for mark in marks:
        depth += 1 if mark.lastindex else -1
        if not depth:
            return mark.end()
    return last
