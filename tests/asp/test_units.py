import pytest

from mars_asp.asp.messages import fill
from mars_asp.asp.units import UNITS, measured


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
    ],
)
def test_numbers_are_written_in_units_of_people(number: int, sort: str, text: str) -> None:
    assert measured(number, sort) == text


def test_holes_of_messages_can_name_a_unit() -> None:
    values = {"L": "100500", "M": "none"}
    said = fill("{L:micrometres} of {M:micrometres}, {L}, {K:micrometres}", values, str)
    assert said == "100.5 mm of none, 100500, {K}"


def test_each_divisor_is_a_power_of_ten() -> None:
    assert all(set(str(divisor)[1:]) == {"0"} for divisor, _ in UNITS.values())
