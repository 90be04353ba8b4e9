"""Whole numbers in the units that people use: a sort that is named after a unit says which.

Rules compute with whole numbers, so they count in small units; nobody wants to read these.
"""

from collections.abc import Mapping

#: By the name of a sort, how many of it are one of the unit that is shown, and that unit.
UNITS: Mapping[str, tuple[int, str]] = {
    "millihertz": (1_000, " Hz"),
    "milliseconds": (1_000, " s"),
    "micrometres": (1_000, " mm"),
    "millionths": (10_000, " %"),
    "instant": (1_000, " s"),
    "thousandths": (10, " %"),
    "thousandths_a_second": (1_000, " a second"),
}
#: By the name of a sort, from how many on it is shown in another unit.
_LARGER: Mapping[str, tuple[int, str]] = {"micrometres": (1_000_000, " m")}

#: By the name of a sort, how many of it are one of each unit that it can be written in.
WRITTEN: Mapping[str, Mapping[str, int]] = {
    "millihertz": {"mHz": 1, "Hz": 1_000},
    "milliseconds": {"ms": 1, "s": 1_000, "min": 60_000},
    "instant": {"ms": 1, "s": 1_000, "min": 60_000},
    "micrometres": {"um": 1, "mm": 1_000, "m": 1_000_000},
    "millionths": {"%": 10_000},
    "thousandths": {"%": 10},
}
#: A unit behind its number, from which no line break may part it.
UNIT = r"(?:Hz|mm|ms|m|s|%)(?!\w)"
#: The sorts of whole numbers.
NUMBERS = frozenset({*UNITS, "number", "count", "index", "vertex", "priority", "cost"})


def measured(number: int, sort: str) -> str:
    """Return a number of a sort in the unit that is shown for it: 25000 millihertz as `25 Hz`."""
    divisor, unit = UNITS[sort]
    if sort in _LARGER and abs(number) >= _LARGER[sort][0]:
        divisor, unit = _LARGER[sort]
    whole, rest = divmod(abs(number), divisor)
    fraction = f".{rest:0{len(str(divisor)) - 1}}".rstrip("0") if rest else ""
    return f"{'-' if number < 0 else ''}{whole}{fraction}{unit}"
