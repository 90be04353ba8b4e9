"""How many seconds an expression in C++ comes to, where it is written out."""

import re
from collections.abc import Sequence
from fractions import Fraction

from mars_asp.annotations.declarations.tokens import SourceToken, joined

_NUMBER = re.compile(r"(\d[\d']*(?:\.\d*)?|\.\d+)(?:[eE]([-+]?\d+))?(?:f|F|u|l|L)*")
_UNITS = {
    "ns": Fraction(1, 10**9),
    "us": Fraction(1, 10**6),
    "ms": Fraction(1, 1000),
    "s": Fraction(1),
    "min": Fraction(60),
}
#: The units of a `std::chrono::duration`; a `std::ratio` is not worked out.
_RATIOS = {
    "milli": Fraction(1, 1000),
    "micro": Fraction(1, 10**6),
    "nano": Fraction(1, 10**9),
    "ratio": None,
}
_DURATIONS = {
    "nanoseconds": Fraction(1, 10**9),
    "microseconds": Fraction(1, 10**6),
    "milliseconds": Fraction(1, 1000),
    "seconds": Fraction(1),
    "minutes": Fraction(60),
    "Duration": Fraction(1),
    "WallDuration": Fraction(1),
    "from_seconds": Fraction(1),
    "duration": Fraction(1),
}
_LITERAL = re.compile(r"(\d[\d.']*)(ns|us|ms|s|min)")


def seconds_in(argument: Sequence[SourceToken]) -> Fraction | None:
    """Return the seconds of a literal duration such as `500ms`, or None for another expression."""
    text = joined(argument)
    literal = _LITERAL.fullmatch(text)
    if literal:
        number = number_in(literal[1])
        return None if number is None else number * _UNITS[literal[2]]
    words = [token.text for token in argument]
    for at, word in enumerate(words):
        if word in _DURATIONS:
            rest = words[at + 1 :]
            opening = next((i for i, t in enumerate(rest) if t in "({"), None)
            if opening is not None:
                number = number_in("".join(rest[opening + 1 : -1]))
                # `duration<double, std::milli>` counts in a unit of its own.
                units = [_RATIOS.get(each) for each in rest[:opening] if each in _RATIOS]
                unit = units[0] if units else _DURATIONS[word]
                return None if number is None or unit is None else number * unit
    return None


def number_in(text: str) -> Fraction | None:
    """Return the value of a literal, or of a quotient of two literals, or None for another text."""
    first, slash, second = text.partition("/")
    found = []
    for part in (first, second) if slash else (first,):
        match = _NUMBER.fullmatch(part.strip())
        if match is None or len(part) > 30 or abs(int(match[2] or 0)) > 30:
            return None
        exponent = f"e{match[2]}" if match[2] else ""
        found.append(Fraction(match[1].replace("'", "").rstrip(".") + exponent))
    if slash:
        return found[0] / found[1] if found[1] else None
    return found[0]
