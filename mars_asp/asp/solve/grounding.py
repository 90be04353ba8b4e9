"""Ground rules and facts with clingo, and find the optimal answer, component by component."""

import re
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from functools import cached_property
from types import MappingProxyType
from typing import Literal, NamedTuple, TypeAlias

import clingo

from mars_asp.asp.fragments import Fragment, able_to_fire, joined, refusals
from mars_asp.asp.signature import Signature
from mars_asp.asp.solve.components import Component, partition
from mars_asp.asp.solve.observer import Recorded, record
from mars_asp.asp.solve.optimum import (
    COST_LEVEL,
    Optimum,
    UnsatisfiableError,
    check_costs,
    has_without,
    least,
    least_with,
    optimise,
)
from mars_asp.asp.solve.term_ids import Labelled, TermId, as_symbol, labelled, state
from mars_asp.diagnostic import Diagnostic, MarsError, whole_file

# The components are minimised one by one, and never the whole program.
_OPTIONS = ("--seed=1", "--stats=0", "--warn=no-atom-undefined", "--opt-mode=ignore")
_MOST_MESSAGES = 10_000
_UNSATISFIABLE = "no answer satisfies the rules that choose"
#: The minimal time for each component: most need less, and a slow one must not stop the others.
_LEAST_SECONDS = 0.05
#: How answers without an atom compare: none exist, or without costs, or equal or greater cost.
Lack: TypeAlias = Literal["never", "free", "equal", "dearer"]
_PROJECTED = re.compile(r"^#project (\w+)/(\d+)\.", re.MULTILINE)
# Shown terms are read from the atoms: the texts that clingo would write for its solver grow with
# the square of a long list, because each item is in a text with the whole list.
_NOTHING_SHOWN = "#show."
_SHOWN = re.compile(r"^#show (\w+)/(\d+)\.", re.MULTILINE)


@dataclass(frozen=True)
class ChosenAnswer:
    """An answer of rules that choose: the atoms that follow from the decided literals.

    It is found by propagation alone, without search, so it also shows that the decisions of the
    components together are an answer of the whole program.
    """

    grounding: "Grounding"
    decided: tuple[int, ...]

    @cached_property
    def true(self) -> Mapping[Signature, Sequence[TermId]]:
        """Return the true atoms of each predicate of which not all are facts."""
        with self._model() as model:
            return {
                signature: [a for a, literal, is_fact in atoms if is_fact or model.is_true(literal)]
                for signature, atoms in self.grounding.open_predicates()
            }

    def true_of(self, predicates: Iterable[Signature]) -> Mapping[Signature, Sequence[TermId]]:
        """Return the true atoms of some predicates, facts among them."""
        control = self.grounding.control
        with self._model() as model:
            return {
                signature: [
                    atom
                    for atom, literal, is_fact in labelled(control, *signature)
                    if is_fact or model.is_true(literal)
                ]
                for signature in predicates
            }

    def count(self, predicate: Signature) -> int:
        """Return the number of true atoms of a predicate; its open atoms must be in components."""
        true = self.grounding.facts.union(self.decided)
        found = labelled(self.grounding.control, *predicate)
        return sum(is_fact or literal in true for _, literal, is_fact in found)

    @cached_property
    def taken(self) -> frozenset[TermId]:
        """Return the true atoms of all predicates that have an atom that is not a fact."""
        return frozenset(atom for atoms in self.true.values() for atom in atoms)

    @property
    def exists(self) -> bool:
        """Whether the decisions of the components are consistent with each other."""
        with self.grounding.control.solve(assumptions=self.decided, yield_=True) as handle:
            return handle.model() is not None

    def check(self) -> None:
        """Check that this answer exists.

        Raises:
            MarsError: the decisions of the components contradict each other.
        """
        with self._model():
            pass

    @contextmanager
    def _model(self) -> Iterator[clingo.Model]:
        with self.grounding.control.solve(assumptions=self.decided, yield_=True) as handle:
            model = handle.model()
            if model is None:
                raise NoAnswerError(self.grounding.refused(_UNSATISFIABLE).diagnostics)
            yield model


@dataclass(frozen=True)
class Resolution:
    """The optimal answer of rules that choose.

    `cost` and `bound` map the levels of the minimisation to values; `count` is the number of
    optima, or None if it is unknown.
    """

    answer: ChosenAnswer
    cost: dict[int, int]
    bound: dict[int, int]
    proven: bool
    count: int | None

    @property
    def taken(self) -> frozenset[TermId]:
        """Return the true atoms of all predicates that have an atom that is not a fact."""
        return self.answer.taken


class NoAnswerError(MarsError):
    """Rules that choose have no answer."""


class Part(NamedTuple):
    """A component with its optimum; `atoms[n - 1]` is the ground atom for its number n."""

    component: Component
    atoms: tuple[int, ...]
    best: Optimum

    def decided(self, answer: Optimum) -> tuple[int, ...]:
        """Return an answer of the component as literals of the ground program."""
        numbered = enumerate(self.atoms, 1)
        return tuple(atom if number in answer.true else -atom for number, atom in numbered)


class Grounding:
    """A clingo control that first grounds deterministic rules, and then rules that choose."""

    def __init__(
        self,
        program: Sequence[Fragment],
        initial: Mapping[Signature, Iterable[TermId]] = MappingProxyType({}),
        options: Sequence[str] = (),
    ) -> None:
        """Ground rules and facts that leave nothing open, and state atoms of other groundings.

        `options` are additional ones of clingo's command line.

        Raises:
            MarsError: clingo refuses a rule, or the rules leave a choice.
        """
        self._messages: list[tuple[clingo.MessageCode, str]] = []
        self._fragments: Sequence[Fragment] = ()
        #: The components that were solved.
        self.parts: list[Part] = []
        self._program = Recorded()
        self._names: dict[int, TermId] = {}
        self._steps = 0
        #: The atoms that are external, with their values.
        self.externals: dict[clingo.Symbol, bool | None] = {}
        messages = self._messages
        self.control = clingo.Control(
            [*_OPTIONS, *options],
            # A method would keep its control alive, which Python's collector does not see as large.
            lambda code, message: messages.append((code, message)),
            _MOST_MESSAGES,
        )
        self.add([*program, Fragment(_NOTHING_SHOWN, "rules")])
        self.state(initial)
        #: The signatures whose atoms are decided before any choice.
        self._settled = frozenset(self.control.symbolic_atoms.signatures)

    def add(self, program: Sequence[Fragment], undefined: bool = False) -> None:
        """Ground further rules and facts.

        Errors are reported with their locations in the files. With `undefined`, instances with an
        undefined operation such as `1/0` are left out, as clingo does.

        Raises:
            MarsError: clingo refuses a rule.
        """
        self._ground(self._able_to_fire(program), undefined)

    def _able_to_fire(self, program: Sequence[Fragment]) -> Sequence[Fragment]:
        found = self.control.symbolic_atoms
        present = {
            name
            for name, arity, positive in found.signatures
            if next(found.by_signature(name, arity, positive), None) is not None
        }
        return able_to_fire(program, present)

    def _ground(self, program: Sequence[Fragment], undefined: bool = False) -> None:
        self._steps += 1
        part = f"step{self._steps}"
        self._fragments = program
        try:
            self.control.add(part, [], joined(program))
            self.control.ground([(part, [])])
        except RuntimeError as error:
            raise self.refused(str(error)) from None
        worst = clingo.MessageCode.OperationUndefined
        if not undefined and any(code == worst for code, _ in self._messages):
            raise self.refused("an operation is undefined")

    def derive(self, program: Sequence[Fragment]) -> None:
        """Ground rules for their atoms alone; afterwards answers cannot be searched any more.

        Neither the solver nor the recorded program receives the rules, which saves most time.

        Raises:
            MarsError: clingo refuses a rule.
        """
        self.control.register_observer(clingo.Observer(), replace=True)
        self.add(program)

    def refused(self, reason: str) -> MarsError:
        """Return clingo's errors about the rules, with locations; `reason` if it gave none."""
        entries = [message.strip() for _, message in self._messages]
        found = tuple(refusals(entries, self._fragments))
        details = "; ".join(entries[:5]) or reason
        whole = Diagnostic(
            "rules-refused",
            "error",
            f"clingo refuses the rules: {details}",
            whole_file("rules"),
            help="run `mars-asp rules lint` on your rule files",
        )
        return MarsError(found or (whole,))

    def symbols(self, name: str, arity: int) -> Iterable[clingo.Symbol]:
        """Yield the grounded atoms of a predicate, facts or not."""
        return (atom.symbol for atom in self.control.symbolic_atoms.by_signature(name, arity))

    def atoms(self, name: str, arity: int) -> Iterable[tuple[clingo.Symbol, bool]]:
        """Yield the atoms of a predicate, each with whether it is a fact."""
        found = self.control.symbolic_atoms.by_signature(name, arity)
        return ((atom.symbol, atom.is_fact) for atom in found)

    def resolve(
        self,
        program: Sequence[Fragment],
        deadline: float | None = None,
        progress: Callable[[int, int], None] | None = None,
    ) -> Resolution:
        """Ground rules that choose, and find their optimal answer.

        `deadline` is a time of `time.monotonic`, after which answers are no longer improved;
        `progress` is called with the numbers of finished and of all components.

        Raises:
            NoAnswerError: the rules have no answer.
            MarsError: the rules are refused.
            TooCostlyError: the costs of a component are too great; nothing is solved then.
        """
        with self._choosing(program):
            return self._minimal(COST_LEVEL, deadline, progress)

    @contextmanager
    def _choosing(self, program: Sequence[Fragment]) -> Iterator[None]:
        """Ground rules that choose, and let the block solve them; NoAnswerError without answer."""
        self._program = record(self.control)
        able = self._able_to_fire(program)
        self._ground([each._replace(text=_SHOWN.sub("", each.text)) for each in able])
        self._names = {
            literal: atom
            for name, arity in _PROJECTED.findall(joined(program))
            for atom, literal, _ in labelled(self.control, name, int(arity), True)
        }
        try:
            yield
        except UnsatisfiableError:
            raise NoAnswerError(self.refused(_UNSATISFIABLE).diagnostics) from None

    def choose(
        self,
        program: Sequence[Fragment],
        deadline: float | None = None,
        counting: bool = False,
        externals: Mapping[clingo.Symbol, bool | None] = MappingProxyType({}),
    ) -> Resolution:
        """Ground a program of any kind, and find its optimal answer; all open atoms are projected.

        `deadline` is as in `resolve`. Optima are only counted with `counting`. `externals` are the
        values of externals that differ from their initial ones.

        Raises:
            MarsError: clingo refuses a rule.
            UnsatisfiableError: there is no answer.
            TooCostlyError: the costs of a component are too great; nothing is solved then.
        """
        self._program = record(self.control)
        self.add(program, undefined=True)
        self._assign(externals)
        self._names = {
            literal: atom
            for signature in self.control.symbolic_atoms.signatures
            for atom, literal, is_fact in labelled(self.control, *signature)
            if not is_fact
        }
        self._program.projected.update(self._names)
        return self._minimal(None, deadline, None, counting)

    def _assign(self, externals: Mapping[clingo.Symbol, bool | None]) -> None:
        """Set the values of externals, in the solver and in the recorded program."""
        for atom in self.control.symbolic_atoms if self._program.externals else ():
            # An atom that a rule derives is no longer external.
            if not atom.is_external:
                continue
            value = externals.get(atom.symbol, self._program.externals.get(atom.literal))
            self.control.assign_external(atom.symbol, value)
            self.externals[atom.symbol] = value
            if value:
                self._program.facts.append(atom.literal)
            elif value is None:
                self._program.note(True, (atom.literal,), ())

    def _minimal(
        self,
        counted: int | None,
        deadline: float | None,
        progress: Callable[[int, int], None] | None,
        counting: bool = True,
    ) -> Resolution:
        """Return the optimal answer; optima are counted as equal at levels from `counted` up."""
        parts = partition(self._program, self._names)
        known: dict[Component, Optimum] = {}
        for component, _ in parts.components:
            check_costs(component)
        cost = dict(parts.constant)
        bound = dict(parts.constant)
        count: int | None = 1 if counting else None
        proven = True
        decided: list[int] = []
        for done, (component, numbered) in enumerate(parts.components):
            if progress is not None:
                progress(done, len(parts.components))
            # Equal components have equal optima, so each is solved once.
            best = known.get(component)
            if best is None:
                least_end = time.monotonic() + _LEAST_SECONDS
                until = None if deadline is None else max(deadline, least_end)
                best = known[component] = optimise(component, until, counted, counting)
            part = Part(component, numbered, best)
            self.parts.append(part)
            decided += part.decided(best)
            for level, value in best.cost.items():
                cost[level] = cost.get(level, 0) + value
                bound[level] = bound.get(level, 0) + best.bound[level]
            proven = proven and best.proven
            count = None if count is None or best.count is None else count * best.count
        return Resolution(ChosenAnswer(self, tuple(decided)), cost, bound, proven, count)

    def state(self, atoms: Mapping[Signature, Iterable[TermId]]) -> None:
        """Add facts that another grounding has derived."""
        declared: dict[tuple[str, bool], list[TermId]] = {}
        for (name, _, positive), terms in atoms.items():
            declared.setdefault((name, positive), []).extend(terms)
        # Clingo copies its program for each use of the backend, even without facts.
        if declared:
            state(self.control, declared)

    @property
    def facts(self) -> frozenset[int]:
        """Return the numbers, in the ground program, of the atoms that are facts."""
        return frozenset(self._program.facts)

    def open_predicates(self) -> Iterator[tuple[Signature, Sequence[Labelled]]]:
        """Yield the predicates with open atoms, each with all its atoms."""
        for signature in self.control.symbolic_atoms.signatures:
            if signature not in self._settled:
                found = labelled(self.control, *signature)
                if not all(is_fact for _, _, is_fact in found):
                    yield Signature(*signature), found

    def extra_cost(
        self, symbol: clingo.Symbol, deadline: float | None = None
    ) -> dict[int, int] | None:
        """Return the additional cost of the cheapest answer with an atom, level by level.

        It is None if no answer has the atom. Call it after `resolve`.

        Raises:
            TimeoutError: the time limit passed before any answer was found.
        """
        atom = self.control.symbolic_atoms[symbol]
        if atom is None:
            return None
        for component, atoms in partition(self._program, self._names, [atom.literal]).components:
            if atom.literal in atoms:
                try:
                    forced = least_with(component, 1 + atoms.index(atom.literal), deadline)
                except UnsatisfiableError:
                    return None
                free = least(component, deadline)
                return {level: forced.cost[level] - cost for level, cost in free.cost.items()}
        return None

    def lacks(self, symbol: clingo.Symbol) -> Lack:
        """Return whether answers without an open atom exist, and are as cheap as the optimum."""
        part, given = self.part_of(symbol), self.control.symbolic_atoms[symbol]
        if part is None or given is None:
            return "never"
        component, atoms, best = part
        atom = 1 + atoms.index(given.literal)
        if not has_without(component, atom):
            return "never"
        if not best.cost:
            return "free"
        return "equal" if has_without(component, atom, best.cost) else "dearer"

    def part_of(self, symbol: clingo.Symbol) -> Part | None:
        """Return the component in which an atom is open, or None if the rules decide it."""
        atom = self.control.symbolic_atoms[symbol]
        return None if atom is None else self._part_of.get(atom.literal)

    @cached_property
    def _part_of(self) -> dict[int, Part]:
        return {atom: part for part in self.parts for atom in part.atoms}

    @cached_property
    def symbol_of(self) -> dict[int, clingo.Symbol]:
        """Return the open atoms by their numbers in the ground program."""
        found = (each for _, atoms in self.open_predicates() for each in atoms)
        return {literal: as_symbol(atom) for atom, literal, is_fact in found if not is_fact}


def unsolved(program: Iterable[Fragment]) -> clingo.Control:
    """Return a control that has grounded a program as far as possible and cannot solve it."""
    control = clingo.Control(_OPTIONS, lambda *_: None, _MOST_MESSAGES)
    control.register_observer(clingo.Observer(), replace=True)
    with suppress(RuntimeError):
        control.add("base", [], joined(program))
        control.ground()
    return control
