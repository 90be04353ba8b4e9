"""The lines of triggers, resets, locks, limits and strategies in a specification.

`rules/specify` decides which lines there are, and their attributes.
"""

from collections.abc import Mapping
from typing import NamedTuple, cast

from mars_asp.asp.solve.term_ids import TermId, as_symbol, text
from mars_asp.model.declarations import (
    GATING,
    Gating,
    Limit,
    Lock,
    Relationship,
    Reset,
    Sign,
    Strategy,
    StrategyName,
)
from mars_asp.reasoning.synthesis.derived import SpecifiedAtoms
from mars_asp.reasoning.synthesis.draft import SpecificationDraft

_STRATEGY = "spec_is_arbitrated_by"
#: The predicates of side lines; of one receiver, locks, limits and the strategy are in this order.
_PREDICATES = (
    *("spec_is_suppressed_by", "spec_is_inhibited_by", "spec_is_reset_by"),
    *("spec_is_locked_by", "spec_is_limited_by", _STRATEGY),
)
_NUMBERS = ("spec_closes_for", "spec_lock_priority", "spec_bound_hold", "spec_mean_period")
_SIGNS: Mapping[str, Sign] = {f"spec_{word}": sign for sign, word in GATING.items()}


class _SideLine(NamedTuple):
    """A side line of the derived specification: its predicate, term, receiver and feeder.

    In place of a feeder, a strategy has its name.
    """

    predicate: str
    line: TermId
    receiver: TermId
    feeder: TermId


class SideLines:
    """Writes side lines into new nodes after the other lines there, all others at their places."""

    def __init__(
        self, draft: SpecificationDraft, derived: SpecifiedAtoms, places: Mapping[TermId, int]
    ) -> None:
        """Index the lines by their receivers; `places` are the indices of lines in the file."""
        self._draft, self._derived, self._places = draft, derived, places
        self._into: dict[TermId, list[_SideLine]] = {}
        self._at: dict[int, _SideLine] = {}
        self._numbers = {
            name: {line: as_symbol(number).number for line, number in derived.of_each(name).items()}
            for name in _NUMBERS
        }
        #: The feeders of written lines.
        self.pending: list[TermId] = []
        for predicate in _PREDICATES:
            for line, receiver, feeder in derived.rows(predicate, 3):
                each = _SideLine(predicate, line, receiver, feeder)
                if receiver in derived.kinds:
                    self._into.setdefault(receiver, []).append(each)
                else:
                    self._at[places[line]] = each

    def write_into(self, node: TermId) -> None:
        """Write the side lines of a new node, in the order of the configuration."""
        lines = self._into.pop(node, ())
        places = self._places
        for line in sorted(
            lines, key=lambda each: (each.predicate == _STRATEGY, places[each.line])
        ):
            self._write(line)

    def write_at(self, place: int) -> None:
        """Write the line that represents a relationship of the file, unless a node has it."""
        line = self._at.pop(place, None)
        if line is not None:
            self._write(line)

    def _write(self, line: _SideLine) -> None:
        draft = self._draft
        receiver = draft.name(line.receiver, self._derived)
        span = draft.relationships[self._places[line.line]].span
        if line.predicate == _STRATEGY:
            strategy = cast("StrategyName", text(line.feeder))
            period = self._numbers["spec_mean_period"].get(line.line)
            draft.lines.append(Strategy(receiver, span, strategy, period))
            return
        source, port = draft.ends.written(draft.name(line.feeder, self._derived))
        ms, priority, hold, _ = (each.get(line.line) for each in self._numbers.values())
        written: Relationship
        match line.predicate:
            case "spec_is_reset_by":
                written = Reset(receiver, source, span, port)
            case "spec_is_locked_by":
                written = Lock(receiver, source, span, priority, hold, port)
            case "spec_is_limited_by":
                written = Limit(receiver, source, span, hold, port)
            case predicate:
                written = Gating(receiver, source, span, _SIGNS[predicate], ms or 1, None, port)
        draft.lines.append(written)
        self.pending.append(line.feeder)
