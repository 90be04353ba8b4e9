"""Recursion that grows without end, and recursion through negation."""

from collections.abc import Iterator, Mapping

from mars_asp.asp.lint.clauses import (
    Clause,
    ClauseAtom,
    is_constant,
    name_of,
    number_of,
    operation_of,
)
from mars_asp.asp.lint.found import LintFinding
from mars_asp.asp.lint.orders import parted
from mars_asp.asp.rules.trees import Kind, SyntaxNode, names_in, names_of
from mars_asp.asp.signature import Signature

RECURSION, NEGATION = "rule-recursion", "rule-negation"


def wrong_recursion(clause: Clause, circle: Mapping[Signature, int]) -> Iterator[LintFinding]:
    """Yield heads whose terms grow with each recursion, and recursion through negation.

    `circle` maps recursive predicates to their component.
    """
    for head, condition in clause.heads:
        number = circle.get(head.signature)
        if number is None:
            continue
        atoms = (*clause.body.atoms, *condition.atoms)
        if clause.sort in ("rule", "other"):
            for atom in atoms:
                if atom.sign == 1 and circle.get(atom.signature) == number:
                    yield _negated(clause, head, atom)
        again = [a for a in atoms if a.sign == 0 and circle.get(a.signature) == number]
        if again:
            yield from _growing(clause, head, again, atoms)


def _negated(clause: Clause, head: ClauseAtom, atom: ClauseAtom) -> LintFinding:
    one, other = head.signature, atom.signature
    itself = "its own negation" if one == other else f"the negation of `{other}`, which rests on it"
    message = f"`{one}` rests on {itself}"
    advice = "what follows is then open, or nothing: break the circle"
    return clause.finding(NEGATION, message, atom.node, advice)


def _growing(
    clause: Clause, head: ClauseAtom, again: list[ClauseAtom], atoms: tuple[ClauseAtom, ...]
) -> Iterator[LintFinding]:
    others = [a for a in atoms if a.sign == 0 and a not in again]
    bounded = names_of(each.node for each in others)
    carried = names_of(each.node for each in again)
    ends = (_is_led(clause, head, again, bounded), _shrinks(clause, head, carried))
    if any(ends) or _is_counted(clause, head, again):
        return
    values = _assigned(clause, carried)
    for term in head.terms:
        name = name_of(term)
        meant = term if name is None else values.get(name, term)
        direction = _direction(meant, carried)
        if direction is None or (name is not None and name in bounded):
            continue
        grown = names_in(meant) & carried
        limited = bounded | _limited(clause, direction) | _met(again)
        if grown <= limited or (name is not None and name in limited):
            continue
        if any(str(meant) == str(t) for a in others for t in a.terms):
            continue
        # A term that is also taken apart is only rebuilt.
        if any(name_of(t) is None and names_in(t) & grown for a in again for t in a.terms):
            continue
        message = f"`{meant!s}` grows with each turn of `{head.signature}`"
        variable = min(grown - limited)
        advice = f"bound `{variable}`: compare it, or read it from a predicate outside the circle"
        yield clause.finding(RECURSION, message, term, advice)


def _assigned(clause: Clause, carried: frozenset[str]) -> Mapping[str, SyntaxNode]:
    """Return the terms of equations `Y = X + 1` by variable, except variables in `carried`."""
    return {
        name: term
        for each in clause.body.comparisons
        for variable, term in each.equal
        if (name := name_of(variable)) is not None and name not in carried and not is_constant(term)
    }


def _is_led(
    clause: Clause, head: ClauseAtom, again: list[ClauseAtom], bounded: frozenset[str]
) -> bool:
    """Whether an argument moves in one direction through finitely many values (`bounded`)."""
    ordered = {
        frozenset((str(each.left), str(each.right)))
        for each in clause.body.comparisons
        if each.sign in ("<", ">")
    }
    for atom in again:
        if atom.signature != head.signature:
            continue
        for new, old in zip(head.terms, atom.terms, strict=True):
            (one, plus), (other, more) = parted(new), parted(old)
            if one == other and plus != more and names_in(new) & bounded:
                return True
            known = (names_in(new) | names_in(old)) & bounded
            if known and frozenset((str(new), str(old))) in ordered:
                return True
    return False


def _is_counted(clause: Clause, head: ClauseAtom, again: list[ClauseAtom]) -> bool:
    """Whether an argument grows or falls by a number in each recursion up to a compared bound."""
    if any(atom.signature != head.signature for atom in again):
        return False
    pairs = zip(head.terms, *(atom.terms for atom in again), strict=True)
    for new, *old in pairs:
        base, plus = parted(new)
        before = [parted(each) for each in old]
        steps = {plus - more for _, more in before}
        if all(other == base for other, _ in before) and (min(steps) > 0 or max(steps) < 0):
            if base in _limited(clause, "+" if min(steps) > 0 else "-"):
                return True
    return False


def _shrinks(clause: Clause, head: ClauseAtom, carried: frozenset[str]) -> bool:
    """Whether an argument is reduced in each recursion (`X/2`, `X-1`) and compared with a bound."""
    compared = names_of(each.node for each in clause.body.comparisons)
    return any(
        operation_of(term) in ("/", "-")
        and number_of(term.right) is not None
        and names_in(term) & carried & compared
        for term in head.terms
    )


def _limited(clause: Clause, direction: str) -> frozenset[str]:
    """Return the variables bounded above (`+`), below (`-`), or either (other directions)."""
    found: frozenset[str] = frozenset()
    for each in clause.body.comparisons:
        ends = {"<": each.left, "<=": each.left, ">": each.right, ">=": each.right}
        small = ends.get(each.sign)
        if each.sign == "!=" or Kind.Interval in (each.left.ast_type, each.right.ast_type):
            found |= names_in(each.left) | names_in(each.right)
        elif small is not None:
            large = each.right if small is each.left else each.left
            found |= names_in(small) if direction != "-" else frozenset()
            found |= names_in(large) if direction != "+" else frozenset()
    for aggregate in clause.aggregates:
        for _, guard in aggregate.guards:
            found |= names_in(guard)
    return found


def _met(again: list[ClauseAtom]) -> frozenset[str]:
    """Return the variables that occur in two different predicates of the recursion."""
    first: dict[str, Signature] = {}
    found = set()
    for atom in again:
        for name in names_in(atom.node):
            if first.setdefault(name, atom.signature) != atom.signature:
                found.add(name)
    return frozenset(found)


def _direction(term: SyntaxNode, carried: frozenset[str]) -> str | None:
    """Return `+` for a sum, product or power of `carried` names, `-`, `()` for nesting, or None."""
    kind = term.ast_type
    if not names_in(term) & carried:
        return None
    if kind is Kind.Function and (term.arguments or not term.name):
        return "()"
    sign = operation_of(term)
    if sign in ("+", "*", "**"):
        return "+"
    return "-" if sign == "-" else None
