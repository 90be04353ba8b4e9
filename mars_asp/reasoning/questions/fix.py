"""Repairs that need no choice: those of findings with exactly one repair."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.diagnostic import Span
from mars_asp.language.text_edits import LineEdit
from mars_asp.reasoning.analysis import analyse
from mars_asp.reasoning.project import Project, project_facts
from mars_asp.reasoning.questions.edits import EditedTexts
from mars_asp.reasoning.questions.repair import (
    MOST_FACTS,
    FindingCounts,
    Repair,
    repairs,
    try_edits,
)


@dataclass(frozen=True, slots=True)
class AppliedFix:
    """Repairs that were applied together, and the resulting project.

    `left_out` are those whose findings are still there, `warnings` the messages that are new.
    `lines` are the edits of the original files, `texts` the resulting files by their paths.
    """

    repairs: tuple[Repair, ...]
    left_out: tuple[Repair, ...]
    warnings: tuple[str, ...]
    lines: tuple[LineEdit, ...]
    texts: Mapping[str, str]
    project: Project


def sole_repairs(
    project: Project,
    rulebook: Rulebook,
    seconds: float | None = None,
    progress: Callable[[int, int], None] | None = None,
    most_facts: int = MOST_FACTS,
) -> tuple[Repair, ...]:
    """Return the repairs of findings with exactly one repair, which need no choice.

    Repairs that rules leave undecided are left out. If a search ended early, another repair could
    exist, so the finding is left out. A line of a file that is included several times has one
    repair only if each instance has. Other arguments are those of `repairs`.

    Raises:
        MarsError: rules that clingo refuses.
    """
    found = repairs(
        project,
        rulebook,
        seconds=seconds,
        progress=progress,
        with_warnings=True,
        most_facts=most_facts,
    )
    several = {_line_of(each) for each in found if not _needs_no_choice(each)}
    return tuple(repair for repair in found if _line_of(repair) not in several)


def _needs_no_choice(repair: Repair) -> bool:
    is_decided = not any(edit.is_undecided for mend in repair.mends for edit in mend.edits)
    return len(repair.mends) == 1 and repair.complete and is_decided


def _line_of(repair: Repair) -> tuple[str, tuple[Span, ...]]:
    """Return the kind and the locations of a repair's finding; instances of a line share them."""
    return repair.consequence.kind, repair.consequence.spans


def fix(project: Project, rulebook: Rulebook, sole: Sequence[Repair]) -> AppliedFix | None:
    """Return the result of applying repairs with one set of edits each; None if none succeeds.

    The result was parsed and analysed again. Of incompatible repairs, the first is applied.

    Raises:
        MarsError: rules that clingo refuses.
    """
    texts = EditedTexts(project)
    analysis = analyse(project_facts(project), rulebook, project.configuration.span)
    before = FindingCounts(analysis.consequences)
    whole = _applied(texts, before, rulebook, sole, sole)
    if whole is not None:
        return whole
    kept: list[Repair] = []
    found = None
    for repair in sole:
        more = _applied(texts, before, rulebook, [*kept, repair], sole)
        if more is not None:
            kept.append(repair)
            found = more
    return found


def _applied(
    texts: EditedTexts,
    before: FindingCounts,
    rulebook: Rulebook,
    chosen: Sequence[Repair],
    sole: Sequence[Repair],
) -> AppliedFix | None:
    """Return the result of all repairs; None if a finding remains or an unannounced one is new."""
    mends = [repair.mends[0] for repair in chosen]
    terms = dict.fromkeys(part for mend in mends for edit in mend.edits for part in edit.parts)
    trial = try_edits(texts, list(terms), rulebook, before) if terms else None
    if trial is None:
        return None
    announced = {warning.message for mend in mends for warning in mend.warnings}
    announced |= {remark.message for mend in mends for remark in mend.remarks}
    new = [c for c in trial.new if c.severity != "note"]
    if (
        not all(trial.counts.lacks(repair.consequence, before) for repair in chosen)
        or any(c.severity == "error" or c.message not in announced for c in new)
        or any(remark.message not in announced for remark in trial.remarks)
    ):
        return None
    left_out = tuple(each for each in sole if not trial.counts.lacks(each.consequence, before))
    messages = (*(each.message for each in new), *(each.message for each in trial.remarks))
    return AppliedFix(
        tuple(chosen),
        left_out,
        tuple(dict.fromkeys(messages)),
        trial.lines,
        trial.texts,
        trial.project,
    )
