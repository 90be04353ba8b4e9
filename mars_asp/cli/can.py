"""Report whether a robot can do something, or several things at one time, and why."""

import argparse
import sys

from mars_asp.asp.trace.document import Document
from mars_asp.cli.account import account_json, told_lines
from mars_asp.cli.encode import encoded
from mars_asp.cli.layout import columns, wrapped
from mars_asp.cli.reason import add_file, read_project, rulebook_for
from mars_asp.cli.report import colours, paint
from mars_asp.model.names import written
from mars_asp.output import visible
from mars_asp.reasoning.questions.capability import Answer, capability


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the verb."""
    add_file(parser)
    parser.add_argument(
        "query", metavar="QUERY", help='such as "Rotn_Y of Camera while Trans_Z of Platform"'
    )


def run(arguments: argparse.Namespace) -> int:
    """Print the answer; 1 where it is no."""
    project = read_project(arguments)
    answer = capability(project, rulebook_for(arguments, ("can", "account")), arguments.query)
    if arguments.format == "json":
        document = Document()
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
        print(encoded({"query": answer.query, "can": answer.able, "demands": demands}))
    else:
        _print_answer(answer, colours(arguments, sys.stdout))
    return int(not answer.able)


def _print_answer(answer: Answer, coloured: bool) -> None:
    print(paint("yes" if answer.able else "no", "strong", coloured))
    for verdict in answer.verdicts:
        demand = f"{verdict.demand.function} of {written(verdict.demand.module)}"
        title, *others = told_lines(
            f"{demand}:", verdict.account, verdict.rule, columns(sys.stdout)
        )
        print()
        print(paint(title, "strong", coloured))
        sys.stdout.writelines(f"{line}\n" for line in others)
    missing = dict.fromkeys(text for verdict in answer.verdicts for text in verdict.missing)
    for index, text in enumerate(missing):
        lines = wrapped(visible(text), columns(sys.stdout), "help: ", "      ")
        print("\n".join(lines if index else ["", *lines]))
