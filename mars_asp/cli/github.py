"""Findings as workflow commands of GitHub Actions, which shows them beside changed lines."""

from collections.abc import Iterable, Iterator

from mars_asp.cli.results import Result, seen_from_root
from mars_asp.output import visible

_COMMANDS = {"error": "error", "warning": "warning", "note": "notice"}


def workflow_commands(results: Iterable[Result]) -> Iterator[str]:
    """Yield a workflow command for each result that is not hidden.

    Forbidden characters in values are escaped as by `@actions/core`.
    """
    for result in results:
        if result.hidden is not None:
            continue
        found = result.diagnostic
        properties: dict[str, object] = {}
        if result.has_file:
            span = found.span
            # An annotation of a whole file is shown at its first line.
            properties = {"file": seen_from_root(span.path)[0], "line": max(1, span.line)}
            # The runner refuses columns of a range of several lines.
            if not span.line:
                pass
            elif span.line == span.end_line:
                properties["endLine"] = span.end_line
                properties["col"] = span.column
                properties["endColumn"] = max(span.column, span.end_column - 1)
            else:
                properties["endLine"] = span.end_line
        properties["title"] = found.kind or found.code
        escaped = {key: _escaped(str(value)) for key, value in properties.items()}
        text = ",".join(
            f"{key}={visible(value.replace(':', '%3A').replace(',', '%2C'))}"
            for key, value in escaped.items()
        )
        yield f"::{_COMMANDS[found.severity]} {text}::{_escaped(_annotation_text(result))}"


def _annotation_text(result: Result) -> str:
    found = result.diagnostic
    place = "" if result.has_file else f"{found.span.path}: "
    help_text = found.help and f"help: {found.help}"
    parts = (f"{place}{found.message}", found.effect, help_text)
    return "\n".join(visible(part) for part in parts if part)


def _escaped(text: str) -> str:
    return text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")
