"""Configurations as cases: their comments state the expected findings and introduced nodes."""

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from mars_asp.asp.cases import Check, Failure, Outcome
from mars_asp.asp.cases.outcomes import shown_beside
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.diagnostic import Diagnostic, MarsError, Span, point
from mars_asp.language.parse import read_text
from mars_asp.model.declarations import Control, Strategy, node_names
from mars_asp.model.names import written
from mars_asp.reasoning.findings import SEVERITIES, consequence_kinds, kinds_of
from mars_asp.reasoning.project import load_project
from mars_asp.reasoning.rules import COSTS, by_name
from mars_asp.reasoning.session import Reasoner
from mars_asp.spelling import nearest, suggestion

SUFFIX = ".mars"
#: The line above the expectations that `snapshot` writes.
SNAPSHOT = "# snapshot: written by `mars-asp test --snapshot`, which replaces the lines below"
_CODE = "case"
_LINE = re.compile(
    r"(?P<before>[ \t]*(?:#|//)[ \t]*)(?P<what>expect(?:[ \t]+\w+)?|never|only):[ \t]*"
    r"(?P<rest>.*?)[ \t\r]*$",
    re.MULTILINE,
)
#: A comment that looks like an expectation, but has no colon or follows a statement.
_MALFORMED = re.compile(
    r"^[ \t]*(?:(?:#|//)[ \t]*expect(?!\w)|[^\s#/].*(?:#|//)[ \t]*expect(?:[ \t]+\w+)?:)",
    re.MULTILINE,
)
_FINDING = re.compile(
    r"(?:(?P<severity>note|warning|error)[ \t]+)?(?P<kind>[a-z]\w*)[ \t]*"
    r"(?:\((?P<subject>[^)]*)\))?(?:[ \t]+at[ \t]+(?P<lines>\d+(?:[ \t]*,[ \t]*\d+)*))?"
)
_COUNT = re.compile(r"(?P<name>\w+)[ \t]+(?P<count>\d+)")
_NONE = "no specification"
#: The severities that are counted.
_COUNTED = ("error", "warning")
#: The names that lines with counts can have; nodes also have those of the robot's packs.
_KNOWN = {"expect nodes": (), "expect cost": tuple(COSTS), "expect findings": _COUNTED}
_NUMBERED = ("nodes", "cost", "findings", "order")


@dataclass(frozen=True)
class ExpectedFinding:
    """The finding of an expectation; a field that is None (`lines`: empty) matches any value."""

    severity: str | None
    kind: str
    subject: str | None
    lines: tuple[int, ...] = ()

    def fits(self, found: "ReportedFinding", anywhere: bool = False) -> bool:
        """Whether a finding matches; `anywhere` ignores the severity and lines."""
        if self.kind != found.kind or self.subject not in (None, found.subject):
            return False
        if anywhere:
            return True
        return self.severity in (None, found.severity) and set(self.lines) <= set(found.lines)


@dataclass(frozen=True)
class ReportedFinding:
    """A finding of the configuration, with the lines of its file that it concerns."""

    severity: str
    kind: str
    subject: str
    lines: tuple[int, ...]

    def __str__(self) -> str:
        at = f" at {', '.join(map(str, self.lines))}" if self.lines else ""
        return f"{self.severity} {self.kind}({self.subject}){at}"


@dataclass(frozen=True)
class ExpectationLine:
    """A line with an expectation: its keyword `what`, and the texts `before` and after it.

    `wanted` are the findings that it lists, `counts` its counts, None if it has none.
    """

    what: str
    before: str
    text: str
    span: Span
    wanted: tuple[ExpectedFinding, ...] = ()
    counts: Mapping[str, int] | None = None


def is_case(path: Path) -> bool:
    """Whether a configuration contains an expectation."""
    try:
        text = read_text(path)
    except MarsError:
        return False
    return any(pattern.search(text) is not None for pattern in (_LINE, _MALFORMED))


def snapshot(path: Path, rulebook: Rulebook) -> str:
    """Return the text of a robot with expectations of its findings and specification at the end.

    An earlier snapshot in the text is replaced; other expectations stay.

    Raises:
        MarsError: the robot is wrong.
    """
    text = _without_snapshot(read_text(path))
    robot = _Robot(str(path), rulebook, text)
    new = [SNAPSHOT, *(f"# expect: {each}" for each in robot.reported if each.severity != "note")]
    new.append(f"# expect findings: {_all(robot.findings)}")
    if robot.is_realised:
        # A snapshot without Gates states what it stated before there were any.
        nodes = {name: count for name, count in robot.nodes.items() if count or name != "Gate"}
        new.append(f"# expect nodes: {_all(nodes)}")
        new.append(f"# expect cost: {_all(robot.cost)}")
    else:
        new.append(f"# expect: {_NONE}")
    new += [f"# expect order: {each}" for each in robot.orders]
    return text.rstrip("\n") + "\n\n" + "\n".join(new) + "\n"


def _without_snapshot(text: str) -> str:
    kept: list[str] = []
    within = False
    for line in text.split("\n"):
        within = line.rstrip("\r") == SNAPSHOT or (within and _LINE.match(line) is not None)
        if not within:
            kept.append(line)
    return "\n".join(kept)


def run_configuration(path: Path, rulebook: Rulebook) -> Outcome:
    """Run a configuration as a case.

    Raises:
        MarsError: the configuration is wrong, or an expectation cannot be read.
    """
    text = read_text(path)
    robot = _Robot(str(path), rulebook)
    lines, start = _expectation_lines(text, robot), point(robot.path, 1, 1)
    failures = tuple(failure for line in lines for failure in _unmet(line, lines, robot))
    if not lines:
        advice = "write what is expected, as in `# expect: warning KIND at LINE`, or use --update"
        failures = (Failure(start, "at least one expectation", lines=(f"  - {advice}",)),)
    updated = _updated(text, lines, robot)
    check = Check(None, lines[0].span if lines else start, failures)
    return Outcome(path, (check,), updated if updated != text else None)


class _Robot:
    """A configuration with its results, which are computed at their first use."""

    def __init__(self, path: str, rulebook: Rulebook, text: str | None = None) -> None:
        self.path, self.rulebook = path, rulebook
        self._reasoner = Reasoner(load_project(path, text=text), rulebook)

    @cached_property
    def reported(self) -> tuple[ReportedFinding, ...]:
        """Return the findings of the configuration."""
        return tuple(
            ReportedFinding(
                each.severity,
                each.kind,
                each.subject,
                tuple(sorted({span.line for span in each.spans if span.path == self.path})),
            )
            for each in self._reasoner.analysis.consequences
        )

    def counted_of(self, what: str) -> Mapping[str, int] | None:
        """Return the actual counts for an expectation with the keyword `what`.

        They are None if no specification exists; `expect findings` has counts even then.
        """
        if what == "expect findings":
            return self.findings
        if not self.is_realised:
            return None
        return self.nodes if what == "expect nodes" else self.cost

    @property
    def is_realised(self) -> bool:
        """Whether there is a specification."""
        return self._reasoner.synthesis is not None

    @cached_property
    def nodes(self) -> Mapping[str, int]:
        """Return the number of nodes of each possible kind, by the name of the kind."""
        found = self._reasoner.synthesis
        kinds = () if found is None else [node.kind for node in found.specification.nodes]
        counted = Counter(self.names[kind] for kind in kinds)
        return {name: counted[name] for name in self.names.values()}

    @cached_property
    def findings(self) -> Mapping[str, int]:
        """Return the numbers of errors and warnings."""
        counted = Counter(each.severity for each in self.reported)
        return {severity: counted[severity] for severity in _COUNTED}

    @cached_property
    def orders(self) -> tuple[str, ...]:
        """Return the order of the controllers of each module with several, by rising priority.

        Only modules that hierarchical control arbitrates have one.
        """
        configuration = self._reasoner.project.configuration
        strategies: dict[str, str] = {}
        for line in configuration.relationships:
            if isinstance(line, Strategy):
                strategies.setdefault(line.controlled, line.strategy)
        ranks: dict[str, dict[str, int]] = {}
        for line in configuration.relationships:
            if not isinstance(line, Control):
                continue
            if strategies.get(line.controlled, configuration.architecture) == "hierarchical":
                ranks.setdefault(line.controlled, {})[line.controller] = line.priority or 0
        return tuple(
            f"{written(module)}: {_ranked(of)}" for module, of in ranks.items() if len(of) > 1
        )

    @cached_property
    def cost(self) -> Mapping[str, int]:
        """Return the costs of its specification by the names of levels; {} without one."""
        found = self._reasoner.synthesis
        return by_name({} if found is None else found.resolution.cost)

    @cached_property
    def names(self) -> Mapping[str, str]:
        """Return the names of nodes, by their kinds."""
        return node_names(self._reasoner.project.configuration.kinds)

    @cached_property
    def kinds(self) -> frozenset[str]:
        """Return the kinds of findings that rules name."""
        return consequence_kinds(self.rulebook)

    @cached_property
    def own_kinds(self) -> frozenset[str] | None:
        """Return the kinds of findings of packs; None without packs, or if one is a variable."""
        kinds = [kinds_of(rule) for rule in self.rulebook.of_packs]
        if not self.rulebook.packs or None in kinds:
            return None
        return frozenset(kind for each in kinds if each is not None for kind in each)

    @cached_property
    def is_open(self) -> bool:
        """Whether some rule computes the kinds of its findings, so that any kind is possible."""
        return any(kinds_of(rule) is None for rule in self.rulebook.rules)


# ---- Expectations -------------------------------------------------------------------------------


def _expectation_lines(text: str, robot: _Robot) -> tuple[ExpectationLine, ...]:
    """Return the lines with expectations.

    Raises:
        MarsError: the expectations that cannot be read.
    """
    problems: list[Diagnostic] = []
    found = []
    for number, line in enumerate(text.split("\n"), 1):
        match = _LINE.match(line)
        if match is not None:
            begin, end = match.start("rest") + 1, match.end("rest") + 1
            span = Span(robot.path, number, begin, number, end)
            what = " ".join(match["what"].split())
            before = line[: match.start("rest")]
            found.append(_expectation_line(what, before, match["rest"], span, robot, problems))
        elif malformed := _MALFORMED.match(line):
            begin = max(malformed[0].rfind("#"), malformed[0].rfind("//")) + 1
            advice = "write it as a comment on a line of its own, as `# expect: KIND` or "
            advice += "`# expect nodes: NAME NUMBER`"
            place = point(robot.path, number, begin)
            problems.append(_case_error("this is not an expectation", place, advice))
    if problems:
        raise MarsError(problems)
    return tuple(found)


def _expectation_line(
    what: str, before: str, text: str, span: Span, robot: _Robot, problems: list[Diagnostic]
) -> ExpectationLine:
    if what in _KNOWN:
        known = tuple(robot.names.values()) if what == "expect nodes" else _KNOWN[what]
        return ExpectationLine(what, before, text, span, (), _counts(text, known, span, problems))
    if what == "expect order":
        return ExpectationLine(what, before, text, span)
    if what not in ("expect", "never", "only"):
        near = nearest(what.partition(" ")[2], _NUMBERED) or "nodes"
        message = f"`{what}` is not an expectation"
        problems.append(_case_error(message, span, f"did you mean `expect {near}`?"))
        return ExpectationLine(what, before, text, span)
    if what == "expect" and text == _NONE:
        return ExpectationLine(what, before, text, span)
    # A list of kinds is separated by commas, and so are the lines after `at`.
    texts = re.split(r",[ \t]*", text) if what == "only" else [text]
    wanted = (_finding(each, span, robot, problems) for each in texts)
    return ExpectationLine(what, before, text, span, tuple(filter(None, wanted)))


def _finding(
    text: str, span: Span, robot: _Robot, problems: list[Diagnostic]
) -> ExpectedFinding | None:
    match = _FINDING.fullmatch(text)
    if match is None:
        advice = "write `KIND`, `KIND(SUBJECT)` or `SEVERITY KIND at LINE`; a severity is "
        advice += " or ".join(SEVERITIES)
        problems.append(_case_error(f"expected a finding, found `{text}`", span, advice))
        return None
    if match["kind"] not in robot.kinds and not robot.is_open:
        advice = suggestion(match["kind"], robot.kinds, "is the pack that finds it given?")
        problems.append(_case_error(f"no rule finds `{match['kind']}`", span, advice))
    lines = tuple(map(int, re.findall(r"\d+", match["lines"] or "")))
    return ExpectedFinding(match["severity"], match["kind"], match["subject"], lines)


def _counts(
    text: str, known: Sequence[str], span: Span, problems: list[Diagnostic]
) -> Mapping[str, int]:
    found: dict[str, int] = {}
    for part in re.split(r",[ \t]*", text):
        match = _COUNT.fullmatch(part)
        if match is None:
            message = f"expected a name and a number, found `{part}`"
            problems.append(_case_error(message, span, f"as in `{known[0]} 1`"))
        elif match["name"] not in known:
            advice = suggestion(match["name"], known, f"one of {', '.join(known)}")
            problems.append(_case_error(f"`{match['name']}` is not counted here", span, advice))
        else:
            found[match["name"]] = int(match["count"])
    return found


def _case_error(message: str, span: Span, advice: str) -> Diagnostic:
    return Diagnostic(_CODE, "error", message, span, help=advice)


# ---- Unmet expectations -------------------------------------------------------------------------


def _unmet(
    line: ExpectationLine, lines: Iterable[ExpectationLine], robot: _Robot
) -> Iterator[Failure]:
    if line.text == _NONE and line.what == "expect":
        if robot.is_realised:
            yield _failure(line.span, _NONE, [f"nodes {_count_list(robot.nodes)}"])
    elif line.what == "expect order":
        if line.text not in robot.orders:
            order = _order_of(line, robot) or "no order of priorities"
            yield _failure(line.span, line.text, [], order)
    elif line.counts is not None:
        there = robot.counted_of(line.what)
        if there is None:
            yield _failure(line.span, line.text, [_NONE])
        elif any(there[name] != count for name, count in line.counts.items()):
            others = {n: c for n, c in there.items() if c and line.what == "expect nodes"}
            found = {name: there[name] for name in line.counts} | others
            yield _failure(line.span, line.text, [_all(found)])
    elif line.what == "expect":
        (wanted,) = line.wanted
        if not any(map(wanted.fits, robot.reported)):
            near = [each for each in robot.reported if wanted.fits(each, anywhere=True)]
            near = near or [each for each in robot.reported if each.kind == wanted.kind]
            if near:
                yield _failure(line.span, line.text, [], near[0])
            else:
                none = f"    there is no {wanted.kind}"
                yield Failure(line.span, line.text, lines=(none,))
    elif line.what == "never":
        unwanted = [each for each in robot.reported if line.wanted[0].fits(each)]
        if unwanted:
            yield _failure(line.span, f"no {line.text}", unwanted)
    else:
        expected = [wanted for each in lines if each.what == "expect" for wanted in each.wanted]
        extra = [
            each
            for each in robot.reported
            if any(wanted.fits(each) for wanted in line.wanted)
            and not any(wanted.fits(each) for wanted in expected)
        ]
        if extra:
            yield _failure(line.span, f"no {line.text} that no line expects", extra)


def _order_of(line: ExpectationLine, robot: _Robot) -> str | None:
    """Return the actual order of the controllers of the line's module; None if unknown."""
    module = line.text.partition(":")[0]
    return next((each for each in robot.orders if each.partition(":")[0] == module), None)


def _count_list(counts: Mapping[str, int]) -> str:
    return _all({name: count for name, count in counts.items() if count}) or "none"


def _all(counts: Mapping[str, int]) -> str:
    return ", ".join(f"{name} {count}" for name, count in counts.items())


def _ranked(ranks: Mapping[str, int]) -> str:
    """Return controllers by rising priority, `A = B < C`."""
    groups: dict[int, list[str]] = {}
    for controller, priority in sorted(ranks.items()):
        groups.setdefault(priority, []).append(written(controller))
    return " < ".join(" = ".join(groups[priority]) for priority in sorted(groups))


def _failure(span: Span, expected: str, found: Iterable[object], near: object = None) -> Failure:
    shown, nearest_one = tuple(map(str, found)), None if near is None else str(near)
    return Failure(span, expected, shown, nearest_one, shown_beside(shown, nearest_one))


# ---- Updates ------------------------------------------------------------------------------------


def _updated(text: str, lines: Sequence[ExpectationLine], robot: _Robot) -> str:
    """Return the text of a configuration with its expectations changed to the actual results.

    `lines` are the expectations in it. If there are none, expectations of all results are appended.
    `never` lines stay unchanged, and so do expected findings without a similar result.
    """
    if not lines:
        own = robot.own_kinds
        findings = [each for each in robot.reported if own is None or each.kind in own]
        new = [f"# expect: {each}" for each in findings]
        new += [f"# only: {', '.join(sorted(own))}"] if own else []
        if not robot.is_realised:
            new.append(f"# expect: {_NONE}")
        else:
            if any(robot.nodes.values()):
                new.append(f"# expect nodes: {_count_list(robot.nodes)}")
            new.append(f"# expect cost: {_all(robot.cost)}")
        return text.rstrip("\n") + "\n" + "\n".join(new) + "\n"
    written = text.split("\n")
    for line in lines:
        result = _updated_text(line, robot)
        if result is not None:
            written[line.span.line - 1] = line.before + result
    return "\n".join(written)


def _updated_text(line: ExpectationLine, robot: _Robot) -> str | None:
    """Return the new text of an expectation, or None if it stays unchanged."""
    if line.counts is not None:
        there = robot.counted_of(line.what)
        if there is None or all(there[name] == n for name, n in line.counts.items()):
            return None
        return _all({name: there[name] for name in line.counts})
    if line.what == "expect order":
        return _order_of(line, robot)
    if line.what != "expect" or not line.wanted or any(map(line.wanted[0].fits, robot.reported)):
        return None
    (wanted,) = line.wanted
    near = [each for each in robot.reported if wanted.fits(each, anywhere=True)]
    if len(near) != 1:
        return None
    severity = near[0].severity if wanted.severity else None
    subject = f"({wanted.subject})" if wanted.subject is not None else ""
    at = f" at {', '.join(map(str, near[0].lines))}" if wanted.lines and near[0].lines else ""
    return " ".join(filter(None, (severity, f"{wanted.kind}{subject}{at}")))
