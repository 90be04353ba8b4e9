"""Answer sets of the resolution rules turned into specifications."""

from mars_asp.synthesis.draft import Node
from mars_asp.synthesis.specify import Specification, specify

__all__ = ["Node", "Specification", "specify"]
