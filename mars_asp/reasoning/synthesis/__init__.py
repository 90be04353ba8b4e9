"""Answer sets of the resolution rules turned into specifications."""

from mars_asp.reasoning.synthesis.derived import Derived
from mars_asp.reasoning.synthesis.draft import Draft, Node
from mars_asp.reasoning.synthesis.specify import Specification, specify

__all__ = [
    "Derived",
    "Draft",
    "Node",
    "Specification",
    "specify",
]
