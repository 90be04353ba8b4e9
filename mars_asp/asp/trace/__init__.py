"""Traces: why an atom holds, or why not, from the rules' syntax trees and an answer set.

The package is independent of the subject of the rules.
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
    """Load the tracer at its first use: most explanations need no trace."""
    if name not in __all__:
        raise AttributeError(f"module `mars_asp.asp.trace` has no attribute `{name}`")
    place = "explainer" if name == "Explainer" else "tree"
    return getattr(importlib.import_module(f"{__name__}.{place}"), name)
