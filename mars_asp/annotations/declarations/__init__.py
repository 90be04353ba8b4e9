"""The one function declaration that follows an annotation."""

from mars_asp.annotations.declarations.declaration import (
    DeclaredParameter,
    NoFunction,
    SourceDeclaration,
)
from mars_asp.annotations.declarations.read import read_declaration

__all__ = ["DeclaredParameter", "NoFunction", "SourceDeclaration", "read_declaration"]
