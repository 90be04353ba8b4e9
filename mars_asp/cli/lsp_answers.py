"""The process that answers the language server, one question after another, within limits.

It calls the functions of `check`, `explain` and `rules lint`, so it has the same findings.
"""

import argparse
import gc
import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import suppress
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mars_asp.annotations.files import extract, find_paths
from mars_asp.asp.contained import begin_group, limit_memory, serve
from mars_asp.asp.trace.text import traces_text
from mars_asp.cli.arguments import parser_of
from mars_asp.cli.check import check
from mars_asp.cli.extract import module_lines
from mars_asp.cli.inputs import load, rulebook_for
from mars_asp.cli.limits import memory_limit
from mars_asp.cli.lines import forget_all, line_at, remember
from mars_asp.cli.lsp_files import EditorFiles
from mars_asp.cli.lsp_rules import lint_answer
from mars_asp.cli.results import Result
from mars_asp.diagnostic import MarsError
from mars_asp.language.format import format_text
from mars_asp.language.parse import parse_text, plain_lines
from mars_asp.lsp.actions import QuickFix, line_edits
from mars_asp.lsp.occurrences import outline
from mars_asp.lsp.places import START, Place
from mars_asp.lsp.questions import CheckedFile, Failed, Question, Sort, Survey
from mars_asp.lsp.robot import Described, EditorRobot, OpenFile, prefixed_name
from mars_asp.model.declarations import Module
from mars_asp.model.ports import inputs, outputs
from mars_asp.reading import overlay
from mars_asp.reasoning.analysis import Consequence
from mars_asp.reasoning.budget import Budget
from mars_asp.reasoning.project import Project, port_names
from mars_asp.reasoning.questions.explain import explain
from mars_asp.reasoning.questions.repair import STAGES as REPAIRING
from mars_asp.reasoning.questions.repair import repairs
from mars_asp.reasoning.rules import STAGES, load_rulebook
from mars_asp.reasoning.session import Reasoner

if TYPE_CHECKING:
    from mars_asp.reasoning.questions.repair import Repair

#: Seconds for the search for repairs.
_REPAIR_SECONDS = 20.0
#: The width of a trace in an editor, in characters.
_WIDTH = 90
#: A trace is cut after so many lines.
_MOST_LINES = 60
#: At most so many configurations are searched for a source.
_MOST_OWNERS = 50


def main() -> None:
    """Answer the questions of standard input until it is closed."""
    serve(_begin)


def _begin(given: int, options: argparse.Namespace) -> Callable[[Question], Any]:
    """Load the built-in rules; return the function that answers; `given` is a watched pipe."""
    begin_group(given)
    with suppress(OSError, ValueError):
        limit_memory(memory_limit(options))
    load_rulebook((), STAGES)
    gc.freeze()
    return lambda question: answer(question, options)


def answer(question: Question, options: argparse.Namespace) -> Any:
    """Return the answer to a question, or `Failed` with the reason.

    `options` are those of the server: rules, sources and limits.
    """
    forget_all()
    try:
        with overlay(question.texts):
            for path, text in question.texts.items():
                remember(path, plain_lines(text))
            return _ANSWERS[question.sort](question, options)
    except MemoryError:
        return Failed("the memory limit ended it; --memory-limit MB allows more")
    except RecursionError:
        return Failed("it is nested too deep")
    except TimeoutError:
        return Failed("it took too long")
    except OSError as error:
        return Failed(error.strerror or "a file cannot be read")
    except Exception as error:  # the next question must be answered
        return Failed(f"internal error, please report it: {error!r:.300}")


def _call(verb: str, path: str, options: argparse.Namespace) -> argparse.Namespace:
    """Return the arguments of a command for a file, with the server's options."""
    _, parser = parser_of(verb)
    words = [path, *(f"--rules={each}" for each in options.rules)]
    words += [f"--sources={each}" for each in options.sources]
    return parser.parse_intermixed_args(words)


# ---- Robots --------------------------------------------------------------------------------------


def _answer_check(question: Question, options: argparse.Namespace) -> CheckedFile:
    """Return the findings of `mars-asp check` for a file, and its robot."""
    arguments = _call("check", question.path, options)
    # This format avoids the search for repairs.
    arguments.format = "github"
    seen: list[Project] = []
    try:
        checked, remarks = check(arguments, lambda project, _: seen.append(project))
        results = [*(each for one in checked for each in one.results), *remarks]
    except MarsError as error:
        results = [Result(each) for each in error.diagnostics]
    files = EditorFiles(question.path)
    findings = tuple(
        files.finding(each.diagnostic, _title(each.consequence) if each.consequence else None)
        for each in results
        if each.hidden is None
    )
    return CheckedFile(findings, _editor_robot(seen[0], files) if seen else None)


def _source(question: Question, options: argparse.Namespace) -> CheckedFile:
    """Return the findings of `mars-asp extract` for a source, and its modules."""
    files = EditorFiles(question.path)
    found = extract([Path(question.path)])
    findings = tuple(files.finding(each) for each in found.diagnostics)
    text = files.text(question.path)
    own = OpenFile(question.path, "", outline(question.path, text.written).mentions if text else ())
    described = {each.name: _module_description(each, files) for each in found.modules}
    return CheckedFile(findings, EditorRobot(question.path, (own,), described))


def _editor_robot(project: Project, files: EditorFiles) -> EditorRobot:
    configuration = project.configuration
    described = configuration.with_declared(project.modules)
    own = tuple(_configurations(configuration.path, "", files))
    read = {file.path for file in own}
    sources = dict.fromkeys(os.path.abspath(each.span.path) for each in project.modules.values())  # noqa: PTH100
    found = []
    for path in sources:
        text = files.text(path) if path not in read else None
        if text is not None:
            found.append(OpenFile(path, "", outline(path, text.written).mentions))
    modules = {name: _module_description(module, files) for name, module in described.items()}
    return EditorRobot(os.path.abspath(configuration.path), (*own, *found), modules)  # noqa: PTH100


def _configurations(path: str, prefix: str, files: EditorFiles) -> Iterator[OpenFile]:
    """Yield the configuration at a path, and the files that it includes, as open files."""
    text = files.text(path)
    if text is None:
        return
    yield OpenFile(text.path, prefix, outline(text.path, text.written).mentions)
    for each in parse_text(text.plain, path).configuration.includes:
        inner = os.path.abspath(Path(path).parent / each.path)  # noqa: PTH100
        yield from _configurations(
            inner, prefixed_name(prefix, each.name) if each.name else prefix, files
        )


def _module_description(module: Module, files: EditorFiles) -> Described:
    lines = tuple(module_lines(module))
    services = [files.place(each.span) for each in module.services]
    nowhere = Place(files.root, START)
    return Described(
        lines,
        files.place(module.named or module.span) or nowhere,
        {name: services[number] or nowhere for name, number in outputs(module).items()},
        {
            name: services[each.parameters[0].service] or nowhere
            for name, each in inputs(module).items()
        },
    )


def _reasoner(question: Question, options: argparse.Namespace, *stages: str) -> Reasoner:
    """Return the reasoner of the robot of a question.

    Raises:
        MarsError: the files of the robot or rules have errors.
    """
    arguments = _call("explain", question.path, options)
    rulebook = rulebook_for(arguments, stages)
    return Reasoner(load(arguments, question.path), rulebook, Budget(options.time_limit))


def _survey(question: Question, options: argparse.Namespace) -> Survey | Failed:
    """Return the consequences and nodes of each module."""
    try:
        reasoner = _reasoner(question, options, "resolve")
        found = reasoner.analysis.consequences
        synthesis = reasoner.synthesis
    except MarsError as error:
        return Failed(str(error))
    project = reasoner.project
    ports = {text: module for text, (module, _) in port_names(project).items()}
    names = {each.text for each in project.configuration.modules} | project.modules.keys()
    about: dict[str, dict[str, None]] = {}
    for each in found:
        ends = (ports.get(end, end) for end in (each.subject, *each.participants))
        for name in dict.fromkeys(end for end in ends if end in names):
            about.setdefault(name, {})[f"{each.kind}({each.subject}): {each.message}"] = None
    nodes: dict[str, dict[str, None]] | None = None
    if synthesis is not None:
        nodes = {}
        for node, titles in synthesis.specification.resolves.items():
            for title in titles:
                subject = title.partition("(")[2].removesuffix(")")
                subject = ports.get(subject, subject)
                nodes.setdefault(subject, {})[node] = None
    return Survey(_as_tuples(about), None if nodes is None else _as_tuples(nodes))


def _as_tuples(found: Mapping[str, Iterable[str]]) -> dict[str, tuple[str, ...]]:
    return {name: tuple(each) for name, each in found.items()}


def _trace(question: Question, options: argparse.Namespace) -> str | Failed:
    """Return the trace of the subject of a question as text, to the default depth."""
    try:
        found = explain(_reasoner(question, options, "resolve", "account"), question.about)
    except MarsError as error:
        return Failed(str(error))
    entries = [(topic.title, topic.trace) for topic in found.topics]
    lines = list(islice(traces_text(entries, line_at, width=_WIDTH), _MOST_LINES + 1))
    if len(lines) > _MOST_LINES:
        lines[_MOST_LINES:] = ["    ..."]
    home = f"{Path(question.path).parent}{os.sep}"
    return "\n".join(lines).replace(home, "").strip("\n")


def _repairs(question: Question, options: argparse.Namespace) -> tuple[QuickFix, ...]:
    """Return the edits that remove findings, each verified by an analysis."""
    try:
        reasoner = _reasoner(question, options, *REPAIRING)
        project, rulebook = reasoner.project, reasoner.rulebook
        found = repairs(project, rulebook, seconds=_REPAIR_SECONDS, with_warnings=True)
    except MarsError:
        # The check reports the errors of the files.
        return ()
    files = EditorFiles(question.path)
    return tuple(each for repair in found for each in _actions(repair, files))


def _actions(repair: "Repair", files: EditorFiles) -> Iterator[QuickFix]:
    for mend in repair.mends:
        texts = {each.path: files.text(each.path) for each in mend.lines}
        known = {path: text for path, text in texts.items() if text is not None}
        if len(known) == len(texts):
            message = "; ".join(edit.message for edit in mend.edits)
            is_sole = repair.complete and len(repair.mends) == 1
            edits = tuple(line_edits(known, mend.lines))
            yield QuickFix(message, edits, _title(repair.consequence), is_sole)


def _title(consequence: Consequence) -> str:
    return str(consequence.atom)


def _owners(question: Question, options: argparse.Namespace) -> tuple[str, ...]:
    """Return the configurations, in folders above a source, whose `@sources` contain it.

    The search ends at the folder `about` of the question.
    """
    source = Path(question.path)
    found: list[str] = []
    looked = 0
    for folder in source.parents:
        for path in sorted(folder.glob("*.mars")):
            looked += 1
            if looked > _MOST_OWNERS:
                return tuple(found)
            if path.is_file() and _names_source(path, source):
                found.append(str(path))
        if str(folder) == question.about or (folder / ".git").exists():
            break
    return tuple(found)


def _names_source(configuration: Path, source: Path) -> bool:
    """Whether `@sources` of a configuration, or of its included files, name a file."""
    try:
        text = EditorFiles(str(configuration)).text(str(configuration))
        parsed = None if text is None else parse_text(text.plain, str(configuration))
    except (MarsError, OSError):
        return False
    real = source.resolve()
    for name in parsed.configuration.sources if parsed is not None else ():
        for path in find_paths(name.text, configuration.parent):
            if path.resolve() == real or real.is_relative_to(path.resolve()):
                return True
    return False


def _format(question: Question, options: argparse.Namespace) -> str | Failed:
    """Return the text that `mars-asp fmt` writes, or `Failed` if there are syntax errors."""
    text = EditorFiles(question.path).text(question.path)
    try:
        return Failed("there is no text") if text is None else format_text(text.plain, text.path)
    except MarsError as error:
        return Failed(str(error))


_ANSWERS: Mapping[Sort, Callable[[Question, argparse.Namespace], Any]] = {
    "check": _answer_check,
    "source": _source,
    "survey": _survey,
    "trace": _trace,
    "repairs": _repairs,
    "owners": _owners,
    "lint": lint_answer,
    "format": _format,
}
