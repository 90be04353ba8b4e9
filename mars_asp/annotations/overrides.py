"""`@Output`, `@Input`, `@Port` and `@Window`: corrections and additions to a declaration."""

import re
from collections.abc import Sequence
from dataclasses import dataclass, field

from mars_asp.annotations.arguments import ArgumentProblem, parts
from mars_asp.annotations.declarations import SourceDeclaration
from mars_asp.annotations.directives import Directive
from mars_asp.annotations.types import representation
from mars_asp.model.names import QUOTED, plain, read_name

_ONE_INPUT = re.compile(rf"([^\W\d]\w*|{QUOTED})\s*:(?!:)\s*(.+)")
#: The name of an unknown representation.
_UNKNOWN = "auto"
_WHOLE = re.compile(r"[0-9]{1,10}")
#: The longest window, in milliseconds.
_LONGEST = 2**31 - 1


@dataclass(frozen=True, slots=True)
class Overrides:
    """The types and the port name that `@Output`, `@Input` and `@Port` give a declaration.

    `inputs` are the types of all inputs in order, `named` the types of single parameters, and
    `further` the types of inputs without a parameter.
    """

    output: str | None = None
    inputs: tuple[str, ...] | None = None
    named: dict[str, str] = field(default_factory=dict)
    port: str | None = None
    further: dict[str, str] = field(default_factory=dict)
    window_ms: int | None = None


def read_overrides(
    found: Sequence[Directive], declaration: SourceDeclaration
) -> tuple[Overrides, list[tuple[Directive, ArgumentProblem]]]:
    """Return the overrides of one declaration, and their problems."""
    output: str | None = None
    inputs: tuple[str, ...] | None = None
    port: str | None = None
    window: int | None = None
    named: dict[str, str] = {}
    further: dict[str, str] = {}
    wrong: list[tuple[Directive, ArgumentProblem]] = []
    for directive in found:
        text = directive.rest
        single = _ONE_INPUT.fullmatch(text) if directive.word == "Input" else None
        problem = None
        if directive.word == "Output":
            problem = _again("@Output") if output is not None else _unreadable(text, declaration)
            output = output if problem else text
        elif directive.word == "Port":
            problem = _again("@Port") if port is not None else _no_name(text)
            port = port if problem else read_name(text)
        elif directive.word == "Window":
            problem = _again("@Window") if window is not None else _no_window(text)
            window = window if problem else int(text)
        elif single is not None and single[1].startswith('"'):
            name = plain(single[1])
            problem = _again("@Input") if inputs is not None or name in further else None
            problem = problem or _unreadable_part(single.start(2), single[2])
            if problem is None:
                further[name] = single[2].strip()
        elif single is not None:
            problem = _again("@Input") if inputs is not None or single[1] in named else None
            problem = problem or _unknown_parameter(single, declaration)
            problem = problem or _unreadable_part(single.start(2), single[2])
            if problem is None:
                named[single[1]] = single[2].strip()
        elif directive.word == "Input":
            pieces = list(parts(text))
            problem = _again("@Input") if inputs is not None or named or further else None
            for begin, piece in pieces:
                problem = problem or _unreadable_part(begin, piece)
            if problem is None:
                inputs = tuple(piece.strip() for _, piece in pieces)
        if problem is not None:
            wrong.append((directive, problem))
    return Overrides(output, inputs, named, port, further, window), wrong


def _again(word: str) -> ArgumentProblem:
    return ArgumentProblem(
        "MARS210", f"`{word}` repeats an annotation above it", "keep one of the two"
    )


def _no_name(text: str) -> ArgumentProblem | None:
    if read_name(text) is not None:
        return None
    help_text = "write letters, digits, `_`, `-` and `/`, or put the name in quotes"
    return ArgumentProblem(
        "MARS107", f"expected the name of a port, found `{text}`", help_text, 0, len(text)
    )


def _no_window(text: str) -> ArgumentProblem | None:
    """Return the problem of a `@Window` without a whole number of milliseconds, if it is one."""
    if _WHOLE.fullmatch(text) and 1 <= int(text) <= _LONGEST:
        return None
    message = f"expected milliseconds, found `{text}`"
    help_text = f"write a whole number from 1 to {_LONGEST}, as in `@Window 50`"
    return ArgumentProblem("MARS215", message, help_text, 0, len(text))


def _unknown_parameter(
    single: re.Match[str], declaration: SourceDeclaration
) -> ArgumentProblem | None:
    names = [parameter.name for parameter in declaration.parameters if parameter.name]
    if single[1] in names:
        return None
    known = ", ".join(f"`{name}`" for name in names)
    return ArgumentProblem(
        "MARS209",
        f"`{declaration.name}` has no parameter `{single[1]}`",
        f"it has {known}" if known else "state all inputs: `@Input TYPE, TYPE`",
        *single.span(1),
    )


def _unreadable(text: str, declaration: SourceDeclaration) -> ArgumentProblem | None:
    if any(parameter.name == text for parameter in declaration.parameters):
        return None
    return _unreadable_part(0, text)


def _unreadable_part(begin: int, text: str) -> ArgumentProblem | None:
    written = text.strip()
    if written in ("none", _UNKNOWN) or representation(written):
        return None
    at = begin + len(text) - len(text.lstrip())
    return ArgumentProblem(
        "MARS211",
        f"expected a representation, found `{written}`",
        "write a type or `none`",
        at,
        at + len(written),
    )
