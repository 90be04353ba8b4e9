"""Explanations for programs: one JSON document, or a line of JSON for each step."""

from collections.abc import Iterator, Sequence

from mars_asp.asp.trace.document import FORMAT, VERSION, TraceDocument, trace_json, trace_lines
from mars_asp.cli.account import account_json
from mars_asp.cli.encode import encoded
from mars_asp.cli.lines import located_line_json
from mars_asp.reasoning.questions.explain import Topic
from mars_asp.reasoning.questions.why_not import WhyNot
from mars_asp.reasoning.rules import by_name


def topics_text(subject: str | None, topics: Sequence[Topic], format: str) -> Iterator[str]:
    """Yield topics as `json`, or as lines of `jsonl` in batches while they are computed."""
    if format == "json":
        yield f"{encoded(topics_document(subject, topics))}\n"
        return
    for line in trace_lines(subject, ((_topic_json(each), each.trace) for each in topics)):
        yield f"{line}\n"


def topics_document(subject: str | None, topics: Sequence[Topic]) -> dict[str, object]:
    """Return topics with the keys of the contract."""
    document = TraceDocument()
    traces = [{"title": each.title, **document.trace(each.trace)} for each in topics]
    entries = list(map(_topic_json, topics))
    return {**_head(subject), "traces": traces, "topics": entries}


def why_not_document(answer: WhyNot) -> dict[str, object]:
    """Return the JSON of `--why-not`: that of `explain` for one topic, and what is missing."""
    lines = [located_line_json(span) for span in answer.evidence]
    title, trace = answer.subject, trace_json(answer.trace)
    cited = [{**line, "label": ""} for line in lines]
    entries = {"answer": answer.answer, "lines": cited, "notes": [], "decided_by": None}
    topic = {"title": title, "sort": "atom", "name": title, "resolves": [], **entries}
    found = {
        "present": answer.present,
        "answer": answer.answer,
        "evidence": lines,
        "to_get": answer.to_get,
        "offered": answer.offered,
        "extra_cost": None if answer.extra is None else by_name(answer.extra),
        "obstacles": [trace_json(obstacle) for obstacle in answer.obstacles],
    }
    traces = [{"title": title, **trace}]
    return {**_head(title), **found, "traces": traces, "topics": [topic]}


def _head(subject: str | None) -> dict[str, object]:
    return {"format": FORMAT, "version": VERSION, "subject": subject}


def _topic_json(topic: Topic) -> dict[str, object]:
    entries = {"title": topic.title, "sort": topic.sort, "name": topic.name}
    account = topic.account
    if account is None:
        return {**entries, "resolves": list(topic.resolves)}
    resolves = list(topic.resolves)
    return {**entries, "resolves": resolves, **account_json(account), "decided_by": topic.rule}
