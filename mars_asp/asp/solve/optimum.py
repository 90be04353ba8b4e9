"""The proven optimum of one component of a ground program."""

import time
from collections.abc import Iterator, Mapping, Sequence, Set
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import NamedTuple

import clingo

from mars_asp.asp.solve.components import Component, GroundRule

#: Levels below this one order optima by preference; answers that differ in them are all optima.
COST_LEVEL = 10
#: The maximal number of counted optima. For a large component, the number of its atoms limits it as
#: well: each answer takes time in proportion to them.
MOST_COUNTED = 10_000
_MOST_ATOMS_COUNTED = 4_000_000
#: Proving that there is no other optimum may take longer than finding one. The proof is given up
#: after this number of conflicts; with a time limit, the answer would depend on the machine.
_MOST_CONFLICTS = 100_000
#: clasp reports sums of costs as 32 bit integers, which wrap without a message.
MOST_COST = 2**31 - 1
#: The maximal number of searches that shrink cores; beyond it, a bound is not the best possible.
_MOST_SEARCHES = 500
_OPTIONS = ("--opt-strategy=usc,stratify", "--seed=1", "--warn=none")


@dataclass(frozen=True, slots=True)
class Optimum:
    """The optimal answer of a component.

    `true` are its true atoms; `cost` and `bound` map levels to values (equal if `proven`); `count`
    is the number of optima, or None if it is unknown.
    """

    true: frozenset[int]
    cost: dict[int, int]
    bound: dict[int, int]
    proven: bool
    count: int | None


class TooCostlyError(Exception):
    """The costs of a level add up to more than clasp can represent."""

    def __init__(self, level: int, total: int) -> None:
        """Store the level and the sum of all its costs."""
        super().__init__(f"costs on level {level} add up to {total}")
        self.level = level
        self.total = total


class UnsatisfiableError(Exception):
    """No answer satisfies the rules."""


class LateError(TimeoutError):
    """The deadline passed before any answer was found; `bound` is a lower bound of the cost."""

    def __init__(self, bound: dict[int, int]) -> None:
        """Store the lower bound of the cost, by level."""
        super().__init__("the time limit passed before any answer was found")
        self.bound = bound


def check_costs(component: Component) -> None:
    """Raise TooCostlyError if clasp cannot represent the sum of the costs of a level.

    Raises:
        TooCostlyError: the sum of a level is too great.
    """
    for level, total in _totals(component).items():
        if total > MOST_COST:
            raise TooCostlyError(level, total)


def _totals(component: Component) -> dict[int, int]:
    totals: dict[int, int] = {}
    for level, weight, _ in component.costs:
        totals[level] = totals.get(level, 0) + abs(weight)
    return totals


def optimise(
    component: Component,
    deadline: float | None = None,
    counted: int | None = COST_LEVEL,
    counting: bool = True,
) -> Optimum:
    """Return the optimal answer of a component; among equal ones the first by its atoms.

    `deadline` is a time of `time.monotonic`. When it passes, the best answer so far is returned, or
    else the first answer found, however long that takes. Answers count as optima if they cost the
    same at the levels from `counted`, or at all levels if it is None; with `counting` they are
    counted.

    Raises:
        UnsatisfiableError: there is no answer.
    """
    try:
        found = least(component, deadline)
    except LateError as late:
        return _first(component, late.bound)
    if not found.proven:
        return found
    costs = {
        level: cost for level, cost in found.cost.items() if counted is None or level >= counted
    }
    # A second optimum is searched in any case: a single one needs no choice by name.
    count = _count_optima(component, costs, deadline, MOST_COUNTED if counting else 1)
    true = found.true if count == 1 else _first_by_name(component, found, deadline)
    return Optimum(true, found.cost, found.bound, True, count if counting else None)


def least(component: Component, deadline: float | None = None) -> Optimum:
    """Return an optimal answer of a component, without counting optima.

    Raises:
        UnsatisfiableError: there is no answer.
        TimeoutError: the time limit passed before any answer was found.
    """
    levels = sorted({level for level, _, _ in component.costs}, reverse=True)
    control = _control(component)
    with control.backend() as backend:
        for level in levels:
            costs = [(lit, weight) for at, weight, lit in component.costs if at == level]
            backend.add_minimize(level, costs)
    true: frozenset[int] | None = None
    cost: list[int] = []
    with _solving(control, deadline) as handle:
        for model in _models(handle, deadline):
            true = _true(model, component)
            cost = list(model.cost)
        result = handle.get()
    if result.unsatisfiable:
        raise UnsatisfiableError
    values = dict(zip(levels, cost, strict=False))
    # Without costs the first answer ends the search, and none is better.
    if true is not None and (result.exhausted or not levels):
        return Optimum(true, values, values, True, None)
    lower = control.statistics["summary"]["lower"] if levels else []
    bound = {**dict.fromkeys(levels, 0), **dict(zip(levels, map(int, lower), strict=False))}
    if true is None:
        raise LateError(bound)
    return Optimum(true, values, bound, False, None)


def least_with(component: Component, atom: int, deadline: float | None = None) -> Optimum:
    """Return an optimal answer among those in which an atom is true.

    Raises:
        UnsatisfiableError: no answer has the atom.
        TimeoutError: the time limit passed before any answer was found.
    """
    forced = replace(component, rules=(*component.rules, GroundRule(False, (), (-atom,))))
    return least(forced, deadline)


def has_without(
    component: Component, atom: int, costs: Mapping[int, int] = MappingProxyType({})
) -> bool:
    """Whether an answer of at most `costs` lacks an atom; True also if this is undecided."""
    control = _bounded(component, costs, (f"--solve-limit={_MOST_CONFLICTS}",))
    return not control.solve(assumptions=[-atom]).unsatisfiable


def others(
    component: Component, best: Optimum, most: int, deadline: float | None = None
) -> Iterator[Optimum]:
    """Yield further answers, cheapest first, without those that only add to earlier answers.

    `best` is the first answer. Answers with all decisions of an earlier one are left out; `most` is
    the maximal number.

    Raises:
        TimeoutError: the deadline passed before the next was found.
    """
    left, found = component, best
    for _ in range(most):
        decided = tuple(atom for atom in component.projected if atom in found.true)
        same = GroundRule(False, (), decided or tuple(-atom for atom in component.projected))
        # Each search begins anew: clasp may never end with rules added to a program that it
        # optimised.
        left = replace(left, rules=(*left.rules, same))
        try:
            found = least(left, deadline)
        except UnsatisfiableError:
            return
        yield found


class Core(NamedTuple):
    """Atoms of which every answer has one; this costs at least `weight` beside other cores."""

    weight: int
    atoms: tuple[int, ...]


def disjoint_needs(
    component: Component, best: Optimum, level: int, deadline: float | None = None
) -> tuple[Core, ...]:
    """Return cores that are a lower bound of the cost at a level, with optimal levels above.

    The weights of the cores with an atom add up to at most its cost, so no answer that is optimal
    above the level costs less than the sum of weights. First come the atoms that all such answers
    have. The others are unsatisfiable cores (Andres et al., Unsatisfiability-based optimization in
    clasp, ICLP 2012), each shrunk until every atom in it is needed, unless that takes too many
    searches. The sum may be less than the optimum.

    Raises:
        TimeoutError: the deadline passed.
    """
    left: dict[int, int] = {}
    for at, weight, atom in component.costs:
        if at == level and atom > 0:
            left[atom] = left.get(atom, 0) + weight
    above = {each: cost for each, cost in best.cost.items() if each > level}
    control = _bounded(component, above)
    needs = []
    for atom in sorted(_in_all(control, best.true.intersection(left), component, deadline)):
        needs.append(Core(left.pop(atom), (atom,)))
    # Atoms that are not true cost nothing, so the other costs bound the cores still to be found.
    open_cost = sum(weight for atom, weight in left.items() if atom in best.true)
    searches = 0
    while open_cost and searches < _MOST_SEARCHES:
        core = _core(control, [-atom for atom in sorted(left)], deadline)
        if core is None:
            break
        for literal in sorted(core):
            smaller = _core(control, [other for other in core if other != literal], deadline)
            core = core if smaller is None else smaller
            searches += 1
        need = Core(min(left[-literal] for literal in core), tuple(sorted(-lit for lit in core)))
        needs.append(need)
        for atom in need.atoms:
            left[atom] -= need.weight
            if not left[atom]:
                del left[atom]
        open_cost -= need.weight
    return tuple(needs)


def _in_all(
    control: clingo.Control, atoms: Set[int], component: Component, deadline: float | None
) -> Set[int]:
    """Return the atoms of `atoms` (those of one answer) that all answers have."""
    common = set(atoms)
    while common:
        with control.backend() as backend:
            other = backend.add_atom()
            backend.add_rule([other], choice=True)
            backend.add_rule([], [other, *sorted(common)])
        with _solving(control, deadline, [other]) as handle:
            model = next(_models(handle, deadline), None)
            if model is None:
                # The clock does not tell: a wait may end a moment before the deadline.
                if not handle.get().unsatisfiable:
                    raise TimeoutError
                break
            common &= _true(model, component)
    return common


def _core(
    control: clingo.Control, assumptions: Sequence[int], deadline: float | None
) -> list[int] | None:
    """Return a subset of assumptions that cannot hold together, or None if all can."""
    with _solving(control, deadline, assumptions) as handle:
        if not handle.wait(_left(deadline)):
            raise TimeoutError
        return None if handle.get().satisfiable else list(handle.core())


def _solving(
    control: clingo.Control, deadline: float | None, assumptions: Sequence[int] = ()
) -> clingo.SolveHandle:
    """Return a started search, in a thread if there is a deadline."""
    entries = list(assumptions)
    if deadline is None:
        return control.solve(assumptions=entries, yield_=True)
    return control.solve(assumptions=entries, yield_=True, async_=True)


def _left(deadline: float | None) -> float | None:
    """Return the seconds before a deadline, at least 0, or None without a limit."""
    return None if deadline is None else max(0.0, deadline - time.monotonic())


def _models(handle: clingo.SolveHandle, deadline: float | None) -> Iterator[clingo.Model]:
    """Yield models until there is no other, or the deadline passes and the search is cancelled."""
    handle.resume()
    while handle.wait(_left(deadline)) and (model := handle.model()) is not None:
        yield model
        handle.resume()
    handle.cancel()


def _true(model: clingo.Model, component: Component) -> frozenset[int]:
    return frozenset(atom for atom in range(1, component.size + 1) if model.is_true(atom))


def _control(component: Component, options: Sequence[str] = ()) -> clingo.Control:
    control = clingo.Control([*_OPTIONS, *options])
    with control.backend() as backend:
        for _ in range(component.size):
            backend.add_atom()
        for rule in component.rules:
            if rule.bound:
                backend.add_weight_rule(rule.head, rule.bound, rule.weighted, rule.choice)
            else:
                backend.add_rule(rule.head, rule.body, rule.choice)
    return control


def _first(component: Component, bound: dict[int, int]) -> Optimum:
    """Return any answer, with its cost; `bound` is the lower bound of the cost."""
    control = _control(component)
    with control.solve(yield_=True) as handle:
        model = handle.model()
        if model is None:
            raise UnsatisfiableError
        true = _true(model, component)
    cost = dict.fromkeys(bound, 0)
    for level, weight, literal in component.costs:
        if (literal in true) if literal > 0 else (-literal not in true):
            cost[level] += weight
    return Optimum(true, cost, bound, False, None)


def _bounded(
    component: Component, costs: Mapping[int, int], options: Sequence[str] = ()
) -> clingo.Control:
    """Return a clingo control whose answers cost at most `costs` at each level."""
    control = _control(component, options)
    totals = _totals(component)
    with control.backend() as backend:
        for level, most in costs.items():
            if most >= totals[level]:
                continue
            terms = [(lit, weight) for at, weight, lit in component.costs if at == level]
            # A negative cost of an atom is a positive cost of its negation, apart from a constant.
            saved = sum(-weight for _, weight in terms if weight < 0)
            terms = [(lit, w) if w > 0 else (-lit, -w) for lit, w in terms]
            # With a higher cost the sum reaches `most` + 1.
            backend.add_weight_rule([], most + saved + 1, terms)
        backend.add_project(component.projected)
    return control


def _count_optima(
    component: Component, costs: dict[int, int], deadline: float | None, most: int
) -> int | None:
    most = min(most, _MOST_ATOMS_COUNTED // component.size)
    limits = (f"--models={most + 1}", f"--solve-limit={_MOST_CONFLICTS}")
    control = _bounded(component, costs, ("--project=project", *limits))
    with _solving(control, deadline) as handle:
        count = sum(1 for _ in _models(handle, deadline))
        # A search that reaches a limit is not exhausted.
        return count if handle.get().exhausted else None


def _first_by_name(component: Component, found: Optimum, deadline: float | None) -> frozenset[int]:
    """Return the true atoms of the first optimum by its atoms, as far as it is found easily."""
    control = _bounded(component, found.cost, (f"--solve-limit={_MOST_CONFLICTS}",))
    true = found.true
    assumed: list[int] = []
    for atom in component.projected:
        if _left(deadline) == 0:
            break
        if atom in true:
            assumed.append(atom)
            continue
        answer: list[frozenset[int]] = []

        def keep(model: clingo.Model, answer: list[frozenset[int]] = answer) -> None:
            answer.append(_true(model, component))

        result = control.solve(assumptions=[*assumed, atom], on_model=keep)
        if result.unknown:
            break
        if answer:
            true = answer[0]
            assumed.append(atom)
        else:
            assumed.append(-atom)
    return true
