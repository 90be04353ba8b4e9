"""Answer sets of the resolution rules turned into specifications."""

from mars_asp.reasoning.synthesis.draft import NODE_PREDICATES, Draft, Node
from mars_asp.reasoning.synthesis.specify import Introduced, Specification, introduce, specify

__all__ = [
    "NODE_PREDICATES",
    "Draft",
    "Introduced",
    "Node",
    "Specification",
    "introduce",
    "specify",
]
