"""Questions to one project, which share their intermediate results.

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
    """The basis of answers: rules, facts, and the consequences of these.

    `resolution` is the chosen answer of the resolution, or None if none is requested or exists;
    `derived` are the atoms that follow from it.
    """

    rulebook: Rulebook
    facts: Sequence[Fact]
    analysis: Analysis
    resolution: Resolution | None = None
    derived: SpecifiedAtoms | None = None

    @cached_property
    def explainer(self) -> "Explainer":
        """Return the tracer of atoms; afterwards the grounding cannot be solved any more."""
        # Questions without traces do not load the tracer.
        from mars_asp.asp.trace import Explainer  # noqa: PLC0415
        from mars_asp.asp.trace.given import GivenFacts  # noqa: PLC0415

        opened = {} if self.resolution is None else self.resolution.answer.true
        given = GivenFacts(self.facts, self.rulebook.declarations)
        return Explainer(self.rulebook, self.analysis.grounding.control, given, opened)

    @property
    def is_explained(self) -> bool:
        """Whether `explainer` was used, so that the grounding cannot be solved any more."""
        return "explainer" in self.__dict__


@dataclass(frozen=True, repr=False)
class Reasoner:
    """A project with its rules; every result is computed once, on first use.

    After the `budget` the best specification so far is taken. An explained grounding gives no
    further answers; a specification that is requested after an explanation needs a new grounding.

    >>> reasoner = Reasoner(load_project("examples/level0/config.mars"))
    >>> len(reasoner.synthesis.specification.nodes)
    3
    """

    __repr__ = brief_repr

    project: Project
    rulebook: Rulebook = field(default_factory=load_rulebook)
    budget: Budget = ENDLESS

    def __post_init__(self) -> None:
        """Add the content of the rulebook's packs to the project.

        Raises:
            MarsError: attributes that no pack declares, and values of the wrong sort.
        """
        if self.project.brought != self.rulebook.brought:
            project = with_brought(self.project, self.rulebook.brought)
            object.__setattr__(self, "project", project)

    @cached_property
    def facts(self) -> tuple[Fact, ...]:
        """Return the facts that state the project to the rules."""
        return tuple(project_facts(self.project))

    @property
    def analysis(self) -> Analysis:
        """Return the atoms that the rules derive.

        Raises:
            MarsError: rules that clingo refuses.
        """
        return self._consequences.analysis

    @property
    def synthesis(self) -> Synthesis | None:
        """Return a minimal specification, or the cheapest within the budget; None if there is none.

        Raises:
            MarsError: rules that clingo refuses, or costs that are too large to be added up.
            TimeoutError: no specification was found in time.
        """
        return self._resolved[1]

    @property
    def is_resolved(self) -> bool:
        """Whether a specification was searched for already."""
        return "_resolved" in self.__dict__

    def evidence(self, resolved: bool) -> Evidence:
        """Return the rules, facts and consequences of the project, if `resolved` also nodes.

        Once there is a resolution it is always included: one grounding has one explainer only.

        Raises:
            MarsError: rules that clingo refuses, or costs that are too large to be added up.
            TimeoutError: no specification was found in time.
        """
        return self._resolved[0] if resolved or self.is_resolved else self._consequences

    def verify(self, specification: Configuration) -> "tuple[Violation, ...]":
        """Return the violations of a specification of the project; the rules include `verify`."""
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
