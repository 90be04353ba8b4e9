"""Clingo's syntax trees as plain values: each node is read once, whoever asks for it how often.

Clingo's own nodes ask its library for each attribute anew, in several calls, which is most of the
time that it takes to read rules.
"""

import importlib
from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache
from typing import Any, NamedTuple, TypeAlias

from clingo import Symbol, ast

#: The kinds of nodes.
Kind = ast.ASTType
#: The kinds of nodes that have elements with variables of their own.
WITH_ELEMENTS = (
    *(Kind.Aggregate, Kind.BodyAggregate, Kind.HeadAggregate),
    *(Kind.Disjunction, Kind.ConditionalLiteral),
)
_LISTS = (ast.ASTSequence, ast.StrSequence)


_NONE: frozenset[str] = frozenset()
#: Where a node begins and where it ends: lines from 1, and columns from 1 that count bytes.
Extent: TypeAlias = tuple[int, int, int, int]
#: Reads an attribute, by its number, of a node of clingo's.
_Leaf: TypeAlias = Callable[[Any, int], Any]


class SyntaxNode:
    """A node of a syntax tree: the attributes that clingo's has, lists of nodes as tuples.

    `children` are the nodes directly below it in their order. Clingo's own is that of `tree`, or
    `inside` it, which keeps it alive.
    """

    ast_type: ast.ASTType
    children: "list[SyntaxNode]"
    _names: frozenset[str] | None = None
    _text: str | None = None
    _below: "list[SyntaxNode] | None" = None

    def __init__(self, tree: ast.AST, inside: Any = None) -> None:
        self._tree, self._inside = tree, inside

    def __getattr__(self, name: str) -> Any:
        """Refuse an attribute that the node does not have; for checkers of types, it has any."""
        raise AttributeError(name)

    @property
    def tree(self) -> ast.AST:
        """Return clingo's node."""
        return self._tree if self._inside is None else _wrap(self._inside)

    @property
    def extent(self) -> Extent:
        """Return where it begins and ends."""
        return _place(self._tree if self._inside is None else self._inside)

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


class TreeReader(NamedTuple):
    """Reads one of clingo's nodes with all below it, or only where it begins and ends."""

    read: Callable[[ast.AST], SyntaxNode]
    #: Takes what the library knows a node by, too.
    place: Callable[[Any], Extent]
    #: Returns clingo's node for what its library knows it by.
    wrap: Callable[[Any], ast.AST]


def plain(tree: ast.AST) -> SyntaxNode:
    """Return clingo's node, with all below it, as plain values."""
    return _read(tree)


def extent_of(node: SyntaxNode | ast.AST) -> Extent:
    """Return where a node begins and ends."""
    return node.extent if isinstance(node, SyntaxNode) else _place(node)


def names_in(node: SyntaxNode) -> frozenset[str]:
    """Return the names of the variables in a tree, but for `_`."""
    if node._names is None:
        if node.ast_type is Kind.Variable:
            node._names = _variable_set(node.name)
        else:
            node._names = _NONE.union(*map(names_in, node.children)) if node.children else _NONE
    return node._names


@lru_cache(maxsize=1024)
def _variable_set(name: str) -> frozenset[str]:
    return _NONE if name == "_" else frozenset((name,))


def below(node: SyntaxNode) -> Sequence[SyntaxNode]:
    """Return a node and all below it, in their order."""
    if node._below is None:
        node._below = found = []
        rest = [node]
        while rest:
            each = rest.pop()
            found.append(each)
            rest += each.children[::-1]
    return node._below


def atom_of(node: SyntaxNode) -> SyntaxNode:
    """Return the atom of a literal; conditional literals and heads of other kinds are their own."""
    atom: SyntaxNode = node.atom if node.ast_type is Kind.Literal else node
    return atom


def guards_of(node: SyntaxNode) -> list[SyntaxNode]:
    """Return the guards of an aggregate, the left one first; none for other nodes."""
    found = (getattr(node, "left_guard", None), getattr(node, "right_guard", None))
    return [guard for guard in found if guard is not None]


def elements_of(
    node: SyntaxNode,
) -> list[tuple[tuple[SyntaxNode, ...], tuple[SyntaxNode, ...]]]:
    """Return the terms and literals of each element of a node, with the condition of the element.

    Aggregates and disjunctions have elements, and a conditional literal is one; other nodes have
    none.
    """
    match node.ast_type:
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


def public_reader() -> TreeReader:
    """Return a reader by what clingo documents."""

    def place(tree: ast.AST) -> Extent:
        begin, end = tree.location.begin, tree.location.end
        return begin.line, begin.column, end.line, end.column

    def read(tree: ast.AST) -> SyntaxNode:
        node = SyntaxNode(tree)
        node.ast_type, node.children = tree.ast_type, []
        for name in tree.keys():  # noqa: SIM118 -- a node is no mapping
            if name == "location":
                continue
            value: Any = getattr(tree, name)
            if isinstance(value, ast.AST):
                value = read(value)
                node.children.append(value)
            elif isinstance(value, _LISTS):
                value = tuple(read(each) if isinstance(each, ast.AST) else each for each in value)
                node.children += (each for each in value if isinstance(each, SyntaxNode))
            setattr(node, name, value)
        return node

    return TreeReader(read, place, lambda tree: tree)


def raw_reader() -> TreeReader | None:
    """Return a reader that asks clingo's library itself, or None if it cannot be had."""
    try:
        internal: Any = importlib.import_module("clingo._internal")
        ffi, lib, check = internal._ffi, internal._lib, internal._handle_error
        leaves = _leaves(ffi, lib, check)
        read = _raw_reader(ffi, lib, check, leaves)
        reader = TreeReader(read, _placer(lib, leaves), _wrapper(lib))
        probe: list[ast.AST] = []
        ast.parse_string("p(X).", probe.append)
        reader.place(reader.wrap(reader.read(probe[-1])._inside))
    except (ImportError, AttributeError, TypeError, RuntimeError):
        return None
    return reader


def _raw_reader(
    ffi: Any, lib: Any, check: Any, leaves: Mapping[int, _Leaf]
) -> Callable[[Any], SyntaxNode]:
    forms = _forms(ffi, lib, leaves)
    kinds = {kind.value: kind for kind in ast.ASTType}
    get_type, get_node = lib.clingo_ast_get_type, lib.clingo_ast_attribute_get_ast
    get_other = lib.clingo_ast_attribute_get_optional_ast
    get_size = lib.clingo_ast_attribute_size_ast_array
    get_at = lib.clingo_ast_attribute_get_ast_at
    release = lib.clingo_ast_release
    # What the library writes its answers to.
    kind_at, size = ffi.new("clingo_ast_type_t*"), ffi.new("size_t*")
    inside = ffi.new("clingo_ast_t**")
    one, other = lib.clingo_ast_attribute_type_ast, lib.clingo_ast_attribute_type_optional_ast
    many = lib.clingo_ast_attribute_type_ast_array

    def read(tree: Any) -> SyntaxNode:
        return inner(tree, tree._rep)

    def inner(tree: Any, rep: Any) -> SyntaxNode:
        # The whole keeps its parts, so that none of them needs a value of Python's.
        node = SyntaxNode(tree, rep)
        node.children = children = []
        get_type(rep, kind_at) or check(False)
        kind = kind_at[0]
        node.ast_type = kinds[kind]
        value: Any
        for name, attribute, form, leaf in forms[kind]:
            if leaf is not None:
                value = leaf(rep, attribute)
            elif form == one:
                get_node(rep, attribute, inside) or check(False)
                value = inner(tree, inside[0])
                children.append(value)
                release(value._inside)
            elif form == many:
                get_size(rep, attribute, size) or check(False)
                found = []
                for at in range(size[0]):
                    get_at(rep, attribute, at, inside) or check(False)
                    found.append(inner(tree, inside[0]))
                    release(found[-1]._inside)
                value = tuple(found)
                children += found
            elif form == other:
                get_other(rep, attribute, inside) or check(False)
                value = None
                if inside[0] != ffi.NULL:
                    value = inner(tree, inside[0])
                    children.append(value)
                    release(value._inside)
            else:
                value = tuple(getattr(node.tree, name))
            setattr(node, name, value)
        return node

    return read


def _placer(lib: Any, leaves: Mapping[int, _Leaf]) -> Callable[[Any], Extent]:
    extent = leaves[lib.clingo_ast_attribute_type_location]
    location = lib.clingo_ast_attribute_location

    def place(tree: Any) -> Extent:
        found: Extent = extent(getattr(tree, "_rep", tree), location)
        return found

    return place


def _wrapper(lib: Any) -> Callable[[Any], ast.AST]:
    make: Any = ast.AST

    def wrap(rep: Any) -> ast.AST:
        lib.clingo_ast_acquire(rep)
        found: ast.AST = make(rep)
        return found

    return wrap


def _leaves(ffi: Any, lib: Any, check: Any) -> dict[int, _Leaf]:
    """Return what reads an attribute that is no node, by its form."""
    get_place, get_text = (
        lib.clingo_ast_attribute_get_location,
        lib.clingo_ast_attribute_get_string,
    )
    get_number, get_symbol = (
        lib.clingo_ast_attribute_get_number,
        lib.clingo_ast_attribute_get_symbol,
    )
    place, text = ffi.new("clingo_location_t*"), ffi.new("char**")
    number, symbol = ffi.new("int*"), ffi.new("clingo_symbol_t*")
    symbol_of: Any = Symbol

    def extent(rep: Any, attribute: int) -> Extent:
        get_place(rep, attribute, place) or check(False)
        return place.begin_line, place.begin_column, place.end_line, place.end_column

    def written(rep: Any, attribute: int) -> str:
        get_text(rep, attribute, text) or check(False)
        found: str = ffi.string(text[0]).decode()
        return found

    def counted(rep: Any, attribute: int) -> int:
        get_number(rep, attribute, number) or check(False)
        found: int = number[0]
        return found

    def value(rep: Any, attribute: int) -> Symbol:
        get_symbol(rep, attribute, symbol) or check(False)
        found: Symbol = symbol_of(symbol[0])
        return found

    return {
        lib.clingo_ast_attribute_type_location: extent,
        lib.clingo_ast_attribute_type_string: written,
        lib.clingo_ast_attribute_type_number: counted,
        lib.clingo_ast_attribute_type_symbol: value,
    }


def _forms(
    ffi: Any, lib: Any, leaves: Mapping[int, _Leaf]
) -> dict[int, list[tuple[str, int, int, _Leaf | None]]]:
    """Return the attributes of each kind of node: names, numbers, forms, and what reads leaves."""
    made, names = lib.g_clingo_ast_constructors, lib.g_clingo_ast_attribute_names.names
    return {
        kind: [
            (
                ffi.string(names[each.attribute]).decode(),
                each.attribute,
                each.type,
                leaves.get(each.type),
            )
            for each in (made.constructors[kind].arguments[at] for at in range(size))
            # Hardly any place is asked for.
            if each.type != lib.clingo_ast_attribute_type_location
        ]
        for kind in range(made.size)
        for size in (made.constructors[kind].size,)
    }


_read, _place, _wrap = raw_reader() or public_reader()
