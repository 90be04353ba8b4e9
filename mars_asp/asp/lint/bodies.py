"""Bodies that never hold, and literals that change nothing."""

from collections import Counter
from collections.abc import Iterator, Sequence, Set

from mars_asp.asp.lint.clauses import (
    OPPOSITE,
    Aggregate,
    Clause,
    ClauseAtom,
    ClauseScope,
    kind_of,
)
from mars_asp.asp.lint.found import Fix, LintFinding
from mars_asp.asp.lint.orders import Compared, compared, constants_in, fewest, guarded, never
from mars_asp.asp.rules.trees import Kind, SyntaxNode, below, extent_of
from mars_asp.diagnostic import Span

CONTRADICTION, REDUNDANT = "rule-contradiction", "rule-redundant"
_NEVER = "so the rule never fires: leave out one of the two"
_INNER = "so nothing is in it: leave out one of the two"


def wrong_bodies(clause: Clause, replaced: Set[str]) -> Iterator[LintFinding]:
    """Yield bodies that never hold, and literals without effect; `replaced` are `#const` names."""
    bounds = [
        each for at, one in enumerate(clause.aggregates) for each in _aggregate_bounds(at, one)
    ]
    contradiction = _contradiction(clause, ClauseScope(), clause.body, bounds, replaced)
    if contradiction is not None:
        yield contradiction
    else:
        for inner in clause.inner:
            contradiction = _contradiction(clause, clause.body, inner, bounds, replaced)
            if contradiction is not None:
                yield contradiction
        yield from _needless(clause, bounds, replaced)
    yield from _repeated(clause)
    yield from _circular(clause)


def _contradiction(
    clause: Clause,
    outer: ClauseScope,
    inner: ClauseScope,
    bounds: Sequence[Compared],
    replaced: Set[str],
) -> LintFinding | None:
    advice = _NEVER if outer == ClauseScope() else _INNER
    atoms = (*outer.atoms, *inner.atoms)
    alike: dict[str, list[ClauseAtom]] = {}
    for atom in atoms:
        alike.setdefault(atom.signature.name, []).append(atom)
    for one in inner.atoms if len(alike) < len(atoms) else ():
        for other in alike[one.signature.name]:
            if _exclude(one, other):
                node = max(one.node, other.node, key=extent_of)
                message = f"`{one.node}` and `{other.node}` are never true together"
                return clause.finding(CONTRADICTION, message, node, advice)
    for each in inner.others:
        if str(each) == "#false":
            message = "`#false` never holds"
            return clause.finding(CONTRADICTION, message, each, advice)
    comparisons = (*outer.comparisons, *inner.comparisons)
    constants = constants_in(comparisons, replaced)
    given = [*map(compared, comparisons), *bounds]
    if not given or not never(given, constants):
        return None
    if outer.comparisons and never([*map(compared, outer.comparisons), *bounds], constants):
        return None
    least = fewest(comparisons, bounds, constants)
    places = [each.node for each in least] or [each.node for each in clause.aggregates]
    text = " and ".join(f"`{each.text}`" for each in least)
    if len(least) > 1:
        message = f"{text} are never true together"
    else:
        message = f"{text or 'what this aggregate is compared with'} never holds"
        advice = advice.replace("leave out one of the two", "leave it out")
    if least and bounds and not never(list(map(compared, least)), constants):
        message += " with the bounds of an aggregate"
    return clause.finding(CONTRADICTION, message, places[-1], advice)


def _exclude(one: ClauseAtom, other: ClauseAtom) -> bool:
    """Whether two atoms of a body exclude each other: `p` with `not p`, or with `-p`."""
    if one.signature[:2] != other.signature[:2] or one is other:
        return False
    if one.signature.positive != other.signature.positive:
        return one.sign == other.sign == 0 and one.text[1:] == other.text and "_" not in one.text
    if {one.sign, other.sign} not in ({0, 1}, {1, 2}):
        return False
    denied, declared = (one, other) if one.sign == 1 else (other, one)
    return all(
        str(no) == "_" or (str(no) == str(yes) and "_" not in _bare(no))
        for no, yes in zip(denied.terms, declared.terms, strict=True)
    )


def _bare(term: SyntaxNode) -> set[str]:
    """Return the names of the variables in a term, `_` among them."""
    return {each.name for each in below(term) if each.ast_type is Kind.Variable}


def _aggregate_bounds(number: int, aggregate: Aggregate) -> Iterator[Compared]:
    """Yield the bounds of an aggregate, which is called `#number`, as comparisons."""
    if aggregate.sign:
        return
    name = f"#{number}"
    yield from (guarded(name, sign, term) for sign, term in aggregate.guards)
    if aggregate.function in ("count", "set", "sum+"):
        yield Compared("", "<=", name, 0)


def _needless(
    clause: Clause, bounds: Sequence[Compared], replaced: Set[str]
) -> Iterator[LintFinding]:
    """Yield the comparisons and aggregate bounds that hold in any case."""
    own = clause.body.comparisons
    constants = constants_in(own, replaced)
    kept = list(own)
    for each in own:
        rest = [other for other in kept if other is not each]
        denied = _denied(compared(each))
        # A comparison may bind a variable.
        binds = each.sign == "=" and str(each.left) != str(each.right)
        if not binds and never([*map(compared, rest), denied], constants):
            kept = rest
            why = (
                "whatever its terms are"
                if never([denied], constants)
                else ("wherever the other comparisons do")
            )
            message = f"`{each.text}` holds {why}"
            fixes = _without(clause, each.node)
            yield clause.finding(REDUNDANT, message, each.node, "leave it out", fixes)
    for at, aggregate in enumerate(clause.aggregates):
        entries = list(_aggregate_bounds(at, aggregate))
        count = len(aggregate.guards)
        binds = any(sign == "=" for sign, _ in aggregate.guards)
        if aggregate.sign == 0 and count and len(entries) > count and not binds:
            known = entries[count:]
            if all(never([*known, _denied(guard)]) for guard in entries[:count]):
                message = "this aggregate always has such a value"
                advice = "leave it out, or correct its bound"
                yield clause.finding(REDUNDANT, message, aggregate.node, advice)


def _denied(each: Compared) -> Compared:
    return each._replace(sign=OPPOSITE[each.sign])


def _repeated(clause: Clause) -> Iterator[LintFinding]:
    """Yield the repeated literals of a body, an element or a condition."""
    for literals in (
        clause.node.body,
        *(element.node.condition for each in clause.aggregates for element in each.elements),
    ):
        seen: dict[str, SyntaxNode] = {}
        kinds = Counter(map(kind_of, literals))
        for literal in literals if len(kinds) < len(literals) else ():
            if literal.ast_type is Kind.Literal and literal.atom.ast_type is Kind.Comparison:
                continue
            if kinds[kind_of(literal)] == 1:
                continue
            first = seen.setdefault(str(literal), literal)
            if first is not literal:
                message = f"`{literal}` is repeated"
                fixes = _without(clause, literal)
                yield clause.finding(REDUNDANT, message, literal, "leave it out", fixes)


def _without(clause: Clause, literal: SyntaxNode) -> tuple[Fix, ...]:
    """Return the fix that removes a literal and the separator before it; empty if there is none."""
    body = list(clause.node.body)
    if literal not in body or body.index(literal) == 0:
        return ()
    before, own = clause.span(body[body.index(literal) - 1]), clause.span(literal)
    if before is None or own is None:
        return ()
    span = Span(own.path, before.end_line, before.end_column, own.end_line, own.end_column)
    return (Fix(span, ""),)


def _circular(clause: Clause) -> Iterator[LintFinding]:
    """Yield a finding if the head of a rule is one of its own premises."""
    if clause.sort != "rule":
        return
    head = clause.heads[0][0]
    for atom in clause.body.positive:
        if (
            atom.signature == head.signature
            and atom.text == head.text
            and "_" not in _bare(atom.node)
        ):
            message = f"`{head.text}` is derived where it holds already"
            advice = "leave out the rule, or correct its head"
            yield clause.finding(REDUNDANT, message, atom.node, advice)
