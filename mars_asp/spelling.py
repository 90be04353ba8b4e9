"""What a misspelt word was probably meant to be."""

import difflib
from collections.abc import Iterable


def nearest(word: str, known: Iterable[str], likeness: float = 0.6) -> str | None:
    """The known word most like `word`, or None if none is alike.

    A word that differs in case only comes first. `likeness` is the least ratio, 0 to 1, of
    Ratcliff and Metzener, Pattern Matching: The Gestalt Approach, Dr. Dobb's Journal, July 1988.
    """
    words = sorted(known)
    for candidate in words:
        if candidate.lower() == word.lower():
            return candidate
    return next(iter(difflib.get_close_matches(word, reversed(words), 1, likeness)), None)
