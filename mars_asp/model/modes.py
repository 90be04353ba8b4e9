"""Delivery modes and frequencies as they are written in annotations and in `.mars` files."""

import re
from decimal import Decimal

from mars_asp.model.declarations import DELIVERY_MODES, MODE_ARGUMENTS, Mode
from mars_asp.model.ranges import ARGUMENT, Problem
from mars_asp.spelling import nearest

_MODE = re.compile(r"\s*([A-Za-z_]\w*)\s*(?:\(([^()]*)\))?\s*")
#: Those arguments, by their positions, that are a distance, which has no sign.
_DISTANCES = {("NotifyOnValue", 1): "a tolerance", ("NotifyOnChange", 0): "a least difference"}


def parse_mode(text: str) -> Mode | Problem:
    """Return the mode in a text such as `NotifyOnValue(30, 0.5)`, or the error in it."""
    match = _MODE.fullmatch(text)
    if match is None:
        return Problem(f"`{text.strip()}` is not a delivery mode", _expected(text))
    name, inside = match[1], match[2]
    if name not in DELIVERY_MODES:
        return Problem(f"`{name}` is not a delivery mode", _expected(name), match.start(1))
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
        if most and named and of is None:
            of = named[1]
        elif len(arguments) < most and of is None:
            number = _mode_argument(stripped, name, len(arguments))
            if isinstance(number, Problem):
                return number._replace(begin=at)
            arguments.append(number)
        else:
            message = f"`{stripped}` is not an argument of `{name}`"
            return Problem(message, _takes(name, most), at)
        offset += len(part) + 1
    # A distance of zero is what is meant where none is stated.
    if arguments and arguments[-1] == 0 and (name, len(arguments) - 1) in _DISTANCES:
        arguments.pop()
    return Mode(name, tuple(arguments), of, written)


def _mode_argument(text: str, name: str, position: int) -> Decimal | Problem:
    """Return argument `position` of the mode `name` as a number, or the error in it."""
    number = ARGUMENT.read(text)
    if isinstance(number, Problem):
        if not re.match(r"[-+]?\.?[0-9]", text):
            return Problem(
                f"`{text}` is not an argument of `{name}`", _takes(name, MODE_ARGUMENTS[name])
            )
        return Problem(f"`{name}`: {number.message}", number.help)
    if number < 0 and (name, position) in _DISTANCES:
        what = _DISTANCES[name, position]
        return Problem(f"`{text}` is negative, and {what} must not be", "write its magnitude")
    return number


def _expected(name: str) -> str:
    near = nearest(name, DELIVERY_MODES)
    if near:
        return f"did you mean `{near}`?"
    return f"write one of {', '.join(DELIVERY_MODES)}"


def _takes(name: str, most: int) -> str:
    if not most:
        return f"`{name}` takes no arguments"
    numbers = "one number" if most == 1 else f"{most} numbers"
    return f"`{name}` takes at most {numbers}, then `of=FIELD`"
