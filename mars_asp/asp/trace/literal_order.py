"""An order in which the literals of a rule's body can be tested, each when its variables are bound.

A literal's turn comes when the variables that it cannot bind itself are bound; tests come before
literals that bind variables. (Left-to-right safety of Datalog, Ullman 1988, chapter 12.)
"""

from collections.abc import Iterator, Sequence, Set
from functools import partial

import clingo
from clingo import ast

from mars_asp.asp.rules.statements import sign_and_function
from mars_asp.asp.trace.scope import AGGREGATES, guards, variables_of

_TYPE = ast.ASTType
_INVERTIBLE = (ast.BinaryOperator.Plus, ast.BinaryOperator.Minus)
_TIMES = ast.BinaryOperator.Multiplication


def in_order(
    literals: Sequence[ast.AST], bound: Set[str], shared: Set[str]
) -> Iterator[tuple[ast.AST, set[str]]]:
    """Yield each literal in a testable order, with the variables bound before it.

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


def needs(literal: ast.AST, shared: Set[str]) -> set[str]:
    """Return the global variables that occur in a literal."""
    return variables_of((literal,)) & shared


def provided(term: ast.AST) -> set[str]:
    """Return the variables that are bound when a term is matched."""
    if term.ast_type == _TYPE.Function:
        return {name for argument in term.arguments for name in provided(argument)}
    return _inverted(term)


def _inverted(term: ast.AST) -> set[str]:
    """Return the variable that clingo can compute from a linear term, such as X from `2*X+1`."""
    if term.ast_type == _TYPE.Variable:
        return {term.name} - {"_"}
    if term.ast_type == _TYPE.UnaryOperation and term.operator_type == ast.UnaryOperator.Minus:
        return _inverted(term.argument)
    if term.ast_type == _TYPE.BinaryOperation:
        sides = ((term.left, term.right), (term.right, term.left))
        known = _is_factor if term.operator_type == _TIMES else _is_constant
        if term.operator_type in (_TIMES, *_INVERTIBLE):
            return {name for side, other in sides if known(other) for name in _inverted(side)}
    return set()


def _is_constant(term: ast.AST) -> bool:
    """Return whether a term is made of constants by arithmetic."""
    if term.ast_type == _TYPE.BinaryOperation:
        return _is_constant(term.left) and _is_constant(term.right)
    if term.ast_type == _TYPE.UnaryOperation:
        return _is_constant(term.argument)
    return bool(term.ast_type == _TYPE.SymbolicTerm)


def _is_factor(term: ast.AST) -> bool:
    """Whether a term is a number other than 0, by which a product can be divided."""
    return bool(term.ast_type == _TYPE.SymbolicTerm and term.symbol != clingo.Number(0))


def _turn(names: Set[str], turn: tuple[ast.AST, set[str]]) -> tuple[bool, bool]:
    """Return a sort key: literals that bind nothing first, then those with bound variables."""
    literal, new = turn
    return bool(new - names), not variables_of((literal,)) & names


def _provides(literal: ast.AST, bound: Set[str], shared: Set[str]) -> set[str] | None:
    """Return the variables that a literal binds, or None if it cannot be tested yet."""
    if literal.ast_type == _TYPE.Literal and literal.sign == ast.Sign.NoSign:
        atom = literal.atom
        if atom.ast_type == _TYPE.SymbolicAtom:
            new = provided(sign_and_function(atom.symbol)[1])
            return new if variables_of((atom,)) <= bound | new else None
        if atom.ast_type == _TYPE.Comparison:
            return _equated(atom, bound)
        if atom.ast_type in AGGREGATES:
            new = set()
            for guard in (atom.left_guard, atom.right_guard):
                if guard is not None and guard.comparison == ast.ComparisonOperator.Equal:
                    new |= provided(guard.term)
            inside = variables_of(tuple(atom.elements)) & shared
            return new if inside <= bound and variables_of(guards(atom)) <= bound | new else None
    return set() if needs(literal, shared) <= bound else None


def _equated(atom: ast.AST, bound: Set[str]) -> set[str] | None:
    if variables_of((atom,)) <= bound:
        return set()
    if len(atom.guards) != 1 or atom.guards[0].comparison != ast.ComparisonOperator.Equal:
        return None
    left, right = atom.term, atom.guards[0].term
    for pattern, value in ((left, right), (right, left)):
        new = provided(pattern)
        if variables_of((value,)) <= bound and variables_of((pattern,)) <= bound | new:
            return new
    return None
