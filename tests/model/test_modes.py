from decimal import Decimal

import pytest

from mars_asp.model.declarations import DELIVERY_MODES, Mode
from mars_asp.model.modes import parse_mode
from mars_asp.model.ranges import Problem


@pytest.mark.parametrize("name", sorted(DELIVERY_MODES))
def test_each_mode_is_independent(name: str) -> None:
    assert parse_mode(f"  {name} ") == Mode(name, text=name)


def test_the_text_of_a_mode_is_kept_beside_its_value() -> None:
    found = parse_mode("NotifyOnValue( 30 ,0.50 )")
    assert isinstance(found, Mode)
    assert found.arguments == (Decimal(30), Decimal("0.5"))
    assert found.text == "NotifyOnValue( 30 ,0.50 )"


def test_an_argument_can_name_the_measured_quantity() -> None:
    found = parse_mode("NotifyOnMin(300, of=nearest)")
    assert isinstance(found, Mode)
    assert (found.arguments, found.of) == ((Decimal(300),), "nearest")


@pytest.mark.parametrize(
    ("short", "long"),
    [
        ("NotifyOnValue(30)", "NotifyOnValue(30.0, 0)"),
        ("NotifyOnValue(0)", "NotifyOnValue(-0, 0.0)"),
        ("NotifyOnChange", "NotifyOnChange(0)"),
        ("NotifyOnChange(of=x)", "NotifyOnChange(0, of=x)"),
    ],
)
def test_an_omitted_distance_is_zero(short: str, long: str) -> None:
    assert parse_mode(short) == parse_mode(long)


@pytest.mark.parametrize("text", ["NotifyOnMax(0)", "NotifyOnMin(0)", "NotifyOnValue(0)"])
def test_a_limit_of_zero_is_a_limit(text: str) -> None:
    found = parse_mode(text)
    assert isinstance(found, Mode)
    assert found.arguments == (Decimal(0),)


@pytest.mark.parametrize(
    ("text", "offset", "message"),
    [
        ("Notify", 0, "`Notify` is not a delivery mode"),
        ("NotifyOnMin(", 0, "`NotifyOnMin(` is not a delivery mode"),
        ("NotifyOnMin(300, of=a, of=b)", 23, "`of=b` is not an argument of `NotifyOnMin`"),
        ("NotifyOnMin(x)", 12, "`x` is not an argument o"),
        ("RequestWhenReady(1)", 17, "`1` is not an argument of `RequestWhenReady`"),
    ],
)
def test_an_error_in_a_mode_is_reported_at_its_location(
    text: str, offset: int, message: str
) -> None:
    found = parse_mode(text)
    assert isinstance(found, Problem)
    assert (found.begin, found.message[: len(message)]) == (offset, message)
