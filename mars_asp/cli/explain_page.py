"""Explanations as an HTML report: findings, diagram, reasons, and the lines that cause them.

The report fetches nothing, and runs only its own script, whatever the names contain.
"""

import contextlib
import json
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from html import escape
from importlib.resources import files
from string import Template
from typing import Any, NamedTuple

import clingo

from mars_asp.asp.trace.document import trace_lines
from mars_asp.asp.trace.text import traces_text
from mars_asp.asp.trace.tree import Unexplained
from mars_asp.cli.lines import line_at, lines_of
from mars_asp.diagnostic import Diagnostic, Span
from mars_asp.draw import Picture, depict
from mars_asp.draw.layered import TooLargeError
from mars_asp.draw.marks import marked, number_findings
from mars_asp.draw.page import whole_page
from mars_asp.draw.picture import NumberedFinding
from mars_asp.draw.svg import svg_text
from mars_asp.exchange.lift import realised_by, with_own_muxes
from mars_asp.model.declarations import Configuration
from mars_asp.output import counted, visible
from mars_asp.reasoning.analysis import Consequence
from mars_asp.reasoning.project import Project
from mars_asp.reasoning.questions.absences import Absence
from mars_asp.reasoning.questions.explain import Topic

#: Larger diagrams take long to draw and are unreadable.
MOST_BOXES = 500
#: Of longer files only the cited lines are shown.
MOST_LINES = 20_000
#: Replaces the module in a text about many modules; visible texts never contain it.
NAME = "\x01"
#: An answer shows at most so many of the lines that it is about.
_MOST_EVIDENCE = 6
#: The headings, and the severities or sorts of the topics below each.
_SORTS: Mapping[str, tuple[str, ...]] = {
    "Errors": ("error",),
    "Warnings": ("warning",),
}
_FURTHER_SORTS: Mapping[str, tuple[str, ...]] = {
    "Other consequences": ("note",),
    "Nodes": ("node",),
    "Atoms": ("atom",),
}


def explanation_page(
    project: Project,
    specification: Configuration | None,
    topics: Sequence[Topic],
    found: Sequence[Consequence],
    messages: Sequence[Diagnostic],
    absent: Sequence[Absence],
    closing: Iterable[str],
) -> str:
    """Return an HTML report of topics, with a diagram of the specification or the configuration.

    `found` are the consequences to mark in the diagram, `messages` are about reading the files,
    and `closing` are sentences about all topics. The report answers why something is `absent`.
    """
    sources = _Sources(project.configuration.path)
    # The user's own file comes first, and is shown even without findings in it.
    sources.name(project.configuration.path)
    numbers = {topic.name: number for number, topic in enumerate(topics, 1)}
    findings = number_findings(found)
    muxes = {} if specification is None else realised_by(specification)
    finding_of = {consequence.atom: finding for finding, consequence in findings}
    page = _Topics(topics, numbers, finding_of, muxes, sources)
    severities = [*(each.severity for each in messages), *(each.severity for each in topics)]
    notes = [each for each in messages if each.severity == "note"]
    grave = [each for each in messages if each.severity != "note"]
    drawn = with_own_muxes(specification or project.configuration)
    picture = marked(depict(drawn, project.modules), findings)
    modules = dict.fromkeys(each.module for each in absent)
    module_numbers = {module: number for number, module in enumerate(modules)}
    data = {**_traces(topics, sources), **_answers(project, absent, numbers, sources)}
    title = sources.name(project.configuration.path)
    body = Template(_part("html")).substitute(
        title=escape(title),
        summary="\n".join(f"<p>{_code_html(line)}</p>" for line in closing),
        counts=_counts(Counter(severities)),
        findings="\n".join((*page.sections(_SORTS), *_messages("About the files", grave, sources))),
        picture=_figure(picture, drawn.kind, _targets(picture, page, module_numbers)),
        absences=_question(absent, module_numbers),
        topics="\n".join(
            (*page.sections(_FURTHER_SORTS), *_messages("Notes on the files", notes, sources))
        ),
        files="\n".join(sources.sections()),
    )
    traces = json.dumps(data, separators=(",", ":"))
    return whole_page(title, _part("css"), body, _part("js"), {"traces": traces})


def _part(ending: str) -> str:
    part = files("mars_asp.cli") / f"explain_page.{ending}"
    return part.read_text(encoding="utf-8")


def _code_html(text: str) -> str:
    """Return a text as HTML, with code for names between backticks."""
    return re.sub("`([^`]*)`", r"<code>\1</code>", escape(visible(text)))


# ---- Files ---------------------------------------------------------------------------------------


@dataclass
class _Sources:
    """The files of the report by path, and the cited lines of each."""

    configuration: str
    _numbers: dict[str, int] = field(default_factory=dict)
    _lines: dict[str, Sequence[str]] = field(default_factory=dict)
    _cited: dict[str, set[int]] = field(default_factory=dict)

    def name(self, path: str) -> str:
        """Return the shown name of a file: its path from the folder of the configuration."""
        if path not in self._lines:
            self._numbers[path] = len(self._numbers) + 1
            self._lines[path], self._cited[path] = lines_of(path), set()
        folder, slash, _ = self.configuration.rpartition("/")
        return visible(path.removeprefix(folder + slash))

    def cite(self, path: str, line: int) -> str | None:
        """Register a line to show, and return its id; None if the file has no such line."""
        self.name(path)
        if not 0 < line <= len(self._lines[path]):
            return None
        self._cited[path].add(line)
        return f"f{self._numbers[path]}-{line}"

    def link(self, span: Span, place: str) -> str:
        """Return a link to a line with the text `place`, or only the text without such a line."""
        line = self.cite(span.path, span.line)
        shown = escape(visible(place))
        return shown if line is None else f'<a class="place" href="#{line}">{shown}</a>'

    def sections(self) -> Iterator[str]:
        """Yield the HTML of each file: all lines, or only the cited ones if it has many."""
        for path, number in self._numbers.items():
            lines = self._lines[path]
            name, cited = escape(self.name(path)), self._cited[path]
            whole = len(lines) <= MOST_LINES
            yield f'<section aria-labelledby="f{number}" data-name="{name}">'
            yield f'<h2 id="f{number}">{name}</h2>'
            if not whole:
                yield f'<p class="quiet">{len(cited)} of {len(lines)} lines</p>'
            yield "<ol>"
            for line in range(1, len(lines) + 1) if whole else sorted(cited):
                text = escape(visible(lines[line - 1].expandtabs(4)))
                yield f'<li id="f{number}-{line}" value="{line}">{text}</li>'
            yield "</ol></section>"


# ---- Topics --------------------------------------------------------------------------------------


def _counts(severities: Mapping[str | None, int]) -> str:
    """Return the HTML with the numbers of errors and warnings."""
    counts = [
        f'<span class="{severity}"><span class="severity">{sign} '
        f"{counted(severities[severity], severity)}</span></span>"
        for severity, sign in (("error", "✖"), ("warning", "▲"))
        if severities[severity]
    ]
    return ", ".join(counts) or '<span class="severity">✔ no errors and no warnings</span>'


def _messages(heading: str, messages: Sequence[Diagnostic], sources: _Sources) -> Iterator[str]:
    if messages:
        name = heading.partition(" ")[0].lower()
        yield f'<section aria-labelledby="{name}"><h2 id="{name}">{heading}</h2><ul>'
        for each in messages:
            place = sources.link(each.span, f"{sources.name(each.span.path)}:{each.span.line}")
            help_text = f"; {_code_html(each.help)}" if each.help else ""
            yield f"<li>{place} {each.severity}: {_code_html(each.message)}{help_text}</li>"
        yield "</ul></section>"


class _Topics(NamedTuple):
    """The topics of an HTML report with their numbers by name, and the findings by their atoms.

    `muxes` are the user's muxes by the names of the nodes that they realise.
    """

    topics: Sequence[Topic]
    numbers: Mapping[str, int]
    findings: Mapping[clingo.Symbol, NumberedFinding]
    muxes: Mapping[str, str]
    sources: _Sources

    def sections(self, headings: Mapping[str, tuple[str, ...]]) -> Iterator[str]:
        """Yield the HTML section of each heading for which there are topics."""
        resolved: dict[str, list[str]] = {}
        for topic in self.topics:
            for name in topic.resolves:
                resolved.setdefault(name, []).append(topic.name)
        for heading, sorts in headings.items():
            chosen = [
                (number, topic)
                for number, topic in enumerate(self.topics, 1)
                if (topic.severity or topic.sort) in sorts
            ]
            if chosen:
                label = f"h-{sorts[0]}"
                yield f'<section class="sort" aria-labelledby="{label}">'
                yield f'<h2 id="{label}">{heading} ({len(chosen)})</h2>'
                for number, topic in chosen:
                    yield from self._topic(number, topic, resolved.get(topic.name, ()))
                yield "</section>"

    def _topic(self, number: int, topic: Topic, resolved_by: Iterable[str]) -> Iterator[str]:
        finding = self.findings.get(topic.atom) if topic.atom is not None else None
        kind, mark, sign = topic.severity or topic.sort, "", ""
        if finding is not None:
            mark = f' data-finding="{finding.number}"'
            sign = f'<span class="number">{finding.number}</span> '
        if topic.severity:
            sign += f'<span class="severity">{topic.severity}</span> '
        account = topic.account
        answer = account.answer if account is not None else None
        text = f": {_code_html(answer.rstrip('.'))}." if answer else ""
        name = f"<b>{escape(visible(topic.name))}</b>"
        if topic.name in self.muxes:
            name += f", which <code>{escape(visible(self.muxes[topic.name]))}</code> realises"
        place = ""
        if finding is not None and account is not None and account.cites:
            place = f' <span class="quiet">{escape(visible(account.cites[0].place))}</span>'
        yield f'<details class="topic {kind}" id="t{number}" name="topic"{mark}>'
        yield f"<summary>{sign}{name}{text}{place}</summary>"
        if account is not None:
            yield '<ul class="lines">'
            for cited in account.cites:
                label = f" {_code_html(cited.label)}" if cited.label else ""
                line = escape(visible(line_at(cited.span)))
                link = self.sources.link(cited.span, cited.place)
                yield f"<li>{link} <code>{line}</code>{label}</li>"
            yield "</ul>"
            yield from (f"<p>{_code_html(note)}</p>" for note in account.notes)
        elif not isinstance(topic.trace, Unexplained):
            lines = traces_text([(topic.title, topic.trace)], line_at)
            shown = "\n".join(escape(visible(line)) for line in list(lines)[1:])
            yield f"<noscript><pre>{shown}</pre></noscript>"
        for says, names in (("Resolves", topic.resolves), ("Resolved by", resolved_by)):
            links = []
            for name in names:
                shown = escape(visible(name))
                number_of = self.numbers.get(name)
                links.append(shown if number_of is None else f'<a href="#t{number_of}">{shown}</a>')
            if links:
                yield f"<p>{says} {', '.join(links)}.</p>"
        if topic.rule:
            yield f'<p class="rule">Rule {escape(visible(topic.rule))}</p>'
        yield "</details>"


# ---- Traces --------------------------------------------------------------------------------------


def _traces(topics: Sequence[Topic], sources: _Sources) -> dict[str, Any]:
    """Return the steps of all traces, each once, and the numbers of the steps of each topic.

    A step has its `kind`, its text (`says`), the id of its line (`at`), its `rule`, the numbers of
    its premises (`from`), and those of `others`: further derivations of the same atom.
    """
    steps: list[dict[str, Any]] = []
    why: list[list[int]] = []
    rules: dict[int, str] = {}
    paths: dict[int, str] = {}
    traced = [topic for topic in topics if not _is_untraced(topic)]
    for line in trace_lines(None, (({}, topic.trace) for topic in traced)):
        entry = json.loads(line)
        match entry:
            case {"step": _, "kind": kind, "atom": atom, "says": says}:
                place = entry["at"] and sources.cite(paths[entry["at"][0]], entry["at"][1])
                step = {
                    "kind": kind,
                    "says": None if says == atom else says,
                    "at": place,
                    "rule": rules.get(entry["rule"]),
                    "from": entry["from"],
                }
                steps.append({key: value for key, value in step.items() if value})
                if "other_of" in entry:
                    steps[entry["other_of"] - 1].setdefault("others", []).append(len(steps))
            case {"rule": number, "id": name}:
                rules[number] = name
            case {"file": number, "path": path}:
                paths[number] = path
            case {"why": numbers}:
                why.append(numbers)
    result = iter(why)
    return {"steps": steps, "why": [[] if _is_untraced(each) else next(result) for each in topics]}


def _is_untraced(topic: Topic) -> bool:
    return topic.account is not None and isinstance(topic.trace, Unexplained)


# ---- What is absent ------------------------------------------------------------------------------


def _question(absent: Sequence[Absence], module_numbers: Mapping[str, int]) -> str:
    """Return the HTML form to choose a kind and a module, or "" if nothing is `absent`."""
    if not absent:
        return ""
    kinds = list(dict.fromkeys(each.kind for each in absent))
    nodes = [kind for kind in kinds if kind[:1].isupper()]
    others = [kind for kind in kinds if kind not in nodes]
    groups = "".join(
        f'<optgroup label="{label}"><option value="{every}">{every} of any kind</option>'
        f"{''.join(f'<option>{escape(kind)}</option>' for kind in each)}</optgroup>"
        for label, every, each in (
            ("Nodes", "node", nodes),
            ("Consequences", "consequence", others),
        )
        if each
    )
    names = "".join(
        f'<option id="n{number}" value="{escape(visible(name))}"></option>'
        for name, number in module_numbers.items()
    )
    return f"""<section id="why-not" aria-labelledby="why-not-heading" hidden>
<h2 id="why-not-heading">Why not?</h2>
<p class="question"><label for="kind">Why is there no</label>
<select id="kind">{groups}</select>
<label for="module">for the module</label>
<input id="module" list="modules" autocomplete="off" spellcheck="false">
<datalist id="modules">{names}</datalist></p>
<div id="answers" role="status"></div></section>"""


def _answers(
    project: Project, absent: Sequence[Absence], numbers: Mapping[str, int], sources: _Sources
) -> dict[str, Any]:
    """Return as JSON why something is absent: answers by index of `names`, then of `kinds`.

    An answer is `null` or a list: an index of `texts`, in which `NAME` replaces the module, and the
    ids of a topic and of the lines that the text is about.
    """
    kinds = {kind: number for number, kind in enumerate(dict.fromkeys(a.kind for a in absent))}
    answers: dict[str, list[list[int | str] | None]] = {}
    texts: dict[str, int] = {}
    for each in absent:
        module = visible(each.module)
        answer = visible(each.answer).replace(f"`{module}`", f"`{NAME}`")
        if answer.startswith(f"No {each.kind}({module})"):
            answer = answer.replace(f"({module})", f"({NAME})", 1)
        found: list[int | str] = [texts.setdefault(answer, len(texts))]
        if each.present is not None and each.present in numbers:
            found.append(f"t{numbers[each.present]}")
        cited = (sources.cite(span.path, span.line) for span in each.evidence[:_MOST_EVIDENCE])
        found += [line for line in dict.fromkeys(cited) if line is not None]
        row = answers.setdefault(module, [None] * len(kinds))
        row[kinds[each.kind]] = found
    return {
        "kinds": list(kinds),
        "names": list(answers),
        "texts": list(texts),
        "answers": list(answers.values()),
        "path": sources.name(project.configuration.path),
    }


# ---- The picture ---------------------------------------------------------------------------------


def _figure(picture: Picture, kind: str, targets: Mapping[str | int, str]) -> str:
    svg = None
    if len(picture.boxes) <= MOST_BOXES:
        with contextlib.suppress(TooLargeError):
            svg = svg_text(picture, targets)
    if svg is None:
        return (
            f'<p class="quiet">There is no picture here: {len(picture.boxes)} boxes with '
            f"{len(picture.lines)} lines are too many to be read. <code>mars-asp draw</code> "
            "writes one to a file.</p>"
        )
    introduced = sum(box.node is not None for box in picture.boxes)
    nodes = f", {introduced} of them introduced" if introduced else ""
    caption = (
        f"The {kind}: {len(picture.boxes)} boxes{nodes}. "
        "A box that is a link opens what is found there, or what is not."
    )
    return (
        '<figure><div class="drawing" role="region" aria-label="Picture" tabindex="0">'
        f"{svg}</div><figcaption>{caption}</figcaption></figure>"
    )


def _targets(
    picture: Picture, page: _Topics, module_numbers: Mapping[str, int]
) -> dict[str | int, str]:
    """Return the links of findings by their numbers, and of diagram boxes by their names.

    A box links to its first finding, else to its node or the gravest topic about it, else to the
    question why not.
    """
    found: dict[str | int, str] = {}
    order = [sort for sorts in (*_SORTS.values(), *_FURTHER_SORTS.values()) for sort in sorts]
    ranked = sorted(
        enumerate(page.topics, 1), key=lambda each: order.index(each[1].severity or each[1].sort)
    )
    for number, topic in ranked:
        if topic.atom is not None and topic.atom in page.findings:
            found[page.findings[topic.atom].number] = f"#t{number}"
    for box in picture.boxes:
        if box.findings:
            found[box.name] = found[box.findings[0].number]
    shown = {box.name for box in picture.boxes}
    for number, topic in ranked:
        name = visible(page.muxes.get(topic.name, topic.name))
        if topic.sort == "consequence":
            subject = name.partition("(")[2].removesuffix(")")
            # A topic about a port is about its module.
            name = subject if subject in shown else subject.partition(".")[0]
        found.setdefault(name, f"#t{number}")
    for module, number in module_numbers.items():
        found.setdefault(visible(module), f"#n{number}")
    return found
