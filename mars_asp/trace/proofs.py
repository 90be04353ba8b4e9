"""Traces of least height, built from firings."""

from collections.abc import Mapping, Sequence

import clingo

from mars_asp.analysis import fill
from mars_asp.rulebook import Rule
from mars_asp.source import Span
from mars_asp.trace.firings import Atoms, Firing, least_heights
from mars_asp.trace.values import Absent, Derived, Given, Trace, Unexplained


class Proofs:
    """Traces over one set of firings; what they share is one object."""

    def __init__(
        self,
        firings: Sequence[Firing],
        given: Mapping[clingo.Symbol, Span],
        rules: Sequence[Rule],
        unsupported: Mapping[int, str],
    ) -> None:
        """Find the least heights."""
        self._given = given
        self._rules = rules
        self._unsupported = unsupported
        self._best, self._heights = least_heights(firings, given)
        self._traces: dict[clingo.Symbol, Trace] = {}

    def of(self, root: clingo.Symbol) -> Trace:
        """Return the trace of a true atom, of least height."""
        traces = self._traces
        stack = [root]
        while stack:
            atom = stack[-1]
            if atom in traces:
                stack.pop()
                continue
            if atom not in self._best:
                traces[atom] = self._leaf(atom)
                stack.pop()
                continue
            firing = self._best[atom]
            premises, absent = self._below(firing, self._heights[atom])
            missing = [premise for premise in premises if premise not in traces]
            if missing:
                stack += missing
                continue
            below = (*(traces[premise] for premise in premises), *map(_absent, absent))
            traces[atom] = self._step(firing, below)
            stack.pop()
        return traces[root]

    def _step(self, firing: Firing, premises: tuple[Trace, ...]) -> Derived:
        rule = self._rules[firing.rule]
        bindings = bindings_of(firing)
        message = fill(rule.because, bindings)
        return Derived(str(firing.head), rule, message, bindings, premises, rule.is_choice)

    def _below(self, firing: Firing, height: int) -> tuple[Atoms, Atoms]:
        """Return what supports a firing, and what it rests on the absence of.

        Of an aggregate stand here all elements that are reached below the height, so that a
        reader sees everything that counts, and no atom is among its own reasons.
        """
        premises = list(firing.premises)
        absent = list(firing.absent)
        for group in firing.groups:
            inside: list[clingo.Symbol] = []
            for element in group.elements:
                if all(self._is_below(premise, height) for premise in element.premises):
                    inside += element.premises
                    absent += element.absent
                    inside += (c for c in element.conditions if self._is_below(c, height))
            premises += sorted(set(inside))
        return tuple(dict.fromkeys(premises)), tuple(dict.fromkeys(absent))

    def _is_below(self, atom: clingo.Symbol, height: int) -> bool:
        return self._heights.get(atom, 0) < height

    def _leaf(self, atom: clingo.Symbol) -> Trace:
        if atom in self._given:
            return Given(str(atom), self._given[atom])
        if self._unsupported:
            return Unexplained(str(atom), f"a rule uses {next(iter(self._unsupported.values()))}")
        return Unexplained(str(atom), "no rule gives it without itself")


def bindings_of(firing: Firing) -> dict[str, clingo.Symbol]:
    """Return the values of a firing's variables."""
    return {pair.arguments[0].string: pair.arguments[1] for pair in firing.bindings}


def _absent(atom: clingo.Symbol) -> Absent:
    if atom.type == clingo.SymbolType.Function and atom.name == "_not":
        return Absent(f"not {atom.arguments[0]}".replace("_any", "_"))
    return Absent(str(atom).replace("_any", "_"))
