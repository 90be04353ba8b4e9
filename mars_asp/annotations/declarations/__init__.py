"""The one function declaration that follows an annotation."""

from mars_asp.annotations.declarations.declaration import Declaration, NoFunction, Parameter
from mars_asp.annotations.declarations.read import read_declaration

__all__ = ["Declaration", "NoFunction", "Parameter", "read_declaration"]
