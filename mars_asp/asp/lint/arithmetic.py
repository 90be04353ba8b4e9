"""Arithmetic in rules that may not fit into the 32 bits of clingo's integers."""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence, Set

from mars_asp.asp.lint.clauses import Clause, name_of, number_of
from mars_asp.asp.lint.found import LintFinding, found
from mars_asp.asp.rules.checks import placed
from mars_asp.asp.rules.statements import Number, Operand, Operation, rule_operands
from mars_asp.asp.rules.trees import Kind, SyntaxNode, below, names_in
from mars_asp.asp.signature import Signature

ARITHMETIC = "rule-arithmetic"
#: The greatest number of clingo.
_MOST = 2**31 - 1
#: Comparisons of a variable, on the left, with a number; their upper bound is the number plus this.
_BOUNDING = {"<": -1, "<=": 0, "=": 0}


def risks(
    read: Iterable[Sequence[Clause]], unbounded: Mapping[Signature, Iterable[int]]
) -> Iterator[LintFinding]:
    """Yield the operations that may exceed 32 bits: products, and sums of numbers that users state.

    `read` are the clauses of each rule. `unbounded` has the positions (from 0) of numbers that
    users state, by predicate. A rule is skipped if its metadata has `fits`, or if comparisons bound
    all operands.
    """
    read = tuple(read)
    declared = _unbounded_positions([clause for variants in read for clause in variants], unbounded)
    for variants in read:
        rule = variants[0].rule
        # Rules made from metadata repeat a body that is judged at its own rule.
        if rule.fits is not None or rule.listed is not None:
            continue
        large = frozenset[str]().union(*(_large(each, declared) for each in variants))
        risky = tuple(_risky(rule_operands(rule.text), large))
        bounds = _upper_bounds(variants) if risky else {}
        for operation in risky:
            if _most(operation, bounds) <= _MOST:
                continue
            names = sorted((large & _variables(operation)) - bounds.keys())
            message = f"`{operation.text}` may not fit into 32 bits"
            if names:
                message += f", as `{names[0]}` has no upper bound"
            advice = "compare numbers, or signs, not products; or state in `%! fits:` why it fits"
            yield found(ARITHMETIC, message, placed(rule.span, operation.place), rule, advice)


def _risky(read: Iterable[Operand], large: Set[str]) -> Iterator[Operation]:
    """Yield the outermost operations that may exceed 32 bits if `large` has unbounded variables."""
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
    # A number of a user is never negative, so the difference of two such numbers fits.
    computed = any(isinstance(each, Operation) for each in inside)
    return sign in ("+", "*", "**") or (sign == "-" and computed)


def _upper_bounds(variants: Iterable[Clause]) -> Mapping[str, int]:
    """Return the upper bounds of variables that comparisons of all variants state."""
    found = list[dict[str, int]]()
    for clause in variants:
        found.append({})
        for comparison in clause.body.comparisons:
            for one, order, other in comparison.sides:
                name, number = name_of(one), number_of(other)
                if name is not None and number is not None and order in _BOUNDING:
                    found[-1][name] = number + _BOUNDING[order]
    shared = set(found[0]).intersection(*found) if found else set()
    return {name: max(bounds[name] for bounds in found) for name in shared}


def _most(operand: Operand, bounds: Mapping[str, int]) -> float:
    """Return the largest value of an operand, infinity if unbounded; variables are at least 0."""
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
    clauses: Iterable[Clause], unbounded: Mapping[Signature, Iterable[int]]
) -> Mapping[Signature, Set[int]]:
    """Return the positions of numbers that users state, propagated from rule to rule."""
    found = {signature: set(places) for signature, places in unbounded.items()}
    reading: dict[Signature, list[Clause]] = {}
    for clause in clauses:
        for signature in {atom.signature for atom in clause.read}:
            reading.setdefault(signature, []).append(clause)
    waiting = list(found)
    while waiting:
        for clause in reading.get(waiting.pop(), ()):
            large = _large(clause, found)
            for head, _ in clause.heads if large else ():
                places = {at for at, term in enumerate(head.terms) if large & _matched(term)}
                known = found.setdefault(head.signature, set())
                if not places <= known:
                    known |= places
                    waiting.append(head.signature)
    return found


def _large(clause: Clause, positions: Mapping[Signature, Set[int]]) -> frozenset[str]:
    """Return the variables of a clause that hold numbers that users state."""
    found = {
        name
        for scope in (clause.body, *clause.inner)
        for atom in scope.positive
        for at in positions.get(atom.signature, ())
        for name in _matched(atom.terms[at])
    }
    for aggregate in clause.aggregates:
        sign, guard = aggregate.guards[0] if aggregate.guards else ("", None)
        if sign == "=" and not aggregate.sign and aggregate.function not in ("count", "set"):
            firsts = {name_of(element.terms[0]) for element in aggregate.elements if element.terms}
            name = name_of(guard) if guard is not None else None
            if name is not None and not firsts.isdisjoint(found):
                found.add(name)
    return frozenset(found)


def _matched(term: SyntaxNode) -> frozenset[str]:
    """Return the variables that matching a term binds: none if the term computes something."""
    kinds = (Kind.Variable, Kind.SymbolicTerm, Kind.Function)
    computes = any(
        each.ast_type not in kinds or getattr(each, "external", False) for each in below(term)
    )
    return frozenset() if computes else names_in(term)
