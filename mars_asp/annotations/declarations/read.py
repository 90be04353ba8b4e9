"""The declaration at the begin of a source text, read by the scanner of its language."""

import re
from dataclasses import replace
from functools import lru_cache

from mars_asp.annotations.declarations.c import read_c
from mars_asp.annotations.declarations.declaration import NoFunction, SourceDeclaration
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
_SOLID = re.compile(r"\S")
_PREPROCESSOR = re.compile(r"(?m)^[ \t]*#(?:\\\n|[^\n])*")
_CONDITION = re.compile(r"(?m)^[ \t]*(#)[ \t]*(?:if|elif|else)")


# Configurations of many equal robots repeat their declarations.
@lru_cache(maxsize=4096)
def read_declaration(language: str, text: str, code: str) -> SourceDeclaration | NoFunction | None:
    """Return the declaration at the begin of a text, or None if there is no code.

    Args:
        language: A key of the languages.
        text: The text.
        code: The text with comments and strings blanked; offsets are indices of both.
    """
    first = _SOLID.search(code)
    if first is None:
        return None
    if language == "python":
        return read_python(text, code, first.start(), len(code))
    plain = code
    if language == "c":
        plain = _PREPROCESSOR.sub(lambda match: " " * len(match[0]), code).replace("\\\n", "  ")
    tokens = tokenise(plain)
    if not tokens:
        return None
    found = _READERS[language](tokens, code)
    if language == "c" and isinstance(found, SourceDeclaration):
        match = _CONDITION.search(code, found.offset, found.end)
        return replace(found, conditional=match.start(1)) if match else found
    return found
