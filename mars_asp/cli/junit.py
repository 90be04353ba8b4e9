"""Findings as JUnit XML: a suite for each robot, a failed case for each finding."""

from collections.abc import Sequence
from xml.etree import ElementTree

from mars_asp.cli.results import Result
from mars_asp.output import visible


def junit_suites(robots: Sequence[tuple[str, Sequence[Result]]]) -> str:
    """Return JUnit XML with a suite for each robot; one without findings is a passed case."""
    root = ElementTree.Element("testsuites", name="mars-asp check")
    for name, findings in robots:
        number = str(len(findings))
        suite = ElementTree.SubElement(
            root,
            "testsuite",
            name=visible(name),
            tests=str(max(1, len(findings))),
            failures=number,
            errors="0",
        )
        for finding in findings:
            _add_failure(suite, finding)
        if not findings:
            shown = visible(name)
            ElementTree.SubElement(suite, "testcase", name=shown, classname="check", file=shown)
    ElementTree.indent(root)
    text: str = ElementTree.tostring(root, encoding="unicode")
    return f'<?xml version="1.0" encoding="utf-8"?>\n{text}\n'


def _add_failure(suite: ElementTree.Element, finding: Result) -> None:
    found = finding.diagnostic
    kind, span = visible(found.kind or found.code), found.span
    message = visible(found.message)
    case = ElementTree.SubElement(
        suite,
        "testcase",
        name=message,
        classname=kind,
        file=visible(span.path),
    )
    if span.line:
        case.set("line", str(span.line))
    failure = ElementTree.SubElement(case, "failure", type=kind, message=message)
    place = f"{span.location}: {found.severity}: {found.message}"
    parts = (place, found.effect, found.help and f"help: {found.help}")
    failure.text = "\n".join(visible(part) for part in parts if part)
