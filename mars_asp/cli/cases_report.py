"""Outcomes of cases as text, as JSON and as JUnit XML."""

import argparse
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree

from mars_asp.asp.cases import Check, Failure, Outcome
from mars_asp.asp.cases.outcomes import difference
from mars_asp.cli.encode import encoded
from mars_asp.cli.lines import location_json
from mars_asp.diagnostic import Diagnostic
from mars_asp.output import counted, visible


class CaseFileResult(NamedTuple):
    """The result of a case file, or the problems of reading it, and the seconds it took."""

    path: Path
    outcome: Outcome | None
    problems: Sequence[Diagnostic]
    seconds: float


def print_outcomes(
    outcomes: Sequence[Outcome],
    arguments: argparse.Namespace,
    measured: Mapping[str, object],
    lines: Iterable[str],
    updated: Iterable[Path] = (),
    wrong: int = 0,
) -> None:
    """Print the failed cases with expected and actual results, and the numbers of cases.

    `measured` holds further results for JSON, and `lines` the same results as text; `updated` are
    the files with new expectations, `wrong` is how many could not be run.
    """
    checks = [(outcome, check) for outcome in outcomes for check in outcome.checks]
    failed = sum(not check.passed for _, check in checks)
    passed = len(checks) - failed
    if arguments.format == "json":
        listed = [_check_json(outcome, check) for outcome, check in checks]
        numbers = {"passed": passed, "failed": failed, "errors": wrong}
        print(encoded({**numbers, "cases": listed, **measured}))
        return
    for outcome, check in checks:
        if not check.passed:
            title = "" if check.title is None else f": {check.title}"
            print(f"FAILED {visible(f'{outcome.path}{title}')}")
            for line in _failure_lines(check):
                print(line)
    if not arguments.quiet:
        for path in updated:
            print(f"wrote {visible(str(path))}")
        errors = f", {counted(wrong, 'file')} not run" if wrong else ""
        print(f"{passed} passed, {failed} failed{errors}")
    for line in lines:
        print(line)


def _failure_lines(check: Check) -> Iterator[str]:
    for failure in check.failures:
        is_atom = failure.expected.startswith("`") and not failure.lines
        found = ", and it is not there" if is_atom else ""
        yield f"  {visible(failure.span.location)}: expected {visible(failure.expected)}{found}"
        yield from map(visible, failure.lines)


def _check_json(outcome: Outcome, check: Check) -> dict[str, object]:
    return {
        "path": str(outcome.path),
        "passed": check.passed,
        "difference": list(difference(check)),
        "title": check.title,
        "line": check.span.line,
        "failures": [_failure_json(failure) for failure in check.failures],
    }


def _failure_json(failure: Failure) -> dict[str, object]:
    return {
        **location_json(failure.span),
        "expected": failure.expected,
        "found": list(failure.found),
        "nearest": failure.nearest,
    }


def junit(ran: Iterable[CaseFileResult]) -> bytes:
    """Return outcomes as JUnit XML, one suite for each folder."""
    folders: dict[str, list[CaseFileResult]] = {}
    for each in ran:
        folders.setdefault(str(each.path.parent), []).append(each)
    root = ElementTree.Element("testsuites", name="mars-asp")
    for folder, files in folders.items():
        suite = ElementTree.SubElement(root, "testsuite", name=visible(folder))
        for each in files:
            _cases(suite, each)
        found = list(suite)
        suite.set("tests", str(len(found)))
        suite.set("failures", str(sum(case.find("failure") is not None for case in found)))
        suite.set("errors", str(sum(case.find("error") is not None for case in found)))
        suite.set("time", f"{sum(each.seconds for each in files):.3f}")
    ElementTree.indent(root)
    written: bytes = ElementTree.tostring(root, encoding="utf-8", xml_declaration=True)
    return written + b"\n"


def _cases(suite: ElementTree.Element, ran: CaseFileResult) -> None:
    path, seconds = visible(str(ran.path)), f"{ran.seconds:.3f}"
    classname = visible(str(ran.path.parent)).replace("/", ".")
    if ran.outcome is None:
        case = ElementTree.SubElement(
            suite, "testcase", name=visible(ran.path.name), classname=classname, file=path
        )
        for problem in ran.problems:
            text = f"{problem.span}: {problem.message}"
            ElementTree.SubElement(case, "error", message=visible(text))
        return
    for check in ran.outcome.checks:
        title = ran.path.name if check.title is None else f"{ran.path.name}: {check.title}"
        case = ElementTree.SubElement(
            suite,
            "testcase",
            name=visible(title),
            classname=classname,
            file=path,
            line=str(check.span.line),
            time=seconds,
        )
        if not check.passed:
            first = check.failures[0]
            message = f"{first.span}: expected {first.expected}"
            failure = ElementTree.SubElement(case, "failure", message=visible(message))
            failure.text = "\n".join(_failure_lines(check))
