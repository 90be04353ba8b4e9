"""Clingo's syntax trees as plain values.

Clingo's own nodes call its library for each access to an attribute. Here each attribute is read
once.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any, TypeAlias

from clingo import Symbol, ast

#: The kinds of nodes.
Kind: TypeAlias = ast.ASTType
#: The signs of literals.
Sign: TypeAlias = ast.Sign
#: The files whose changes can change trees.
FILES = (Path(__file__), Path(ast.__file__))
#: The kinds of nodes that have elements with variables of their own.
WITH_ELEMENTS = (
    *(Kind.Aggregate, Kind.BodyAggregate, Kind.HeadAggregate),
    *(Kind.Disjunction, Kind.ConditionalLiteral),
)
#: The kinds of aggregates in bodies.
AGGREGATES = (Kind.BodyAggregate, Kind.Aggregate)
#: The functions of aggregates, and the signs of comparisons, of binary and of unary operations, by
#: clingo's numbers.
FUNCTIONS = ("count", "sum", "sumplus", "min", "max")
COMPARISONS = (">", "<", "<=", ">=", "!=", "=")
OPERATIONS = ("^", "?", "&", "+", "-", "*", "/", "\\", "**")
UNARY_OPERATIONS = ("-", "~", "|")
_LISTS = (ast.ASTSequence, ast.StrSequence)
_ATTRIBUTES: dict[ast.ASTType, list[str]] = {}

_NONE: frozenset[str] = frozenset()
#: Clingo's own nodes.
Tree: TypeAlias = ast.AST
#: Where a node begins and where it ends: lines from 1, and columns from 1 that count bytes.
Extent: TypeAlias = tuple[int, int, int, int]


class SyntaxNode:
    """A node of a syntax tree, with the attributes of clingo's node `tree`, lists as tuples.

    `children` are the nodes directly below it, in their order.
    """

    ast_type: ast.ASTType
    children: "list[SyntaxNode]"
    _names: frozenset[str] | None = None
    _text: str | None = None
    _below: "list[SyntaxNode] | None" = None

    def __init__(self, tree: ast.AST) -> None:
        self.tree = tree

    def __getattr__(self, name: str) -> Any:
        """Raise AttributeError; declared so that type checkers accept any attribute."""
        raise AttributeError(name)

    def __str__(self) -> str:
        if self._text is None:
            match self.ast_type:
                case Kind.Variable:
                    self._text = self.name
                case Kind.SymbolicTerm:
                    self._text = str(self.symbol)
                case _:
                    self._text = str(self.tree)
        return self._text

    @property
    def parts(self) -> "Iterator[tuple[str, SyntaxNode | tuple[SyntaxNode, ...]]]":
        """Yield the attributes that are nodes, or lists of nodes, with their names."""
        for name in _attributes(self.ast_type, self.tree):
            value = getattr(self, name)
            inside = value if isinstance(value, tuple) else (value,)
            if all(isinstance(each, SyntaxNode) for each in inside):
                yield name, value

    def updated(self, **attributes: Any) -> "SyntaxNode":
        """Return the node with other attributes: nodes, or values of clingo."""
        return plain(self.tree.update(**{name: _tree(value) for name, value in attributes.items()}))


def _tree(value: Any) -> Any:
    if isinstance(value, list):
        return list(map(_tree, value))
    return value.tree if isinstance(value, SyntaxNode) else value


class _Changing(ast.Transformer):
    """Applies a function to all nodes of a tree, to the innermost first."""

    def __init__(self, change: Callable[[Tree], Tree]) -> None:
        self._change = change

    def visit(self, ast: ast.AST, *args: Any, **kwargs: Any) -> ast.AST:
        """Return the node after the changes of it and of all below it."""
        inside = self.visit_children(ast)
        return self._change(ast.update(**inside) if inside else ast)


def changed(node: SyntaxNode, change: Callable[[Tree], Tree]) -> SyntaxNode:
    """Return a node after a change of clingo's nodes, the innermost first."""
    return plain(_Changing(change).visit(node.tree))


def with_variables(node: SyntaxNode, names: Mapping[str, str]) -> SyntaxNode:
    """Return a node with other names of some variables, by their names."""

    def rename(tree: ast.AST) -> ast.AST:
        is_renamed = tree.ast_type == Kind.Variable and tree.name in names
        return tree.update(name=names[tree.name]) if is_renamed else tree

    return node if names_in(node).isdisjoint(names) else changed(node, rename)


def constant(tree: ast.AST, symbol: Symbol) -> ast.AST:
    """Return a constant as clingo's node, with the location of another one."""
    return ast.SymbolicTerm(tree.location, symbol)


def plain(tree: ast.AST) -> SyntaxNode:
    """Return clingo's node, with all below it, as plain values."""
    node = SyntaxNode(tree)
    node.ast_type, node.children = tree.ast_type, []
    for name in _attributes(node.ast_type, tree):
        value: Any = getattr(tree, name)
        if isinstance(value, ast.AST):
            value = plain(value)
            node.children.append(value)
        elif isinstance(value, _LISTS):
            value = tuple(plain(each) if isinstance(each, ast.AST) else each for each in value)
            node.children += (each for each in value if isinstance(each, SyntaxNode))
        setattr(node, name, value)
    return node


def _attributes(kind: ast.ASTType, tree: ast.AST) -> Sequence[str]:
    """Return the names of the attributes of a kind of nodes, except its location."""
    if kind not in _ATTRIBUTES:
        keys = tree.keys()
        _ATTRIBUTES[kind] = [name for name in keys if name != "location"]
    return _ATTRIBUTES[kind]


def extent_of(node: SyntaxNode | ast.AST) -> Extent:
    """Return first line and column, and last line and column, of a node."""
    location = (node.tree if isinstance(node, SyntaxNode) else node).location
    return (*location.begin[1:], *location.end[1:])


def names_in(node: SyntaxNode) -> frozenset[str]:
    """Return the names of the variables in a tree, but for `_`."""
    if node._names is None:
        is_variable = node.ast_type is Kind.Variable
        node._names = _variable_set(node.name) if is_variable else names_of(node.children)
    return node._names


def names_of(nodes: Iterable[SyntaxNode]) -> frozenset[str]:
    """Return the names of the variables in several trees, but for `_`."""
    return _NONE.union(*map(names_in, nodes))


@lru_cache(maxsize=1024)
def _variable_set(name: str) -> frozenset[str]:
    return _NONE if name == "_" else frozenset((name,))


def below(node: SyntaxNode) -> Sequence[SyntaxNode]:
    """Return a node and all its descendants, in the order of the text."""
    if node._below is None:
        node._below = found = []
        rest = [node]
        while rest:
            each = rest.pop()
            found.append(each)
            rest += each.children[::-1]
    return node._below


def atom_of(node: SyntaxNode) -> SyntaxNode:
    """Return the atom of a literal; other nodes are returned unchanged."""
    atom: SyntaxNode = node.atom if node.ast_type is Kind.Literal else node
    return atom


def guards_of(node: SyntaxNode) -> list[SyntaxNode]:
    """Return the guards of an aggregate, the left one first; none for other nodes."""
    found = (getattr(node, "left_guard", None), getattr(node, "right_guard", None))
    return [guard for guard in found if guard is not None]


def global_names(nodes: Iterable[SyntaxNode]) -> frozenset[str]:
    """Return the variables of heads and literals that are outside of elements and conditions.

    These variables are global, as are those of guards; the scope of other variables is their own
    element (ASP-Core-2, section 2.1; gringo's local variables).
    """
    found: list[SyntaxNode] = []
    for node in nodes:
        atom = atom_of(node)
        found += guards_of(atom) if atom.ast_type in WITH_ELEMENTS else (node,)
    return names_of(found)


def elements_of(
    node: SyntaxNode,
) -> list[tuple[tuple[SyntaxNode, ...], tuple[SyntaxNode, ...]]]:
    """Return the terms and literals of each element of a node, with the condition of the element.

    Aggregates and disjunctions have elements, and a literal is one, with a condition or without;
    other nodes have none.
    """
    match node.ast_type:
        case Kind.Literal:
            return [((node,), ())]
        case Kind.Aggregate | Kind.Disjunction:
            return [((each.literal,), each.condition) for each in node.elements]
        case Kind.BodyAggregate:
            return [(each.terms, each.condition) for each in node.elements]
        case Kind.HeadAggregate:
            inner = ((each.terms, each.condition) for each in node.elements)
            return [((*terms, each.literal), each.condition) for terms, each in inner]
        case Kind.ConditionalLiteral:
            return [((node.literal,), node.condition)]
        case _:
            return []
