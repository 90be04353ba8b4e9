"""Representation names, and which of them are equal (language reference, section 9)."""

import re
from collections.abc import Iterable, Mapping
from typing import NamedTuple

_WORD = re.compile(r"[A-Za-z_][\w:]*")


class RepresentationNames(NamedTuple):
    """Each name's canonical form, and the names that may abbreviate several others."""

    canonical: Mapping[str, str]
    ambiguous: Mapping[str, tuple[str, ...]]


def canonical_names(names: Iterable[str]) -> RepresentationNames:
    """Return a canonical form for equal names: a name equals the only longer name that ends in it.

    The longer names count as one if they are `::`-suffixes of one another.
    """
    every = set(names)
    words = {word for name in every for word in _WORD.findall(name)}
    longer: dict[str, set[str]] = {}
    for word in words:
        parts = word.split("::")
        for start in range(1, len(parts)):
            longer.setdefault("::".join(parts[start:]), set()).add(word)
    full: dict[str, str] = {}
    unclear: dict[str, tuple[str, ...]] = {}
    for word in words:
        candidates = longer.get(word, set())
        longest = max(candidates, key=len, default=word)
        if all(longest == other or longest.endswith(f"::{other}") for other in candidates):
            full[word] = longest
        else:
            full[word] = word
            unclear[word] = tuple(sorted(candidates))
    canonical = {name: _WORD.sub(lambda match: full[match[0]], name) for name in every}
    ambiguous = {}
    for name in every:
        doubtful = [word for word in _WORD.findall(name) if word in unclear]
        if doubtful:
            ambiguous[name] = unclear[doubtful[0]]
    return RepresentationNames(canonical, ambiguous)
