"""Show why each consequence and node is there, down to lines of rules and configuration."""

import argparse
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING

from mars_asp.asp.trace import DEPTH
from mars_asp.cli.account import BELOW, FURTHER, account_lines
from mars_asp.cli.again import command
from mars_asp.cli.deliver import write_file
from mars_asp.cli.layout import columns, compared, counted, wrapped
from mars_asp.cli.lines import line_at
from mars_asp.cli.outputs import ending
from mars_asp.cli.reason import (
    JUDGING,
    STANDARD_INPUT,
    add_file,
    analyse_project,
    one_of_several,
    read_project,
    rulebook_for,
    unapplied_packs,
)
from mars_asp.cli.report import colours, paint, report
from mars_asp.cli.schemas import FORMATS, add_schema, explain_schema
from mars_asp.cli.selection import Selection, add_selection
from mars_asp.diagnostic import Diagnostic, Span
from mars_asp.model.declarations import Configuration
from mars_asp.model.names import read_name
from mars_asp.output import visible
from mars_asp.reasoning.analysis import Consequence
from mars_asp.reasoning.budget import Budget
from mars_asp.reasoning.launch_trees import analyse_trees, launch_rules
from mars_asp.reasoning.project import Project
from mars_asp.reasoning.questions.explain import Explanation, Sort, Topic, explain
from mars_asp.reasoning.questions.stated import Stated, lines_meant, stated
from mars_asp.reasoning.questions.unrealised import unrealised
from mars_asp.reasoning.rules import NODES, by_name
from mars_asp.reasoning.session import Reasoner

if TYPE_CHECKING:
    from mars_asp.asp.trace.tree import Trace
    from mars_asp.reasoning.questions.absences import Absence
    from mars_asp.reasoning.questions.why_not import WhyNot

#: The verb's output has one format more than that of others.
RESULT_FORMATS = ("text", "json", "jsonl")
MOST_ALTERNATIVES = 1000
#: Deep enough to say which premise fails; why that one does is the next question.
ABSENCE_DEPTH = 1
#: So deep is an absence followed at most, one grounding for each level.
_MOST_LEVELS = 60
#: Of the lines that an answer speaks of so many are shown.
_MOST_EVIDENCE = 6
#: A page of everything about more modules has no traces, which would be too large for browsers.
_MOST_TRACED = 2_000
_TOO_MANY_TRACES = (
    f"This page has no traces and no answers to why not, as there are more than {_MOST_TRACED} "
    "modules. `mars-asp explain FILE NAME --depth all` prints the trace of one name, and "
    "`mars-asp explain FILE --why-not 'KIND(NAME)'` one answer."
)


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the verb."""
    add_file(parser)
    parser.add_argument(
        "subject",
        nargs="?",
        metavar="SUBJECT",
        help="a module, node, consequence kind or atom, or a line: `A uses_data_from B`, FILE:LINE",
    )
    question = parser.add_mutually_exclusive_group()
    question.add_argument(
        "--all",
        dest="every",
        action="store_true",
        help="every derivation of each step, not only the shortest, each numbered `1 of 2`",
    )
    question.add_argument(
        "--repair", action="store_true", help="the smallest edits that remove each error"
    )
    question.add_argument(
        "--alternatives",
        nargs="?",
        const=5,
        type=_count,
        metavar="N",
        help="other realisations, in the order of their cost (default 5), and why none costs less",
    )
    question.add_argument(
        "--why-not", metavar="ATOM", help="why there is no ATOM, and what would give one"
    )
    parser.add_argument(
        "--only",
        choices=("consequences", "nodes"),
        help="only these, of everything or of a module; consequences alone need no resolution",
    )
    parser.add_argument("--about", metavar="NAME", help="the same as SUBJECT")
    parser.add_argument(
        "--depth",
        metavar="N|all",
        default=argparse.SUPPRESS,
        type=_depth,
        help=f"how deep (default {DEPTH}, of what is absent {ABSENCE_DEPTH})",
    )
    parser.add_argument("--places", action="store_true", help="add the file and line of each rule")
    parser.add_argument(
        "-o",
        "--output",
        metavar="OUT.html",
        type=ending(".html", "-"),
        help="write a page: the findings, the picture, the traces and their lines; "
        "`-` is standard output",
    )
    add_selection(parser, writes=False)
    add_schema(parser, "that format, of `jsonl` of one line", explain_schema, *FORMATS)


def run(arguments: argparse.Namespace) -> int:
    """Print the traces; 3 where no time was left."""
    rule = _rule_or_kind(arguments)
    if rule is not None:
        print(rule)
        return 0
    _tell_subject(arguments)
    contradiction = _contradiction(arguments)
    if contradiction is not None:
        print(f"mars-asp explain: {contradiction}", file=sys.stderr)
        return 2
    project = read_project(arguments, quietly=True)
    subject = arguments.about if arguments.subject is None else arguments.subject
    # A name may be asked for as the configuration writes it.
    subject = subject and (read_name(subject) or subject)
    if arguments.why_not is not None:
        return _why_not(project, arguments)
    if arguments.alternatives is not None or arguments.repair:
        report((*project.diagnostics, *one_of_several(project)), arguments)
    if arguments.alternatives is not None:
        from mars_asp.cli.alternatives import run_alternatives

        return run_alternatives(project, arguments, subject)
    if arguments.repair:
        from mars_asp.cli.repair import run_repair

        return run_repair(project, arguments, subject)
    if (project.trees or project.format == "dora") and arguments.only != "nodes":
        status = _explain_findings(project, arguments, subject)
        if status is not None:
            return status
    rulebook = rulebook_for(arguments, ("resolve", "account"))
    selection = Selection(arguments, rulebook)
    messages = _report_messages(project, selection, arguments)
    reasoner = Reasoner(project, rulebook, Budget(arguments.time_limit))
    traced = _wants_traces(arguments)
    meant = () if subject is None else lines_meant(subject, project)
    if arguments.output is not None:
        traced = subject is not None or len(project.configuration.modules) <= _MOST_TRACED
    about = None if meant else subject
    answer = explain(reasoner, about, arguments.every, arguments.only, traced)
    if meant:
        answer = replace(answer, subject=subject, topics=tuple(_resting(answer, meant)))
    absent = () if arguments.output is None else _absent(reasoner, answer, arguments.only)
    del reasoner
    topics, has_errors = _reported(answer, selection, project)
    found = () if arguments.output is None else _among_topics(answer, topics)
    status = int(has_errors)
    # What a page says of the whole is no remark beside it.
    is_told = arguments.output is not None or not arguments.quiet
    closing = tuple(_closing(answer, arguments)) if is_told else ()
    synthesis = answer.synthesis
    specified = None if synthesis is None else synthesis.specification.configuration
    # The traces stand without what was grounded, which takes as much memory.
    del answer, synthesis
    if arguments.output is not None:
        remarks = closing if traced else (*closing, _TOO_MANY_TRACES)
        page = (project, specified, topics, found, messages, absent, remarks)
        _write_page(*page, arguments.output)
    else:
        _print_topics(subject, topics, closing, traced, arguments)
    return status


def _write_page(
    project: Project,
    specified: Configuration | None,
    topics: Sequence[Topic],
    found: Sequence[Consequence],
    messages: Sequence[Diagnostic],
    absent: Sequence["Absence"],
    remarks: Sequence[str],
    output: str,
) -> None:
    from mars_asp.cli.explain_page import explanation_page

    page = explanation_page(project, specified, topics, found, messages, absent, remarks)
    if output == "-":
        sys.stdout.write(page)
    else:
        write_file(output, page)


def _among_topics(answer: Explanation, topics: Sequence[Topic]) -> tuple[Consequence, ...]:
    """Return the consequences that are topics."""
    atoms = {topic.atom for topic in topics}
    return tuple(each for each in answer.analysis.consequences if each.atom in atoms)


def _print_topics(
    subject: str | None,
    topics: Sequence[Topic],
    closing: Sequence[str],
    traced: bool,
    arguments: argparse.Namespace,
) -> None:
    """Print topics in the format that the user wants; `closing` lines are for text alone."""
    if arguments.format != "text":
        from mars_asp.cli.trace_document import write_topics

        write_topics(subject, topics, arguments.format, sys.stdout.write)
    else:
        lines = chain(_told(topics, traced, arguments), closing)
        sys.stdout.writelines(f"{line}\n" for line in lines)


def _explain_findings(
    project: Project, arguments: argparse.Namespace, subject: str | None
) -> int | None:
    """Print the findings in launch trees or a dataflow; return None if none has the subject."""
    from mars_asp.reasoning.questions import launch_trees

    rulebook = rulebook_for(arguments, JUDGING)
    selection = Selection(arguments, rulebook)
    traced = _wants_traces(arguments)
    if project.trees:
        of, rules = "the launch files", launch_rules(rulebook)
        analysis = analyse_trees(project, rulebook)
    else:
        of, rules = "the dataflow", rulebook
        analysis = analyse_project(project, rulebook, arguments)
    answer = launch_trees.explain_findings(
        project, analysis, rules, subject, every=arguments.every, traced=traced
    )
    if answer is None:
        return None
    messages, _ = selection.messages(project)
    report((*messages, *unapplied_packs(project, rulebook)), arguments)
    topics, has_errors = _reported(answer, selection, project)
    closing = [] if topics or arguments.quiet else [f"nothing found in {of}"]
    if arguments.output is not None:
        found = _among_topics(answer, topics)
        _write_page(project, None, topics, found, messages, (), closing, arguments.output)
    else:
        _print_topics(answer.subject, topics, closing, traced, arguments)
    return int(has_errors)


def _report_messages(
    project: Project, selection: Selection, arguments: argparse.Namespace
) -> tuple[Diagnostic, ...]:
    """Report the selected messages on reading a project as one robot, and return them."""
    messages, _ = selection.messages(project)
    report((*messages, *one_of_several(project)), arguments)
    return messages


def _wants_traces(arguments: argparse.Namespace) -> bool:
    deeper = arguments.every or arguments.places or hasattr(arguments, "depth")
    return deeper or arguments.format != "text" or arguments.output is not None


def _reported(
    answer: Explanation, selection: Selection, project: Project
) -> tuple[tuple[Topic, ...], bool]:
    """Return the topics that are reported, and whether an error is.

    Who asks about something is told of it, whatever hides it elsewhere.
    """
    if answer.subject is not None or selection.leaves_all(project):
        return answer.topics, selection.has_errors(project, answer.analysis)
    selected = selection.among(project, answer.analysis.consequences)
    shown = {f"{each.kind}({each.subject})" for each in selected.shown}
    left = (each for each in answer.topics if each.sort != "consequence" or each.name in shown)
    return tuple(left), selected.has_errors


def _resting(answer: Explanation, lines: Sequence[Span]) -> Iterator[Topic]:
    """Yield the topics of which one of some lines is a cause."""
    wanted = {(span.path, span.line) for span in lines}
    for topic in answer.topics:
        cites = () if topic.account is None else topic.account.cites
        if any((each.span.path, each.span.line) in wanted for each in cites):
            yield topic


def _absent(reasoner: Reasoner, answer: Explanation, only: Sort | None) -> Sequence["Absence"]:
    """Return why there is not more for each module or, of one subject, for the modules of that."""
    from mars_asp.reasoning.questions.absences import absences

    names = [name.text for name in reasoner.project.configuration.modules]
    if answer.subject is not None:
        told = [title for each in answer.topics for title in (each.name, *each.resolves)]
        about = {answer.subject, *(title.partition("(")[2].removesuffix(")") for title in told)}
        names = [name for name in names if name in about]
    return tuple(absences(reasoner, names, only))


def _rule_or_kind(arguments: argparse.Namespace) -> str | None:
    """Return the text about a rule or a kind that is named alone, if there is no such file."""
    name, *further = arguments.files
    is_alone = arguments.subject is None and not further and name != STANDARD_INPUT
    if not is_alone or Path(name).exists():
        return None
    from mars_asp.cli.rules import rule_or_kind_text

    return rule_or_kind_text(name, arguments)


def _tell_subject(arguments: argparse.Namespace) -> None:
    """Take the last word for the subject where it is no file: words before it are files."""
    *files, last = arguments.files
    if files and arguments.subject is None and not _is_file(last, files):
        arguments.files, arguments.subject = files, last


def _is_file(word: str, files: Sequence[str]) -> bool:
    """Whether a word names a file, and no module; beside our own files a folder is none."""
    if word == STANDARD_INPUT or Path(word).is_file():
        return True
    is_folder = word != "" and Path(word).is_dir()
    return is_folder and not any(file.endswith(".mars") for file in files)


def _contradiction(arguments: argparse.Namespace) -> str | None:
    """Return what arguments leave open or would be ignored."""
    has_subject = arguments.subject is not None
    if has_subject and arguments.about is not None:
        return "SUBJECT and --about mean the same: give one of them"
    if arguments.why_not is not None and (has_subject or arguments.about is not None):
        subject = "SUBJECT" if has_subject else "--about"
        return f"--why-not asks about its ATOM alone: leave out {subject}, or --why-not"
    if arguments.output is not None:
        for option in ("why_not", "repair", "alternatives", "places"):
            if getattr(arguments, option) not in (None, False):
                named = option.replace("_", "-")
                return f"-o writes accounts and whole traces: leave out --{named}, or -o"
        if hasattr(arguments, "depth"):
            return "-o writes accounts and whole traces: leave out --depth, or -o"
        if arguments.format != "text":
            return f"-o writes a page: leave out `--format {arguments.format}`, or -o"
    if arguments.why_not is not None and arguments.only is not None:
        return "--why-not asks about its ATOM alone: leave out --only, or --why-not"
    if arguments.format == "jsonl":
        for option in ("why_not", "repair", "alternatives"):
            if getattr(arguments, option):
                named = option.replace("_", "-")
                return f"--{named} prints no trace line by line: take `--format json`"
    for option in ("repair", "alternatives"):
        if getattr(arguments, option) and arguments.only is not None:
            return f"--{option} prints no trace, so --only has no effect: leave it out"
        if getattr(arguments, option) and hasattr(arguments, "depth"):
            return f"--{option} prints no trace, so --depth has no effect: leave it out"
    return None


def _why_not(project: Project, arguments: argparse.Namespace) -> int:
    from mars_asp.reasoning.questions.why_not import why_not

    depth = getattr(arguments, "depth", ABSENCE_DEPTH)
    levels = _MOST_LEVELS if depth is None else 2 * depth
    rulebook = rulebook_for(arguments)
    selection = Selection(arguments, rulebook)
    _report_messages(project, selection, arguments)
    reasoner = Reasoner(project, rulebook, Budget(arguments.time_limit))
    asked = stated(arguments.why_not, project)
    subject = arguments.why_not if asked is None else asked.atom
    answer = why_not(reasoner, subject, levels)
    if asked is not None and asked.atom != arguments.why_not:
        answer = replace(answer, subject=asked.line, answer=_of_line(answer.answer, asked))
    if arguments.format == "json":
        from mars_asp.cli.trace_document import why_not_document

        print(why_not_document(answer))
    else:
        first, *others = _why_not_text(answer, arguments, project.format)
        coloured = colours(arguments, sys.stdout)
        sys.stdout.writelines(f"{paint(line, 'strong', coloured)}\n" for line in first)
        sys.stdout.writelines(f"{line}\n" for lines in others for line in lines)
    return int(selection.has_errors(project, answer.analysis))


def _of_line(answer: str, asked: Stated) -> str:
    """Return an answer about an atom as one about the line that says the same."""
    reason = answer.removeprefix(f"No {asked.atom}: ")
    if reason != answer:
        return f"{reason[:1].upper()}{reason[1:]}"
    return answer.replace(asked.atom, f"`{asked.line}`")


def _why_not_text(
    answer: "WhyNot", arguments: argparse.Namespace, format: str | None
) -> Iterator[Sequence[str]]:
    """Yield the lines of the answer, then those that it speaks of and what would give one."""
    width = columns(sys.stdout)

    def below(text: str) -> Sequence[str]:
        return wrapped(visible(text), width, BELOW, BELOW + FURTHER)

    yield wrapped(visible(answer.answer), width, "", FURTHER)
    # Several things may be on one line.
    evidence = tuple({(span.path, span.line): span for span in answer.evidence}.values())
    shown = evidence[:_MOST_EVIDENCE]
    # Lines of the user are not broken.
    places = [visible(f"{span.path}:{span.line}") for span in shown]
    wide = max(map(len, places), default=0)
    lines = (visible(line_at(span)) for span in shown)
    yield [f"{BELOW}{place:{wide}}  {line}" for place, line in zip(places, lines, strict=True)]
    if len(evidence) > len(shown):
        yield [f"{BELOW}and {counted(len(evidence) - len(shown), 'more line')}"]
    if answer.to_get is not None:
        # The lines of others' files are not ours.
        where = f", in what `mars-asp import {format}` prints" if format else ""
        yield below(f"To get one{where}: {answer.to_get}")
    if answer.extra is not None:
        yield below(_price(answer.extra))
    if answer.obstacles:
        asked = command("explain", arguments, "--repair")
        yield [f"{BELOW}To see what would fix that:", f"{BELOW}{BELOW}{asked}"]
    if answer.see is not None:
        yield [f"{BELOW}Why: {command('explain', arguments, answer.see)}"]


def _price(extra: Mapping[int, int]) -> str:
    """Return what a specification with what is asked for costs beyond the minimal one."""
    return f"A specification with it costs {compared(by_name(extra)) or 'the same'}."


def _count(text: str) -> int:
    if text.isdigit() and 0 < int(text) <= MOST_ALTERNATIVES:
        return int(text)
    raise argparse.ArgumentTypeError(
        f"expected a number from 1 to {MOST_ALTERNATIVES}, found `{text}`"
    )


def _depth(text: str) -> int | None:
    if text == "all":
        return None
    if text.isdigit() and 0 < int(text) < 10**6:
        return int(text)
    raise argparse.ArgumentTypeError(f"a depth is a number from 1 or `all`, found `{text}`")


def _closing(answer: Explanation, arguments: argparse.Namespace) -> Iterator[str]:
    """Yield what is said below the traces."""
    if arguments.only == "nodes" and answer.synthesis is None:
        yield f"{unrealised(answer.analysis)}, so there is no node to explain"
    elif not answer.topics and answer.subject is not None:
        yield f"no consequence and no node rests on `{answer.subject}`"
    elif not answer.topics and arguments.only != "nodes":
        yield "nothing to resolve, so nothing to explain"
    if answer.synthesis is not None and answer.subject is None:
        yield _summary(answer)
    elif answer.subject is None and arguments.only is None:
        yield unrealised(answer.analysis)


def _told(topics: Sequence[Topic], traced: bool, arguments: argparse.Namespace) -> Iterator[str]:
    """Yield the lines of topics: accounts, or traces where these are wanted or all there is."""
    coloured = colours(arguments, sys.stdout)
    if traced or any(topic.account is None for topic in topics):
        told = [(topic.title, topic.trace) for topic in topics]
        yield from _lines(told, getattr(arguments, "depth", DEPTH), arguments)
        return
    width = columns(sys.stdout)
    for topic in topics:
        if topic.account is not None:
            yield ""
            first, *others = account_lines(topic, topic.account, width)
            yield paint(first, "strong", coloured)
            yield from others
    yield ""


def _lines(
    topics: Sequence[tuple[str, "Trace"]], depth: int | None, arguments: argparse.Namespace
) -> Iterator[str]:
    from mars_asp.asp.trace.text import traces_text

    coloured = colours(arguments, sys.stdout)
    for line in traces_text(topics, line_at, depth, columns(sys.stdout), places=arguments.places):
        title = not line.startswith(" ")
        if title:
            yield ""
        yield paint(visible(line), "strong", coloured) if title else visible(line)
    yield ""


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
