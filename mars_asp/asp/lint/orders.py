"""Contradictions between comparisons of terms, single or in combination.

A term is a base and a number added to it: `X + 2`, or 7 with an empty base. Comparisons bound the
differences of bases, so the shortest paths between bases show whether all comparisons can hold.
"""

from collections.abc import Iterable, Mapping, Set
from itertools import combinations
from typing import NamedTuple

from mars_asp.asp.lint.clauses import Comparison, is_constant, number_of, operation_of
from mars_asp.asp.rules.trees import SyntaxNode

#: The base of plain numbers.
_ZERO = ""
_Distances = dict[str, dict[str, int]]


class Compared(NamedTuple):
    """The comparison `left + plus SIGN right` of two bases."""

    left: str
    sign: str
    right: str
    plus: int


def compared(comparison: Comparison) -> Compared:
    """Return a comparison of two terms as a comparison of their bases."""
    (left, one), (right, other) = parted(comparison.left), parted(comparison.right)
    return Compared(left, comparison.sign, right, one - other)


def guarded(name: str, sign: str, term: SyntaxNode) -> Compared:
    """Return the comparison `term sign name`, where `name` is the name of an aggregate."""
    base, plus = parted(term)
    return Compared(base, sign, name, plus)


def never(comparisons: Iterable[Compared], constants: Set[str] = frozenset()) -> bool:
    """Whether comparisons contradict each other.

    Each of `constants` differs from the others and from all numbers.
    """
    given = tuple(comparisons)
    paths = _paths(given, constants)
    if paths is None:
        return True

    def difference(one: str, other: str) -> int | None:
        """Return the difference of two bases, or None if it is not fixed."""
        there, back = paths[one].get(other), paths[other].get(one)
        return there if there is not None and back == -there else None

    if any(s == "!=" and difference(one, other) == -plus for one, s, other, plus in given):
        return True
    fixed = sorted({*constants, _ZERO} & paths.keys())
    return any(difference(one, other) is not None for one, other in combinations(fixed, 2))


def fewest(
    comparisons: Iterable[Comparison], given: Iterable[Compared], constants: Set[str]
) -> list[Comparison]:
    """Return a minimal subset of `comparisons` that contradicts the `given` ones.

    All of them do so. `constants` are different values.
    """
    given, kept = tuple(given), list(comparisons)
    for each in tuple(kept):
        rest = [other for other in kept if other is not each]
        if never([*map(compared, rest), *given], constants):
            kept = rest
    return kept


def constants_in(comparisons: Iterable[Comparison], replaced: Set[str]) -> frozenset[str]:
    """Return the compared constants, without numbers and those that `#const` replaces."""
    return frozenset(
        str(term)
        for comparison in comparisons
        for term in (comparison.left, comparison.right)
        if is_constant(term) and number_of(term) is None and str(term) not in replaced
    )


def parted(term: SyntaxNode) -> tuple[str, int]:
    """Return the base and the added number of a term: (`X`, 2) of `X + 2`, ("", 7) of 7."""
    number = number_of(term)
    if number is not None:
        return _ZERO, number
    sign = operation_of(term)
    if sign in ("+", "-"):
        left, right = number_of(term.left), number_of(term.right)
        if right is not None:
            base, plus = parted(term.left)
            return base, plus + (right if sign == "+" else -right)
        if left is not None and sign == "+":
            base, plus = parted(term.right)
            return base, plus + left
    return str(term), 0


def _paths(given: Iterable[Compared], constants: Set[str]) -> _Distances | None:
    """Return the upper bounds of the differences of bases, or None if they are contradictory."""
    paths: _Distances = {}
    for left, sign, right, plus in given:
        for base in (left, right):
            paths.setdefault(base, {})[base] = 0
        if sign in ("<", "<=", "="):
            _bound(paths, left, right, -plus - (sign == "<"))
        if sign in (">", ">=", "="):
            _bound(paths, right, left, plus - (sign == ">"))
    for middle in paths:
        for one, known in paths.items():
            if middle in known:
                for other, far in list(paths[middle].items()):
                    _bound(paths, one, other, known[middle] + far)
    return None if any(known[base] < 0 for base, known in paths.items()) else paths


def _bound(paths: Mapping[str, dict[str, int]], one: str, other: str, most: int) -> None:
    known = paths[one]
    known[other] = min(most, known.get(other, most))
