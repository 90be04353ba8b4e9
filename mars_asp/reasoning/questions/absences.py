"""Why modules lack nodes and consequences of each kind, in one query.

The sentences are those of `why_not`. Changes that would give one, and their costs, are not
searched, as each change would need a trial of its own.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import clingo

from mars_asp.asp.signature import signature_of
from mars_asp.asp.solve.term_ids import as_term
from mars_asp.asp.trace.patterns import fits
from mars_asp.diagnostic import Span
from mars_asp.model.declarations import node_names
from mars_asp.reasoning.analysis import read_consequences
from mars_asp.reasoning.findings import consequence_kinds
from mars_asp.reasoning.questions.absence_query import at_module
from mars_asp.reasoning.questions.blame import reasons
from mars_asp.reasoning.questions.connected import BY_TYPE, connected_part
from mars_asp.reasoning.questions.explain import Sort
from mars_asp.reasoning.questions.why_not import (
    RESOLVES,
    circles,
    holds,
    is_there,
    node_term,
    unrealised_answer,
)
from mars_asp.reasoning.session import Evidence, Reasoner
from mars_asp.reasoning.synthesis import IntroducedNode
from mars_asp.reasoning.synthesis.synthesise import Synthesis

#: Answers about larger robots are more than users read, in HTML reports too large to open.
MOST_MODULES = 2_000


@dataclass(frozen=True, slots=True)
class Absence:
    """Why a module lacks a node or consequence of a kind, or that it has one.

    `evidence` are the lines that the answer cites; `present` is the name of an existing one.
    """

    kind: str
    module: str
    answer: str
    evidence: tuple[Span, ...] = ()
    present: str | None = None

    @property
    def title(self) -> str:
        """Return the absent thing as `KIND(MODULE)`."""
        return f"{self.kind}({self.module})"


def absences(
    reasoner: Reasoner, modules: Sequence[str], only: Sort | None = None
) -> Iterator[Absence]:
    """Yield the absent nodes and consequences of modules with the reasons; `only` selects one sort.

    Kinds without a rule in `rules/absence`, such as those of rule packs, are left out, and for a
    subset of the modules also kinds that depend on the whole. Above `MOST_MODULES` there are none.
    For consequences alone no specification is searched.

    Raises:
        MarsError: clingo refuses the rules.
        TimeoutError: no specification was found in time.
    """
    names = frozenset(modules)
    unknown: frozenset[str] = frozenset()
    if len(names) < len(reasoner.project.configuration.modules) and not reasoner.rulebook.packs:
        part = connected_part(reasoner.project, names)
        reasoner = Reasoner(part, reasoner.rulebook, reasoner.budget)
        unknown = BY_TYPE
    if not names or len(reasoner.project.configuration.modules) > MOST_MODULES:
        return
    resolving = only != "consequences"
    evidence = reasoner.evidence(resolved=resolving)
    synthesis = reasoner.synthesis if resolving else None
    words = node_names(reasoner.project.configuration.kinds)
    kinds: list[str] = [*words] if resolving else []
    there: dict[tuple[str, str], Absence] = {}
    if only != "nodes":
        kinds += sorted(consequence_kinds(reasoner.rulebook) - unknown)
        there.update(_consequences(evidence))
    if synthesis is not None:
        there.update(_nodes(evidence, synthesis, words, modules))
    because = {
        (kind, module): found
        for kind, module, found in reasons(reasoner.project, reasoner.rulebook, kinds, modules)
    }
    unrealised = resolving and synthesis is None
    against = unrealised_answer("", evidence, evidence.analysis) if unrealised else None
    elsewhere = frozenset(circles(evidence.analysis))
    for module in modules:
        for kind in kinds:
            key, word = (kind, module), words.get(kind, kind)
            title, found = f"{word}({module})", because.get((kind, module))
            if key in there:
                yield there[key]
            elif kind in words and against is not None:
                answer = against.answer.replace("No ", f"No {title}", 1)
                yield Absence(word, module, answer, against.evidence)
            elif found is not None:
                start = (
                    f"{title} is there under another name" if key in elsewhere else f"No {title}"
                )
                yield Absence(word, module, f"{start}: {found.because}.", found.evidence)


def _consequences(evidence: Evidence) -> Iterator[tuple[tuple[str, str], Absence]]:
    found = read_consequences(evidence.analysis, participants=False)
    # Of equal keys the last remains, which is the one that `why_not` finds first.
    for each in sorted(found, key=lambda each: each.atom, reverse=True):
        title = f"{each.kind}({each.subject})"
        answer = holds(title, each.message)
        yield (
            (each.kind, each.subject),
            Absence(each.kind, each.subject, answer, each.spans, title),
        )


def _nodes(
    evidence: Evidence, synthesis: Synthesis, words: Mapping[str, str], modules: Sequence[str]
) -> Iterator[tuple[tuple[str, str], Absence]]:
    """Yield the existing nodes at modules or for their consequences, by kind and module.

    `words` are the names of kinds in answers.
    """
    specification = synthesis.specification
    resolving: dict[tuple[str, str], IntroducedNode] = {}
    for node in specification.nodes:
        for topic in specification.resolves[node.name]:
            resolving.setdefault((node.kind, topic), node)
    by_term = {node.term: node for node in specification.nodes}
    held = _true_nodes(evidence, synthesis, words)
    for kind, word in words.items():
        for module in modules:
            atoms = (
                atom
                for pattern in at_module(kind, clingo.String(module))
                for atom in held.get((pattern.name, pattern.arguments[0]), ())
                if fits(pattern, atom)
            )
            atom = next(atoms, None)
            found = resolving.get((kind, f"{RESOLVES.get(kind)}({module})"))
            if atom is not None:
                found = by_term.get(node_term(atom, kind))
            if atom is not None or found is not None:
                resolves = () if found is None else specification.resolves[found.name]
                answer = is_there(f"{word}({module})", resolves)
                name = None if found is None else found.name
                yield (kind, module), Absence(word, module, answer, (), name or word)


def _true_nodes(
    evidence: Evidence, synthesis: Synthesis, kinds: Iterable[str]
) -> Mapping[tuple[str, clingo.Symbol], Sequence[clingo.Symbol]]:
    """Return the true atoms of nodes of some kinds, by predicate name and first argument."""
    grounding, taken = evidence.analysis.grounding, synthesis.resolution.taken
    held: dict[tuple[str, clingo.Symbol], list[clingo.Symbol]] = {}
    patterns = [pattern for kind in kinds for pattern in at_module(kind, clingo.String(""))]
    for signature in dict.fromkeys(map(signature_of, patterns)):
        if signature in synthesis.derived.predicates:
            synthesis.derived.hand_to(grounding)
        for atom, is_fact in sorted(grounding.atoms(signature.name, signature.arity)):
            if is_fact or as_term(atom) in taken:
                held.setdefault((atom.name, atom.arguments[0]), []).append(atom)
    return held
