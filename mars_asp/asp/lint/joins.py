"""Premises without a common variable, whose instances are combined each with each."""

from collections.abc import Callable, Iterator, Sequence

from mars_asp.asp.lint.clauses import (
    Aggregate,
    Clause,
    ClauseAtom,
    Comparison,
    name_of,
)
from mars_asp.asp.lint.found import LintFinding
from mars_asp.asp.rules.trees import names_in, names_of
from mars_asp.asp.solve.disjoint_sets import DisjointSets

JOIN = "rule-join"


def paired(clause: Clause, is_large: Callable[[ClauseAtom], bool]) -> Iterator[LintFinding]:
    """Yield premises that no variable or equation joins, if `is_large` is true of them."""
    yield from _unjoined(
        clause, clause.body.positive, clause.body.comparisons, clause.aggregates, is_large
    )
    for inner in clause.inner:
        # A variable that the body binds has a single value here.
        free = tuple(a for a in inner.positive if not names_in(a.node) & clause.bound)
        yield from _unjoined(clause, free, inner.comparisons, (), is_large)


def _unjoined(
    clause: Clause,
    atoms: Sequence[ClauseAtom],
    comparisons: Sequence[Comparison],
    aggregates: Sequence[Aggregate],
    is_large: Callable[[ClauseAtom], bool],
) -> Iterator[LintFinding]:
    if len(atoms) < 2:
        return
    group = DisjointSets[str]()
    for atom in atoms:
        group.join(tuple(names_in(atom.node)))
    bound = names_of(each.node for each in atoms)
    nodes = [*(each.node for each in comparisons), *(each.node for each in aggregates)]
    others = [names_in(node) for node in nodes]
    for each in comparisons:
        names = names_in(each.left) | names_in(each.right)
        # An equation that only gives a value to a variable does not join.
        given = {name_of(each.left), name_of(each.right)} - bound - {None}
        if each.sign == "=" and not any(sum(one in each for each in others) == 1 for one in given):
            group.join(tuple(names))
    for aggregate in aggregates:
        for sign, guard in aggregate.guards:
            if sign == "=":
                inside = names_of(each.node for each in aggregate.elements)
                group.join(tuple(names_in(guard) | (inside & clause.bound)))
    first: dict[str, ClauseAtom] = {}
    for atom in atoms:
        names = names_in(atom.node)
        if names and is_large(atom):
            first.setdefault(group.find(min(names)), atom)
    if len(first) > 1:
        one, other, *_ = first.values()
        message = f"each `{one.text}` is paired with each `{other.text}`"
        advice = "join them by a variable, or derive what belongs together by a rule of its own"
        yield clause.finding(JOIN, message, other.node, advice)
