"""Parse, extract and analyse; print what warns or stops, and nothing else."""

import argparse
import sys
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.cli.deliver import file_key, replace_files
from mars_asp.cli.encode import encoded
from mars_asp.cli.excluded import add_exclusion
from mars_asp.cli.folding import fold, instances_of
from mars_asp.cli.layout import columns, counted, wrapped
from mars_asp.cli.lines import forget, line_text, remember
from mars_asp.cli.progress import progress_bar
from mars_asp.cli.publish import FINDING_FORMATS, is_published, publish, published
from mars_asp.cli.reason import (
    JUDGING,
    SHOWN_INPUT,
    STANDARD_INPUT,
    add_launch,
    check_inputs,
    judge_project,
    load,
    robots,
    rulebook_for,
)
from mars_asp.cli.report import Suggestion, report
from mars_asp.cli.results import Result, results_of
from mars_asp.cli.selection import Selection, add_selection, hidden_text
from mars_asp.cli.worker import read_standard_input
from mars_asp.diagnostic import NOT_READ, Diagnostic, MarsError, Severity, point
from mars_asp.language.parse import MOST_BYTES, decode, plain_lines
from mars_asp.language.text_edits import ConflictError, edited_bytes
from mars_asp.output import visible
from mars_asp.reading import OUTSIDE, is_hidden

if TYPE_CHECKING:
    from mars_asp.reasoning.analysis import Analysis
    from mars_asp.reasoning.project import Project
    from mars_asp.reasoning.questions.fix import Fix
    from mars_asp.reasoning.questions.repair import Repair

    _Seen: TypeAlias = Callable[[Project, Analysis], None]

#: What the verb prints its result in.
RESULT_FORMATS = FINDING_FORMATS
_Rules: TypeAlias = Callable[[tuple[str, ...]], Rulebook]
#: Of a larger robot a repair takes longer to find than people wait for a check.
_MOST_FACTS, _MOST_SOLVED = 2_000, 20_000


@dataclass
class Checked:
    """What came of a file: how many diagnostics of each severity, and what was mended."""

    path: str
    #: Files of others that say more of the same robot.
    further: tuple[str, ...] = ()
    status: int = 0
    counted: Counter[Severity] = field(default_factory=Counter)
    mended: "tuple[Repair, ...]" = ()
    #: How many findings have exactly one repair that was not applied.
    mendable: int = 0
    #: The files that are changed for it: path, new content, and old.
    written: list[tuple[str, bytes, bytes]] = field(default_factory=list)
    #: What standard input holds in the end.
    text: str | None = None
    #: How many findings a comment or a baseline hides.
    hidden: Counter[str] = field(default_factory=Counter)
    #: The launch files that were judged, each by itself.
    launch_files: tuple[str, ...] = ()
    #: What was found, where that is printed at the end.
    results: list[Result] = field(default_factory=list)

    def report(
        self,
        results: Iterable[Result],
        arguments: argparse.Namespace,
        sole: "Sequence[Repair]" = (),
        instances: Mapping[str, str] | None = None,
    ) -> None:
        """Print what is not hidden, some with its one repair, and count it.

        As text, equal findings of `instances` are one.
        """
        results = tuple(results)
        found = [each.diagnostic for each in results if each.hidden is None]
        suggestions = _suggestions(found, sole)
        self.counted.update(each.severity for each in found)
        self.hidden.update(each.hidden.by for each in results if each.hidden is not None)
        if is_published(arguments):
            self.results += (
                each._replace(suggestion=suggestions.get(each.diagnostic)) for each in results
            )
        else:
            if instances is not None and arguments.format == "text":
                shown = [each for each in results if each.hidden is None]
                folded = fold(shown, instances, suggestions)
                found = [each for each, _ in folded]
                suggestions = {each: of for each, of in folded if of is not None}
            report(found, arguments, suggestions)


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the verb."""
    parser.add_argument(
        "files",
        metavar="PATH",
        nargs="*",
        default=["."],
        help="a folder, whose robots are judged each by itself; `.mars` files, each a robot of its "
        "own; other files, which are one robot; `-` is standard input (default: this folder)",
    )
    parser.add_argument(
        "--fix",
        action="store_true",
        help="apply the repair of each finding that has exactly one, and check again; "
        "the text of standard input goes to the output",
    )
    parser.add_argument(
        "--fail-on",
        choices=("error", "warning"),
        default="error",
        help="the least severity of a reported finding that makes the exit status 1",
    )
    add_launch(parser)
    add_exclusion(parser)
    add_selection(parser)


@published
def run(arguments: argparse.Namespace) -> int:
    """Report the findings; 1 where one is bad enough to fail, 2 where a file cannot be read."""
    check_inputs(*arguments.files)
    if arguments.fix and is_published(arguments):
        told = f"--fix prints what it changed: leave out `--format {arguments.format}`, or --fix"
        print(f"mars-asp check: {told}", file=sys.stderr)
        return 2
    checked, remarks = check(arguments)
    status = max((one.status for one in checked), default=0)
    if is_published(arguments):
        results = [*(each for one in checked for each in one.results), *remarks]
        publish(results, arguments, status)
    else:
        report((each.diagnostic for each in remarks), arguments)
    if arguments.format == "json":
        print(encoded(_json(checked)))
    elif arguments.format != "sarif":
        _print(checked, arguments)
    return status


def check(
    arguments: argparse.Namespace, seen: "_Seen" = lambda project, analysis: None
) -> tuple[list[Checked], list[Result]]:
    """Check the files of a call; return what came of each, and what is odd about the selection.

    Findings are printed, or kept where all are published at the end. Each robot that could be read
    is `seen` with what follows from it.

    Raises:
        MarsError: what is wrong with rule packs, settings or a baseline.
    """
    rules = cache(lambda stages: rulebook_for(arguments, stages))
    selection = Selection(arguments, rules(JUDGING))
    checked = []
    edited: dict[object, tuple[str, bytes]] = {}
    is_complete = True
    for robot in robots(arguments, _each_once(arguments.files)):
        name, *further = robot.paths
        one = Checked(name, tuple(further))
        checked.append(one)
        try:
            if robot.problems:
                raise MarsError(robot.problems)
            _check(one, rules, selection, arguments, edited, seen)
        except MarsError as error:
            one.report(map(Result, error.diagnostics), arguments)
            # Others of the folder are judged all the same.
            one.status = 2
            is_complete = False
        one.report(map(Result, robot.notes), arguments)
    for one in checked:
        if one.written:
            replace_files(one.written)
    remarks = map(Result, selection.end(is_complete and all(one.status < 2 for one in checked)))
    return checked, list(remarks)


def _each_once(names: Iterable[str]) -> list[str]:
    """Return the names of files without those of a file that was named before."""
    first: dict[str, str] = {}
    for name in names:
        first.setdefault(name if name == STANDARD_INPUT else str(Path(name).resolve()), name)
    return list(first.values())


def _check(
    one: Checked,
    rules: _Rules,
    selection: Selection,
    arguments: argparse.Namespace,
    edited: dict[object, tuple[str, bytes]],
    seen: "_Seen",
) -> None:
    """Check a file; with `--fix`, apply repairs as `_fix` does.

    Raises:
        MarsError: what is wrong with the file or its sources.
    """
    raw = read_standard_input(MOST_BYTES + 1) if one.path == STANDARD_INPUT else None
    text = None if raw is None else decode(raw, SHOWN_INPUT)
    path = SHOWN_INPUT if raw is not None else one.path
    project = load(arguments, path, text, one.further)
    one.launch_files = tuple(tree.path for tree in project.trees)
    one.text = text if arguments.fix else None
    analysis = judge_project(project, rules(JUDGING), arguments)
    seen(project, analysis)
    selected = selection.of(project, analysis, notes=False)
    sole: tuple[Repair, ...] = ()
    is_small = arguments.fix or len(analysis.facts) <= _MOST_FACTS
    shows_repairs = arguments.format != "github"
    if project.format is None and selected.shown and is_small and shows_repairs:
        shown = {(each.spans, each.message) for each in selected.shown}
        found = _sole_repairs(project, rules, arguments)
        sole = tuple(r for r in found if (r.consequence.spans, r.consequence.message) in shown)
    if sole and arguments.fix:
        fixed = _fix(project, sole, rules, raw, one, arguments, edited)
        if fixed is not None:
            project, sole = fixed.project, ()
            for path, text in fixed.texts.items():
                remember(path, text)
            analysis = judge_project(project, rules(JUDGING), arguments)
            selected = selection.of(project, analysis, notes=False)
    one.mendable = 0 if arguments.fix else len(sole)
    messages, hidden = selection.messages(project)
    one.hidden.update(hidden)
    unread = [d for d in messages if d.code == NOT_READ]
    one.report((Result(d) for d in messages if d.code != NOT_READ), arguments)
    # Of a launch tree the rules find what is equal.
    instances = None if project.trees else instances_of(project.configuration)
    one.report(results_of(selected), arguments, sole, instances)
    one.report(map(Result, unread), arguments)
    # Another robot that includes the file is judged by what it holds until all are checked.
    for path, _, _ in one.written:
        forget(path)
    if project.format is not None and arguments.fix:
        one.report([Result(_unfixed(project.configuration.path, _FOREIGN, _BY_HAND))], arguments)
        one.status = 2
    failing: tuple[Severity, ...] = ("error", "warning")
    failing = failing[: failing.index(arguments.fail_on) + 1]
    one.status = max(one.status, int(any(one.counted[severity] for severity in failing)))


def _sole_repairs(
    project: "Project", rules: _Rules, arguments: argparse.Namespace
) -> "tuple[Repair, ...]":
    from mars_asp.reasoning.questions.fix import sole_repairs
    from mars_asp.reasoning.questions.repair import MOST_FACTS, STAGES

    most = MOST_FACTS if arguments.fix else _MOST_SOLVED
    with progress_bar(arguments, "sets of edits") as progress:
        return sole_repairs(project, rules(STAGES), arguments.time_limit, progress, most)


def _suggestions(
    found: Iterable[Diagnostic], sole: "Iterable[Repair]"
) -> Mapping[Diagnostic, Suggestion]:
    """Return the one repair of each finding that has one."""
    mends = {(r.consequence.spans, r.consequence.message): r.mends[0] for r in sole}
    return {
        each: Suggestion(
            "; ".join(edit.message for edit in mend.edits),
            mend.lines,
            (*(warning.message for warning in mend.warnings), *(r.message for r in mend.remarks)),
        )
        for each in found
        if (mend := mends.get(((each.span, *(at for at, _ in each.labels)), each.message)))
    }


def _fix(
    project: "Project",
    sole: "Sequence[Repair]",
    rules: _Rules,
    raw: bytes | None,
    one: Checked,
    arguments: argparse.Namespace,
    edited: dict[object, tuple[str, bytes]],
) -> "Fix | None":
    """Apply repairs to the files; return nothing where none could be applied.

    The files are written at the end, all of a robot or none. The new content of each is added to
    `edited`, by the identity of the file, with the robot for which it is. Robots that share a file
    have to agree on it.
    """
    from mars_asp.reasoning.questions.fix import fix
    from mars_asp.reasoning.questions.repair import STAGES

    fixed = fix(project, rules(STAGES), sole)
    if fixed is None:
        return None
    problems: list[Diagnostic] = []
    for path, text in fixed.texts.items():
        is_input = raw is not None and path == SHOWN_INPUT
        try:
            old = raw if raw is not None and is_input else Path(path).read_bytes()
            new = edited_bytes(old, [line for line in fixed.lines if line.path == path])
            if _plain(new) != text.rstrip("\n"):
                raise ConflictError
        except (OSError, ConflictError):
            problems.append(_unfixed(path, "it is not what was analysed"))
            continue
        if is_input:
            one.text = decode(new, path)
        elif is_hidden(path):
            problems.append(_unfixed(path, OUTSIDE))
        elif not Path(path).stat().st_mode & 0o222:
            problems.append(_unfixed(path, "it is read-only"))
        elif (other := edited.get(file_key(path), (one.path, new)))[1] != new:
            problems.append(_unfixed(path, f"it is changed for `{other[0]}`", _AGAIN))
        elif file_key(path) not in edited:
            one.written.append((path, new, old))
    if problems:
        one.status = 2
        one.written.clear()
        one.text = None if raw is None else decode(raw, SHOWN_INPUT)
        one.report(map(Result, problems), arguments)
        return None
    edited.update((file_key(path), (one.path, new)) for path, new, _ in one.written)
    one.mended = fixed.repairs
    return fixed


def _plain(raw: bytes) -> str:
    for codec in (
        ("utf-16",) if raw.startswith((b"\xff\xfe", b"\xfe\xff")) else ("utf-8", "latin-1")
    ):
        try:
            return plain_lines(raw.decode(codec)).rstrip("\n")
        except UnicodeDecodeError:
            continue
    raise ConflictError


#: Why a file that is no `.mars` file stays as it is.
_FOREIGN = "repairs are edits of `.mars` files"
_BY_HAND = "change it by hand, as the help of each finding suggests"
_AGAIN = "run the command again"


def _unfixed(path: str, why: str, help_text: str | None = None) -> Diagnostic:
    message = f"`{path}` was not fixed: {why}"
    return Diagnostic("unfixed", "error", message, point(path, 1, 1), help=help_text)


# ---- What is printed at the end ------------------------------------------------------------------


def _print(checked: Sequence[Checked], arguments: argparse.Namespace) -> None:
    """Print what was mended and how many findings there are; the text of standard input alone."""
    # The output is for the text of standard input alone, where that is mended.
    for one in checked:
        if one.text is not None:
            sys.stdout.buffer.write(one.text.encode())
        for repair in one.mended:
            consequence, mend = repair.consequence, repair.mends[0]
            span = consequence.spans[0]
            about = f"{consequence.kind}({consequence.subject})"
            said = "; ".join(edit.message for edit in mend.edits)
            place = f"{span.path}:{span.line}:{span.column}"
            told = visible(f"fixed {place}: {about}: {said}")
            for text in wrapped(told, columns(sys.stderr), further="  "):
                print(text, file=sys.stderr)
            for line in mend.lines:
                for text in line_text(line):
                    print(text.removeprefix("   "), file=sys.stderr)
    if not arguments.quiet:
        for told in _summary(checked):
            for text in wrapped(told, columns(sys.stderr), further="  "):
                print(text, file=sys.stderr)


def _summary(checked: Sequence[Checked]) -> Iterable[str]:
    """Yield how much was found and mended in how many files, where there is anything to say."""
    total: Counter[Severity] = sum((one.counted for one in checked), Counter())
    read = [path for one in checked for path in (one.path, *one.further)]
    folders = sum(Path(path).is_dir() for path in read)
    places = [(len(read) - folders, "file"), (folders, "folder")]
    within = " and ".join(counted(number, noun) for number, noun in places if number)
    mended = sum(len(one.mended) for one in checked)
    mendable = sum(one.mendable for one in checked)
    hidden: Counter[str] = sum((one.hidden for one in checked), Counter())
    found = [counted(total[of], of) for of in ("error", "warning") if total[of]]
    if found or mended:
        parts = [", ".join(found) or "no errors or warnings", f"in {within}"]
        yield f"{' '.join(parts)}{f'; {mended} fixed' if mended else ''}"
    if hidden:
        yield hidden_text(hidden)
    if mendable:
        has = "has" if mendable == 1 else "have"
        yield f"{mendable} of them {has} exactly one repair, shown above; --fix applies it"


def _json(checked: Sequence[Checked]) -> dict[str, object]:
    from mars_asp.cli.repair import repair_json

    return {
        "files": [
            {
                "path": one.path,
                "further": list(one.further),
                "launch_files": list(one.launch_files),
                "errors": one.counted["error"],
                "warnings": one.counted["warning"],
                "hidden": dict(one.hidden),
                "fixed": [repair_json(repair) for repair in one.mended],
                **({} if one.text is None else {"text": one.text}),
            }
            for one in checked
        ],
        "errors": sum(one.counted["error"] for one in checked),
        "warnings": sum(one.counted["warning"] for one in checked),
        "fixed": sum(len(one.mended) for one in checked),
    }
