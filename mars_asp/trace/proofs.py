"""Traces of least height, built from firings."""

from collections.abc import Mapping, Sequence

import clingo

from mars_asp.rulebook import Rule
from mars_asp.source import Span
from mars_asp.term import Term, as_symbol, as_term
from mars_asp.trace.firings import Firing, Terms, least_heights
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
        self._traces: dict[Term, Trace] = {}
        self._absences: dict[Term, Absent] = {}

    def of(self, atom: clingo.Symbol) -> Trace:
        """Return the trace of a true atom, of least height."""
        traces = self._traces
        root = as_term(atom)
        stack: list[tuple[Term, tuple[Terms, Terms] | None]] = [(root, None)]
        while stack:
            head, below = stack.pop()
            firing = self._best.get(head)
            if head in traces:
                continue
            if firing is None:
                traces[head] = self._leaf(as_symbol(head))
            elif below is None:
                below = self._below(firing, self._heights[head])
                stack.append((head, below))
                stack += ((premise, None) for premise in below[0] if premise not in traces)
            else:
                premises, absent = below
                steps = (*(traces[premise] for premise in premises), *map(self._absent, absent))
                rule = self._rules[firing.rule]
                traces[head] = Derived(head, rule, firing.values, steps, rule.is_choice)
        return traces[root]

    def _below(self, firing: Firing, height: int) -> tuple[Terms, Terms]:
        """Return what supports a firing, and what it rests on the absence of.

        Of an aggregate stand here all elements that are reached below the height, so that a
        reader sees everything that counts, and no atom is among its own reasons.
        """
        if not firing.groups:
            return firing.premises, firing.absent
        premises = list(firing.premises)
        absent = list(firing.absent)
        for group in firing.groups:
            inside: list[Term] = []
            lacking: list[Term] = []
            for element in group.elements:
                if all(self._is_below(premise, height) for premise in element.premises):
                    inside += element.premises
                    lacking += element.absent
                    inside += (c for c in element.conditions if self._is_below(c, height))
            premises += sorted(set(inside), key=as_symbol)
            absent += sorted(set(lacking), key=as_symbol)
        return tuple(dict.fromkeys(premises)), tuple(dict.fromkeys(absent))

    def _is_below(self, atom: Term, height: int) -> bool:
        return self._heights.get(atom, 0) < height

    def _absent(self, pattern: Term) -> Absent:
        known = self._absences.get(pattern)
        if known is None:
            atom = as_symbol(pattern)
            is_not = atom.type == clingo.SymbolType.Function and atom.name == "_not"
            text = f"not {atom.arguments[0]}" if is_not else str(atom)
            known = self._absences[pattern] = Absent(text.replace("_any", "_"))
        return known

    def _leaf(self, atom: clingo.Symbol) -> Trace:
        if atom in self._given:
            return Given(str(atom), self._given[atom])
        if self._unsupported:
            return Unexplained(str(atom), f"a rule uses {next(iter(self._unsupported.values()))}")
        return Unexplained(str(atom), "no rule gives it without itself")
