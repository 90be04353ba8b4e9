"""Rates of messages: exact, and as they are written."""

from decimal import Decimal
from fractions import Fraction
from functools import lru_cache
from typing import Self

from mars_asp.model.ranges import FREQUENCY, Problem

#: Milliseconds of the units in which a period is written.
_UNITS = {"ms": 1, "s": 1000}


class Rate(Fraction):
    """An exact rate in Hertz, with its original text; equal to any equal number."""

    __slots__ = ("written",)
    written: str

    def __new__(cls, hz: Fraction | Decimal | int, written: str | None = None) -> Self:
        """Return a rate, with its text as `written`, else in canonical form."""
        rate = super().__new__(cls, hz)
        rate.written = as_written(rate) if written is None else written
        return rate

    def __copy__(self) -> Self:
        """Return the rate itself, which nothing changes."""
        return self

    def __deepcopy__(self, memo: object) -> Self:
        """Return the rate itself, which nothing changes."""
        return self

    def __reduce__(self) -> tuple[type[Self], tuple[Fraction, str]]:
        """Return the constructor with its arguments, as `pickle` needs them."""
        return type(self), (Fraction(self), self.written)


@lru_cache(maxsize=1024)
def read_frequency(text: str) -> Rate | Problem:
    """Return the rate in a number of Hertz, or the error in it."""
    hz = FREQUENCY.read(text)
    return hz if isinstance(hz, Problem) else Rate(hz)


def every(period: Decimal | int, unit: str) -> Rate:
    """Return the rate of one message per period, which is above 0, in `ms` or `s`."""
    words = f"every {_decimal_text(Fraction(period))} {unit}"
    return Rate(Fraction(1000) / (Fraction(period) * _UNITS[unit]), words)


def as_written(hz: Fraction) -> str:
    """Return a rate as text: as a decimal number, or as a period if that is not finite."""
    if isinstance(hz, Rate) and hasattr(hz, "written"):
        return hz.written
    if _is_decimal(hz):
        return _decimal_text(hz)
    period = 1000 / hz
    if period.denominator != 1 and not _is_decimal(period):
        raise ValueError(f"{hz} Hz can be written neither as a rate nor as a period")
    return f"every {_decimal_text(period)} ms"


def as_number(hz: Fraction) -> int | float:
    """Return a rate for JSON: an integer if it is whole, else the nearest float."""
    return int(hz) if hz.denominator == 1 else float(hz)


def _is_decimal(number: Fraction) -> bool:
    """Whether a number has finitely many decimals."""
    rest = number.denominator
    for prime in (2, 5):
        while rest % prime == 0:
            rest //= prime
    return rest == 1


def _decimal_text(number: Fraction) -> str:
    """Return a number with finitely many decimals as text, without an exponent."""
    whole, rest = divmod(abs(number), 1)
    sign = "-" if number < 0 else ""
    digits = ""
    while rest:
        digit, rest = divmod(rest * 10, 1)
        digits += str(digit)
    return f"{sign}{whole}.{digits}" if digits else f"{sign}{whole}"
