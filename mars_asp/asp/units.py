"""Whole numbers in the units that people use: a sort that is named after a unit says which.

Rules compute with whole numbers, so they count in small units; nobody wants to read these.
"""

from collections.abc import Iterable, Mapping
from fractions import Fraction

#: The power of ten that stands before a unit in the name of a sort, and how it is written.
_PREFIXES = {
    "micro": (-6, "u"),
    "milli": (-3, "m"),
    "centi": (-2, "c"),
    "": (0, ""),
    "kilo": (3, "k"),
}
#: By the name of a unit how it is written, and with which prefixes people use it.
_MEASURES = {
    "seconds": ("s", ("micro", "milli", "")),
    "hertz": ("Hz", ("milli", "", "kilo")),
    "metres": ("m", ("micro", "milli", "centi", "", "kilo")),
    "grams": ("g", ("milli", "", "kilo")),
    "newtons": ("N", ("milli", "", "kilo")),
    "watts": ("W", ("micro", "milli", "", "kilo")),
    "watt_hours": ("Wh", ("milli", "", "kilo")),
    "joules": ("J", ("milli", "", "kilo")),
    "volts": ("V", ("micro", "milli", "", "kilo")),
    "amperes": ("A", ("micro", "milli", "")),
    "ampere_hours": ("Ah", ("milli", "")),
    "degrees": ("deg", ("micro", "milli", "")),
    "bytes": ("B", ("", "kilo")),
}


def _written(unit: str, prefixes: tuple[str, ...], power: int) -> dict[str, int]:
    """Return the units in which a sort can be written, those that are as large or larger."""
    known = {
        f"{sign}{unit}": 10 ** (other - power)
        for other, sign in map(_PREFIXES.__getitem__, prefixes)
        if other >= power
    }
    return {**known, "min": 60 * known["s"]} if unit == "s" else known


#: By the name of a sort, how many of it are one of the unit that is shown, and that unit.
UNITS: Mapping[str, tuple[int, str]] = {
    **{
        f"{prefix}{name}": (10 ** max(0, -power), f" {sign if power > 0 else ''}{unit}")
        for name, (unit, prefixes) in _MEASURES.items()
        for prefix, (power, sign) in _PREFIXES.items()
        if prefix in prefixes
    },
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
    **{
        f"{prefix}{name}": _written(unit, prefixes, _PREFIXES[prefix][0])
        for name, (unit, prefixes) in _MEASURES.items()
        for prefix in prefixes
    },
    "instant": _written("s", ("milli", ""), -3),
    "millionths": {"%": 10_000},
    "thousandths": {"%": 10},
}
#: The sorts by how their units are written, in small letters.
OF_UNITS: Mapping[str, str] = {
    unit.lower(): sort
    for sort, units in WRITTEN.items()
    for unit, count in units.items()
    if count == 1 and sort != "instant"
}
#: A unit behind its number, from which no line break may part it.
UNIT = r"(?:m?[ms]|k?(?:Hz|Wh|Ah|[mgNWJVAB])|deg|%)(?!\w)"
#: The sorts of whole numbers.
NUMBERS = frozenset({*UNITS, "number", "count", "index", "vertex", "priority", "cost"})


def times_as_many(sort: str, other: str) -> Fraction | None:
    """Return how many of another sort there are for one of a sort of the same measure."""
    one, two = WRITTEN.get(sort, {}), WRITTEN.get(other, {})
    common = next(iter(one.keys() & two.keys()), None)
    return None if common is None else Fraction(two[common], one[common])


def measured(number: int, sort: str) -> str:
    """Return a number of a sort in the unit that is shown for it: 25000 millihertz as `25 Hz`."""
    divisor, unit = UNITS[sort]
    if sort in _LARGER and abs(number) >= _LARGER[sort][0]:
        divisor, unit = _LARGER[sort]
    whole, rest = divmod(abs(number), divisor)
    fraction = f".{rest:0{len(str(divisor)) - 1}}".rstrip("0") if rest else ""
    return f"{'-' if number < 0 else ''}{whole}{fraction}{unit}"


def measured_alike(numbers: Iterable[int], sort: str) -> tuple[str, ...]:
    """Return numbers of a sort in one unit: that of the sort where one is less than a whole unit.

    40 and 50 milliseconds are `40 ms` and `50 ms`, 1500 and 2000 are `1.5 s` and `2 s`.
    """
    numbers = tuple(numbers)
    own = next((unit for unit, count in WRITTEN.get(sort, {}).items() if count == 1), None)
    if own is not None and any(0 < abs(number) < UNITS[sort][0] for number in numbers):
        return tuple(f"{number} {own}" for number in numbers)
    return tuple(measured(number, sort) for number in numbers)
