"""Arithmetic in rules that leaves the 32 bits of clingo's integers, which wrap without a word."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from mars_asp import statements
from mars_asp.diagnostic import Diagnostic
from mars_asp.kept import made_of
from mars_asp.source import point
from mars_asp.statements import (
    Number,
    Operand,
    Operation,
    Place,
    definitions,
    operands,
)

LEAST, MOST = -(2**31), 2**31 - 1


class _Overflow(NamedTuple):
    place: Place
    text: str


def overflows(text: str, path: str) -> Iterator[Diagnostic]:
    """Yield the numbers of a rule file, and what is computed from them alone, that do not fit."""
    files = map(Path, (__file__, statements.__file__))
    for place, written in made_of("overflows", files, [text], _overflows)[text]:
        yield Diagnostic(
            "rule-number",
            "error",
            f"`{written}` does not fit into 32 bits, so it would be another number",
            point(path, *place),
            help=f"numbers in rules are {LEAST} to {MOST}",
        )


def _overflows(text: str) -> tuple[_Overflow, ...]:
    found: dict[_Overflow, None] = {}
    known = definitions(text)
    for operand in operands(text):
        _value(operand, known, found)
    return tuple(sorted(found))


def _value(
    operand: Operand, known: Mapping[str, Operand], found: dict[_Overflow, None], depth: int = 0
) -> int | None:
    """Return the exact value of an operand if it is one that fits; note what does not."""
    value: int | None
    match operand:
        case str():
            # What defines itself has no value.
            inner = known.get(operand) if depth < len(known) else None
            return _value(inner, known, found, depth + 1)
        case Number(stated, _):
            value, written = stated, str(stated)
        case Operation("-", (Number(whole, _),)) if whole == MOST + 1:
            return LEAST
        case Operation(sign, inside, written, _):
            value = _computed(sign, [_value(each, known, found, depth) for each in inside])
        case _:
            return None
    if value is not None and not LEAST <= value <= MOST:
        found[_Overflow(operand.place, written)] = None
        return None
    return value


def _computed(sign: str, values: Sequence[int | None]) -> int | None:
    """Return what clingo means by an operation, if it had whole numbers of any size."""
    match sign, values:
        case "-", [int(one)]:
            return -one
        case "|", [int(one)]:
            return abs(one)
        case "+", [int(one), int(other)]:
            return one + other
        case "-", [int(one), int(other)]:
            return one - other
        case "*", [int(one), int(other)]:
            return one * other
        case "**", [int(one), int(other)] if other >= 0:
            # Whatever has more digits does not fit.
            return int(one ** min(other, 64))
        case "/", [int(one), int(other)] if other:
            return abs(one) // abs(other) * (1 if (one < 0) == (other < 0) else -1)
    return None
