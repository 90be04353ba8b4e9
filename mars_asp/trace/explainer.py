"""Traces of least height, well-founded, read from the firings that were asked for.

Heights are found as Knuth (1977) generalises Dijkstra: an atom has the height of its lowest
firing plus one, and a firing counts only when all its premises have a height, so no atom can
support itself.
"""

from collections.abc import Iterable, Mapping, Sequence, Set
from dataclasses import dataclass

import clingo

from mars_asp.analysis import fill
from mars_asp.rulebook import Rule, Rulebook
from mars_asp.source import Span
from mars_asp.trace.demand import first_arguments, reachable_rules
from mars_asp.trace.rewrite import Rewriter, Signature
from mars_asp.trace.values import Absent, Derived, Given, Trace, Unexplained


@dataclass(frozen=True, slots=True)
class Firing:
    """One use of a rule; `premises` are true atoms, those of its aggregates included."""

    rule: int
    head: clingo.Symbol
    premises: tuple[clingo.Symbol, ...]
    absent: tuple[clingo.Symbol, ...]
    bindings: tuple[clingo.Symbol, ...]


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
        firings = self._read()
        return _proofs(asked, firings, self._given, self._rules, self._rewriter.unsupported)

    def _ask(self, atoms: Sequence[clingo.Symbol]) -> None:
        if not self._question:
            self._copy_open()
        self._question += 1
        firsts = ((a.name, str(a.arguments[0]) if a.arguments else "") for a in atoms)
        numbers = reachable_rules(self._rules, first_arguments(firsts), self._present())
        # A part of its own for each question: it holds only the rules that can matter.
        part = f"_explain{self._question}"
        self._control.add(part, ["k"], self._rewriter.text(self._rules, numbers))
        number = clingo.Number(self._question)
        with self._control.backend() as backend:
            for atom in atoms:
                asked = clingo.Function(f"_ask_{atom.name}", [number, *atom.arguments])
                backend.add_rule([backend.add_atom(asked)])
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
        with self._control.backend() as backend:
            for name, arity in sorted(self._opened):
                for atom in self._control.symbolic_atoms.by_signature(name, arity):
                    if atom.is_fact or atom.symbol in self._taken:
                        copy = clingo.Function(f"_t_{name}", atom.symbol.arguments)
                        backend.add_rule([backend.add_atom(copy)])

    def _read(self) -> dict[clingo.Symbol, list[Firing]]:
        number = clingo.Number(self._question)
        elements: dict[clingo.Symbol, list[clingo.Symbol]] = {}
        absences: dict[clingo.Symbol, list[clingo.Symbol]] = {}
        for atom in self._control.symbolic_atoms.by_signature("_e", 4):
            firing, _, premises, absent = atom.symbol.arguments
            if firing.arguments[0] == number:
                elements.setdefault(firing, []).extend(premises.arguments)
                absences.setdefault(firing, []).extend(absent.arguments)
        firings: dict[clingo.Symbol, list[Firing]] = {}
        for atom in self._control.symbolic_atoms.by_signature("_s", 6):
            symbol = atom.symbol
            question, rule, head, premises, absent, bindings = symbol.arguments
            if question != number:
                continue
            more = sorted(set(elements.get(symbol, ())))
            firings.setdefault(head, []).append(
                Firing(
                    rule.number,
                    head,
                    tuple(dict.fromkeys((*premises.arguments, *more))),
                    tuple(dict.fromkeys((*absent.arguments, *absences.get(symbol, ())))),
                    tuple(bindings.arguments),
                )
            )
        return firings


def _proofs(
    asked: Iterable[clingo.Symbol],
    firings: Mapping[clingo.Symbol, Sequence[Firing]],
    given: Mapping[clingo.Symbol, Span],
    rules: Sequence[Rule],
    unsupported: Mapping[int, str],
) -> dict[clingo.Symbol, Trace]:
    best = _lowest(firings, given)
    traces: dict[clingo.Symbol, Trace] = {}
    wanted = list(asked)
    for root in wanted:
        stack = [root]
        while stack:
            atom = stack[-1]
            if atom in traces:
                stack.pop()
                continue
            if atom in given or atom not in best:
                traces[atom] = _leaf(atom, given, unsupported)
                stack.pop()
                continue
            firing = best[atom]
            missing = [premise for premise in firing.premises if premise not in traces]
            if missing:
                stack += missing
                continue
            traces[atom] = _derived(firing, traces, rules[firing.rule])
            stack.pop()
    return {atom: traces[atom] for atom in wanted}


def _leaf(
    atom: clingo.Symbol, given: Mapping[clingo.Symbol, Span], unsupported: Mapping[int, str]
) -> Trace:
    if atom in given:
        return Given(str(atom), given[atom])
    if unsupported:
        return Unexplained(str(atom), f"a rule uses {next(iter(unsupported.values()))}")
    return Given(str(atom), None)


def _derived(firing: Firing, traces: Mapping[clingo.Symbol, Trace], rule: Rule) -> Derived:
    bindings = {pair.arguments[0].string: pair.arguments[1] for pair in firing.bindings}
    premises = [traces[premise] for premise in firing.premises]
    absent = [Absent(str(atom).replace("_any", "_")) for atom in firing.absent]
    return Derived(
        str(firing.head),
        rule,
        fill(rule.because, bindings),
        bindings,
        (*premises, *absent),
        rule.is_choice,
    )


def _lowest(
    firings: Mapping[clingo.Symbol, Sequence[Firing]], given: Mapping[clingo.Symbol, Span]
) -> dict[clingo.Symbol, Firing]:
    """Return for each atom its firing of least height, ties by rule and then by bindings."""
    waiting: dict[int, int] = {}
    users: dict[clingo.Symbol, list[int]] = {}
    every = [firing for group in firings.values() for firing in group]
    level: list[int] = []
    for index, firing in enumerate(every):
        open_premises = {p for p in firing.premises if p not in given and p in firings}
        waiting[index] = len(open_premises)
        for premise in open_premises:
            users.setdefault(premise, []).append(index)
        if not open_premises:
            level.append(index)
    best: dict[clingo.Symbol, Firing] = {}
    while level:
        reached: dict[clingo.Symbol, Firing] = {}
        for index in level:
            firing = every[index]
            if firing.head in best:
                continue
            rival = reached.get(firing.head)
            if rival is None or _order(firing) < _order(rival):
                reached[firing.head] = firing
        best |= reached
        level = []
        for atom in reached:
            for index in users.get(atom, ()):
                waiting[index] -= 1
                if not waiting[index]:
                    level.append(index)
    return best


def _order(firing: Firing) -> tuple[int, tuple[clingo.Symbol, ...]]:
    return firing.rule, firing.bindings
