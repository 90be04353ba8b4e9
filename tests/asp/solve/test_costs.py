"""Costs that clasp could not add up are refused before anything is solved."""

import pytest

from mars_asp.asp.solve.components import Component, GroundRule
from mars_asp.asp.solve.optimum import MOST_COST, TooCostlyError, check_costs, optimise


def forced(*weights: int) -> Component:
    """Return a component of so many free atoms, of which all have to be chosen."""
    atoms = tuple(range(1, len(weights) + 1))
    chosen = [GroundRule(True, (atom,), ()) for atom in atoms]
    needed = [GroundRule(False, (), (-atom,)) for atom in atoms]
    costs = tuple((20, weight, atom) for atom, weight in enumerate(weights, 1))
    return Component(len(atoms), (*chosen, *needed), costs, atoms)


@pytest.mark.parametrize("weights", [(MOST_COST,), (2**30, 2**30 - 1), (1, 1, MOST_COST - 2)])
def test_the_largest_sum_is_added_up(weights: tuple[int, ...]) -> None:
    component = forced(*weights)
    check_costs(component)
    best = optimise(component)
    assert best.proven
    assert best.cost == {20: MOST_COST}
    assert best.count == 1


@pytest.mark.parametrize("weights", [(MOST_COST, 1), (2_000_000_000,) * 2, (1_500_000_000,) * 2])
def test_a_larger_sum_is_refused(weights: tuple[int, ...]) -> None:
    with pytest.raises(TooCostlyError) as caught:
        check_costs(forced(*weights))
    assert (caught.value.level, caught.value.total) == (20, sum(weights))
