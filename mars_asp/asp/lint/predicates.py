"""Predicates that no rule reads, and predicates that can never hold."""

from collections.abc import Iterator, Mapping, Sequence, Set

from mars_asp.asp.fragments import firing
from mars_asp.asp.lint.clauses import Clause
from mars_asp.asp.lint.found import LintFinding, found
from mars_asp.asp.rules.declarations import Declaration
from mars_asp.asp.signature import Signature
from mars_asp.diagnostic import Span

UNUSED, UNDEFINED = "rule-unused", "rule-undefined"


def unused(
    clauses: Sequence[Clause],
    judged: Set[int],
    public: Set[Signature],
    circle: Mapping[Signature, int],
) -> Iterator[LintFinding]:
    """Yield the derived predicates that no other rule reads, each once.

    `judged` are the numbers of the clauses to report; all clauses read. `public` are predicates
    with other readers. `circle` maps recursive predicates to their component: a component does not
    count as a reader of itself.
    """
    read: set[Signature] = set(public)
    for clause in clauses:
        heads = [head.signature for head, _ in clause.heads]
        circles = {circle.get(head) for head in heads}
        own = circles.pop() if len(circles) == 1 else None
        read |= {
            atom.signature.unsigned
            for atom in clause.read
            if own is None or circle.get(atom.signature) != own
        }
    # A reader of one predicate of a component uses the whole component.
    wanted = {number for each, number in circle.items() if each.unsigned in read}
    read |= {each.unsigned for each, number in circle.items() if number in wanted}
    entries: set[Signature] = set()
    for number in sorted(judged):
        for head, _ in clauses[number].heads:
            signature = head.signature.unsigned
            if signature not in read and signature not in entries:
                entries.add(signature)
                message = f"nothing reads `{signature}`"
                advice = f"leave it out, or show it: `#show {signature}.`"
                yield clauses[number].finding(UNUSED, message, head.node, advice)


def unfounded(
    clauses: Sequence[Clause], judged: Set[int], circle: Mapping[Signature, int]
) -> Iterator[LintFinding]:
    """Yield predicates that are derived only from each other, so that they have no atoms."""
    rules: dict[Signature, list[int]] = {}
    circular: list[tuple[Set[Signature], Set[Signature]]] = []
    for number, clause in enumerate(clauses):
        for head, condition in clause.heads:
            own = circle.get(head.signature)
            needed = (*clause.body.positive, *condition.positive)
            # A rule with its head as premise has a finding of its own.
            if own is not None and head.text not in {atom.text for atom in clause.body.positive}:
                rules.setdefault(head.signature, []).append(number)
                inside = {a.signature for a in needed if circle.get(a.signature) == own}
                circular.append((inside, {head.signature}))
    founded = {each for number in firing(circular, ()) for each in circular[number][1]}
    entries: set[int] = set()
    for signature, numbers in rules.items():
        if signature not in founded and numbers[0] in judged and circle[signature] not in entries:
            entries.add(circle[signature])
            clause = clauses[numbers[0]]
            others = sorted(f"`{each}`" for each in rules if circle[each] == circle[signature])
            what = " and ".join(others) if len(others) > 1 else "itself"
            message = f"`{signature}` is derived from {what} alone, so it never holds"
            yield clause.finding(UNDEFINED, message, clause.node, "add a rule to begin with")


def documented_in_vain(
    clauses: Sequence[Clause], own: Sequence[Declaration], given: Set[Signature]
) -> Iterator[LintFinding]:
    """Yield the documented predicates that no rule derives and no input provides."""
    known = {head.signature.unsigned for clause in clauses for head, _ in clause.heads} | given
    for each in own:
        signature = each.signature.unsigned
        if signature not in known and each.origin is None:
            message = f"`{signature}` is documented, and nothing gives or derives it"
            others = sorted(f"`{other}`" for other in known if other.name == signature.name)
            advice = (
                f"did you mean {' or '.join(others)}?" if others else "leave it out, or derive it"
            )
            yield found(UNDEFINED, message, each.span, None, advice)


def unknown(clauses: Sequence[Clause], given: Set[Signature]) -> Iterator[LintFinding]:
    """Yield the predicates that rules read and that nothing gives or derives.

    The rules of packs have an error of their own for these, before any lint.
    """
    known = {head.signature.unsigned for clause in clauses for head, _ in clause.heads} | given
    for clause in clauses:
        for signature in sorted({atom.signature.unsigned for atom in clause.read} - known):
            message = f"nothing gives or derives `{signature}`"
            advice = "derive it, or document where its facts come from: `%*! name(X) ... *%`"
            yield clause.finding(UNDEFINED, message, clause.node, advice)


def undefined(
    clauses: Sequence[Clause],
    declared: Mapping[Signature, Span],
    documented: Set[Signature],
    attributes: Set[Signature],
) -> Iterator[LintFinding]:
    """Yield the predicates with `#defined` that no rule reads, or constraints alone.

    `declared` are the locations of `#defined`, `documented` the predicates that the input provides,
    `attributes` those among them that users state for these rules alone.
    """
    derived = {head.signature.unsigned for clause in clauses for head, _ in clause.heads}
    read: dict[Signature, set[str]] = {}
    for clause in clauses:
        for atom in clause.read:
            read.setdefault(atom.signature.unsigned, set()).add(clause.sort)
    for signature, place in declared.items():
        if signature in attributes and signature not in read:
            message = f"nothing reads `{signature}`, which users are to state"
            advice = "read it in a rule, or let other packs read it: `packs: read`"
            yield found(UNUSED, message, place, None, advice)
        if signature in derived or signature in documented:
            continue
        if signature not in read:
            message = f"nothing reads `{signature}`"
            yield found(UNUSED, message, place, None, "leave out its `#defined`")
        elif read[signature] == {"constraint"}:
            message = f"constraints alone read `{signature}`, and nothing gives or derives it"
            advice = "derive it, or document where its facts come from: `%*! name(X) ... *%`"
            yield found(UNDEFINED, message, place, None, advice)
