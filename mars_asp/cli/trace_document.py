"""Explanations for programs: one JSON document, or a line of JSON a step, and their schemas."""

import argparse
from collections.abc import Callable, Iterable, Iterator, Sequence
from importlib.resources import files
from typing import Any

from mars_asp.asp.trace.document import FORMAT, VERSION, Document, trace_lines
from mars_asp.cli.encode import encoded
from mars_asp.cli.lines import line_at
from mars_asp.reasoning.questions.explain import Topic

#: The formats that programs read; each has a schema in the package.
FORMATS = ("json", "jsonl")
#: So many lines are written at once.
_AT_ONCE = 1000


def write_topics(
    subject: str | None,
    topics: Sequence[Topic],
    written: str,
    write: Callable[[str], object],
) -> None:
    """Write topics in one of the `FORMATS`; lines as they are made."""
    if written == "json":
        write(f"{encoded(_document(subject, topics))}\n")
        return
    lines = trace_lines(subject, ((_topic_json(each), each.trace) for each in topics))
    for part in _batches(lines):
        write("".join(part))


def add_schema(parser: argparse.ArgumentParser) -> None:
    """Add the option that prints a schema."""
    parser.add_argument(
        "--schema",
        choices=FORMATS,
        action=_Schema,
        help="print the JSON Schema of that format, of `jsonl` of one line, and do nothing else",
    )


class _Schema(argparse.Action):
    """Prints a schema in the place of an explanation, as `--help` does."""

    def __call__(
        self, parser: argparse.ArgumentParser, _: object, values: Any, *__: object
    ) -> None:
        print(schema_text(values), end="")
        parser.exit()


def schema_text(written: str) -> str:
    """Return the JSON Schema of one of the `FORMATS`."""
    schema = files("mars_asp.cli") / f"explain.{written}.schema.json"
    return schema.read_text(encoding="utf-8")


def _document(subject: str | None, topics: Sequence[Topic]) -> dict[str, object]:
    document = Document()
    traces = [{"title": each.title, **document.trace(each.trace)} for each in topics]
    told = list(map(_topic_json, topics))
    head = {"format": FORMAT, "version": VERSION, "subject": subject}
    return {**head, "traces": traces, "topics": told}


def _topic_json(topic: Topic) -> dict[str, object]:
    told = {"title": topic.title, "sort": topic.sort, "name": topic.name}
    account = topic.account
    if account is None:
        return {**told, "resolves": list(topic.resolves)}
    lines = [
        {
            "path": each.span.path,
            "line": each.span.line,
            "column": each.span.column,
            "text": line_at(each.span),
            "label": each.label,
        }
        for each in account.cites
    ]
    answer = {"answer": account.answer, "lines": lines, "notes": list(account.notes)}
    return {**told, "resolves": list(topic.resolves), **answer, "decided_by": topic.rule}


def _batches(lines: Iterable[str]) -> Iterator[list[str]]:
    part: list[str] = []
    for line in lines:
        part.append(f"{line}\n")
        if len(part) == _AT_ONCE:
            yield part
            part = []
    yield part
