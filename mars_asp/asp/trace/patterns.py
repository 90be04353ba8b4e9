"""Atoms with holes: a pattern is absent when no true atom fits it.

A hole is the term `_any("X")` for any value; holes of one name have one value, except `_`.
"""

from collections.abc import Iterator

import clingo

from mars_asp.asp.rules.statements import parsed
from mars_asp.asp.rules.trees import Kind, Sign, SyntaxNode, names_in, plain
from mars_asp.asp.solve.atoms import function_text

_HOLE = "_any"
_FUNCTION = clingo.SymbolType.Function


def hole(name: str = "_") -> clingo.Symbol:
    """Return a hole, which matches any value; `name` is its variable in texts."""
    return clingo.Function(_HOLE, [clingo.String(name)])


def is_hole(symbol: clingo.Symbol) -> bool:
    """Whether a term is a hole."""
    return symbol.type == _FUNCTION and symbol.name == _HOLE and len(symbol.arguments) == 1


def has_holes(symbol: clingo.Symbol) -> bool:
    """Whether a term contains a hole."""
    if symbol.type != _FUNCTION:
        return False
    return is_hole(symbol) or any(map(has_holes, symbol.arguments))


def subterms(symbol: clingo.Symbol) -> Iterator[clingo.Symbol]:
    """Yield a term and the terms in it, without holes."""
    if not is_hole(symbol):
        yield symbol
        for argument in symbol.arguments if symbol.type == _FUNCTION else ():
            yield from subterms(argument)


def strings_in(symbol: clingo.Symbol) -> frozenset[str]:
    """Return the strings in a term."""
    terms = subterms(symbol)
    return frozenset(each.string for each in terms if each.type == clingo.SymbolType.String)


def fixed_parts(symbol: clingo.Symbol) -> list[clingo.Symbol]:
    """Return the largest subterms of a pattern without holes, from left to right."""
    if is_hole(symbol):
        return []
    found: list[clingo.Symbol] = []
    for argument in symbol.arguments:
        found += fixed_parts(argument) if has_holes(argument) else [argument]
    return found


def can_be_followed(symbol: clingo.Symbol) -> bool:
    """Whether all holes are plain variables; others, such as `X+1`, make a pattern too wide."""
    if symbol.type != _FUNCTION:
        return True
    if is_hole(symbol):
        return symbol.arguments[0].string.replace("'", "").replace("_", "a").isalnum()
    return all(map(can_be_followed, symbol.arguments))


def shown_pattern(symbol: clingo.Symbol) -> str:
    """Return a pattern's text, with the names of its holes."""
    if symbol.type != _FUNCTION or not has_holes(symbol):
        return str(symbol)
    if is_hole(symbol):
        return symbol.arguments[0].string
    name = symbol.name if symbol.positive else f"-{symbol.name}"
    return function_text(name, list(map(shown_pattern, symbol.arguments)))


def fits(
    pattern: clingo.Symbol, symbol: clingo.Symbol, values: dict[str, clingo.Symbol] | None = None
) -> bool:
    """Whether a term is an instance of a pattern; `values` receives the values of its holes."""
    values = {} if values is None else values
    if is_hole(pattern):
        name = pattern.arguments[0].string
        return name == "_" or values.setdefault(name, symbol) == symbol
    if not has_holes(pattern):
        return pattern == symbol
    if symbol.type != _FUNCTION:
        return False
    kinds = [(s.name, s.positive, len(s.arguments)) for s in (pattern, symbol)]
    return kinds[0] == kinds[1] and all(
        fits(part, value, values)
        for part, value in zip(pattern.arguments, symbol.arguments, strict=True)
    )


def pattern_term(term: SyntaxNode, bound: set[str]) -> str:
    """Return a term's text as a pattern; parts with unbound variables become holes."""
    names = names_in(term)
    anonymous = "_" in str(term) and pattern_is_open(term)
    if names <= bound and not anonymous:
        return str(term)
    if term.ast_type == Kind.Function:
        return function_text(term.name, [pattern_term(each, bound) for each in term.arguments])
    return f"{_HOLE}({clingo.String(str(term))})"


def pattern_is_open(term: SyntaxNode) -> bool:
    """Whether a term contains an anonymous variable."""
    if term.ast_type == Kind.Variable:
        return bool(term.name == "_")
    return term.ast_type == Kind.Function and any(map(pattern_is_open, term.arguments))


def pattern_in(text: str) -> clingo.Symbol | None:
    """Return the pattern in a user's text, such as `reach(X)`; None if it is not an atom."""
    try:
        (rule,) = map(plain, parsed(f"{text}.")[1:])
        if rule.body or rule.head.sign != Sign.NoSign:
            return None
        return pattern_of(rule.head.atom.symbol)
    except (RuntimeError, ValueError, AttributeError):
        return None


def pattern_of(term: SyntaxNode) -> clingo.Symbol:
    """Return the pattern of an atom that a user writes; its variables become holes.

    Raises:
        ValueError: the term holds arithmetic, an interval or a pool.
    """
    if term.ast_type == Kind.Variable:
        return hole(term.name)
    if term.ast_type == Kind.SymbolicTerm:
        symbol: clingo.Symbol = term.symbol
        return symbol
    if term.ast_type == Kind.Function:
        return clingo.Function(term.name, [pattern_of(argument) for argument in term.arguments])
    if term.ast_type == Kind.UnaryOperation:
        inner = pattern_of(term.argument)
        if inner.type == clingo.SymbolType.Number:
            return clingo.Number(-inner.number)
        if inner.type == _FUNCTION and inner.name and not is_hole(inner):
            return clingo.Function(inner.name, inner.arguments, not inner.positive)
    raise ValueError(str(term))
