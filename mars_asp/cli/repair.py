"""The output of `explain --repair`: findings and the edits that remove them."""

import argparse
import sys
from collections.abc import Iterator

from mars_asp.cli.analyse import consequence_json
from mars_asp.cli.diagnostic_text import colours, paint
from mars_asp.cli.encode import print_result
from mars_asp.cli.inputs import JUDGING, judge_project, rulebook_for
from mars_asp.cli.lines import line_json, line_text, location_json, rule_location_json
from mars_asp.cli.progress import progress_bar
from mars_asp.cli.selection import Selection
from mars_asp.cli.wrapping import columns, spent, wrapped
from mars_asp.diagnostic import Diagnostic
from mars_asp.language.text_edits import LineEdit
from mars_asp.model.declarations import Mount
from mars_asp.output import counted, visible
from mars_asp.reasoning.analysis import Consequence
from mars_asp.reasoning.project import Project
from mars_asp.reasoning.questions.repair import (
    STAGES,
    Mend,
    Repair,
    RepairEdit,
    repairs,
    repairs_by_hand,
)
from mars_asp.reasoning.rules import by_name

#: A repair of more lines is printed once, even if it fixes several findings.
_MOST_PRINTED_AGAIN = 8
#: Printed if the specification after the edits has no costs.
_NOTHING_LEFT = "then there is a specification, which needs no node"
#: The indent of the lines below a repair.
_BELOW = "       "


def run_repair(project: Project, arguments: argparse.Namespace, subject: str | None) -> int:
    """Print repairs; return 1 if an error is reported, 3 if the time limit ended the search.

    Without a subject, only reported findings are repaired.
    """
    is_foreign = project.format is not None
    rulebook = rulebook_for(arguments, JUDGING if is_foreign else STAGES)
    selection = Selection(arguments, rulebook)
    if is_foreign:
        # Foreign files have the findings of `check`.
        analysis = judge_project(project, rulebook, arguments)
        found = repairs_by_hand(project, rulebook, analysis, subject)
    else:
        with progress_bar(arguments, "sets of edits") as progress:
            found = repairs(
                project,
                rulebook,
                subject,
                arguments.time_limit,
                progress,
                reported=lambda every: selection.among(project, every).shown,
            )
    shown = selection.among(project, [repair.consequence for repair in found]).shown
    if subject is None:
        found = tuple(repair for repair in found if repair.consequence in shown)
    print_result(
        arguments,
        lambda: {"subject": subject, "repairs": list(map(repair_json, found))},
        _repair_text(found, project, colours(arguments, sys.stdout), columns(sys.stdout)),
    )
    if any(repair.late for repair in found):
        print("mars-asp: the time limit ended the search", file=sys.stderr)
        return 3
    return int(any(consequence.severity == "error" for consequence in shown))


def _repair_text(
    found: tuple[Repair, ...], project: Project, coloured: bool, width: int
) -> Iterator[str]:
    has_mounts = any(isinstance(each, Mount) for each in project.configuration.relationships)
    if not found:
        yield "nothing to repair"
    printed: dict[tuple[LineEdit, ...], str] = {}
    for repair in found:
        consequence = repair.consequence
        span = consequence.spans[0]
        kind = paint(consequence.kind, consequence.severity, coloured)
        place = visible(f"{span.path}:{span.line}:{span.column}")
        yield from wrapped(visible(consequence.message), width, f"{place}: {kind}: ", "  ")
        for number, mend in enumerate(repair.mends, 1):
            here = f"repair {number} of `{consequence.kind}({visible(consequence.subject)})`"
            first = printed.setdefault(mend.lines, here)
            yield from _mend_text(number, mend, first, here, width, has_mounts)
        if project.format is not None:
            for text in _by_hand(consequence):
                yield from wrapped(text, width, "  ", "    ")
        elif not repair.proposed:
            yield from wrapped(_unproposed(consequence), width, "  ", "    ")
        elif not repair.mends and not repair.tried and not repair.complete:
            alone = f"{consequence.kind}({visible(consequence.subject)})"
            why = "no time was left" if repair.late else "not tried beside so many others"
            yield from wrapped(f"{why}: ask for `{alone}` alone", width, "  ", "    ")
        elif not repair.mends:
            end = "" if repair.complete else ", and more were left"
            tried = counted(repair.tried, "set")
            were = "was" if repair.tried == 1 else "were"
            yield f"  no repair found: {tried} of edits {were} tried{end}"
    if any(repair.mends and not repair.complete for repair in found):
        yield "there may be more repairs: the search ends after a few"


def _by_hand(consequence: Consequence) -> Iterator[str]:
    """Yield the help of a finding in a foreign file, and its further locations."""
    yield f"by hand: {visible(consequence.help or 'only `.mars` files are edited here')}"
    _, *further = dict.fromkeys(f"{span.path}:{span.line}" for span in consequence.spans)
    if further:
        yield f"see also {', '.join(map(visible, further))}"


def _unproposed(consequence: Consequence) -> str:
    """Return the sentence that no edit is known for a finding, with its help if it has some."""
    if consequence.help:
        return f"no edit is known that would fix it; by hand: {visible(consequence.help)}"
    rule = f"edit({consequence.kind}, SUBJECT, CASE, EDIT, WEIGHT)"
    return f"no rule proposes an edit for `{consequence.kind}`; one of yours may: `{rule}`"


def _mend_text(
    number: int, mend: Mend, first: str, here: str, width: int, has_mounts: bool
) -> Iterator[str]:
    """Yield the lines of a repair named `here`; long ones only at their `first` name.

    The numbers of relationships leave out mounts, which all specifications have.
    """
    messages = "; ".join(visible(edit.message) for edit in mend.edits)
    rules = ", ".join(dict.fromkeys(edit.rule.id for edit in mend.edits))
    yield from wrapped(f"{messages}  [{rules}]", width, f"  {number}. ", _BELOW)
    lines = [text for line in mend.lines for text in line_text(line)]
    if first != here and len(lines) > _MOST_PRINTED_AGAIN:
        lines = wrapped(f"the {len(lines)} lines of {first}", width, _BELOW, _BELOW)
    yield from lines
    if mend.others:
        yield f"{_BELOW}also fixes {counted(mend.others, 'other finding')}"
    warnings = [*(each.message for each in mend.warnings), *(each.message for each in mend.remarks)]
    for warning in warnings:
        yield from wrapped(visible(warning), width, f"{_BELOW}then warns: ", _BELOW + "  ")
    if mend.errors:
        are = "is" if mend.errors == 1 else "are"
        yield f"{_BELOW}{counted(mend.errors, 'other error')} {are} left"
    elif mend.spent is not None:
        costs = spent(by_name(mend.spent))
        message = f"then there is a specification of {costs}{' plus mounts' * has_mounts}"
        message = message if costs else _NOTHING_LEFT
        yield from wrapped(message, width, _BELOW, _BELOW)


def repair_json(repair: Repair) -> dict[str, object]:
    """Return a repair with the keys of the contract."""
    return {
        "consequence": consequence_json(repair.consequence),
        "repairs": [mend_json(mend) for mend in repair.mends],
        "proposed": repair.proposed,
        "tried": repair.tried,
        "complete": repair.complete,
    }


def mend_json(mend: Mend) -> dict[str, object]:
    """Return one repair of a finding with the keys of the contract."""
    return {
        "edits": [_edit_json(edit) for edit in mend.edits],
        "lines": [line_json(line) for line in mend.lines],
        "also_mended": mend.others,
        "warnings": [
            *(consequence_json(warning) for warning in mend.warnings),
            *(_remark_json(remark) for remark in mend.remarks),
        ],
        "errors_left": mend.errors,
        "cost": None if mend.spent is None else by_name(mend.spent),
    }


def _edit_json(edit: RepairEdit) -> dict[str, object]:
    return {
        "edit": str(edit.term),
        "parts": [str(part) for part in edit.parts],
        "message": edit.message,
        "weight": edit.weight,
        "rule": rule_location_json(edit.rule),
    }


def _remark_json(remark: Diagnostic) -> dict[str, object]:
    """Return a warning of reading files with the keys of a consequence."""
    return {
        "kind": remark.code,
        "subject": "",
        "participants": [],
        "severity": remark.severity,
        "message": remark.message,
        "help": remark.help,
        "locations": [location_json(remark.span)],
        "rule": None,
    }
