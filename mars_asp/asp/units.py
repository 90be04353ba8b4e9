"""Whole numbers in readable units: a sort that is named after a unit defines the unit.

Rules compute with whole numbers, so they count in small units, which are hard to read.
"""

from collections.abc import Iterable, Mapping
from fractions import Fraction
from functools import cache

#: The power of ten of each SI prefix in the name of a sort, and its sign.
_NAMES = (
    "quecto:-30:q ronto:-27:r yocto:-24:y zepto:-21:z atto:-18:a femto:-15:f pico:-12:p nano:-9:n "
    "micro:-6:u milli:-3:m centi:-2:c deci:-1:d :0: deca:1:da hecto:2:h kilo:3:k mega:6:M giga:9:G "
    "tera:12:T peta:15:P exa:18:E zetta:21:Z yotta:24:Y ronna:27:R quetta:30:Q"
)
_PREFIXES = {
    name: (int(power), sign)
    for name, power, sign in (each.split(":") for each in _NAMES.split(" "))
}
_SIGNS = dict(_PREFIXES.values())
#: The sign of each unit, by its name.
_BASES = {
    "seconds": "s",
    "hertz": "Hz",
    "metres": "m",
    "grams": "g",
    "newtons": "N",
    "watts": "W",
    "watt_hours": "Wh",
    "joules": "J",
    "volts": "V",
    "amperes": "A",
    "ampere_hours": "Ah",
    "degrees": "deg",
    "bytes": "B",
}
_MEASURES = {
    **_BASES,
    **{f"{name}_per_second": f"{unit}/s" for name, unit in _BASES.items() if name != "seconds"},
}
#: The sort, unit and power of ten of each measure. Bytes have no fractions: dB means decibel.
_SORTS = [
    (f"{prefix}{name}", unit, power)
    for prefix, (power, _) in _PREFIXES.items()
    for name, unit in _MEASURES.items()
    if power >= 0 or not unit.startswith("B")
]


def _scaled_unit(unit: str, power: int) -> tuple[int, str]:
    """Return divisor and sign in which a value in 10^`power` of a unit is shown."""
    if power >= 0:
        return 1, f" {_SIGNS[power]}{unit}"
    return (10**-power, f" {unit}") if power >= -6 else (1000, f" {_SIGNS[power + 3]}{unit}")


def usual(units: Mapping[str, int]) -> tuple[str, ...]:
    """Return the unit of a sort, and its usual larger units."""
    whole = {*_MEASURES.values(), "%", "min", *(f"k{unit}" for unit in _MEASURES.values())} - {"ks"}
    small = {f"m{unit}" for unit in _MEASURES.values()}
    return tuple(unit for unit, count in units.items() if count == 1 or unit in whole | small)


#: The number of a sort in one shown unit, and the sign of this unit, by the name of the sort.
UNITS: Mapping[str, tuple[int, str]] = {
    **{sort: _scaled_unit(unit, power) for sort, unit, power in _SORTS},
    "micrometres": (1_000, " mm"),
    "millionths": (10_000, " %"),
    "instant": (1_000, " s"),
    "thousandths": (10, " %"),
    "thousandths_a_second": (1_000, " a second"),
}
#: The number from which a sort is shown in another unit, and this unit, by the name of the sort.
_LARGER: Mapping[str, tuple[int, str]] = {"micrometres": (1_000_000, " m")}

#: The unit and power of ten of each sort that can be written in several units.
_MEASURED = {sort: (unit, power) for sort, unit, power in _SORTS} | {"instant": ("s", -3)}
_OF_EXACT = {f"{_SIGNS[power]}{unit}": sort for sort, unit, power in _SORTS}
#: The sorts by their units' signs, also in small letters; an ambiguous one is the smaller unit.
OF_UNITS: Mapping[str, str] = {
    **{unit.lower(): sort for unit, sort in reversed(_OF_EXACT.items())},
    **_OF_EXACT,
}
#: A unit after its number, never separated by a line break; `as` is rather a word.
UNIT = (
    rf"(?!as\b)(?:(?:{'|'.join(filter(None, _SIGNS.values()))})?"
    rf"(?:{'|'.join(_BASES.values())})(?:/s)?|%)(?![\w/])"
)
#: The sorts of whole numbers.
NUMBERS = frozenset({*UNITS, "number", "count", "index", "vertex", "priority", "cost"})


@cache
def units_of(sort: str) -> Mapping[str, int]:
    """Return each unit in which a number of a sort may be written, with its size in the sort."""
    if sort not in _MEASURED:
        return {"millionths": {"%": 10_000}, "thousandths": {"%": 10}}.get(sort, {})
    unit, power = _MEASURED[sort]
    known = {
        f"{sign}{unit}": 10 ** (other - power)
        for other, sign in _SIGNS.items()
        if other >= power and (other >= 0 or unit[0] != "B")
    }
    return {**known, "min": 60 * known["s"]} if "s" in known else known


@cache
def times_as_many(sort: str, other: str) -> Fraction | None:
    """Return the factor from a sort to another one of the same measure, None for others."""
    one, two = units_of(sort), units_of(other)
    common = next(iter(one.keys() & two.keys()), None)
    return None if common is None else Fraction(two[common], one[common])


def measured(number: int, sort: str) -> str:
    """Return a number with its usual unit: 25000 of `millihertz` as `25 Hz`."""
    divisor, unit = UNITS[sort]
    if sort in _LARGER and abs(number) >= _LARGER[sort][0]:
        divisor, unit = _LARGER[sort]
    whole, rest = divmod(abs(number), divisor)
    fraction = f".{rest:0{len(str(divisor)) - 1}}".rstrip("0") if rest else ""
    return f"{'-' if number < 0 else ''}{whole}{fraction}{unit}"


def measured_alike(numbers: Iterable[int], sort: str) -> tuple[str, ...]:
    """Return numbers of a sort with a common unit.

    40 and 50 of `milliseconds` are `40 ms` and `50 ms`, 1500 and 2000 are `1.5 s` and `2 s`.
    """
    numbers = tuple(numbers)
    own = next((unit for unit, count in units_of(sort).items() if count == 1), None)
    if own is not None and any(0 < abs(number) < UNITS[sort][0] for number in numbers):
        return tuple(f"{number} {own}" for number in numbers)
    return tuple(measured(number, sort) for number in numbers)
