"""Why an atom does not hold without a rule in `rules/absence`, and the changes that give it.

The rule that comes nearest is followed through its failed premises to a missing line, or to the
lines that prevent the atom. A change is made to these, and the question is answered again.
"""

from collections.abc import Callable, Mapping, Sequence, Set
from dataclasses import dataclass, replace

import clingo

from mars_asp.asp.rules.declarations import Declaration
from mars_asp.asp.rules.symbols import symbol_in
from mars_asp.asp.signature import Signature, signature_of
from mars_asp.asp.trace import absence
from mars_asp.asp.trace.patterns import pattern_in, strings_in
from mars_asp.asp.trace.text import leaves_of
from mars_asp.asp.trace.tree import Absent, Given, NearMiss, Trace, Underivable
from mars_asp.diagnostic import Span
from mars_asp.model.declarations import GATING
from mars_asp.model.names import written
from mars_asp.reasoning.project import Project
from mars_asp.reasoning.questions.blame import Blame
from mars_asp.reasoning.questions.changes import changed
from mars_asp.reasoning.questions.failed_value import failed_value
from mars_asp.reasoning.session import Reasoner
from mars_asp.reasoning.synthesis.synthesise import is_resolved

#: Limits of the depth of failed premises, and of the number of successive changes.
MOST_LEVELS, MOST_CHANGES = 12, 3
#: At most this many of the lines that prevent an atom are shown.
MOST_LINES = 8
#: By the predicate of a line, the change that adds one and the positions of its modules.
_LINES: Mapping[str, tuple[str, tuple[int, int]]] = {
    "uses_data_from": ("data", (1, 2)),
    "is_controlled_by": ("control", (1, 2)),
    "is_mounted_on": ("mount", (1, 3)),
    "is_suppressed_by": ("suppress", (1, 2)),
    "is_inhibited_by": ("inhibit", (1, 2)),
    "is_reset_by": ("reset", (1, 2)),
    "is_locked_by": ("lock", (1, 2)),
    "is_limited_by": ("limit", (1, 2)),
}


@dataclass(frozen=True, slots=True)
class _Lack:
    """A failed premise, the lines that show it, and a change that may satisfy it."""

    because: str
    evidence: tuple[Span, ...] = ()
    change: clingo.Symbol | None = None
    to_get: str = ""
    wider: "_Lack | None" = None


def near_miss(
    reasoner: Reasoner, pattern: clingo.Symbol, gives: Callable[[Project], bool]
) -> Blame:
    """Return the failed premise of the nearest rule, with the changes that give the atom if found.

    `gives` returns whether an atom of the pattern holds in a project.
    """
    first = lack = _lack(reasoner, pattern)
    project, steps = reasoner.project, list[str]()
    for _ in range(MOST_CHANGES):
        if lack.change is None:
            break
        wider = lack.wider
        if wider is not None and wider.change and gives(changed(project, wider.change)):
            # Any module in place of the named one suffices.
            first, lack = (wider if first is lack else first), wider
        assert lack.change is not None
        project = changed(project, lack.change)
        steps.append(lack.to_get)
        if gives(project):
            return Blame(first.because, first.evidence, _together(steps))
        lack = _lack(Reasoner(project, reasoner.rulebook, reasoner.budget), pattern)
    return Blame(first.because, first.evidence)


def _together(steps: Sequence[str]) -> str:
    """Return several changes as one text; equal lines are written once, with their number."""
    lines = [each.replace("a further line", "a line") for each in steps]
    words = {each: lines.count(each) for each in lines}
    texts = [
        each.replace("a line", "two lines" if count == 2 else f"{count} lines")
        if count > 1
        else steps[lines.index(each)]
        for each, count in words.items()
    ]
    return ", and ".join(texts)


def _lack(reasoner: Reasoner, pattern: clingo.Symbol) -> _Lack:
    resolved = is_resolved(reasoner.rulebook, signature_of(pattern))
    explainer = reasoner.evidence(resolved and reasoner.synthesis is not None).explainer
    trace: Trace = absence.explain_absence(explainer, pattern, MOST_LEVELS)
    attempt: NearMiss | None = None
    seen: set[int] = set()
    while isinstance(trace, Underivable) and trace.attempts and id(trace) not in seen:
        seen.add(id(trace))
        attempt = trace.attempts[0]
        if attempt.cause is None:
            return _insufficient(attempt, pattern, reasoner.rulebook.declarations)
        trace = attempt.cause
    if isinstance(trace, Absent | Underivable):
        return _of_absent(trace, strings_in(pattern))
    return _excluded(trace)


def _of_absent(trace: Absent | Underivable, kept: Set[str]) -> _Lack:
    """Return the missing line of an absent atom, and a wider one with `_` for names not in `kept`.

    `kept` are the names in the question.
    """
    found = pattern_in(trace.atom)
    if found is not None and found.name in _LINES and len(found.arguments) > 2:
        ends = [found.arguments[place] for place in _LINES[found.name][1]]
        named = [end.type == clingo.SymbolType.String for end in ends]
        kept_names = [name and end.string in kept for name, end in zip(named, ends, strict=True)]
        if ends[0] == ends[1]:
            kept_names[1] = False
        wider = (
            _missing_line(found.name, ends, kept_names)
            if kept_names != named and any(kept_names)
            else None
        )
        return replace(_missing_line(found.name, ends, named), wider=wider)
    if found is not None and found.name == "architecture":
        kind = found.arguments[0]
        return _Lack(f"control is not {kind}", (), found, f"`@configuration {kind}`")
    return _Lack(trace.sentence or "no line of the configuration or its annotations states it")


def _missing_line(name: str, ends: Sequence[clingo.Symbol], kept: Sequence[bool]) -> _Lack:
    """Return the lack of a line between two ends; an end that is not `kept` is any module."""
    change, line = _new_line(name, ends, kept)
    return _Lack(f"there is no line {line}", (), change, f"a line {line}")


def _new_line(
    name: str, ends: Sequence[clingo.Symbol], kept: Sequence[bool]
) -> tuple[clingo.Symbol, str]:
    """Return the change that adds a line, and its text; an end that is not `kept` is any module."""
    first, second = (
        written(end.string) if keep else "..." for end, keep in zip(ends, kept, strict=True)
    )
    terms = [
        end if keep else clingo.Function("new", [clingo.Number(number)])
        for number, (end, keep) in enumerate(zip(ends, kept, strict=True), 1)
    ]
    rest = " MS" if name in GATING.values() else ""
    return clingo.Function(_LINES[name][0], terms), f"`{first} {name} {second}{rest}`"


def _excluded(trace: Trace) -> _Lack:
    """Return the lines that prevent an atom."""
    leaves = leaves_of(trace)
    spans = tuple(leaf.span for leaf in leaves if leaf.span is not None)
    numbers = dict.fromkeys(
        symbol.arguments[0]
        for leaf in leaves
        if (symbol := symbol_in(leaf.atom)) is not None and symbol.name in _LINES
    )
    drops = [clingo.Function("drop", [number]) for number in numbers]
    prevent = f"these {len(spans)} lines prevent" if len(spans) > 1 else "this line prevents"
    return _Lack(
        f"{prevent} it" if spans else "something that holds prevents it",
        spans[:MOST_LINES],
        clingo.Function("both", drops) if drops else None,
        f"leave out {f'these {len(drops)} lines' if len(drops) > 1 else 'that line'}",
    )


def _insufficient(
    attempt: NearMiss, pattern: clingo.Symbol, declared: Mapping[Signature, Declaration]
) -> _Lack:
    """Return the lack of a rule instance: it needs more lines, or was not chosen."""
    if attempt.fails is None:
        return _Lack("it is possible, but the minimal specification does without it")
    leaves = [leaf for held in attempt.held for leaf in leaves_of(held)]
    spans = tuple(dict.fromkeys(leaf.span for leaf in leaves if leaf.span is not None))
    failed = failed_value(attempt, declared, strings_in(pattern))
    if failed is None:
        if attempt.value is None and not spans:
            return _Lack(f"what rule `{attempt.rule.id}` compares does not fit")
        these = f"these {len(spans)} lines do not" if len(spans) > 1 else "this line alone does not"
        failed = f"{these if spans else 'what there is does not'} suffice"
    return _Lack(failed, spans[:MOST_LINES], *_further_line(leaves, pattern))


def _further_line(
    leaves: Sequence[Given], pattern: clingo.Symbol
) -> tuple[clingo.Symbol | None, str]:
    """Return the change that adds a line like one of `leaves`, and its text, else None and ""."""
    kept = strings_in(pattern)
    for leaf in leaves:
        symbol = symbol_in(leaf.atom)
        if symbol is None or symbol.name not in _LINES:
            continue
        ends = [symbol.arguments[place] for place in _LINES[symbol.name][1]]
        keep = [end.string in kept for end in ends]
        if any(keep):
            change, line = _new_line(symbol.name, ends, keep)
            return change, f"a further line {line}"
    return None, ""
