"""Ground terms as numbers, which are compared and taken apart much faster than clingo's symbols.

A number stands for one term as long as the process lives. Its size says nothing: sort by symbols.
Numbers and symbols are clingo's own where its Python package offers them, though not in its
documented interface; otherwise they are counted here, more slowly.
"""

import importlib
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple, NewType

import clingo

Term = NewType("Term", int)


class Reader(NamedTuple):
    """How terms are read: each function is documented where it is defined for all."""

    as_term: Callable[[clingo.Symbol], Term]
    as_symbol: Callable[[Term], clingo.Symbol]
    arguments: Callable[[Term], Sequence[Term]]
    atoms: Callable[[clingo.Control, str, int, bool], list[Term]]


def plain_reader() -> Reader:
    """Return a reader by the documented interface alone."""
    symbols: list[clingo.Symbol] = []
    numbers: dict[clingo.Symbol, Term] = {}

    def as_term(symbol: clingo.Symbol) -> Term:
        known = numbers.get(symbol)
        if known is None:
            known = numbers[symbol] = Term(len(symbols))
            symbols.append(symbol)
        return known

    def arguments(term: Term) -> Sequence[Term]:
        return [as_term(argument) for argument in symbols[term].arguments]

    def atoms(control: clingo.Control, name: str, arity: int, positive: bool) -> list[Term]:
        found = control.symbolic_atoms.by_signature(name, arity, positive)
        return [as_term(atom.symbol) for atom in found]

    return Reader(as_term, symbols.__getitem__, arguments, atoms)


def raw_reader() -> Reader | None:
    """Return a reader by clingo's own numbers; `None` where they cannot be had."""
    try:
        internal: Any = importlib.import_module("clingo._internal")
        ffi, lib, check = internal._ffi, internal._lib, internal._handle_error
        symbol_of: Callable[[Term], clingo.Symbol] = clingo.Symbol
        probe = clingo.Function("f", [clingo.Number(1)])
        atoms_of: Any = clingo.Control().symbolic_atoms
        if symbol_of(probe._rep) != probe or not atoms_of._rep:
            return None
    except (ImportError, AttributeError, TypeError):
        return None
    inside = ffi.new("clingo_symbol_t**")
    size = ffi.new("size_t*")
    read, unpack = lib.clingo_symbol_arguments, ffi.unpack

    def as_term(symbol: clingo.Symbol) -> Term:
        return Term(symbol._rep)

    def arguments(term: Term) -> Sequence[Term]:
        check(read(term, inside, size))
        count = size[0]
        found: Sequence[Term] = unpack(inside[0], count) if count else ()
        return found

    def atoms(control: clingo.Control, name: str, arity: int, positive: bool) -> list[Term]:
        base: Any = control.symbolic_atoms
        signature = ffi.new("clingo_signature_t*")
        place = ffi.new("clingo_symbolic_atom_iterator_t*")
        valid = ffi.new("bool*")
        symbol = ffi.new("clingo_symbol_t*")
        check(lib.clingo_signature_create(name.encode(), arity, positive, signature))
        check(lib.clingo_symbolic_atoms_begin(base._rep, signature, place))
        found = []
        is_valid, read_symbol = lib.clingo_symbolic_atoms_is_valid, lib.clingo_symbolic_atoms_symbol
        following = lib.clingo_symbolic_atoms_next
        check(is_valid(base._rep, place[0], valid))
        while valid[0]:
            check(read_symbol(base._rep, place[0], symbol))
            found.append(symbol[0])
            check(following(base._rep, place[0], place))
            check(is_valid(base._rep, place[0], valid))
        return found

    return Reader(as_term, symbol_of, arguments, atoms)


_READER = raw_reader() or plain_reader()
#: The number of a symbol.
as_term = _READER.as_term
#: The symbol of a number.
as_symbol = _READER.as_symbol
#: The arguments of a function or tuple.
arguments = _READER.arguments
#: The atoms of a predicate: its name, arity and whether it is not classically negated.
atoms = _READER.atoms
