"""Modules read out of annotations."""

from mars_asp.annotations.blocks import Blocks, read_blocks
from mars_asp.annotations.representations import Names, canonical_names

__all__ = ["Blocks", "Names", "canonical_names", "read_blocks"]
