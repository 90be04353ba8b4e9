"""From an analysis to its minimal specification."""

import time
from collections.abc import Callable, Mapping, Set
from dataclasses import dataclass

import clingo

from mars_asp.analysis import Analysis
from mars_asp.model import Configuration, Module
from mars_asp.rulebook import Rulebook
from mars_asp.solve import Grounding, Resolution
from mars_asp.synthesis import Specification, specify

#: The levels of the minimisation in `rules/resolve`.
NODES, CONVERSION, RELATIONSHIPS = 30, 20, 10
COSTS = {"nodes": NODES, "conversion": CONVERSION, "relationships": RELATIONSHIPS}
#: What the specification is built from: predicates of `rules/resolve` and of the consequences.
_READ = (
    ("splitter", 2),
    ("at", 3),
    ("edge", 4),
    ("lowers", 3),
    ("makes_for", 4),
    ("states_need", 3),
    ("own", 2),
    ("control_splitter", 1),
    ("arbiter", 1),
    ("full", 2),
    ("hears", 3),
    ("moved_hold", 2),
    ("leads", 2),
    ("arbitrates", 4),
    ("stands_for", 3),
    ("resolves", 3),
)


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

    Raises:
        MarsError: clingo refuses the rules.
        TimeoutError: no specification was found in the seconds given.
    """
    deadline = None if seconds is None else time.monotonic() + seconds
    grounding = analysis.grounding
    resolution = grounding.resolve(rulebook.text("resolve"), deadline, progress)
    if any(True for _ in grounding.symbols("unresolvable", 1)):
        return None
    specification = specification_of(configuration, modules, grounding, resolution.taken)
    return Synthesis(specification, resolution)


def specification_of(
    configuration: Configuration,
    modules: Mapping[str, Module],
    grounding: Grounding,
    taken: Set[clingo.Symbol],
) -> Specification:
    """Build the specification of one answer: the true atoms that are no facts."""
    atoms = [
        symbol
        for name, arity in _READ
        for symbol, is_fact in grounding.atoms(name, arity)
        if is_fact or symbol in taken
    ]
    return specify(configuration, modules, atoms)
