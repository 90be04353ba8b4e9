"""Reason about modular robots with the MARS model and answer set programming.

>>> import mars_asp
>>> robot = mars_asp.load("examples/level0/config.mars")
>>> [finding.kind for finding in robot.check()]
[]
>>> robot.specification.cost["nodes"]
3

The names in `__all__` are public: they change with the first number of `__version__` alone, as in
Semantic Versioning 2.0. `mars_asp.asp` is an engine for any logic program, independent of MARS.
"""

import importlib
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mars_asp.asp.rules.rulebook import Rulebook
    from mars_asp.asp.trace.tree import Absent, Derived, Given, Trace, Underivable
    from mars_asp.diagnostic import Diagnostic, MarsError, Span
    from mars_asp.reasoning.analysis import Analysis, Consequence
    from mars_asp.reasoning.budget import Budget
    from mars_asp.reasoning.project import Project, load_project
    from mars_asp.reasoning.questions.explain import Explanation, Topic, explain
    from mars_asp.reasoning.questions.why_not import WhyNot, why_not
    from mars_asp.reasoning.rules import load_rulebook
    from mars_asp.reasoning.session import Reasoner
    from mars_asp.robot import (
        AnalyseResult,
        CanResult,
        ExplainResult,
        Finding,
        RepairResult,
        Robot,
        RobotAnswer,
        RunResult,
        SpecificationResult,
        VerifyResult,
        WhyNotResult,
        load,
        loads,
    )

__version__ = "0.1.0"

#: The module of each public name; it is loaded when the name is used.
_PLACES = {
    "Absent": "mars_asp.asp.trace.tree",
    "AnalyseResult": "mars_asp.robot",
    "Analysis": "mars_asp.reasoning.analysis",
    "Budget": "mars_asp.reasoning.budget",
    "CanResult": "mars_asp.robot",
    "Consequence": "mars_asp.reasoning.analysis",
    "Derived": "mars_asp.asp.trace.tree",
    "Diagnostic": "mars_asp.diagnostic",
    "ExplainResult": "mars_asp.robot",
    "Explanation": "mars_asp.reasoning.questions.explain",
    "Finding": "mars_asp.robot",
    "Given": "mars_asp.asp.trace.tree",
    "MarsError": "mars_asp.diagnostic",
    "Underivable": "mars_asp.asp.trace.tree",
    "Project": "mars_asp.reasoning.project",
    "Reasoner": "mars_asp.reasoning.session",
    "RepairResult": "mars_asp.robot",
    "Robot": "mars_asp.robot",
    "RobotAnswer": "mars_asp.robot",
    "Rulebook": "mars_asp.asp.rules.rulebook",
    "RunResult": "mars_asp.robot",
    "Span": "mars_asp.diagnostic",
    "SpecificationResult": "mars_asp.robot",
    "Topic": "mars_asp.reasoning.questions.explain",
    "Trace": "mars_asp.asp.trace.tree",
    "VerifyResult": "mars_asp.robot",
    "WhyNot": "mars_asp.reasoning.questions.why_not",
    "WhyNotResult": "mars_asp.robot",
    "explain": "mars_asp.reasoning.questions.explain",
    "load": "mars_asp.robot",
    "load_project": "mars_asp.reasoning.project",
    "load_rulebook": "mars_asp.reasoning.rules",
    "loads": "mars_asp.robot",
    "why_not": "mars_asp.reasoning.questions.why_not",
}

__all__ = [
    "Absent",
    "AnalyseResult",
    "Analysis",
    "Budget",
    "CanResult",
    "Consequence",
    "Derived",
    "Diagnostic",
    "ExplainResult",
    "Explanation",
    "Finding",
    "Given",
    "MarsError",
    "Project",
    "Reasoner",
    "RepairResult",
    "Robot",
    "RobotAnswer",
    "Rulebook",
    "RunResult",
    "Span",
    "SpecificationResult",
    "Topic",
    "Trace",
    "Underivable",
    "VerifyResult",
    "WhyNot",
    "WhyNotResult",
    "explain",
    "load",
    "load_project",
    "load_rulebook",
    "loads",
    "why_not",
]


def __getattr__(name: str) -> object:
    """Import the module of a public name at its first use."""
    place = _PLACES.get(name)
    if place is None:
        from mars_asp.spelling import nearest  # noqa: PLC0415 -- needed for a mistake alone

        near = None if name.startswith("_") else nearest(name, __all__)
        hint = f": did you mean `{near}`?" if near else ""
        raise AttributeError(f"module `mars_asp` has no attribute `{name}`{hint}")
    return getattr(importlib.import_module(place), name)


def __dir__() -> list[str]:
    """Return the public names, and those that every module has."""
    return sorted({*globals(), *__all__})
