"""Predicates that nothing reads, and such as can never hold."""

from collections.abc import Iterator, Mapping, Sequence, Set

from mars_asp.asp.lint.clauses import Clause
from mars_asp.asp.lint.found import Found, found
from mars_asp.asp.signature import Signature
from mars_asp.diagnostic import Span

UNUSED, UNDEFINED = "rule-unused", "rule-undefined"


def unused(clauses: Sequence[Clause], judged: Set[int], public: Set[Signature]) -> Iterator[Found]:
    """Yield the predicates that some rules derive and nothing reads, each once.

    `judged` are the numbers of the clauses that are looked at; all read. `public` are predicates
    that others read.
    """
    read: set[Signature] = set(public)
    for clause in clauses:
        own = {head.signature.unsigned for head, _ in clause.heads}
        read |= {atom.signature.unsigned for atom in clause.read} - (
            own if len(own) == 1 else set()
        )
    told: set[Signature] = set()
    for number in sorted(judged):
        for head, _ in clauses[number].heads:
            signature = head.signature.unsigned
            if signature not in read and signature not in told:
                told.add(signature)
                message = f"nothing reads `{signature}`"
                advice = f"leave it out, or show it: `#show {signature}.`"
                place = clauses[number].place(head.node)
                yield found(UNUSED, message, place, clauses[number].rule, advice)


def undefined(
    clauses: Sequence[Clause],
    declared: Mapping[Signature, Span],
    documented: Set[Signature],
) -> Iterator[Found]:
    """Yield what is declared by `#defined` though nothing reads it, or constraints alone do.

    `declared` says where that is, `documented` are predicates that somebody gives.
    """
    derived = {head.signature.unsigned for clause in clauses for head, _ in clause.heads}
    read: dict[Signature, set[str]] = {}
    for clause in clauses:
        for atom in clause.read:
            read.setdefault(atom.signature.unsigned, set()).add(clause.sort)
    for signature, place in declared.items():
        if signature in derived or signature in documented:
            continue
        if signature not in read:
            message = f"nothing reads `{signature}`"
            yield found(UNUSED, message, place, None, "leave out its `#defined`")
        elif read[signature] == {"constraint"}:
            message = f"constraints alone read `{signature}`, and nothing gives or derives it"
            advice = "derive it, or document where its facts come from: `%*! name(X) ... *%`"
            yield found(UNDEFINED, message, place, None, advice)
