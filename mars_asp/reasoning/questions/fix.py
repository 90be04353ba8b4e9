"""Repairs that can be applied without a choice: those of findings that have exactly one."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.diagnostic import MarsError, Span
from mars_asp.language.text_edits import LineEdit
from mars_asp.reasoning.analysis import Analysis, analyse
from mars_asp.reasoning.project import Project, project_facts, revised
from mars_asp.reasoning.questions.edits import (
    EditedTexts,
    ImpossibleEditError,
    UnknownEditError,
    apply_edits,
)
from mars_asp.reasoning.questions.repair import (
    MOST_FACTS,
    FindingCounts,
    Repair,
    new_remarks,
    order_kept,
    repairs,
)


@dataclass(frozen=True, slots=True)
class AppliedFix:
    """Repairs that were applied together, and what they made of a project.

    `lines` are those of the files as they were, `texts` the files as they are then, by their paths.
    """

    repairs: tuple[Repair, ...]
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
    """Return the repairs of those findings that have exactly one: nobody has to choose.

    Where the search ended before all was tried, there may be another. A line of a file that is
    included several times has one repair only if each instance has. Other arguments are those of
    `repairs`.

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
    several = {_line_of(each) for each in found if len(each.mends) != 1 or not each.complete}
    return tuple(repair for repair in found if _line_of(repair) not in several)


def _line_of(repair: Repair) -> tuple[str, tuple[Span, ...]]:
    """Return the kind and the locations of a finding, which its instances share."""
    return repair.consequence.kind, repair.consequence.spans


def fix(project: Project, rulebook: Rulebook, sole: Sequence[Repair]) -> AppliedFix | None:
    """Apply repairs, each of which has one mend; return what was applied, if anything could be.

    The result was parsed and analysed again. Where repairs do not go together, those that come
    later are left out.

    Raises:
        MarsError: rules that clingo refuses.
    """
    texts = EditedTexts(project)
    before = analyse(project_facts(project), rulebook, project.configuration.span)
    whole = _applied(texts, before, rulebook, sole)
    if whole is not None:
        return whole
    kept: list[Repair] = []
    found = None
    for repair in sole:
        more = _applied(texts, before, rulebook, [*kept, repair])
        if more is not None:
            kept.append(repair)
            found = more
    return found


def _applied(
    texts: EditedTexts, before: Analysis, rulebook: Rulebook, chosen: Sequence[Repair]
) -> AppliedFix | None:
    """Write, read and analyse; return nothing where a finding stays, or one comes unannounced."""
    edits = [edit for repair in chosen for edit in repair.mends[0].edits]
    terms = list(dict.fromkeys(part for edit in edits for part in edit.parts))
    if not terms:
        return None
    project = texts.project
    try:
        lines, changed = apply_edits(texts, terms)
        after = revised(project, changed)
        analysis = analyse(project_facts(after), rulebook, after.configuration.span)
    except (MarsError, UnknownEditError, ImpossibleEditError):
        return None
    known, result = FindingCounts(before.consequences), FindingCounts(analysis.consequences)
    mends = [repair.mends[0] for repair in chosen]
    announced = {warning.message for mend in mends for warning in mend.warnings}
    announced |= {remark.message for mend in mends for remark in mend.remarks}
    new = [c for c in result.beyond(known) if c.severity != "note"]
    remarks = new_remarks(project.diagnostics, after.diagnostics)
    if (
        not order_kept(texts, after.configuration, terms)
        or not all(result.lacks(repair.consequence, known) for repair in chosen)
        or any(c.severity == "error" or c.message not in announced for c in new)
        or any(remark.message not in announced for remark in remarks)
    ):
        return None
    return AppliedFix(tuple(chosen), lines, changed, after)
