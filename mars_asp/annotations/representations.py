"""Representation names: when two of them are the same (language reference, section 9)."""

import re
from collections.abc import Iterable, Mapping
from typing import NamedTuple

_WORD = re.compile(r"[A-Za-z_][\w:]*")


class RepresentationNames(NamedTuple):
    """Each name's canonical form, and the names that may stand for several."""

    canonical: Mapping[str, str]
    ambiguous: Mapping[str, tuple[str, ...]]


def canonical_names(names: Iterable[str]) -> RepresentationNames:
    """Find the names that are equal: the same, or the only `::`-suffix of another.

    Where the longer names that end in a name are suffixes of one another they count as one.
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
