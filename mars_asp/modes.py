"""Delivery modes and frequencies as they are written in annotations and in `.mars` files."""

import re
from dataclasses import dataclass
from decimal import Decimal

from mars_asp.model import DELIVERY_MODES, MODE_ARGUMENTS, Mode
from mars_asp.spelling import nearest

_NUMBER = re.compile(r"[+-]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)")
_MODE = re.compile(r"\s*([A-Za-z_]\w*)\s*(?:\(([^()]*)\))?\s*")
_MOST_DIGITS = 18


@dataclass(frozen=True, slots=True)
class ModeProblem:
    """What is wrong with a mode: where in its text (from 0), the message and what to do."""

    offset: int
    message: str
    help: str


def parse_number(text: str) -> Decimal | None:
    """Return a plain decimal number (no exponent, no unit), or `None` where it is none.

    Signs and leading zeros do not count among its digits, so what is read can be printed.
    """
    if len(text.lstrip("+-0")) > _MOST_DIGITS or not _NUMBER.fullmatch(text) or not text.isascii():
        return None
    return Decimal(text)


def parse_mode(text: str) -> Mode | ModeProblem:
    """Read one mode, such as `NotifyOnValue(30, 0.5)` or `NotifyOnMin(300, of=nearest)`."""
    match = _MODE.fullmatch(text)
    if match is None:
        return ModeProblem(0, f"`{text.strip()}` is no delivery mode", _expected(text))
    name, inside = match[1], match[2]
    if name not in DELIVERY_MODES:
        return ModeProblem(match.start(1), f"`{name}` is no delivery mode", _expected(name))
    written = re.sub(r"\s+", " ", text.strip())
    if inside is None:
        return Mode(name, text=written)
    most = MODE_ARGUMENTS.get(name, 0)
    arguments: list[Decimal] = []
    of: str | None = None
    offset = match.start(2)
    for part in inside.split(","):
        stripped = part.strip()
        at = offset + len(part) - len(part.lstrip())
        named = re.fullmatch(r"of\s*=\s*([A-Za-z_][\w.]*)", stripped)
        number = parse_number(stripped)
        if most and named and of is None:
            of = named[1]
        elif number is not None and len(arguments) < most and of is None:
            arguments.append(number)
        else:
            return ModeProblem(
                at, f"`{stripped}` is no argument of `{name}`", _arguments_help(name, most)
            )
        offset += len(part) + 1
    return Mode(name, tuple(arguments), of, written)


def _expected(name: str) -> str:
    near = nearest(name, DELIVERY_MODES)
    if near:
        return f"did you mean `{near}`?"
    return f"write one of {', '.join(DELIVERY_MODES)}"


def _arguments_help(name: str, most: int) -> str:
    if not most:
        return f"`{name}` takes no arguments"
    return f"`{name}` takes at most {most} number(s), then `of=FIELD`"
