"""Facts of the input by their atoms, with the declarations of their predicates."""

from collections.abc import Iterable, Mapping, Set
from types import MappingProxyType

from mars_asp.asp.rules.declarations import Declaration
from mars_asp.asp.signature import Signature
from mars_asp.asp.solve import term_ids
from mars_asp.asp.solve.atoms import Fact
from mars_asp.asp.trace.sentences import Sentences
from mars_asp.asp.trace.tree import Absent, Given, SentenceRenderer, Trace
from mars_asp.diagnostic import Span


class GivenFacts:
    """The facts of the input by their texts, indexed when their predicate is first needed."""

    def __init__(
        self,
        facts: Iterable[Fact],
        declarations: Mapping[Signature, Declaration] = MappingProxyType({}),
        externals: Mapping[str, Span] = MappingProxyType({}),
    ) -> None:
        """Group facts by predicate; `declarations` give their origins and sentences.

        `externals` are the locations of external atoms, by their texts.
        """
        self._externals = externals
        self._facts: dict[str, list[Fact]] = {}
        for fact in facts:
            self._facts.setdefault(fact.atom.name, []).append(fact)
        self._by_text: dict[str, dict[str, Fact]] = {}
        self._declared = declarations
        self._sentences = Sentences(declarations, self._facts)
        uncited = [s for s, each in declarations.items() if not each.cited]
        self._uncited = {*((s.name, s.arity) for s in uncited), *(s.name for s in uncited)}

    @property
    def predicates(self) -> Set[str]:
        """Return the names of the predicates that have a fact."""
        return self._facts.keys()

    def leaf(self, atom: term_ids.TermId) -> Given | None:
        """Return the leaf for an atom that is a fact of the input, else None."""
        written = term_ids.text(atom)
        name = written.partition("(")[0]
        if name not in self._facts:
            return None
        if name not in self._by_text:
            self._by_text[name] = {str(fact.atom): fact for fact in self._facts[name]}
        fact = self._by_text[name].get(written)
        if fact is None:
            return None
        declared = self._declared.get(Signature(name, len(fact.atom.arguments)))
        origin = "stated" if declared is None or declared.origin is None else declared.origin
        words = None if declared is None else SentenceRenderer(self._sentences, fact.atom, declared)
        is_external = written in self._externals
        return Given(written, fact.span, "external" if is_external else origin, words)

    def absence(self, pattern: term_ids.TermId, written: str) -> Absent | None:
        """Return the absence of all atoms of a pattern, or None if their predicate is never cited.

        `written` is the text of the pattern.
        """
        name = written.partition("(")[0]
        if name in self._uncited and (name, len(term_ids.arguments(pattern))) in self._uncited:
            return None
        return Absent(written, self.words_of_absence(pattern), self.external(written))

    def external(self, written: str) -> Span | None:
        """Return the location of the `#external` statement of an atom, or None without one."""
        return self._externals.get(written)

    def words_of_absence(self, pattern: term_ids.TermId) -> SentenceRenderer | None:
        """Return the renderer of the sentence of an absence, None without declarations."""
        return SentenceRenderer(self._sentences, pattern) if self._declared else None


def is_cited(leaf: Trace) -> bool:
    """Whether a leaf counts as a reason; facts about the notation alone do not."""
    declared = leaf.words.declared if isinstance(leaf, Given) and leaf.words is not None else None
    return declared is None or declared.cited
