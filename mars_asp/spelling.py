"""Suggestions for misspelt words: the most similar known words."""

from collections.abc import Collection, Iterable, Iterator
from functools import lru_cache
from itertools import islice
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    from difflib import SequenceMatcher

#: Advice where no known word is alike.
_Advice = TypeVar("_Advice", str, None)
#: So many pairs of names are compared at most; a pair takes some 15 microseconds.
_MOST_COMPARED = 100_000
#: The similarity of words that differ by two neighbouring letters in the other order. Words of two
#: letters are other names then.
_SWAPPED, _LEAST_LETTERS = 0.9, 3


def nearest(word: str, known: Iterable[str], likeness: float = 0.6) -> str | None:
    """Return the known word most similar to `word`, or None if none is similar enough.

    A word that differs in case only comes first. `likeness` is the least ratio, 0 to 1, of
    Ratcliff and Metzener, Pattern Matching: The Gestalt Approach, Dr. Dobb's Journal, July 1988.
    """
    words = sorted(known)
    for candidate in words:
        if candidate.lower() == word.lower():
            return candidate
    alike = ((_ratio(word, candidate, likeness), candidate) for candidate in words)
    best, candidate = max(alike, default=(0.0, ""))
    return candidate if best >= likeness else None


def suggestion(
    word: str, known: Iterable[str], otherwise: _Advice, likeness: float = 0.6
) -> str | _Advice:
    """Return the question "did you mean ...?" for the nearest known word, else `otherwise`."""
    near = nearest(word, known, likeness)
    return f"did you mean `{near}`?" if near else otherwise


@lru_cache(maxsize=_MOST_COMPARED)
def _ratio(word: str, candidate: str, likeness: float) -> float:
    """Return the similarity of two words(0 to 1), 0 if it is below `likeness`.

    The same words are compared again wherever an edit of a configuration is tried.
    """
    if _is_swapped(word, candidate):
        return _SWAPPED
    matcher = _matcher(word)
    matcher.set_seq1(candidate)
    if matcher.real_quick_ratio() < likeness or matcher.quick_ratio() < likeness:
        return 0.0
    ratio = matcher.ratio()
    return ratio if ratio >= likeness else 0.0


def _is_swapped(word: str, other: str) -> bool:
    """Whether two words differ by two neighbouring letters in the other order.

    The ratio of short words does not show that: it is two thirds for words of three letters.
    """
    swaps = (f"{word[:n]}{word[n + 1]}{word[n]}{word[n + 2 :]}" for n in range(len(word) - 1))
    return len(word) == len(other) >= _LEAST_LETTERS and word != other and other in swaps


@lru_cache(maxsize=1)
def _matcher(word: str) -> "SequenceMatcher[str]":
    """Return a matcher for a word, which is costly to prepare."""
    # Few words are misspelt, so that few commands need it.
    from difflib import SequenceMatcher  # noqa: PLC0415

    return SequenceMatcher(None, "", word)


def resemblances(
    names: Iterable[str], known: Collection[str], likeness: float
) -> Iterator[tuple[str, str]]:
    """Yield each name that resembles a known one, with the most similar known name.

    Of very many names only the first are compared, as the time grows with the product of both
    numbers, and very many unknown names are hardly misspelt.
    """
    if known:
        for name in islice(names, max(1, _MOST_COMPARED // len(known))):
            if near := nearest(name, known, likeness):
                yield name, near
