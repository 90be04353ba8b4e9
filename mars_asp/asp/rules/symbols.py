"""Terms of facts as clingo's symbols, and back."""

import clingo

from mars_asp.asp.rules.statements import masked
from mars_asp.asp.solve.atoms import Atom, Term


def symbol_of(term: Term) -> clingo.Symbol:
    """Return a term of a fact, or an atom, as clingo's symbol."""
    match term:
        case int():
            return clingo.Number(term)
        case str():
            return clingo.String(term)
        case Atom(name, arguments):
            return clingo.Function(name, list(map(symbol_of, arguments)))


def term_of(symbol: clingo.Symbol) -> Term:
    """Return a symbol of clingo as a term of a fact."""
    kinds = clingo.SymbolType
    if symbol.type == kinds.Number:
        return symbol.number
    if symbol.type == kinds.String:
        return symbol.string
    if symbol.type == kinds.Function and symbol.positive:
        return Atom(symbol.name, tuple(map(term_of, symbol.arguments)))
    return Atom(str(symbol))


def symbol_in(text: str) -> clingo.Symbol | None:
    """Return the ground term in a text, or None if it is not one."""
    try:
        if not text.isascii():
            # clingo may cut its message within a character, which its Python package cannot decode.
            clingo.parse_term(masked(text), logger=lambda *_: None)
        return clingo.parse_term(text, logger=lambda *_: None)
    except RuntimeError:
        return None
