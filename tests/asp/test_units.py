import re

import pytest

from mars_asp.asp.messages import fill
from mars_asp.asp.units import UNIT, UNITS, WRITTEN, measured


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
    ],
)
def test_numbers_are_written_in_units_of_people(number: int, sort: str, text: str) -> None:
    assert measured(number, sort) == text


def test_holes_of_messages_can_name_a_unit() -> None:
    values = {"L": "100500", "M": "none"}
    said = fill("{L:micrometres} of {M:micrometres}, {L}, {K:micrometres}", values, str)
    assert said == "100.5 mm of none, 100500, {K}"


def test_each_divisor_is_a_power_of_ten() -> None:
    assert all(set(str(divisor)[1:]) <= {"0"} for divisor, _ in UNITS.values())


def test_each_sort_is_written_in_its_own_unit_and_in_larger_ones() -> None:
    assert WRITTEN["milliwatts"] == {"mW": 1, "W": 1000, "kW": 1_000_000}
    assert WRITTEN["seconds"] == {"s": 1, "min": 60}
    assert WRITTEN["centimetres"] == {"cm": 1, "m": 100, "km": 100_000}
    assert WRITTEN["millihertz"] == {"mHz": 1, "Hz": 1000, "kHz": 1_000_000}


def test_no_line_break_parts_a_number_and_a_unit_that_is_shown() -> None:
    shown = {unit.strip() for _, unit in UNITS.values()} - {"a second"}
    assert {unit for unit in shown if not re.fullmatch(UNIT, unit)} == set()
