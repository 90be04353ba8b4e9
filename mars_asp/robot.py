"""A robot in Python: it is loaded once, then checked, explained, drawn, repaired and run.

Each answer is that of the command of the same name; `to_dict()` is the JSON of it, `text` and
`str()` are its text.

>>> robot = load("examples/level0/config.mars")
>>> robot
Robot("examples/level0/config.mars": 8 modules, 10 relationships)
"""

import argparse
import os
import pathlib
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, fields
from functools import cache, cached_property
from html import escape
from typing import TYPE_CHECKING, Any, Literal, TypeAlias, TypeVar

from mars_asp.cli.alternatives import alternatives_json, alternatives_lines
from mars_asp.cli.analyse import analysis_json, analysis_lines
from mars_asp.cli.arguments import arguments_of, rule_pack
from mars_asp.cli.can import capability_json, capability_lines
from mars_asp.cli.check import judge
from mars_asp.cli.check_output import Checked, reported_findings, result_json
from mars_asp.cli.diagnostic_text import concise_text
from mars_asp.cli.diff import comparable, difference_json, difference_lines
from mars_asp.cli.explain import (
    Explained,
    explained,
    explanation_html,
    explanation_text,
    why_not_answer,
    why_not_paragraphs,
)
from mars_asp.cli.import_robot import check_one_tree, foreign_text
from mars_asp.cli.inputs import (
    JUDGING,
    judge_project,
    packs_of,
    read_project,
    read_specification,
    rulebook_for,
)
from mars_asp.cli.inputs import load as load_text
from mars_asp.cli.lines import line_text, lines_of, remember
from mars_asp.cli.repair import mend_json
from mars_asp.cli.results import Result
from mars_asp.cli.selection import Selection
from mars_asp.cli.synthesise import minimal_specification, specification_text, synthesis_json
from mars_asp.cli.trace_document import topics_document, why_not_document
from mars_asp.cli.verify import (
    SpecificationComparison,
    judge_wiring,
    verification_json,
    verification_lines,
)
from mars_asp.cli.wrapping import columns
from mars_asp.diagnostic import Diagnostic, MarsError, whole_file
from mars_asp.exchange.lift import lifted
from mars_asp.exchange.recognise import FORMATS
from mars_asp.model.declarations import (
    Configuration,
    Control,
    Data,
    Gating,
    Limit,
    Lock,
    Module,
    Mount,
    Relationship,
    Reset,
    Strategy,
)
from mars_asp.model.described import described_modules, module_classes
from mars_asp.model.names import read_name
from mars_asp.model.rates import as_number
from mars_asp.output import counted, visible
from mars_asp.reasoning.analysis import Analysis, Consequence, findings
from mars_asp.reasoning.budget import ENDLESS, Budget
from mars_asp.reasoning.facts.compile import facts_text
from mars_asp.reasoning.packs import find_packs
from mars_asp.reasoning.project import Project
from mars_asp.reasoning.questions.alternatives import alternatives
from mars_asp.reasoning.questions.capability import capability
from mars_asp.reasoning.questions.diff import diff
from mars_asp.reasoning.questions.explain import Topic
from mars_asp.reasoning.questions.repair import STAGES, Mend, repairs
from mars_asp.reasoning.questions.unrealised import unrealised
from mars_asp.reasoning.questions.why_not import WhyNot
from mars_asp.reasoning.rules import by_name
from mars_asp.reasoning.session import Reasoner
from mars_asp.reasoning.verification import Caution, Verification, Violation
from mars_asp.spelling import nearest

if TYPE_CHECKING:
    import networkx

    from mars_asp.execution.judgement import Judgement, Requirement
    from mars_asp.reasoning.synthesis.synthesise import Synthesis


PathLike: TypeAlias = str | os.PathLike[str]
Answered = TypeVar("Answered")
#: A `repr` is at most this long.
_LONGEST = 200


def load(
    path: PathLike,
    *more: PathLike,
    format: str | None = None,
    sources: Iterable[PathLike] = (),
    rules: Iterable[PathLike] = (),
    budget: Budget | None = None,
) -> "Robot":
    """Read one robot: a `.mars` file, a ROS workspace, or other files that describe it together.

    Args:
        path: A file or folder.
        more: More foreign files of the same robot.
        format: The format of the files if their content does not show it, such as `ros2`.
        sources: More annotated sources.
        rules: Rule packs: folders, or names of installed packs.
        budget: The time of each search (default: no limit).

    Raises:
        MarsError: the files cannot be read, or the folder holds several robots.

    >>> load("examples/level0/config.mars").modules[:2]
    ('Sonar', 'SonarMap')
    """
    options = _Options.from_values(format, sources, rules, budget)
    files = list(_paths((path, *more)))
    arguments = options.namespace_for("check", files=files)
    return Robot(tuple(files), read_project(arguments, quietly=True), options)


def loads(
    text: str,
    name: str = "<text>",
    *,
    format: str | None = None,
    sources: Iterable[PathLike] = (),
    rules: Iterable[PathLike] = (),
    budget: Budget | None = None,
) -> "Robot":
    r"""Read one robot from text, in `.mars` unless a `format` is given; `name` is its shown path.

    Raises:
        MarsError: the text is wrong.

    >>> loads("@configuration\n@modules A, B\nA uses_data_from B").modules
    ('A', 'B')
    """
    _check_types(text=(text, str), name=(name, str))
    options = _Options.from_values(format or "mars", sources, rules, budget)
    arguments = options.namespace_for("check", files=[name])
    return Robot((name,), load_text(arguments, name, text), options)


@dataclass(frozen=True)
class _Options:
    """The options by which a robot is read and solved."""

    format: str | None
    sources: tuple[str, ...]
    rules: tuple[str, ...]
    budget: Budget

    @classmethod
    def from_values(
        cls,
        format: str | None,
        sources: Iterable[PathLike],
        rules: Iterable[PathLike],
        budget: Budget | None,
    ) -> "_Options":
        """Return options with paths as text.

        Raises:
            MarsError: there is no such format, or a rule pack is wrong.
        """
        _check_types(format=(format, str), budget=(budget, Budget))
        if format is not None and format not in FORMATS:
            near = nearest(format, FORMATS)
            help_text = f"did you mean `{near}`?" if near else f"one of {', '.join(FORMATS)}"
            raise _error("format", f"unknown format `{format}`", help_text)
        packs = tuple(rule_pack(each) for each in _paths(rules))
        problems: list[Diagnostic] = []
        find_packs([*map(pathlib.Path, packs)], problems)
        if problems:
            raise MarsError(problems)
        return cls(format, _paths(sources), packs, budget or ENDLESS)

    def namespace_for(self, command: str, **values: object) -> argparse.Namespace:
        """Return the arguments of a command."""
        return arguments_of(
            command,
            from_format=self.format,
            sources=list(self.sources),
            rules=list(self.rules),
            time_limit=self.budget.seconds,
            **values,
        )


def _paths(given: PathLike | Iterable[PathLike]) -> tuple[str, ...]:
    """Return paths as text; one path alone is meant as one."""
    paths = given if isinstance(given, Iterable) and not isinstance(given, str) else [given]
    return tuple(map(_path_text, paths))


def _path_text(given: object) -> str:
    """Return a path as text.

    Raises:
        MarsError: the value has another type.
    """
    path = os.fspath(given) if isinstance(given, os.PathLike) else given
    if not isinstance(path, str):
        raise _error("usage", f"`{given!r:.60}` is not a path", "give a text or a `pathlib.Path`")
    return path


def _check_types(**values: tuple[object, type]) -> None:
    """Raise MarsError unless each argument is None or has its type.

    Raises:
        MarsError: one has another type.
    """
    for name, (value, kind) in values.items():
        if value is not None and (not isinstance(value, kind) or isinstance(value, bool)):
            message = f"`{name}` is `{value!r:.60}`, and not {_NOUNS[kind]}"
            raise _error("usage", message)


#: The types of arguments in words.
_NOUNS: Mapping[type, str] = {str: "a text", int: "a whole number", Budget: "a `Budget`"}


def _error(code: str, message: str, help_text: str | None = None) -> MarsError:
    span = whole_file("")
    return MarsError([Diagnostic(code, "error", message, span, help=help_text, excerpt="")])


class CommandAnswer:
    """The text and the JSON of a command's answer, each computed at first use."""

    make_text: Callable[[], str]
    make_json: Callable[[], dict[str, object]]

    @cached_property
    def text(self) -> str:
        """The text that the command prints."""
        return self.make_text()

    def to_dict(self) -> dict[str, Any]:
        """Return the JSON document that the command prints."""
        return self.make_json()

    def __str__(self) -> str:
        return self.text


@dataclass(frozen=True, eq=False, repr=False)
class RobotAnswer(CommandAnswer):
    """The answer of a command: `str()` is the printed text, `found` the value that it shows.

    >>> answer = load("examples/level0/config.mars").alternatives(1)
    >>> answer.to_dict()["proven_minimal"]
    True
    """

    found: Any
    summary: str
    make_text: Callable[[], str]
    make_json: Callable[[], dict[str, object]]

    def __repr__(self) -> str:
        return _short(f"{type(self).__name__}({self.summary})")


def _short(text: str) -> str:
    """Return a text in one line, shortened to the length of a `repr`."""
    line = visible(text)
    return line if len(line) <= _LONGEST else f"{line[: _LONGEST - 4]}...)"


def _text_of_lines(lines: Iterable[str]) -> str:
    return "".join(f"{line}\n" for line in lines)


@dataclass(frozen=True)
class Finding:
    """A finding of `check`; `line` and `column` are None if it has no location.

    `kind` is None for errors of the input, which have no `subject` and `participants` either.

    >>> workspace = load("examples/ros2_workspace")
    >>> [finding.kind for finding in workspace.check(select=["guard_bypass"])]
    ['guard_bypass']
    """

    kind: str | None
    code: str
    severity: Literal["error", "warning", "note"]
    message: str
    path: str
    line: int | None
    column: int | None
    help: str | None
    subject: str | None
    participants: tuple[str, ...]
    result: Result = field(compare=False)

    @classmethod
    def from_result(cls, result: "Result") -> "Finding":
        """Return a result of `check` as a finding."""
        found, of = result_json(result), result.consequence
        values: Any = {name: found[name] for name in cls.__match_args__[:8]}
        about = (None, ()) if of is None else (of.subject, of.participants)
        return cls(**values, subject=about[0], participants=about[1], result=result)

    def to_dict(self) -> dict[str, Any]:
        """Return the finding with the keys of `check --format json`."""
        return result_json(self.result)

    def __str__(self) -> str:
        return concise_text(self.result.diagnostic)

    def __repr__(self) -> str:
        return _short(f"Finding({self})")


@dataclass(frozen=True, eq=False, repr=False)
class Robot:
    """One robot, read from files; each answer is computed when it is needed, and kept.

    >>> robot = load("examples/level0/config.mars")
    >>> robot.specification.cost["nodes"]
    3
    """

    paths: tuple[str, ...]
    project: Project
    options: _Options = field(repr=False)

    def __repr__(self) -> str:
        modules = counted(len(self.modules), "module")
        relationships = counted(len(self.project.configuration.relationships), "relationship")
        counts = f": {modules}, {relationships})"
        path = visible(" ".join(self.paths))
        most = _LONGEST - len(counts) - len('Robot("..."')
        return f'Robot("{path if len(path) <= most else f"{path[:most]}..."}"{counts}'

    @property
    def modules(self) -> tuple[str, ...]:
        """The names of the modules, in the order of the files.

        >>> len(load("examples/level0/config.mars").modules)
        8
        """
        return tuple(name.text for name in self.project.configuration.modules)

    @property
    def text(self) -> str:
        """The `.mars` text; of foreign files the text that `import` prints.

        Raises:
            MarsError: several launch files start a robot each.

        >>> load("examples/level0/config.mars").text.split()[0]
        '@configuration'
        """
        if self.project.format is None:
            return self.project.text

        check_one_tree(self.project.trees, self.project.configuration)
        return foreign_text(self.project.configuration)

    @property
    def facts(self) -> str:
        """The facts that `facts` prints, input of clingo.

        >>> "architecture(hierarchical)." in load("examples/level0/config.mars").facts
        True
        """
        return facts_text(self._reasoner.facts)

    # ---- Judgement -------------------------------------------------------------------------------

    def check(
        self,
        *,
        select: Iterable[str] | None = None,
        ignore: Iterable[str] | None = None,
        baseline: PathLike | None = None,
    ) -> tuple[Finding, ...]:
        """Return the findings that `check` reports, in its order.

        Args:
            select: Kinds or ids of rules that are reported alone.
            ignore: Kinds or ids of rules that are not reported.
            baseline: A file of known findings, which are not reported.

        Raises:
            MarsError: a name is neither a kind nor a rule, or the baseline cannot be read.

        >>> for finding in load("examples/ros2_workspace").check(select=["guard_bypass"]):
        ...     print(f"{finding.path}:{finding.line}")
        examples/ros2_workspace/src/scout_drive/scout_drive/dock.py:11
        """
        arguments = self._arguments("check")
        arguments.select = None if select is None else _name_list("select", select)
        arguments.ignore = None if ignore is None else _name_list("ignore", ignore)
        arguments.baseline = None if baseline is None else _path_text(baseline)
        rules = cache(lambda stages: rulebook_for(arguments, stages))
        selection = Selection(arguments, rules(JUDGING))
        checked = Checked(self.paths[0], self.paths[1:])
        judge(checked, self.project, rules, selection, arguments, with_participants=True)
        results = [*checked.results, *map(Result, selection.end())]
        return tuple(map(Finding.from_result, reported_findings(results)))

    def analyse(self) -> "AnalyseResult":
        """Return all consequences, or of launch files all findings.

        Raises:
            MarsError: rules that clingo refuses.

        >>> load("examples/level0/config.mars").analyse().consequences[0].kind
        'data_divergence'
        """
        arguments = self._arguments("analyse", quiet=False)
        rules = rulebook_for(arguments, JUDGING if self.project.trees else ("resolve",))
        analysis = judge_project(self.project, rules, arguments)
        selected = cache(lambda: Selection(arguments, rules).of(self.project, analysis))
        parts = {each.name: getattr(analysis, each.name) for each in fields(Analysis)}
        return AnalyseResult(
            **parts,
            make_text=self._quoting(
                lambda: _text_of_lines(
                    analysis_lines(self.project, analysis, selected(), arguments)
                )
            ),
            make_json=self._quoting(lambda: analysis_json(self.project, analysis, selected())),
        )

    def verify(
        self, specification: "PathLike | Robot | SpecificationResult | None" = None
    ) -> "VerifyResult":
        """Judge a specification of this robot; the result is true if it realises the robot.

        Args:
            specification: A file, a robot or a specification; None for the wiring that a foreign
                robot has, and the minimal specification of a `.mars` robot.

        Raises:
            MarsError: the file cannot be read, or there is no minimal specification.

        >>> robot = load("examples/level0/config.mars")
        >>> bool(robot.verify()), bool(robot.verify(robot))
        (True, False)
        """
        arguments = self._arguments("verify", file=self.paths[0])
        modules: Mapping[str, Module] = {}
        if specification is None and self.project.format is not None:
            configuration = lifted(self.project.configuration)
        elif specification is None:
            configuration = self.specification.configuration
        elif isinstance(specification, SpecificationResult):
            configuration = specification.configuration
        else:
            project = (
                specification.project
                if isinstance(specification, Robot)
                else read_specification(arguments, _path_text(specification))
            )
            configuration, modules = project.configuration, project.modules
        found, compared = judge_wiring(configuration, modules, self.project, arguments)
        return VerifyResult(
            found,
            f"realises={not found.violations}, minimal={compared.minimal}",
            self._quoting(
                lambda: _text_of_lines(verification_lines(found, compared, columns(None)))
            ),
            self._quoting(lambda: verification_json(found, compared)),
            compared,
        )

    def can(self, query: str) -> "CanResult":
        """Return whether the robot can do something, such as `Rotn_Y of Camera`.

        Raises:
            MarsError: the query is wrong.

        >>> bool(load("examples/mobile-camera/config.mars").can("Rotn_Y of Camera"))
        True
        """
        _check_types(query=(query, str))
        rules = rulebook_for(self._arguments("can"), ("can", "account"))
        found = capability(self.project, rules, query)
        return CanResult(
            found,
            f"{query}: {'yes' if found.able else 'no'}",
            self._quoting(lambda: _text_of_lines(capability_lines(found))),
            self._quoting(lambda: capability_json(found)),
        )

    # ---- Synthesis -------------------------------------------------------------------------------

    @cached_property
    def specification(self) -> "SpecificationResult":
        """The minimal specification.

        Raises:
            MarsError: nothing realises the robot, or no specification was found in time.

        >>> load("examples/level0/config.mars").specification.proven_minimal
        True
        """
        arguments = self._arguments("synthesise")
        rules = rulebook_for(arguments, ("resolve", "verify"))
        analysis = self._reasoner.analysis
        try:
            found = minimal_specification(self.project, analysis, rules, arguments)
        except TimeoutError as error:
            raise _error("time", f"no specification was found in time: {error}") from None
        if found is None:
            errors = [each for each in findings(analysis) if each.severity == "error"]
            problem = _error("unrealisable", unrealised(analysis), "`check` shows the reasons")
            raise MarsError([*problem.diagnostics, *errors])
        printed, cost = found.specification.configuration, by_name(found.resolution.cost)
        proof = "proven minimal" if found.resolution.proven else "best found"
        return SpecificationResult(
            found,
            f"{counted(len(printed.modules), 'module')}, {cost['nodes']} introduced, {proof}",
            self._quoting(lambda: specification_text(printed, self.project, arguments)),
            self._quoting(lambda: synthesis_json(self.project, found)),
            self,
        )

    def alternatives(self, n: int = 10) -> RobotAnswer:
        """Return up to `n` other realisations in the order of their cost.

        Raises:
            MarsError: nothing realises the robot.

        >>> load("examples/level0/config.mars").alternatives(1)
        RobotAnswer(0 alternatives)
        """
        _check_types(n=(n, int))
        if n < 1:
            raise _error("usage", f"{n} alternatives cannot be listed", "ask for 1 or more")
        arguments = self._arguments("explain", alternatives=n)
        rules = rulebook_for(arguments, ("resolve", "account"))
        reasoner = Reasoner(self.project, rules, self.options.budget)
        found = alternatives(reasoner, None, n)
        if found is None:
            raise _error("unrealisable", "no specification realises the configuration")
        return RobotAnswer(
            found,
            counted(len(found.others), "alternative"),
            self._quoting(
                lambda: _text_of_lines(alternatives_lines(found, arguments, columns(None)))
            ),
            self._quoting(lambda: alternatives_json(found)),
        )

    # ---- Explanation -----------------------------------------------------------------------------

    def explain(
        self,
        subject: str | None = None,
        *,
        only: Literal["consequences", "nodes"] | None = None,
        depth: int | None = None,
    ) -> "ExplainResult":
        """Return why each consequence and node is there, or those that a subject names.

        Args:
            subject: A module, a node, a kind, an atom, or a line of a file.
            only: Only consequences, or only nodes.
            depth: How deep the text shows traces (default: accounts without traces).

        Raises:
            MarsError: the subject names nothing.

        >>> load("examples/level0/config.mars").explain("DataSplitter1").topics[0].name
        'DataSplitter1'
        """
        _check_types(subject=(subject, str), depth=(depth, int))
        if only not in (None, "consequences", "nodes"):
            raise _error("usage", f"`{only}` is not what is explained", '"consequences" or "nodes"')
        if depth is not None and depth < 1:
            raise _error("usage", f"the depth {depth} is below 1")
        given = {"subject": subject, "only": only} | ({} if depth is None else {"depth": depth})
        # Traces are part of the answer, also where the text does not show them.
        arguments = self._arguments("explain", **given, format="json")
        named = subject and (read_name(subject) or subject)
        found = explained(self.project, named, arguments)
        shown = found._replace(is_traced=depth is not None)
        spoken = self._arguments("explain", **given)
        spoken.quiet = False

        def make_page() -> str:
            arguments = self._arguments("explain", **given, output="-")
            return explanation_html(explained(self.project, named, arguments), self.project)

        return ExplainResult(
            found,
            ", ".join(topic.name for topic in found.topics) or "nothing to explain",
            self._quoting(lambda: "".join(explanation_text(shown, spoken))),
            self._quoting(lambda: topics_document(found.subject, found.topics)),
            self._quoting(make_page),
        )

    def why_not(self, atom: str) -> "WhyNotResult":
        """Return why an atom or a finding, such as `ArbitrationNode(Turn)`, is absent; a way to it.

        Raises:
            MarsError: the atom names nothing that there can be.

        >>> load("examples/level0/config.mars").why_not("DataSplitter(Turn)").present
        False
        """
        _check_types(atom=(atom, str))
        arguments = self._arguments("explain", why_not=atom)
        reasoner = Reasoner(self.project, rulebook_for(arguments), self.options.budget)
        found = why_not_answer(reasoner, arguments)
        parts = why_not_paragraphs(found, arguments, self.project.format)
        return WhyNotResult(
            found,
            found.answer,
            self._quoting(lambda: _text_of_lines(line for part in parts for line in part)),
            self._quoting(lambda: why_not_document(found)),
        )

    def repairs(self, subject: str | None = None) -> "tuple[RepairResult, ...]":
        """Return the smallest edits that remove each error, or each finding that a subject names.

        There are none for foreign files, as edits are of `.mars` text.

        Raises:
            MarsError: the subject names nothing.

        >>> len(load("examples/module-conflict/config.mars").repairs()) > 0
        True
        """
        _check_types(subject=(subject, str))
        rules = rulebook_for(self._arguments("explain"), STAGES)
        found = repairs(self.project, rules, subject, self.options.budget.seconds)
        return tuple(_repair(of.consequence, each) for of in found for each in of.mends)

    def diff(self, other: "Robot") -> RobotAnswer:
        """Return how the consequences, nodes and costs of another robot differ from this one.

        >>> robot = load("examples/level0/config.mars")
        >>> print(robot.diff(robot), end="")
        nothing changed
        cost: nodes 3, conversion 0, relationships 12
        """
        if not isinstance(other, Robot):
            help_text = "load it first: `robot.diff(mars_asp.load(PATH))`"
            raise _error("usage", f"`{other!r}` is not a robot", help_text)
        rules, budget = rulebook_for(self._arguments("diff")), self.options.budget
        projects = comparable(self.project, other.project)
        old, new = (Reasoner(each, rules, budget) for each in projects)
        found = other._quoting(self._quoting(lambda: diff(old, new, lines_of)))()
        consequences = counted(len(found.consequences), "consequence")
        return RobotAnswer(
            found,
            f"{consequences}, {counted(len(found.nodes), 'node')}",
            self._quoting(
                lambda: _text_of_lines(difference_lines(found, False, False, columns(None)))
            ),
            self._quoting(lambda: difference_json(found)),
        )

    # ---- Execution -------------------------------------------------------------------------------

    def run(self, scenario: PathLike, *, seed: int | None = None) -> "RunResult":
        """Execute the specification in a scenario and judge the run; runs code of the modules.

        Raises:
            MarsError: the scenario is wrong, or nothing realises the robot.

        >>> load("examples/level0/config.mars").run("examples/level0/scenario.toml", seed=1).verdict
        'pass'
        """
        from mars_asp.cli.run import read_run_scenario
        from mars_asp.cli.run_json import run_json
        from mars_asp.cli.run_text import run_text
        from mars_asp.cli.trials import run_trial, runnable
        from mars_asp.execution.judgement import run_rulebook
        from mars_asp.execution.scenario.functions import bind_kinds

        _check_types(seed=(seed, int))
        arguments = self._arguments("run", scenario=_path_text(scenario), seed=seed)
        configuration = self.project.configuration
        if configuration.kind == "configuration":
            configuration = self.specification.configuration
        specification, modules = runnable(configuration, self.project, arguments)
        bound = bind_kinds(read_run_scenario(arguments), specification)
        rules = run_rulebook(packs_of(arguments))
        trial, found = run_trial(specification, modules, bound, rulebook=rules)
        arguments.quiet = False
        return RunResult(
            found,
            f"{found.verdict}, {len(found.requirements)} requirements",
            self._quoting(lambda: run_text(trial, found, arguments)),
            self._quoting(lambda: run_json(trial, found)),
        )

    # ---- Pictures and graphs ---------------------------------------------------------------------

    def draw(
        self,
        *,
        about: str | None = None,
        depth: int | None = None,
        only: str | None = None,
        classes: bool = False,
    ) -> str:
        """Return a picture as SVG text, with its findings marked.

        Args:
            about: Only the surroundings of this module.
            depth: How many relationships lead away from it at most.
            only: Relationships of these kinds alone: `data`, `control`, `mounts`, with commas.
            classes: Whether boxes show the classes of modules.

        Raises:
            MarsError: there is no such module, or the picture is too large.

        >>> load("examples/level0/config.mars").draw(about="Turn", only="data")[:4]
        '<svg'
        """
        from mars_asp.cli.draw import drawn, relationship_kinds

        _check_types(about=(about, str), depth=(depth, int), only=(only, str))
        if depth is not None and about is None:
            raise _error("usage", "`depth` counts from a module: name it by `about`")
        try:
            kinds = None if only is None else relationship_kinds(only)
        except argparse.ArgumentTypeError as error:
            raise _error("usage", f"`only`: {error}") from None
        arguments = self._arguments("draw", about=about, depth=depth, only=kinds, classes=classes)
        return str(drawn(self.project, "svg", arguments))

    #: The picture of a notebook.
    _repr_svg_ = draw

    def to_dict(self) -> dict[str, Any]:
        """Return the modules with their classes, and the relationships.

        >>> load("examples/level0/config.mars").to_dict()["modules"][0]["name"]
        'Sonar'
        """
        return _graph(self.project.configuration, self.project.modules)

    def to_networkx(self) -> "networkx.MultiDiGraph":
        """Return the graph of the relationships.

        Nodes are names of modules, with `classes`. Edges go from source to client, from controller
        to controlled and from mounted module to host; `kind` is data, control or mount.

        >>> graph = load("examples/level0/config.mars").to_networkx()
        >>> sorted(graph.successors("Sonar"))
        ['MobilePlatform', 'SonarMap']
        """
        return _networkx(self.to_dict())

    # ---- Parts of answers ------------------------------------------------------------------------

    @cached_property
    def _reasoner(self) -> Reasoner:
        rules = rulebook_for(self._arguments("synthesise"), ("resolve", "verify"))
        return Reasoner(self.project, rules, self.options.budget)

    def _quoting(self, make: Callable[[], Answered]) -> Callable[[], Answered]:
        """Return a function that quotes lines of the texts that this robot was read from."""

        def make_with_lines() -> Answered:
            project = self.project
            texts = {project.configuration.path: project.text, **project.included}
            for path, text in texts.items():
                if text:
                    remember(path, text)
            return make()

        return make_with_lines

    def _arguments(self, command: str, **values: object) -> argparse.Namespace:
        return self.options.namespace_for(command, **{"files": list(self.paths), **values})


# ---- Answers -------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False, repr=False)
class AnalyseResult(CommandAnswer, Analysis):
    """The consequences of a robot, as `analyse` prints them.

    >>> "3 consequences: 3 notes" in str(load("examples/level0/config.mars").analyse())
    True
    """

    make_text: Callable[[], str] = field(kw_only=True)
    make_json: Callable[[], dict[str, object]] = field(kw_only=True)


@dataclass(frozen=True, eq=False, repr=False)
class SpecificationResult(RobotAnswer):
    """The minimal specification of a robot, as `synthesise` prints it.

    >>> load("examples/level0/config.mars").specification
    SpecificationResult(11 modules, 3 introduced, proven minimal)
    """

    found: "Synthesis"
    robot: Robot

    @property
    def modules(self) -> tuple[str, ...]:
        """The names of modules and introduced nodes."""
        return tuple(name.text for name in self.configuration.modules)

    @property
    def cost(self) -> Mapping[str, int]:
        """The cost by level: nodes, conversion, relationships."""
        return by_name(self.found.resolution.cost)

    @property
    def proven_minimal(self) -> bool:
        """Whether it is proven that no specification costs less."""
        return self.found.resolution.proven

    @property
    def resolves(self) -> Mapping[str, tuple[str, ...]]:
        """The consequences that each introduced node resolves, as `kind(subject)`."""
        return {name: tuple(of) for name, of in self.found.specification.resolves.items()}

    @property
    def configuration(self) -> Configuration:
        """The specification as declarations."""
        return self.found.specification.configuration

    def to_networkx(self) -> "networkx.MultiDiGraph":
        """Return the graph of its relationships, as that of a robot."""
        return _networkx(_graph(self.configuration, self.robot.project.modules))

    def draw(self) -> str:
        """Return a picture as SVG text."""
        return loads(self.text, "<specification>").draw()

    #: The picture of a notebook.
    _repr_svg_ = draw


@dataclass(frozen=True, eq=False, repr=False)
class ExplainResult(RobotAnswer):
    """Why consequences and nodes are there, as `explain` prints it.

    >>> load("examples/level0/config.mars").explain("DataSplitter1")
    ExplainResult(DataSplitter1)
    """

    found: Explained
    make_page: Callable[[], str]

    @property
    def topics(self) -> tuple[Topic, ...]:
        """The explained consequences, nodes and atoms, each with its trace."""
        return self.found.topics

    def _repr_html_(self) -> str:
        page = escape(self.make_page())
        return f'<iframe srcdoc="{page}" width="100%" height="600"></iframe>'


@dataclass(frozen=True, eq=False, repr=False)
class WhyNotResult(RobotAnswer):
    """Why something is not there, as `explain --why-not` prints it.

    >>> load("examples/level0/config.mars").why_not("DataSplitter(Turn)").present
    False
    """

    found: WhyNot

    @property
    def answer(self) -> str:
        """The answer in one sentence."""
        return self.found.answer

    @property
    def present(self) -> bool:
        """Whether the subject of the question exists after all."""
        return self.found.present

    @property
    def to_get(self) -> str | None:
        """A sentence with the smallest change found that gives the absent subject, or None."""
        return self.found.to_get


@dataclass(frozen=True, eq=False, repr=False)
class CanResult(RobotAnswer):
    """Whether the robot can do something, as `can` prints it; true if it can.

    >>> bool(load("examples/level0/config.mars").can("Trans_X of MobilePlatform"))
    False
    """

    def __bool__(self) -> bool:
        return bool(self.found.able)


@dataclass(frozen=True, eq=False, repr=False)
class VerifyResult(RobotAnswer):
    """Whether a specification realises a robot, as `verify` prints it; true if it does.

    >>> load("examples/level0/config.mars").verify()
    VerifyResult(realises=True, minimal=True)
    """

    found: Verification
    comparison: SpecificationComparison

    def __bool__(self) -> bool:
        return self.realises

    @property
    def realises(self) -> bool:
        """Whether no clause of the definition is violated."""
        return not self.found.violations

    @property
    def minimal(self) -> bool | None:
        """Whether the specification has the minimal cost; None if that is not known."""
        return self.comparison.minimal

    @property
    def violations(self) -> tuple[Violation, ...]:
        """The violated clauses, each with its message, help and locations."""
        return self.found.violations

    @property
    def warnings(self) -> tuple[Caution, ...]:
        """The warnings, each with its message and help."""
        return self.found.cautions


@dataclass(frozen=True, eq=False, repr=False)
class RepairResult(RobotAnswer):
    """Edits that together remove a finding, as `explain --repair` prints them.

    >>> repair = load("examples/module-conflict/config.mars").repairs()[0]
    >>> repair.removes.partition("(")[0]
    'module_conflict'
    """

    found: Mend
    #: The finding that is removed, as `kind(subject)`.
    removes: str

    @property
    def title(self) -> str:
        """The edits in words."""
        return "; ".join(edit.message for edit in self.found.edits)

    @property
    def edits(self) -> tuple[str, ...]:
        """The edits as terms of `rules/repair`."""
        return tuple(str(edit.term) for edit in self.found.edits)


@dataclass(frozen=True, eq=False, repr=False)
class RunResult(RobotAnswer):
    """A run and its judgement, as `run` prints them; true if all requirements hold.

    >>> load("examples/level0/config.mars").run("examples/level0/scenario.toml").verdict
    'pass'
    """

    found: "Judgement"

    def __bool__(self) -> bool:
        return self.verdict == "pass"

    @property
    def verdict(self) -> Literal["pass", "fail", "not decided"]:
        """The verdict on the run."""
        return self.found.verdict

    @property
    def requirements(self) -> "tuple[Requirement, ...]":
        """The requirements, each with `name`, `holds` and `message`."""
        return self.found.requirements


# ---- Graphs --------------------------------------------------------------------------------------


def _graph(configuration: Configuration, modules: Mapping[str, Module]) -> dict[str, Any]:
    """Return modules with their classes, and relationships with their stated values, as JSON."""
    described = described_modules(configuration, modules)
    classes = {name: list(module_classes(module)) for name, module in described.items()}
    names = [name.text for name in configuration.modules]
    if configuration.kind == "specification":
        kinds = {name: configuration.node_kind(name) for name in names}
        classes |= {name: [kind] for name, kind in kinds.items() if kind is not None}
    return {
        "modules": [{"name": name, "classes": classes.get(name, [])} for name in names],
        "relationships": list(map(_edge, configuration.relationships)),
    }


def _edge(relationship: Relationship) -> dict[str, Any]:
    """Return a relationship as JSON of an edge, without values that are not stated."""
    match relationship:
        case Data(client, source):
            mode, hz = relationship.mode, relationship.hz
            ends = {"kind": "data", "from": source, "to": client}
            values: dict[str, Any] = {
                "mode": None if mode is None else mode.text or mode.name,
                "hz": None if hz is None else as_number(hz),
            }
        case Control(controlled, controller):
            ends = {"kind": "control", "from": controller, "to": controlled}
            values = {"priority": relationship.priority, "hold_ms": relationship.hold_ms}
        case Mount(mounting, mounted):
            # `A is_mounted_on B` gives A as `mounting` and B, the host, as `mounted`.
            ends = {"kind": "mount", "from": mounting, "to": mounted}
            values = {}
        case Gating(gated, trigger):
            ends = {"kind": relationship.sign, "from": trigger, "to": gated}
            values = {"ms": relationship.ms}
        case Reset(module, source):
            ends, values = {"kind": "reset", "from": source, "to": module}, {}
        case Lock(controlled, source):
            ends = {"kind": "lock", "from": source, "to": controlled}
            values = {"priority": relationship.priority, "hold_ms": relationship.hold_ms}
        case Limit(controlled, source):
            ends = {"kind": "limit", "from": source, "to": controlled}
            values = {"hold_ms": relationship.hold_ms}
        case Strategy(controlled):
            ends = {"kind": "strategy", "from": controlled, "to": controlled}
            values = {"strategy": relationship.strategy, "period_ms": relationship.period_ms}
    return ends | {name: value for name, value in values.items() if value is not None}


def _networkx(graph: dict[str, Any]) -> "networkx.MultiDiGraph":
    import networkx

    found = networkx.MultiDiGraph()
    for module in graph["modules"]:
        found.add_node(module["name"], classes=tuple(module["classes"]))
    for edge in graph["relationships"]:
        values = {name: value for name, value in edge.items() if name not in ("from", "to")}
        found.add_edge(edge["from"], edge["to"], **values)
    return found


def _repair(of: Consequence, mend: Mend) -> RepairResult:
    """Return the public result for `mend`, a set of edits that removes the finding `of`."""
    removes = f"{of.kind}({of.subject})"
    title = "; ".join(edit.message for edit in mend.edits)
    lines = (line for edit in mend.lines for line in line_text(edit))
    return RepairResult(
        mend,
        f"{removes}: {title}",
        lambda: _text_of_lines([f"{removes}: {title}", *lines]),
        lambda: mend_json(mend),
        removes,
    )


def _name_list(option: str, names: Iterable[str]) -> list[str]:
    """Return names of findings as a list; MarsError for a single text, a likely mistake.

    Raises:
        MarsError: it is one text, or holds another value.
    """
    if isinstance(names, str):
        raise _error("usage", f"`{option}` is a text", f'write {option}=["{names}"]')
    listed = list(names) if isinstance(names, Iterable) else [names]
    for each in listed:
        _check_types(**{option: (each, str)})
    return listed
