"""An engine for explained answer sets: it reads, grounds and solves rules, and explains answers.

>>> from mars_asp import asp
>>> answer = asp.Program.from_files("reach.lp").solve()
>>> print(answer.why("reach(d)").text())

It is independent of the subject of the rules; MARS uses its public interface. See its README.
"""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mars_asp.asp.program import Answer, NotDerived, Program, Reason, Session, Unsatisfiable
    from mars_asp.asp.trace.conflicts import Conflicts

__all__ = [
    "Answer",
    "Conflicts",
    "NotDerived",
    "Program",
    "Reason",
    "Session",
    "Unsatisfiable",
]


def __getattr__(name: str) -> object:
    """Load `program` at the first use: users of single engine modules load only these."""
    if name not in __all__:
        raise AttributeError(f"module `mars_asp.asp` has no attribute `{name}`")
    from mars_asp.asp import program  # noqa: PLC0415

    return getattr(program, name)
