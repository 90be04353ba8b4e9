"""Traces of least height, well-founded, built from the firings that were asked for."""

from collections.abc import Iterable, Mapping, Sequence, Set

import clingo

from mars_asp.rulebook import Rule, Rulebook
from mars_asp.source import Span
from mars_asp.trace.absence import absence, believed, nearness
from mars_asp.trace.demand import first_arguments, reachable_rules
from mars_asp.trace.firings import Firing, read_firings
from mars_asp.trace.near import Candidate, NearMisses
from mars_asp.trace.pattern import can_be_followed, fixed_parts
from mars_asp.trace.proofs import Proofs
from mars_asp.trace.rewrite import Rewriter, Signature, asking_name
from mars_asp.trace.values import Absent, Missing, Trace


class Explainer:
    """Answers questions about one grounding and one answer set."""

    def __init__(
        self,
        rulebook: Rulebook,
        control: clingo.Control,
        given: Mapping[clingo.Symbol, Span],
        taken: Set[clingo.Symbol] = frozenset(),
        opened: Set[Signature] = frozenset(),
    ) -> None:
        """Prepare for questions.

        `control` holds the grounded rules of `rulebook`; `given` are the facts of the input;
        `taken` the true atoms that are no facts of the grounding and `opened` their predicates,
        of which all true atoms are looked up among the facts and `taken`.
        """
        self._rules: Sequence[Rule] = rulebook.rules
        self._control = control
        self._given = given
        self._taken = taken
        self._opened = opened
        self._rewriter = Rewriter(opened)
        self._question = 0

    def why(self, atoms: Iterable[clingo.Symbol]) -> dict[clingo.Symbol, Trace]:
        """Return the trace of each atom that is true.

        One grounding finds all firings behind the atoms; traces share what they have in common.
        """
        asked = tuple(atoms)
        self._ask(asked)
        firings = read_firings(self._control, self._question)
        proofs = Proofs(firings, self._given, self._rules, self._rewriter.unsupported)
        return {atom: proofs.of(atom) for atom in asked}

    def why_not(self, pattern: clingo.Symbol, depth: int) -> Missing | Absent:
        """Return what keeps an atom from holding; holes of the pattern are any value.

        Each level below is one more grounding; at most `depth` of them.
        """
        near = NearMisses(self._rewriter)
        found: dict[clingo.Symbol, list[tuple[Candidate, Firing]]] = {}
        pending = [pattern]
        for _ in range(depth):
            if not pending:
                break
            attempts = self._come_near(pending, near)
            found |= attempts
            lacking = (f.lacks.arguments[1] for a in attempts.values() for _, f in a if f.lacks)
            parts = dict.fromkeys(lack.arguments[0] for lack in lacking if lack.name == "no")
            pending = [part for part in parts if part not in found and can_be_followed(part)]
        true = {atom for a in found.values() for _, firing in a for atom in believed(firing)}
        return absence(pattern, found, self._rules, self.why(sorted(true)))

    def _come_near(
        self, patterns: Sequence[clingo.Symbol], near: NearMisses
    ) -> dict[clingo.Symbol, list[tuple[Candidate, Firing]]]:
        """Return for each pattern, rule by rule, the candidate that comes nearest."""
        lines = []
        asked = []
        for index, pattern in enumerate(patterns):
            kind = (pattern.name, len(pattern.arguments))
            parts = clingo.Function("w", fixed_parts(pattern))
            asked.append(("_near", [clingo.Number(index), parts]))
            for number, rule in enumerate(self._rules):
                if kind in rule.heads:
                    lines.append(near.text(rule, number, pattern, index))
        self._ground("\n".join(lines), asked)
        best: dict[tuple[int, int], tuple[Candidate, Firing]] = {}
        for firing in read_firings(self._control, self._question):
            candidate = near.candidates[firing.rule]
            key = (candidate.pattern, candidate.rule)
            if key not in best or nearness(candidate, firing) < nearness(*best[key]):
                best[key] = (candidate, firing)
        found: dict[clingo.Symbol, list[tuple[Candidate, Firing]]] = {p: [] for p in patterns}
        for (index, _), attempt in sorted(best.items(), key=lambda item: item[0]):
            found[patterns[index]].append(attempt)
        return found

    def _ask(self, atoms: Sequence[clingo.Symbol]) -> None:
        self._copy_open()
        firsts = ((a.name, str(a.arguments[0]) if a.arguments else "") for a in atoms)
        numbers = reachable_rules(self._rules, first_arguments(firsts), self._present())
        asked = [
            (asking_name(f"{'' if atom.positive else '-'}{atom.name}"), atom.arguments)
            for atom in atoms
        ]
        self._ground(self._rewriter.text(self._rules, numbers), asked)

    def _ground(self, text: str, asked: Iterable[tuple[str, Sequence[clingo.Symbol]]]) -> None:
        """Ground explanation rules as a part of their own, so that only they can matter."""
        self._copy_open()
        self._question += 1
        part = f"_explain{self._question}"
        number = clingo.Number(self._question)
        self._control.add(part, ["k"], text)
        with self._control.backend() as backend:
            for name, arguments in asked:
                fact = clingo.Function(name, [number, *arguments])
                backend.add_rule([backend.add_atom(fact)])
        self._control.ground([(part, [number])])

    def _present(self) -> frozenset[str]:
        """Return the names of the predicates that have a true atom."""
        atoms = self._control.symbolic_atoms
        copied = {(f"_t_{name}", arity): name for name, arity in self._opened}
        found = set()
        for name, arity, positive in atoms.signatures:
            if (name, arity) not in self._opened and any(
                True for _ in atoms.by_signature(name, arity, positive)
            ):
                found.add(copied.get((name, arity), name))
        return frozenset(found)

    def _copy_open(self) -> None:
        if self._question:
            return
        atoms = self._control.symbolic_atoms
        with self._control.backend() as backend:
            for name, arity in sorted(self._opened):
                for positive in (True, False):
                    for atom in atoms.by_signature(name, arity, positive):
                        if atom.is_fact or atom.symbol in self._taken:
                            copy = clingo.Function(f"_t_{name}", atom.symbol.arguments, positive)
                            backend.add_rule([backend.add_atom(copy)])
