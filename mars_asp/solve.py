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


class Grounding:
    """One clingo control with the consequences as facts, then the resolution rules."""

    def __init__(self, base: str, facts: str) -> None:
        """Ground the rules of the consequences over facts.

        Raises:
            MarsError: clingo refuses a rule, or the rules leave a choice.
        """
        self._messages: list[tuple[clingo.MessageCode, str]] = []
        #: Where each open atom stands: its component, its number there, and the optimum.
        self._solved: dict[clingo.Symbol, tuple[Component, int, Optimum]] = {}
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
            for number, atom in enumerate(atoms, 1):
                if atom in names:
                    self._solved[names[atom]] = (component, number, best)
            taken.update(names[atoms[n - 1]] for n in best.true if atoms[n - 1] in names)
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
        if atom not in self._solved:
            return None
        component, number, best = self._solved[atom]
        try:
            forced = least_with(component, number, deadline)
        except UnsatisfiableError:
            return None
        return {level: forced.cost[level] - cost for level, cost in best.cost.items()}

    def _optimise(self, component: Component, deadline: float | None) -> Optimum:
        if deadline is not None and time.monotonic() > deadline:
            deadline = time.monotonic() + 0.05
        try:
            return optimise(component, deadline)
        except UnsatisfiableError:
            raise self._refused("no resolution satisfies the rules of `rules/resolve`") from None
