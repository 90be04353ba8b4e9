"""From an analysis to its minimal specification."""

from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass

from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.signature import Signature
from mars_asp.asp.solve.atoms import Fact
from mars_asp.asp.solve.grounding import NoAnswerError, Resolution
from mars_asp.asp.solve.optimum import MOST_COST, TooCostlyError
from mars_asp.diagnostic import Diagnostic, MarsError, whole_file
from mars_asp.reasoning.analysis import Analysis
from mars_asp.reasoning.budget import ENDLESS, Budget
from mars_asp.reasoning.project import Project
from mars_asp.reasoning.rules import CONVERSION
from mars_asp.reasoning.synthesis import (
    Specification,
    SpecifiedAtoms,
    specify,
)
from mars_asp.reasoning.synthesis.derived import STAGE
from mars_asp.reasoning.synthesis.exclusion import excluded
from mars_asp.reasoning.synthesis.preferences import Preference, preferences

#: Derived for each relationship that excludes every specification.
UNRESOLVABLE = Signature("unresolvable", 1)


@dataclass(frozen=True, slots=True)
class Synthesis:
    """The cheapest specification found, with the solver's result and unmet preferences."""

    specification: Specification
    resolution: Resolution
    derived: SpecifiedAtoms
    preferences: tuple[Preference, ...] = ()

    def cost(self, level: int) -> int:
        """Return the cost at a level (priority), 0 if nothing is minimised there."""
        return self.resolution.cost.get(level, 0)

    def bound(self, level: int) -> int:
        """Return the lower bound of the cost of all specifications, at a level."""
        return self.resolution.bound.get(level, 0)


def synthesise(
    project: Project, analysis: Analysis, rulebook: Rulebook, budget: Budget = ENDLESS
) -> Synthesis | None:
    """Return a minimal specification, or `None` if a consequence cannot be resolved.

    After the budget the cheapest one found so far is returned, with a lower bound of the cost.

    Raises:
        NoSpecificationError: constraints of rule packs exclude every specification.
        MarsError: clingo refuses the rules, or costs are too large to be added up.
    """
    with _resolved(analysis, rulebook, budget) as resolution:
        if resolution is None:
            return None
        derived = SpecifiedAtoms(rulebook, resolution.answer)
        preferred = preferences(rulebook, resolution.answer)
    return Synthesis(specify(project, derived), resolution, derived, preferred)


def least_cost(
    analysis: Analysis, rulebook: Rulebook, budget: Budget = ENDLESS
) -> Mapping[int, int] | None:
    """Return the cost of a minimal specification by level, or None if there is none.

    Raises:
        NoSpecificationError: constraints of rule packs exclude every specification.
        MarsError: clingo refuses the rules, or costs are too large to be added up.
    """
    with _resolved(analysis, rulebook, budget) as resolution:
        if resolution is None:
            return None
        resolution.answer.check()
    return resolution.cost


@contextmanager
def _resolved(
    analysis: Analysis, rulebook: Rulebook, budget: Budget
) -> Iterator[Resolution | None]:
    """Resolve an analysis; in the block, an error without answer names the excluding constraints.

    The resolution is None if a consequence cannot be resolved.

    Raises:
        NoSpecificationError: constraints of rule packs exclude every answer.
    """
    try:
        with costs_of(analysis.facts):
            resolution = analysis.grounding.resolve(
                rulebook.fragments("resolve"), budget.deadline(), budget.progress
            )
        yield None if is_unresolvable(analysis) else resolution
    except NoAnswerError as error:
        raise (excluded(rulebook, analysis.facts) or error) from None


@contextmanager
def costs_of(facts: Iterable[Fact]) -> Iterator[None]:
    """In the block, report a cost overflow at the largest cost that the facts state.

    Raises:
        MarsError: the sum of the costs in a component is too large.
    """
    try:
        yield
    except TooCostlyError as error:
        raise MarsError((_too_costly(error, facts),)) from None


def _too_costly(error: TooCostlyError, facts: Iterable[Fact]) -> Diagnostic:
    together = f"could be chosen together add up to {error.total}, more than {MOST_COST}"
    declared = [fact for fact in facts if fact.atom.name == "converts"]
    if error.level != CONVERSION or not declared:
        return Diagnostic(
            "costs-too-large",
            "error",
            f"costs on level {error.level} that {together}",
            whole_file("rules"),
            help="state smaller weights in the `#minimize` statements of your rule files",
        )
    dearest = max(declared, key=lambda fact: int(str(fact.atom.arguments[4])))
    return Diagnostic(
        "costs-too-large",
        "error",
        f"conversion costs that {together}",
        dearest.span,
        help="state smaller costs after `@Converts`: only their ratios count",
    )


def is_unresolvable(analysis: Analysis) -> bool:
    """Whether a consequence can never be resolved, so that there is no specification."""
    return any(True for _ in analysis.grounding.symbols(UNRESOLVABLE.name, UNRESOLVABLE.arity))


def is_resolved(rulebook: Rulebook, signature: Signature) -> bool:
    """Whether the rules of the stages `resolve` and `specify` derive a predicate.

    Such atoms do not count in a configuration without a specification, although some may be
    derived, as an unresolvable component does not stop the others.
    """
    stages = ("resolve", STAGE)
    resolving = (rule for rule in rulebook.rules if rule.stage in stages)
    return any(signature.unsigned in rule.heads for rule in resolving)
