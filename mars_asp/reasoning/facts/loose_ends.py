"""Which outputs are like which inputs, by their representations and names.

Names are compared by the words and letters that they share, and modules by the namespaces that
they do not share. All outputs of a representation are compared with each of its inputs.
"""

import re
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence, Set
from functools import lru_cache
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple, TypeAlias

from mars_asp.diagnostic import Span

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    _Scores: TypeAlias = NDArray[np.float64]
    #: The numbers of names, and how often each has a feature.
    _Column: TypeAlias = tuple[NDArray[np.int64] | slice, NDArray[np.int64]]

#: The largest number of candidates of an input.
MOST = 3
#: Equal names count 1; each part of a namespace that two modules do not share counts this less.
_APART = 0.25
#: A whole word counts as much as this many letters, so that a few letters of others weigh less.
_OF_WORD = 4
#: A feature of more than one in so many names is stored for all.
_MANY = 16
_WORD = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|[0-9]+|[^\W_A-Za-z0-9]+")


class PortEnd(NamedTuple):
    """An output or input of the module `module`, named `port`.

    `annotation` is the identifier of the annotation that declares it, and `place` its index there.
    """

    annotation: int
    place: int
    span: Span
    module: str
    port: str
    representation: str | None


def nearest(
    inputs: Iterable[PortEnd], outputs: Iterable[PortEnd], free: Set[PortEnd]
) -> Iterator[tuple[PortEnd, PortEnd, int]]:
    """Yield each input with the outputs that are most similar to it, and their rank from 0.

    Only outputs in `free` of other modules and the same representation are candidates. In robots
    with similar components (`left/...`, `right/...`), an input is not compared with the output of
    another component if its own component has such an output as well.
    """
    by_representation: dict[str, list[PortEnd]] = {}
    for output in outputs:
        if output.representation is not None:
            by_representation.setdefault(output.representation, []).append(output)
    wanted = {output.representation for output in free}
    pools: dict[str, _Pool] = {}
    for entry in inputs:
        representation = entry.representation
        if representation is None or representation not in wanted:
            continue
        if representation not in pools:
            pools[representation] = _Pool(by_representation[representation], free)
        for rank, output in enumerate(pools[representation].nearest(entry)):
            yield entry, output, rank


class _Pool:
    """Outputs of one representation, to be searched for those that are most similar to an input.

    The arrays have an entry for each free output.
    """

    def __init__(self, outputs: Sequence[PortEnd], free: Set[PortEnd]) -> None:
        # Few configurations have loose ends of one type.
        import numpy as np  # noqa: PLC0415

        self._free = sorted((o for o in outputs if o in free), key=lambda o: (o.module, o.port))
        self._of_module: dict[str, list[int]] = {}
        for number, output in enumerate(self._free):
            self._of_module.setdefault(output.module, []).append(number)
        names = sorted({output.port for output in self._free})
        numbers = {name: number for number, name in enumerate(names)}
        self._name = np.array([numbers[output.port] for output in self._free])
        self._sizes, self._columns = _columns(list(map(_features, names)))
        self._spaces = _Namespaces(outputs, self._free)
        # Entries of one module, and many of one name, follow each other.
        self._likeness: Callable[[str], _Scores] = lru_cache(maxsize=64)(self._by_name)
        self._nearness: Callable[[tuple[str, ...]], _Scores] = lru_cache(maxsize=4)(
            self._spaces.nearness
        )

    def nearest(self, entry: PortEnd) -> Iterator[PortEnd]:
        """Yield the outputs nearest to an input; of equally near ones the first by name."""
        scores = self._likeness(entry.port) + self._nearness(_namespace(entry.module))
        scores[self._of_module.get(entry.module, [])] = float("-inf")
        for _ in range(MOST):
            number = int(scores.argmax())
            if scores[number] == float("-inf"):
                return
            yield self._free[number]
            scores[number] = float("-inf")

    def _by_name(self, name: str) -> "_Scores":
        """Return the share of features that each output has in common with a name, 0 to 1."""
        features = _features(name)
        common = self._sizes * 0
        for feature, count in features.items():
            if feature in self._columns:
                names, counts = self._columns[feature]
                common[names] += counts.clip(max=count)
        shares: _Scores = 2 * common / (self._sizes + features.total()).clip(min=1)
        of_outputs: _Scores = shares[self._name]
        return of_outputs


class _Namespaces:
    """The namespaces of modules with outputs, and how far they are from each other."""

    def __init__(self, outputs: Sequence[PortEnd], free: Sequence[PortEnd]) -> None:
        import numpy as np  # noqa: PLC0415

        spaces = [_namespace(output.module) for output in free]
        self._depths = np.array([len(space) for space in spaces])
        #: By depth, for each free output its namespace up to there, and the rest of its name.
        self._prefixes, self._rests = [], []
        #: The rests of all outputs in a namespace.
        self._within: dict[tuple[str, ...], set[int]] = {}
        self._known: dict[tuple[str, ...], int] = {}
        rests: dict[tuple[str, ...], int] = {}
        for output in outputs:
            parts = *_namespace(output.module), output.module.rpartition("/")[2], output.port
            for depth in range(1, len(parts) - 1):
                rest = rests.setdefault(parts[depth:], len(rests))
                self._within.setdefault(parts[:depth], set()).add(rest)
                self._known.setdefault(parts[:depth], len(self._known))
        for depth in range(1, max(map(len, spaces), default=0) + 1):
            deep = [space if len(space) >= depth else None for space in spaces]
            self._prefixes.append(
                np.array([-1 if s is None else self._known[s[:depth]] for s in deep])
            )
            ends = [output.module.rpartition("/")[2] for output in free]
            self._rests.append(
                np.array(
                    [
                        len(rests) if s is None else rests[*s[depth:], e, output.port]
                        for s, e, output in zip(deep, ends, free, strict=True)
                    ]
                )
            )
        self._count = len(rests) + 1

    def nearness(self, space: tuple[str, ...]) -> "_Scores":
        """Return how far each free output is from a namespace, as a score of at most 0."""
        import numpy as np  # noqa: PLC0415

        common = self._depths * 0
        for depth, prefixes in enumerate(self._prefixes[: len(space)], 1):
            common += prefixes == self._known.get(space[:depth], -2)
        scores: _Scores = -_APART * (len(space) + self._depths - 2 * common)
        for depth, rests in enumerate(self._rests[: len(space)], 1):
            own = np.zeros(self._count, dtype=bool)
            own[list(self._within.get(space[:depth], ()))] = True
            scores[(common == depth - 1) & own[rests]] = float("-inf")
        return scores


def _columns(
    features: Sequence[Counter[str]],
) -> "tuple[NDArray[np.int64], dict[str, _Column]]":
    """Return the number of features of each name, and a column of counts for each feature."""
    import numpy as np  # noqa: PLC0415

    found: dict[str, dict[int, int]] = {}
    for number, counts in enumerate(features):
        for feature, count in counts.items():
            found.setdefault(feature, {})[number] = count
    columns: dict[str, _Column] = {}
    for feature, having in found.items():
        names, times = np.array(list(having)), np.array(list(having.values()))
        # To add to all is faster than to add to many.
        if len(having) * _MANY >= len(features):
            every = np.zeros(len(features), dtype=np.int64)
            every[names] = times
            columns[feature] = slice(None), every
        else:
            columns[feature] = names, times
    return np.array([counts.total() for counts in features]), columns


def _namespace(module: str) -> tuple[str, ...]:
    return tuple(module.split("/")[:-1])


@lru_cache(maxsize=100_000)
def _features(name: str) -> Counter[str]:
    """Return the words, letters and pairs of letters of a name."""
    words = [word.lower() for word in _WORD.findall(name)]
    found = Counter({f"{word} ": _OF_WORD * count for word, count in Counter(words).items()})
    for word in words:
        found.update(word)
        found.update(f"{one}{two}" for one, two in pairwise(f"^{word}$"))
    return found
