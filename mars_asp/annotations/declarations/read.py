"""The declaration that begins in a stretch of code, by the scanner of its language."""

import re
from dataclasses import replace

from mars_asp.annotations.declarations.c import read_c
from mars_asp.annotations.declarations.declaration import Declaration, NoFunction
from mars_asp.annotations.declarations.go import read_go
from mars_asp.annotations.declarations.java import read_java
from mars_asp.annotations.declarations.matlab import read_matlab
from mars_asp.annotations.declarations.python import read_python
from mars_asp.annotations.declarations.rust import read_rust
from mars_asp.annotations.declarations.tokens import tokenise

_READERS = {
    "c": read_c,
    "java": read_java,
    "go": read_go,
    "rust": read_rust,
    "matlab": read_matlab,
}
#: No declaration is longer than this many characters.
_LONGEST = 20000
_PREPROCESSOR = re.compile(r"(?m)^[ \t]*#(?:\\\n|[^\n])*")
_CONDITION = re.compile(r"(?m)^[ \t]*(#)[ \t]*(?:if|elif|else)")


def read_declaration(
    language: str, text: str, code: str, begin: int, end: int
) -> Declaration | NoFunction | None:
    """Read the declaration that begins in a stretch of code; `None` where nothing stands there."""
    first = re.compile(r"\S").search(code, begin, end)
    if first is None:
        return None
    if language == "python":
        return read_python(text, code, first.start(), end)
    stretch = code[begin : min(end, begin + _LONGEST)]
    if language == "c":
        stretch = _PREPROCESSOR.sub(lambda match: " " * len(match[0]), stretch)
        stretch = stretch.replace("\\\n", "  ")
    tokens = tokenise(stretch, begin)
    if not tokens:
        return None
    found = _READERS[language](tokens, code)
    if language == "c" and isinstance(found, Declaration):
        match = _CONDITION.search(code, found.offset, found.end)
        return replace(found, conditional=match.start(1)) if match else found
    return found
