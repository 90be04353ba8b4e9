"""Facts of the input, found by their atoms."""

from collections.abc import Iterable, Mapping, Set
from types import MappingProxyType

from mars_asp.asp.rules.declarations import Origin
from mars_asp.asp.signature import Signature
from mars_asp.asp.solve import term_ids
from mars_asp.asp.solve.atoms import Fact
from mars_asp.asp.trace.tree import Given
from mars_asp.diagnostic import Span


class GivenFacts:
    """The facts of the input by their texts, for predicates that somebody asks about."""

    def __init__(
        self,
        facts: Iterable[Fact],
        origins: Mapping[Signature, Origin] = MappingProxyType({}),
    ) -> None:
        """Sort facts by their predicates; `origins` says where those are from."""
        self._origins = origins
        self._facts: dict[str, list[Fact]] = {}
        for fact in facts:
            self._facts.setdefault(fact.atom.name, []).append(fact)
        self._spans: dict[str, dict[str, Span]] = {}

    @property
    def predicates(self) -> Set[str]:
        """Return the names of the predicates that have a fact."""
        return self._facts.keys()

    def leaf(self, atom: term_ids.TermId) -> Given | None:
        """Return an atom with its place; `None` where no fact gives it."""
        written = term_ids.text(atom)
        name = written.partition("(")[0]
        if name not in self._facts:
            return None
        if name not in self._spans:
            self._spans[name] = {str(fact.atom): fact.span for fact in self._facts[name]}
        span = self._spans[name].get(written)
        if span is None:
            return None
        if not self._origins:
            return Given(written, span)
        signature = Signature(name, len(term_ids.arguments(atom)))
        return Given(written, span, self._origins.get(signature, "stated"))
