"""Findings as a log of the Static Analysis Results Interchange Format, version 2.1.0.

Numbers in comments are sections of the standard by OASIS,
https://docs.oasis-open.org/sarif/sarif/v2.1.0/sarif-v2.1.0.html.
"""

import hashlib
import os
import re
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path, PurePath
from typing import Any, TypeAlias
from urllib.parse import quote

from mars_asp import __version__
from mars_asp.asp.rules.rule import HOLE, Rule
from mars_asp.cli.baseline import known_of
from mars_asp.cli.diagnostic_text import Suggestion
from mars_asp.cli.lines import lines_of
from mars_asp.cli.results import Result, root_of, seen_from_root
from mars_asp.diagnostic import Span
from mars_asp.language.text_edits import LineEdit, common_length
from mars_asp.output import visible

_Json: TypeAlias = dict[str, Any]
_SCHEMA = (
    "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json"
)
#: The base of relative paths, by the name that GitHub and CodeQL use.
_ROOT = "%SRCROOT%"
#: The help of results without a rule.
_HELP_OF_CHECKS = "`mars-asp check --help` explains the options that choose what is reported"


def sarif_log(results: Sequence[Result], status: int) -> _Json:
    """Return a log of one run that ends with an exit status."""
    found = [each for each in results if not each.is_of_command]
    rules: dict[str, Result] = {}
    for each in found:
        rules.setdefault(each.diagnostic.code, each)
    numbers = {code: number for number, code in enumerate(rules)}
    driver = {
        "name": "mars-asp",
        "version": __version__,
        "semanticVersion": __version__,
        "rules": [_descriptor(code, first) for code, first in rules.items()],
    }
    text = "what relative paths are relative to: the root of the repository, else the folder in use"
    run: _Json = {
        "tool": {"driver": driver},
        "invocations": [_invocation(results, status)],
        "originalUriBaseIds": {_ROOT: {"description": {"text": plain_text(text)}}},
        "columnKind": "unicodeCodePoints",
        "results": [_result(each, numbers) for each in found],
    }
    return {"$schema": _SCHEMA, "version": "2.1.0", "runs": [run]}


def _invocation(results: Iterable[Result], status: int) -> _Json:
    """Return the end of a run, with the errors in the words of its command (3.20)."""
    wrong = [
        {
            "level": each.diagnostic.severity,
            "message": {"text": _marked(_message_text(each))},
            "descriptor": {"id": each.diagnostic.code},
        }
        for each in results
        if each.is_of_command
    ]
    ended: _Json = {"executionSuccessful": status < 2, "exitCode": status}
    return ended | ({"toolConfigurationNotifications": wrong} if wrong else {})


def _descriptor(code: str, first: Result) -> _Json:
    """Return the descriptor of a rule or check; `first` is its first result (3.49)."""
    level = {"defaultConfiguration": {"level": first.diagnostic.severity}}
    if first.consequence is None:
        # GitHub requires a description and help for each descriptor.
        short, advice = plain_text(_spaced_words(code)), first.diagnostic.help or _HELP_OF_CHECKS
        return {
            "id": code,
            "shortDescription": {"text": short},
            "fullDescription": {"text": short},
            "help": {"text": plain_text(advice)},
            **level,
        }
    kind, rule = first.consequence.kind, first.consequence.rule
    return {
        "id": code,
        "name": kind,
        "shortDescription": {"text": plain_text(_spaced_words(kind))},
        "fullDescription": {"text": plain_text(rule.why or _spaced_words(kind))},
        "help": _help(kind, rule),
        **level,
        "properties": {"kind": kind, "command": f"mars-asp rules show {kind}"},
    }


def _help(kind: str, rule: Rule) -> _Json:
    """Return the help of a rule as text and as Markdown, with its holes unfilled."""
    what = _unfilled(rule.because) or _spaced_words(kind)
    advice = _unfilled(rule.help)
    show = f"`mars-asp rules show {rule.id}` explains it."
    hide = f"To hide it: `mars: ignore[{kind}] reason` in a comment at the end of its line."
    parts = [plain_text(what), plain_text(rule.why), plain_text(advice), show, hide]
    return {
        "text": " ".join(filter(None, parts)),
        "markdown": "\n\n".join((f"# {kind}", *filter(None, parts))),
    }


def _unfilled(text: str | None) -> str | None:
    return text and HOLE.sub(lambda match: match[1] or "...", text)


def _spaced_words(name: str) -> str:
    return re.sub("[-_/]", " ", name)


def _result(result: Result, numbers: Mapping[str, int]) -> _Json:
    found, consequence = result.diagnostic, result.consequence
    entry: _Json = {
        "ruleId": found.code,
        "ruleIndex": numbers[found.code],
        "level": found.severity,
        "message": {"text": _marked(_message_text(result))},
        "locations": [_location(found.span)] if result.has_file else [],
    }
    if found.labels and result.has_file:
        # A related location is shown where the message has a link to it, as on GitHub (3.11.6).
        words = (
            visible(label) or f"{PurePath(span.path).name}, line {span.line}"
            for span, label in found.labels
        )
        escaped = (re.sub(r"[\\\[\]]", r"\\\g<0>", each) for each in words)
        links = ", ".join(f"[{each}]({number})" for number, each in enumerate(escaped, 1))
        entry["message"]["text"] += f" See {links}."
        entry["relatedLocations"] = [
            _location(span, label) | {"id": number}
            for number, (span, label) in enumerate(found.labels, 1)
        ]
    if result.suggestion is not None and result.has_file:
        entry |= _fixes(result.suggestion)
    if consequence is not None:
        # The fingerprint stays when lines move, and from whichever folder the file is named.
        known = known_of(consequence, str(root_of(Path.cwd()) / "baseline.json"))
        parts = (known.kind, known.subject, *known.participants)
        digest = hashlib.sha256("\0".join(parts).encode("utf-8", "surrogatepass")).hexdigest()
        entry["partialFingerprints"] = {"marsFinding/v1": digest[:32]}
        entry["properties"] = {
            "kind": consequence.kind,
            "subject": visible(consequence.subject),
            "participants": [visible(each) for each in consequence.participants],
        }
    if result.is_new is not None:
        entry["baselineState"] = "new" if result.is_new else "unchanged"
    if result.hidden is not None:
        # Their authors intend both kinds, so none is under review (3.35).
        kind = "inSource" if result.hidden.by == "comment" else "external"
        suppression = {"kind": kind, "status": "accepted"}
        if result.hidden.reason:
            suppression["justification"] = visible(result.hidden.reason)
        entry["suppressions"] = [suppression]
    return entry


def _message_text(result: Result) -> str:
    """Return the subject, the message, the effect and the help of a result."""
    found = result.diagnostic
    text = plain_text(found.message, found.effect, found.help and f"help: {found.help}")
    return text if result.has_file else f"{visible(found.span.path)}: {text}"


def _marked(text: str) -> str:
    """Return a text with escaped brackets, so that no link begins in it (3.11.6)."""
    return re.sub(r"[\[\]]", r"\\\g<0>", text)


def _location(span: Span, label: str = "") -> _Json:
    # GitHub shows a result at a line, so a result about a whole file is at the first line.
    region: _Json = {"startLine": max(1, span.line), "startColumn": max(1, span.column)}
    if span.end_line:
        region |= {"endLine": span.end_line, "endColumn": span.end_column}
    place: _Json = {
        "physicalLocation": {"artifactLocation": _artifact(span.path), "region": region}
    }
    return place | ({"message": {"text": plain_text(label)}} if label else {})


def _artifact(path: str) -> _Json:
    """Return the location of a file, relative to the repository if it is inside (3.4)."""
    shown, is_below = seen_from_root(path)
    if is_below:
        return {"uri": quote(os.fsencode(shown)), "uriBaseId": _ROOT}
    return {"uri": PurePath(shown).as_uri()}


def _fixes(suggestion: Suggestion) -> _Json:
    """Return the property `fixes` of a result (3.55).

    The result is empty if a line can no longer be read.
    """
    changes: dict[str, list[dict[str, object]]] = {}
    for edit in suggestion.edits:
        lines = lines_of(edit.path)
        if edit.line > len(lines):
            return {}
        changes.setdefault(edit.path, []).append(_replacement(edit, lines))
    warnings = (f"then warns: {warning}" for warning in suggestion.warnings)
    fix = {
        "description": {"text": plain_text(suggestion.message, *warnings)},
        "artifactChanges": [
            {"artifactLocation": _artifact(path), "replacements": of}
            for path, of in changes.items()
        ],
    }
    return {"fixes": [fix]}


def _replacement(edit: "LineEdit", lines: Sequence[str]) -> dict[str, object]:
    """Return the deleted region, which may be empty, and the inserted content (3.57)."""
    number, old = edit.line, lines[edit.line - 1]
    if edit.old is None:
        column = 1 if edit.where == "before" else len(old) + 1
        text = f"{edit.new}\n" if edit.where == "before" else f"\n{edit.new}"
        return _put((number, column), (number, column), text)
    if edit.new is not None:
        # The smallest change, so that two fixes of a line do not overlap.
        before = common_length(old, edit.new)
        after = common_length(old[before:][::-1], edit.new[before:][::-1])
        new = edit.new[before : len(edit.new) - after]
        return _put((number, before + 1), (number, len(old) - after + 1), new)
    # A line is deleted with its end; the last line, with the end of the line before.
    if number < len(lines):
        return _put((number, 1), (number + 1, 1), None)
    begin = (number - 1, len(lines[number - 2]) + 1) if number > 1 else (1, 1)
    return _put(begin, (number, len(old) + 1), None)


def _put(begin: tuple[int, int], end: tuple[int, int], text: str | None) -> dict[str, object]:
    names = ("startLine", "startColumn", "endLine", "endColumn")
    region = dict(zip(names, (*begin, *end), strict=True))
    inserted = {} if text is None else {"insertedContent": {"text": text}}
    return {"deletedRegion": region, **inserted}


def plain_text(*parts: str | None) -> str:
    """Return sentences as one text, each made safe to show."""
    return " ".join(visible(_sentence(part)) for part in parts if part)


def _sentence(part: str) -> str:
    # A text may begin with a path, which keeps its letters.
    is_path = re.match(r"\S*[/.]\w", part) is not None
    whole = part[:1].upper() + part[1:] if part[:1].isalpha() and not is_path else part
    return whole if whole.endswith((".", "?", "!")) else f"{whole}."
