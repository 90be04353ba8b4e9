"""Clingo's syntax trees as plain values: each node is read once, whoever asks for it how often.

Clingo's own nodes ask its library for each attribute anew, in several calls, which is most of the
time that it takes to read rules.
"""

import importlib
from collections.abc import Callable
from typing import Any, TypeAlias

from clingo import Symbol, ast

#: What nodes are.
Kind = ast.ASTType
_LISTS = (ast.ASTSequence, ast.StrSequence)


#: Where a node begins and where it ends: lines from 1, and columns from 1 that count bytes.
Extent: TypeAlias = tuple[int, int, int, int]
#: Reads an attribute, by its number, of a node of clingo's.
_Leaf: TypeAlias = Callable[[Any, int], Any]


class Node:
    """A node of a syntax tree: the attributes that clingo's has, lists of nodes as tuples.

    `children` are the nodes directly below it in their order, `extent` is where it stands, if it
    has a place.
    """

    __slots__ = ("__dict__", "_tree", "ast_type", "children", "extent", "names")

    ast_type: ast.ASTType
    children: "list[Node]"
    extent: Extent
    #: The variables in it, but for `_`; known when they have been asked for.
    names: frozenset[str] | None

    def __init__(self, tree: ast.AST) -> None:
        self._tree = tree
        self.names = None

    def __getattr__(self, name: str) -> Any:
        """Refuse an attribute that the node does not have; for checkers of types, it has any."""
        raise AttributeError(name)

    def __str__(self) -> str:
        return str(self._tree)


def plain(tree: ast.AST) -> Node:
    """Return clingo's node, with all below it, as plain values."""
    return _read(tree)


def extent_of(node: Node | ast.AST) -> Extent:
    """Return where a node begins and ends."""
    if isinstance(node, Node):
        return node.extent
    begin, end = node.location.begin, node.location.end
    return begin.line, begin.column, end.line, end.column


def below(node: Node) -> list[Node]:
    """Return a node and all below it, in their order."""
    found: list[Node] = []
    _gather(node, found)
    return found


def _gather(node: Node, found: list[Node]) -> None:
    found.append(node)
    for child in node.children:
        _gather(child, found)


def public_reader() -> Callable[[ast.AST], Node]:
    """Return a reader by what clingo documents."""

    def read(tree: ast.AST) -> Node:
        node = Node(tree)
        node.ast_type, node.children = tree.ast_type, []
        for name in tree.keys():  # noqa: SIM118 -- a node is no mapping
            value: Any = getattr(tree, name)
            if name == "location":
                begin, end = value.begin, value.end
                node.extent = (begin.line, begin.column, end.line, end.column)
            elif isinstance(value, ast.AST):
                node.__dict__[name] = read(value)
                node.children.append(node.__dict__[name])
            elif isinstance(value, _LISTS):
                inside = [read(each) if isinstance(each, ast.AST) else each for each in value]
                node.__dict__[name] = tuple(inside)
                node.children += (each for each in inside if isinstance(each, Node))
            else:
                node.__dict__[name] = value
        return node

    return read


def raw_reader() -> Callable[[ast.AST], Node] | None:
    """Return a reader that asks clingo's library itself; `None` where it cannot be had."""
    try:
        internal: Any = importlib.import_module("clingo._internal")
        read = _raw_reader(internal._ffi, internal._lib, internal._handle_error)
        probe: list[ast.AST] = []
        ast.parse_string("p(X).", probe.append)
        read(probe[-1])
    except (ImportError, AttributeError, TypeError, RuntimeError):
        return None
    return read


def _raw_reader(ffi: Any, lib: Any, check: Any) -> Callable[[Any], Node]:
    forms = _forms(ffi, lib, _leaves(ffi, lib, check))
    kinds = {kind.value: kind for kind in ast.ASTType}
    get_type, get_node = lib.clingo_ast_get_type, lib.clingo_ast_attribute_get_ast
    get_other = lib.clingo_ast_attribute_get_optional_ast
    get_size = lib.clingo_ast_attribute_size_ast_array
    get_at = lib.clingo_ast_attribute_get_ast_at
    # What the library writes its answers to.
    kind_at, size = ffi.new("clingo_ast_type_t*"), ffi.new("size_t*")
    inside = ffi.new("clingo_ast_t**")
    make: Any = ast.AST
    one, other = lib.clingo_ast_attribute_type_ast, lib.clingo_ast_attribute_type_optional_ast
    many = lib.clingo_ast_attribute_type_ast_array

    def read(tree: Any) -> Node:
        rep = tree._rep
        node = Node(tree)
        own = node.__dict__
        node.children = children = []
        get_type(rep, kind_at) or check(False)
        kind = kind_at[0]
        node.ast_type = kinds[kind]
        for name, attribute, form, leaf in forms[kind]:
            if leaf is not None:
                value = leaf(rep, attribute)
                if name == "location":
                    node.extent = value
                else:
                    own[name] = value
            elif form == one:
                get_node(rep, attribute, inside) or check(False)
                own[name] = child = read(make(inside[0]))
                children.append(child)
            elif form == many:
                get_size(rep, attribute, size) or check(False)
                found = []
                for at in range(size[0]):
                    get_at(rep, attribute, at, inside) or check(False)
                    found.append(read(make(inside[0])))
                own[name] = tuple(found)
                children += found
            elif form == other:
                get_other(rep, attribute, inside) or check(False)
                own[name] = None
                if inside[0] != ffi.NULL:
                    own[name] = child = read(make(inside[0]))
                    children.append(child)
            else:
                own[name] = tuple(getattr(tree, name))
        return node

    return read


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
    ffi: Any, lib: Any, leaves: dict[int, _Leaf]
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
        ]
        for kind in range(made.size)
        for size in (made.constructors[kind].size,)
    }


_read = raw_reader() or public_reader()
