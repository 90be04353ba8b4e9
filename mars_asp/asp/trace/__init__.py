"""Why an atom holds, and why it does not: traces from the rules' syntax trees and an answer set.

Nothing here knows what the rules are about.
"""

from mars_asp.asp.trace.explainer import Explainer
from mars_asp.asp.trace.tree import Absent, Attempt, Derived, Given, Missing, Trace, Unexplained

__all__ = [
    "Absent",
    "Attempt",
    "Derived",
    "Explainer",
    "Given",
    "Missing",
    "Trace",
    "Unexplained",
]
