"""Exact rates as the whole millihertz that rules compare.

A rate of a fraction of a millihertz is rounded, and moved further if another rate of the
configuration would get the same number. Thus the numbers have the exact order of the rates, and
only equal rates get equal numbers.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass, field
from decimal import Decimal
from fractions import Fraction
from math import ceil

from mars_asp.asp.solve.atoms import Fact, fact_at
from mars_asp.model.declarations import Configuration, Data, Module, Service
from mars_asp.model.ranges import MOST
from mars_asp.model.rates import Rate, as_written
from mars_asp.model.remembered import remembered
from mars_asp.reasoning.facts.ends import Ends


@dataclass(frozen=True)
class Rates:
    """The integers that represent rates in facts: rounded millihertz.

    Different rates have different numbers.
    """

    _numbers: Mapping[Fraction, int]
    _meant: Mapping[int, Fraction]
    #: The numbers of all rates in facts.
    _taken: Set[int]
    #: The rates as they are written; of several texts the first one in the order of texts.
    _written: Mapping[int, Rate] = field(default_factory=dict)

    @property
    def rounded(self) -> Sequence[int]:
        """Return the numbers that differ from the millihertz of their rates, in order."""
        return sorted(self._meant)

    def millihertz(self, hz: Fraction) -> int:
        """Return the number that represents a rate in facts, close to its millihertz."""
        result = self._numbers.get(hz)
        if result is not None:
            return result
        millihertz = hz * 1000
        number = max(round(millihertz), 1)
        if number == millihertz and number not in self._meant:
            return number
        # An unknown rate gets an unused number, on its own side of the nearest known rate.
        step = 1 if self.hertz(number) < hz else -1
        while number in self._taken and 1 < number < MOST:
            number += step
        return number

    def hertz(self, millihertz: int) -> Rate:
        """Return the rate that a number in facts represents."""
        meant = self._meant.get(millihertz)
        if meant is None:
            return Rate(Decimal(millihertz) / 1000)
        return meant if isinstance(meant, Rate) else Rate(meant)

    def written(self, millihertz: int) -> Rate:
        """Return the rate that a number in facts represents, as the user writes it."""
        return self._written.get(millihertz) or self.hertz(millihertz)


@remembered
def rates_in(configuration: Configuration, described: Mapping[str, Module]) -> Rates:
    """Return the numbers of the rates that lines and annotations state."""
    return rates_of(_written_rates(configuration, described))


def rates_of(rates: Iterable[Fraction]) -> Rates:
    """Return distinct numbers of rates that are compared with each other, in the same order."""
    every: dict[Fraction, Fraction] = {}
    texts: dict[Fraction, Rate] = {}
    for hz in rates:
        every[hz] = hz
        if isinstance(hz, Rate):
            texts[hz] = min(texts.get(hz, hz), hz, key=as_written)
    if all((hz * 1000).denominator == 1 for hz in every):
        numbered = {hz: int(hz * 1000) for hz in every}
        written = {numbered[hz]: rate for hz, rate in texts.items()}
        return Rates({}, {}, {*numbered.values()}, written)
    ordered = sorted(every)
    numbers: list[int] = []
    for hz in ordered:
        numbers.append(max(round(hz * 1000), numbers[-1] + 1 if numbers else 1))
        # Numbers beyond the maximum move down again.
    for place, number in enumerate(numbers):
        numbers[place] = min(number, MOST - (len(numbers) - 1 - place))
    moved = {hz: number for hz, number in zip(ordered, numbers, strict=True) if hz * 1000 != number}
    meant = {number: every[hz] for hz, number in moved.items()}
    written = {
        number: texts[hz] for hz, number in zip(ordered, numbers, strict=True) if hz in texts
    }
    return Rates(moved, meant, frozenset(numbers), written)


def _written_rates(
    configuration: Configuration, described: Mapping[str, Module]
) -> Iterator[Fraction]:
    for relationship in configuration.relationships:
        if isinstance(relationship, Data) and relationship.hz is not None:
            yield relationship.hz
    for module in described.values():
        for service in module.services:
            if service.hz is not None:
                yield service.hz


def rounded_rates(
    configuration: Configuration, ends: Ends, services: Mapping[str, Service], rates: Rates
) -> Iterator[Fact]:
    """Yield the facts about rounded rates, with the comparisons that need the exact rates.

    `services` are the delivering services of outputs, by the names of the outputs.
    """
    for rate in rates.rounded:
        yield fact_at(configuration.span, "rounded", rate)
        below = min(ceil(1000 / rates.hertz(rate)) - 1, MOST)
        yield fact_at(configuration.span, "below_period", rate, below)
    if not rates.rounded:
        return
    entries: set[tuple[int, int]] = set()
    for line in configuration.relationships:
        if not isinstance(line, Data) or line.hz is None:
            continue
        service = services.get(ends.source(line))
        hz = None if service is None else service.hz
        if hz is None or (hz / line.hz).denominator != 1:
            continue
        pair = rates.millihertz(hz), rates.millihertz(line.hz)
        if pair not in entries:
            entries.add(pair)
            yield fact_at(line.span, "multiple", *pair)
