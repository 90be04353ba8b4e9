"""Types in declarations of C and C++, freed of specifiers and macros."""

import re
from collections.abc import Sequence
from typing import Literal, NamedTuple, TypeAlias

from mars_asp.annotations.declarations.tokens import (
    SourceToken,
    after_angle,
    closing,
    is_word,
    joined,
    text_at,
)

SPECIFIERS = frozenset(
    (
        "static inline virtual explicit constexpr consteval constinit friend extern register "
        "thread_local mutable typename const volatile struct class enum union restrict "
        "__restrict __restrict__ _Noreturn _Thread_local _Atomic __extension__ __inline "
        "__inline__ __forceinline __const __volatile__ __cdecl __stdcall __fastcall __thiscall "
        "__vectorcall WINAPI APIENTRY CALLBACK PASCAL JNICALL JNIEXPORT template"
    ).split()
)
BUILTIN_WORDS = frozenset(
    "unsigned signed long short int char float double bool void _Bool _Complex __int128".split()
)
_PLACEHOLDERS = frozenset(("auto", "decltype"))
#: Words before brackets that belong to the decorated declaration.
ATTRIBUTES = frozenset(
    ("__attribute__", "__attribute", "__declspec", "alignas", "_Alignas", "__asm__", "asm")
)
_MACRO = re.compile(r"_*[A-Z][A-Z0-9_]*[A-Z0-9_]|_[A-Z][a-z]*_(?:[a-z]+_)*")


def is_macro(text: str) -> bool:
    """Whether a word has the form of a macro name."""
    return _MACRO.fullmatch(text) is not None


def without_attributes(tokens: Sequence[SourceToken]) -> list[SourceToken]:
    """Return tokens without `[[...]]`, `__attribute__((...))` and the like."""
    if not any(text == "[" or text in ATTRIBUTES for text, _ in tokens):
        return list(tokens)
    kept: list[SourceToken] = []
    at = 0
    while at < len(tokens):
        after = after_attribute(tokens, at)
        if after == at:
            kept.append(tokens[at])
            after += 1
        at = after
    return kept


def after_attribute(tokens: Sequence[SourceToken], at: int) -> int:
    """Return the index after the attribute that begins at `at`, or `at` without an attribute."""
    text = text_at(tokens, at)
    if text == "[":
        return closing(tokens, at) if text_at(tokens, at + 1) == "[" else at
    if text in ATTRIBUTES and text_at(tokens, at + 1) == "(":
        return closing(tokens, at + 1)
    return at


Kind: TypeAlias = Literal["name", "builtin", "placeholder", "specifier", "sign"]


class Unit(NamedTuple):
    """One component of a type: a whole qualified name with its arguments, or a sign."""

    kind: Kind
    tokens: Sequence[SourceToken]

    @property
    def text(self) -> str:
        """Return the text of the first token."""
        return self.tokens[0].text


def units(tokens: Sequence[SourceToken]) -> list[Unit]:
    """Return the components of a type: names, builtin words, specifiers and signs."""
    found: list[Unit] = []
    at = 0
    while at < len(tokens):
        begin, text = at, tokens[at].text
        kind: Kind = "name"
        at += 1
        if text in SPECIFIERS:
            kind = "specifier"
        elif text in BUILTIN_WORDS:
            kind = "builtin"
        elif text in _PLACEHOLDERS:
            kind = "placeholder"
            at = closing(tokens, at) if text_at(tokens, at) == "(" else at
        elif is_word(text):
            at = _after_name(tokens, at)
        elif text == "::" and is_word(text_at(tokens, at)):
            at = _after_name(tokens, at + 1)
        else:
            kind = "sign"
        found.append(Unit(kind, tokens[begin:at]))
    return found


def _after_name(tokens: Sequence[SourceToken], at: int) -> int:
    """Return the index after the continuation of a name: arguments and `::name`."""
    while True:
        if text_at(tokens, at) == "<":
            at = after_angle(tokens, at)
        elif text_at(tokens, at) == "::":
            at += 1
            while text_at(tokens, at) == "template":
                at += 1
            if not is_word(text_at(tokens, at)):
                return at
            at += 1
        else:
            return at


def type_text(parts: Sequence[Unit]) -> str | None:
    """Return the text of a type without specifiers and macros, or None if it names no type.

    Among several names, the last one without the form of a macro is the type.
    """
    if any(part.kind == "placeholder" for part in parts):
        return "auto"
    signs = "".join(part.text for part in parts if part.kind == "sign")
    builtin = [part.text for part in parts if part.kind == "builtin"]
    if builtin:
        return " ".join(builtin) + signs
    names = [part for part in parts if part.kind == "name"]
    plain = [part for part in names if not is_macro(part.text)] or names
    return joined(plain[-1].tokens) + signs if plain else None
