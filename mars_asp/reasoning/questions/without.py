"""The violations without a node: `rules/verify` judges the remaining specification.

>>> reasoner = Reasoner(load_project("config.mars"), load_rulebook(stages=("resolve", "verify")))
>>> [broken.violation.message for broken in without("DataSplitter1", reasoner)]
['`Camera` feeds data to 2 receivers']
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass, replace
from itertools import chain
from typing import NamedTuple

from mars_asp.diagnostic import Span, point
from mars_asp.model.declarations import (
    Configuration,
    Control,
    Data,
    Mount,
    Relationship,
    Strategy,
    ends_of,
    ports_of,
    verb_of,
    with_source,
)
from mars_asp.reasoning.questions.subject import no_node
from mars_asp.reasoning.session import Reasoner
from mars_asp.reasoning.synthesis import IntroducedNode
from mars_asp.reasoning.verification import (
    Violation,
    judge_specification,
)

#: The file name in the locations of remaining lines, which are in no file.
_LEFT = "<left>"


@dataclass(frozen=True, slots=True)
class ViolatedClause:
    """A violation without a node, and the relationships of the configuration on which it rests."""

    violation: Violation
    relationships: tuple[Relationship, ...]


def without(name: str, reasoner: Reasoner) -> tuple[ViolatedClause, ...] | None:
    """Return the violated clauses of the minimal specification without the node `name`.

    The result is None if no specification exists. The rulebook of `reasoner` contains the stages
    `resolve` and `verify`.

    Raises:
        MarsError: there is no such node.
        TimeoutError: no specification was found in time.
    """
    synthesis, project = reasoner.synthesis, reasoner.project
    if synthesis is None:
        return None
    nodes = {node.name: node for node in synthesis.specification.nodes}
    if name not in nodes:
        raise no_node(name, list(nodes), project)
    declared = project.configuration.relationships
    over = _Ways(synthesis.specification.configuration, nodes).over(declared)
    left = _Left(synthesis.specification.configuration, name)
    rulebook = reasoner.rulebook
    verification = judge_specification(left.specification, project, rulebook, cited=True)
    of_span = {relationship.span: number for number, relationship in enumerate(declared)}
    found = []
    for violation in verification.violations:
        spans = set(violation.locations)
        numbers = {of_span[span] for span in spans if span in of_span}
        for line in left.last(spans):
            numbers |= set[int].intersection(*(set(over[number]) for number in line.of))
        found.append(
            ViolatedClause(violation, tuple(declared[number] for number in sorted(numbers)))
        )
    return tuple(found)


class _Line(NamedTuple):
    """A line without the node, and the indices of the specification's lines that it replaces."""

    line: Relationship
    of: tuple[int, ...]


class _Left:
    """A specification without a node, whose outputs are connected to its inputs.

    A joined line has the attributes of the input line, as at an arbiter, and else those of the
    output line. Each line has a location by which traces refer to it.
    """

    def __init__(self, whole: Configuration, name: str) -> None:
        lines = [
            _Line(replace(line.line, span=point(_LEFT, number, 1)), line.of)
            for number, line in enumerate(_without(whole.relationships, name), 1)
        ]
        self._lines = {line.line.span: line for line in lines}
        self.specification = replace(
            whole,
            modules=tuple(module for module in whole.modules if module.text != name),
            relationships=tuple(line.line for line in lines),
            conversions=tuple(c for c in whole.conversions if c.transformer != name),
            stand_ins=tuple(each for each in whole.stand_ins if each.node != name),
        )

    def last(self, places: Iterable[Span]) -> Sequence[_Line]:
        """Return the lines at some locations that feed no other of these lines."""
        lines = [self._lines[place] for place in places if place in self._lines]
        feeders = {ends_of(line.line)[1] for line in lines}
        return [line for line in lines if ends_of(line.line)[0] not in feeders]


def _without(lines: Sequence[Relationship], name: str) -> Iterator[_Line]:
    """Yield the lines without the node: each line into it is joined with each out of it.

    The triggers, locks, limits and strategy of the node go with it.
    """
    wired = [None if isinstance(line, Mount) else ends_of(line) for line in lines]
    inputs = [
        number
        for number, ends in enumerate(wired)
        if ends is not None and ends[0] == name and isinstance(lines[number], Data | Control)
    ]
    for number, (line, ends) in enumerate(zip(lines, wired, strict=True)):
        if ends is not None and ends[1] == name != ends[0]:
            for given in inputs:
                yield _Line(_joined(lines[given], line), (given, number))
        elif ends is None or ends[0] != name:
            yield _Line(line, (number,))


def _joined(given: Relationship, taken: Relationship) -> Relationship:
    joined = with_source(taken, ends_of(given)[1], ports_of(given)[1])
    if not isinstance(joined, Control):
        return joined
    assert isinstance(given, Control)
    assert isinstance(taken, Control)
    return replace(
        joined,
        priority=taken.priority if given.priority is None else given.priority,
        hold_ms=taken.hold_ms if given.hold_ms is None else given.hold_ms,
        allocation=taken.allocation if given.allocation is None else given.allocation,
    )


class _Ways:
    """The lines of a specification on the paths between declared modules."""

    def __init__(self, specification: Configuration, nodes: Mapping[str, IntroducedNode]) -> None:
        self._lines = specification.relationships
        self._nodes = nodes
        self._stand_in = {node.stands_for: node.name for node in nodes.values()}
        self._into: dict[tuple[type, str], list[int]] = {}
        self._out_of: dict[str, list[int]] = {}
        #: The gate, reset, lock and limit lines by their verb.
        self._aside: dict[str, list[int]] = {}
        for number, line in enumerate(self._lines):
            receiver, feeder = ends_of(line)
            self._into.setdefault((type(line), receiver), []).append(number)
            if isinstance(line, Data | Control):
                self._out_of.setdefault(feeder, []).append(number)
            else:
                self._aside.setdefault(verb_of(line), []).append(number)

    def over(self, declared: Sequence[Relationship]) -> Sequence[Set[int]]:
        """Return for each line the indices of the declared relationships whose path contains it."""
        found: list[set[int]] = [set() for _ in self._lines]
        for number, relationship in enumerate(declared):
            for line in self._of(relationship):
                found[line].add(number)
        return found

    def _of(self, relationship: Relationship) -> Iterator[int]:
        """Yield the index of each line on the path of a declared relationship."""
        if isinstance(relationship, Mount | Strategy):
            return
        receiver = ends_of(relationship)[0]
        if not isinstance(relationship, Data | Control):
            yield from self._back(self._realising(relationship), relationship)
            return
        yield from self._back(self._into.get((type(relationship), receiver), ()), relationship)
        # Commands to inherited functions pass the node that represents the module.
        stand_in = self._stand_in.get(receiver) if isinstance(relationship, Control) else None
        if stand_in is not None:
            before = list(self._back(self._into.get((Control, stand_in), ()), relationship))
            yield from before
            # Without such commands the controller has no path to the node.
            yield from self._on(stand_in) if before else ()

    def _realising(self, relationship: Relationship) -> Sequence[int]:
        """Return the lines with the location of a gate, reset, lock or limit line.

        One line can represent several receivers' lines, at the location of the first. For the
        others, the lines into the nodes before their receivers are returned.
        """
        lines = self._aside.get(verb_of(relationship), ())
        own = [number for number in lines if self._lines[number].span == relationship.span]
        receiver = ends_of(relationship)[0]
        ends = {receiver, self._stand_in.get(receiver, receiver)}
        return own or [
            number
            for number in lines
            for after in self._on(ends_of(self._lines[number])[0])
            if ends_of(self._lines[after])[0] in ends
        ]

    def _back(self, starts: Iterable[int], relationship: Relationship) -> Iterator[int]:
        """Yield the index of each line on paths from a relationship's feeder via nodes to starts.

        Ports that both the relationship and a line name are the same.
        """
        feeder, (into, out_of) = ends_of(relationship)[1], ports_of(relationship)
        after: dict[int, int | None] = {
            number: None
            for number in starts
            if not isinstance(relationship, Data) or _agree(into, ports_of(self._lines[number])[0])
        }
        waiting = list(after)
        while waiting:
            number = waiting.pop()
            origin = ends_of(self._lines[number])[1]
            if origin == feeder and _agree(out_of, ports_of(self._lines[number])[1]):
                on: int | None = number
                while on is not None:
                    yield on
                    on = after[on]
            elif origin in self._nodes and self._nodes[origin].stands_for is None:
                lines = (self._into.get((kind, origin), ()) for kind in (Data, Control))
                before = [n for n in chain(*lines) if n not in after]
                after.update(dict.fromkeys(before, number))
                waiting += before

    def _on(self, feeder: str) -> Iterator[int]:
        """Yield each data or control line downstream of the node `feeder`, up to modules."""
        waiting = list(self._out_of.get(feeder, ()))
        while waiting:
            number = waiting.pop()
            yield number
            receiver = ends_of(self._lines[number])[0]
            if receiver in self._nodes:
                waiting += self._out_of.get(receiver, ())


def _agree(declared: str | None, written: str | None) -> bool:
    """Whether two names of ports can mean the same port."""
    return declared is None or written is None or declared == written
