"""Why an atom holds, and why it does not: traces from the rules' syntax trees and an answer set.

Nothing here knows what the rules are about.
"""

import importlib
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mars_asp.asp.trace.explainer import Explainer
    from mars_asp.asp.trace.tree import (
        Absent,
        Derived,
        Given,
        NearMiss,
        Trace,
        Underivable,
        Unexplained,
    )

__all__ = [
    "DEPTH",
    "Absent",
    "Derived",
    "Explainer",
    "Given",
    "NearMiss",
    "Trace",
    "Underivable",
    "Unexplained",
]
#: How deep a trace is printed: deep enough for a reason, short enough to read.
DEPTH = 4


def __getattr__(name: str) -> object:
    """Load the tracer when somebody asks for it: most explanations are told without a trace."""
    if name not in __all__:
        raise AttributeError(f"module `mars_asp.asp.trace` has no attribute `{name}`")
    place = "explainer" if name == "Explainer" else "tree"
    return getattr(importlib.import_module(f"{__name__}.{place}"), name)
