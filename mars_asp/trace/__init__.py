"""Why an atom holds: derivation traces from the rules' syntax trees and the finished answer set.

Nothing here knows what the rules are about.
"""

from mars_asp.trace.explainer import Explainer
from mars_asp.trace.values import Absent, Derived, Given, Trace

__all__ = ["Absent", "Derived", "Explainer", "Given", "Trace"]
