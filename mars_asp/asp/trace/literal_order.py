"""An order in which the literals of a rule's body can be tested, each when its variables are bound.

A literal's turn comes when the variables that it cannot bind itself are bound; tests come before
literals that bind variables. (Left-to-right safety of Datalog, Ullman 1988, chapter 12.)
"""

from collections.abc import Iterator, Sequence, Set
from functools import partial

import clingo

from mars_asp.asp.rules.statements import sign_and_function
from mars_asp.asp.rules.trees import (
    AGGREGATES,
    COMPARISONS,
    OPERATIONS,
    UNARY_OPERATIONS,
    Kind,
    Sign,
    SyntaxNode,
    global_names,
    guards_of,
    names_in,
    names_of,
)


def in_order(
    literals: Sequence[SyntaxNode], bound: Set[str], shared: Set[str]
) -> Iterator[tuple[SyntaxNode, set[str]]]:
    """Yield each literal with the variables that are bound before it.

    `bound` are bound at first, `shared` are the rule's global variables. Literals that can never be
    tested are left out.
    """
    names = set(bound)
    waiting = list(literals)
    while waiting:
        ready = [(literal, _provides(literal, names, shared)) for literal in waiting]
        turns = [(literal, new) for literal, new in ready if new is not None]
        if not turns:
            return
        literal, new = min(turns, key=partial(_turn, names))
        yield literal, set(names)
        names |= new
        waiting = [other for other in waiting if other is not literal]


def needs(literal: SyntaxNode, shared: Set[str]) -> Set[str]:
    """Return those of the `shared` (global) variables that occur in a literal."""
    return names_in(literal) & shared


def provided(term: SyntaxNode) -> set[str]:
    """Return the variables that are bound when a term is matched."""
    if term.ast_type == Kind.Function:
        return {name for argument in term.arguments for name in provided(argument)}
    return _inverted(term)


def _inverted(term: SyntaxNode) -> set[str]:
    """Return the variable that clingo can compute from a linear term, such as X from `2*X+1`."""
    if term.ast_type == Kind.Variable:
        return {term.name} - {"_"}
    if term.ast_type == Kind.UnaryOperation and UNARY_OPERATIONS[term.operator_type] == "-":
        return _inverted(term.argument)
    if term.ast_type == Kind.BinaryOperation:
        sides = ((term.left, term.right), (term.right, term.left))
        sign = OPERATIONS[term.operator_type]
        known = _is_factor if sign == "*" else _is_constant
        if sign in "+-*":
            return {name for side, other in sides if known(other) for name in _inverted(side)}
    return set()


def _is_constant(term: SyntaxNode) -> bool:
    """Return whether a term is made of constants by arithmetic."""
    if term.ast_type == Kind.BinaryOperation:
        return _is_constant(term.left) and _is_constant(term.right)
    if term.ast_type == Kind.UnaryOperation:
        return _is_constant(term.argument)
    return bool(term.ast_type == Kind.SymbolicTerm)


def _is_factor(term: SyntaxNode) -> bool:
    """Whether a term is a number other than 0, by which a product can be divided."""
    return bool(term.ast_type == Kind.SymbolicTerm and term.symbol != clingo.Number(0))


def _turn(names: Set[str], turn: tuple[SyntaxNode, set[str]]) -> tuple[bool, bool]:
    """Return a sort key: literals that bind nothing first, then those that use `names`."""
    literal, new = turn
    return bool(new - names), not names_in(literal) & names


def _provides(literal: SyntaxNode, bound: Set[str], shared: Set[str]) -> set[str] | None:
    """Return the variables that a literal binds, or None if it cannot be tested yet."""
    if literal.ast_type == Kind.Literal and literal.sign == Sign.NoSign:
        atom = literal.atom
        if atom.ast_type == Kind.SymbolicAtom:
            new = provided(sign_and_function(atom.symbol)[1])
            return new if names_in(atom) <= bound | new else None
        if atom.ast_type == Kind.Comparison:
            return _equated(atom, bound)
        if atom.ast_type in AGGREGATES:
            new = set()
            for guard in guards_of(atom):
                if COMPARISONS[guard.comparison] == "=":
                    new |= provided(guard.term)
            inside = names_of(atom.elements) & shared
            return new if inside <= bound and global_names([literal]) <= bound | new else None
    return set() if needs(literal, shared) <= bound else None


def _equated(atom: SyntaxNode, bound: Set[str]) -> set[str] | None:
    if names_in(atom) <= bound:
        return set()
    if len(atom.guards) != 1 or COMPARISONS[atom.guards[0].comparison] != "=":
        return None
    left, right = atom.term, atom.guards[0].term
    for pattern, value in ((left, right), (right, left)):
        new = provided(pattern)
        if names_in(value) <= bound and names_in(pattern) <= bound | new:
            return new
    return None
