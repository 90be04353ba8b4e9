"""Reason about modular robots with the MARS model and answer set programming.

>>> from mars_asp import Reasoner, load_project, load_rulebook, explain
>>> for topic in explain(Reasoner(load_project("config.mars"), load_rulebook())).topics:
...     print(topic.title)

What `__all__` names is public: it changes with the first number of `__version__` alone, as Semantic
Versioning 2.0 has it. `mars_asp.asp` is an engine for any logic program, and loads nothing of MARS.
"""

import importlib
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mars_asp.asp.rules.rulebook import Rulebook
    from mars_asp.asp.trace.tree import Absent, Derived, Given, Missing, Trace
    from mars_asp.diagnostic import Diagnostic, MarsError, Span
    from mars_asp.reasoning.analysis import Analysis, Consequence
    from mars_asp.reasoning.budget import Budget
    from mars_asp.reasoning.project import Project, load_project
    from mars_asp.reasoning.questions.explain import Explanation, Topic, explain
    from mars_asp.reasoning.questions.why_not import WhyNot, why_not
    from mars_asp.reasoning.rules import load_rulebook
    from mars_asp.reasoning.session import Reasoner

__version__ = "0.1.0"

#: Where what is public is defined; it is loaded when somebody asks for it.
_PLACES = {
    "Absent": "mars_asp.asp.trace.tree",
    "Analysis": "mars_asp.reasoning.analysis",
    "Budget": "mars_asp.reasoning.budget",
    "Consequence": "mars_asp.reasoning.analysis",
    "Derived": "mars_asp.asp.trace.tree",
    "Diagnostic": "mars_asp.diagnostic",
    "Explanation": "mars_asp.reasoning.questions.explain",
    "Given": "mars_asp.asp.trace.tree",
    "MarsError": "mars_asp.diagnostic",
    "Missing": "mars_asp.asp.trace.tree",
    "Project": "mars_asp.reasoning.project",
    "Reasoner": "mars_asp.reasoning.session",
    "Rulebook": "mars_asp.asp.rules.rulebook",
    "Span": "mars_asp.diagnostic",
    "Topic": "mars_asp.reasoning.questions.explain",
    "Trace": "mars_asp.asp.trace.tree",
    "explain": "mars_asp.reasoning.questions.explain",
    "load_project": "mars_asp.reasoning.project",
    "load_rulebook": "mars_asp.reasoning.rules",
    "WhyNot": "mars_asp.reasoning.questions.why_not",
    "why_not": "mars_asp.reasoning.questions.why_not",
}

__all__ = [
    "Absent",
    "Analysis",
    "Budget",
    "Consequence",
    "Derived",
    "Diagnostic",
    "Explanation",
    "Given",
    "MarsError",
    "Missing",
    "Project",
    "Reasoner",
    "Rulebook",
    "Span",
    "Topic",
    "Trace",
    "WhyNot",
    "explain",
    "load_project",
    "load_rulebook",
    "why_not",
]


def __getattr__(name: str) -> object:
    """Load what is public when it is asked for: a command loads no more than its verb needs."""
    place = _PLACES.get(name)
    if place is None:
        raise AttributeError(f"module `mars_asp` has no attribute `{name}`")
    return getattr(importlib.import_module(place), name)
