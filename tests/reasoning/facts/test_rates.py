"""Rates as facts tell them: in the order of the exact ones."""

from fractions import Fraction
from itertools import pairwise

from hypothesis import given
from hypothesis import strategies as st

from mars_asp.model.ranges import MOST
from mars_asp.model.rates import Rate, every
from mars_asp.reasoning.facts.rates import rates_of
from tests.support.strategies import few

periods = st.builds(every, st.integers(1, 60) | st.integers(1, MOST), st.just("ms"))
near = st.sampled_from(["58.8235", "58.8235294117647", "58.824", "0.001", "2147483.647", "0.0001"])
exact = st.integers(1, MOST).map(lambda number: Rate(Fraction(number, 1000)))
rates = st.lists(periods | exact | near.map(lambda text: Rate(Fraction(text))), max_size=30)


@few
@given(rates)
def test_numbers_are_in_the_exact_order_and_stand_for_one_rate_each(stated: list[Rate]) -> None:
    told = rates_of(stated)
    ordered = sorted(set(stated))
    numbers = [told.millihertz(hz) for hz in ordered]
    assert all(low < high for low, high in pairwise(numbers))
    assert all(1 <= number <= MOST for number in numbers)
    assert [told.hertz(number) for number in numbers] == ordered
    rounded = [n for n, hz in zip(numbers, ordered, strict=True) if hz * 1000 != n]
    assert list(told.rounded) == rounded
