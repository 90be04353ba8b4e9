"""Show why each consequence and node is there, down to lines of rules and configuration."""

import argparse
import os
import re
import sys
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.trace import DEPTH
from mars_asp.cli.account import BELOW, FURTHER, account_lines
from mars_asp.cli.arguments import misuse
from mars_asp.cli.deliver import write_result
from mars_asp.cli.diagnostic_text import colours, paint, report
from mars_asp.cli.encode import encoded
from mars_asp.cli.input_codes import input_codes
from mars_asp.cli.inputs import (
    JUDGING,
    STANDARD_INPUT,
    add_file,
    analyse_project,
    is_other_file,
    one_of_several,
    read_project,
    rulebook_for,
    unapplied_packs,
    workspace_of,
)
from mars_asp.cli.lines import line_at, located_lines
from mars_asp.cli.output_files import ending
from mars_asp.cli.schemas import FORMATS, add_schema, schema_text
from mars_asp.cli.selection import Selection, add_selection
from mars_asp.cli.suggested_commands import command
from mars_asp.cli.wrapping import columns, compared, wrapped
from mars_asp.diagnostic import Diagnostic, MarsError, Span
from mars_asp.exchange.recognise import recognised
from mars_asp.language.parse import read_text
from mars_asp.model.declarations import Configuration
from mars_asp.model.names import read_name
from mars_asp.output import counted, visible
from mars_asp.reasoning.analysis import Analysis, Consequence
from mars_asp.reasoning.budget import Budget
from mars_asp.reasoning.findings import consequence_kinds
from mars_asp.reasoning.launch_trees import analyse_trees, launch_rules
from mars_asp.reasoning.project import Project
from mars_asp.reasoning.questions.explain import Explanation, Sort, Topic, explain
from mars_asp.reasoning.questions.relationship_query import (
    RelationshipQuery,
    lines_meant,
    read_relationship,
)
from mars_asp.reasoning.questions.subject import NothingToExplainError
from mars_asp.reasoning.questions.unrealised import unrealised
from mars_asp.reasoning.rules import NODES, by_name
from mars_asp.reasoning.session import Reasoner
from mars_asp.spelling import nearest

if TYPE_CHECKING:
    from mars_asp.asp.trace.tree import Trace
    from mars_asp.reasoning.questions.absences import Absence
    from mars_asp.reasoning.questions.why_not import WhyNot

#: This command has one format more than others.
RESULT_FORMATS = ("text", "json", "jsonl")
MOST_ALTERNATIVES = 1000
#: Deep enough to show the failed premise; a further question explains its failure.
ABSENCE_DEPTH = 1
#: An absence is followed at most so deep, with one grounding for each level.
_MOST_LEVELS = 60
#: An answer shows at most so many of the lines that it is about.
_MOST_EVIDENCE = 6
_LINE = re.compile(r"(.+\.\w+):([0-9]+)(?::[0-9]+)?")
#: Precedes the command that lists other specifications of the same cost.
_TO_LIST = "To list them: "
#: An HTML report on more modules has no traces, as it would be too large for browsers.
_MOST_TRACED = 2_000
_TOO_MANY_TRACES = (
    f"This page has no traces and no answers to why not, as there are more than {_MOST_TRACED} "
    "modules. `mars-asp explain FILE NAME --depth all` prints the trace of one name, and "
    "`mars-asp explain FILE --why-not 'KIND(NAME)'` one answer."
)


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    add_file(parser)
    parser.add_argument("subject", nargs="?", metavar="SUBJECT")
    question = parser.add_mutually_exclusive_group()
    question.add_argument("--all", dest="every", action="store_true")
    question.add_argument("--repair", action="store_true")
    question.add_argument(
        "--alternatives", nargs="?", const=5, type=_alternatives_count, metavar="N"
    )
    question.add_argument("--why-not", metavar="ATOM")
    parser.add_argument("--only", choices=("consequences", "nodes"))
    parser.add_argument("--about", metavar="NAME")
    parser.add_argument(
        "--depth",
        metavar="N|all",
        default=argparse.SUPPRESS,
        type=_depth,
        help=f"how deep (default {DEPTH}, of what is absent {ABSENCE_DEPTH})",
    )
    parser.add_argument("--places", action="store_true")
    parser.add_argument("-o", "--output", metavar="OUT.html", type=ending(".html", "-"))
    add_selection(parser, writes=False)
    text = partial(schema_text, "explain")
    add_schema(parser, "that format, of `jsonl` of one line", text, *FORMATS)


def run(arguments: argparse.Namespace) -> int:
    """Print the explanation; return 1 if an error is reported."""
    _split_location(arguments)
    rule = _rule_or_kind(arguments)
    if rule is not None:
        print(rule)
        return 0
    *files, last = arguments.files
    if files and arguments.subject is None and not _is_file(last, files):
        # A last word that is not a file is the subject.
        arguments.files, arguments.subject = files, last
    contradiction = _contradiction(arguments) or _misplaced_words(arguments)
    if contradiction is not None:
        return misuse("explain", contradiction)
    project = read_project(arguments, quietly=True)
    subject = arguments.about if arguments.subject is None else arguments.subject
    # The subject may be a name as the configuration writes it, such as a quoted one.
    subject = subject and (read_name(subject) or subject)
    if subject not in {name.text for name in project.configuration.modules}:
        subject = subject and _place(subject, arguments)
        if subject in input_codes() and arguments.output is None:
            from mars_asp.cli.rules import rule_or_kind_text

            print(rule_or_kind_text(subject, arguments))
            return 0
    if arguments.why_not is not None:
        return _why_not(project, arguments)
    if arguments.alternatives is not None or arguments.repair:
        report((*project.diagnostics, *one_of_several(project, arguments)), arguments)
    if arguments.alternatives is not None:
        from mars_asp.cli.alternatives import run_alternatives

        return run_alternatives(project, arguments, subject)
    if arguments.repair:
        from mars_asp.cli.repair import run_repair

        return run_repair(project, arguments, subject)
    found = explained(project, subject, arguments)
    report(found.messages, arguments)
    if arguments.output is None:
        for text in explanation_text(found, arguments):
            sys.stdout.write(text)
    else:
        write_result(arguments.output, explanation_html(found, project))
    return int(found.has_errors)


class Explained(NamedTuple):
    """The reported topics of an explanation, and the sentences about all of them.

    `messages` are about reading the robot. Only an HTML report has a `specification` to draw,
    `absent` atoms with their reasons, and the `consequences` that are topics.
    """

    subject: str | None
    topics: tuple[Topic, ...]
    closing: tuple[str, ...]
    has_errors: bool
    messages: tuple[Diagnostic, ...]
    is_traced: bool
    specification: Configuration | None = None
    absent: tuple["Absence", ...] = ()
    consequences: tuple[Consequence, ...] = ()


def explained(project: Project, subject: str | None, arguments: argparse.Namespace) -> Explained:
    """Return why each consequence and node exists, or only those that `subject` names.

    Raises:
        MarsError: the subject names nothing, or rules, settings or a baseline are wrong.
        TimeoutError: no specification was found in time.
    """
    if (project.trees or project.format == "dora") and arguments.only != "nodes":
        found = _explained_findings(project, subject, arguments)
        if found is not None:
            return found
    rulebook = rulebook_for(arguments, ("resolve", "account"))
    selection = Selection(arguments, rulebook)
    messages = (*selection.messages(project)[0], *one_of_several(project, arguments))
    reasoner = Reasoner(project, rulebook, Budget(arguments.time_limit))
    is_page = arguments.output is not None
    traced = _wants_traces(arguments)
    meant = () if subject is None else lines_meant(subject, project)
    if is_page:
        traced = subject is not None or len(project.configuration.modules) <= _MOST_TRACED
    is_rule = subject in rulebook.by_id
    about = None if meant or is_rule else subject
    try:
        answer = explain(reasoner, about, arguments.every, arguments.only, traced)
    except NothingToExplainError as error:
        has_errors = selection.has_errors(project, reasoner.analysis)
        return Explained(subject, (), (error.sentence,), has_errors, messages, traced)
    if is_rule:
        topics = tuple(topic for topic in answer.topics if topic.rule == subject)
        answer = replace(answer, subject=subject, topics=topics)
    elif meant:
        answer = replace(answer, subject=subject, topics=tuple(_resting(answer, meant)))
    absent = tuple(_absent(reasoner, answer, arguments.only)) if is_page else ()
    topics, has_errors = _reported(answer, selection, project)
    closing = tuple(_closing(answer, arguments))
    if is_page and not traced:
        closing = (*closing, _TOO_MANY_TRACES)
    synthesis = answer.synthesis
    specified = None if synthesis is None else synthesis.specification.configuration
    consequences = _among_topics(answer, topics) if is_page else ()
    # The grounding takes as much memory as traces, which do not need it, so it is not kept.
    return Explained(
        subject, topics, closing, has_errors, messages, traced, specified, absent, consequences
    )


def _among_topics(answer: Explanation, topics: Sequence[Topic]) -> tuple[Consequence, ...]:
    """Return the consequences that are topics of an explanation."""
    atoms = {topic.atom for topic in topics}
    return tuple(each for each in answer.analysis.consequences if each.atom in atoms)


def explanation_html(found: Explained, project: Project) -> str:
    """Return an explanation as an HTML report."""
    from mars_asp.cli.explain_page import explanation_page

    return explanation_page(
        project,
        found.specification,
        found.topics,
        found.consequences,
        found.messages,
        found.absent,
        found.closing,
    )


def explanation_text(found: Explained, arguments: argparse.Namespace) -> Iterator[str]:
    """Yield the parts of an explanation in the requested format."""
    if arguments.format == "text":
        # Without topics, the closing sentence is the answer about the subject.
        is_answer = found.subject is not None and not found.topics
        width = columns(sys.stdout)
        closing = [
            line
            for text in found.closing
            # A command is not broken.
            for line in ([text] if text.startswith(_TO_LIST) else wrapped(text, width, "", "  "))
        ]
        if arguments.quiet and not is_answer:
            closing = []
        lines = chain(_topic_lines(found.topics, found.is_traced, arguments), closing)
        yield from (f"{line}\n" for line in lines)
        return
    from mars_asp.cli.trace_document import topics_text

    yield from topics_text(found.subject, found.topics, arguments.format)


def _explained_findings(
    project: Project, subject: str | None, arguments: argparse.Namespace
) -> Explained | None:
    """Return the findings in launch trees or a dataflow, or None if none has the subject."""
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
    explained_of = partial(
        launch_trees.explain_findings, analysis, rules, every=arguments.every, traced=traced
    )
    answer = explained_of(subject)
    if answer is None and subject is not None:
        # A program has no slash before its name, and a node or topic has.
        kind, bracket, name = subject.rpartition("(")
        spellings = (f"{kind}{bracket}{slash}{name.removeprefix('/')}" for slash in ("", "/"))
        answer = next(filter(None, map(explained_of, spellings)), None)
    messages, _ = selection.messages(project, unapplied_packs(project, rulebook))
    if answer is None:
        closing = _no_finding(project, analysis, rules, subject, of, arguments)
        if closing is None:
            return None
        return Explained(subject, (), (closing,), False, messages, traced)
    topics, has_errors = _reported(answer, selection, project)
    found_nothing = () if topics else (f"nothing found in {of}",)
    consequences = () if arguments.output is None else _among_topics(answer, topics)
    found = Explained(answer.subject, topics, found_nothing, has_errors, messages, traced)
    return found._replace(consequences=consequences)


def _no_finding(
    project: Project,
    analysis: Analysis,
    rules: Rulebook,
    subject: str | None,
    of: str,
    arguments: argparse.Namespace,
) -> str | None:
    """Return the sentence that no finding is about a subject, or why; None for unknown subjects.

    Raises:
        MarsError: `subject` looks like a name or file of launch files, which do not have it.
    """
    if subject in {name.text for name in project.configuration.modules}:
        return f"no finding about `{subject}` in {of}"
    if subject in rules.by_id or subject in consequence_kinds(rules):
        return f"no finding of `{subject}` in {of}"
    if subject is None or not project.trees:
        return None
    from mars_asp.reasoning.questions.why_no_finding import names_in, unknown_name

    names = names_in(analysis)
    line = _LINE.fullmatch(subject)
    if line is not None:
        is_read = any(f"/{name}".endswith(f"/{line[1]}") for name in names)
        if not is_read and not Path(line[1]).is_file():
            raise unknown_name(project, analysis, line[1])
        return f"no finding at `{subject}` in {of}"
    for name in (subject, f"/{subject}"):
        if name in names:
            return f"no finding about `{name}` in {of}"
    if subject.startswith("/") and "./" not in subject:
        raise unknown_name(project, analysis, subject)
    why = _why_no_finding(project, analysis, rules, subject, arguments)
    if why is not None:
        return why.answer
    # Names of ROS may be written without their first slash.
    near = nearest(f"/{subject}", (name for name in names if name.startswith("/")))
    is_node = project.configuration.node_kind(subject) is not None
    if near and not is_node and nearest(subject, consequence_kinds(rules)) is None:
        raise unknown_name(project, analysis, subject)
    return None


def _wants_traces(arguments: argparse.Namespace) -> bool:
    deeper = arguments.every or arguments.places or hasattr(arguments, "depth")
    return deeper or arguments.format != "text" or arguments.output is not None


def _reported(
    answer: Explanation, selection: Selection, project: Project
) -> tuple[tuple[Topic, ...], bool]:
    """Return the reported topics, and whether an error is reported.

    Topics of a requested subject are reported even if their findings are hidden elsewhere.
    """
    if answer.subject is not None or selection.leaves_all(project):
        return answer.topics, selection.has_errors(project, answer.analysis)
    selected = selection.among(project, answer.analysis.consequences)
    shown = {f"{each.kind}({each.subject})" for each in selected.shown}
    left = (each for each in answer.topics if each.sort != "consequence" or each.name in shown)
    return tuple(left), selected.has_errors


def _resting(answer: Explanation, lines: Sequence[Span]) -> Iterator[Topic]:
    """Yield the topics that cite one of the lines, and the findings at one."""
    wanted = {span[:2] for span in lines}
    found = answer.analysis.consequences
    here = {each.atom for each in found if any(at[:2] in wanted for at in each.spans[:1])}
    for topic in answer.topics:
        cites = () if topic.account is None else topic.account.cites
        if topic.atom in here or any(each.span[:2] in wanted for each in cites):
            yield topic


def _absent(reasoner: Reasoner, answer: Explanation, only: Sort | None) -> Sequence["Absence"]:
    """Return why modules lack further nodes or consequences; `only` selects one sort."""
    from mars_asp.reasoning.questions.absences import absences

    names = [name.text for name in reasoner.project.configuration.modules]
    if answer.subject is not None:
        entries = [title for each in answer.topics for title in (each.name, *each.resolves)]
        about = {answer.subject, *(title.partition("(")[2].removesuffix(")") for title in entries)}
        names = [name for name in names if name in about]
    return tuple(absences(reasoner, names, only))


def _rule_or_kind(arguments: argparse.Namespace) -> str | None:
    """Return the text on the only argument, if it is a rule or kind and not a file, or None."""
    name, *further = arguments.files
    is_alone = arguments.subject is None and not further and name != STANDARD_INPUT
    if not is_alone or Path(name).exists():
        return None
    from mars_asp.cli.rules import rule_or_kind_text

    return rule_or_kind_text(name, arguments)


def _split_location(arguments: argparse.Namespace) -> None:
    """Change `FILE:LINE` or `FILE:LINE:COLUMN` in the arguments into file and subject."""
    name, *further = arguments.files
    match = re.fullmatch(r"(.+?):([0-9]+)(?::[0-9]+)?", name)
    if match is None or further or arguments.subject is not None or Path(name).exists():
        return
    path, line = match.groups()
    if not Path(path).is_file():
        return
    arguments.files, arguments.subject = [path], f"{Path(path).name}:{line}"
    text = read_text(Path(path))
    if arguments.from_format is None and _is_part(path, text):
        # A source is read within its workspace, which may have several of its name.
        workspace = workspace_of(path)
        if workspace is not None:
            arguments.files, arguments.subject = [workspace], f"{path}:{line}"


def _is_part(path: str, text: str) -> bool:
    """Whether a file only belongs to a robot: a source, or YAML that is not a mux."""
    form = recognised(text)
    if form != "twist_mux":
        return form == "mars" and is_other_file(path, text)
    from mars_asp.exchange.twist_mux.document import read_documents

    try:
        return not read_documents([(text, path)])
    except MarsError:
        return True


def _place(subject: str, arguments: argparse.Namespace) -> str:
    """Return `FILE:LINE` with the path as in locations; other subjects unchanged."""
    match = _LINE.fullmatch(subject)
    if match is None:
        return subject
    file, line = match.groups()
    if Path(file).is_file():
        is_absolute = Path(arguments.files[0]).is_absolute()
        file = str(Path(file).absolute()) if is_absolute else os.path.relpath(file)
    return f"{file}:{line}"


def _is_file(word: str, files: Sequence[str]) -> bool:
    """Whether a word names a file, or a folder unless `files` has a `.mars` file before it."""
    if word == STANDARD_INPUT or Path(word).is_file():
        return True
    is_folder = word != "" and Path(word).is_dir()
    return is_folder and not any(file.endswith(".mars") for file in files)


def _contradiction(arguments: argparse.Namespace) -> str | None:
    """Return the message that options contradict each other, or None."""
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


def why_not_answer(reasoner: Reasoner, arguments: argparse.Namespace) -> "WhyNot":
    """Return why an atom, a relationship as a configuration states it, or a finding is absent.

    Raises:
        MarsError: clingo refuses rules, or `why_not` names neither a module nor a kind.
    """
    from mars_asp.reasoning.questions.why_not import why_not

    project, atom = reasoner.project, arguments.why_not
    kind = atom.partition("(")[0].strip()
    if project.trees or kind not in consequence_kinds(rulebook_for(arguments)):
        judging = rulebook_for(arguments, JUDGING)
        found, rules = analyse_trees(project, judging), launch_rules(judging)
        answer = _why_no_finding(project, found, rules, atom, arguments)
        if answer is not None:
            return answer
    line = read_relationship(atom, project)
    answer = why_not(reasoner, atom if line is None else line.atom, _levels(arguments))
    if line is None or line.atom == atom:
        return answer
    return replace(answer, subject=line.line, answer=_of_line(answer.answer, line))


def _misplaced_words(arguments: argparse.Namespace) -> str | None:
    """Return the error that a subject precedes the file, or is a second one, or None."""
    # A word with a suffix may be the path of a file that is missing.
    words = [
        each
        for each in arguments.files
        if each != STANDARD_INPUT and not (os.path.exists(each) or re.search(r"\.[a-z]+$", each))  # noqa: PTH110 -- never raises
    ]
    if arguments.subject is not None and words and words[0] != arguments.files[0]:
        named = "`, `".join((*words, arguments.subject))
        return f"one SUBJECT is explained at a time, found `{named}`"
    if len(arguments.files) != 2 or words != arguments.files[:1]:
        return None
    first, *others = arguments.files
    swapped = command("explain", argparse.Namespace(**vars(arguments) | {"files": others}), first)
    return f"`{first}` is not a file, and words about it come after the files: {swapped}"


def _why_no_finding(
    project: Project,
    analysis: Analysis,
    rules: Rulebook,
    subject: str,
    arguments: argparse.Namespace,
) -> "WhyNot | None":
    """Return why the launch files lack such a finding, None if `subject` is not a finding."""
    from mars_asp.reasoning.questions.why_no_finding import why_no_finding

    return why_no_finding(project, analysis, rules, subject, _levels(arguments))


def _levels(arguments: argparse.Namespace) -> int:
    """Return the number of levels of rules to search for a `--depth`."""
    depth: int | None = getattr(arguments, "depth", ABSENCE_DEPTH)
    return _MOST_LEVELS if depth is None else 2 * depth


def _why_not(project: Project, arguments: argparse.Namespace) -> int:
    rulebook = rulebook_for(arguments)
    selection = Selection(arguments, rulebook)
    report((*selection.messages(project)[0], *one_of_several(project, arguments)), arguments)
    reasoner = Reasoner(project, rulebook, Budget(arguments.time_limit))
    answer = why_not_answer(reasoner, arguments)
    if arguments.format == "json":
        from mars_asp.cli.trace_document import why_not_document

        print(encoded(why_not_document(answer)))
    else:
        first, *others = why_not_paragraphs(answer, arguments, project.format)
        coloured = colours(arguments, sys.stdout)
        sys.stdout.writelines(f"{paint(line, 'strong', coloured)}\n" for line in first)
        sys.stdout.writelines(f"{line}\n" for lines in others for line in lines)
    return int(selection.has_errors(project, answer.analysis))


def _of_line(answer: str, relationship: RelationshipQuery) -> str:
    """Return an answer about an atom with the atom replaced by the relationship."""
    reason = answer.removeprefix(f"No {relationship.atom}: ")
    if reason != answer:
        return f"{reason[:1].upper()}{reason[1:]}"
    return answer.replace(relationship.atom, f"`{relationship.line}`")


def why_not_paragraphs(
    answer: "WhyNot", arguments: argparse.Namespace, format: str | None
) -> Iterator[Sequence[str]]:
    """Yield groups of lines: answer, evidence, the change that gives the atom, commands."""
    width = columns(sys.stdout)

    def below(text: str) -> Sequence[str]:
        return wrapped(visible(text), width, BELOW, BELOW + FURTHER)

    yield wrapped(visible(answer.answer), width, "", FURTHER)
    yield [*located_lines(answer.evidence, BELOW, _MOST_EVIDENCE)]
    if answer.to_get is not None:
        # Edits apply to `.mars` files, and not to foreign ones.
        where = f", in what `mars-asp import {format}` prints" if format else ""
        yield below(f"To get one{where}: {answer.to_get}")
    if answer.extra is not None:
        price = compared(by_name(answer.extra))
        yield below(f"A specification with it{'' if price.startswith('costs') else ':'} {price}.")
    if answer.obstacles:
        query = command("explain", arguments, "--repair")
        yield [f"{BELOW}To see what would fix that:", f"{BELOW}{BELOW}{query}"]
    if answer.see is not None:
        yield [f"{BELOW}Why: {command('explain', arguments, answer.see)}"]


def _alternatives_count(text: str) -> int:
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
    """Yield the sentences after the traces."""
    if arguments.only == "nodes" and answer.synthesis is None:
        yield f"{unrealised(answer.analysis)}, so there is no node to explain"
    elif not answer.topics and answer.subject is not None:
        yield f"no consequence and no node rests on `{answer.subject}`"
    elif not answer.topics and arguments.only != "nodes":
        yield "nothing to resolve, so nothing to explain"
    if answer.synthesis is not None and answer.subject is None:
        yield _summary(answer)
        if (answer.synthesis.resolution.count or 1) > 1:
            yield f"{_TO_LIST}{command('explain', arguments, '--alternatives')}"
    elif answer.subject is None and arguments.only is None:
        yield unrealised(answer.analysis)


def _topic_lines(
    topics: Sequence[Topic], traced: bool, arguments: argparse.Namespace
) -> Iterator[str]:
    """Yield the lines of topics: accounts, or traces if requested or if an account is missing."""
    if not topics:
        return
    coloured = colours(arguments, sys.stdout)
    if traced or any(topic.account is None for topic in topics):
        entries = [(topic.title, topic.trace) for topic in topics]
        yield from _trace_lines(entries, getattr(arguments, "depth", DEPTH), arguments)
        return
    width = columns(sys.stdout)
    repeated = set(_covered_by_nodes(topics))
    for topic in topics:
        if topic.account is not None and topic.name not in repeated:
            yield ""
            first, *others = account_lines(topic, topic.account, width)
            yield paint(first, "strong", coloured)
            yield from others
    yield ""


def _covered_by_nodes(topics: Sequence[Topic]) -> Iterator[str]:
    """Yield the consequences whose lines are all cited by the node that resolves them.

    The paragraph of the node covers these consequences. Errors and warnings have their own.
    """
    lines = {
        topic.name: {each.span[:2] for each in topic.account.cites}
        for topic in topics
        if topic.account is not None and topic.severity not in ("error", "warning")
    }
    for node in topics:
        for name in node.resolves:
            if name in lines and node.name in lines and lines[name] <= lines[node.name]:
                yield name


def _trace_lines(
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
    others = "" if count is None else f"; {counted(count, 'such specification')}"
    return f"{counted(nodes, 'node')}, {proof}{others}"
