"""Arithmetic in rules of which nothing shows that it fits into the 32 bits of clingo's integers."""

from collections.abc import Iterable, Iterator, Mapping, Set

from mars_asp.asp.lint.clauses import placed
from mars_asp.asp.lint.found import Found, found
from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.statements import (
    Operand,
    Operation,
    Statement,
    rule_operands,
    statements_of,
)
from mars_asp.asp.signature import Signature

ARITHMETIC = "rule-arithmetic"


def risks(rules: Iterable[Rule], unbounded: Mapping[Signature, Iterable[int]]) -> Iterator[Found]:
    """Yield what rules compute that may not fit: products, and sums of numbers a user states.

    `unbounded` are the positions from 0 of such numbers in the predicates that hold them, given.
    A rule that says why what it computes `fits` is taken at its word.
    """
    rules = tuple(rules)
    read = statements_of(rule.text for rule in rules)
    stated = _stated([statement for variants in read.values() for statement in variants], unbounded)
    for rule in rules:
        # What metadata stands for repeats a body of which all is said.
        if rule.fits is not None or rule.listed is not None:
            continue
        large = frozenset[str]().union(*(_large(each, stated) for each in read[rule.text]))
        for operation in _risky(rule_operands(rule.text), large):
            names = sorted(large & _variables(operation))
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


def _variables(operand: Operand) -> frozenset[str]:
    if isinstance(operand, Operation):
        return frozenset().union(*map(_variables, operand.operands))
    is_variable = isinstance(operand, str) and operand.lstrip("_")[:1].isupper()
    return frozenset({operand}) if isinstance(operand, str) and is_variable else frozenset()


def _stated(
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
    for value, elements in statement.assigned:
        if isinstance(value, str) and any(term in found for _, term in elements):
            found.add(value)
    return frozenset(found)
