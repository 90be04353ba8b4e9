"""Rates in facts have the order of the exact rates."""

import random
from fractions import Fraction
from itertools import pairwise

from hypothesis import given
from hypothesis import strategies as st

from mars_asp.language.parse import parse_text
from mars_asp.model.ranges import MOST
from mars_asp.model.rates import Rate, every
from mars_asp.reasoning.analysis import analyse
from mars_asp.reasoning.facts.rates import rates_of
from mars_asp.reasoning.project import Project, project_facts
from mars_asp.reasoning.rules import load_rulebook
from tests.support.strategies import few

periods = st.builds(every, st.integers(1, 60) | st.integers(1, MOST), st.just("ms"))
near = st.sampled_from(["58.8235", "58.8235294117647", "58.824", "0.001", "2147483.647", "0.0001"])
exact = st.integers(1, MOST).map(lambda number: Rate(Fraction(number, 1000)))
rates = st.lists(periods | exact | near.map(lambda text: Rate(Fraction(text))), max_size=30)


@few
@given(rates)
def test_numbers_are_in_the_exact_order_and_represent_one_rate_each(rates: list[Rate]) -> None:
    result = rates_of(rates)
    ordered = sorted(set(rates))
    numbers = [result.millihertz(hz) for hz in ordered]
    assert all(low < high for low, high in pairwise(numbers))
    assert all(1 <= number <= MOST for number in numbers)
    assert [result.hertz(number) for number in numbers] == ordered
    rounded = [n for n, hz in zip(numbers, ordered, strict=True) if hz * 1000 != n]
    assert list(result.rounded) == rounded


@few
@given(rates)
def test_a_number_has_the_text_of_its_rate(rates: list[Rate]) -> None:
    result, other = rates_of(rates), rates_of(reversed(rates))
    for hz in rates:
        shown = result.written(result.millihertz(hz))
        texts = [each.written for each in rates if each == hz]
        assert shown == hz
        assert shown.written == min(texts) == other.written(other.millihertz(hz)).written


def test_holds_are_compared_with_exact_periods() -> None:
    """A hold is short if it is less than the time between two messages, whatever their sizes."""
    rng = random.Random(36)
    lines, blocks, short = [], [], set()
    for number in range(300):
        written = rng.choice(
            [
                f"every {rng.randint(1, rng.choice([20, 3000, MOST]))} ms",
                f"every {rng.randint(1, rng.choice([20, MOST // 1000]))} s",
                f"{rng.randint(1, 10 ** rng.randint(1, 12)) / 10**6:.6f}",
            ]
        )
        first, *rest = written.split()
        hz = Fraction(first) if not rest else every(int(rest[0]), rest[1])
        near = int(1000 / hz) + rng.randint(-1, 2)
        hold = min(max(rng.choice([near, rng.randint(1, MOST)]), 1), MOST)
        if hold < 1000 / hz:
            short.add(f"M{number}")
        lines.append(f"M{number} is_controlled_by C{number} 1 hold {hold}")
        lines.append(f"M{number} is_controlled_by Other")
        sense = f"@DataOut NotifyAtFrequency {written}\nImg f();"
        blocks.append(f"@module_start\n@module_name C{number}\n{sense}\n@module_end")
    names = ", ".join(["Other", *(f"M{n}, C{n}" for n in range(300))])
    text = "\n".join(["@configuration hierarchical", f"@modules {names}", *lines, *blocks, ""])
    parsed = parse_text(text, "robot.mars")
    assert parsed.configuration is not None
    facts = project_facts(Project(parsed.configuration, {}, ()))
    analysis = analyse(facts, load_rulebook(), parsed.configuration.span)
    found = {c.subject for c in analysis.consequences if c.kind == "short_hold"}
    assert found == short
    assert 50 < len(found) < 250
