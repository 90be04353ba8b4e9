"""Findings as a log of the Static Analysis Results Interchange Format, version 2.1.0.

Numbers in comments are sections of that standard of OASIS,
https://docs.oasis-open.org/sarif/sarif/v2.1.0/sarif-v2.1.0.html.
"""

import hashlib
import os
import re
from collections.abc import Mapping, Sequence
from pathlib import PurePath
from typing import Any, TypeAlias
from urllib.parse import quote

from mars_asp import __version__
from mars_asp.asp.rules.rule import HOLE, Rule
from mars_asp.cli.results import Result, plain_text, seen_from_root, unique_rules
from mars_asp.diagnostic import Span
from mars_asp.output import visible
from mars_asp.reasoning.analysis import Consequence

_Json: TypeAlias = dict[str, Any]
_SCHEMA = (
    "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json"
)
#: What relative paths are relative to, by the name that GitHub and CodeQL use.
_ROOT = "%SRCROOT%"
#: The page of all findings, which has a heading for each kind.
_PAGE = "docs/reference/findings.md"


def sarif_log(results: Sequence[Result], status: int) -> _Json:
    """Return a log of one run that ends with an exit status."""
    rules = unique_rules(results)
    numbers = {code: number for number, code in enumerate(rules)}
    driver = {
        "name": "mars-asp",
        "version": __version__,
        "semanticVersion": __version__,
        "rules": [_descriptor(code, first) for code, first in rules.items()],
    }
    told = "what relative paths are relative to: the root of the repository, else the folder in use"
    run: _Json = {
        "tool": {"driver": driver},
        "invocations": [{"executionSuccessful": status < 2, "exitCode": status}],
        "originalUriBaseIds": {_ROOT: {"description": {"text": plain_text(told)}}},
        "columnKind": "unicodeCodePoints",
        "results": [_result(each, numbers) for each in results],
    }
    return {"$schema": _SCHEMA, "version": "2.1.0", "runs": [run]}


def _descriptor(code: str, first: Result) -> _Json:
    """Return what is known of the rule or check that found something (3.49)."""
    level = {"defaultConfiguration": {"level": first.diagnostic.severity}}
    if first.consequence is None:
        return {"id": code, "shortDescription": {"text": plain_text(_words(code))}, **level}
    kind, rule = first.consequence.kind, first.consequence.rule
    page = f"{_PAGE}#{kind}"
    why = {"fullDescription": {"text": plain_text(rule.why)}} if rule.why else {}
    return {
        "id": code,
        "name": kind,
        "shortDescription": {"text": plain_text(_words(kind))},
        **why,
        "help": _help(kind, rule, page),
        **level,
        "properties": {"kind": kind, "page": page},
    }


def _help(kind: str, rule: Rule, page: str) -> _Json:
    """Return what to do, as text and as Markdown, with the words that it fills in left open."""
    what = _unfilled(rule.because) or _words(kind)
    advice = _unfilled(rule.help)
    show = f"`mars-asp rules show {rule.id}` and {page} explain it."
    hide = f"To hide it: `mars: ignore[{kind}] reason` in a comment at the end of its line."
    parts = [plain_text(what), plain_text(rule.why), plain_text(advice), show, hide]
    return {
        "text": " ".join(filter(None, parts)),
        "markdown": "\n\n".join((f"# {kind}", *filter(None, parts))),
    }


def _unfilled(text: str | None) -> str | None:
    return text and HOLE.sub(lambda match: match[1] or "...", text)


def _words(name: str) -> str:
    return re.sub("[-_/]", " ", name)


def _result(result: Result, numbers: Mapping[str, int]) -> _Json:
    found, consequence = result.diagnostic, result.consequence
    advice = found.help and f"help: {found.help}"
    entry: _Json = {
        "ruleId": found.code,
        "ruleIndex": numbers[found.code],
        "level": found.severity,
        "message": {"text": plain_text(found.message, found.effect, advice)},
        "locations": [_location(found.span)] if result.has_file else [],
    }
    if not result.has_file:
        entry["message"]["text"] = f"{visible(found.span.path)}: {entry['message']['text']}"
    if found.labels:
        entry["relatedLocations"] = [
            _location(span, label) | {"id": number}
            for number, (span, label) in enumerate(found.labels, 1)
            if result.has_file
        ]
    if consequence is not None:
        entry["partialFingerprints"] = {"marsFinding/v1": _fingerprint(consequence)}
        entry["properties"] = {
            "kind": consequence.kind,
            "subject": visible(consequence.subject),
            "participants": [visible(each) for each in consequence.participants],
        }
    if result.is_new is not None:
        entry["baselineState"] = "new" if result.is_new else "unchanged"
    if result.hidden is not None:
        # Both are meant by whoever wrote them, so none is under review (3.35).
        kind = "inSource" if result.hidden.by == "comment" else "external"
        suppression = {"kind": kind, "status": "accepted"}
        if result.hidden.reason:
            suppression["justification"] = visible(result.hidden.reason)
        entry["suppressions"] = [suppression]
    return entry


def _location(span: Span, label: str = "") -> _Json:
    region: _Json = {"startLine": span.line, "startColumn": span.column}
    if span.end_line:
        region |= {"endLine": span.end_line, "endColumn": span.end_column}
    place = {"physicalLocation": {"artifactLocation": _artifact(span.path), "region": region}}
    return place | ({"message": {"text": plain_text(label)}} if label else {})


def _artifact(path: str) -> _Json:
    """Return where a file is, relative to the repository if it is in it (3.4)."""
    shown, is_below = seen_from_root(path)
    if is_below:
        return {"uri": quote(os.fsencode(shown)), "uriBaseId": _ROOT}
    return {"uri": PurePath(shown).as_uri()}


def _fingerprint(consequence: Consequence) -> str:
    """Return what stays the same of a finding when its lines move."""
    parts = (consequence.kind, consequence.subject, *consequence.participants)
    return hashlib.sha256("\0".join(parts).encode("utf-8", "surrogatepass")).hexdigest()[:32]
