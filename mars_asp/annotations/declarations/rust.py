"""Function declarations of Rust."""

from collections.abc import Sequence

from mars_asp.annotations.declarations.declaration import (
    DeclaredParameter,
    NoFunction,
    SourceDeclaration,
)
from mars_asp.annotations.declarations.tokens import (
    SourceToken,
    after_angle,
    before,
    closing,
    is_word,
    joined,
    split,
    text_at,
    texts,
)

_BEFORE = frozenset(("pub", "crate", "async", "unsafe", "const", "extern", "default", "safe"))


def read_rust(tokens: Sequence[SourceToken], code: str) -> SourceDeclaration | NoFunction:
    """Return the function `fn name(...) -> type`, else the first token after attributes."""
    first = at = _after_attributes(tokens, 0)
    token = tokens[min(first, len(tokens) - 1)]
    none = NoFunction(token.offset, token.text)
    while text_at(tokens, at) != "fn":
        text = text_at(tokens, at)
        if text == "(" and text_at(tokens, at - 1) == "pub":
            at = closing(tokens, at)
        elif text in _BEFORE or text.startswith('"'):
            at += 1
        else:
            return none
    at += 1
    if text_at(tokens, at) == "r" and text_at(tokens, at + 1) == "#":
        at += 2
    name = text_at(tokens, at)
    at += 1
    if text_at(tokens, at) == "<":
        at = after_angle(tokens, at)
    if not is_word(name) or text_at(tokens, at) != "(":
        return none
    end = closing(tokens, at)
    groups = split(tokens[at + 1 : end - 1])
    parameters = tuple(p for group in groups if (p := _parameter(group)) is not None)
    output = "void"
    if text_at(tokens, end) == "->":
        stop = end + 1
        while stop < len(tokens) and tokens[stop].text not in ("{", ";", "where"):
            if tokens[stop].text in ("(", "["):
                stop = closing(tokens, stop)
            else:
                stop = after_angle(tokens, stop) if tokens[stop].text == "<" else stop + 1
        output = joined(tokens[end + 1 : stop])
    return SourceDeclaration(name, output, parameters, token.offset, tokens[end - 1].offset)


def _after_attributes(tokens: Sequence[SourceToken], at: int) -> int:
    while text_at(tokens, at) == "#":
        opening = at + 2 if text_at(tokens, at + 1) == "!" else at + 1
        if text_at(tokens, opening) != "[":
            break
        at = closing(tokens, opening)
    return at


def _parameter(group: Sequence[SourceToken]) -> DeclaredParameter | None:
    """Return the parameter of `pattern: type`, or None for the receiver."""
    group = group[_after_attributes(group, 0) :]
    words = texts(before(group, ":"))
    written = group[len(words) + 1 :]
    if "self" in words or not written:
        return None
    if len(words) > 1 and words[0] in ("mut", "ref"):
        words = words[-1:] if len(words) == 2 else words
    name = words[0] if len(words) == 1 and is_word(words[0]) and words[0] != "_" else None
    kind = texts(written)
    return DeclaredParameter(name, joined(written), kind[:1] == ["&"] and "mut" in kind[:4])
