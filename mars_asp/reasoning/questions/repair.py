"""The smallest edits that remove a finding: proposed by `rules/repair`, each tried by solving.

>>> for repair in repairs(load_project("config.mars"), load_rulebook(stages=STAGES)):
...     print(repair.consequence.message, [mend.cost for mend in repair.mends])
"""

import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass, replace
from itertools import combinations, groupby, pairwise

import clingo

from mars_asp.asp.messages import rendered_messages, saying
from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.signature import Signature
from mars_asp.asp.solve.term_ids import as_symbol
from mars_asp.diagnostic import Diagnostic, MarsError
from mars_asp.language.text_edits import LineEdit
from mars_asp.model.declarations import Configuration, Control, ends_of
from mars_asp.reasoning.analysis import Analysis, Consequence, analyse
from mars_asp.reasoning.budget import Budget
from mars_asp.reasoning.findings import consequence_kinds
from mars_asp.reasoning.project import Project, project_facts, revised
from mars_asp.reasoning.questions.edits import (
    EditedTexts,
    ImpossibleEditError,
    UnknownEditError,
    apply_edits,
)
from mars_asp.reasoning.questions.launch_trees import is_about
from mars_asp.reasoning.questions.subject import wrong_subject
from mars_asp.reasoning.synthesis.synthesise import least_cost
from mars_asp.spelling import nearest

#: The stages in the rulebook of a repair.
STAGES = ("resolve", "repair")
#: Limits for a finding: found repairs, tried sets of edits, and edits in a set.
MOST_MENDS, MOST_TRIED, MOST_EDITS = 5, 60, 3
#: Limits for all findings: solved facts, the cost of a try in facts, and the minimal tries.
MOST_FACTS, FACTS_OF_A_TRY, LEAST_TRIED = 200_000, 500, 10
#: If the proposed edits exceed this fraction of the tries, the heaviest edits come first; once all
#: findings have a repair, only this other fraction of the tries remains.
ONE_IN_FOR_EACH, ONE_IN_FOR_FURTHER = 4, 10
#: Up to this weight edits can be combined; a heavier one is tried alone, and last.
HEAVIEST = 3
_STAGE = "repair"
_EDIT = Signature("edit", 5)


@dataclass(frozen=True, slots=True)
class RepairEdit:
    """One edit that a rule proposes; `weight` is the size of the change, from 1.

    `parts` are its component edits, or the edit itself. One that `is_undecided` may be wrong even
    if there is no other, so it is not applied without a user.
    """

    term: clingo.Symbol
    parts: tuple[clingo.Symbol, ...]
    message: str
    weight: int
    rule: Rule
    is_undecided: bool = False


@dataclass(frozen=True, slots=True)
class Mend:
    """Edits that together remove a finding, with the result of solving with them.

    `others` counts further removed findings; `warnings` are new warnings of the rules,
    `remarks` new ones of reading the files; `errors` counts the remaining errors; `spent` is
    the cost of a minimal specification by level, `None` while errors remain.
    """

    edits: tuple[RepairEdit, ...]
    lines: tuple[LineEdit, ...]
    others: int
    warnings: tuple[Consequence, ...]
    remarks: tuple[Diagnostic, ...]
    errors: int
    spent: Mapping[int, int] | None

    @property
    def cost(self) -> tuple[int, int, int]:
        """Return the rank of the edits: their number, their weight, new warnings."""
        warnings = len(self.warnings) + len(self.remarks)
        return len(self.edits), sum(edit.weight for edit in self.edits), warnings


@dataclass(frozen=True, slots=True)
class Repair:
    """A finding and the smallest sets of edits that remove it, best first.

    `proposed` is the number of edits from rules, `tried` the number of solved sets; `complete`
    is whether no smaller or equal set was left out; `late` is whether the time ended the
    search.
    """

    consequence: Consequence
    mends: tuple[Mend, ...]
    proposed: int
    tried: int
    complete: bool
    late: bool


def repairs(
    project: Project,
    rulebook: Rulebook,
    subject: str | None = None,
    seconds: float | None = None,
    progress: Callable[[int, int], None] | None = None,
    with_warnings: bool = False,
    most_facts: int | None = None,
    reported: Callable[[Sequence[Consequence]], Sequence[Consequence]] = lambda found: found,
) -> tuple[Repair, ...]:
    """Return repairs of every error, or of every warning if there is no error.

    Without a subject only those of findings count that `reported` returns.
    `subject` selects findings by kind, subject or `kind(subject)` instead; `with_warnings`
    includes warnings beside errors. The search ends after `most_facts` solved facts, by default
    `MOST_FACTS`, or after `seconds`. `rulebook` contains the stages `STAGES`. `progress` is
    called with the number of tried sets of edits, and with its maximum.

    Raises:
        MarsError: rules that clingo refuses; the subject is neither a module
            nor a kind of consequence.
    """
    began = time.monotonic()
    deadline = None if seconds is None else began + seconds
    facts = project_facts(project)
    analysis = analyse(facts, rulebook, project.configuration.span, with_labels=True)
    if project.format is not None:
        return repairs_by_hand(project, rulebook, analysis, subject)
    consequences = analysis.consequences if subject else reported(analysis.consequences)
    findings = _findings_to_repair(consequences, subject, with_warnings)
    if not findings:
        if subject is not None:
            _check_subject(subject, project, rulebook)
        return ()
    proposed = _proposals(analysis, rulebook)
    most = (MOST_FACTS if most_facts is None else most_facts) // (len(facts) + FACTS_OF_A_TRY)
    search = _EditSearch(project, rulebook, analysis.consequences, findings, deadline)
    return search.repairs(
        [
            proposed.get((kind, about, case), [])
            for kind, _, about, case in (finding.atom.arguments for finding in findings)
        ],
        max(LEAST_TRIED, most),
        time.monotonic() - began,
        progress,
    )


def repairs_by_hand(
    project: Project, rulebook: Rulebook, analysis: Analysis, subject: str | None = None
) -> tuple[Repair, ...]:
    """Return the findings of an analysis of foreign files, each without edits.

    Raises:
        MarsError: the subject names neither a module nor a kind of consequence.
    """
    chosen = (c for c in analysis.consequences if subject is None or is_about(c, subject))
    findings = [each for each in chosen if each.severity != "note"]
    if not findings and subject is not None:
        _check_subject(subject, project, rulebook)
    return tuple(Repair(finding, (), 0, 0, True, False) for finding in findings)


def _findings_to_repair(
    found: Sequence[Consequence], subject: str | None, with_warnings: bool
) -> list[Consequence]:
    if subject is not None:
        return [
            c
            for c in found
            if c.severity != "note"
            and subject in (c.kind, c.subject, f"{c.kind}({c.subject})", *c.participants)
        ]
    errors = [c for c in found if c.severity == "error"]
    if with_warnings:
        return [c for c in found if c.severity != "note"]
    return errors or [c for c in found if c.severity == "warning"]


def _check_subject(subject: str, project: Project, rulebook: Rulebook) -> None:
    """Raise an error if a subject is neither a module nor a kind of consequence."""
    names = {name.text for name in project.configuration.modules}
    kinds = consequence_kinds(rulebook)
    kind, _, rest = subject.partition("(")
    about = rest.removesuffix(")")
    if subject in names | kinds or (kind in kinds and about in names):
        return
    near = nearest(subject, names | kinds)
    if kind in kinds:
        module = nearest(about, names)
        near = f"{kind}({module})" if module else None
    raise wrong_subject(
        project,
        f"`{subject}` is neither a module nor a kind of consequence",
        f"did you mean `{near}`?" if near else "write a module, a KIND or `KIND(NAME)`",
    )


def _proposals(
    analysis: Analysis, rulebook: Rulebook
) -> dict[tuple[clingo.Symbol, ...], list[RepairEdit]]:
    """Return the edits that rules propose, lightest first, by the key of the finding."""
    speakers = [rule for rule in rulebook.rules if _EDIT in rule.heads]
    grounding = analysis.grounding
    grounding.derive([*rulebook.fragments("repair"), *saying(_STAGE, speakers)])
    found: dict[tuple[clingo.Symbol, ...], dict[clingo.Symbol, RepairEdit]] = {}
    parts: dict[clingo.Symbol, list[clingo.Symbol]] = {}
    for symbol in sorted(grounding.symbols("sub_edit", 2)):
        whole, part = symbol.arguments
        parts.setdefault(whole, []).append(part)
    spoiling = {symbol.arguments[0] for symbol in grounding.symbols("spoils", 1)}
    undecided = {tuple(symbol.arguments) for symbol in grounding.symbols("needs_choice", 2)}
    result = rendered_messages(grounding.control, _STAGE, speakers)
    for each in sorted(result, key=lambda s: (s.number, as_symbol(s.head), as_symbol(s.values))):
        *key, term, weight = as_symbol(each.head).arguments
        if term in spoiling:
            continue
        consists = tuple(parts.get(term, (term,)))
        message = each.message or str(term)
        is_undecided = (key[0], term) in undecided
        edit = RepairEdit(term, consists, message, weight.number, each.rule, is_undecided)
        found.setdefault(tuple(key), {}).setdefault(term, edit)
    return {
        key: sorted(edits.values(), key=lambda edit: (edit.weight, edit.rule.span, edit.term))
        for key, edits in found.items()
    }


@dataclass(frozen=True, slots=True)
class Trial:
    """An edited and analysed project: its edited lines, and its new findings."""

    lines: tuple[LineEdit, ...]
    texts: Mapping[str, str]
    project: Project
    analysis: Analysis
    counts: "FindingCounts"
    new: tuple[Consequence, ...]
    remarks: tuple[Diagnostic, ...]


def try_edits(
    texts: EditedTexts,
    terms: Sequence[clingo.Symbol],
    rulebook: Rulebook,
    before: "FindingCounts",
) -> Trial | None:
    """Return the project with edits, analysed; None if they fail or change the controllers' order.

    `before` are the findings without the edits.
    """
    try:
        lines, changed = apply_edits(texts, terms)
        project = revised(texts.project, changed)
        analysis = analyse(project_facts(project), rulebook, project.configuration.span)
    except (MarsError, UnknownEditError, ImpossibleEditError):
        return None
    if not order_kept(texts, project.configuration, terms):
        return None
    counts = FindingCounts(analysis.consequences)
    remarks = tuple(new_remarks(texts.project.diagnostics, project.diagnostics))
    new = tuple(counts.beyond(before))
    return Trial(lines, changed, project, analysis, counts, new, remarks)


class _EditSearch:
    """Tries sets of edits on one project, each once for all findings that it could remove."""

    def __init__(
        self,
        project: Project,
        rulebook: Rulebook,
        before: Iterable[Consequence],
        findings: Sequence[Consequence],
        deadline: float | None,
    ) -> None:
        self._texts = EditedTexts(project)
        self._rulebook = rulebook
        self._deadline = deadline
        self._before = FindingCounts(before)
        self._findings = findings

    def repairs(
        self,
        proposed: Sequence[Sequence[RepairEdit]],
        most: int,
        longest: float,
        progress: Callable[[int, int], None] | None,
    ) -> tuple[Repair, ...]:
        """Return a repair for each finding, searched by number of edits, then by weight.

        `proposed` are the edits for each finding, lightest first; `most` limits the tried sets;
        `longest` is the assumed duration of a try in seconds, before the first one.
        """
        mends: list[list[Mend]] = [[] for _ in self._findings]
        tried = [0] * len(self._findings)
        #: The findings for which a set was skipped, and those for which it was for lack of time.
        left: set[int] = set()
        hurried: set[int] = set()
        solved = 0
        singles = len(_shared(dict(enumerate(proposed)), 1))
        crowded = singles > max(LEAST_TRIED, most // ONE_IN_FOR_EACH)
        further = max(LEAST_TRIED, most // ONE_IN_FOR_FURTHER)
        # Heavy edits come last, alone; but first if trying each edit would take too long.
        sizes = tuple(range(1, MOST_EDITS + 1))
        for size in (None, *sizes) if crowded else (*sizes, None):
            wanting = [number for number, found in enumerate(mends) if not found or size == 1]
            for group in _shared({n: proposed[n] for n in wanting}, size):
                now = time.monotonic()
                late = self._deadline is not None and now + longest > self._deadline
                most = min(most, further) if crowded and all(mends) else most
                wanted = {
                    number: edits
                    for number, edits in group.items()
                    if len(mends[number]) < MOST_MENDS
                    and (size is None or tried[number] < MOST_TRIED)
                }
                left |= group.keys() - wanted.keys()
                if late or solved >= most:
                    left |= wanted.keys()
                    hurried |= wanted.keys() if solved < most else set()
                    continue
                if not wanted:
                    continue
                if progress is not None:
                    progress(solved, most)
                solved += 1
                result = self._try(next(iter(wanted.values())))
                longest = max(longest, time.monotonic() - now)
                for number, edits in wanted.items():
                    tried[number] += 1
                    if result is not None and number in result[0]:
                        mends[number].append(replace(result[1], edits=edits))
        return tuple(
            Repair(
                finding,
                tuple(sorted(mends[number], key=lambda mend: mend.cost)),
                len(proposed[number]),
                tried[number],
                number not in left,
                number in hurried,
            )
            for number, finding in enumerate(self._findings)
        )

    def _try(self, edits: tuple[RepairEdit, ...]) -> tuple[frozenset[int], Mend] | None:
        """Return the numbers of the removed findings and the repair, or None without success.

        It is None if the edits remove no finding, add an error, or leave no specification possible.
        """
        terms = [part for edit in edits for part in edit.parts]
        trial = try_edits(self._texts, terms, self._rulebook, self._before)
        if trial is None or any(c.severity == "error" for c in trial.new):
            return None
        gone = frozenset(
            number
            for number, finding in enumerate(self._findings)
            if trial.counts.lacks(finding, self._before)
        )
        if not gone:
            return None
        errors = sum(c.severity == "error" for c in trial.analysis.consequences)
        spent = None if errors else self._spent(trial.analysis)
        if not errors and spent is None:
            return None
        others = trial.counts.fewer(self._findings, self._before) - 1
        warnings = tuple(c for c in trial.new if c.severity == "warning")
        return gone, Mend(edits, trial.lines, others, warnings, trial.remarks, errors, spent)

    def _spent(self, analysis: Analysis) -> Mapping[int, int] | None:
        left = None if self._deadline is None else max(0.1, self._deadline - time.monotonic())
        try:
            return least_cost(analysis, self._rulebook, Budget(left))
        except (MarsError, TimeoutError):
            return None


def _shared(
    proposed: Mapping[int, Sequence[RepairEdit]], size: int | None
) -> list[dict[int, tuple[RepairEdit, ...]]]:
    """Return the sets of `size` edits, each with the numbers of the findings that it may remove.

    They are ordered by weight per finding, then by their rank for a finding. For a `size` of None
    they are the heavy edits, which are tried alone.
    """
    found: dict[frozenset[clingo.Symbol], dict[int, tuple[RepairEdit, ...]]] = {}
    rank: dict[frozenset[clingo.Symbol], int] = {}
    for number, edits in proposed.items():
        for place, chosen in enumerate(_by_weight(edits, size)):
            terms = frozenset(edit.term for edit in chosen)
            found.setdefault(terms, {})[number] = chosen
            rank[terms] = min(place, rank.get(terms, place))

    def order(terms: frozenset[clingo.Symbol]) -> tuple[float, int, int]:
        group = found[terms]
        weight = sum(edit.weight for edit in next(iter(group.values())))
        return weight / len(group), rank[terms], min(group)

    return [found[terms] for terms in sorted(found, key=order)]


def _by_weight(edits: Sequence[RepairEdit], size: int | None) -> Iterator[tuple[RepairEdit, ...]]:
    """Yield the sets of `size` edits, lightest first; the heavy edits alone if `size` is None."""
    if size is None:
        yield from ((edit,) for edit in edits if edit.weight > HEAVIEST)
        return
    edits = [edit for edit in edits if edit.weight <= HEAVIEST]
    if size == 1:
        yield from combinations(edits, size)
    else:
        # Sets of more edits would be too many to try anyway.
        groups = combinations(edits[:20], size)
        by_weight = sorted(groups, key=lambda group: sum(edit.weight for edit in group))
        # Single edits use up tries before, so this is more than enough.
        yield from by_weight[:MOST_TRIED]


class FindingCounts:
    """The number of consequences by kind and subject, by participants, and by message."""

    def __init__(self, consequences: Iterable[Consequence]) -> None:
        """Count the consequences of one analysis."""
        self._consequences = tuple(consequences)
        self._kind_and_subject = Counter(map(_kind_and_subject, self._consequences))
        self._taking_part = Counter(map(_taking_part, self._consequences))
        self._messages = Counter(map(_message, self._consequences))

    def lacks(self, finding: Consequence, before: "FindingCounts") -> bool:
        """Whether one `finding` of `before` is gone here, without a similar one in its place."""
        about, message = _kind_and_subject(finding), _message(finding)
        return (
            self._kind_and_subject[about] < before._kind_and_subject[about]
            and self._messages[message] < before._messages[message]
        )

    def fewer(self, findings: Iterable[Consequence], before: "FindingCounts") -> int:
        """Return how many findings of the kinds and subjects of `findings` are gone here."""
        return sum(
            max(0, before._kind_and_subject[about] - self._kind_and_subject[about])
            for about in set(map(_kind_and_subject, findings))
        )

    def beyond(self, before: "FindingCounts") -> list[Consequence]:
        """Return the findings that `before` does not have, with their participants and messages."""
        return [
            c
            for c in self._consequences
            if self._taking_part[_taking_part(c)] > before._taking_part[_taking_part(c)]
            or (
                c.severity == "warning"
                and self._messages[_message(c)] > before._messages[_message(c)]
            )
        ]


def _kind_and_subject(consequence: Consequence) -> tuple[str, ...]:
    return consequence.kind, consequence.subject


def _taking_part(consequence: Consequence) -> tuple[str, ...]:
    return *_kind_and_subject(consequence), *consequence.participants


def _message(consequence: Consequence) -> tuple[str, ...]:
    return *_kind_and_subject(consequence), consequence.message


def new_remarks(before: Iterable[Diagnostic], after: Iterable[Diagnostic]) -> Iterator[Diagnostic]:
    """Yield the warnings about files that only `after` has; locations do not count."""
    known = Counter((remark.code, remark.message) for remark in before)
    for remark in after:
        name = remark.code, remark.message
        if known[name]:
            known[name] -= 1
        elif remark.severity == "warning":
            yield remark


def order_kept(before: EditedTexts, after: Configuration, edits: Iterable[clingo.Symbol]) -> bool:
    """Whether controllers that ranked strictly above others of a module still do.

    A renamed controller keeps its rank; an edit that removes a priority may change the ranks
    of all controllers of its module.
    """
    terms = list(edits)
    declared = before.project.configuration
    renamed = {}
    unranked = set()
    for term in terms:
        if term.match("rename", 2):
            renamed[term.arguments[0].string] = term.arguments[1].string
        elif term.match("unrank", 1):
            span = before.relationships[term.arguments[0].number].span
            # One line of a file that is included twice is two relationships.
            unranked |= {ends_of(each)[0] for each in declared.relationships if each.span == span}
    now = _ranks(after, {})
    return all(_is_kept(_ranks(declared, names), now, unranked) for names in ({}, renamed))


def _is_kept(
    before: Mapping[str, Mapping[str, int]],
    after: Mapping[str, Mapping[str, int]],
    unranked: Set[str],
) -> bool:
    return all(
        max(lower) < min(higher)
        for module in before.keys() - unranked
        for lower, higher in pairwise(_levels(before[module], after.get(module, {})))
    )


def _levels(ranks: Mapping[str, int], now: Mapping[str, int]) -> list[list[int]]:
    """Return the present ranks of controllers, grouped by equal ranks before, lowest first."""
    kept = sorted(ranks.keys() & now.keys(), key=ranks.__getitem__)
    return [[now[name] for name in same] for _, same in groupby(kept, ranks.__getitem__)]


def _ranks(configuration: Configuration, renamed: Mapping[str, str]) -> dict[str, dict[str, int]]:
    """Return, by module, the highest priority of each controller (0: none), by their new names."""
    ranks: dict[str, dict[str, int]] = {}
    for declared in configuration.relationships:
        if isinstance(declared, Control):
            of = ranks.setdefault(renamed.get(declared.controlled, declared.controlled), {})
            name = renamed.get(declared.controller, declared.controller)
            of[name] = max(of.get(name, 0), declared.priority or 0)
    return ranks
