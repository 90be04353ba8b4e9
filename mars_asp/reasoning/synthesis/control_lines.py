"""The control lines of a specification, in the order of the relationships that they represent.

`rules/specify` decides which lines there are, and their attributes.
"""

from collections.abc import Iterator, Mapping
from typing import NamedTuple, get_args

from clingo import String

from mars_asp.asp.solve.term_ids import TermId, as_symbol, as_term, text
from mars_asp.model.declarations import Allocation, Control
from mars_asp.reasoning.facts.identifiers import hold_of
from mars_asp.reasoning.synthesis.derived import SpecifiedAtoms
from mars_asp.reasoning.synthesis.draft import SpecificationDraft
from mars_asp.reasoning.synthesis.side_lines import SideLines

_ALLOCATIONS: Mapping[str, Allocation] = {each: each for each in get_args(Allocation)}


class _ControlLine(NamedTuple):
    """One control line, and the index of its relationship in the file, or -1."""

    line: TermId
    controlled: TermId
    controller: TermId
    place: int


class ControlLines:
    """Writes the control lines of a specification, each with all lines upstream, into a draft."""

    def __init__(
        self,
        draft: SpecificationDraft,
        derived: SpecifiedAtoms,
        places: Mapping[TermId, int],
        sides: SideLines,
    ) -> None:
        """Index the lines by their ends; `places` are the indices of lines in the file."""
        self._draft, self._derived, self._sides = draft, derived, sides
        self._into: dict[TermId, list[_ControlLine]] = {}
        self._out_of: dict[TermId, list[_ControlLine]] = {}
        for line, controlled, controller in derived.rows("spec_is_controlled_by", 3):
            each = _ControlLine(line, controlled, controller, places.get(line, -1))
            self._into.setdefault(controlled, []).append(each)
            self._out_of.setdefault(controller, []).append(each)
        #: The number of lines into each receiver that are not written.
        self._left = {receiver: len(lines) for receiver, lines in self._into.items()}
        self._priorities = derived.of_each("spec_priority")
        self._holds = derived.of_each("spec_hold")
        self._allocations = derived.of_each("spec_allocation")
        #: The InheritanceNode that represents each module.
        self._stand_ins = {module: node for node, module in derived.rows("spec_stands_for", 2)}
        self._written: set[TermId] = set()
        self._opened: set[TermId] = set()

    def write(self, control: Control) -> None:
        """Write the lines into a relationship's controlled module, and all lines upstream.

        The lines into an InheritanceNode that represents the module, and its providers, follow.
        """
        module = as_term(String(control.controlled))
        self._write_into(module)
        node = self._stand_ins.pop(module, None)
        if node is not None:
            self._write_into(node)
            for provider in sorted(set(self._reached_modules(node)), key=self._derived.string):
                self._write_into(provider)

    def _reached_modules(self, node: TermId) -> Iterator[TermId]:
        """Yield the modules downstream of a node."""
        stack = [node]
        for each in stack:
            for line in self._out_of.get(each, ()):
                if line.controlled in self._derived.kinds:
                    stack.append(line.controlled)
                else:
                    yield line.controlled

    def _write_into(self, receiver: TermId) -> None:
        self._write_upstream(
            sorted(self._into.pop(receiver, ()), reverse=True, key=lambda line: line.place)
        )

    def open(self, feeder: TermId) -> None:
        """Write the lines before the feeder of a side line; of a splitter also those after it."""
        if self._fans_out(feeder):
            self._write_split(feeder)
            for line in self._into[feeder]:
                self._write_upstream(self._opened_by(line.controller))
        else:
            self._write_upstream(self._opened_by(feeder))

    def _write_upstream(self, stack: list[_ControlLine]) -> None:
        """Write lines, the last first, each followed by all lines upstream of it."""
        while stack:
            line = stack.pop()
            after = [line]
            if self._fans_out(line.controller):
                after = self._into[line.controller]
                self._write_split(line.controller)
            else:
                self._write_line(line)
            for each in after:
                stack += self._opened_by(each.controller)

    def _opened_by(self, node: TermId) -> list[_ControlLine]:
        """Return the lines into a forwarding node, last first; none at later calls."""
        if not self._hands_on(node) or node in self._opened:
            return []
        self._opened.add(node)
        return sorted(self._into.get(node, ()), reverse=True, key=lambda line: line.place)

    def _hands_on(self, node: TermId) -> bool:
        """Whether a term is a node whose lines are written with those out of it.

        An InheritanceNode is written with the module that it represents instead.
        """
        return self._derived.kinds.get(node, "inheritance_node") != "inheritance_node"

    def _fans_out(self, node: TermId) -> bool:
        return self._hands_on(node) and len(self._out_of.get(node, ())) > 1

    def _write_split(self, node: TermId) -> None:
        """Write the inputs of a node and then all its outputs."""
        if node in self._opened:
            return
        self._opened.add(node)
        for line in self._into[node]:
            self._write_line(line)
        for line in sorted(self._out_of[node], key=self._by_receiver):
            self._write_line(line)

    def _by_receiver(self, line: _ControlLine) -> tuple[int, bool, bool, str]:
        """Return the sort key of a line: its index, and modules before nodes."""
        hands_on, is_node = self._hands_on(line.controlled), line.controlled in self._derived.kinds
        return line.place, hands_on, is_node, "" if hands_on else text(line.controlled)

    def _write_line(self, line: _ControlLine) -> None:
        if line.line in self._written:
            return
        self._written.add(line.line)
        draft, derived = self._draft, self._derived
        if self._fans_out(line.controlled):
            draft.name(line.controlled, derived)
        controller = draft.name(line.controller, derived)
        controlled = draft.name(line.controlled, derived)
        priority, hold = self._priorities.get(line.line), self._holds.get(line.line)
        allocation = self._allocations.get(line.line)
        # A splitter's input takes the index of the first of its outputs.
        after = (line, *self._out_of.get(line.controlled, ()))
        place = next((each.place for each in after if each.place >= 0), None)
        relationship = None if place is None else draft.relationships[place]
        # A line from a node represents several relationships, so it has the place of none.
        is_own = relationship is not None and line.controller not in derived.kinds
        draft.lines.append(
            Control(
                controlled,
                controller,
                relationship.span if relationship and is_own else draft.span,
                None if priority is None else as_symbol(priority).number,
                None if hold is None else hold_of(as_symbol(hold)),
                None if allocation is None else _ALLOCATIONS[text(allocation)],
                topic=relationship.topic if isinstance(relationship, Control) else None,
            )
        )
        self._left[line.controlled] -= 1
        if not self._left[line.controlled]:
            self._sides.write_into(line.controlled)
