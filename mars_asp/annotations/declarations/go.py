"""Function declarations of Go."""

from collections.abc import Sequence

from mars_asp.annotations.declarations.declaration import (
    DeclaredParameter,
    NoFunction,
    SourceDeclaration,
)
from mars_asp.annotations.declarations.tokens import (
    SourceToken,
    closing,
    is_word,
    joined,
    split,
    text_at,
)


def read_go(tokens: Sequence[SourceToken], code: str) -> SourceDeclaration | NoFunction:
    """Return the function `func (receiver) name(parameters) results`, or the first other token."""
    first = tokens[0]
    none = NoFunction(first.offset, first.text)
    if first.text != "func":
        return none
    at = closing(tokens, 1) if text_at(tokens, 1) == "(" else 1
    name = text_at(tokens, at)
    at += 1
    if text_at(tokens, at) == "[":
        at = closing(tokens, at)
    if not is_word(name) or text_at(tokens, at) != "(":
        return none
    end = closing(tokens, at)
    parameters = _parameters(tokens[at + 1 : end - 1])
    types = [result.type or "" for result in _results(tokens, end, code)]
    # An error beside a result reports a failure; it is not delivered.
    types = [written for written in types if written != "error"]
    output = "void" if not types else types[0] if len(types) == 1 else f"({', '.join(types)})"
    return SourceDeclaration(name, output, parameters, first.offset, tokens[end - 1].offset)


def _results(tokens: Sequence[SourceToken], at: int, code: str) -> tuple[DeclaredParameter, ...]:
    """Return the results that begin at token `at`; none if a line break precedes them."""
    if at >= len(tokens) or "\n" in code[tokens[at - 1].offset : tokens[at].offset]:
        return ()
    if tokens[at].text == "(":
        return _parameters(tokens[at + 1 : closing(tokens, at) - 1])
    end = _after_type(tokens, at)
    return (DeclaredParameter(None, joined(tokens[at:end])),) if end > at else ()


def _parameters(tokens: Sequence[SourceToken]) -> tuple[DeclaredParameter, ...]:
    """Return the parameters with their types; in `a, b T` all names have the last type."""
    groups = split(tokens, angles=False)
    named = any(_after_type(group, 0) != len(group) for group in groups)
    found: list[DeclaredParameter] = []
    following: str | None = None
    for group in reversed(groups):
        if not named:
            found.append(DeclaredParameter(None, _type_text(group)))
        elif len(group) == 1:
            found.append(DeclaredParameter(group[0].text, following))
        else:
            following = _type_text(group[1:])
            found.append(DeclaredParameter(group[0].text, following))
    return tuple(reversed(found))


def _type_text(tokens: Sequence[SourceToken]) -> str:
    if tokens and tokens[0].text == "...":
        return f"[]{joined(tokens[1:])}"
    return joined(tokens)


def _after_type(tokens: Sequence[SourceToken], at: int) -> int:
    """Return the index after the type that begins at `at`, or `at` without a type."""
    while True:
        text, following = text_at(tokens, at), text_at(tokens, at + 1)
        if text in ("*", "...") or (text == "<" and following == "-"):
            at += 1 if text != "<" else 2
        elif text == "chan":
            at += 3 if (following, text_at(tokens, at + 2)) == ("<", "-") else 1
        elif text == "[":
            at = closing(tokens, at)
        elif text == "map" and following == "[":
            at = closing(tokens, at + 1)
        else:
            break
    text, following = text_at(tokens, at), text_at(tokens, at + 1)
    if text == "(":
        return closing(tokens, at)
    if text == "func" and following == "(":
        at = closing(tokens, at + 1)
        return closing(tokens, at) if text_at(tokens, at) == "(" else _after_type(tokens, at)
    if text in ("interface", "struct") and following == "{":
        return closing(tokens, at + 1)
    if not is_word(text):
        return at
    at += 1
    while text_at(tokens, at) == "." and is_word(text_at(tokens, at + 1)):
        at += 2
    return closing(tokens, at) if text_at(tokens, at) == "[" else at
