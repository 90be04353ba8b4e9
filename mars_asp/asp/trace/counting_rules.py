"""The groups of a rule: aggregates, and conditional literals as if all elements were counted."""

from collections.abc import Callable, Iterator, Sequence, Set

from mars_asp.asp.rules.trees import (
    COMPARISONS,
    FUNCTIONS,
    Kind,
    SyntaxNode,
    elements_of,
    names_of,
)
from mars_asp.asp.solve.atoms import term_text

_SWAPPED = {"<=": "ge", "<": "gt", ">=": "le", ">": "lt"}
_STRAIGHT = {"<=": "le", "<": "lt", ">=": "ge", ">": "gt"}


def group_key(rule: str, group: SyntaxNode, outside: Set[str]) -> str:
    """Return a term that identifies the elements of a group: rule, text and global variables.

    The names of the variables in `outside` are part of it, as variants of a pool may differ in
    these.
    """
    inside = (group,) if group.ast_type == Kind.ConditionalLiteral else group.elements
    names = sorted(names_of(inside) & outside)
    return f"k({','.join((rule, term_text(f'{group} for {names}'), *names))})"


def needed_of(group: SyntaxNode, named: Callable[[SyntaxNode], SyntaxNode]) -> tuple[str, str, str]:
    """Return the elements of a group that a firing rests on: (function, relation, bound).

    They may be all, none, or enough to reach the bound. `named` returns a term with a single value
    for the bound.
    """
    if group.ast_type == Kind.ConditionalLiteral:
        return "all", "all", "0"
    function = FUNCTIONS[group.function] if group.ast_type == Kind.BodyAggregate else "count"
    supporting = ("le", "lt") if function == "min" else ("ge", "gt")
    relations = [
        (table.get(COMPARISONS[guard.comparison]), guard.term)
        for guard, table in ((group.left_guard, _SWAPPED), (group.right_guard, _STRAIGHT))
        if guard is not None
    ]
    for relation, bound in relations:
        if relation in supporting:
            return function, relation, str(named(bound))
    if relations and all(relation is not None for relation, _ in relations):
        return "none", "none", "0"
    return "all", "all", "0"


def counted_elements(
    group: SyntaxNode,
) -> Iterator[tuple[str, Sequence[SyntaxNode], Sequence[SyntaxNode]]]:
    """Yield the key of each element, the literals that support it, and its other conditions.

    The key is "" for an element without a tuple, which its first literal identifies.
    """
    for entries, condition in elements_of(group):
        match group.ast_type:
            case Kind.BodyAggregate:
                yield f"t({','.join(map(str, entries))})", condition, ()
            case Kind.ConditionalLiteral:
                yield "", entries, condition
            case _:
                yield "", (*entries, *condition), ()
