"""The groups of a rule: aggregates, and conditional literals as if all elements were counted."""

from collections.abc import Callable, Iterator, Sequence, Set

from clingo import ast

from mars_asp.asp.solve.atoms import term_text
from mars_asp.asp.trace.scope import variables_of

_TYPE = ast.ASTType

_SWAPPED = {
    ast.ComparisonOperator.LessEqual: "ge",
    ast.ComparisonOperator.LessThan: "gt",
    ast.ComparisonOperator.GreaterEqual: "le",
    ast.ComparisonOperator.GreaterThan: "lt",
}
_STRAIGHT = {
    ast.ComparisonOperator.LessEqual: "le",
    ast.ComparisonOperator.LessThan: "lt",
    ast.ComparisonOperator.GreaterEqual: "ge",
    ast.ComparisonOperator.GreaterThan: "gt",
}


def group_key(rule: str, group: ast.AST, outside: Set[str]) -> str:
    """Return a term that identifies an aggregate and its global variables in a rule.

    The names of the variables in `outside` are part of it, as variants of a pool may differ in
    these.
    """
    conditional = group.ast_type == _TYPE.ConditionalLiteral
    names = sorted(variables_of((group,) if conditional else group.elements) & outside)
    return f"k({','.join((rule, term_text(f'{group} for {names}'), *names))})"


def needed_of(group: ast.AST, named: Callable[[ast.AST], ast.AST]) -> tuple[str, str, str]:
    """Return which elements of a group a firing needs, as (function, relation, bound).

    They may be all, none, or enough to reach the bound. `named` returns a term with a single value
    for the bound.
    """
    if group.ast_type == _TYPE.ConditionalLiteral:
        return "all", "all", "0"
    function = "count"
    if group.ast_type == _TYPE.BodyAggregate:
        function = ast.AggregateFunction(group.function).name.lower()
    supporting = ("le", "lt") if function == "min" else ("ge", "gt")
    relations = [
        (table.get(guard.comparison), guard.term)
        for guard, table in ((group.left_guard, _SWAPPED), (group.right_guard, _STRAIGHT))
        if guard is not None
    ]
    for relation, bound in relations:
        if relation in supporting:
            return function, relation, str(named(bound))
    if relations and all(relation is not None for relation, _ in relations):
        return "none", "none", "0"
    return "all", "all", "0"


def elements_of(
    group: ast.AST,
) -> Iterator[tuple[str, Sequence[ast.AST], Sequence[ast.AST]]]:
    """Yield for each element its key, its supporting literals, and its other conditions.

    The key is "" for an element without a tuple, which its first literal identifies.
    """
    if group.ast_type == _TYPE.ConditionalLiteral:
        yield "", (group.literal,), tuple(group.condition)
        return
    for element in group.elements:
        if group.ast_type == _TYPE.BodyAggregate:
            terms = ",".join(map(str, element.terms))
            yield f"t({terms})", tuple(element.condition), ()
        else:
            yield "", (element.literal, *element.condition), ()
