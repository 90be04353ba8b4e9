"""The scope of variables, local to an element or global, and the atoms that a head can give.

Variables outside of aggregates and conditions are global, as are those of guards; the scope of
other variables is their own element (ASP-Core-2, section 2.1; gringo's local variables).
"""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence

from clingo import ast

_TYPE = ast.ASTType
AGGREGATES = (_TYPE.BodyAggregate, _TYPE.Aggregate)
#: The prefix of renamed variables that are local to an element of a head; no instance shows them.
OWN = "_Own_"
# Reading a term's text is many times faster than walking its tree through the foreign interface.
_STRING = re.compile(r'"(?:[^"\\]|\\.)*"')
_VARIABLE = re.compile(r"(?<![\w'])_*[A-Z][\w']*")


def bare(node: ast.AST | str) -> str:
    """Return the text of a node without string literals."""
    return _STRING.sub('""', str(node))


def variables_of(nodes: Iterable[ast.AST | str]) -> set[str]:
    """Return the names of the variables in nodes or texts of terms, except anonymous ones."""
    return {name for node in nodes for name in _VARIABLE.findall(bare(node))}


def global_variables(head: Iterable[ast.AST], literals: Iterable[ast.AST]) -> set[str]:
    """Return the variables of a rule that are not local to an aggregate or condition.

    `head` are the terms or literals of the head whose variables are all global.
    """
    found = variables_of(head)
    for literal in literals:
        if literal.ast_type == _TYPE.ConditionalLiteral:
            continue
        if literal.atom.ast_type in AGGREGATES:
            found |= variables_of(guards(literal.atom))
        else:
            found |= variables_of((literal,))
    return found


def guards(aggregate: ast.AST) -> list[ast.AST]:
    """Return the terms with which an aggregate is compared."""
    both = (aggregate.left_guard, aggregate.right_guard)
    return [guard.term for guard in both if guard is not None]


def atoms_of_head(statement: ast.AST) -> Iterator[tuple[ast.AST, Sequence[ast.AST]]]:
    """Yield each atom that a head may derive, with its condition.

    Callers move the condition into the body, so its variables that clash with local ones there are
    renamed with the prefix `OWN`.
    """
    head = statement.head
    found: list[tuple[ast.AST, Sequence[ast.AST]]] = []
    shared: set[str] = set()
    if head.ast_type == _TYPE.Literal:
        found = [(head, ())]
    elif head.ast_type in (_TYPE.Aggregate, _TYPE.Disjunction):
        found = [(element.literal, tuple(element.condition)) for element in head.elements]
    elif head.ast_type == _TYPE.HeadAggregate:
        inner = [element.condition for element in head.elements]
        found = [(element.literal, tuple(element.condition)) for element in inner]
    if any(condition for _, condition in found):
        outer = guards(head) if head.ast_type != _TYPE.Disjunction else ()
        shared = variables_of(statement.body) - global_variables(outer, statement.body)
    for literal, condition in found:
        if literal.atom.ast_type == _TYPE.SymbolicAtom:
            clashing = shared & variables_of((literal, *condition))
            own = Renamed({name: f"{OWN}{name}" for name in clashing})
            yield (own(literal), tuple(map(own, condition))) if clashing else (literal, condition)


class Renamed(ast.Transformer):
    """Renames variables of a tree."""

    def __init__(self, names: Mapping[str, str]) -> None:
        """Begin with a mapping of old to new names."""
        self._names = names

    def visit_Variable(self, node: ast.AST) -> ast.AST:  # noqa: N802 -- clingo's own name
        """Return a variable with its new name."""
        return node.update(name=self._names[node.name]) if node.name in self._names else node
