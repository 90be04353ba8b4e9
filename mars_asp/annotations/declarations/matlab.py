"""Function declarations of MATLAB, which state no types."""

from collections.abc import Sequence

from mars_asp.annotations.declarations.declaration import (
    DeclaredParameter,
    NoFunction,
    SourceDeclaration,
)
from mars_asp.annotations.declarations.tokens import SourceToken, closing, is_word, split, text_at


def read_matlab(tokens: Sequence[SourceToken], code: str) -> SourceDeclaration | NoFunction:
    """Return the function `function [results] = name(parameters)`, or the first other token."""
    none = NoFunction(tokens[0].offset, tokens[0].text)
    if tokens[0].text != "function":
        return none
    at, results = 1, False
    if text_at(tokens, 1) == "[":
        at = closing(tokens, 1)
        results = at > 3
    elif text_at(tokens, 2) == "=":
        at, results = 2, True
    if text_at(tokens, at) == "=":
        at += 1
    elif at > 1:
        return none
    if not is_word(text_at(tokens, at)):
        return none
    name = tokens[at].text
    while text_at(tokens, at + 1) == "." and is_word(text_at(tokens, at + 2)):
        at += 2
        name += f".{tokens[at].text}"
    at += 1
    parameters: tuple[DeclaredParameter, ...] = ()
    # A bracket on a later line belongs to the body.
    line = code.find("\n", tokens[at - 1].offset)
    if text_at(tokens, at) == "(" and not 0 <= line < tokens[at].offset:
        end = closing(tokens, at)
        groups = split(tokens[at + 1 : end - 1], angles=False)
        parameters = tuple(DeclaredParameter(group[0].text, None) for group in groups)
        at = end
    last = tokens[at - 1].offset
    return SourceDeclaration(name, None if results else "void", parameters, tokens[0].offset, last)
