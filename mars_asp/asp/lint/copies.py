"""Rules that others make superfluous: the same rule again, or one that asks for more."""

from collections.abc import Iterator, Sequence

from mars_asp.asp.lint.clauses import Clause, text_of
from mars_asp.asp.lint.found import Found, found
from mars_asp.asp.rules.trees import Kind, Node

DUPLICATE, SUBSUMED = "rule-duplicate", "rule-subsumed"
_Binding = dict[str, str]
#: So many ways to match two rules are tried.
_MOST = 2000


def superfluous(clauses: Sequence[Clause], judged: frozenset[int]) -> Iterator[Found]:
    """Yield the rules of which all follows from another one; `judged` are those looked at."""
    plain = [
        (number, clause)
        for number, clause in enumerate(clauses)
        if clause.sort in ("rule", "constraint") and clause.rule.listed is None
    ]
    alike: dict[tuple[object, ...], list[int]] = {}
    for number, clause in plain:
        alike.setdefault(_about(clause), []).append(number)
    for about, numbers in alike.items():
        wanted = [number for number in numbers if number in judged]
        # What holds of any value holds of a constant.
        others = numbers if about[-1] == "" else [*numbers, *alike.get((*about[:-1], ""), ())]
        for number in wanted:
            for other in others:
                if other != number and (found_ := _compared(clauses, number, other)):
                    yield found_
                    break


def _about(clause: Clause) -> tuple[object, ...]:
    """Return what rules with the same head have in common: predicate and constants."""
    if not clause.heads:
        return (clause.sort, None, "")
    head = clause.heads[0][0]
    first = head.terms[0] if head.terms else None
    name = text_of(first) if first is not None and first.ast_type is Kind.SymbolicTerm else ""
    return clause.sort, head.signature, name


def _compared(clauses: Sequence[Clause], number: int, other: int) -> Found | None:
    own, rival = clauses[number], clauses[other]
    if own.rule is rival.rule or own.rule.stage != rival.rule.stage:
        return None
    if not _covers(rival, own):
        return None
    same = _covers(own, rival)
    if same and number < other:
        return None
    place, labels = own.place(own.node), ((rival.place(rival.node), "this one"),)
    if same:
        message = "this rule is there already"
        advice = "leave out one of the two"
        return found(DUPLICATE, message, place, own.rule, advice, labels=labels)
    if own.rule.because is not None and own.rule.because != rival.rule.because:
        # It says why in its own words, and traces show that.
        return None
    message = "whatever this rule gives, another one gives without some of its premises"
    advice = "leave out this rule, or what makes the other one too general"
    return found(SUBSUMED, message, place, own.rule, advice, labels=labels)


def _covers(general: Clause, special: Clause) -> bool:
    """Whether one rule gives all that another does: some of its premises are among the others."""
    if not general.kinds <= special.kinds:
        return False
    given, wanted = special.node.body, general.node.body
    start = _match(general.node.head, special.node.head, {})
    tries = [_MOST]
    return start is not None and _all_match(wanted, given, start, tries)


def _all_match(
    wanted: Sequence[Node], given: Sequence[Node], binding: _Binding, tries: list[int]
) -> bool:
    if not wanted:
        return True
    first, *rest = wanted
    for each in given:
        tries[0] -= 1
        if tries[0] < 0:
            return False
        more = _match(first, each, binding)
        if more is not None and _all_match(rest, given, more, tries):
            return True
    return False


def _match(general: Node, special: Node, binding: _Binding) -> _Binding | None:
    """Return what the variables of one tree have to be for it to be another."""
    if general.ast_type is Kind.Variable:
        text = str(special)
        if general.name == "_":
            return binding
        known = binding.get(general.name)
        if known is None:
            return {**binding, general.name: text} if text != "_" else None
        return binding if known == text else None
    if general.ast_type is not special.ast_type or len(general.children) != len(special.children):
        return None
    if not general.children:
        return binding if str(general) == str(special) else None
    if _own(general) != _own(special):
        return None
    for one, other in zip(general.children, special.children, strict=True):
        more = _match(one, other, binding)
        if more is None:
            return None
        binding = more
    return binding


def _own(node: Node) -> list[object]:
    """Return what a node says by itself."""
    return [v for v in vars(node).values() if isinstance(v, str | int)]
