"""Traces of minimal height, built from firings."""

from collections.abc import Iterable, Mapping, Sequence
from functools import cache, partial

import clingo

from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.solve.term_ids import TermId, as_term, text
from mars_asp.asp.trace.counted import CountedBelow, CountedWithout, Support, support
from mars_asp.asp.trace.dominators import Needs
from mars_asp.asp.trace.firings import Firing, firing_order
from mars_asp.asp.trace.given import GivenFacts, is_cited
from mars_asp.asp.trace.heights import least_heights
from mars_asp.asp.trace.tree import Absent, Derived, Trace, Unexplained


class Proofs:
    """Traces over one set of firings; common steps are one object."""

    def __init__(
        self,
        firings: Iterable[Firing],
        given: GivenFacts,
        rules: Sequence[Rule],
        unsupported: Mapping[int, str],
        every: bool = False,
    ) -> None:
        """Compute the minimal heights; with `every`, traces get their other derivations.

        `unsupported` are the constructs of rules that cannot be traced.
        """
        self._given = given
        self._rules = rules
        self._unsupported = unsupported

        @cache
        def may_be_given(rule: int) -> bool:
            return any(head.name in given.predicates for head in rules[rule].heads)

        # A fact of the input needs no reasons, even if rules derive it as well.
        firings = [f for f in firings if not (may_be_given(f.rule) and given.leaf(f.head))]
        self._best, heights = least_heights(firings)
        self._counted = CountedBelow(heights)
        self._traces: dict[TermId, Trace | None] = {}
        self._absences: dict[TermId, Absent | None] = {}
        self._needs = Needs(firings, heights) if every else None
        del firings
        self._heights = heights
        #: The other derivations of each derived atom; filled after all traces are made, because
        #: they can contain each other.
        self._others: dict[TermId, list[Derived]] = {atom: [] for atom in self._best if every}
        self._filled: set[TermId] = set()
        # In order of height, so that the premises of an atom have their traces already.
        for atom, height in heights.items():
            # There are many firings; only other derivations are compared with them again.
            firing = self._best[atom] if every else self._best.pop(atom)
            below: Support = firing.premises, firing.absent
            if firing.groups:
                below = support(firing, partial(self._counted.of, height))
            self._traces[atom] = self._derived_step(firing, below, self._others.get(atom, ()))

    def of(self, atom: clingo.Symbol) -> Trace:
        """Return the trace of a true atom, of minimal height."""
        root = as_term(atom)
        trace = self._least(root) or self._leaf(root)
        if self._needs is not None:
            self._add_others(root, self._needs)
        return trace

    def _least(self, atom: TermId) -> Trace | None:
        """Return the minimal trace of an atom, or None if its predicate is `cited: never`."""
        if atom not in self._traces:
            leaf = self._leaf(atom)
            self._traces[atom] = leaf if is_cited(leaf) else None
        return self._traces[atom]

    def _add_others(self, root: TermId, needs: Needs) -> None:
        """Add the other derivations of an atom and of all atoms in its derivations.

        Firings of one rule with equal values and equal premises are one derivation.
        """
        waiting = [root]
        while waiting:
            atom = waiting.pop()
            if atom in self._filled or atom not in self._best:
                continue
            self._filled.add(atom)
            best = self._best[atom]
            below = support(best, partial(self._counted.of, self._heights[atom]))
            waiting += below[0]
            entries = {_derivation(best, below)}
            counted = CountedWithout(partial(needs.holds_without, atom))
            alike: set[tuple[object, ...]] = set()
            for firing in sorted(needs.firings_of(atom), key=firing_order):
                if firing is best:
                    continue
                own = _beside_groups(firing, counted)
                if own in alike:
                    continue
                alike.add(own)
                below = support(firing, counted.of)
                if _derivation(firing, below) in entries:
                    continue
                entries.add(_derivation(firing, below))
                waiting += below[0]
                self._others[atom].append(self._derived_step(firing, below))

    def _derived_step(
        self, firing: Firing, below: Support, others: Sequence[Derived] = ()
    ) -> Derived:
        premises, absent = below
        found: list[Trace | None] = [*map(self._least, premises), *map(self._absent, absent)]
        steps: tuple[Trace, ...] = tuple(filter(None, found))
        rule = self._rules[firing.rule]
        return Derived(firing.head, rule, firing.values, steps, rule.is_choice, others)

    def _absent(self, pattern: TermId) -> Absent | None:
        """Return the absence of a pattern, or None if its predicate is `cited: never`."""
        if pattern not in self._absences:
            atom = text(pattern).replace("_any", "_")
            self._absences[pattern] = (
                Absent(f"not {atom.removeprefix('_not(').removesuffix(')')}")
                if atom.startswith("_not(")
                else self._given.absence(pattern, atom)
            )
        return self._absences[pattern]

    def _leaf(self, atom: TermId) -> Trace:
        given = self._given.leaf(atom)
        if given is not None:
            return given
        if self._unsupported:
            return Unexplained(text(atom), f"a rule uses {next(iter(self._unsupported.values()))}")
        return Unexplained(text(atom), "no rule gives it without itself")


def _beside_groups(firing: Firing, counted: CountedWithout) -> tuple[object, ...]:
    """Return a key of a firing in which the premises of groups are ignored."""
    held, lacking = counted.of_all(firing.groups)
    own = frozenset(firing.premises) - held, frozenset(firing.absent) - lacking
    return firing.rule, firing.values, firing.groups, *own


def _derivation(firing: Firing, below: Support) -> tuple[object, ...]:
    """Return a key that distinguishes the derivations of one atom."""
    return firing.rule, firing.values, *map(frozenset, below)
