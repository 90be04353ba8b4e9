"""Cases for the rules of MARS, by their stages."""

from pathlib import Path

from mars_asp.asp import cases
from mars_asp.asp.cases import Outcome
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.reasoning.findings import CONSEQUENCE
from mars_asp.reasoning.rules import FOLLOWING, STAGES


def run_case(path: Path, rulebook: Rulebook) -> Outcome:
    """Run a case; what it does not show is compared by its consequences.

    Raises:
        MarsError: the case may not be given to clingo.
    """
    return cases.run_case(path, rulebook, stages_of(path), CONSEQUENCE)


def stages_of(path: Path) -> tuple[str, ...]:
    """Return the stages that the folders of a case are named after, and those that follow them."""
    named = cases.stages_of(path, STAGES)
    return tuple(dict.fromkeys((*named, *(FOLLOWING[s] for s in named if s in FOLLOWING))))
