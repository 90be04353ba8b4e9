import re
from collections import Counter

import pytest

from mars_asp.asp.messages import fill
from mars_asp.asp.units import OF_UNITS, UNIT, UNITS, measured, times_as_many, units_of


@pytest.mark.parametrize(
    ("number", "sort", "text"),
    [
        (25_000, "millihertz", "25 Hz"),
        (12_500, "millihertz", "12.5 Hz"),
        (1, "millihertz", "0.001 Hz"),
        (0, "milliseconds", "0 s"),
        (500, "milliseconds", "0.5 s"),
        (350_000, "micrometres", "350 mm"),
        (-380_789, "micrometres", "-380.789 mm"),
        (350, "micrometres", "0.35 mm"),
        (999_999, "micrometres", "999.999 mm"),
        (2_999_900, "micrometres", "2.9999 m"),
        (2_147_483_647, "micrometres", "2147.483647 m"),
        (2_147_483_647, "milliseconds", "2147483.647 s"),
        (1000, "thousandths", "100 %"),
        (125_000, "millionths", "12.5 %"),
        (5, "thousandths", "0.5 %"),
        (90, "seconds", "90 s"),
        (-1_500, "milliwatts", "-1.5 W"),
        (3, "kilowatts", "3 kW"),
        (250, "centimetres", "2.5 m"),
        (2, "megawatts", "2 MW"),
        (1500, "nanoseconds", "1.5 us"),
        (250, "millimetres_per_second", "0.25 m/s"),
        (90, "degrees_per_second", "90 deg/s"),
        (3, "megabytes_per_second", "3 MB/s"),
    ],
)
def test_numbers_are_written_in_units_of_people(number: int, sort: str, text: str) -> None:
    assert measured(number, sort) == text


def test_holes_of_messages_can_name_a_unit() -> None:
    values = {"L": "100500", "M": "none"}
    result = fill("{L:micrometres} of {M:micrometres}, {L}, {K:micrometres}", values, str)
    assert result == "100.5 mm of none, 100500, {K}"


def test_each_divisor_is_a_power_of_ten() -> None:
    assert all(set(str(divisor)[1:]) <= {"0"} for divisor, _ in UNITS.values())


def test_each_sort_is_written_in_its_own_unit_and_in_larger_ones() -> None:
    known = {
        "milliwatts": {"mW": 1, "W": 1000, "kW": 1_000_000, "MW": 10**9},
        "seconds": {"s": 1, "min": 60, "das": 10},
        "centimetres": {"cm": 1, "dm": 10, "m": 100, "km": 100_000},
        "micrometres_per_second": {"um/s": 1, "mm/s": 1000, "m/s": 1_000_000},
        "bytes": {"B": 1, "QB": 10**30},
    }
    for sort, units in known.items():
        assert units_of(sort).items() >= units.items()
    assert "nW" not in units_of("milliwatts") and "mB" not in units_of("bytes")


def test_each_measure_has_all_prefixes_and_no_two_sorts_one_unit() -> None:
    own = [(u, s) for s in UNITS for u, n in units_of(s).items() if n == 1]
    units = Counter(unit for unit, sort in own if sort != "instant")
    assert [unit for unit, count in units.items() if count > 1] == []
    signs = [*"qryzafpnumcd", "", "da", *"hkMGTPEZYRQ"]
    for unit in ("s", "Hz", "m", "g", "N", "W", "Wh", "J", "V", "A", "Ah", "deg", "m/s", "deg/s"):
        assert {f"{sign}{unit}" for sign in signs} <= units.keys()
    assert OF_UNITS["MW"] == "megawatts" and OF_UNITS["mw"] == "milliwatts"
    assert times_as_many("kilometres", "millimetres") == 1_000_000
    assert times_as_many("metres", "metres_per_second") is None


def test_no_line_break_parts_a_number_and_a_unit_that_is_shown() -> None:
    shown = {unit.strip() for _, unit in UNITS.values()} - {"a second", "as"}
    assert {unit for unit in shown if not re.fullmatch(UNIT, unit)} == set()
