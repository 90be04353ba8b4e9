"""Report whether a robot can do something, or several things at one time, and why."""

import argparse
import os.path
import shlex
import sys
from collections.abc import Iterator

from mars_asp.asp.trace.document import TraceDocument
from mars_asp.cli.account import account_json, explanation_lines
from mars_asp.cli.arguments import misuse
from mars_asp.cli.diagnostic_text import colours, paint
from mars_asp.cli.encode import print_result
from mars_asp.cli.inputs import add_file, read_project, report_reading, rulebook_for
from mars_asp.cli.wrapping import columns, wrapped
from mars_asp.model.names import written
from mars_asp.output import visible
from mars_asp.reasoning.questions.capability import CapabilityAnswer, capability


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    add_file(parser)
    parser.add_argument("query", metavar="QUERY")


def run(arguments: argparse.Namespace) -> int:
    """Print the answer; return 1 if it is no."""
    path, query = arguments.files[0], arguments.query
    if os.path.exists(query) and not os.path.exists(path):  # noqa: PTH110 -- never raises
        words = shlex.join((query, path))
        return misuse("can", f"the query comes after the file: mars-asp can {visible(words)}")
    if "of" in arguments.files and not os.path.exists("of"):  # noqa: PTH110 -- never raises
        return misuse("can", "the query is one word: put it in quotes, as in 'Trans_Z of Base'")
    project = read_project(arguments, quietly=True)
    answer = capability(project, rulebook_for(arguments, ("can", "account")), arguments.query)
    report_reading(project, arguments)
    lines = capability_lines(answer, colours(arguments, sys.stdout))
    print_result(arguments, lambda: capability_json(answer), lines)
    return int(not answer.able)


def capability_json(answer: CapabilityAnswer) -> dict[str, object]:
    """Return an answer as the JSON of `can`."""
    document = TraceDocument()
    demands = [
        {
            "function": v.demand.function,
            "module": v.demand.module,
            "can": v.able,
            "missing": list(v.missing),
            **account_json(v.account),
            "traces": [document.trace(trace) for trace in v.traces],
        }
        for v in answer.verdicts
    ]
    return {"query": answer.query, "can": answer.able, "demands": demands}


def capability_lines(answer: CapabilityAnswer, coloured: bool = False) -> Iterator[str]:
    """Yield the lines of an answer: yes or no, the reason for each demand, help."""
    yield paint("yes" if answer.able else "no", "strong", coloured)
    for verdict in answer.verdicts:
        demand = f"{verdict.demand.function} of {written(verdict.demand.module)}"
        title, *others = explanation_lines(
            f"{demand}:", verdict.account, verdict.rule, columns(sys.stdout)
        )
        yield ""
        yield paint(title, "strong", coloured)
        yield from others
    missing = dict.fromkeys(text for verdict in answer.verdicts for text in verdict.missing)
    for index, text in enumerate(missing):
        if not index:
            yield ""
        yield from wrapped(visible(text), columns(sys.stdout), "help: ", "      ")
