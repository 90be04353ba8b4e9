"""The data of a function declaration, in any language."""

from dataclasses import dataclass

#: The type of a callback; callbacks are never data, so their parameters are not kept.
CALLBACK = "std::function<void()>"


@dataclass(frozen=True, slots=True)
class DeclaredParameter:
    """A parameter's name and type as written; `out` is whether its target is writable."""

    name: str | None
    type: str | None
    out: bool = False


@dataclass(frozen=True, slots=True)
class SourceDeclaration:
    """A function's declaration.

    `offset` is its begin and `end` the end of its parameters; `conditional` is the offset of an
    `#if` within, or None. `output` is the type as written, or None if it is not stated.
    """

    name: str
    output: str | None
    parameters: tuple[DeclaredParameter, ...]
    offset: int
    end: int
    conditional: int | None = None


@dataclass(frozen=True, slots=True)
class NoFunction:
    """The first token of code without a function declaration."""

    offset: int
    found: str
