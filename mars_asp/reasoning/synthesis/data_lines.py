"""The data lines of a specification: the tree of each source at its first relationship.

`rules/specify` decides which lines there are, and their attributes.
"""

from collections.abc import Mapping
from fractions import Fraction
from functools import cache
from typing import NamedTuple

from clingo import String

from mars_asp.asp.solve.term_ids import TermId, as_symbol, as_term
from mars_asp.model.declarations import Data, Mode
from mars_asp.reasoning.facts.identifiers import mode_of
from mars_asp.reasoning.synthesis.derived import SpecifiedAtoms
from mars_asp.reasoning.synthesis.draft import SpecificationDraft
from mars_asp.reasoning.synthesis.side_lines import SideLines


class _DataLine(NamedTuple):
    """A data line of the derived specification: its term, client and feeder."""

    line: TermId
    client: TermId
    feeder: TermId


class DataLines:
    """Writes the data lines of a specification: for each source once, along its converters."""

    def __init__(
        self,
        draft: SpecificationDraft,
        derived: SpecifiedAtoms,
        places: Mapping[TermId, int],
        sides: SideLines,
    ) -> None:
        """Index the lines by their feeders; `places` are the indices of lines in the file."""
        self._draft, self._derived, self._places, self._sides = draft, derived, places, sides
        self._out_of: dict[TermId, list[_DataLine]] = {}
        #: The feeder of each node.
        self._feeders: dict[TermId, TermId] = {}
        for line, client, feeder in derived.rows("spec_uses_data_from", 3):
            self._out_of.setdefault(feeder, []).append(_DataLine(line, client, feeder))
            if client in derived.kinds:
                self._feeders[client] = feeder
        data = (each for each in draft.relationships if isinstance(each, Data))
        self._sources = {as_term(String(draft.ends.source(each))) for each in data}
        self._modes = derived.of_each("spec_required_mode")
        self._rates = derived.of_each("spec_required_rate")
        self._inputs = derived.of_each("spec_into")
        self._done: set[TermId] = set()
        #: Prevents duplicates: a node with several inputs is reached from each of them.
        self._written: set[TermId] = set()

    def write(self, relationship: Data) -> None:
        """Write all lines of a relationship's source, unless they are written already."""
        self._write_source(as_term(String(self._draft.ends.source(relationship))))

    def open(self, feeder: TermId) -> None:
        """Write the lines before the feeder of a side line, if its source has no client."""
        while feeder in self._feeders:
            feeder = self._feeders[feeder]
        if feeder not in self._sources:
            self._write_source(feeder)

    def _write_source(self, source: TermId) -> None:
        if source in self._done:
            return
        self._done.add(source)
        place = self._places_downstream(source)
        # A stack instead of recursion: chains of converters may be long.
        stack = self._outputs(source, place)
        while stack:
            line = stack.pop()
            if line.line in self._written:
                continue
            self._written.add(line.line)
            self._write_line(line)
            self._sides.write_into(line.client)
            if line.client in self._derived.kinds:
                stack += self._outputs(line.client, place)

    def _outputs(self, feeder: TermId, place: Mapping[TermId, int]) -> list[_DataLine]:
        """Return the lines out of a source or node, last first."""
        return sorted(self._out_of.get(feeder, ()), key=lambda line: place[line.line], reverse=True)

    def _places_downstream(self, source: TermId) -> Mapping[TermId, int]:
        """Return the index of each line of a source: the lowest of the clients it serves."""
        lines = list(self._out_of.get(source, ()))
        for line in lines:
            if line.client in self._derived.kinds:
                lines += self._out_of.get(line.client, ())
        place: dict[TermId, int] = {}
        for line in reversed(lines):
            own = self._places.get(line.line)
            if own is None:
                after = (place[each.line] for each in self._out_of.get(line.client, ()))
                own = min(after, default=0)
            place[line.line] = own
        return place

    def _write_line(self, line: _DataLine) -> None:
        draft = self._draft
        client = draft.name(line.client, self._derived)
        mode, hz = self._service(line.line)
        feeder = draft.name(line.feeder, self._derived)
        source, source_port = draft.ends.written(feeder)
        entry = self._inputs.get(line.line)
        place = self._places.get(line.line)
        declared = None if place is None else draft.relationships[place]
        client_port = (
            None if entry is None else draft.ends.entries[self._derived.string(entry)].port
        )
        if isinstance(declared, Data) and client in draft.with_one_input:
            client_port = declared.client_port
        ports = client_port, source_port
        span = draft.span if declared is None else declared.span
        draft.lines.append(Data(client, source, span, mode, hz, *ports))
        if line.line in self._places and line.client not in self._derived.kinds:
            draft.place_of[id(draft.lines[-1])] = self._places[line.line]

    def _service(self, line: TermId) -> tuple[Mode | None, Fraction | None]:
        """Return the mode and frequency of a line, in the text of its relationship if any."""
        if line not in self._modes:
            return None, None
        if line in self._places:
            declared = self._draft.relationships[self._places[line]]
            if isinstance(declared, Data) and declared.mode is not None:
                return declared.mode, declared.hz
        rate = self._rates.get(line)
        hz = None if rate is None else self._draft.rates.written(as_symbol(rate).number)
        return _mode(self._modes[line]), hz


@cache
def _mode(term: TermId) -> Mode:
    return mode_of(as_symbol(term))
