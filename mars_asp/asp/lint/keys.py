"""Premises that are one fact by the key of their predicate, although they are to differ."""

from collections.abc import Iterator, Mapping, Sequence, Set
from itertools import combinations

from mars_asp.asp.lint.bodies import CONTRADICTION
from mars_asp.asp.lint.clauses import (
    Clause,
    ClauseAtom,
    ClauseScope,
    Comparison,
    is_constant,
    joined,
)
from mars_asp.asp.lint.found import LintFinding
from mars_asp.asp.lint.orders import Compared, compared, constants_in, fewest, never, parted
from mars_asp.asp.rules.declarations import Declaration
from mars_asp.asp.rules.trees import extent_of
from mars_asp.asp.signature import Signature


def apart_by_keys(
    clause: Clause, declared: Mapping[Signature, Declaration], replaced: Set[str]
) -> Iterator[LintFinding]:
    """Yield bodies that need two facts, although the predicate's key allows only one."""
    first = _contradicted_key(clause, ClauseScope(), clause.body, declared, replaced)
    if first is not None:
        yield first
        return
    for inner in clause.inner:
        found_ = _contradicted_key(clause, clause.body, inner, declared, replaced)
        if found_ is not None:
            yield found_


def _contradicted_key(
    clause: Clause,
    outer: ClauseScope,
    inner: ClauseScope,
    declared: Mapping[Signature, Declaration],
    replaced: Set[str],
) -> LintFinding | None:
    scope = joined(outer, inner)
    for one, other in combinations(scope.positive, 2):
        declaration = declared.get(one.signature)
        if declaration is None or one.signature != other.signature:
            continue
        if one in outer.atoms and other in outer.atoms and not inner.comparisons:
            continue
        for key in declaration.keys:
            values = [(str(one.terms[at]), str(other.terms[at])) for at in key]
            if any(left != right or left == "_" for left, right in values):
                continue
            why = _unlike(one, other, scope.comparisons, replaced)
            if why:
                names = " and ".join(f"`{declaration.arguments[at].name}`" for at in key)
                facts = f"`{one.text}` and `{other.text}` are one fact"
                message = f"{facts}, as there is one for each {names}" if key else facts
                advice = "so this never holds: leave out one of the two"
                advice += f", or let them differ in {names}" if key else ""
                if why == "-":
                    message = message.replace("are one fact", "are never true together")
                else:
                    message += f", so {why} never holds"
                later = max(one.node, other.node, key=extent_of)
                return clause.finding(CONTRADICTION, message, later, advice)
    return None


def _unlike(
    one: ClauseAtom, other: ClauseAtom, comparisons: Sequence[Comparison], replaced: Set[str]
) -> str:
    """Return the comparisons by which two atoms differ: `-` if their terms do, "" if none."""
    pairs = [
        (left, right)
        for left, right in zip(one.terms, other.terms, strict=True)
        if str(left) != str(right) and "_" not in (str(left), str(right))
    ]
    for left, right in pairs:
        is_replaced = not replaced.isdisjoint((str(left), str(right)))
        if is_constant(left) and is_constant(right) and not is_replaced:
            return "-"
    bases = ((parted(left), parted(right)) for left, right in pairs)
    equal = [Compared(a, "=", b, plus - more) for (a, plus), (b, more) in bases]
    constants = constants_in(comparisons, replaced)
    if not equal or never(map(compared, comparisons), constants):
        return ""
    if not never([*map(compared, comparisons), *equal], constants):
        return ""
    return " and ".join(f"`{each.text}`" for each in fewest(comparisons, equal, constants))
