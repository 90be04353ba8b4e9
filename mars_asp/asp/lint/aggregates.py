"""Aggregates that count less, or other values, than they seem to."""

from collections.abc import Iterator

from mars_asp.asp.lint.clauses import Aggregate, Clause, Element, name_of
from mars_asp.asp.lint.found import LintFinding
from mars_asp.asp.rules.trees import Kind, below, names_in, names_of

AGGREGATE = "rule-aggregate"
_SUMS = ("sum", "sum+")


def wrong_aggregates(clause: Clause) -> Iterator[LintFinding]:
    """Yield the elements of aggregates in which equal tuples count once, by accident."""
    yield from _fixed_choice(clause)
    for number, aggregate in enumerate(clause.aggregates):
        bound = clause.bound
        for element in aggregate.elements:
            if aggregate.function != "set" and element.terms:
                yield from _element(clause, aggregate, element, bound)
        for _, guard in aggregate.guards:
            name = name_of(guard)
            inside = names_of(each.node for each in aggregate.elements)
            others = clause.aggregates[:number] + clause.aggregates[number + 1 :]
            if (
                name is not None
                and name in inside
                and not _is_bound_elsewhere(clause, name, others)
            ):
                message = f"`{name}` is the value of the aggregate and a variable in it"
                advice = "use two variables: what is in the braces is another thing"
                yield clause.finding(AGGREGATE, message, guard, advice)


def _fixed_choice(clause: Clause) -> Iterator[LintFinding]:
    """Yield a choice `{ a(X) : b(X) }` whose body binds all variables in the braces."""
    if clause.sort != "choice" or len(clause.heads) != 1:
        return
    ((head, condition),) = clause.heads
    names = names_of(each.node for each in condition.atoms)
    bound = names_of(each.node for each in clause.body.positive)
    own = names_in(head.node)
    if own and names and own | names <= bound:
        variables = " and ".join(f"`{name}`" for name in sorted(own))
        are = "are" if len(own) > 1 else "is"
        message = (
            f"{variables} {are} bound outside of the braces, so that `{head.text}` is one atom"
        )
        advice = "use another variable in the braces, or move the condition to the body"
        yield clause.finding(AGGREGATE, message, head.node, advice)


def _is_bound_elsewhere(clause: Clause, name: str | None, others: tuple[Aggregate, ...]) -> bool:
    atoms = names_of(term for atom in clause.body.positive for term in atom.terms)
    compared = names_of(one for each in clause.body.comparisons for one, _ in each.equal)
    guards = names_of(guard for each in others for _, guard in each.guards)
    return name in atoms | compared | guards


def _element(
    clause: Clause, aggregate: Aggregate, element: Element, bound: frozenset[str]
) -> Iterator[LintFinding]:
    first, *rest = element.terms
    counted = [first, *rest] if aggregate.function not in _SUMS else rest
    entries = names_of(element.terms)
    local = entries - bound
    inside = names_of(each.node for each in element.scope.atoms)
    if aggregate.function in _SUMS and not rest:
        if lost := _lost(element, entries | bound):
            message = f"`{first!s}` is added once, however many {lost} have it"
            advice = f"add what tells them apart: `{first!s}, {lost.strip('`')} : ...`"
            if lost == "others":
                advice = f"add what tells them apart: `{first!s}, X : ...`, not `_`"
            yield clause.finding(AGGREGATE, message, first, advice)
        return
    if aggregate.function in ("count", *_SUMS) and not local and inside - bound:
        what = ", ".join(map(str, element.terms))
        message = f"at most one `{what}` is counted, as nothing in it varies"
        advice = f"count what differs: `{min(inside - bound)}`"
        yield clause.finding(AGGREGATE, message, first, advice)
        return
    for term in counted:
        name = name_of(term)
        is_global = name in bound and _is_bound_elsewhere(clause, name, clause.aggregates)
        if is_global:
            message = f"`{name}` is bound outside of the aggregate, so it is one value in it"
            advice = "use another variable for what is counted, or leave it out of the tuple"
            yield clause.finding(AGGREGATE, message, term, advice)


def _lost(element: Element, known: frozenset[str]) -> str:
    """Return the variable of an element that its tuple lacks, "others" for `_`, "" if none."""
    for atom in element.scope.positive:
        for name in sorted(names_in(atom.node) - known):
            return f"`{name}`"
    for atom in element.scope.positive:
        if any(each.ast_type is Kind.Variable and each.name == "_" for each in below(atom.node)):
            return "others"
    return ""
