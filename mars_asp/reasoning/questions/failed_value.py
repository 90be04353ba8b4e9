"""The value that fails a comparison: `latency_ms` is 40 ms; the rule needs more than 50 ms."""

import re
from collections.abc import Iterator, Mapping, Set
from typing import NamedTuple

import clingo

from mars_asp.asp.messages import shown
from mars_asp.asp.rules.declarations import Declaration
from mars_asp.asp.rules.statements import Literal
from mars_asp.asp.signature import Signature, plain
from mars_asp.asp.trace.tree import NearMiss
from mars_asp.asp.units import UNITS, measured_alike

_COMPARISON = re.compile(r"([^\s{}]+) (<=|>=|!=|<|>|=) ([^\s{}]+)")
#: A bound of an aggregate, as clingo writes it.
_BOUND = re.compile(r"([^\s{}]+) (<=|>=|!=|<|>|=) #(sum|count|min|max)\+? \{ ([^,:; ]+)")
_AGGREGATES = {"sum": "sum", "count": "number", "min": "least", "max": "greatest"}
_NEEDS = {
    ">": "more than {}",
    "<": "less than {}",
    ">=": "{} or more",
    "<=": "{} or less",
    "=": "{}",
    "!=": "a value other than {}",
}
_TURNED = {">": "<", "<": ">", ">=": "<=", "<=": ">=", "=": "=", "!=": "!="}


class _ComparedValue(NamedTuple):
    """One side of a comparison: its value, its name in words, and the sort of the value."""

    value: clingo.Symbol
    name: str | None
    sort: str | None


def failed_value(
    attempt: NearMiss, declared: Mapping[Signature, Declaration], known: Set[str]
) -> str | None:
    """Return a clause with the failing and the needed value of a comparison.

    The result is None if the value has no name. Modules in `known` are not named again.
    """
    sides = _Sides(attempt, declared, known)
    bound = _BOUND.match(attempt.fails or "")
    first: _ComparedValue | None
    if bound is not None and attempt.value is not None:
        first, sign = sides.aggregate(attempt.value, bound), _TURNED[bound[2]]
        second = sides.side(bound[1])
    else:
        match = _COMPARISON.fullmatch(attempt.fails or "")
        if match is None:
            return None
        first, sign, second = sides.side(match[1]), match[2], sides.side(match[3])
    if first is None or second is None:
        return None
    if first.name is None:
        first, sign, second = second, _TURNED[sign], first
    if first.name is None:
        return None
    value, needed = _value_texts(first, second)
    other = f", its {second.name}" if second.name is not None else ""
    return f"{first.name} is {value}; the rule needs {_NEEDS[sign].format(needed)}{other}"


class _Sides:
    """Reads the sides of the comparison that fails in an attempt."""

    def __init__(
        self, attempt: NearMiss, declared: Mapping[Signature, Declaration], known: Set[str]
    ) -> None:
        self._attempt, self._declared, self._known = attempt, declared, known

    def side(self, text: str) -> _ComparedValue | None:
        """Return one side: a constant, a bound variable, or an aggregate; None for another term."""
        value = self._attempt.bindings.get(text)
        if value is None:
            try:
                return _ComparedValue(clingo.parse_term(text), None, None)
            except RuntimeError:
                return None
        for literal, place in self._reading(text):
            sort = self._sort(literal, place)
            name = f"`{plain(literal.signature.name)}`"
            return _ComparedValue(value, f"{name}{self._owner_phrase(literal, place)}", sort)
        assigned = re.search(
            rf"(?<![\w']){re.escape(text)} = #(sum|count|min|max)\+? \{{ ([^,:; ]+)",
            self._attempt.rule.written[1],
        )
        if assigned is None:
            return None
        return _ComparedValue(
            value, f"the {_AGGREGATES[assigned[1]]}", self._unit(assigned[1], assigned[2])
        )

    def aggregate(self, value: clingo.Symbol, bound: re.Match[str]) -> _ComparedValue:
        """Return the value of an aggregate, with its name; `bound` matches the comparison."""
        return _ComparedValue(value, f"the {_AGGREGATES[bound[3]]}", self._unit(bound[3], bound[4]))

    def _unit(self, function: str, term: str) -> str | None:
        found = self._reading(term, everywhere=True) if function != "count" else iter(())
        return next((self._sort(*each) for each in found), None)

    def _reading(self, variable: str, everywhere: bool = False) -> Iterator[tuple[Literal, int]]:
        """Yield literals with the index at which `variable` occurs, first those with a unit.

        They are premises that bind it; if `everywhere`, literals of aggregates as well.
        """
        found = [
            (literal, place)
            for statement in self._attempt.rule.statements[:1]
            for literal in (statement.read if everywhere else statement.body.literals)
            if literal.binds or everywhere
            for place, term in enumerate(literal.terms)
            if term.text == variable
        ]
        return iter(sorted(found, key=lambda each: self._sort(*each) is None))

    def _sort(self, literal: Literal, place: int) -> str | None:
        declared = self._declared.get(literal.signature.unsigned)
        sorts = () if declared is None else declared.arguments[place].sorts
        return next((sort for sort in sorts if sort in UNITS), None)

    def _owner_phrase(self, literal: Literal, place: int) -> str:
        thing = self._attempt.bindings.get(literal.terms[0].text) if place else None
        if thing is None or thing.type != clingo.SymbolType.String or thing.string in self._known:
            return ""
        return f" of `{thing.string}`"


def _value_texts(first: _ComparedValue, second: _ComparedValue) -> tuple[str, ...]:
    sort, values = first.sort or second.sort, (first.value, second.value)
    if sort is not None and all(each.type == clingo.SymbolType.Number for each in values):
        return measured_alike([each.number for each in values], sort)
    return tuple(map(shown, values))
