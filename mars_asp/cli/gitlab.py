"""Findings as a code quality report of GitLab, which shows them in merge requests."""

import hashlib
import json
from collections import Counter
from collections.abc import Iterable
from pathlib import Path

from mars_asp.cli.baseline import BaselineEntry, known_of
from mars_asp.cli.results import Result, root_of, seen_from_root
from mars_asp.output import visible


def code_quality_report(findings: Iterable[Result]) -> list[dict[str, object]]:
    """Return an entry for each finding; paths are relative to the repository."""
    alike: Counter[BaselineEntry] = Counter()
    return [_entry(each, alike) for each in findings]


def _entry(finding: Result, alike: Counter[BaselineEntry]) -> dict[str, object]:
    found = finding.diagnostic
    path = seen_from_root(found.span.path)[0] if finding.has_file else found.span.path
    severity = {"error": "critical", "warning": "major", "note": "info"}[found.severity]
    # An error of the input hides the findings of its robot.
    if found.severity == "error" and found.kind is None:
        severity = "blocker"
    return {
        "description": visible(found.message),
        "check_name": visible(found.kind or found.code),
        "fingerprint": _fingerprint(finding, alike),
        "severity": severity,
        "location": {"path": visible(path), "lines": {"begin": max(1, found.span.line)}},
    }


def _fingerprint(finding: Result, alike: Counter[BaselineEntry]) -> str:
    """Return a digest of a finding that stays the same when lines move.

    It covers its baseline entry, and its number among equal entries, counted in `alike`.
    """
    baseline = str(root_of(Path.cwd()) / "baseline.json")
    known = known_of(finding.consequence or finding.diagnostic, baseline)
    text = json.dumps([*known, alike[known]])
    alike[known] += 1
    return hashlib.sha256(text.encode()).hexdigest()
