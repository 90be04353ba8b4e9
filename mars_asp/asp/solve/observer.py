"""A ground program, recorded as numbers while clingo grounds it.

Clingo passes a large program rule by rule, and its Python package makes two lists of each rule. If
the package offers it, though not in its documented interface, they are read from clingo's memory;
otherwise the documented interface is used, which is slower.
"""

import importlib
from array import array
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import clingo


@dataclass(frozen=True, slots=True)
class Recorded:
    """A ground program, which grows while clingo grounds.

    For each rule, `rules` has four numbers: whether it is a choice, the lengths of head and body,
    and the bound of a weight body or 0; then head and body. A weight body lists literals and
    weights. Rules that state a fact are in `facts` alone. `costs` are (level, weight, literal);
    `projected` are the atoms that distinguish answers, `externals` have their initial values, where
    None is open.
    """

    rules: "array[int]" = field(default_factory=lambda: array("i"))
    facts: "array[int]" = field(default_factory=lambda: array("i"))
    costs: list[tuple[int, int, int]] = field(default_factory=list)
    projected: set[int] = field(default_factory=set)
    externals: dict[int, bool | None] = field(default_factory=dict)

    def note(self, choice: bool, head: Sequence[int], body: Sequence[int]) -> None:
        """Add a rule of literals (numbers); one head without body or choice is a fact."""
        if not body and len(head) == 1 and not choice:
            self.facts.append(head[0])
        else:
            self.rules.extend((choice, len(head), len(body), 0, *head, *body))


class _Rare(clingo.Observer):
    """A clingo observer that records all statements except plain rules."""

    def __init__(self, noted: Recorded) -> None:
        self.noted = noted

    def weight_rule(
        self, choice: bool, head: Sequence[int], lower_bound: int, body: Sequence[tuple[int, int]]
    ) -> None:
        if lower_bound <= 0:
            self.noted.note(choice, head, ())
            return
        weighted = [number for pair in body for number in pair]
        self.noted.rules.extend((choice, len(head), len(weighted), lower_bound, *head, *weighted))

    def minimize(self, priority: int, literals: Sequence[tuple[int, int]]) -> None:
        self.noted.costs.extend((priority, weight, literal) for literal, weight in literals)

    def external(self, atom: int, value: clingo.TruthValue) -> None:
        values = {clingo.TruthValue.True_: True, clingo.TruthValue.False_: False}
        self.noted.externals[atom] = values.get(value)

    def project(self, atoms: Sequence[int]) -> None:
        self.noted.projected.update(atoms)


class _All(_Rare):
    """A clingo observer that records all statements."""

    def rule(self, choice: bool, head: Sequence[int], body: Sequence[int]) -> None:
        self.noted.note(choice, head, body)


def plain_record(control: clingo.Control) -> Recorded:
    """Return the recording of a control through clingo's documented interface."""
    noted = Recorded()
    control.register_observer(_All(noted))
    return noted


def raw_recorder() -> Callable[[clingo.Control], Recorded] | None:
    """Return a faster function than `plain_record`, or None if clingo does not allow it."""
    try:
        internal: Any = importlib.import_module("clingo._internal")
        ffi, lib, check = internal._ffi, internal._lib, internal._handle_error
        control: Any = clingo.Control()
        kind = ffi.typeof(ffi.new("clingo_ground_program_observer_t*").rule)
        # Where memory may not be executed, there are no callbacks.
        ffi.callback(kind, lambda *_: True)
        if not (control._rep and hasattr(control, "_error") and hasattr(control, "_mem")):
            return None
    except (ImportError, AttributeError, TypeError, MemoryError):
        return None
    unpack = ffi.unpack

    def record(control: clingo.Control) -> Recorded:
        noted = Recorded()
        note, note_fact = noted.rules.extend, noted.facts.append
        base: Any = control
        errors = base._error

        def rule(choice: bool, head: Any, heads: int, body: Any, bodies: int, _: Any) -> bool:
            if not bodies and heads == 1 and not choice:
                note_fact(head[0])
                return True
            note((choice, heads, bodies, 0))
            if heads:
                note(unpack(head, heads))
            if bodies:
                note(unpack(body, bodies))
            return True

        def stopped(*error: Any) -> bool:
            # The control raises it again, as it does for observers of the documented interface.
            errors.error = error
            lib.clingo_set_error(lib.clingo_error_unknown, b"stopped while grounding")
            return False

        control.register_observer(_Rare(noted))
        observer = ffi.new("clingo_ground_program_observer_t*")
        observer.rule = callback = ffi.callback(kind, rule, onerror=stopped)
        # Clingo copies the observer, but may call the callback as long as the control lives.
        base._mem.append(callback)
        check(lib.clingo_control_register_observer(base._rep, observer, False, ffi.NULL))
        return noted

    return record


#: Begin to record what a control grounds from now on.
record = raw_recorder() or plain_record
