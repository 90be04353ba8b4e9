"""Well-founded traces of minimal height for the atoms of a query."""

import re
from collections.abc import Iterable, Mapping, Sequence
from types import MappingProxyType

import clingo

from mars_asp.asp.rules.dependencies import dependencies_of, reachable_rules
from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.signature import Signature
from mars_asp.asp.solve.term_ids import TermId, arguments, as_symbol, as_term, atoms, state
from mars_asp.asp.trace.firing_rules import QUESTION, Rewriter, asking_name
from mars_asp.asp.trace.firings import Firing, read_firings
from mars_asp.asp.trace.given import GivenFacts
from mars_asp.asp.trace.proofs import Proofs
from mars_asp.asp.trace.tree import Trace

_COPIED = re.compile(r"_t_(\w+)")


class Explainer:
    """Returns traces of atoms in one grounding and one answer."""

    def __init__(
        self,
        rulebook: Rulebook,
        control: clingo.Control,
        given: GivenFacts,
        opened: Mapping[Signature, Sequence[TermId]] = MappingProxyType({}),
    ) -> None:
        """Prepare for questions.

        `control` holds the grounded rules of `rulebook`; `given` are the facts of the input;
        `opened` are the true atoms of each predicate that has atoms which are not facts of the
        grounding. The first question detaches the solver from `control`, which cannot search for
        answers any more.
        """
        self.rules: Sequence[Rule] = rulebook.rules
        self._rulebook = rulebook
        self.rewriter = Rewriter(frozenset(Signature(name, arity) for name, arity, _ in opened))
        self._control = control
        self.given = given
        self._opened = opened
        self._question = 0
        self._copied: set[Signature] = set()

    def why(
        self, atoms: Iterable[clingo.Symbol], every: bool = False
    ) -> dict[clingo.Symbol, Trace]:
        """Return the trace of each of some true atoms; with `every`, with other derivations.

        One grounding finds all firings of the derivations; traces share common steps.
        """
        queries = tuple(atoms)
        unsupported = self.rewriter.unsupported
        # As an iterator, so that the firings can be freed while they are read.
        proofs = Proofs(iter(self._ask(queries)), self.given, self.rules, unsupported, every)
        return {atom: proofs.of(atom) for atom in queries}

    def _ask(self, atoms: Sequence[clingo.Symbol]) -> list[Firing]:
        queries: dict[str, list[TermId]] = {}
        firsts: dict[str, set[TermId | None]] = {}
        for atom in atoms:
            name, term = atom.name if atom.positive else f"-{atom.name}", as_term(atom)
            queries.setdefault(asking_name(name), []).append(term)
            firsts.setdefault(name, set()).add(next(iter(arguments(term)), None))
        entries = {
            name: frozenset("" if term is None else str(as_symbol(term)) for term in terms)
            for name, terms in firsts.items()
        }
        rules = dependencies_of(rule.text for rule in self.rules)
        numbers = reachable_rules(rules, entries, self._present(), self._rulebook.replaced)
        return self.firings(self.rewriter.text(self.rules, numbers), queries)

    def firings(self, text: str, queries: Mapping[str, Sequence[TermId]]) -> list[Firing]:
        """Return the firings that explanation rules find.

        The rules are grounded as a separate program part whose predicates have unique names, so
        that earlier rules cannot match. The part begins with facts of the predicates of `queries`,
        with the arguments of the given terms.
        """
        if not self._question:
            # Only the atoms matter, and passing the rules to the solver is most of the cost.
            self._control.register_observer(clingo.Observer(), replace=True)
        self._copy_open(text)
        self._question += 1
        question = str(self._question)
        part = f"_explain{question}"
        self._control.add(part, [], text.replace(QUESTION, question))
        numbered = {name.replace(QUESTION, question): terms for name, terms in queries.items()}
        state(self._control, {(name, True): terms for name, terms in numbered.items()})
        self._control.ground([(part, [])])
        return read_firings(self._control, self._question)

    def _present(self) -> frozenset[str]:
        """Return the names of the predicates that have an atom."""
        atoms = self._control.symbolic_atoms
        found = [signature for signature, true in self._opened.items() if true]
        for each in atoms.signatures:
            if any(True for _ in atoms.by_signature(*each)):
                found.append(Signature(*each))
        return frozenset(signature.signed for signature in found)

    def _copy_open(self, text: str) -> None:
        """Add copies of the open predicates' true atoms that the rules in a text read, once."""
        named = set(_COPIED.findall(text))
        copied = {each for each in self.rewriter.open if each.name in named}
        declared: dict[tuple[str, bool], list[TermId]] = {}
        for name, arity, _ in sorted(copied - self._copied):
            for positive in (True, False):
                true = self._opened.get(Signature(name, arity, positive))
                if true is None:
                    true = atoms(self._control, name, arity, positive)
                declared.setdefault((f"_t_{name}", positive), []).extend(true)
        state(self._control, declared)
        self._copied |= copied
