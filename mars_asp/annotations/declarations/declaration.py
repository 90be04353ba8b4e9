"""What a function declaration says, in whichever language it is written."""

from dataclasses import dataclass

#: The type of a callback; callbacks are never data, so what they take is not kept.
CALLBACK = "std::function<void()>"


@dataclass(frozen=True, slots=True)
class DeclaredParameter:
    """A parameter's name and type as written; `out` where it can be written to."""

    name: str | None
    type: str | None
    out: bool = False


@dataclass(frozen=True, slots=True)
class SourceDeclaration:
    """A function's declaration.

    `offset` is where it begins and `end` where its parameters do; `conditional` is the offset of an
    `#if` within, if any. `output` is the type as written, or None if it is not stated.
    """

    name: str
    output: str | None
    parameters: tuple[DeclaredParameter, ...]
    offset: int
    end: int
    conditional: int | None = None


@dataclass(frozen=True, slots=True)
class NoFunction:
    """What follows is no function: where its first token is and what that is."""

    offset: int
    found: str
