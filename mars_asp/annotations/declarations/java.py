"""Method declarations of Java."""

from collections.abc import Sequence

from mars_asp.annotations.declarations.declaration import (
    DeclaredParameter,
    NoFunction,
    SourceDeclaration,
)
from mars_asp.annotations.declarations.tokens import (
    SourceToken,
    after_angle,
    closing,
    is_word,
    joined,
    split,
    text_at,
    texts,
)

_MODIFIERS = frozenset(
    (
        "public protected private abstract static final synchronized native default strictfp "
        "transient volatile"
    ).split()
)
_STATEMENTS = frozenset(
    (
        "return if else while for switch case throw new do break continue try catch import package "
        "class interface enum record assert yield"
    ).split()
)


def read_java(tokens: Sequence[SourceToken], code: str) -> SourceDeclaration | NoFunction:
    """Return the method `modifiers <T> type name(parameters)`, or the first other token."""
    first = _after_annotations(tokens, 0)
    token = tokens[min(first, len(tokens) - 1)]
    none = NoFunction(token.offset, token.text)
    at = _after_modifiers(tokens, first)
    if text_at(tokens, at) == "<":
        at = _after_modifiers(tokens, after_angle(tokens, at))
    if text_at(tokens, at) in _STATEMENTS:
        return none
    stop = _after_type(tokens, at)
    name = text_at(tokens, stop)
    if stop == at or not is_word(name) or text_at(tokens, stop + 1) != "(":
        return none
    end = closing(tokens, stop + 1)
    groups = split(tokens[stop + 2 : end - 1])
    parameters = [_parameter(group) for group in groups]
    if any(parameter is None for parameter in parameters):
        return none
    written = _type_text(tokens[at:stop]) + _arrays(tokens, end)
    taken = tuple(p for p in parameters if p is not None and p.name != "this")
    return SourceDeclaration(name, written, taken, token.offset, tokens[end - 1].offset)


def _after_annotations(tokens: Sequence[SourceToken], at: int) -> int:
    while text_at(tokens, at) == "@" and text_at(tokens, at + 1) != "interface":
        at += 2
        while text_at(tokens, at) == ".":
            at += 2
        if text_at(tokens, at) == "(":
            at = closing(tokens, at)
    return at


def _after_modifiers(tokens: Sequence[SourceToken], at: int) -> int:
    while True:
        at = _after_annotations(tokens, at)
        if text_at(tokens, at) not in _MODIFIERS:
            return at
        at += 1


def _after_type(tokens: Sequence[SourceToken], at: int) -> int:
    """Return the index after the type that begins at `at`, or `at` without a type."""
    if not is_word(text_at(tokens, at)):
        return at
    at += 1
    while True:
        text = text_at(tokens, at)
        if text == "<":
            at = after_angle(tokens, at)
        elif text == "." and (is_word(text_at(tokens, at + 1)) or text_at(tokens, at + 1) == "@"):
            at = _after_annotations(tokens, at + 1) + 1
        elif text == "[":
            at = closing(tokens, at)
        elif text == "@" and text_at(tokens, _after_annotations(tokens, at)) in ("[", "..."):
            at = _after_annotations(tokens, at)
        else:
            return at


def _type_text(tokens: Sequence[SourceToken]) -> str:
    """Return a type without the annotations in it."""
    kept: list[SourceToken] = []
    at = 0
    while at < len(tokens):
        after = _after_annotations(tokens, at)
        kept += tokens[at : at + 1] if after == at else ()
        at = max(after, at + (after == at))
    return joined(kept)


def _arrays(tokens: Sequence[SourceToken], at: int) -> str:
    """Return `[]` for each pair of brackets from token `at` on, the C-like array suffix."""
    found = ""
    while text_at(tokens, at) == "[":
        at = closing(tokens, at)
        found += "[]"
    return found


def _parameter(group: Sequence[SourceToken]) -> DeclaredParameter | None:
    at = _after_modifiers(group, 0)
    stop = _after_type(group, at)
    written = _type_text(group[at:stop])
    if text_at(group, stop) == "...":
        written += "[]"
        stop += 1
    name = text_at(group, stop)
    if "this" in texts(group[stop:]):
        return DeclaredParameter("this", written)
    if not written or not is_word(name):
        return None
    return DeclaredParameter(name, written + _arrays(group, stop + 1))
