"""Optima of components, against exhaustive search, and the results at a deadline."""

import random
import time
from itertools import combinations, product
from math import factorial
from types import SimpleNamespace

import pytest

from mars_asp.asp.solve import optimum
from mars_asp.asp.solve.components import Component, GroundRule
from mars_asp.asp.solve.optimum import (
    LateError,
    Optimum,
    UnsatisfiableError,
    disjoint_needs,
    least,
    least_with,
    optimise,
    others,
)
from tests.support.fixtures import Patch

#: Levels of costs, and one of taste, highest first.
LEVELS = (30, 20, 10, 1)


def choice(atom: int) -> GroundRule:
    return GroundRule(True, (atom,), ())


def forbid(*literals: int) -> GroundRule:
    return GroundRule(False, (), literals)


def component(
    free: int, rules: tuple[GroundRule, ...] = (), costs: tuple[tuple[int, int, int], ...] = ()
) -> Component:
    """Return a component of so many free atoms and of those that rules give besides."""
    size = max([free, *(atom for rule in rules for atom in rule.head)])
    chosen = tuple(choice(atom) for atom in range(1, free + 1))
    return Component(size, (*chosen, *rules), costs, tuple(range(1, free + 1)))


# ---- All answers ---------------------------------------------------------------------------------


def random_component(rng: random.Random) -> Component:
    """Return free atoms, atoms that rules give from those before them, constraints and costs."""
    free = rng.randint(1, 5)
    size = free + rng.randint(0, 2)

    def literals(below: int, most: int) -> tuple[int, ...]:
        atoms = rng.sample(range(1, below + 1), min(below, rng.randint(1, most)))
        return tuple(atom * rng.choice((1, -1)) for atom in atoms)

    rules = [
        GroundRule(False, (atom,), literals(atom - 1, 2)) for atom in range(free + 1, size + 1)
    ]
    rules += [forbid(*literals(size, 3)) for _ in range(rng.randint(0, 3))]
    weighted = tuple((literal, rng.randint(1, 3)) for literal in literals(size, size))
    rules.append(GroundRule(False, (), (), rng.randint(2, 6), weighted))
    levels = rng.sample(LEVELS, rng.randint(0, 4))
    costs = tuple(
        (level, rng.randint(1, 2), literal) for level in levels for literal in literals(size, size)
    )
    return component(free, tuple(rules), costs)


def holds(literal: int, true: frozenset[int]) -> bool:
    return (literal in true) if literal > 0 else (-literal not in true)


def answers(whole: Component) -> list[frozenset[int]]:
    """Return all answers, in the order of their atoms: first those in which the first is true."""
    found = []
    for values in product((True, False), repeat=len(whole.projected)):
        chosen = {atom for atom, value in zip(whole.projected, values, strict=True) if value}
        for rule in whole.rules:
            if not rule.choice and rule.head:
                given = all(holds(literal, frozenset(chosen)) for literal in rule.body)
                chosen |= set(rule.head) if given else set()
        true = frozenset(chosen)
        if all(rule.choice or rule.head or not fires(rule, true) for rule in whole.rules):
            found.append(true)
    return found


def fires(rule: GroundRule, true: frozenset[int]) -> bool:
    if rule.bound:
        return sum(weight for each, weight in rule.weighted if holds(each, true)) >= rule.bound
    return all(holds(literal, true) for literal in rule.body)


def cost(whole: Component, true: frozenset[int]) -> dict[int, int]:
    """Return the cost of an answer at each level, the highest level first."""
    total = {level: 0 for level in LEVELS if any(at == level for at, _, _ in whole.costs)}
    for level, weight, literal in whole.costs:
        total[level] += weight * holds(literal, true)
    return total


def by_cost(whole: Component, true: frozenset[int]) -> list[int]:
    return list(cost(whole, true).values())


@pytest.mark.parametrize("deadline", [None, 1000.0])
def test_the_least_answers_are_those_of_an_exhaustive_search(deadline: float | None) -> None:
    """The first of equal answers by the order of atoms is chosen; preferences do not matter."""
    until = None if deadline is None else time.monotonic() + deadline
    unsatisfiable = 0
    for seed in range(150):
        whole = random_component(random.Random(seed))
        everything = answers(whole)
        if not everything:
            unsatisfiable += 1
            for search in (optimise, least):
                with pytest.raises(UnsatisfiableError):
                    search(whole, until)
            continue
        best = min(everything, key=lambda true: by_cost(whole, true))
        as_dear = [
            true
            for true in everything
            if all(
                cost(whole, true)[level] == value
                for level, value in cost(whole, best).items()
                if level >= 10
            )
        ]
        costs = cost(whole, best)
        assert optimise(whole, until) == Optimum(best, costs, costs, True, len(as_dear)), seed
        some = least(whole, until)
        assert (some.cost, some.bound, some.proven, some.count) == (costs, costs, True, None)
        assert some.true in everything
        assert cost(whole, some.true) == costs
    assert 10 < unsatisfiable < 100


def test_the_least_with_an_atom_is_that_of_an_exhaustive_search() -> None:
    for seed in range(60):
        whole = random_component(random.Random(seed))
        for atom in range(1, whole.size + 1):
            having = [true for true in answers(whole) if atom in true]
            if not having:
                with pytest.raises(UnsatisfiableError):
                    least_with(whole, atom)
                continue
            found = least_with(whole, atom)
            assert found.true in having
            assert list(found.cost.values()) == min(by_cost(whole, true) for true in having)


@pytest.mark.parametrize("most", [0, 1, 2, 100])
def test_each_other_answer_is_least_of_those_that_lack_a_decision_of_all_before(most: int) -> None:
    compared = 0
    for seed in range(60):
        whole = random_component(random.Random(seed))
        left = answers(whole)
        if not left:
            continue
        before = best = optimise(whole)
        found = list(others(whole, best, most))
        for other in found:
            left = lacking(whole, left, before)
            assert other.true in left
            assert list(other.cost.values()) == min(by_cost(whole, true) for true in left)
            before = other
            compared += 1
        assert len(found) <= most
        if len(found) < most:
            assert lacking(whole, left, before) == []
    assert compared > 30 or not most


def lacking(whole: Component, left: list[frozenset[int]], before: Optimum) -> list[frozenset[int]]:
    """Return answers that lack a decision; if there was none to lack, those that decide at all."""
    decided = before.true & set(whole.projected)
    return [
        true for true in left if (not true >= decided if decided else true & set(whole.projected))
    ]


def test_disjoint_needs_are_met_by_every_answer_and_have_no_atom_to_spare() -> None:
    needed = 0
    for seed in range(150):
        whole = random_component(random.Random(seed))
        everything = answers(whole)
        if not everything:
            continue
        best = optimise(whole)
        for level in (30, 20):
            left = [
                true
                for true in everything
                if all(cost(whole, true)[at] == best.cost[at] for at in best.cost if at > level)
            ]
            weights: dict[int, int] = {}
            for at, weight, atom in whole.costs:
                if at == level and atom > 0:
                    weights[atom] = weights.get(atom, 0) + weight
            needs = disjoint_needs(whole, best, level)
            needed += len(needs)
            for need in needs:
                assert need.weight > 0
                assert all(true & set(need.atoms) for true in left)
                for atom in need.atoms:
                    weights[atom] -= need.weight
                    assert any(not true & (set(need.atoms) - {atom}) for true in left)
            assert all(weight >= 0 for weight in weights.values())
            unmet = {atom for atom, weight in weights.items() if weight}
            assert any(not true & unmet for true in left)
    assert needed > 30


def test_an_atom_that_costs_when_false_is_in_no_core() -> None:
    either = component(3, (forbid(-1, -2), forbid(3)), ((20, 1, 1), (20, 1, 2), (20, 1, -3)))
    best = optimise(either)
    assert disjoint_needs(either, best, 20) == ((1, (1, 2)),)
    assert disjoint_needs(either, best, 10) == ()


def test_cores_below_a_level_hold_for_the_optima_of_that_level() -> None:
    dear = component(2, (forbid(-1, -2),), ((30, 1, 1), (20, 5, 2), (20, 2, 1)))
    best = optimise(dear)
    assert disjoint_needs(dear, best, 30) == ()
    assert disjoint_needs(dear, best, 20) == ((5, (2,)),)


def test_weights_that_differ_are_shared_out() -> None:
    pairs = component(3, (forbid(-1, -2), forbid(-2, -3)), ((20, 1, 1), (20, 2, 2), (20, 1, 3)))
    found = disjoint_needs(pairs, optimise(pairs), 20)
    assert sum(need.weight for need in found) == 2


# ---- Limits --------------------------------------------------------------------------------------


@pytest.mark.parametrize(("most", "count"), [(2, None), (3, 3), (4, 3)])
@pytest.mark.parametrize("limit", ["MOST_COUNTED", "_MOST_ATOMS_COUNTED"])
def test_as_many_are_counted_as_may_be(
    most: int, count: int | None, limit: str, monkeypatch: Patch
) -> None:
    one_of_three = component(3, (forbid(-1, -2, -3), forbid(1, 2), forbid(1, 3), forbid(2, 3)))
    monkeypatch.setattr(optimum, limit, most * (1 if limit == "MOST_COUNTED" else 3))
    found = optimise(one_of_three)
    assert (found.true, found.proven, found.count) == (frozenset({1}), True, count)


def holes(pigeons: int, costly: bool, *more: GroundRule) -> Component:
    """Return places for pigeons in one hole less, where one that has none costs or is forbidden.

    To prove that not all have a place takes exponential time: some milliseconds with 8 pigeons,
    hours with 12.
    """
    number = pigeons * (pigeons - 1)
    places = [range(1 + p * (pigeons - 1), 1 + (p + 1) * (pigeons - 1)) for p in range(pigeons)]
    rules = [
        forbid(one, other)
        for hole in zip(*places, strict=True)
        for one, other in combinations(hole, 2)
    ]
    none_of = [tuple(-place for place in own) for own in places]
    if not costly:
        return component(number, (*rules, *(forbid(*own) for own in none_of), *more))
    without = range(number + 1, number + 1 + pigeons)
    rules += [GroundRule(False, (n,), own) for n, own in zip(without, none_of, strict=True)]
    return component(number, (*rules, *more), tuple((20, 1, atom) for atom in without))


def test_counting_gives_up_after_so_many_conflicts(monkeypatch: Patch) -> None:
    """Any of 6 is left out, and the others have their places in any order."""
    assert optimise(holes(6, True)).count == 6 * factorial(5)
    monkeypatch.setattr(optimum, "_MOST_CONFLICTS", 1)
    assert optimise(holes(6, True)).count is None


def test_atoms_are_decided_in_their_order_until_one_is_hard(
    monkeypatch: Patch,
) -> None:
    """The first would need holes for all, which is impossible; the second is possible."""
    whole = holes(6, False)
    first, second = whole.size + 1, whole.size + 2
    rules = [
        forbid(first, *rule.body) if len(rule.body) == 5 else rule
        for rule in (*whole.rules, choice(first), choice(second))
    ]
    asking = Component(second, tuple(rules), (), (first, second))
    assert optimise(asking).true >= {second}
    monkeypatch.setattr(optimum, "_MOST_CONFLICTS", 1)
    assert not optimise(asking).true & {first, second}


# ---- Deadlines -----------------------------------------------------------------------------------


def test_slow_proofs_are_completed_before_the_deadline() -> None:
    until = time.monotonic() + 1000
    assert optimise(holes(7, True), until).cost == {20: 1}
    with pytest.raises(UnsatisfiableError):
        least(holes(7, False), until)
    assert len(disjoint_needs(holes(7, True), optimise(holes(7, True)), 20, until)) == 1


@pytest.mark.parametrize("left", [-1.0, 0.0, 0.02])
def test_after_the_deadline_the_best_answer_so_far_is_returned_with_its_bound(left: float) -> None:
    whole = holes(12, True)
    found = optimise(whole, time.monotonic() + left)
    assert not found.proven
    assert found.count is None
    assert found.bound == {20: 0}
    assert all(not fires(rule, found.true) for rule in whole.rules if not rule.head)
    assert found.cost == cost(whole, found.true)
    with pytest.raises(LateError) as caught:
        least(whole, time.monotonic() + left)
    assert caught.value.bound == {20: 0}


def test_an_answer_that_is_not_proven_least_is_neither_counted_nor_called_so() -> None:
    """An answer without the atom of cost 100 is easy; a lower bound of other costs is hard."""
    hard = holes(12, True)
    dear = hard.size + 1
    rules = (*hard.rules, choice(dear))
    whole = Component(dear, rules, ((20, 100, dear), *hard.costs, (10, 1, 1)), hard.projected)
    for search in (optimise, least):
        found = search(whole, time.monotonic() + 0.1)
        assert (found.proven, found.count) == (False, None)
        assert found.bound == {20: 0, 10: 0}
        assert found.cost == cost(whole, found.true)
        assert 1 <= found.cost[20] < 100
        assert all(not fires(rule, found.true) for rule in rules if not rule.head)


@pytest.mark.parametrize("left", [-1.0, 0.02])
def test_after_the_deadline_a_search_without_an_answer_is_late(left: float) -> None:
    with pytest.raises(LateError) as caught:
        least(holes(12, False), time.monotonic() + left)
    assert caught.value.bound == {}
    found = optimise(holes(12, True), time.monotonic())
    with pytest.raises(TimeoutError):
        disjoint_needs(holes(12, True), found, 20, time.monotonic() + left)
    with pytest.raises(UnsatisfiableError):
        optimise(holes(7, False), time.monotonic() + left)


def test_a_wait_that_ends_before_its_deadline_proves_nothing(monkeypatch: Patch) -> None:
    whole = holes(12, True)
    found = optimise(whole, time.monotonic())
    monkeypatch.setattr(optimum, "_left", lambda deadline: 0.01)
    with pytest.raises(TimeoutError):
        disjoint_needs(whole, found, 20, time.monotonic() + 100)


def test_costs_of_false_atoms_are_summed_after_the_deadline() -> None:
    hard = holes(12, True, forbid(1))
    costs = (*hard.costs, (20, 5, 1), (20, 7, -1), (10, 11, 2), (10, 13, -2))
    whole = Component(hard.size, hard.rules, costs, hard.projected)
    found = optimise(whole, time.monotonic() - 1)
    assert not found.proven
    assert found.cost == cost(whole, found.true)
    assert found.cost[20] >= 7


def test_a_proven_answer_is_minimal_at_every_deadline(
    monkeypatch: Patch,
) -> None:
    """If it passes after the proof, the result may be another than the first of equal answers."""
    chosen = component(6, (forbid(-1, -2, -3, -4, -5, -6),), tuple((30, 1, n) for n in range(1, 7)))
    found = set()
    for reached in range(40):
        times = [0.0] * reached
        clock = SimpleNamespace(monotonic=lambda times=times: times.pop() if times else 1000.0)
        monkeypatch.setattr(optimum, "time", clock)
        best = optimise(chosen, 500.0)
        assert not best.proven or best.cost == {30: 1}
        found |= {tuple(best.true)} if best.proven else set()
    assert (1,) in found
    assert len(found) > 1
