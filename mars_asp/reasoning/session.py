"""Questions to one project: what one of them made is there for the next.

>>> reasoner = Reasoner(load_project("config.mars"), load_rulebook())
>>> explain(reasoner, "ArbitrationNode"), why_not(reasoner, "DataSplitter(Sonar)")
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.solve.atoms import Fact
from mars_asp.asp.solve.grounding import Resolution
from mars_asp.model.declarations import Configuration
from mars_asp.output import brief_repr
from mars_asp.reasoning.analysis import Analysis, analyse
from mars_asp.reasoning.budget import ENDLESS, Budget
from mars_asp.reasoning.project import Project, project_facts, with_brought
from mars_asp.reasoning.rules import load_rulebook
from mars_asp.reasoning.synthesis import SpecifiedAtoms
from mars_asp.reasoning.synthesis.synthesise import Synthesis, synthesise

if TYPE_CHECKING:
    from mars_asp.asp.trace import Explainer
    from mars_asp.reasoning.verification import Violation


@dataclass(frozen=True)
class Evidence:
    """What questions are answered from: rules, facts, and what follows from these.

    `resolution` is chosen on top of that, or None if nothing was or can be; `derived` follows
    from it.
    """

    rulebook: Rulebook
    facts: Sequence[Fact]
    analysis: Analysis
    resolution: Resolution | None = None
    derived: SpecifiedAtoms | None = None

    @cached_property
    def explainer(self) -> "Explainer":
        """Return what explains what is derived and chosen; no more answers can be asked for."""
        # Answers without traces do not wait for the tracer to be loaded.
        from mars_asp.asp.trace import Explainer  # noqa: PLC0415
        from mars_asp.asp.trace.given import GivenFacts  # noqa: PLC0415

        opened = {} if self.resolution is None else self.resolution.answer.true
        given = GivenFacts(self.facts, self.rulebook.declarations)
        return Explainer(self.rulebook, self.analysis.grounding.control, given, opened)

    @property
    def is_explained(self) -> bool:
        """Whether something was explained from it already."""
        return "explainer" in self.__dict__


@dataclass(frozen=True, repr=False)
class Reasoner:
    """A project and the rules that it is judged by; everything is found once, when it is needed.

    When the `budget` is spent the best specification so far is taken. What explains asks for no
    more answers on its grounding, so consequences that were explained are grounded anew where a
    specification is wanted, once.

    >>> reasoner = Reasoner(load_project("examples/level0/config.mars"))
    >>> len(reasoner.synthesis.specification.nodes)
    3
    """

    __repr__ = brief_repr

    project: Project
    rulebook: Rulebook = field(default_factory=load_rulebook)
    budget: Budget = ENDLESS

    def __post_init__(self) -> None:
        """Let the project know what the packs of the rulebook bring.

        Raises:
            MarsError: attributes that no pack declares, and values that are none of theirs.
        """
        if self.project.brought != self.rulebook.brought:
            project = with_brought(self.project, self.rulebook.brought)
            object.__setattr__(self, "project", project)

    @cached_property
    def facts(self) -> tuple[Fact, ...]:
        """Return the facts of the project."""
        return tuple(project_facts(self.project))

    @property
    def analysis(self) -> Analysis:
        """Return what the rules derive.

        Raises:
            MarsError: rules that clingo refuses.
        """
        return self._consequences.analysis

    @property
    def synthesis(self) -> Synthesis | None:
        """Return the least specification, or None if no specification realises the project.

        Raises:
            MarsError: rules that clingo refuses, or costs that are too large to be added up.
            TimeoutError: no specification was found in time.
        """
        return self._resolved[1]

    @property
    def is_resolved(self) -> bool:
        """Whether a specification was looked for already."""
        return "_resolved" in self.__dict__

    def evidence(self, resolved: bool) -> Evidence:
        """Return the consequences of the whole project and, where wanted, what resolves them.

        What was resolved already holds the consequences, too: an explained grounding is explained
        by one explainer alone.

        Raises:
            MarsError: rules that clingo refuses, or costs that are too large to be added up.
            TimeoutError: no specification was found in time.
        """
        return self._resolved[0] if resolved or self.is_resolved else self._consequences

    def verify(self, specification: Configuration) -> "tuple[Violation, ...]":
        """Return what is wrong with a specification of the project; `rulebook` holds `verify`."""
        from mars_asp.reasoning.verification import verify  # noqa: PLC0415

        return verify(specification, self.project, self.rulebook)

    @cached_property
    def _consequences(self) -> Evidence:
        return Evidence(self.rulebook, self.facts, self._analyse())

    @cached_property
    def _resolved(self) -> tuple[Evidence, Synthesis | None]:
        analysis = self._analyse() if self._consequences.is_explained else self.analysis
        found = synthesise(self.project, analysis, self.rulebook, self.budget)
        if found is None:
            return Evidence(self.rulebook, self.facts, analysis), None
        resolution, derived = found.resolution, found.derived
        evidence = Evidence(self.rulebook, self.facts, analysis, resolution, derived=derived)
        return evidence, found

    def _analyse(self) -> Analysis:
        span = self.project.configuration.span
        return analyse(self.facts, self.rulebook, span, with_labels=True)
