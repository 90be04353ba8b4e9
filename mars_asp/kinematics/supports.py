"""Supports: sets of motions that make up a unit twist, the smallest of them first.

Columns of a Jacobian span the twists of a chain. A set of columns *supports* a unit vector that is
in its span, and a column has a *share* in it if the set without the column does not. No such set
needs more than six columns, because twists have six coordinates.
"""

from collections.abc import Iterator, Sequence
from functools import lru_cache
from itertools import combinations
from math import comb, sqrt

import numpy as np
from numpy.typing import NDArray

from mars_asp.kinematics.frames import TOLERANCE, Matrix, scaled

#: How many sets of one size are looked at. It bounds how far out they reach: all sets of two are
#: looked at among the nearest 100, of three among 32, of four 20, of five 16, of six 15.
MOST_SETS = 5005
#: Shorter than this is what is left of a unit vector that lies in a span, and a share that is none.
_NOTHING = sqrt(TOLERANCE) / 10


def spanned(columns: Matrix) -> NDArray[np.bool_]:
    """Return, for each of n unit vectors, whether it is in the span of columns (nxk)."""
    columns = scaled(columns)
    size = columns.shape[0]
    if not columns.size:
        return np.zeros(size, dtype=bool)
    left, singular, _ = np.linalg.svd(columns, full_matrices=False)
    basis = left[:, singular > TOLERANCE * max(float(singular[0]), TOLERANCE)]
    inside: NDArray[np.bool_] = np.linalg.norm(np.eye(size) - basis @ basis.T, axis=0) < _NOTHING
    return inside


def columns_with_share(columns: Matrix, unit: int) -> tuple[int, ...]:
    """Return the indices of a minimal set of columns (nxk) that supports a unit vector.

    Earlier columns are preferred. The result is () if the vector is not in their span.
    """
    if not spanned(columns)[unit]:
        return ()
    kept = list(range(columns.shape[1]))
    for column in reversed(range(columns.shape[1])):
        fewer = [index for index in kept if index != column]
        if spanned(columns[:, fewer])[unit]:
            kept = fewer
    return tuple(kept)


def fewest_groups(groups: Sequence[Matrix], units: Sequence[int]) -> dict[int, list[list[int]]]:
    """Return, by unit vector, the sets of fewest groups of columns (each 6xk) that support it.

    Groups are ordered nearest first. Of each size, at most `MOST_SETS` sets are tried, of the
    nearest groups; if none of them suffices, groups are added in their order until they do, and
    dispensable ones are dropped, the last first.
    """
    found: dict[int, list[list[int]]] = {}
    left = list(units)
    padded = _padded(groups)
    for size in range(1, min(6, len(groups)) + 1):
        if not left:
            return found
        sets = _sets(min(len(groups), _reach(size)), size)
        rest = _rest(padded, sets)
        for unit in left:
            hits = sets[rest[:, unit] < _NOTHING**2]
            if len(hits):
                found[unit] = [list(map(int, hit)) for hit in hits]
        left = [unit for unit in left if unit not in found]
    return found | {unit: [kept] for unit in left if (kept := _sufficient(groups, unit))}


def circuits(columns: Matrix, unit: int) -> Iterator[tuple[int, ...]]:
    """Yield sets of two columns (6xk) or more that support a unit vector, each with a share in it.

    Columns are ordered nearest first; the number of tried sets is limited as in `fewest_groups`.
    """
    padded = _padded([columns[:, [index]] for index in range(columns.shape[1])])
    for size in range(2, min(6, columns.shape[1]) + 1):
        sets = _sets(min(columns.shape[1], _reach(size)), size)
        hits = sets[_rest(padded, sets)[:, unit] < _NOTHING**2]
        if not len(hits):
            continue
        chosen = padded[hits][..., 0].transpose(0, 2, 1)
        shares = np.abs(np.linalg.pinv(chosen, rcond=TOLERANCE)[:, :, unit]).min(axis=1)
        independent = np.linalg.svd(chosen, compute_uv=False)[:, -1] > TOLERANCE
        for hit in hits[(shares > _NOTHING) & independent]:
            yield tuple(map(int, hit))


def _padded(groups: Sequence[Matrix]) -> Matrix:
    """Return groups as an array (groups, 6, columns), scaled together and padded with zeros."""
    most = max((group.shape[1] for group in groups), default=0)
    padded = np.zeros((len(groups), 6, most))
    if groups:
        columns = scaled(np.hstack(groups))
        start = 0
        for index, group in enumerate(groups):
            padded[index, :, : group.shape[1]] = columns[:, start : start + group.shape[1]]
            start += group.shape[1]
    return padded


def _rest(padded: Matrix, sets: NDArray[np.intp]) -> Matrix:
    """Return the squared distances (sets, 6) of the unit vectors from the spans of the sets.

    They are the diagonals of the projectors on the complements, made by Gram and Schmidt's method,
    each direction cleared twice.
    """
    projectors = np.broadcast_to(np.eye(6), (len(sets), 6, 6)).copy()
    for place in range(sets.shape[1]):
        for column in range(padded.shape[2]):
            new = padded[sets[:, place], :, column, None]
            new = projectors @ (projectors @ new)
            length = np.linalg.norm(new, axis=1, keepdims=True)
            new = np.where(length > TOLERANCE, new, 0.0) / np.maximum(length, TOLERANCE)
            projectors -= new @ new.transpose(0, 2, 1)
    rest: Matrix = np.diagonal(projectors, axis1=1, axis2=2)
    return rest


def _sufficient(groups: Sequence[Matrix], unit: int) -> list[int]:
    """Return a minimal list of groups that support a unit vector, nearest first; [] if none."""
    kept: list[int] = []
    rank = 0
    for index in range(len(groups)):
        columns = scaled(np.hstack([groups[i] for i in (*kept, index)]))
        now = int(np.linalg.matrix_rank(columns, tol=TOLERANCE))
        if now > rank:
            kept, rank = [*kept, index], now
        if spanned(columns)[unit]:
            break
    else:
        return []
    for index in reversed(kept):
        fewer = [other for other in kept if other != index]
        if fewer and spanned(np.hstack([groups[i] for i in fewer]))[unit]:
            kept = fewer
    return kept


@lru_cache
def _reach(size: int) -> int:
    """Return the largest number of elements with at most `MOST_SETS` subsets of a size."""
    count = size
    while comb(count + 1, size) <= MOST_SETS:
        count += 1
    return count


@lru_cache(64)
def _sets(count: int, size: int) -> NDArray[np.intp]:
    """Return all sets of `size` of the first `count` numbers, in the order of `combinations`."""
    return np.array(list(combinations(range(count), size)), dtype=np.intp).reshape(-1, size)
