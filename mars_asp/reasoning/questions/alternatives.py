"""Other specifications of a configuration, their additional cost, and lower bounds of the cost.

>>> found = alternatives(Reasoner(load_project("config.mars"), load_rulebook()))
>>> [other.extra for other in found.others]
[{30: 1, 20: 0, 10: 2}]
"""

import difflib
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from heapq import heappop, heappush
from itertools import islice
from typing import NamedTuple, TypeAlias

import clingo

from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.solve.grounding import ChosenAnswer, Part
from mars_asp.asp.solve.optimum import COST_LEVEL, Optimum, disjoint_needs, others
from mars_asp.asp.solve.optimum import Core as AtomNeed
from mars_asp.language.print import print_configuration
from mars_asp.model.declarations import VERBS, Connection
from mars_asp.reasoning.analysis import Analysis
from mars_asp.reasoning.project import Project
from mars_asp.reasoning.questions.needs import NodeReason, reasons
from mars_asp.reasoning.questions.subject import no_node
from mars_asp.reasoning.rules import COSTS, NODES
from mars_asp.reasoning.session import Evidence, Reasoner
from mars_asp.reasoning.synthesis import Specification, SpecifiedAtoms, specify
from mars_asp.reasoning.synthesis.synthesise import Synthesis

#: The levels of the cost, highest first.
_LEVELS = tuple(level for level in COSTS.values() if level >= COST_LEVEL)
#: Derived for each relationship that counts.
_COUNTED = (("link", 3), ("commanded", 3), ("acts", 5), ("acts_on", 4))
#: At most this many conversions are named.
MOST_CONVERSIONS = 5
#: For each component with another answer, in order, its number and that of the answer.
_Places: TypeAlias = tuple[tuple[int, int], ...]
_RELATES = re.compile(rf"^//|\b(?:{'|'.join(VERBS)})\b")


@dataclass(frozen=True, slots=True)
class Alternative:
    """Another specification, its additional cost by level, and its differing lines."""

    extra: Mapping[int, int]
    specification: Specification
    added: tuple[str, ...]
    removed: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class CertificateEntry:
    """A set of nodes of which each specification has one: `names` are those of the minimal one.

    `nodes` are terms; `reasons` explain each node, and why the minimal specification needs it; they
    are empty unless requested.
    """

    nodes: tuple[str, ...]
    names: tuple[str, ...]
    reasons: tuple[NodeReason, ...] = ()


@dataclass(frozen=True, slots=True)
class Level:
    """The cost on a level, and the lower bound that the certificate entries prove for it."""

    cost: int
    bound: int


@dataclass(frozen=True)
class Alternatives:
    """The minimal specification, others in the order of their cost, and entries of a certificate.

    `forced` are the nodes without an alternative. `needs` have no node in common; if they are fewer
    than the nodes, a search among the `candidates` proved that fewer nodes do not suffice. Of the
    `written` relationships of data and control, `declared` count. `levels` and `conversions`, those
    of the first transformers, are only filled for the whole. `complete` is whether there are no
    further alternatives.
    """

    synthesis: Synthesis
    analysis: Analysis
    written: int
    declared: int
    nodes: int
    forced: tuple[str, ...]
    needs: tuple[CertificateEntry, ...]
    candidates: int
    levels: Mapping[int, Level]
    conversions: tuple[str, ...]
    others: tuple[Alternative, ...]
    complete: bool


def alternatives(
    reasoner: Reasoner, subject: str | None = None, most: int = 5, shown: int | None = None
) -> Alternatives | None:
    """Return up to `most` alternatives to the whole or a node, None without a specification.

    The first `shown` certificate entries have reasons, all if it is `None`. The rulebook of
    `reasoner` contains the stages `resolve` and `account`.

    In each component that differs from the minimal specification, an alternative lacks a
    decision of every cheaper answer, so that mere additions are left out.

    Raises:
        MarsError: the subject is not a node of the specification.
        TimeoutError: the time did not suffice.
    """
    deadline = reasoner.budget.deadline()
    evidence, synthesis = reasoner.evidence(resolved=True), reasoner.synthesis
    if synthesis is None:
        return None
    search = _AlternativesSearch(reasoner.project, evidence, synthesis, reasoner.rulebook, deadline)
    return search.run(subject, most, shown)


class _OpenChoice(NamedTuple):
    """Another answer of one component, and its additional cost at each of `_LEVELS`."""

    extra: tuple[int, ...]
    part: Part
    other: Optimum


@dataclass(frozen=True)
class _AlternativesSearch:
    project: Project
    evidence: Evidence
    synthesis: Synthesis
    rulebook: Rulebook
    deadline: float | None

    @property
    def analysis(self) -> Analysis:
        return self.evidence.analysis

    def run(self, subject: str | None, most: int, shown: int | None) -> Alternatives:
        names = {clingo.parse_term(n.term): n.name for n in self.synthesis.specification.nodes}
        chosen = [atom for atom, name in names.items() if subject in (None, name)]
        if not chosen and subject is not None:
            raise no_node(subject, list(names.values()), self.project)
        part_of = self.analysis.grounding.part_of
        forced = [atom for atom in chosen if part_of(atom) is None]
        if subject is None:
            parts = list(self.analysis.grounding.parts)
        else:
            parts = [part for atom in chosen if (part := part_of(atom)) is not None]
        found = list(islice(_combined([self._choices(part, most + 1) for part in parts]), most + 1))
        own = _lines(self.synthesis.specification)
        entries = [self._alternative(extra, chosen, own) for extra, chosen in found[:most]]
        bounds = self._cores_by_level(parts)
        needs = [CertificateEntry((str(atom),), (names[atom],)) for atom in forced]
        for part in parts:
            needs += self._needs(part, bounds[id(part.component), NODES], names)
        place = {name: number for number, name in enumerate(names.values())}
        needs.sort(key=lambda need: min((place[name] for name in need.names), default=len(place)))
        levels = self._levels(parts, bounds) if subject is None else {}
        return Alternatives(
            self.synthesis,
            self.analysis,
            sum(isinstance(r, Connection) for r in self.project.configuration.relationships),
            sum(1 for each in _COUNTED for _ in self.analysis.grounding.symbols(*each)),
            len(forced) + sum(len(_costly(part) & part.best.true) for part in parts),
            tuple(names[atom] for atom in forced),
            (*self._explained(needs[:shown]), *needs[len(needs[:shown]) :]),
            len(forced) + sum(len(_costly(part)) for part in parts),
            levels,
            self._first_conversions() if levels else (),
            tuple(entries),
            len(found) <= most,
        )

    def _cores_by_level(
        self, parts: Iterable[Part]
    ) -> Mapping[tuple[int, int], Sequence[AtomNeed]]:
        """Return the unsatisfiable cores of each component at each level."""
        found: dict[tuple[int, int], Sequence[AtomNeed]] = {}
        for part in parts:
            for level in _LEVELS:
                key = id(part.component), level
                if key not in found:
                    found[key] = disjoint_needs(part.component, part.best, level, self.deadline)
        return found

    def _levels(
        self, parts: Sequence[Part], bounds: Mapping[tuple[int, int], Sequence[AtomNeed]]
    ) -> Mapping[int, Level]:
        """Return the cost of each level, and its bound from the cores in `bounds`."""
        found = {}
        for level in _LEVELS:
            cost = self.synthesis.cost(level)
            open_cost = sum(part.best.cost.get(level, 0) for part in parts)
            met = sum(n.weight for part in parts for n in bounds[id(part.component), level])
            found[level] = Level(cost, cost - open_cost + met)
        return found

    def _explained(self, needs: Sequence[CertificateEntry]) -> Iterator[CertificateEntry]:
        terms = [node for need in needs for node in need.nodes]
        found = self._reasons(terms)
        for need in needs:
            entries = [found[node] for node in need.nodes if node in found]
            # Nodes of the minimal specification come first, with the reason why they are needed.
            entries.sort(key=lambda reason: reason.why is None)
            yield replace(need, reasons=tuple(entries))

    def _first_conversions(self) -> tuple[str, ...]:
        """Return the conversions of the first transformers, with their costs."""
        nodes = self.synthesis.specification.nodes
        applying = [node.term for node in nodes if node.conversion and node.conversion.converter]
        found = self._reasons(applying[:MOST_CONVERSIONS])
        return tuple(reason.cost for reason in found.values() if reason.cost is not None)

    def _reasons(self, terms: Sequence[str]) -> Mapping[str, NodeReason]:
        if not terms:
            return {}
        nodes = self.synthesis.specification.nodes
        found = reasons(self.project, self.evidence, nodes, terms)
        return {node: found[node] for node in terms if node in found}

    def _choices(self, part: Part, most: int) -> list[_OpenChoice]:
        """Return up to `most` other answers of a component, the cheapest first."""
        return [
            _OpenChoice(
                tuple(other.cost.get(level, 0) - part.best.cost.get(level, 0) for level in _LEVELS),
                part,
                other,
            )
            for other in others(part.component, part.best, most, self.deadline)
        ]

    def _alternative(
        self, extra: tuple[int, ...], chosen: Sequence[_OpenChoice], own: Sequence[str]
    ) -> Alternative:
        kept = set(self.synthesis.resolution.answer.decided)
        for choice in chosen:
            kept.difference_update(choice.part.decided(choice.part.best))
        changed = [atom for choice in chosen for atom in choice.part.decided(choice.other)]
        answer = ChosenAnswer(self.analysis.grounding, (*kept, *changed))
        derived = SpecifiedAtoms(self.rulebook, answer)
        specification = specify(self.project, derived)
        changes = list(difflib.ndiff(own, _lines(specification)))
        return Alternative(
            dict(zip(_LEVELS, extra, strict=True)),
            specification,
            tuple(line[2:] for line in changes if line.startswith("+ ")),
            tuple(line[2:] for line in changes if line.startswith("- ")),
        )

    def _needs(
        self, part: Part, found: Sequence[AtomNeed], names: Mapping[clingo.Symbol, str]
    ) -> Iterator[CertificateEntry]:
        symbol_of = self.analysis.grounding.symbol_of
        for need in found:
            numbers = [part.atoms[atom - 1] for atom in need.atoms]
            entries = [symbol_of[number] for number in numbers if number in symbol_of]
            ours = tuple(names[symbol] for symbol in entries if symbol in names)
            yield CertificateEntry(tuple(map(str, entries)), ours)


def _combined(
    parts: Sequence[Sequence[_OpenChoice]],
) -> Iterator[tuple[tuple[int, ...], tuple[_OpenChoice, ...]]]:
    """Yield the costs and choices of all combinations, at most one choice a component, by cost.

    The choices of each component are ordered by cost. Each combination is reached from one
    other only: the one with the previous choice in its last component, or the first choice of
    the component before, or without it (Lawler, A procedure for computing the K best solutions,
    Management Science 1972).
    """
    ordered = sorted((part for part in parts if part), key=lambda part: part[0].extra)
    none = (0,) * len(_LEVELS)

    def made(places: _Places) -> tuple[tuple[int, ...], int, _Places]:
        extras = [ordered[part][index].extra for part, index in places]
        return tuple(map(sum, zip(none, *extras, strict=True))), len(places), places

    waiting = [made(((0, 0),))] if ordered else []
    while waiting:
        extra, _, places = heappop(waiting)
        yield extra, tuple(ordered[part][index] for part, index in places)
        *before, (part, index) = places
        if index + 1 < len(ordered[part]):
            heappush(waiting, made((*before, (part, index + 1))))
        if part + 1 < len(ordered):
            heappush(waiting, made((*places, (part + 1, 0))))
            if index == 0:
                heappush(waiting, made((*before, (part + 1, 0))))


def _lines(specification: Specification) -> list[str]:
    """Return the printed relationships, and the comments of transformers."""
    printed = print_configuration(specification.configuration).splitlines()
    return [line for line in printed if _RELATES.search(line)]


def _costly(part: Part) -> set[int]:
    """Return the open atoms with a cost on the level of nodes."""
    return {atom for at, _, atom in part.component.costs if at == NODES and atom > 0}
