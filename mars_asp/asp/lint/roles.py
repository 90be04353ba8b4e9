"""Findings without a message, demands, things without a place, words taken for numbers."""

from collections.abc import Iterable, Iterator, Mapping, Sequence, Set

from mars_asp.asp.lint.clauses import Clause, name_of
from mars_asp.asp.lint.found import LintFinding, found
from mars_asp.asp.lint.values import KnownValue
from mars_asp.asp.rules.declarations import Declaration
from mars_asp.asp.rules.trees import Kind, SyntaxNode
from mars_asp.asp.signature import Signature

NONE, SILENT, DEMAND = "rule-none", "rule-silent", "rule-demand"
DESCRIBED, UNPLACED = "rule-described", "rule-unplaced"
#: Words for a missing value.
_WORDS = frozenset({"none"})


def words_as_numbers(clause: Clause, known: KnownValue) -> Iterator[LintFinding]:
    """Yield comparisons of a number with a variable whose value may be `none`."""
    outer = known.environment(clause, clause.body)
    for scope in clause.scopes:
        comparisons = (*clause.body.comparisons, *scope.comparisons)
        denied = {
            (name_of(one), str(other))
            for each in comparisons
            if each.sign == "!="
            for one, _, other in each.sides
        }
        environment = {**outer, **known.environment(clause, scope)}
        for each in scope.comparisons:
            # A number is never more than a word, so only the larger side matters.
            sides = {">": (each.left, each.right), "<": (each.right, each.left)}
            one, other = sides.get(each.sign[0], (None, None))
            name = name_of(one) if one is not None else None
            values = (environment.get(name) if name is not None else None) or ()
            is_measured = any(each.form == "number" for each in values)
            words = {each.text for each in values if is_measured and each.text in _WORDS}
            words = {word for word in words if (name, word) not in denied}
            limits = known.of(other, environment) if other is not None and words else None
            if limits and all(each.form == "number" for each in limits):
                word = min(words)
                message = f"`{name}` may be `{word}`, which is more than any number"
                advice = f"add `{name} != {word}`"
                yield clause.finding(NONE, message, each.node, advice)


def silent(clause: Clause, reported: Set[Signature]) -> Iterator[LintFinding]:
    """Yield the rules that derive findings (`reported`) without a message."""
    head = clause.heads[0][0] if clause.heads else None
    if clause.sort == "rule" and head is not None and clause.rule.because is None:
        if head.signature.unsigned in reported:
            message = f"`{head.text}` has no message"
            advice = "write it above the rule: `%! because: ...`, with an `%! id: ...`"
            yield clause.finding(SILENT, message, head.node, advice)


def demands(
    clause: Clause, allowed: Set[str], decided: Mapping[str, Set[Signature]]
) -> Iterator[LintFinding]:
    """Yield the constraints in stages that only derive, where they would exclude every answer.

    `allowed` are the stages for constraints; if empty, all. `decided` maps stages that choose to
    the predicates that they derive, over which constraints are allowed.
    """
    stage = clause.rule.stage
    if clause.sort != "constraint" or stage in allowed or not allowed:
        return
    if any(atom.signature.unsigned in decided.get(stage, ()) for atom in clause.read):
        return
    message = "where this constraint is not met, there is no answer at all"
    advice = "derive a finding or a violation instead, which names what is wrong"
    yield clause.finding(DEMAND, message, clause.node, advice)


def described_anew(
    own: Iterable[Declaration], given: Mapping[Signature, Declaration]
) -> Iterator[LintFinding]:
    """Yield the descriptions of predicates that have one already."""
    for each in own:
        earlier = given.get(each.signature.unsigned)
        if earlier is not None and (earlier.public or earlier.origin is not None):
            message = f"`{each.signature}` is described already"
            labels = ((earlier.span, "the description that counts"),)
            advice = f"leave this out: `rules show {each.signature}` prints the other"
            yield found(DESCRIBED, message, each.span, None, advice, labels=labels)


def unplaced(
    clauses: Sequence[Clause], judged: Set[int], placing: Mapping[Signature, Set[Signature]]
) -> Iterator[LintFinding]:
    """Yield the introduced things to which no rule gives a place.

    `placing` maps the predicate that introduces a thing to predicates that place it. The thing is
    the first argument of each.
    """
    placed = {
        (head.signature.unsigned, _node_form(head.terms[0]))
        for clause in clauses
        for head, _ in clause.heads
        if head.terms
    }
    for number in sorted(judged):
        clause = clauses[number]
        for head, _ in clause.heads:
            by = placing.get(head.signature.unsigned)
            form = _node_form(head.terms[0]) if by else None
            if by and form and not any((each, at) in placed for each in by for at in (form, None)):
                message = f"no rule places `{head.terms[0]!s}`"
                advice = f"derive {' or '.join(f'`{each}`' for each in sorted(by))} for it"
                yield clause.finding(UNPLACED, message, head.node, advice)


def _node_form(term: SyntaxNode) -> tuple[str, int] | None:
    """Return name and arity of a function or constant, or None for other terms."""
    if term.ast_type is Kind.Function:
        return term.name, len(term.arguments)
    return (str(term), 0) if term.ast_type is Kind.SymbolicTerm else None
