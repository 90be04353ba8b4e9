"""Ground rules and facts with clingo, and find the least resolution, component by component."""

import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass

import clingo

from mars_asp.diagnostic import Diagnostic, MarsError
from mars_asp.ground_program import Component, Recorder, partition
from mars_asp.optimum import Optimum, UnsatisfiableError, least_with, optimise
from mars_asp.source import point

_OPTIONS = ("--seed=1", "--stats=0", "--warn=no-atom-undefined")
_MOST_MESSAGES = 10_000


@dataclass(frozen=True, slots=True)
class Resolution:
    """The least answer of the resolution rules.

    `taken` are the true atoms that are no facts; `cost` and `bound` map the levels of the
    minimisation to values; `count` is how many optima there are, `None` where nobody counted.
    """

    taken: frozenset[clingo.Symbol]
    cost: dict[int, int]
    bound: dict[int, int]
    proven: bool
    count: int | None


@dataclass(frozen=True, slots=True)
class Part:
    """A component, the symbols of its atoms (`None` for clingo's own) from 1, and its optimum."""

    component: Component
    symbols: tuple[clingo.Symbol | None, ...]
    best: Optimum


class Grounding:
    """One clingo control with the consequences as facts, then the resolution rules."""

    def __init__(self, base: str, facts: str) -> None:
        """Ground the rules of the consequences over facts.

        Raises:
            MarsError: clingo refuses a rule, or the rules leave a choice.
        """
        self._messages: list[tuple[clingo.MessageCode, str]] = []
        #: The components that were solved, and where each open atom stands: part and number.
        self.parts: list[Part] = []
        self._places: dict[clingo.Symbol, tuple[int, int]] = {}
        self.control = clingo.Control(_OPTIONS, self._note, _MOST_MESSAGES)
        self._add("base", f"{base}\n{facts}")

    def _note(self, code: clingo.MessageCode, message: str) -> None:
        self._messages.append((code, message))

    def _add(self, part: str, text: str) -> None:
        try:
            self.control.add(part, [], text)
            self.control.ground([(part, [])])
        except RuntimeError as error:
            raise self._refused(str(error)) from None
        worst = clingo.MessageCode.OperationUndefined
        if any(code == worst for code, _ in self._messages):
            raise self._refused("an operation is undefined")

    def _refused(self, reason: str) -> MarsError:
        details = "; ".join(message.strip() for _, message in self._messages[:5]) or reason
        return MarsError(
            (
                Diagnostic(
                    "rules-refused",
                    "error",
                    f"clingo refuses the rules: {details}",
                    point("rules", 1, 1),
                    help="run `mars-asp rules lint` on your rule files",
                ),
            )
        )

    def symbols(self, name: str, arity: int) -> Iterable[clingo.Symbol]:
        """Yield the atoms of a predicate that are grounded, facts or not."""
        return (atom.symbol for atom in self.control.symbolic_atoms.by_signature(name, arity))

    def atoms(self, name: str, arity: int) -> Iterable[tuple[clingo.Symbol, bool]]:
        """Yield the atoms of a predicate and whether each is a fact."""
        found = self.control.symbolic_atoms.by_signature(name, arity)
        return ((atom.symbol, atom.is_fact) for atom in found)

    def resolve(
        self,
        rules: str,
        deadline: float | None = None,
        progress: Callable[[int, int], None] | None = None,
    ) -> Resolution:
        """Ground the resolution rules and find their least answer.

        `deadline` is a time of `time.monotonic`; `progress` is told components done and in all.

        Raises:
            MarsError: the rules are refused, or have no answer.
            TimeoutError: the deadline passed before every component had an answer.
        """
        recorder = Recorder()
        self.control.register_observer(recorder)
        self._add("resolve", rules)
        names = {
            atom.literal: atom.symbol
            for atom in self.control.symbolic_atoms
            if not atom.is_fact and atom.literal not in recorder.facts
        }
        last = (1, "")
        keys = {literal: (0, str(symbol)) for literal, symbol in names.items()}
        parts = partition(recorder, lambda atom: keys.get(atom, last))
        taken = {names[atom] for atom in parts.facts if atom in names}
        cost = dict(parts.constant)
        bound = dict(parts.constant)
        count: int | None = 1
        proven = True
        known: dict[Component, Optimum] = {}
        for done, (component, atoms) in enumerate(parts.components):
            if progress is not None:
                progress(done, len(parts.components))
            # Equal components have equal optima, so each is solved once.
            best = known.get(component)
            if best is None:
                best = known[component] = self._optimise(component, deadline)
            symbols = tuple(names.get(atom) for atom in atoms)
            for number, symbol in enumerate(symbols, 1):
                if symbol is not None:
                    self._places[symbol] = (len(self.parts), number)
            self.parts.append(Part(component, symbols, best))
            taken.update(s for n in best.true if (s := symbols[n - 1]) is not None)
            for level, value in best.cost.items():
                cost[level] = cost.get(level, 0) + value
                bound[level] = bound.get(level, 0) + best.bound[level]
            proven = proven and best.proven
            count = None if count is None or best.count is None else count * best.count
        return Resolution(frozenset(taken), cost, bound, proven, count)

    def extra_cost(
        self, atom: clingo.Symbol, deadline: float | None = None
    ) -> dict[int, int] | None:
        """Return what the cheapest answer with an atom costs more, level by level.

        `None` where no answer has it. To be asked after `resolve`.

        Raises:
            TimeoutError: the deadline passed before any answer was found.
        """
        if atom not in self._places:
            return None
        index, number = self._places[atom]
        component, best = self.parts[index].component, self.parts[index].best
        try:
            forced = least_with(component, number, deadline)
        except UnsatisfiableError:
            return None
        return {level: forced.cost[level] - cost for level, cost in best.cost.items()}

    def part_of(self, atom: clingo.Symbol) -> Part | None:
        """Return the component in which an atom is open; `None` where the rules decide it."""
        place = self._places.get(atom)
        return None if place is None else self.parts[place[0]]

    def _optimise(self, component: Component, deadline: float | None) -> Optimum:
        if deadline is not None and time.monotonic() > deadline:
            deadline = time.monotonic() + 0.05
        try:
            return optimise(component, deadline)
        except UnsatisfiableError:
            raise self._refused("no resolution satisfies the rules of `rules/resolve`") from None
