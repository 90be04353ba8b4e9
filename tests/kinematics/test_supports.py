"""Supports of unit twists, against a search through all sets with ranks by numpy alone."""

import random
from itertools import combinations
from math import comb, cos, sin, sqrt

import numpy as np
import pytest

from mars_asp.kinematics import supports
from mars_asp.kinematics.frames import (
    TOLERANCE,
    Matrix,
    build_robot,
    jacobian,
    scaled,
    take_posture,
)
from mars_asp.kinematics.supports import circuits, columns_with_share, fewest_groups, spanned
from tests.support.fixtures import Patch

UNITS = range(6)


def matrix(*columns: list[float]) -> Matrix:
    return np.array(columns, dtype=float).T.reshape(len(columns[0]), -1)


def unit(*places: int) -> list[float]:
    """Return a column of six with ones in some places."""
    return [float(place in places) for place in UNITS]


def in_span(columns: Matrix, place: int) -> bool:
    """Whether a unit vector as a further column leaves the rank unchanged."""
    with_unit = np.hstack([columns, np.eye(columns.shape[0])[:, [place]]])
    return bool(np.linalg.matrix_rank(with_unit) == np.linalg.matrix_rank(columns))


def whole_columns(rng: random.Random, count: int) -> Matrix:
    """Return columns (6xk) of small whole numbers, many of which depend on each other."""
    return matrix(
        *([float(rng.choice((0, 0, 0, 1, 1, -1, 2))) for _ in UNITS] for _ in range(count))
    )


# ---- Spans ---------------------------------------------------------------------------------------


def test_spans_are_those_of_ranks() -> None:
    rng = random.Random(1)
    seen = set()
    for _ in range(100):
        columns = whole_columns(rng, rng.randint(1, 6))
        should = [in_span(columns, place) for place in UNITS]
        assert spanned(columns).tolist() == should
        assert spanned(columns[:3]).tolist() == [in_span(columns[:3], n) for n in range(3)]
        seen.add(sum(should))
    assert {0, 1, 2, 3, 4, 6} <= seen


@pytest.mark.parametrize(("slant", "inside"), [(3.1e-6, True), (3.2e-6, False)])
def test_the_residual_of_a_unit_vector_in_a_span_is_below_a_bound(
    slant: float, inside: bool
) -> None:
    """The bound is a tenth of the root of 1e-9, which is 3.1623e-6: of a radian, some 0.00018
    degrees."""
    assert sqrt(TOLERANCE) / 10 == pytest.approx(3.1623e-6, rel=1e-4)
    column = np.array([[cos(slant)], [sin(slant)], [0.0]])
    assert spanned(column).tolist() == [inside, False, False]
    twist = np.vstack([column, np.zeros((3, 1))])
    assert (fewest_groups([twist], [0]) == {0: [[0]]}) is inside
    pair = np.hstack([twist, np.array([unit(3)]).T + 0.0])
    pair[:, 0] += pair[:, 1]
    assert (list(circuits(pair, 0)) == [(0, 1)]) is inside


def test_directions_that_hardly_differ_are_one() -> None:
    """Two axes less than 1e-9 apart span a line, two that are farther apart a plane."""
    for apart, plane in ((1e-10, False), (1e-7, True)):
        axes = np.array([[1.0, 1.0], [0.0, apart], [0.0, 0.0]])
        assert spanned(axes).tolist() == [True, plane, False]


def test_lengths_of_columns_count_for_nothing() -> None:
    columns = matrix([1e-6, 0, 0, 0, 0, 0], [0, 0, 0, 0, 1e5, 0], [0] * 6)
    assert spanned(columns).tolist() == [True, False, False, False, True, False]
    assert spanned(np.zeros((6, 3))).tolist() == [False] * 6


def test_levers_are_measured_in_the_longest() -> None:
    """Columns get the length one; a pure translation does not count as a lever."""
    turning = matrix([0, 0, 1, 0, 3000, 0], [0, 0, 1, 0, -4000, 0], [0, 0, 0, 5000, 0, 0])
    found = scaled(turning)
    assert np.linalg.norm(found, axis=0) == pytest.approx(1)
    assert found[4, 0] / found[2, 0] == pytest.approx(0.75)
    assert found[4, 1] / found[2, 1] == pytest.approx(-1)
    assert found[:, 2].tolist() == unit(3)
    short = scaled(matrix([0, 0, 1, 0.5, 0, 0]))
    assert short[3, 0] / short[2, 0] == pytest.approx(0.5)
    along_x = scaled(matrix([0, 0, 1, 2000, 0, 0], [0, 1, 0, 500, 0, 0]))
    assert along_x[3, 0] / along_x[2, 0] == pytest.approx(1)
    assert along_x[3, 1] / along_x[1, 1] == pytest.approx(0.25)
    sliding = scaled(matrix([0, 0, 0, 0, 3000, 4000]))
    assert sliding[:, 0] == pytest.approx([0, 0, 0, 0, 0.6, 0.8])
    six = np.arange(1.0, 4.0).reshape(3, 1) @ np.ones((1, 6))
    assert scaled(six) == pytest.approx(six / sqrt(14))
    assert scaled(np.empty((6, 0))).shape == (6, 0)
    assert scaled(np.empty((3, 0))).shape == (3, 0)


def test_a_jacobian_without_carriers_has_no_columns() -> None:
    assert jacobian(take_posture(build_robot((), {})), "M", ()).shape == (6, 0)


# ---- Shares --------------------------------------------------------------------------------------


def test_columns_with_a_share_support_and_none_is_to_spare() -> None:
    rng = random.Random(2)
    supported = 0
    for _ in range(60):
        columns = whole_columns(rng, rng.randint(1, 7))
        for place in UNITS:
            shared = columns_with_share(columns, place)
            if not in_span(columns, place):
                assert shared == ()
                continue
            supported += 1
            assert in_span(columns[:, shared], place)
            for column in shared:
                fewer = [other for other in shared if other != column]
                assert not fewer or not in_span(columns[:, fewer], place)
    assert supported > 50


def test_of_columns_that_do_the_same_the_first_is_kept() -> None:
    twice = matrix(unit(0), unit(0, 1), unit(0), unit(1))
    assert columns_with_share(twice, 0) == (0,)
    assert columns_with_share(twice, 1) == (0, 1)


# ---- Groups and circuits -------------------------------------------------------------------------


def fewest(groups: list[Matrix], place: int) -> list[list[int]]:
    """Return the sets of fewest groups by trying all."""
    for size in range(1, len(groups) + 1):
        sets = [
            list(chosen)
            for chosen in combinations(range(len(groups)), size)
            if in_span(np.hstack([groups[n] for n in chosen]), place)
        ]
        if sets:
            return sets
    return []


def test_fewest_groups_are_those_of_all_sets() -> None:
    rng = random.Random(3)
    sizes = set()
    for _ in range(30):
        groups = [whole_columns(rng, rng.choice((1, 1, 2))) for _ in range(rng.randint(1, 6))]
        should = {place: sets for place in UNITS if (sets := fewest(groups, place))}
        assert fewest_groups(groups, UNITS) == should
        sizes |= {len(sets[0]) for sets in should.values()}
        assert fewest_groups(groups, ()) == {}
        assert fewest_groups(groups, (2,)) == {n: sets for n, sets in should.items() if n == 2}
    assert sizes >= {1, 2, 3, 4}
    assert fewest_groups([], UNITS) == {}


def chained(count: int) -> Matrix:
    """Return so many columns, of which only all together give the first unit vector."""
    columns = [unit(n, n + 1) for n in range(count - 1)]
    return matrix(*columns, unit(count - 1))


@pytest.mark.parametrize("count", range(1, 7))
def test_six_columns_may_be_needed(count: int) -> None:
    columns = chained(count)
    groups = [columns[:, [n]] for n in range(count)]
    assert fewest_groups(groups, [0]) == {0: [list(range(count))]}
    assert list(circuits(columns, 0)) == ([tuple(range(count))] if count > 1 else [])


def test_circuits_are_those_of_all_sets() -> None:
    """Each column has a share: without it the others do not support the unit vector."""
    rng = random.Random(4)
    found = 0
    for _ in range(40):
        columns = whole_columns(rng, rng.randint(1, 7))
        for place in (0, 4):
            should = [
                chosen
                for size in range(2, 7)
                for chosen in combinations(range(columns.shape[1]), size)
                if is_circuit(columns[:, chosen], place)
            ]
            assert list(circuits(columns, place)) == should
            found += len(should)
    assert found > 40


def is_circuit(columns: Matrix, place: int) -> bool:
    count = columns.shape[1]
    without = [np.delete(columns, column, axis=1) for column in range(count)]
    return (
        in_span(columns, place)
        and np.linalg.matrix_rank(columns) == count
        and not any(in_span(fewer, place) for fewer in without)
    )


def test_a_share_that_is_next_to_none_makes_no_circuit() -> None:
    for slant, is_one in ((1e-6, False), (1e-5, True)):
        columns = matrix([1.0, slant, 0, 0, 0, 0], unit(1))
        assert (list(circuits(columns, 0)) == [(0, 1)]) is is_one


# ---- Far out -------------------------------------------------------------------------------------


@pytest.mark.parametrize(("size", "reach"), [(2, 100), (3, 32), (4, 20), (5, 16), (6, 15)])
def test_as_many_of_the_nearest_are_tried_as_the_sets_allow(size: int, reach: int) -> None:
    """A group at the end of the reach is found among all sets; a pair one farther out is found
    only by taking groups in their order, and then as one set of several."""
    assert comb(reach, size) <= supports.MOST_SETS < comb(reach + 1, size)
    useful = [chained(size)[:, [n]] for n in range(size)]
    none = matrix([0.0] * 6)
    within = [*useful[:-1], *[none] * (reach - size), useful[-1]]
    assert fewest_groups(within, [0]) == {0: [[*range(size - 1), reach - 1]]}
    # A second solution is farther out: only the nearer one is reported.
    assert fewest_groups([*within, useful[-1]], [0]) == {0: [[*range(size - 1), reach - 1]]}
    columns = np.hstack([*within, useful[-1]])
    assert list(circuits(columns, 0)) == [(*range(size - 1), reach - 1)]


def test_single_groups_are_all_tried() -> None:
    groups = [matrix([0.0] * 6)] * 150 + [matrix(unit(0))]
    assert fewest_groups(groups, [0, 1]) == {0: [[150]]}


def test_beyond_the_reach_groups_are_taken_in_their_order() -> None:
    """Near groups are kept, and groups that add nothing or are dispensable are dropped."""
    none, first, second = matrix([0.0] * 6), matrix(unit(0, 1)), matrix(unit(1))
    other = matrix(unit(4))

    def found(*groups: Matrix) -> list[list[int]]:
        sets = fewest_groups([*[none] * 101, *groups], [0]).get(0, [])
        return [[place - 101 for place in places] for places in sets]

    assert found(none, first, second) == [[1, 2]]
    third = matrix(unit(0, 2)), matrix(unit(2))
    assert found(other, none, first, first, other, second, *third) == [[2, 5]]
    assert found(first, none, other, matrix(unit(1, 4)), second) == [[0, 2, 3]]
    assert found(first, other) == []
    wide = np.hstack([second, matrix(unit(4))])
    assert found(matrix(unit(1, 4)), first, wide) == [[1, 2]]


def test_one_group_that_suffices_is_kept_however_far_out_it_is(
    monkeypatch: Patch,
) -> None:
    monkeypatch.setattr(supports, "MOST_SETS", 1)
    supports._reach.cache_clear()
    try:
        groups = [matrix([0.0] * 6)] * 6 + [matrix(unit(0))]
        assert fewest_groups(groups, [0]) == {0: [[6]]}
    finally:
        supports._reach.cache_clear()
