"""The numbers of the language: how they are written, and the range of each.

Rules reason with whole numbers of 32 bits, so every number is checked where it is read.
"""

import re
from decimal import Decimal
from typing import NamedTuple

_NUMBER = re.compile(r"[+-]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)")
#: Signs and leading zeros do not count among them, so what is read can be printed.
_MOST_DIGITS = 18
_MOST_SHOWN = 40
MOST = 2**31 - 1
#: Millimetres of which micrometres fit, degrees of which microdegrees fit.
_FARTHEST = Decimal(MOST) / 1000
_WIDEST = Decimal(MOST) / 1_000_000


class Problem(NamedTuple):
    """An error in a number, mode, attribute or tuple, with advice.

    `begin` is its offset in the text, or its slot in the tuple; `end` is stated for attributes.
    """

    message: str
    help: str
    begin: int = 0
    end: int = 0


class NumberRange(NamedTuple):
    """The valid numbers of one use; `noun` includes its article.

    `least` and `most` are valid, except a `least` of 0 with `above`; `decimals`
    is how many may be written, `None` for any number of them.
    """

    noun: str
    least: Decimal
    most: Decimal
    help: str
    decimals: int | None = None
    above: bool = False

    def read(self, text: str) -> Decimal | Problem:
        """Return the number in a text, or the error if it is invalid or out of range."""
        fault = self._fault(text)
        # Zero has no sign.
        return Decimal(text) + 0 if fault is None else Problem(fault, self.help)

    def _fault(self, text: str) -> str | None:
        shown = f"`{_shortened(text)}`"
        if not _NUMBER.fullmatch(text) or (self.decimals == 0 and "." in text):
            return f"expected {self.noun}, found {shown}"
        value = Decimal(text)
        if value > self.most:
            return f"{shown} is too large for {self.noun}"
        if value < self.least or (self.above and value == self.least):
            if self.least < 0:
                return f"{shown} is too small for {self.noun}"
            wanted = "positive" if self.above else f"at least {self.least}"
            return f"{self.noun} must be {wanted}, found {shown}"
        if self.decimals is not None and len(text.partition(".")[2].rstrip("0")) > self.decimals:
            return f"{shown} has too many decimals for {self.noun}"
        if len(text.lstrip("+-0")) > _MOST_DIGITS:
            return f"{shown} has more than {_MOST_DIGITS} digits"
        return None


def _integer_range(noun: str, least: int, most: int = MOST) -> NumberRange:
    help_text = f"write a whole number from {least} to {most}"
    return NumberRange(noun, Decimal(least), Decimal(most), help_text, 0)


PRIORITY = _integer_range("a priority", 0)
HOLD = _integer_range("a hold in milliseconds", 1)
PERIOD = _integer_range("a period in milliseconds", 1)
CLOSED = _integer_range("a time in milliseconds", 1)
VERTEX = _integer_range("a vertex", 0)
COST = _integer_range("a cost", 1, 1_000_000)
FREQUENCY = NumberRange(
    "a frequency",
    Decimal(0),
    _FARTHEST,
    f"write Hz without a unit, above 0, at most {_FARTHEST}, or a period: `every 17 ms`",
    above=True,
)
#: The times between two messages, by their units.
PERIODS = {
    "ms": _integer_range("a period in milliseconds", 1),
    "s": _integer_range("a period in seconds", 1, MOST // 1000),
}
LENGTH = NumberRange(
    "a length", -_FARTHEST, _FARTHEST, f"write a number of mm from -{_FARTHEST} to {_FARTHEST}"
)
ANGLE = NumberRange("an angle", -_WIDEST, _WIDEST, f"write degrees from -{_WIDEST} to {_WIDEST}")
BOUND = NumberRange(
    "a bound",
    -_FARTHEST,
    _FARTHEST,
    f"write `MIN MAX` or `MIN MAX RATE` as numbers from -{_FARTHEST} to {_FARTHEST},"
    " `_` for an open bound",
)
RATE = NumberRange(
    "a rate",
    Decimal(0),
    _FARTHEST,
    f"write the speed without its direction, in degrees or mm per second, at most {_FARTHEST}",
    above=True,
)
_MOST_ARGUMENT = Decimal(10**12)
ARGUMENT = NumberRange(
    "an argument",
    -_MOST_ARGUMENT,
    _MOST_ARGUMENT,
    f"write a number from -{_MOST_ARGUMENT} to {_MOST_ARGUMENT}",
)


def _shortened(text: str) -> str:
    """Return a text, or the beginning of a long one with its length."""
    if len(text) <= _MOST_SHOWN:
        return text
    return f"{text[: _MOST_SHOWN // 2]}... ({len(text)} characters)"
