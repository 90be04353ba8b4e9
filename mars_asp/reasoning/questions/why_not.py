"""Why an atom, node or consequence is not there, and what it would cost to have it.

>>> reasoner = Reasoner(load_project("config.mars"), load_rulebook())
>>> answer = why_not(reasoner, "DataSplitter(FeelForce)")
>>> answer.trace.attempts[0].fails
"2 <= { at(R,S,T); edge(S,T,T',A) }"
"""

import re
import time
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace

import clingo

from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.rules.statements import constants_of, defined
from mars_asp.asp.rules.symbols import symbol_of
from mars_asp.asp.signature import Signature, signature_of
from mars_asp.asp.solve.atoms import Fact
from mars_asp.asp.solve.term_ids import as_term
from mars_asp.asp.trace import absence
from mars_asp.asp.trace.patterns import fits, hole, is_hole, pattern_in, shown_pattern
from mars_asp.asp.trace.tree import Absent, Missing, Trace
from mars_asp.diagnostic import Diagnostic, MarsError, point
from mars_asp.model.declarations import NODE_NAMES, node_kind
from mars_asp.reasoning.analysis import Analysis
from mars_asp.reasoning.findings import consequence_kinds, kinds_of
from mars_asp.reasoning.project import Project
from mars_asp.reasoning.questions.subject import wrong_subject
from mars_asp.reasoning.session import Reasoner
from mars_asp.reasoning.synthesis.synthesise import UNRESOLVABLE, Synthesis, is_resolved
from mars_asp.spelling import nearest

#: The atoms of `rules/resolve` that stand for a node at a module, by its kind.
_AT_MODULE: dict[str, Callable[[clingo.Symbol], clingo.Symbol]] = {
    "data_splitter": lambda name: clingo.Function("splitter", [name, hole()]),
    "data_transformer": lambda name: clingo.Function("transformer", [name, hole()]),
    "arbitration_node": lambda name: clingo.Function(
        "receives", [name, clingo.Function("run", [hole()])]
    ),
    "control_splitter": lambda name: clingo.Function(
        "control_splitter", [hole() if is_hole(name) else clingo.Function("base", [name])]
    ),
    "inheritance_node": lambda name: clingo.Function("inheritance_node", [name]),
}
_CALL = re.compile(r'\s*(\w+)\s*(?:\(\s*(?:"([^"]*)"|([^",()]*?))\s*\))?\s*')
#: Of many atoms that would do, so many are tried for the cheapest realisation.
MOST_TRIED = 100


@dataclass(frozen=True)
class WhyNot:
    """The answer: `present` where it holds after all.

    `extra` is what the cheapest realisation with `offered` costs more, by level; `None` where no
    realisation has such an atom, or where it is nothing that is chosen. `choosable` tells these
    two apart. `obstacles` are the traces of what stands against every specification, where that is
    why there is nothing.
    """

    subject: str
    atom: str
    trace: Trace
    present: bool
    choosable: bool
    offered: str | None
    extra: Mapping[int, int] | None
    analysis: Analysis
    obstacles: tuple[Trace, ...] = ()


def why_not(reasoner: Reasoner, subject: str, depth: int = 8) -> WhyNot:
    """Explain an absence: of an atom, `KIND(NAME)` of a consequence, or `NODE(NAME)` of a node.

    Variables of an atom, and `_` for a name, stand for any value. A node may be named as well.

    Raises:
        MarsError: the subject names no predicate, kind, node or constant that there is.
        TimeoutError: no specification was found in time.
    """
    project, rulebook, seconds = reasoner.project, reasoner.rulebook, reasoner.seconds
    deadline = None if seconds is None else time.monotonic() + seconds
    vocabulary = _Vocabulary(project, rulebook, reasoner.facts)
    pattern = None if vocabulary.is_node(subject) else vocabulary.pattern(subject)
    analysis, synthesis = reasoner.analysis, None
    choosable = pattern is None or is_resolved(rulebook, signature_of(pattern))
    if choosable:
        analysis, synthesis = reasoner.resolved
        if synthesis is None:
            explainer = reasoner.resolution_explainer
            against = sorted(analysis.grounding.symbols(UNRESOLVABLE.name, UNRESOLVABLE.arity))
            obstacles = tuple(explainer.why(against).values())
            shown = subject if pattern is None else shown_pattern(pattern)
            return WhyNot(
                subject, shown, Absent(shown), False, True, None, None, analysis, obstacles
            )
    if pattern is None:
        assert synthesis is not None
        pattern = _node_term(subject, project, synthesis)
    resolution = None if synthesis is None else synthesis.resolution
    if synthesis is not None and signature_of(pattern) in synthesis.derived.predicates:
        # It follows from the answer that was found; nobody looks for another one.
        synthesis.derived.hand_to(analysis.grounding)
        explainer, choosable = reasoner.resolution_explainer, False
    else:
        explainer = reasoner.resolution_explainer if choosable else reasoner.explainer
    atoms = list(analysis.grounding.atoms(pattern.name, len(pattern.arguments)))
    matching = [(atom, is_fact) for atom, is_fact in atoms if fits(pattern, atom)]
    taken = frozenset() if resolution is None else resolution.taken
    for atom, is_fact in sorted(matching):
        if is_fact or as_term(atom) in taken:
            trace = explainer.why([atom])[atom]
            return WhyNot(subject, str(atom), trace, True, choosable, None, None, analysis)
    shown = shown_pattern(pattern)
    trace = _of_named_kind(absence.why_not(explainer, pattern, depth), pattern)
    offered, extra = None, None
    if synthesis is not None and choosable:
        offered, extra = _cheapest(synthesis, analysis, [atom for atom, _ in matching], deadline)
    return WhyNot(subject, shown, trace, False, choosable, offered, extra, analysis)


def _node_term(name: str, project: Project, synthesis: Synthesis) -> clingo.Symbol:
    """Return what the node of a name stands for.

    Raises:
        MarsError: there is no node of that name, which only counts nodes: ask where one is missing.
    """
    nodes = synthesis.specification.nodes
    for node in nodes:
        if node.name == name:
            return clingo.parse_term(node.term)
    kind = node_kind(name)
    assert kind is not None
    same = [node.name for node in nodes if node.kind == kind]
    there = f"there is {', '.join(same)}" if same else "there is none of this kind"
    word = NODE_NAMES[kind]
    raise wrong_subject(
        project,
        f"no node is named `{name}`: {there}",
        f"ask where one is missing: `{word}(NAME)` for a module NAME, or `{word}(_)` for any",
    )


def _of_named_kind(trace: Trace, pattern: clingo.Symbol) -> Trace:
    """Leave out rules that could give any kind of consequence where others name the one asked."""
    if pattern.name != "consequence" or not isinstance(trace, Missing):
        return trace
    named = tuple(a for a in trace.attempts if kinds_of(a.rule) is not None)
    return replace(trace, attempts=named or trace.attempts)


def _cheapest(
    synthesis: Synthesis,
    analysis: Analysis,
    atoms: Iterable[clingo.Symbol],
    deadline: float | None,
) -> tuple[str | None, Mapping[int, int] | None]:
    """Return which of some atoms costs least to have, and what that costs more."""
    best: tuple[list[int], str, Mapping[int, int]] | None = None
    for atom in sorted(atoms)[:MOST_TRIED]:
        extra = analysis.grounding.extra_cost(atom, deadline)
        if extra is None:
            continue
        # From the highest level down: nodes before conversions before lines.
        key = [extra[level] for level in sorted(extra, reverse=True)]
        if best is None or (key, str(atom)) < best[:2]:
            best = (key, str(atom), extra)
    return (None, None) if best is None else (best[1], best[2])


class _Vocabulary:
    """What a subject may name."""

    def __init__(self, project: Project, rulebook: Rulebook, facts: Iterable[Fact]) -> None:
        self._path = project.configuration.path
        self._predicates = {head for rule in rulebook.rules for head in rule.heads}
        self._kinds = consequence_kinds(rulebook)
        self._any_kind = any(kinds_of(rule) is None for rule in rulebook.rules)
        self._constants: set[str] = set()
        self._strings: set[str] = {name.text for name in project.configuration.modules}
        for found in constants_of(rule.text for rule in rulebook.rules).values():
            self._constants |= found.names
            self._strings |= found.strings
        for _, text in rulebook.texts:
            self._predicates |= defined(text)
        for fact in facts:
            symbol = symbol_of(fact.atom)
            self._predicates.add(signature_of(symbol))
            self._note(symbol)

    def _note(self, symbol: clingo.Symbol) -> None:
        if symbol.type == clingo.SymbolType.String:
            self._strings.add(symbol.string)
        elif symbol.type == clingo.SymbolType.Function:
            self._constants.add(symbol.name)
            for argument in symbol.arguments:
                self._note(argument)

    def is_node(self, subject: str) -> bool:
        """Say whether a subject is the name of a node, and of no module."""
        return (
            node_kind(subject) is not None
            and subject not in NODE_NAMES.values()
            and subject not in self._strings
        )

    def pattern(self, subject: str) -> clingo.Symbol:
        """Return what a subject asks for."""
        call = _CALL.fullmatch(subject)
        if call is not None:
            name = call[2] if call[2] is not None else call[3]
            words = {word: kind for kind, word in NODE_NAMES.items()}
            kind = words.get(call[1], call[1])
            if kind in _AT_MODULE and subject not in self._strings:
                return _AT_MODULE[kind](self._about(name))
            if self._is_kind(call[1]):
                kind_term = clingo.Function(call[1])
                return clingo.Function(
                    "consequence", [kind_term, hole(), self._about(name), hole()]
                )
            if not self._is_predicate(call[1]):
                raise self._unknown_predicate(call[1])
        return self._atom(subject)

    def _about(self, name: str | None) -> clingo.Symbol:
        return hole() if name in (None, "", "_") else self._string(name or "")

    def _is_kind(self, name: str) -> bool:
        """Say whether rules name a kind, or one that derives any kind could mean it."""
        if name in self._kinds:
            return True
        return self._any_kind and name in self._constants and not self._is_predicate(name)

    def _is_predicate(self, name: str) -> bool:
        return any(name == known.name for known in self._predicates)

    def _atom(self, subject: str) -> clingo.Symbol:
        found = pattern_in(subject)
        if found is None:
            raise self._wrong(
                f"`{subject}` is no atom", "write `KIND(NAME)`, `DataSplitter(NAME)` or an atom"
            )
        kind = signature_of(found).unsigned
        if kind not in self._predicates:
            raise self._other_arity(kind)
        return clingo.Function(found.name, list(map(self._known, found.arguments)), found.positive)

    def _known(self, term: clingo.Symbol) -> clingo.Symbol:
        """Check the constants of a term; a variable with the name of a module is that module."""
        if is_hole(term):
            name = term.arguments[0].string
            return clingo.String(name) if name in self._strings else term
        if term.type == clingo.SymbolType.String:
            return self._string(term.string)
        if term.type != clingo.SymbolType.Function:
            return term
        if term.name and term.name not in self._constants:
            raise self._unknown("constant", term.name, self._constants)
        return clingo.Function(term.name, list(map(self._known, term.arguments)), term.positive)

    def _string(self, name: str) -> clingo.Symbol:
        if name not in self._strings:
            near = nearest(name, self._strings)
            help_text = f"did you mean `{near}`?" if near else "name a module, or write `_` for any"
            raise self._wrong(f"there is no name `{name}`", help_text)
        return clingo.String(name)

    def _other_arity(self, signature: Signature) -> MarsError:
        name, arity, _ = signature
        same = sorted(str(other) for other in self._predicates if other.name == name)
        if not same:
            return self._unknown_predicate(name)
        return self._wrong(
            f"no rule and no fact gives `{name}` with {arity} arguments",
            f"there is {' and '.join(f'`{kind}`' for kind in same)}",
        )

    def _unknown_predicate(self, name: str) -> MarsError:
        if name in self._strings:
            return self._wrong(
                f"`{name}` is a module, which is there", f"ask for `DataSplitter({name})`"
            )
        known = {known.name for known in self._predicates} | self._kinds | set(NODE_NAMES.values())
        return self._unknown("predicate, kind of consequence or kind of node", name, known)

    def _unknown(self, what: str, name: str, known: Iterable[str]) -> MarsError:
        near = nearest(name, known)
        help_text = f"did you mean `{near}`?" if near else "see `mars-asp rules list`"
        return self._wrong(f"there is no {what} `{name}`", help_text)

    def _wrong(self, message: str, help_text: str) -> MarsError:
        place = point(self._path, 1, 1)
        return MarsError((Diagnostic("subject", "error", message, place, help=help_text),))
