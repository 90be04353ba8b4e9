"""Facts of the input, found by their atoms."""

from collections.abc import Iterable, Iterator, Mapping

import clingo

from mars_asp.atom import Atom, Fact, Term
from mars_asp.source import Span


class GivenFacts(Mapping[clingo.Symbol, Span]):
    """Where each fact comes from, found by its text, for predicates that somebody asks about."""

    def __init__(self, facts: Iterable[Fact]) -> None:
        """Sort facts by their predicates."""
        self._facts: dict[str, list[Fact]] = {}
        for fact in facts:
            self._facts.setdefault(fact.atom.name, []).append(fact)
        self._spans: dict[str, dict[str, Span]] = {}

    def __getitem__(self, atom: clingo.Symbol) -> Span:
        return self._spans_of(atom.name)[str(atom)]

    def __contains__(self, atom: object) -> bool:
        # Most that is asked about is derived, and an exception would be slow.
        return (
            isinstance(atom, clingo.Symbol)
            and atom.name in self._facts
            and str(atom) in self._spans_of(atom.name)
        )

    def __iter__(self) -> Iterator[clingo.Symbol]:
        return (symbol_of(fact.atom) for facts in self._facts.values() for fact in facts)

    def __len__(self) -> int:
        return sum(map(len, self._facts.values()))

    def _spans_of(self, name: str) -> dict[str, Span]:
        if name not in self._facts:
            raise KeyError(name)
        if name not in self._spans:
            self._spans[name] = {str(fact.atom): fact.span for fact in self._facts[name]}
        return self._spans[name]


def symbol_of(atom: Atom) -> clingo.Symbol:
    """Return an atom as clingo's symbol."""
    return clingo.Function(atom.name, [_symbol(term) for term in atom.arguments])


def _symbol(term: Term) -> clingo.Symbol:
    match term:
        case int():
            return clingo.Number(term)
        case str():
            return clingo.String(term)
        case Atom():
            return symbol_of(term)
