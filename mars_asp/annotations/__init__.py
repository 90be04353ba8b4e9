"""Modules read out of annotations in source code."""

from mars_asp.annotations.blocks import Blocks, read_blocks
from mars_asp.annotations.files import Extraction, extract
from mars_asp.annotations.representations import Names, canonical_names

__all__ = ["Blocks", "Extraction", "Names", "canonical_names", "extract", "read_blocks"]
