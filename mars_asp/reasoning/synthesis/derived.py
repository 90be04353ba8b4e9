"""The atoms that `rules/specify` derives from an answer: a specification with unnamed nodes."""

from collections.abc import Mapping, Sequence
from functools import cache, cached_property

from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.signature import Signature
from mars_asp.asp.solve.grounding import ChosenAnswer, Grounding
from mars_asp.asp.solve.term_ids import TermId, arguments, as_symbol, atoms, text
from mars_asp.reasoning.rules import FOLLOWING

#: The stage that follows the resolution.
STAGE = FOLLOWING["resolve"]
_NODE = Signature("spec_node", 2)


class SpecifiedAtoms:
    """The atoms that the rules of `STAGE` derive from the true atoms of an answer."""

    def __init__(self, rulebook: Rulebook, answer: ChosenAnswer) -> None:
        """Ground the rules over the atoms that they read; no search is needed.

        Raises:
            MarsError: the rules are refused, or there is no such answer.
        """
        rules = [rule for rule in rulebook.rules if rule.stage == STAGE]
        #: The predicates that the rules derive.
        self.predicates = frozenset().union(*(rule.heads for rule in rules))
        read = frozenset().union(*(rule.reads for rule in rules)) - self.predicates
        self._grounding = Grounding((), answer.true_of(sorted(read)))
        self._grounding.derive(rulebook.fragments(STAGE))
        #: The texts of terms and strings; cached, as few terms occur in very many atoms.
        self.text, self.string = cache(text), cache(lambda term: as_symbol(term).string)

    def hand_to(self, grounding: Grounding) -> None:
        """Add the derived atoms to the grounding of the answer, so that it can explain them."""
        control = self._grounding.control
        found = sorted(self.predicates)
        grounding.state({signature: atoms(control, *signature) for signature in found})

    def atoms(self, predicate: Signature) -> Sequence[TermId]:
        """Return the atoms of a predicate that the rules of `STAGE` derived."""
        return atoms(self._grounding.control, *predicate)

    def rows(self, name: str, arity: int) -> list[Sequence[TermId]]:
        """Return, for each derived atom of the predicate `name`/`arity`, its arguments."""
        return [arguments(atom) for atom in atoms(self._grounding.control, name, arity, True)]

    def of_each(self, name: str) -> dict[TermId, TermId]:
        """Return the second argument of a binary predicate by the first."""
        return {thing: item for thing, item in self.rows(name, 2)}

    @cached_property
    def kinds(self) -> Mapping[TermId, str]:
        """Return the kind of each introduced node, by the term of the node."""
        return {node: self.text(kind) for node, kind in self.rows(_NODE.name, _NODE.arity)}

    @cached_property
    def stands_for(self) -> Mapping[TermId, str]:
        """Return the module that each InheritanceNode represents."""
        return {node: self.string(module) for node, module in self.rows("spec_stands_for", 2)}

    @cached_property
    def converts(self) -> Mapping[TermId, tuple[str, str]]:
        """Return the two representations of each transformer: source and target."""
        rows = self.rows("spec_converts", 3)
        return {node: (self.string(source), self.string(target)) for node, source, target in rows}

    @cached_property
    def annotations(self) -> Mapping[TermId, int]:
        """Return the identifier of the annotation of each transformer's conversion."""
        rows = self.rows("does_conversion", 2)
        return {node: as_symbol(annotation).number for node, annotation in rows}

    @cached_property
    def resolved(self) -> Mapping[TermId, tuple[str, ...]]:
        """Return the consequences that each node resolves, in alphabetical order."""
        found: dict[TermId, set[str]] = {}
        for node, kind, subject in self.rows("resolves", 3):
            found.setdefault(node, set()).add(f"{self.text(kind)}({self.string(subject)})")
        return {node: tuple(sorted(words)) for node, words in found.items()}


def decided_by(rulebook: Rulebook, kind: str) -> Signature | None:
    """Return the predicate that decides the nodes of a kind, or None if no single one does."""
    found = [
        [literal.signature for literal in statement.read]
        for rule in rulebook.rules
        if rule.stage == STAGE and rule.derives(_NODE)
        for statement in rule.statements
        if statement.head.signature == _NODE and statement.head.terms[1].constant == kind
    ]
    return found[0][0] if list(map(len, found)) == [1] else None
