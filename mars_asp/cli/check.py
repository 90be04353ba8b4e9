"""Parse, extract and analyse; print errors and warnings, and nothing else."""

import argparse
import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from functools import cache, partial
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.cli.arguments import add_flags, misuse
from mars_asp.cli.check_output import (
    FORMATS,
    TEXT_FORMATS,
    Checked,
    leave_out_repeats,
    left_out_text,
    new_warning_lines,
    nothing_fixed,
    write_report,
)
from mars_asp.cli.deliver import (
    file_key,
    replace_files,
    write_closing,
    write_obstacle,
    write_result,
)
from mars_asp.cli.diagnostic_text import Suggestion, report
from mars_asp.cli.excluded import add_exclusion
from mars_asp.cli.fmt import unified_diff
from mars_asp.cli.folding import instances_of
from mars_asp.cli.inputs import (
    JUDGING,
    STANDARD_INPUT,
    add_launch,
    add_stdin_filename,
    check_inputs,
    judge_project,
    load,
    packs_of,
    robots,
    shown_input,
    unapplied_packs,
)
from mars_asp.cli.lines import forget, remember
from mars_asp.cli.progress import progress_bar
from mars_asp.cli.results import Result, results_of
from mars_asp.cli.schemas import add_schema, schema_text
from mars_asp.cli.selection import Selection, add_selection
from mars_asp.cli.settings import SETTINGS
from mars_asp.cli.worker import read_standard_input
from mars_asp.diagnostic import NOT_READ, Diagnostic, MarsError, Severity, whole_file
from mars_asp.language.parse import MOST_BYTES, decode, plain_lines
from mars_asp.language.text_edits import ConflictError, edited_bytes
from mars_asp.output import counted
from mars_asp.reading import OUTSIDE, decoded, is_hidden
from mars_asp.reasoning.packs import MANIFEST
from mars_asp.reasoning.rules import load_rulebook

if TYPE_CHECKING:
    from mars_asp.reasoning.analysis import Analysis
    from mars_asp.reasoning.project import Project
    from mars_asp.reasoning.questions.fix import AppliedFix
    from mars_asp.reasoning.questions.repair import Repair

    _Seen: TypeAlias = Callable[[Project, Analysis], None]

#: The formats of the result.
RESULT_FORMATS = FORMATS
_Rules: TypeAlias = Callable[[tuple[str, ...]], Rulebook]
#: The severities that make the exit status 1, by the values of `--fail-on`.
_FAILING: Mapping[str, tuple[Severity, ...]] = {
    "error": ("error",),
    "warning": ("error", "warning"),
    "never": (),
}
#: Repairs of larger robots take longer than users wait for a check.
_MOST_FACTS, _MOST_SOLVED = 2_000, 20_000


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("files", metavar="PATH", nargs="*", default=["."])
    add_flags(parser, "--fix")
    parser.add_argument("--fail-on", choices=tuple(_FAILING), default="error")
    add_flags(parser, "--exit-zero", "--statistics")
    parser.add_argument("-o", "--output", metavar="OUT")
    add_schema(parser, "the document of --format json", partial(schema_text, "check"))
    add_flags(parser, "--diff")
    add_stdin_filename(parser)
    add_launch(parser)
    add_exclusion(parser)
    add_selection(parser)


def run(arguments: argparse.Namespace) -> int:
    """Report the findings; return 1 if one reaches `--fail-on`, 2 if a file cannot be read."""
    if problem := _conflict_of_options(arguments):
        return misuse("check", problem)
    arguments.fix |= arguments.diff
    if arguments.exit_zero:
        arguments.fail_on = "never"
    try:
        checked, remarks = check(arguments)
        status = max((one.status for one in checked), default=0)
        if arguments.diff:
            return _show_changes(checked, arguments, status)
    except MarsError as error:
        # Nothing was checked: settings are wrong, the values of options, or files that they name.
        is_finding = _are_of_settings(error, arguments) and not arguments.diff
        if arguments.format in TEXT_FORMATS and not is_finding:
            report(error.diagnostics, arguments)
            return error.status
        checked, remarks, status = [], [Result(each) for each in error.diagnostics], error.status
    unwritten = [
        each
        for each in remarks
        if each.diagnostic.span.path == arguments.write_baseline
        and each.diagnostic.severity == "error"
        and arguments.format in TEXT_FORMATS
        and arguments.write_baseline != STANDARD_INPUT
    ]
    remarks = [each for each in remarks if each not in unwritten]
    write_report(checked, remarks, arguments, status)
    report((each.diagnostic for each in unwritten), arguments)
    return status


def _show_changes(checked: Sequence[Checked], arguments: argparse.Namespace, status: int) -> int:
    """Print the changes that --fix would make as a unified diff, and errors of the input.

    Returns:
        2 for bad input, else 1 if there is a change.
    """
    changes = [
        unified_diff(path, decode(old, path), decode(new, path))
        for one in checked
        for path, new, old in one.written
    ]
    changes += [one.change for one in checked if one.change]
    write_result(arguments.output or "-", "".join(changes))
    messages = (each.diagnostic for one in checked for each in one.results if not each.consequence)
    is_wrong = status >= 2
    report([each for each in messages if is_wrong or each.code == "unfixed"], arguments)
    if not arguments.quiet:
        repairs = sum(len(one.mended) for one in checked)
        within = f" in {counted(len(changes), 'file')}" if changes else ""
        left_out = sum(one.left_out for one in checked)
        further = f"; {left_out_text(left_out)}" if left_out else ""
        summary = f"{counted(repairs, 'finding')} would be fixed{within}{further}\n"
        choice = (f"{each}\n" for each in nothing_fixed(checked, arguments))
        write_closing("".join((summary, *new_warning_lines(checked), *choice)))
    return status if is_wrong else int(bool(changes))


def _conflict_of_options(arguments: argparse.Namespace) -> str | None:
    """Return the message that options contradict each other, or None."""
    if arguments.stdin_filename and STANDARD_INPUT not in arguments.files:
        return "--stdin-filename names the text of `-`: add `-`"
    if arguments.diff and (arguments.format not in TEXT_FORMATS or arguments.statistics):
        option = "--statistics" if arguments.statistics else f"`--format {arguments.format}`"
        return f"--diff prints a unified diff: leave out {option}, or --diff"
    if arguments.fix and arguments.format not in (*TEXT_FORMATS, "json"):
        return f"--fix prints what it changed: leave out `--format {arguments.format}`, or --fix"
    if arguments.statistics and arguments.format not in TEXT_FORMATS:
        return f"--statistics prints lines: leave out `--format {arguments.format}`"
    return None


def check(
    arguments: argparse.Namespace, seen: "_Seen" = lambda project, analysis: None
) -> tuple[list[Checked], list[Result]]:
    """Check the files of a call; return the results of each robot, and remarks on the selection.

    `seen` is called with each robot that could be read and its analysis.

    Raises:
        MarsError: rule packs, settings, a baseline or the values of options are wrong.
    """
    check_inputs(*arguments.files)
    load_rules = cache(partial(load_rulebook, trusted=arguments.trust))
    found = robots(arguments, _each_once(arguments.files))
    # The folder of each robot has its own settings and pack.
    commands = [argparse.Namespace(**vars(arguments) | {"files": robot.paths}) for robot in found]
    packs = tuple(packs_of(arguments))
    rulebooks = {packs: load_rules(packs, JUDGING)}
    for command in commands:
        # Errors are reported with the robot.
        with suppress(MarsError):
            packs = tuple(packs_of(command))
            rulebooks[packs] = load_rules(packs, JUDGING)
    selection = Selection(arguments, *rulebooks.values())
    checked = []
    edited: dict[object, tuple[str, bytes]] = {}
    of_settings: set[Diagnostic] = set()
    for robot, command in zip(found, commands, strict=True):
        name, *further = robot.paths
        is_input = name == STANDARD_INPUT
        one = Checked(arguments.stdin_filename or name if is_input else name, tuple(further))
        checked.append(one)
        try:
            if robot.problems:
                raise MarsError(robot.problems)
            rules = partial(load_rules, tuple(packs_of(command)))
            _check(one, is_input, rules, selection, command, edited, seen)
        except MarsError as error:
            if all(each.span.path.startswith("--") for each in error.diagnostics):
                raise
            # Many robots share settings, packs and named sources: report each of their errors once.
            new = (each for each in error.diagnostics if each not in of_settings)
            one.append_results(map(Result, new))
            if _are_of_settings(error, arguments):
                of_settings.update(error.diagnostics)
            shared = (*arguments.sources, MANIFEST, ".lp")
            of_settings.update(e for e in error.diagnostics if e.span.path.endswith(shared))
            one.status = 2
        one.append_results(map(Result, robot.notes))
    if arguments.format != "junit":
        leave_out_repeats(checked)
    for one in checked:
        if one.written and not arguments.diff:
            replace_files(one.written)
    remarks = map(Result, selection.end(all(one.status < 2 for one in checked)))
    return checked, list(remarks)


def _are_of_settings(error: MarsError, arguments: argparse.Namespace) -> bool:
    """Whether all problems are in a file with settings, or in the baseline of an option."""
    names = (*SETTINGS, Path(arguments.config or SETTINGS[0]).name)
    return all(
        Path(each.span.path).name in names
        or (each.span.path == arguments.baseline and each.code in ("baseline", "encoding"))
        for each in error.diagnostics
    )


def _each_once(names: Iterable[str]) -> list[str]:
    """Return the names without those of files that an earlier name has as well."""
    first: dict[str, str] = {}
    for name in names:
        first.setdefault(name if name == STANDARD_INPUT else os.path.realpath(name), name)
    return list(first.values())


def _check(
    one: Checked,
    is_input: bool,
    rules: _Rules,
    selection: Selection,
    arguments: argparse.Namespace,
    edited: dict[object, tuple[str, bytes]],
    seen: "_Seen",
) -> None:
    """Read and judge the robot `one`, from standard input if `is_input`.

    Raises:
        MarsError: its files or sources are wrong.
    """
    # Repairs print all of the text, also if it is too large to read.
    most = -1 if arguments.fix else MOST_BYTES + 1
    raw = read_standard_input(most) if is_input else None
    one.text = raw if arguments.fix else None
    path = shown_input(arguments) if raw is not None else one.path
    text = None if raw is None else decode(raw, path)
    project = _readable(one, [path, *one.further], text, arguments)
    judge(one, project, rules, selection, arguments, raw, edited, seen)


def _readable(
    one: Checked, paths: Sequence[str], text: str | None, arguments: argparse.Namespace
) -> "Project":
    """Read the files of the robot `one`; of several the others, if some have errors.

    Raises:
        MarsError: none of the files can be read.
    """
    try:
        return load(arguments, paths[0], text, paths[1:])
    except MarsError as error:
        wrong = {each.span.path for each in error.diagnostics}
        others = [path for path in paths if path not in wrong]
        if not others or len(others) == len(paths):
            raise
        project = _readable(one, others, text, arguments)
        one.append_results(map(Result, error.diagnostics))
        one.status = 2
        return project


def judge(
    one: Checked,
    project: "Project",
    rules: _Rules,
    selection: Selection,
    arguments: argparse.Namespace,
    raw: bytes | None = None,
    edited: dict[object, tuple[str, bytes]] | None = None,
    seen: "_Seen" = lambda project, analysis: None,
    with_participants: bool = False,
) -> None:
    """Add the findings in a project to `one`; with `--fix`, apply repairs as `_fix` does.

    `raw` is the content of standard input if it was read. `rules` loads the rules of stages,
    `edited` is that of `_fix`, and `seen` is called with the analysis.

    Raises:
        MarsError: rule packs, settings or a baseline are wrong.
    """
    one.launch_files = tuple(tree.path for tree in project.trees)
    analysis = judge_project(project, rules(JUDGING), arguments)
    seen(project, analysis)
    known = selection.unused() if arguments.fix else {}
    selected = selection.of(project, analysis, False, with_participants)
    sole: tuple[Repair, ...] = ()
    is_small = arguments.fix or len(analysis.facts) <= _MOST_FACTS
    shows_repairs = arguments.format != "github"
    if project.format is None and selected.shown and is_small and shows_repairs:
        shown = {(each.spans, each.message) for each in selected.shown}
        found = _sole_repairs(project, rules, arguments)
        sole = tuple(r for r in found if (r.consequence.spans, r.consequence.message) in shown)
    if sole and arguments.fix:
        fixed = _fix(project, sole, rules, raw, one, {} if edited is None else edited)
        if fixed is not None:
            project, sole = fixed.project, ()
            for path, text in fixed.texts.items():
                remember(path, text)
            analysis = judge_project(project, rules(JUDGING), arguments)
            selection.restore(known)
            selected = selection.of(project, analysis, False, with_participants)
    one.mendable = 0 if arguments.fix else len(sole)
    messages, hidden = selection.messages(project, unapplied_packs(project, rules(JUDGING)))
    one.hidden.update(hidden)
    unread = [d for d in messages if d.code == NOT_READ]
    one.append_results(Result(d) for d in messages if d.code != NOT_READ)
    if not project.trees:
        # The rules themselves fold findings of launch trees.
        one.instances = instances_of(project.configuration)
    one.append_results(_with_suggestions(results_of(selected), sole))
    one.append_results(map(Result, unread))
    # Until all robots are checked, others that include the file are judged by its old content.
    for path, _, _ in one.written:
        forget(path)
    if project.format is not None and arguments.fix and selected.shown:
        note = _unfixed(project.configuration.path, _FOREIGN, _BY_HAND, "note")
        one.append_results([Result(note)])
    failing = _FAILING[arguments.fail_on]
    one.status = max(one.status, int(any(one.counted[severity] for severity in failing)))


def _sole_repairs(
    project: "Project", rules: _Rules, arguments: argparse.Namespace
) -> "tuple[Repair, ...]":
    from mars_asp.reasoning.questions.fix import sole_repairs
    from mars_asp.reasoning.questions.repair import MOST_FACTS, STAGES

    most = MOST_FACTS if arguments.fix else _MOST_SOLVED
    with progress_bar(arguments, "sets of edits") as progress:
        return sole_repairs(project, rules(STAGES), arguments.time_limit, progress, most)


def _with_suggestions(results: Iterable[Result], sole: "Iterable[Repair]") -> Iterator[Result]:
    """Yield results; the findings of the repairs `sole` get them as suggestions."""
    mends = {(r.consequence.spans, r.consequence.message): r.mends[0] for r in sole}
    for each in results:
        found = each.consequence
        mend = mends.get((found.spans, found.message)) if found and not each.hidden else None
        if mend is None:
            yield each
            continue
        warnings = (*(w.message for w in mend.warnings), *(r.message for r in mend.remarks))
        edits = "; ".join(edit.message for edit in mend.edits)
        yield each._replace(suggestion=Suggestion(edits, mend.lines, warnings))


def _fix(
    project: "Project",
    sole: "Sequence[Repair]",
    rules: _Rules,
    raw: bytes | None,
    one: Checked,
    edited: dict[object, tuple[str, bytes]],
) -> "AppliedFix | None":
    """Apply repairs to files; return None if none could be applied or a file cannot be changed.

    The files are written at the end, all of a robot or none. `edited` maps the identity of each
    file to the robot that changes it and the new content; robots that share a file have to agree
    on the content.
    """
    from mars_asp.reasoning.questions.fix import fix
    from mars_asp.reasoning.questions.repair import STAGES

    fixed = fix(project, rules(STAGES), sole)
    if fixed is None:
        return None
    problems: list[Diagnostic] = []
    for path, text in fixed.texts.items():
        is_input = raw is not None and path == project.configuration.path
        try:
            old = raw if raw is not None and is_input else Path(path).read_bytes()
            new = edited_bytes(old, [line for line in fixed.lines if line.path == path])
            if plain_lines(decoded(new)).rstrip("\n") != text.rstrip("\n"):
                raise ConflictError
        except (OSError, ConflictError):
            problems.append(_unfixed(path, "it is not what was analysed"))
            continue
        if is_input:
            one.change = unified_diff(path, decode(old, path), decode(new, path))
            one.text = new
        elif is_hidden(path):
            problems.append(_unfixed(path, OUTSIDE))
        elif obstacle := write_obstacle(path):
            problems.append(_unfixed(path, obstacle))
        elif (other := edited.get(file_key(path), (one.path, new)))[1] != new:
            problems.append(_unfixed(path, f"it is changed for `{other[0]}`", _AGAIN))
        elif file_key(path) not in edited:
            one.written.append((path, new, old))
    if problems:
        one.status = 2
        one.written.clear()
        one.text = raw
        one.append_results(map(Result, problems))
        return None
    edited.update((file_key(path), (one.path, new)) for path, new, _ in one.written)
    one.mended = fixed.repairs
    one.left_out, one.new_warnings = len(fixed.left_out), fixed.warnings
    return fixed


#: Why files in other formats stay as they are.
_FOREIGN = "repairs are edits of `.mars` files"
_BY_HAND = "change it by hand, as the help of each finding suggests"
_AGAIN = "run the command again"


def _unfixed(
    path: str, why: str, help_text: str | None = None, severity: Severity = "error"
) -> Diagnostic:
    message = f"`{path}` was not fixed: {why}"
    return Diagnostic("unfixed", severity, message, whole_file(path), help=help_text)
