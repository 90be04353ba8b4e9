"""Arithmetic in rules of which nothing shows that it fits into the 32 bits of clingo's integers."""

import math
from collections.abc import Iterable, Iterator, Mapping, Set

from mars_asp.asp.lint.clauses import Clause, clauses_of, name_of, number_of, placed
from mars_asp.asp.lint.found import LintFinding, found
from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.statements import (
    Number,
    Operand,
    Operation,
    Statement,
    rule_operands,
    statements_of,
)
from mars_asp.asp.signature import Signature

ARITHMETIC = "rule-arithmetic"
#: The greatest number of clingo.
_MOST = 2**31 - 1
#: Comparisons of a variable, on the left, by which it is no greater than a number plus so much.
_BOUNDING = {"<": -1, "<=": 0, "=": 0}
_TURNED = {">": "<", ">=": "<=", "=": "="}


def risks(
    rules: Iterable[Rule], unbounded: Mapping[Signature, Iterable[int]]
) -> Iterator[LintFinding]:
    """Yield the operations that may not fit: products, and sums of numbers that a user states.

    `unbounded` are the positions from 0 of such numbers in the predicates that hold them, given.
    A rule that says why what it computes `fits` is taken at its word. So is one whose comparisons
    bound all that it computes with.
    """
    rules = tuple(rules)
    read = statements_of(rule.text for rule in rules)
    declared = _unbounded_positions(
        [statement for variants in read.values() for statement in variants], unbounded
    )
    for rule in rules:
        # What metadata stands for repeats a body of which all is said.
        if rule.fits is not None or rule.listed is not None:
            continue
        large = frozenset[str]().union(*(_large(each, declared) for each in read[rule.text]))
        risky = tuple(_risky(rule_operands(rule.text), large))
        bounds = _upper_bounds(rule) if risky else {}
        for operation in risky:
            if _most(operation, bounds) <= _MOST:
                continue
            names = sorted((large & _variables(operation)) - bounds.keys())
            message = f"`{operation.text}` may not fit into 32 bits"
            if names:
                message += f", as `{names[0]}` has no upper bound"
            advice = "compare numbers, or signs, not products; or state in `%! fits:` why it fits"
            yield found(ARITHMETIC, message, placed(rule, operation.place), rule, advice)


def _risky(read: Iterable[Operand], large: Set[str]) -> Iterator[Operation]:
    """Yield the outermost operations that may not fit, where some variables are `large`."""
    for operand in read:
        if isinstance(operand, Operation):
            if _is_risky(operand, large):
                yield operand
            else:
                yield from _risky(operand.operands, large)


def _is_risky(operation: Operation, large: Set[str]) -> bool:
    sign, inside = operation.sign, operation.operands
    if sign in ("*", "**") and sum(bool(_variables(each)) for each in inside) == 2:
        return True
    if len(inside) < 2 or large.isdisjoint(_variables(operation)):
        return False
    # What users state is never negative, so the difference of two of them fits.
    computed = any(isinstance(each, Operation) for each in inside)
    return sign in ("+", "*", "**") or (sign == "-" and computed)


def _upper_bounds(rule: Rule) -> Mapping[str, int]:
    """Return the numbers that variables of a rule are compared with, and do not exceed."""
    ways = [dict(_bounded(clause)) for clause in clauses_of([rule])[0]]
    shared = set(ways[0]).intersection(*ways) if ways else set()
    return {name: max(way[name] for way in ways) for name in shared}


def _bounded(clause: Clause) -> Iterator[tuple[str, int]]:
    for left, sign, right, _ in clause.body.comparisons:
        for one, order, other in ((left, sign, right), (right, _TURNED.get(sign, ""), left)):
            name, number = name_of(one), number_of(other)
            if name is not None and number is not None and order in _BOUNDING:
                yield name, number + _BOUNDING[order]


def _most(operand: Operand, bounds: Mapping[str, int]) -> float:
    """Return the upper bound of an operand if its variables are not negative."""
    if isinstance(operand, Number):
        return operand.value
    if not isinstance(operand, Operation):
        return bounds.get(operand, math.inf)
    first, *others = (_most(each, bounds) for each in operand.operands)
    if operand.sign == "+" and others:
        return first + others[0]
    if operand.sign == "*":
        return first * others[0]
    return first if operand.sign in ("/", "-") and others else math.inf


def _variables(operand: Operand) -> frozenset[str]:
    if isinstance(operand, Operation):
        return frozenset().union(*map(_variables, operand.operands))
    is_variable = isinstance(operand, str) and operand.lstrip("_")[:1].isupper()
    return frozenset({operand}) if isinstance(operand, str) and is_variable else frozenset()


def _unbounded_positions(
    rules: Iterable[Statement], unbounded: Mapping[Signature, Iterable[int]]
) -> Mapping[Signature, Set[int]]:
    """Return the positions of numbers that users state, handed on from rule to rule."""
    found = {signature: set(places) for signature, places in unbounded.items()}
    reading: dict[Signature, list[Statement]] = {}
    for statement in rules:
        for signature in statement.reads:
            reading.setdefault(signature, []).append(statement)
    waiting = list(found)
    while waiting:
        for statement in reading.get(waiting.pop(), ()):
            large = _large(statement, found)
            for head in statement.heads if large else ():
                literal = head.literal
                places = {at for at, term in enumerate(literal.terms) if term.variables & large}
                known = found.setdefault(literal.signature, set())
                if not places <= known:
                    known |= places
                    waiting.append(literal.signature)
    return found


def _large(statement: Statement, stated: Mapping[Signature, Set[int]]) -> frozenset[str]:
    """Return the variables of a statement that hold numbers that users state."""
    found = {
        name
        for literal in statement.read
        if literal.binds
        for at in stated.get(literal.signature, ())
        for name in literal.terms[at].variables
    }
    for variable, firsts in statement.assigned:
        if not firsts.isdisjoint(found):
            found.add(variable)
    return frozenset(found)
