"""Ground terms and atoms as numbers, which are compared and taken apart faster than symbols.

A number identifies a term for the life of the process. Numbers have no meaningful order: sort by
symbols. Numbers and symbols are clingo's own if its Python package offers them, though not in its
documented interface; otherwise they are counted here, which is slower.
"""

import importlib
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, NamedTuple, NewType, TypeAlias

import clingo

TermId = NewType("TermId", int)


#: An atom, its literal in the ground program, and whether it is a fact.
Labelled: TypeAlias = tuple[TermId, int, bool]


#: Facts to state: the name and sign of a predicate, and terms with the arguments of its facts.
FactArguments: TypeAlias = Mapping[tuple[str, bool], Iterable[TermId]]


class TermReader(NamedTuple):
    """Functions that read terms; each is documented at the module's name for it."""

    as_term: Callable[[clingo.Symbol], TermId]
    as_symbol: Callable[[TermId], clingo.Symbol]
    text: Callable[[TermId], str]
    arguments: Callable[[TermId], Sequence[TermId]]
    atoms: Callable[[clingo.Control, str, int, bool], list[TermId]]
    labelled: Callable[[clingo.Control, str, int, bool], list[Labelled]]
    state: Callable[[clingo.Control, FactArguments], None]


def plain_reader() -> TermReader:
    """Return a reader that uses the documented interface alone."""
    symbols: list[clingo.Symbol] = []
    numbers: dict[clingo.Symbol, TermId] = {}

    def as_term(symbol: clingo.Symbol) -> TermId:
        known = numbers.get(symbol)
        if known is None:
            known = numbers[symbol] = TermId(len(symbols))
            symbols.append(symbol)
        return known

    def arguments(term: TermId) -> Sequence[TermId]:
        return [as_term(argument) for argument in symbols[term].arguments]

    def atoms(control: clingo.Control, name: str, arity: int, positive: bool) -> list[TermId]:
        found = control.symbolic_atoms.by_signature(name, arity, positive)
        return [as_term(atom.symbol) for atom in found]

    def labelled(control: clingo.Control, name: str, arity: int, positive: bool) -> list[Labelled]:
        found = control.symbolic_atoms.by_signature(name, arity, positive)
        return [(as_term(atom.symbol), atom.literal, atom.is_fact) for atom in found]

    def state(control: clingo.Control, facts: FactArguments) -> None:
        with control.backend() as backend:
            for (name, positive), like in facts.items():
                for term in like:
                    fact = clingo.Function(name, symbols[term].arguments, positive)
                    backend.add_rule([backend.add_atom(fact)])

    def text(term: TermId) -> str:
        return str(symbols[term])

    return TermReader(as_term, symbols.__getitem__, text, arguments, atoms, labelled, state)


def raw_reader() -> TermReader | None:
    """Return a reader that uses clingo's own numbers, or None if they are not available."""
    try:
        internal: Any = importlib.import_module("clingo._internal")
        ffi, lib, check = internal._ffi, internal._lib, internal._handle_error
        symbol_of: Callable[[TermId], clingo.Symbol] = clingo.Symbol
        probe = clingo.Function("f", [clingo.Number(1)])
        atoms_of: Any = clingo.Control().symbolic_atoms
        if symbol_of(probe._rep) != probe or not atoms_of._rep:
            return None
    except (ImportError, AttributeError, TypeError):
        return None
    inside = ffi.new("clingo_symbol_t**")
    size = ffi.new("size_t*")
    read, unpack = lib.clingo_symbol_arguments, ffi.unpack
    measure, write = lib.clingo_symbol_to_string_size, lib.clingo_symbol_to_string
    room = 4096
    buffer = ffi.new("char[]", room)

    def as_term(symbol: clingo.Symbol) -> TermId:
        raw: Any = symbol
        return TermId(raw._rep)

    def text(term: TermId) -> str:
        place = buffer
        if not write(term, buffer, room):
            check(measure(term, size))
            place = ffi.new("char[]", size[0])
            check(write(term, place, size[0]))
        found: str = ffi.string(place).decode()
        return found

    def arguments(term: TermId) -> Sequence[TermId]:
        if not read(term, inside, size):
            check(False)
        count = size[0]
        found: Sequence[TermId] = unpack(inside[0], count) if count else ()
        return found

    atoms, labelled = _raw_atoms(ffi, lib, check)
    state = _raw_state(ffi, lib, check)
    return TermReader(as_term, symbol_of, text, arguments, atoms, labelled, state)


def _raw_atoms(
    ffi: Any, lib: Any, check: Any
) -> tuple[
    Callable[[clingo.Control, str, int, bool], list[TermId]],
    Callable[[clingo.Control, str, int, bool], list[Labelled]],
]:
    signature = ffi.new("clingo_signature_t*")
    place = ffi.new("clingo_symbolic_atom_iterator_t*")
    valid = ffi.new("bool*")
    symbol = ffi.new("clingo_symbol_t*")
    literal = ffi.new("clingo_literal_t*")
    is_fact = ffi.new("bool*")
    read_symbol, read_literal = lib.clingo_symbolic_atoms_symbol, lib.clingo_symbolic_atoms_literal
    read_is_fact = lib.clingo_symbolic_atoms_is_fact
    following, is_valid = lib.clingo_symbolic_atoms_next, lib.clingo_symbolic_atoms_is_valid

    def begin(control: clingo.Control, name: str, arity: int, positive: bool) -> Any:
        """Set `place` to the first atom of a predicate; return clingo's handle of all atoms."""
        symbolic: Any = control.symbolic_atoms
        base = symbolic._rep
        check(lib.clingo_signature_create(name.encode(), arity, positive, signature))
        check(lib.clingo_symbolic_atoms_begin(base, signature, place))
        check(is_valid(base, place[0], valid))
        return base

    # A call of `check` for each of these calls would double their time.
    def atoms(control: clingo.Control, name: str, arity: int, positive: bool) -> list[TermId]:
        found: list[TermId] = []
        base = begin(control, name, arity, positive)
        while valid[0]:
            done = read_symbol(base, place[0], symbol) and following(base, place[0], place)
            if not (done and is_valid(base, place[0], valid)):
                check(False)
            found.append(symbol[0])
        return found

    def labelled(control: clingo.Control, name: str, arity: int, positive: bool) -> list[Labelled]:
        found = []
        base = begin(control, name, arity, positive)
        while valid[0]:
            done = read_symbol(base, place[0], symbol) and read_literal(base, place[0], literal)
            done = done and read_is_fact(base, place[0], is_fact)
            if not (done and following(base, place[0], place) and is_valid(base, place[0], valid)):
                check(False)
            found.append((symbol[0], literal[0], is_fact[0]))
        return found

    return atoms, labelled


def _raw_state(ffi: Any, lib: Any, check: Any) -> Callable[[clingo.Control, FactArguments], None]:
    inside = ffi.new("clingo_symbol_t**")
    size = ffi.new("size_t*")
    symbol = ffi.new("clingo_symbol_t*")
    atom = ffi.new("clingo_atom_t*")
    read, create = lib.clingo_symbol_arguments, lib.clingo_symbol_create_function
    add, rule = lib.clingo_backend_add_atom, lib.clingo_backend_rule

    def state(control: clingo.Control, facts: FactArguments) -> None:
        with control.backend() as backend:
            base: Any = backend
            held, none = base._rep, ffi.NULL
            for (name, positive), like in facts.items():
                word = name.encode()
                for term in like:
                    done = read(term, inside, size)
                    done = done and create(word, inside[0], size[0], positive, symbol)
                    done = done and add(held, symbol, atom)
                    if not (done and rule(held, False, atom, 1, none, 0)):
                        check(False)

    return state


_READER = raw_reader() or plain_reader()
#: The number of a symbol.
as_term = _READER.as_term
#: The symbol of a number.
as_symbol = _READER.as_symbol
#: The text of a term in clingo's syntax.
text = _READER.text
#: The arguments of a function or tuple.
arguments = _READER.arguments
#: The atoms of a predicate: its name, arity and whether it is not classically negated.
atoms = _READER.atoms
#: The atoms of a predicate with their literals, and whether each is a fact.
labelled = _READER.labelled
#: State facts of predicates with the arguments of other atoms. The first one takes a millisecond.
state = _READER.state
