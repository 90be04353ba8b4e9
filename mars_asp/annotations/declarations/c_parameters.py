"""Parameters in declarations of C and C++."""

from collections.abc import Sequence

from mars_asp.annotations.declarations.c_types import (
    Unit,
    is_macro,
    type_text,
    units,
    without_attributes,
)
from mars_asp.annotations.declarations.declaration import CALLBACK, DeclaredParameter
from mars_asp.annotations.declarations.tokens import (
    SourceToken,
    after_angle,
    before,
    closing,
    is_word,
    outside,
    split,
    text_at,
    texts,
)

#: Signs that occur in expressions and in no parameter, before a default.
_OF_EXPRESSIONS = frozenset(".+-/!?|%;~")
_BRACKETS = frozenset("([{<")


def declarators(tokens: Sequence[SourceToken]) -> list[Sequence[SourceToken]]:
    """Return the tokens of each parameter, without attributes and defaults."""
    return [before(group, "=") for group in split(without_attributes(tokens))]


def are_parameters(found: Sequence[Sequence[SourceToken]]) -> bool:
    """Whether declarators can be parameters, and not a call's arguments."""
    for declarator in found:
        words = [text for _, text in outside(declarator) if text not in _BRACKETS]
        if not any(is_word(text) or text == "..." for text in words):
            return False
        if any(text in _OF_EXPRESSIONS or text[0] in '"0123456789' for text in words):
            return False
    return True


def read_parameter(tokens: Sequence[SourceToken]) -> DeclaredParameter | None:
    """Return the parameter of a declarator, or None for `void`, `...` and C++'s explicit object."""
    words = texts(tokens)
    if words in (["void"], ["..."], []) or words[0] == "this":
        return None
    if "(" in words:
        bracket = next((at for at, text in _with_angles(tokens) if text == "("), None)
        if bracket is not None:
            return _bracketed(tokens, bracket)
    tokens, arrays = without_arrays(tokens)
    return _split_name(tokens, arrays)


def _with_angles(tokens: Sequence[SourceToken]) -> list[tuple[int, str]]:
    """Return index and text of the tokens outside of template arguments."""
    found: list[tuple[int, str]] = []
    at = 0
    while at < len(tokens):
        text = tokens[at].text
        found.append((at, text))
        at = after_angle(tokens, at) if text == "<" else at + 1
    return found


def _bracketed(tokens: Sequence[SourceToken], at: int) -> DeclaredParameter | None:
    """Return a parameter with brackets, such as `T (*f)(...)` or `MACRO(T x)`; None for others."""
    end = closing(tokens, at)
    inside = tokens[at + 1 : end - 1]
    names = [part for part in units(tokens[:at]) if part.kind in ("name", "builtin", "placeholder")]
    if len(names) == 1 and is_macro(names[0].text) and end == len(tokens):
        return read_parameter(before(inside, "="))
    signs = [token.text for token in inside]
    if not set(signs) & {"*", "&", "&&", "^"}:
        if len(inside) == len(names) == 1 and end == len(tokens):
            return _split_name([*tokens[:at], inside[0]], "")
        # A function as a parameter is a pointer to the function.
        return DeclaredParameter(tokens[at - 1].text if len(names) > 1 else None, CALLBACK)
    inner, _ = without_arrays(inside)
    name = inner[-1].text if inner and is_word(inner[-1].text) else None
    if "(" in signs or text_at(tokens, end) == "(":
        return DeclaredParameter(name, CALLBACK)
    outer, arrays = without_arrays(tokens[end:])
    kind = type_text(units(tokens[:at]))
    # A pointer or reference to an array is the array; any other pointer is its target type.
    extra = "[]" if len(inner) != len(inside) else ""
    written = None if kind is None else f"{kind}{extra}{arrays}"
    return DeclaredParameter(name, written, "const" not in texts([*tokens[:at], *outer]))


def without_arrays(tokens: Sequence[SourceToken]) -> tuple[list[SourceToken], str]:
    """Return a declarator without `[...]`, and its array brackets as `[]`."""
    for at, token in enumerate(tokens):
        if token.text == "[":
            end, arrays = at, ""
            while text_at(tokens, end) == "[":
                end = closing(tokens, end)
                arrays += "[]"
            return [*tokens[:at], *tokens[end:]], arrays
    return list(tokens), ""


def _split_name(tokens: Sequence[SourceToken], arrays: str) -> DeclaredParameter:
    """Return the parameter of a type and an optional name after it."""
    parts = units(tokens)
    kinds = [part for part in parts if part.kind not in ("specifier", "sign")]
    if len(kinds) > 2 and is_macro(kinds[-1].text):
        # A macro after the name, such as `Scan s UNUSED`.
        parts.remove(kinds.pop())
    name = None
    final = next((part for part in reversed(parts) if part.kind != "specifier"), None)
    if final is not None and final.kind == "name" and len(kinds) > 1 and len(final.tokens) == 1:
        name = final.text
        parts.remove(final)
    kind = type_text(parts)
    return DeclaredParameter(name, None if kind is None else kind + arrays, _is_out(parts))


def _is_out(parts: Sequence[Unit]) -> bool:
    """Whether the target of a pointer or reference type can be written."""
    words = [part.text for part in parts if part.kind in ("specifier", "sign")]
    stars = [at for at, text in enumerate(words) if text in ("*", "&")]
    return bool(stars) and "const" not in words[: stars[-1]]


def read_old_style(
    names: Sequence[str], tokens: Sequence[SourceToken]
) -> tuple[DeclaredParameter, ...] | None:
    """Return the parameters declared between `)` and `{` in K&R style.

    The result is None if they declare anything except the named parameters.
    """
    types: dict[str, DeclaredParameter] = {}
    start = 0
    for at, token in enumerate(tokens):
        if token.text != ";":
            continue
        groups = declarators(tokens[start:at])
        start = at + 1
        if not groups:
            continue
        base = [t for t in groups[0] if is_word(t.text)][: -1 if len(groups[0]) > 1 else None]
        for index, group in enumerate(groups):
            parameter = read_parameter(group if not index else [*base, *group])
            if parameter is None or parameter.name is None or parameter.name not in names:
                return None
            types[parameter.name] = parameter
    if start < len(tokens) or not types:
        return None
    return tuple(types.get(name, DeclaredParameter(name, "int")) for name in names)
