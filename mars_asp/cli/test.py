"""Run cases: facts or configurations, and what the rules are expected to make of them."""

import argparse
import re
import shlex
import sys
import time
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.cli.arguments import add_flags
from mars_asp.cli.cases_report import CaseFileResult, junit, print_outcomes
from mars_asp.cli.deliver import replace_files, write_file
from mars_asp.cli.diagnostic_text import report
from mars_asp.cli.inputs import STANDARD_INPUT, print_settings
from mars_asp.cli.progress import detail
from mars_asp.cli.settings import check_settings, packs_for
from mars_asp.cli.worker import read_standard_input
from mars_asp.diagnostic import Diagnostic, MarsError, refusal
from mars_asp.language.parse import MOST_BYTES, decode, read_text, unreadable
from mars_asp.output import visible
from mars_asp.reading import overlay, overlay_bytes
from mars_asp.reasoning.cases import FoundCase, cases_of, run_case
from mars_asp.reasoning.cases.configurations import SNAPSHOT, SUFFIX, snapshot
from mars_asp.reasoning.packs import with_companions
from mars_asp.reasoning.rules import STAGES, load_rulebook

#: The header of a `.mars` file.
_HEADER = re.compile(r"(?m)^\s*@(configuration|specification)\b")


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("paths", nargs="*", default=["."], metavar="PATH")
    add_flags(parser, "--update", "--snapshot")
    parser.add_argument("--junit", metavar="FILE")
    add_flags(parser, "--watch", "--coverage", "--mutate")
    parser.add_argument("--jobs", type=_jobs, metavar="N")


def _jobs(text: str) -> int:
    if not text.isdecimal() or not 1 <= int(text) <= 1000:
        raise argparse.ArgumentTypeError(f"expected a number from 1 to 1000, found `{text}`")
    return int(text)


def run(arguments: argparse.Namespace) -> int:
    """Run the cases; return 1 if one failed or there are none.

    Raises:
        MarsError: rules or cases have errors.
    """
    check_settings(arguments)
    if STANDARD_INPUT in arguments.paths:
        return _run_with_input(arguments)
    if arguments.watch:
        from mars_asp.cli.cases_watch import watched

        return watched(run_once, arguments)
    return run_once(arguments)


def _run_with_input(arguments: argparse.Namespace) -> int:
    """Run the cases of standard input as a file, whose suffix follows from the text.

    Raises:
        MarsError: an option needs a file, or the rules or cases are wrong.
    """
    for option in ("update", "snapshot", "watch", "mutate"):
        if getattr(arguments, option):
            raise refusal("usage", "standard input cannot be changed", f"--{option}", None)
    text = decode(read_standard_input(MOST_BYTES + 1), "<stdin>")
    name = f"<stdin>{SUFFIX if _HEADER.search(text) else '.lp'}"
    arguments.paths = [name if path == STANDARD_INPUT else path for path in arguments.paths]
    with overlay({name: text}):
        return run_once(arguments)


def run_once(arguments: argparse.Namespace) -> int:
    """Run all cases, and update, measure or report them as requested.

    Raises:
        MarsError: rules or cases have errors.
    """
    rules = [Path(path) for path in arguments.rules]
    missing = [
        path
        for path in arguments.paths
        if overlay_bytes(Path(path)) is None and not Path(path).exists()
    ]
    unread = [
        CaseFileResult(Path(path), None, (unreadable(path, "no such file", _advice(path)),), 0.0)
        for path in missing
    ]
    if unread and arguments.snapshot:
        raise MarsError(problem for each in unread for problem in each.problems)
    there = [path for path in arguments.paths if path not in missing]
    found = cases_of(map(Path, there), rules)
    packs = {each: _packs_of(each, rules, arguments) for each in found}
    if arguments.snapshot:
        return _snapshot(packs, arguments)
    if there and not found:
        where = ", ".join(map(visible, there))
        message = f"no case in {where}: cases are `.lp` and `.mars` files with an expectation"
        print(f"mars-asp test: {message}", file=sys.stderr)
    loaded = {
        each: load_rulebook(each, STAGES, trusted=arguments.trust) for each in {*packs.values()}
    }
    books = {each: loaded[packs[each]] for each in found}
    ran = [*unread, *(_ran(each, books[each]) for each in found)]
    problems: list[Diagnostic] = [problem for each in ran for problem in each.problems]
    updated = _updated(ran) if arguments.update and not problems else {}
    # What an update leaves as it is may still fail; the files change when the command ends.
    with overlay({str(path): text for path, text in updated.items()}):
        again = {each.path: _ran(each, books[each]) for each in found if each.path in updated}
    ran = [again.get(each.path, each) for each in ran]
    if arguments.junit:
        write_file(arguments.junit, junit(ran))
    if problems and (arguments.update or not any(each.outcome for each in ran)):
        raise MarsError(dict.fromkeys(problems))
    # The other cases are run even if one has errors.
    report(dict.fromkeys(problems), arguments)
    print_settings(arguments, *(each.path.parent for each in ran))
    for each in ran:
        detail(arguments, f"{each.path}: {each.seconds:.2f} s")
    outcomes = [each.outcome for each in ran if each.outcome is not None]
    all_pass = all(outcome.passed for outcome in outcomes)
    if arguments.mutate and not all_pass:
        print("mars-asp test: mutants are tried when all cases pass", file=sys.stderr)
    arguments.mutate = arguments.mutate and all_pass
    result, lines, status = _measured(books, arguments)
    wrong = sum(each.outcome is None for each in ran)
    print_outcomes(outcomes, arguments, result, lines, updated, wrong)
    kept = [str(each.path) for each in outcomes if not each.passed and _has_snapshot(each.path)]
    if arguments.update and kept:
        way = visible(shlex.join(["mars-asp", "test", "--snapshot", *kept]))
        print(f"mars-asp test: to replace all lines of a snapshot: {way}", file=sys.stderr)
    elif arguments.update and not all_pass:
        advice = "delete lines that no longer hold: --update leaves what must be there, or must not"
        print(f"mars-asp test: {advice}", file=sys.stderr)
    if problems:
        return 2
    return max(int(not all_pass or not outcomes), status)


def _has_snapshot(path: Path) -> bool:
    return path.suffix == SUFFIX and SNAPSHOT in read_text(path)


def _advice(path: str) -> str | None:
    """Return how to run the cases that a path may mean: those of one line, or of one title."""
    file = path.partition(":")[0]
    if file != path and Path(file).exists():
        way = visible(shlex.join(["mars-asp", "test", file]))
        return f"name the file, all of whose cases are run: `{way}`"
    return None if Path(path).parent.name or "." in path else "name files or folders of cases"


def _packs_of(
    found: FoundCase, rules: Sequence[Path], arguments: argparse.Namespace
) -> tuple[Path, ...]:
    """Return the packs of a case: those given, or of the settings of a robot, and its own."""
    is_robot = found.pack is None and found.path.suffix == SUFFIX
    own = () if found.pack is None else with_companions(found.pack)
    return (*(rules or (packs_for(arguments, found.path.parent) if is_robot else ())), *own)


def _snapshot(found: Mapping[FoundCase, tuple[Path, ...]], arguments: argparse.Namespace) -> int:
    """Write the current results of robots into their files as the expected ones.

    Raises:
        MarsError: a file is not a robot, or has errors.
    """
    robots = [each for each in found if each.path.suffix == SUFFIX]
    named = {Path(path) for path in arguments.paths}
    others = [each.path for each in found if each.path in named and each not in robots]
    if others or not robots:
        place = str(others[0]) if others else arguments.paths[0]
        advice = "name `.mars` files; facts are updated by --update"
        message = "a snapshot is of a robot"
        if Path(place).is_dir():
            message = "no robot in the folder has a snapshot yet, nor another expectation"
        raise refusal("case", message, place, advice)
    written = []
    for each in robots:
        text = snapshot(each.path, load_rulebook(found[each], STAGES, trusted=arguments.trust))
        before = each.path.read_bytes()
        written.append((str(each.path), text.encode(), before))
    replace_files(written)
    if not arguments.quiet:
        for path, _, _ in written:
            print(f"wrote {visible(path)}")
    return 0


def _ran(found: FoundCase, rulebook: Rulebook) -> CaseFileResult:
    begun = time.monotonic()
    try:
        outcome, problems = run_case(found.path, rulebook), ()
    except MarsError as error:
        return CaseFileResult(found.path, None, error.diagnostics, time.monotonic() - begun)
    return CaseFileResult(found.path, outcome, problems, time.monotonic() - begun)


def _measured(
    books: Mapping[FoundCase, Rulebook], arguments: argparse.Namespace
) -> tuple[Mapping[str, object], Sequence[str], int]:
    """Return the results of `--coverage` and `--mutate` as JSON and as lines, and the status."""
    if not arguments.coverage and not arguments.mutate:
        return {}, (), 0
    from mars_asp.cli.cases_measure import measured

    return measured(books, arguments)


def _updated(ran: Iterable[CaseFileResult]) -> Mapping[Path, str]:
    """Write the actual results into the case files, all or none; return the changed texts."""
    outcomes = [each.outcome for each in ran if each.outcome is not None]
    new = {each.path: each.updated for each in outcomes if each.updated is not None}
    if new:
        replace_files([(str(p), text.encode(), p.read_bytes()) for p, text in new.items()])
    return new
