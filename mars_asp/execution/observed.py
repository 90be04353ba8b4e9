"""The facts about what was observed in a run, and their numbers."""

from mars_asp.asp.solve.atoms import Fact, Term, fact_at
from mars_asp.diagnostic import point
from mars_asp.execution.executor.schedule import MILLISECOND

#: The location of facts that are not in a file.
_OBSERVED = point("<run>", 1, 1)
#: The bounds of the integers of clingo.
MOST = 2**31 - 1


def seen(name: str, *arguments: Term) -> Fact:
    """Return a fact that no line states."""
    return fact_at(_OBSERVED, name, *arguments)


def milliseconds(time: int) -> int:
    """Return a time (ns) in milliseconds."""
    return rounded(time // MILLISECOND)


def rounded(number: float) -> int:
    """Round to an integer, clamped to the 32 bits of clingo."""
    return int(max(-MOST, min(MOST, round(number) if abs(number) < MOST else number)))
