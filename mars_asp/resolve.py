"""From an analysis to its minimal specification."""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from mars_asp.analysis import Analysis
from mars_asp.model import Configuration, Module
from mars_asp.rulebook import Rulebook
from mars_asp.solve import Resolution
from mars_asp.synthesis import Specification, specify

#: The levels of the minimisation in `rules/resolve`.
NODES, CONVERSION, RELATIONSHIPS = 30, 20, 10
COSTS = {"nodes": NODES, "conversion": CONVERSION, "relationships": RELATIONSHIPS}
#: What the rules derive of each relationship that stands against every specification.
UNRESOLVABLE = ("unresolvable", 1)


@dataclass(frozen=True, slots=True)
class Synthesis:
    """The least specification found and what is known of its cost."""

    specification: Specification
    resolution: Resolution

    def cost(self, level: int) -> int:
        """Return the cost at a level."""
        return self.resolution.cost.get(level, 0)

    def bound(self, level: int) -> int:
        """Return what no specification can cost less than, at a level."""
        return self.resolution.bound.get(level, 0)


def synthesise(
    configuration: Configuration,
    modules: Mapping[str, Module],
    analysis: Analysis,
    rulebook: Rulebook,
    seconds: float | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Synthesis | None:
    """Find the least specification, or `None` where a consequence cannot be resolved.

    After the seconds given the best found so far is taken, with a bound on what is least.

    Raises:
        MarsError: clingo refuses the rules.
    """
    resolution = _resolve(analysis, rulebook, seconds, progress)
    if resolution is None:
        return None
    return Synthesis(specify(configuration, modules, resolution.answer.shown), resolution)


def least_cost(
    analysis: Analysis, rulebook: Rulebook, seconds: float | None = None
) -> Mapping[int, int] | None:
    """Return what `synthesise` would find the least specification to cost, by level.

    Raises:
        MarsError: clingo refuses the rules.
    """
    resolution = _resolve(analysis, rulebook, seconds)
    if resolution is None:
        return None
    resolution.answer.check()
    return resolution.cost


def _resolve(
    analysis: Analysis,
    rulebook: Rulebook,
    seconds: float | None,
    progress: Callable[[int, int], None] | None = None,
) -> Resolution | None:
    deadline = None if seconds is None else time.monotonic() + seconds
    grounding = analysis.grounding
    resolution = grounding.resolve(rulebook.text("resolve"), deadline, progress)
    return None if any(True for _ in grounding.symbols(*UNRESOLVABLE)) else resolution


def is_resolved(rulebook: Rulebook, name: str, arity: int) -> bool:
    """Say whether the rules of the resolution derive a predicate."""
    return any((name, arity) in rule.heads for rule in rulebook.rules if rule.stage == "resolve")


def is_refuted(rulebook: Rulebook, name: str, arity: int) -> bool:
    """Say whether no atom of a predicate holds where nothing realises the configuration.

    Some may be derived all the same, for what stands against a part does not stop the others.
    """
    return (name, arity) != UNRESOLVABLE and is_resolved(rulebook, name, arity)
