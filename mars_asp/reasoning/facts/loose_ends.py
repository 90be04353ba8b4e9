"""Which outputs are like which inputs, by their representations and names.

How near two names are is a number that is no matter of reasoning: the share of words that they have
in common and the share of letters in order (Ratcliff and Metzener, 1988, as `difflib` has it).
"""

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from functools import lru_cache
from typing import NamedTuple

from mars_asp.diagnostic import Span

#: So many candidates are told of an input.
MOST = 3
#: Of more outputs than this, letters are compared only of those with the most words in common.
_MOST_COMPARED = 12
_WORD = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|[0-9]+|[^\W_A-Za-z0-9]+")


class Port(NamedTuple):
    """An output or input: its annotation, its place there, its module, name and representation."""

    annotation: int
    place: int
    span: Span
    module: str
    port: str
    representation: str | None


def nearest(inputs: Iterable[Port], outputs: Iterable[Port]) -> Iterator[tuple[Port, Port, int]]:
    """Yield inputs with the outputs of other modules that are most like them, and their rank."""
    by_representation: dict[str, list[Port]] = {}
    for output in outputs:
        if output.representation is not None:
            by_representation.setdefault(output.representation, []).append(output)
    pools = {name: _Pool(pool) for name, pool in by_representation.items()}
    for entry in inputs:
        pool = None if entry.representation is None else pools.get(entry.representation)
        if pool is not None:
            for rank, output in enumerate(pool.nearest(entry)):
                yield entry, output, rank


class _Pool:
    """Outputs of one representation."""

    def __init__(self, outputs: Sequence[Port]) -> None:
        self.outputs = outputs
        self.words = [_words(output.port) for output in outputs]
        self.by_word: dict[str, list[int]] = {}
        self.compared: dict[frozenset[str], Sequence[int]] = {}
        for number, words in enumerate(self.words):
            for word in words:
                self.by_word.setdefault(word, []).append(number)

    def nearest(self, entry: Port) -> list[Port]:
        words = _words(entry.port)
        # In large configurations most inputs are called like others.
        numbers = self.compared.get(words)
        if numbers is None:
            numbers = self.compared[words] = self._alike(words)
        ranked = sorted(
            (-self._likeness(entry, words, number), self.outputs[number])
            for number in numbers
            if self.outputs[number].module != entry.module
        )
        return [output for _, output in ranked[:MOST]]

    def _alike(self, words: frozenset[str]) -> Sequence[int]:
        """Return the outputs to compare letter by letter."""
        if len(self.outputs) <= _MOST_COMPARED:
            return range(len(self.outputs))
        common: Counter[int] = Counter()
        for word in sorted(words):
            numbers = self.by_word.get(word, ())
            # What stands in most names tells nothing.
            if len(numbers) * 4 <= len(self.outputs) or len(numbers) <= _MOST_COMPARED:
                common.update(numbers)
        if not common:
            return range(_MOST_COMPARED)
        return [number for number, _ in common.most_common(_MOST_COMPARED)]

    def _likeness(self, entry: Port, words: frozenset[str], number: int) -> float:
        other = self.words[number]
        either = words | other
        shared = len(words & other) / len(either) if either else 0.0
        return shared + _letters(entry.port, self.outputs[number].port)


@lru_cache(maxsize=100_000)
def _letters(name: str, other: str) -> float:
    """Return the share of letters in order, 0 to 1."""
    # Few configurations have loose ends of one type.
    from difflib import SequenceMatcher  # noqa: PLC0415

    return SequenceMatcher(None, name, other, autojunk=False).ratio()


@lru_cache(maxsize=100_000)
def _words(name: str) -> frozenset[str]:
    return frozenset(word.lower() for word in _WORD.findall(name))
