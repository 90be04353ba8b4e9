"""The declaration that annotations belong to: what `@Signature` states, else what follows them."""

import re
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import TypeAlias

from mars_asp.annotations.comments import blanked
from mars_asp.annotations.declarations import NoFunction, SourceDeclaration, read_declaration
from mars_asp.annotations.directives import Directive
from mars_asp.annotations.sources import Source, SourceRange

#: How far behind its annotations a declaration may end, in bytes; most end much earlier.
MOST_DECLARED = 16384
_STEPS = (256, 1024, 4096, MOST_DECLARED)
#: Parameters without names may be names whose types stand behind the brackets; so far, at least,
#: these are looked for.
_LEAST_OLD_STYLE = 4096
_BEHIND_ANY = re.compile(r"[()\[\]{;]")
#: A result of Go may hold braces of its own; those of the function end their line.
_BEHIND_PARAMETERS = {"go": re.compile(r"[()\[\];]|\{(?=[ \t]*\n)")}


@dataclass(frozen=True, slots=True)
class Endless:
    """A declaration that goes on for longer than is read: where it begins."""

    offset: int


Found: TypeAlias = SourceDeclaration | NoFunction | Endless | None


@dataclass(frozen=True, slots=True)
class Following:
    """What follows annotations; `found` is `None` where nothing stands there.

    `place` turns the offsets of a declaration into those of its file. `over` is whether nothing
    that stands later can belong to the annotations.
    """

    found: Found
    place: Callable[[int], int]
    over: bool


def stated(source: Source, signature: Directive) -> Following:
    """Read the declaration that a `@Signature` states; one that ends with a comma does not end."""
    if signature.rest.endswith(","):
        return Following(Endless(0), partial(signature.place, source), True)
    text = signature.rest.rstrip(":;") + (":" if source.language == "python" else ";")
    read = read_declaration(source.language, text, blanked(source.language, text))
    return Following(read, partial(signature.place, source), True)


def following(source: Source, begin: int, end: int) -> Following:
    """Read the declaration between two offsets, looking no further ahead than it needs."""
    for most in _STEPS:
        stretch = source.stretch(begin, max(begin, end), most)
        read = read_declaration(source.language, stretch.text, stretch.code)
        whole = not stretch.cut or _is_whole(source.language, read, stretch)
        if whole:
            break
    found: Found = read
    # Other words begin no function, whatever follows.
    is_other = isinstance(read, NoFunction) and read.found not in ("def", "async", "@")
    if read is not None and not whole and not is_other:
        found = Endless(read.offset)
    over = found is not None or stretch.cut
    return Following(found, partial(source.within, begin, stretch.text), over)


def _is_whole(
    language: str, read: SourceDeclaration | NoFunction | None, stretch: SourceRange
) -> bool:
    """Whether all of a declaration stands in a stretch that is cut.

    What stands behind the parameters counts as well: a return type, or in old C their types.
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
    for sign in _BEHIND_PARAMETERS.get(language, _BEHIND_ANY).finditer(stretch.code, read.end + 1):
        depth += (sign[0] in "([") - (sign[0] in ")]")
        if depth <= 0 and sign[0] in "{;":
            return True
    return False
