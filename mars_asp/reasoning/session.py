"""Questions to one project: what one of them made is there for the next.

>>> reasoner = Reasoner(load_project("config.mars"), load_rulebook())
>>> explain(reasoner, "ArbitrationNode"), why_not(reasoner, "DataSplitter(Sonar)")
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.solve.atoms import Fact
from mars_asp.asp.solve.grounding import Resolution
from mars_asp.asp.trace import Explainer
from mars_asp.asp.trace.given import GivenFacts
from mars_asp.model.declarations import Configuration
from mars_asp.reasoning.analysis import Analysis, analyse
from mars_asp.reasoning.facts.vocabulary import given_in
from mars_asp.reasoning.project import Project, project_facts
from mars_asp.reasoning.synthesis.synthesise import Synthesis, synthesise
from mars_asp.reasoning.verification import Violation, verify


class Resolved(NamedTuple):
    """An analysis, and what was synthesised on it, if anything can be."""

    analysis: Analysis
    synthesis: Synthesis | None


@dataclass(frozen=True)
class Reasoner:
    """A project and the rules that it is judged by; everything is found once, when it is needed.

    After `seconds` the best specification so far is taken. `progress` is told how many components
    are solved, and of how many. What explains asks for no more answers on its grounding, so
    consequences that were explained are grounded anew where a specification is wanted, once.
    """

    project: Project
    rulebook: Rulebook
    seconds: float | None = None
    progress: Callable[[int, int], None] | None = None

    @cached_property
    def facts(self) -> tuple[Fact, ...]:
        """Return the facts of the project."""
        return tuple(project_facts(self.project))

    @cached_property
    def analysis(self) -> Analysis:
        """Return what the rules derive.

        Raises:
            MarsError: rules that clingo refuses.
        """
        return self._analyse()

    @cached_property
    def explainer(self) -> Explainer:
        """Return what explains consequences."""
        # Once a grounding was explained its answers cannot be read any more, so there is one only.
        if self.is_resolved:
            return self.resolution_explainer
        return explainer_for(self.rulebook, self.facts, self.analysis, None)

    @cached_property
    def resolved(self) -> Resolved:
        """Return the least specification with the analysis that it stands on.

        Raises:
            MarsError: rules that clingo refuses, or costs that are too large to be added up.
            TimeoutError: no specification was found in time.
        """
        analysis = self._analyse() if "explainer" in self.__dict__ else self.analysis
        configuration, modules = self.project.configuration, self.project.modules
        found = synthesise(
            configuration, modules, analysis, self.rulebook, self.seconds, self.progress
        )
        return Resolved(analysis, found)

    @cached_property
    def resolution_explainer(self) -> Explainer:
        """Return what explains consequences and nodes."""
        analysis, found = self.resolved
        resolution = None if found is None else found.resolution
        return explainer_for(self.rulebook, self.facts, analysis, resolution)

    @property
    def synthesis(self) -> Synthesis | None:
        """Return the least specification; `None` where no specification realises the project."""
        return self.resolved.synthesis

    @property
    def is_resolved(self) -> bool:
        """Whether a specification was looked for already."""
        return "resolved" in self.__dict__

    def verify(self, specification: Configuration) -> tuple[Violation, ...]:
        """Return what is wrong with a specification of the project; `rulebook` holds `verify`."""
        return verify(specification, self.project, self.rulebook)

    def _analyse(self) -> Analysis:
        return analyse(self.facts, self.rulebook, self.project.configuration.span)


def explainer_for(
    rulebook: Rulebook, facts: Iterable[Fact], analysis: Analysis, resolution: Resolution | None
) -> Explainer:
    """Return an explainer of one analysis and of what later stages chose on top of it."""
    opened = {} if resolution is None else resolution.answer.true
    origins = {each.signature: each.origin for each in given_in(rulebook, "base")}
    given = GivenFacts(facts, origins)
    return Explainer(rulebook, analysis.grounding.control, given, opened)
