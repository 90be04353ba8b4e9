"""The output of `check`: findings in one of its formats, then notes and a summary.

Findings go to standard output or a file, notes about reading and the summary to standard error. The
formats `json`, `sarif` and `github` contain the notes instead.
"""

import argparse
import os
import sys
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from mars_asp.cli.deliver import write_closing, write_file
from mars_asp.cli.diagnostic_text import (
    colours,
    concise_text,
    diagnostic_json,
    diagnostic_text,
    report,
    suggestion_lines,
)
from mars_asp.cli.encode import encoded
from mars_asp.cli.finding_formats import is_note
from mars_asp.cli.folding import fold
from mars_asp.cli.inputs import STANDARD_INPUT
from mars_asp.cli.lines import line_text
from mars_asp.cli.results import Result
from mars_asp.cli.selection import hidden_text
from mars_asp.cli.suggested_commands import command_on
from mars_asp.cli.worker import read_standard_input
from mars_asp.cli.wrapping import columns, wrapped
from mars_asp.diagnostic import NOT_READ, Diagnostic, Severity, brief
from mars_asp.output import counted, visible
from mars_asp.reading import decoded

if TYPE_CHECKING:
    from mars_asp.reasoning.questions.repair import Repair

#: The format `text` is `full` on a terminal and `concise` elsewhere.
TEXT_FORMATS = ("text", "full", "concise")
FORMATS = (*TEXT_FORMATS, "json", "junit", "gitlab", "sarif", "github")
#: The formats that contain notes about reading.
_WITH_NOTES = ("json", "sarif", "github")


@dataclass
class Checked:
    """The results of one robot, their counts by severity, and the repairs that were applied."""

    path: str
    #: Foreign files that describe the same robot.
    further: tuple[str, ...] = ()
    status: int = 0
    counted: Counter[Severity] = field(default_factory=Counter)
    #: How many of them an earlier robot has as well.
    repeated: Counter[Severity] = field(default_factory=Counter)
    mended: "tuple[Repair, ...]" = ()
    #: How many findings have exactly one repair that was not applied.
    mendable: int = 0
    #: How many sole repairs conflict with the applied ones.
    left_out: int = 0
    new_warnings: tuple[str, ...] = ()
    #: The files that repairs change: path, new content, old content.
    written: list[tuple[str, bytes, bytes]] = field(default_factory=list)
    #: The content of standard input after the repairs.
    text: bytes | None = None
    #: The changes of standard input as a unified diff.
    change: str = ""
    #: How many findings are hidden, by `comment` or `baseline`.
    hidden: Counter[str] = field(default_factory=Counter)
    #: The launch files that were judged, each by itself.
    launch_files: tuple[str, ...] = ()
    results: list[Result] = field(default_factory=list)
    #: The instance of each module that has twins; their equal findings are printed as one.
    instances: Mapping[str, str] = field(default_factory=dict)

    def append_results(self, results: Iterable[Result]) -> None:
        """Append results, and count them by severity."""
        for each in results:
            self.results.append(each)
            if each.hidden is None:
                self.counted[each.diagnostic.severity] += 1
            else:
                self.hidden[each.hidden.by] += 1


def leave_out_repeats(checked: Iterable[Checked]) -> None:
    """Leave out results and repairs that an earlier robot has as well, in a file of both."""
    reported: set[Diagnostic] = set()
    mended: set[tuple[object, str]] = set()
    for one in checked:
        repeats = [each for each in one.results if each.diagnostic in reported]
        one.repeated.update(each.diagnostic.severity for each in repeats if each.hidden is None)
        one.mendable -= sum(each.suggestion is not None for each in repeats)
        one.results = [each for each in one.results if each.diagnostic not in reported]
        reported.update(each.diagnostic for each in one.results)
        found = [((r.consequence.spans, r.consequence.message), r) for r in one.mended]
        one.mended = tuple(repair for key, repair in found if key not in mended)
        mended.update(key for key, _ in found)


def write_report(
    checked: Sequence[Checked],
    remarks: Sequence[Result],
    arguments: argparse.Namespace,
    status: int,
) -> None:
    """Write the findings, then notes and the summary to standard error.

    Only this function decides on streams. Findings go to `--output`, else to standard output; but
    to standard error if standard output is for a repaired text or a baseline.
    """
    output = None if arguments.output == STANDARD_INPUT else arguments.output
    repairs_input = (
        arguments.fix and STANDARD_INPUT in arguments.files and arguments.format != "json"
    )
    is_taken = repairs_input or arguments.write_baseline == STANDARD_INPUT
    stream = None if output is not None else sys.stderr if is_taken else sys.stdout
    if arguments.format not in TEXT_FORMATS:
        findings = _document_text(checked, remarks, arguments, status)
    elif arguments.statistics:
        counted_ones = reported_findings(_unhidden(checked, remarks))
        findings = "".join(_statistics(counted_ones))
        # A number alone does not tell why a file was not read.
        wrong = (each.diagnostic for each in counted_ones if not each.diagnostic.kind)
        report((each for each in wrong if each.severity == "error"), arguments)
    else:
        folded = [
            each for one in checked for each in fold(reported_findings(one.results), one.instances)
        ]
        results = [*folded, *reported_findings(remarks)]
        findings = "".join(_diagnostic_text(results, arguments, stream))
    closing = "".join(_closing(checked, remarks, arguments))
    if output is not None:
        write_file(output, findings)
    elif is_taken:
        closing = findings + closing
    else:
        sys.stdout.write(findings)
    if repairs_input:
        text = next((one.text for one in checked if one.text is not None), b"")
        # Standard input that is excluded has not been read.
        sys.stdout.buffer.write(text or read_standard_input())
    write_closing(closing)


def reported_findings(results: Iterable[Result]) -> list[Result]:
    """Return the results that are reported findings."""
    return [each for each in results if each.hidden is None and not is_note(each)]


def _unhidden(checked: Sequence[Checked], remarks: Iterable[Result]) -> list[Result]:
    """Return all results that are not hidden."""
    every = [*(each for one in checked for each in one.results), *remarks]
    return [each for each in every if each.hidden is None]


# ---- Text ----------------------------------------------------------------------------------------


def _diagnostic_text(
    results: Iterable[Result], arguments: argparse.Namespace, stream: object
) -> Iterator[str]:
    """Yield the lines of results in the requested format, in colours if `stream` has them."""
    isatty = getattr(stream, "isatty", None)
    on_terminal = bool(isatty and isatty())
    is_full = _is_full(arguments)
    coloured, width = colours(arguments, stream), columns(stream)
    for result in results:
        found = brief(result.diagnostic)
        if not is_full:
            yield f"{concise_text(found, coloured)}\n"
            continue
        yield f"{diagnostic_text(found, coloured, width, whole_head=not on_terminal)}\n"
        for line in suggestion_lines(result.suggestion, width):
            yield f"{line}\n"


def _statistics(results: Iterable[Result]) -> Iterator[str]:
    """Yield the number and name of each kind of finding or code of error, a line each."""
    names = (each.diagnostic.kind or each.diagnostic.code for each in results)
    numbers = Counter(names)
    width = len(str(max(numbers.values(), default=0)))
    for name, number in sorted(numbers.items(), key=lambda item: (-item[1], item[0])):
        yield f"{number:>{width}} {visible(name)}\n"


def _is_full(arguments: argparse.Namespace) -> bool:
    """Whether text output has quoted lines and help."""
    if arguments.format == "text":
        return arguments.output is None and sys.stdout.isatty()
    return bool(arguments.format == "full")


def _closing(
    checked: Sequence[Checked], remarks: Sequence[Result], arguments: argparse.Namespace
) -> Iterator[str]:
    """Yield the text for standard error: notes, applied repairs and the summary."""
    if arguments.format not in _WITH_NOTES and not arguments.quiet:
        notes = filter(is_note, _unhidden(checked, remarks))
        yield from _diagnostic_text(notes, arguments, sys.stderr)
    width = columns(sys.stderr)
    is_listed = arguments.format in ("json", "sarif")
    for repair in (each for one in checked for each in one.mended if not is_listed):
        consequence, mend = repair.consequence, repair.mends[0]
        span = consequence.spans[0]
        about = f"{consequence.kind}({consequence.subject})"
        edits = "; ".join(edit.message for edit in mend.edits)
        text = visible(f"fixed {span.path}:{span.line}:{span.column}: {about}: {edits}")
        for line in wrapped(text, width, further="  "):
            yield f"{line}\n"
        for edit in mend.lines:
            for line in line_text(edit):
                yield f"{line.removeprefix('   ')}\n"
    if not is_listed:
        yield from new_warning_lines(checked)
    if not arguments.quiet:
        for sentence in _summary_sentences(checked, remarks, arguments):
            for line in wrapped(sentence, width, further="  "):
                yield f"{line}\n"


def new_warning_lines(checked: Sequence[Checked]) -> Iterator[str]:
    """Yield the lines on warnings that were not there before the repairs."""
    width = columns(sys.stderr)
    for message in (each for one in checked for each in one.new_warnings):
        for line in wrapped(visible(message), width, "    then warns: ", "      "):
            yield f"{line}\n"


def _summary_sentences(
    checked: Sequence[Checked], remarks: Sequence[Result], arguments: argparse.Namespace
) -> Iterator[str]:
    """Yield the sentences with the numbers of findings, repairs and files."""
    total: Counter[Severity] = sum((one.counted - one.repeated for one in checked), Counter())
    read = [path for one in checked for path in (one.path, *one.further)]
    folders = sum(os.path.isdir(path) for path in read)  # noqa: PTH112 -- never raises
    places = [(len(read) - folders, "file"), (folders, "folder")]
    within = " and ".join(counted(number, noun) for number, noun in places if number)
    mended = sum(len(one.mended) for one in checked)
    mendable = sum(one.mendable for one in checked)
    hidden: Counter[str] = sum((one.hidden for one in checked), Counter())
    found = [counted(total[of], of) for of in ("error", "warning") if total[of]]
    if found or mended:
        parts = [", ".join(found) or "no errors or warnings", f"in {within}"]
        yield f"{' '.join(parts)}{f'; {mended} fixed' if mended else ''}"
    elif within and not hidden and arguments.write_baseline is None:
        yield f"no problems found in {within}"
    elif not within and not reported_findings(remarks):
        yield "no file checked: all are excluded"
    if hidden:
        yield hidden_text(hidden)
    if mendable:
        has, them = ("has", "it") if mendable == 1 else ("have", "those that go together")
        shown = ", shown above" if _is_full(arguments) else ""
        yield f"{mendable} of them {has} exactly one repair{shown}; --fix applies {them}"
    if left_out := sum(one.left_out for one in checked):
        yield left_out_text(left_out)
    if arguments.fix:
        yield from nothing_fixed(checked, arguments)


def nothing_fixed(checked: Sequence[Checked], arguments: argparse.Namespace) -> Iterator[str]:
    """Yield the sentence that no finding has exactly one repair, if nothing else was the reason."""
    codes = {each.diagnostic.code for one in checked for each in one.results}
    left = [one.path for one in checked if one.status < 2 and any(one.counted.values())]
    if left and "unfixed" not in codes and not any(one.mended for one in checked):
        path = left[0] if len(left) == 1 else "FILE"
        way = f"`{command_on(path, 'explain', arguments, '--repair')}`"
        yield f"no finding has exactly one repair: {way} shows those that there are"


def left_out_text(number: int) -> str:
    """Return the sentence on repairs that are incompatible with the applied ones."""
    was, they = ("was", "it does") if number == 1 else ("were", "they do")
    return f"{counted(number, 'repair')} {was} left out, as {they} not go together with the others"


# ---- Documents -----------------------------------------------------------------------------------


def _document_text(
    checked: Sequence[Checked],
    remarks: Sequence[Result],
    arguments: argparse.Namespace,
    status: int,
) -> str:
    """Return the results in the requested format for programs; `status` is the exit status."""
    if arguments.format == "json":
        return f"{encoded(_check_document(checked, remarks, arguments))}\n"
    if arguments.format == "junit":
        from mars_asp.cli.junit import junit_suites

        robots = [(", ".join((one.path, *one.further)), one.results) for one in checked]
        if others := reported_findings(remarks):
            robots.append(("mars-asp check", others))
        return junit_suites([(name, reported_findings(results)) for name, results in robots])
    if arguments.format == "gitlab":
        from mars_asp.cli.gitlab import code_quality_report

        return f"{encoded(code_quality_report(reported_findings(_unhidden(checked, remarks))))}\n"
    from mars_asp.cli.finding_formats import published_text

    every = [*(each for one in checked for each in one.results), *remarks]
    return published_text(every, arguments, status)


def _check_document(
    checked: Sequence[Checked], remarks: Sequence[Result], arguments: argparse.Namespace
) -> dict[str, object]:
    from mars_asp.cli.repair import repair_json

    shown = _unhidden(checked, remarks)
    findings, notes = reported_findings(shown), list(filter(is_note, shown))
    if arguments.quiet:
        # Programs must learn of unread parts of a file even with `--quiet`.
        notes = [each for each in notes if each.diagnostic.code == NOT_READ]
    severities = Counter(each.diagnostic.severity for each in findings)
    return {
        "format": "mars-check",
        "version": 1,
        "findings": [result_json(each) for each in findings],
        "notes": [result_json(each) for each in notes],
        "files": [
            {
                "path": one.path,
                "further": list(one.further),
                "launch_files": list(one.launch_files),
                "errors": one.counted["error"],
                "warnings": one.counted["warning"],
                "hidden": dict(one.hidden),
                "fixed": [repair_json(repair) for repair in one.mended],
                **({} if one.text is None else {"text": decoded(one.text)}),
            }
            for one in checked
        ],
        "errors": severities["error"],
        "warnings": severities["warning"],
        "fixed": sum(len(one.mended) for one in checked),
    }


def result_json(result: Result) -> dict[str, object]:
    """Return a result with the keys of the contract."""
    return diagnostic_json(brief(result.diagnostic), result.suggestion)
