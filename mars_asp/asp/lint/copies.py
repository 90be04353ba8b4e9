"""Rules that others make superfluous: repeated rules, and rules with more premises.

Two rules are compared only if one has the rarest mark of the other: a predicate of its body, or a
constant or function of the rule. So thousands of rules with one head take no longer than as many
with different heads.
"""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from typing import TypeAlias

from mars_asp.asp.lint.clauses import Clause, kind_of
from mars_asp.asp.lint.found import LintFinding
from mars_asp.asp.rules.trees import Kind, SyntaxNode, below

DUPLICATE, SUBSUMED = "rule-duplicate", "rule-subsumed"
_Binding = dict[str, str]
#: A feature of a rule; a rule that covers it has no further features.
_Mark: TypeAlias = tuple[object, ...]
#: The key of rules with the same head.
_About: TypeAlias = tuple[object, ...]
#: The maximal number of attempts to match two rules.
_MOST = 2000


def superfluous(clauses: Sequence[Clause], judged: frozenset[int]) -> Iterator[LintFinding]:
    """Yield the rules that follow from another rule; `judged` are the clauses to report."""
    plain = [
        (number, clause)
        for number, clause in enumerate(clauses)
        if clause.sort in ("rule", "constraint") and clause.rule.listed is None
    ]
    alike: dict[_About, list[int]] = {}
    for number, clause in plain:
        alike.setdefault(_head_pattern(clause), []).append(number)
    # A rule for any value covers a rule for a constant.
    general = {about: [about] if about[-1] == "" else [about, (*about[:-1], "")] for about in alike}
    compared = {
        each
        for about, numbers in alike.items()
        if sum(len(alike.get(each, ())) for each in general[about]) > 1
        and not judged.isdisjoint(numbers)
        for each in general[about]
        if each in alike
    }
    marks = {number: _marks(clauses[number]) for each in compared for number in alike[each]}
    rare = _by_rarest({each: alike[each] for each in compared}, marks)
    for about, numbers in alike.items():
        for number in numbers if about in compared else ():
            if number not in judged:
                continue
            for each in general[about]:
                others = rare.get(each, {})
                near = (others.get(mark, ()) for mark in (*marks[number], ()))
                tried = sorted(other for some in near for other in some if other != number)
                found_ = next(filter(None, (_subsumed(clauses, number, o) for o in tried)), None)
                if found_ is not None:
                    yield found_
                    break


def _by_rarest(
    alike: Mapping[_About, Sequence[int]], marks: Mapping[int, frozenset[_Mark]]
) -> dict[_About, dict[_Mark, list[int]]]:
    """Return the numbers of rules by head, then by the mark (`_marks`) that fewest rules have."""
    counts = Counter(mark for each in marks.values() for mark in each)
    found: dict[_About, dict[_Mark, list[int]]] = {}
    for about, numbers in alike.items():
        by_mark = found.setdefault(about, {})
        for number in numbers:
            rarest = min(marks[number], key=lambda mark: (counts[mark], repr(mark)), default=())
            by_mark.setdefault(rarest, []).append(number)
    return found


def _marks(clause: Clause) -> frozenset[_Mark]:
    """Return the features of a rule to compare: its literals, their constants and functions."""
    found: set[_Mark] = set(clause.kinds)
    for literal in (clause.node.head, *clause.node.body):
        kind = kind_of(literal)
        for each in below(literal):
            if each.ast_type is Kind.SymbolicTerm:
                found.add((kind, str(each)))
            elif each.ast_type is Kind.Function:
                found.add((kind, each.name, len(each.arguments)))
    return frozenset(found)


def _head_pattern(clause: Clause) -> _About:
    """Return a key of the head: its predicate, and its first argument if constant."""
    if not clause.heads:
        return (clause.sort, None, "")
    head = clause.heads[0][0]
    first = head.terms[0] if head.terms else None
    name = str(first) if first is not None and first.ast_type is Kind.SymbolicTerm else ""
    return clause.sort, head.signature, name


def _subsumed(clauses: Sequence[Clause], number: int, other: int) -> LintFinding | None:
    own, rival = clauses[number], clauses[other]
    if own.rule is rival.rule or own.rule.stage != rival.rule.stage:
        return None
    if not _covers(rival, own):
        return None
    same = _covers(own, rival)
    if same and number < other:
        return None
    labels = ((rival.place(rival.node), "this one"),)
    if same:
        message = "this rule is there already"
        advice = "leave out one of the two"
        return own.finding(DUPLICATE, message, own.node, advice, labels=labels)
    if own.rule.because is not None and own.rule.because != rival.rule.because:
        # Its own message is shown in traces, so the rule is not superfluous.
        return None
    message = "whatever this rule gives, another one gives without some of its premises"
    advice = "leave out this rule, or what makes the other one too general"
    return own.finding(SUBSUMED, message, own.node, advice, labels=labels)


def _covers(general: Clause, special: Clause) -> bool:
    """Whether `general` derives all that `special` derives, with a subset of its premises."""
    if not general.kinds <= special.kinds:
        return False
    given, wanted = special.node.body, general.node.body
    start = _match(general.node.head, special.node.head, {})
    tries = [_MOST]
    return start is not None and _all_match(wanted, given, start, tries)


def _all_match(
    wanted: Sequence[SyntaxNode], given: Sequence[SyntaxNode], binding: _Binding, tries: list[int]
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


def _match(general: SyntaxNode, special: SyntaxNode, binding: _Binding) -> _Binding | None:
    """Return the substitution that turns `general` into `special`, extending `binding`, or None."""
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


def _own(node: SyntaxNode) -> list[object]:
    """Return the texts and numbers in a node's own attributes."""
    return [v for name, v in vars(node).items() if name[0] != "_" and isinstance(v, str | int)]
