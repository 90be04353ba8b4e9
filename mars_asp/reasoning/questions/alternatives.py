"""What else would realise a configuration, what it costs more, and why nothing costs less.

>>> found = alternatives(Reasoner(load_project("config.mars"), load_rulebook()))
>>> [other.extra for other in found.others]
[{30: 1, 20: 0, 10: 2}]
"""

import difflib
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from heapq import heappop, heappush
from itertools import islice
from typing import NamedTuple, TypeAlias

import clingo

from mars_asp.asp.messages import shown
from mars_asp.asp.rules.declarations import Declaration
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.signature import Signature, signature_of
from mars_asp.asp.solve.grounding import Answer, Part
from mars_asp.asp.solve.optimum import COST_LEVEL, Optimum, disjoint_needs, others
from mars_asp.diagnostic import Diagnostic, MarsError, point
from mars_asp.language.print import print_configuration
from mars_asp.reasoning.analysis import Analysis
from mars_asp.reasoning.project import Project
from mars_asp.reasoning.rules import COSTS, NODES
from mars_asp.reasoning.session import Reasoner
from mars_asp.reasoning.synthesis import Derived, Specification, specify
from mars_asp.reasoning.synthesis.synthesise import Synthesis
from mars_asp.spelling import nearest

#: The levels that are a cost, highest first.
_LEVELS = tuple(level for level in COSTS.values() if level >= COST_LEVEL)
#: For each part that another answer is chosen of, in order, its number and that of the answer.
_Places: TypeAlias = tuple[tuple[int, int], ...]
_RELATES = re.compile(r"^//|\b(?:is_mounted_on|is_controlled_by|uses_data_from)\b")


@dataclass(frozen=True, slots=True)
class Alternative:
    """Another realisation: what it costs more, by level, and its lines that differ."""

    extra: Mapping[int, int]
    specification: Specification
    added: tuple[str, ...]
    removed: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Need:
    """Of these possible nodes, told in words, every realisation has one; `names` are in ours."""

    words: tuple[str, ...]
    names: tuple[str, ...]


@dataclass(frozen=True)
class Alternatives:
    """The least specification, others in the order of their cost, and needs that bound the cost.

    `forced` are the nodes that the rules leave no choice about. `needs` have no node in common;
    `open` is how many nodes are left to choice: where it is more than the needs, that fewer do not
    suffice was found by search. `complete` says that there are no further ones.
    """

    synthesis: Synthesis
    analysis: Analysis
    forced: tuple[str, ...]
    needs: tuple[Need, ...]
    open: int
    others: tuple[Alternative, ...]
    complete: bool


def alternatives(
    reasoner: Reasoner, subject: str | None = None, most: int = 5
) -> Alternatives | None:
    """Return other realisations of all, or of the component of a node; `None` where there is none.

    In each component in which one differs from the least specification, it lacks a decision of all
    that are less there, so mere additions are left out.

    Raises:
        MarsError: the subject is not a node of the specification.
        TimeoutError: the time did not suffice.
    """
    deadline = reasoner.budget.deadline()
    evidence, synthesis = reasoner.evidence(resolved=True), reasoner.synthesis
    if synthesis is None:
        return None
    search = _Search(reasoner.project, evidence.analysis, synthesis, reasoner.rulebook, deadline)
    return search.run(subject, most)


class _Choice(NamedTuple):
    """Another answer of one component, and what it costs more at each of `_LEVELS`."""

    extra: tuple[int, ...]
    part: Part
    other: Optimum


@dataclass(frozen=True)
class _Search:
    project: Project
    analysis: Analysis
    synthesis: Synthesis
    rulebook: Rulebook
    deadline: float | None

    def run(self, subject: str | None, most: int) -> Alternatives:
        names = {clingo.parse_term(n.term): n.name for n in self.synthesis.specification.nodes}
        chosen = [atom for atom, name in names.items() if subject in (None, name)]
        if not chosen and subject is not None:
            raise self._no_node(subject, names.values())
        part_of = self.analysis.grounding.part_of
        forced = tuple(names[atom] for atom in chosen if part_of(atom) is None)
        if subject is None:
            parts = list(self.analysis.grounding.parts)
        else:
            parts = [part for atom in chosen if (part := part_of(atom)) is not None]
        found = list(islice(_combined([self._choices(part, most + 1) for part in parts]), most + 1))
        own = _lines(self.synthesis.specification)
        told = [self._told(extra, chosen, own) for extra, chosen in found[:most]]
        needs = [need for part in parts for need in self._needs(part, names)]
        opened = sum(len(_taken(part)) for part in parts)
        return Alternatives(
            self.synthesis,
            self.analysis,
            forced,
            tuple(needs),
            opened,
            tuple(told),
            len(found) <= most,
        )

    def _choices(self, part: Part, most: int) -> list[_Choice]:
        """Return other answers of a component in the order of what they cost more."""
        return [
            _Choice(
                tuple(other.cost.get(level, 0) - cost for level, cost in _costs(part)), part, other
            )
            for other in others(part.component, part.best, most, self.deadline)
        ]

    def _told(
        self, extra: tuple[int, ...], chosen: Sequence[_Choice], own: Sequence[str]
    ) -> Alternative:
        kept = set(self.synthesis.resolution.answer.decided)
        for choice in chosen:
            kept.difference_update(choice.part.decided(choice.part.best))
        changed = [atom for choice in chosen for atom in choice.part.decided(choice.other)]
        answer = Answer(self.analysis.grounding, (*kept, *changed))
        derived = Derived(self.rulebook, answer)
        specification = specify(self.project, derived)
        changes = list(difflib.ndiff(own, _lines(specification)))
        return Alternative(
            dict(zip(_LEVELS, extra, strict=True)),
            specification,
            tuple(line[2:] for line in changes if line.startswith("+ ")),
            tuple(line[2:] for line in changes if line.startswith("- ")),
        )

    def _needs(self, part: Part, names: Mapping[clingo.Symbol, str]) -> Iterator[Need]:
        declared = self.rulebook.declarations
        symbol_of = self.analysis.grounding.symbol_of
        for atoms in disjoint_needs(part.component, NODES, self.deadline):
            told = [
                symbol_of[number] for atom in atoms if (number := part.atoms[atom - 1]) in symbol_of
            ]
            yield Need(
                tuple(_words(symbol, declared) for symbol in told),
                tuple(names[symbol] for symbol in told if symbol in names),
            )

    def _no_node(self, subject: str, names: object) -> MarsError:
        known = [node.name for node in self.synthesis.specification.nodes]
        near = nearest(subject, known)
        place = point(self.project.configuration.path, 1, 1)
        help_text = f"did you mean `{near}`?" if near else f"one of {', '.join(known) or 'none'}"
        message = f"`{subject}` is not a node of the specification"
        return MarsError((Diagnostic("subject", "error", message, place, help=help_text),))


def _combined(
    parts: Sequence[Sequence[_Choice]],
) -> Iterator[tuple[tuple[int, ...], tuple[_Choice, ...]]]:
    """Yield what choices cost together and the choices, one at most of each part, cheapest first.

    Each part's choices are in the order of their cost. A combination is found from one other alone:
    that in which its last choice was the one before, or the first one of the part before, or was
    not made (Lawler, A procedure for computing the K best solutions, Management Science 1972).
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
    """Return the relationships and the comments of transformers, as they are printed."""
    printed = print_configuration(specification.configuration).splitlines()
    return [line for line in printed if _RELATES.search(line)]


def _costs(part: Part) -> list[tuple[int, int]]:
    """Return the levels that are a cost, highest first, with what the optimum costs there."""
    return [(level, part.best.cost.get(level, 0)) for level in _LEVELS]


def _taken(part: Part) -> set[int]:
    """Return the atoms of the optimum that cost a node and were open."""
    return {a for at, _, a in part.component.costs if at == NODES and a in part.best.true}


def _words(symbol: clingo.Symbol, declared: Mapping[Signature, Declaration]) -> str:
    """Return what is declared of a predicate, with an atom's arguments for its variables."""
    known = declared.get(signature_of(symbol))
    if known is None:
        return str(symbol)
    names = (argument.name for argument in known.arguments)
    values = dict(zip(names, map(shown, symbol.arguments), strict=True))
    pattern = "|".join(rf"(?<!\w){re.escape(name)}(?![\w'])" for name in values)
    return re.sub(pattern, lambda match: f"`{values[match[0]]}`", known.words).split(".")[0]
