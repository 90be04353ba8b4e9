"""Answer sets of the resolution rules turned into specifications."""

from mars_asp.reasoning.synthesis.derived import SpecifiedAtoms
from mars_asp.reasoning.synthesis.draft import IntroducedNode, SpecificationDraft
from mars_asp.reasoning.synthesis.specify import Specification, specify

__all__ = [
    "IntroducedNode",
    "Specification",
    "SpecificationDraft",
    "SpecifiedAtoms",
    "specify",
]
