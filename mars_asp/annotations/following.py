"""The declaration of annotations: from `@Signature`, or from the code that follows them."""

import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

from mars_asp.annotations.comments import blanked
from mars_asp.annotations.declarations import NoFunction, SourceDeclaration, read_declaration
from mars_asp.annotations.directives import Directive
from mars_asp.annotations.sources import Source, SourceRange

#: The maximal number of characters up to the end of a declaration; most end much earlier.
MOST_DECLARED = 16384
_STEPS = (256, 1024, 4096, MOST_DECLARED)
#: Parameters without names may be names in old style, with types after the brackets. These types
#: are searched in at least this number of characters.
_LEAST_OLD_STYLE = 4096
_AFTER_ANY = re.compile(r"[()\[\]{;]")
#: A result in Go may contain braces; the brace of the function body ends its line.
_AFTER_PARAMETERS = {"go": re.compile(r"[()\[\];]|\{(?=[ \t]*\n)")}


@dataclass(frozen=True, slots=True)
class Endless:
    """A declaration that exceeds the maximal length, by its offset."""

    offset: int


Found: TypeAlias = SourceDeclaration | NoFunction | Endless | None


@dataclass(frozen=True, slots=True)
class Following:
    """The result of the search after annotations; `found` is None if no code follows.

    `place` converts offsets of a declaration into offsets of its file. `over` is whether no later
    code can belong to the annotations.
    """

    found: Found
    place: Callable[[int], int]
    over: bool


def signature_declaration(source: Source, signature: Directive) -> Following:
    """Return the declaration that `@Signature` states; `Endless` if its text ends with a comma."""
    if signature.rest.endswith(","):
        return Following(Endless(0), signature.place, True)
    text = signature.rest.rstrip(":;") + (":" if source.language == "python" else ";")
    read = read_declaration(source.language, text, blanked(source.language, text))
    return Following(read, signature.place, True)


def following(source: Source, begin: int, end: int) -> Following:
    """Return the declaration between two offsets, reading no more text than necessary."""
    for most in _STEPS:
        stretch = source.stretch(begin, max(begin, end), most)
        read = read_declaration(source.language, stretch.text, stretch.code)
        whole = not stretch.cut or _is_whole(source.language, read, stretch)
        if whole:
            break
    found: Found = read
    # Other words cannot begin a function, whatever text follows.
    is_other = isinstance(read, NoFunction) and read.found not in ("def", "async", "@")
    if read is not None and not whole and not is_other:
        found = Endless(read.offset)
    over = found is not None or stretch.cut
    return Following(found, begin.__add__, over)


def _is_whole(
    language: str, read: SourceDeclaration | NoFunction | None, stretch: SourceRange
) -> bool:
    """Whether a text that is cut off contains all of a declaration.

    The declaration extends beyond the parameters: to a return type, or to the types of old C.
    """
    if not isinstance(read, SourceDeclaration):
        return False
    if language == "python":
        return read.end < len(stretch.code)
    if language == "matlab":
        return stretch.code.find("\n", read.end) >= 0
    if language == "c" and len(stretch.code) < _LEAST_OLD_STYLE:
        if read.parameters and all(parameter.name is None for parameter in read.parameters):
            return False
    depth = 0
    for sign in _AFTER_PARAMETERS.get(language, _AFTER_ANY).finditer(stretch.code, read.end + 1):
        depth += (sign[0] in "([") - (sign[0] in ")]")
        if depth <= 0 and sign[0] in "{;":
            return True
    return False
