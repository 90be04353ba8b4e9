"""Explanations for programs: one JSON document, or a line of JSON a step."""

from collections.abc import Callable, Iterable, Iterator, Sequence

from mars_asp.asp.trace.document import FORMAT, VERSION, Document, trace_lines
from mars_asp.cli.encode import encoded
from mars_asp.cli.lines import line_at
from mars_asp.reasoning.questions.explain import Topic

#: So many lines are written at once.
_AT_ONCE = 1000


def write_topics(
    subject: str | None,
    topics: Sequence[Topic],
    written: str,
    write: Callable[[str], object],
) -> None:
    """Write topics as `json` or `jsonl`; lines as they are made."""
    if written == "json":
        write(f"{encoded(_document(subject, topics))}\n")
        return
    lines = trace_lines(subject, ((_topic_json(each), each.trace) for each in topics))
    for part in _batches(lines):
        write("".join(part))


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
