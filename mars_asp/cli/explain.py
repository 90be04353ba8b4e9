"""Show why each consequence and node is there, down to lines of rules and configuration."""

import argparse
import json
import linecache
import sys
from collections.abc import Iterator

from mars_asp.cli.reason import add_file, read_project, rulebook_for
from mars_asp.cli.report import colours
from mars_asp.cli.style import paint
from mars_asp.explain import Explanation, explain
from mars_asp.resolve import NODES
from mars_asp.source import Span
from mars_asp.trace.text import DEPTH, trace_json, traces_text
from mars_asp.visible import visible


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the verb."""
    add_file(parser)
    parser.add_argument(
        "subject", nargs="?", metavar="SUBJECT", help="a module, node, consequence kind or atom"
    )
    parser.add_argument("--about", metavar="NAME", help="the same as SUBJECT")
    parser.add_argument(
        "--depth", metavar="N|all", default=str(DEPTH), type=_depth, help="how deep (default 4)"
    )


def run(arguments: argparse.Namespace) -> int:
    """Print the traces; 3 where no time was left."""
    project = read_project(arguments)
    subject = arguments.subject or arguments.about
    try:
        answer = explain(project, rulebook_for(arguments), subject, arguments.time_limit)
    except TimeoutError:
        print("mars-asp: the time limit ended this before anything was found", file=sys.stderr)
        return 3
    if arguments.format == "json":
        traces = [{"title": t.title, **trace_json(t.trace)} for t in answer.topics]
        json.dump({"subject": subject, "traces": traces}, sys.stdout)
        print()
    else:
        for line in _text(answer, arguments, colours(arguments, sys.stdout)):
            print(line)
    return int(answer.analysis.has_errors)


def _depth(text: str) -> int | None:
    if text == "all":
        return None
    if text.isdigit() and 0 < int(text) < 10**6:
        return int(text)
    raise argparse.ArgumentTypeError(f"`{text}` is no depth: write a number from 1, or `all`")


def _text(answer: Explanation, arguments: argparse.Namespace, coloured: bool) -> Iterator[str]:
    topics = [(topic.title, topic.trace) for topic in answer.topics]
    for line in traces_text(topics, line_at, arguments.depth):
        title = not line.startswith(" ")
        if title:
            yield ""
        yield paint(visible(line), "strong", coloured and title)
    yield ""
    if arguments.quiet:
        return
    if not answer.topics:
        yield "nothing to resolve, so nothing to explain"
    if answer.synthesis is not None and answer.subject is None:
        yield _summary(answer)


def _summary(answer: Explanation) -> str:
    assert answer.synthesis is not None
    nodes = answer.synthesis.cost(NODES)
    resolution = answer.synthesis.resolution
    if not nodes:
        return "no node is needed"
    proof = "proven: no specification has fewer" if resolution.proven else "best found"
    count = resolution.count
    others = "" if count is None else f"; {count} such specification{'s' * (count != 1)}"
    return f"{nodes} node{'s' * (nodes > 1)}, {proof}{others}"


def line_at(span: Span) -> str:
    """Return the line of a file where something stands."""
    return linecache.getline(span.path, span.line).strip()
