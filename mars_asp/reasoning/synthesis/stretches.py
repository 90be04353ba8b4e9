"""The stretches of a configuration that can be resolved apart, in the order of the file.

Modules belong to one island when facts connect them. A stretch is a run of relationships that holds
whole islands only, so what is named in it has no number that depends on later stretches.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass, field
from functools import cached_property

from mars_asp.asp.rules.symbols import symbol_of
from mars_asp.asp.signature import Signature
from mars_asp.asp.slice.portions import Portion
from mars_asp.asp.solve.atoms import Atom, Fact
from mars_asp.asp.solve.disjoint_sets import DisjointSets
from mars_asp.asp.solve.grounding import Grounding
from mars_asp.asp.solve.term_ids import TermId, arguments, as_term, atoms
from mars_asp.model.declarations import Relationship, ends_of
from mars_asp.reasoning.facts.vocabulary import Vocabulary

#: A stretch has at least this share of all relationships, for each takes time of its own.
_MOST = 64
#: So many stretches are passed over together.
_TOGETHER = 8


@dataclass(frozen=True)
class Stretches:
    """The relationships of each stretch, in their order, and what is in it."""

    relationships: tuple[Sequence[Relationship], ...]
    #: By the name or identifier of what is in a stretch, the number of the stretch from 0.
    _number_of: Mapping[int | str, int]
    _connected: Mapping[Signature, tuple[int, ...]]

    def facts(
        self, number: int, facts: Iterable[Fact], everywhere: Set[Signature]
    ) -> Iterator[Fact]:
        """Yield the facts about one stretch, and those that are about none or `everywhere`."""
        for fact in facts:
            told = fact.atom.arguments
            signature = Signature(fact.atom.name, len(told))
            connected = self._connected.get(signature)
            if not connected or signature in everywhere:
                yield fact
            elif isinstance(part := told[connected[0]], Atom) or part not in self._number_of:
                continue
            elif self._number_of[part] == number:
                yield fact

    def before_last(self) -> Iterator[range]:
        """Yield the stretches but the last one, in their order: the first alone, then several."""
        begin, last = 0, len(self.relationships) - 1
        while begin < last:
            yield range(begin, min(begin + min(begin + 1, _TOGETHER), last))
            begin += min(begin + 1, _TOGETHER)

    @cached_property
    def by_term(self) -> Mapping[TermId, int]:
        """Return the numbers of stretches by the terms of what is in them."""
        return {as_term(symbol_of(name)): number for name, number in self._number_of.items()}


@dataclass(frozen=True)
class Divided:
    """The consequences in a grounding, by the stretches that they are about."""

    stretches: Stretches
    grounding: Grounding
    _found: dict[Signature, tuple[list[TermId], ...]] = field(default_factory=dict)

    def ground(self, numbers: Iterable[int], portion: Portion) -> Grounding:
        """Return a grounding of what a portion of the resolution reads about some stretches."""
        stated: dict[Signature, Sequence[TermId]] = {}
        for signature, at in portion.of_parts.items():
            if signature not in self._found:
                self._found[signature] = self._apart(signature, at)
            stated[signature] = [atom for n in numbers for atom in self._found[signature][n]]
        for signature in portion.of_all:
            stated[signature] = atoms(self.grounding.control, *signature)
        return Grounding((), stated)

    def _apart(self, signature: Signature, at: int) -> tuple[list[TermId], ...]:
        number_of = self.stretches.by_term
        found: tuple[list[TermId], ...] = tuple([] for _ in self.stretches.relationships)
        for atom in atoms(self.grounding.control, *signature):
            number = number_of.get(arguments(atom)[at])
            if number is not None:
                found[number].append(atom)
        return found


def stretches(
    relationships: Sequence[Relationship], facts: Iterable[Fact], vocabulary: Vocabulary
) -> Stretches:
    """Cut relationships into stretches; one alone has them all where no cut can be made.

    `facts` are those of the configuration.
    """
    parts: DisjointSets[int | str] = DisjointSets()
    for fact in facts:
        told = fact.atom.arguments
        connected = vocabulary.connected.get(Signature(fact.atom.name, len(told)), ())
        if len(connected) > 1:
            parts.join([value for at in connected if not isinstance(value := told[at], Atom)])
    roots = [parts.find(ends_of(each)[0]) for each in relationships]
    ends = tuple(_ends(roots))
    cut = tuple(relationships[start:end] for start, end in zip((0, *ends), ends, strict=False))
    each = (number for number, stretch in enumerate(cut) for _ in stretch)
    number_of_root = dict(zip(roots, each, strict=True))
    number_of = {
        member: number_of_root[root]
        for member in parts.parent
        if (root := parts.find(member)) in number_of_root
    }
    return Stretches(cut, number_of, vocabulary.connected)


def _ends(roots: Sequence[int | str]) -> Iterator[int]:
    """Yield where stretches end, so that no island is in two of them."""
    last = {root: place for place, root in enumerate(roots, 1)}
    furthest = start = 0
    for place, root in enumerate(roots, 1):
        furthest = max(furthest, last[root])
        if furthest == place and (_MOST * (place - start) >= len(roots) or place == len(roots)):
            yield place
            start = place
