"""Why an atom, node or consequence is absent, the changes that give it, and their cost.

>>> reasoner = Reasoner(load_project("config.mars"), load_rulebook())
>>> why_not(reasoner, "ArbitrationNode(Turn)").answer
'No ArbitrationNode(Turn): nothing controls `Turn`, and an arbiter needs two controllers.'
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import clingo

from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.signature import Signature, plain, signature_of
from mars_asp.asp.solve.term_ids import as_term
from mars_asp.asp.trace import absence
from mars_asp.asp.trace.patterns import fits, has_holes, hole, is_hole, shown_pattern, subterms
from mars_asp.asp.trace.text import leaves_of
from mars_asp.asp.trace.tree import Absent, Trace, Underivable
from mars_asp.diagnostic import Span
from mars_asp.model.declarations import node_names
from mars_asp.output import brief_repr, listing
from mars_asp.reasoning.analysis import Analysis, read_consequences
from mars_asp.reasoning.findings import kinds_of
from mars_asp.reasoning.project import Project, port_names
from mars_asp.reasoning.questions.absence_query import (
    RELATIONSHIPS,
    AbsenceQuestion,
    Vocabulary,
    at_module,
)
from mars_asp.reasoning.questions.blame import Blame, blame
from mars_asp.reasoning.questions.connected import BY_TYPE, connected_part
from mars_asp.reasoning.questions.near_miss import near_miss
from mars_asp.reasoning.questions.subject import spaced_subjects
from mars_asp.reasoning.questions.unrealised import unrealised
from mars_asp.reasoning.session import Evidence, Reasoner
from mars_asp.reasoning.synthesis.exclusion import NoSpecificationError, excluded
from mars_asp.reasoning.synthesis.synthesise import (
    UNRESOLVABLE,
    Synthesis,
    is_resolved,
    is_unresolvable,
)

_INSERTED = Signature("inserted", 2)
#: The consequence that a node of a kind resolves, if its atom names no module.
RESOLVES = {"arbitration_node": "control_convergence", "control_splitter": "control_divergence"}
#: The relationships of cycles, which are reported for the first module only.
_CIRCLES = {"data_cycle": "data", "control_cycle": "control"}
#: The kinds of the consequences and nodes that atoms of rules are about, by predicate.
_ABOUT = {
    "diverges": "data_divergence",
    "converges": "control_convergence",
    "contested": "control_convergence",
    "spreads": "control_divergence",
    "tied": "ambiguous_priority",
    "splitter": "data_splitter",
    "transformer": "data_transformer",
    "edge": "data_transformer",
    "control_splitter": "control_splitter",
    "inheritance_node": "inheritance_node",
}
#: At most this many possible atoms are tried for the cheapest realisation.
MOST_TRIED = 100
#: At most this many nodes of a kind are named.
_MOST_NAMED = 4


@dataclass(frozen=True, repr=False, kw_only=True)
class WhyNot:
    """The answer to the question why something is absent; it may be `present` after all.

    `evidence` are the lines that the answer cites. `to_get` is the smallest change found and tried
    that gives it, or None. `see` is the subject whose explanation shows why it holds. `extra` is
    the additional cost, by level, of the cheapest specification with the atom `offered`. It is None
    if none has such an atom, or if the atom is not chosen; `choosable` distinguishes these.
    `obstacles` are the traces of the errors that prevent every specification.

    >>> reasoner = Reasoner(load_project("examples/level0/config.mars"))
    >>> why_not(reasoner, "DataSplitter(Turn)").present
    False
    """

    __repr__ = brief_repr

    subject: str
    answer: str
    evidence: tuple[Span, ...] = ()
    to_get: str | None = None
    present: bool = False
    choosable: bool = True
    offered: str | None = None
    extra: Mapping[int, int] | None = None
    analysis: Analysis
    find_trace: Callable[[], Trace]
    obstacles: tuple[Trace, ...] = ()
    see: str | None = None

    @cached_property
    def trace(self) -> Trace:
        """Return the trace of an existing atom, else of the nearest rules that fail."""
        return self.find_trace()


def why_not(reasoner: Reasoner, subject: str, depth: int = 8) -> WhyNot:
    """Return the reason why an atom, `KIND(NAME)` of a consequence or `NODE(NAME)` is absent.

    Variables of an atom, and `_` for a name, match any value. The subject may also be the name of a
    node. The trace has at most `depth` levels.

    Raises:
        MarsError: the subject names no predicate, kind, node or constant that there is.
        TimeoutError: no specification was found in time.

    >>> reasoner = Reasoner(load_project("examples/level0/config.mars"))
    >>> why_not(reasoner, "DataSplitter(Turn)").to_get
    'two lines `... uses_data_from Turn`...'
    """
    subject = spaced_subjects(subject, reasoner.rulebook)[-1]
    vocabulary = Vocabulary(reasoner)
    if vocabulary.is_node(subject):
        return _of_named_node(reasoner, subject)
    question = vocabulary.question(subject)
    near = _near(reasoner, question)
    found = _answer(near, question, depth)
    is_local = found.present and question.is_node and near is not reasoner
    # An error elsewhere may prevent every specification.
    if is_local and is_unresolvable(reasoner.analysis):
        found = _answer(reasoner, question, depth)
    return replace(found, subject=plain(subject), answer=plain(found.answer))


def _near(reasoner: Reasoner, question: AbsenceQuestion) -> Reasoner:
    """Return a reasoner about only the connected component that a question needs.

    With packs it is the whole project, as packs may relate unconnected modules, and for
    questions with numbers, which identify lines of the whole.
    """
    terms = {each for pattern in question.patterns for each in subterms(pattern)}
    names = {each.string for each in terms if each.type == clingo.SymbolType.String}
    has_numbers = any(each.type == clingo.SymbolType.Number for each in terms)
    numbered = question.kind is None and has_numbers
    if reasoner.rulebook.packs or reasoner.is_resolved or not names or numbered:
        return reasoner
    if question.kind in BY_TYPE:
        return reasoner
    ports = port_names(reasoner.project)
    modules = {ports[name][0] if name in ports else name for name in names}
    part = connected_part(reasoner.project, modules)
    return Reasoner(part, reasoner.rulebook, reasoner.budget)


def _answer(reasoner: Reasoner, question: AbsenceQuestion, depth: int) -> WhyNot:
    pattern = question.patterns[0]
    choosable = is_resolved(reasoner.rulebook, signature_of(pattern))
    evidence = reasoner.evidence(resolved=choosable)
    synthesis = reasoner.synthesis if choosable else None
    if choosable and synthesis is None:
        return unrealised_answer(question.shown, evidence, reasoner.analysis)
    held = _true_atom(question, evidence, synthesis)
    if held is not None:
        return _present(question, held, evidence, synthesis)
    offered, extra = (
        (None, None)
        if synthesis is None
        else _cheapest(evidence.analysis, question.patterns, reasoner.budget.deadline())
    )
    if synthesis is not None and offered is None and reasoner.rulebook.packs:
        against = excluded(reasoner.rulebook, evidence.facts, shown_pattern(pattern))
        if against is not None:
            return _excluded(question, against, evidence)
    found = _blame(reasoner, question, evidence)

    def trace() -> Trace:
        found = absence.explain_absence(evidence.explainer, pattern, depth)
        if pattern.name != "consequence" or not isinstance(found, Underivable):
            return found
        # Rules that give any kind of consequence are left out if others name the kind.
        named = tuple(a for a in found.attempts if kinds_of(a.rule) is not None)
        return replace(found, attempts=named or found.attempts)

    start = f"No {question.shown}"
    if question.kind in _CIRCLES and _goes_round(question, evidence.analysis):
        start = f"{question.shown} is there under another name"
    return WhyNot(
        subject=question.shown,
        answer=f"{start}: {found.because}.",
        evidence=found.evidence,
        to_get=_sentences(found),
        choosable=synthesis is not None,
        offered=offered,
        extra=extra,
        analysis=evidence.analysis,
        find_trace=trace,
    )


def _excluded(
    question: AbsenceQuestion, against: NoSpecificationError, evidence: Evidence
) -> WhyNot:
    """Return the answer that constraints of packs exclude such a node from every specification."""
    first = against.diagnostics[0]
    return WhyNot(
        subject=question.shown,
        answer=f"No {question.shown}: {first.message}, as `{first.code}` demands.",
        evidence=tuple(each.span for each in against.diagnostics),
        to_get=first.help,
        analysis=evidence.analysis,
        find_trace=lambda: Absent(shown_pattern(question.patterns[0])),
    )


def _sentences(found: Blame) -> str | None:
    """Return the change that gives what is missing, and what else may be meant, or None."""
    if found.to_get is None:
        return None
    return ". ".join(filter(None, (found.to_get, found.beside))) + "."


def _true_atom(
    question: AbsenceQuestion, evidence: Evidence, synthesis: Synthesis | None
) -> clingo.Symbol | None:
    """Return a true atom that matches a question, or None."""
    grounding = evidence.analysis.grounding
    if synthesis is not None and signature_of(question.patterns[0]) in synthesis.derived.predicates:
        synthesis.derived.hand_to(grounding)
    taken = frozenset() if synthesis is None else synthesis.resolution.taken
    for pattern in question.patterns:
        atoms = list(grounding.atoms(pattern.name, len(pattern.arguments)))
        for atom, is_fact in sorted(atoms):
            if fits(pattern, atom) and (is_fact or as_term(atom) in taken):
                return atom
    topic = f"{RESOLVES.get(question.kind or '')}({question.module})"
    if synthesis is not None:
        for node in synthesis.specification.nodes:
            resolved = synthesis.specification.resolves[node.name]
            if node.kind == question.kind and topic in resolved:
                return clingo.parse_term(node.term)
    return None


def _present(
    question: AbsenceQuestion, held: clingo.Symbol, evidence: Evidence, synthesis: Synthesis | None
) -> WhyNot:
    """Return the answer that the atom `held` holds, with the subject that explains why."""
    spans: tuple[Span, ...] = ()
    # `explain` takes no variables.
    open_atom = question.kind is None and any(map(has_holes, question.patterns))
    see = None if open_atom else question.shown
    if synthesis is not None and question.is_node:
        specification = synthesis.specification
        nodes = [node for node in specification.nodes if _is_meant(node.term, held, question)]
        each = (topic for node in nodes for topic in specification.resolves[node.name])
        topics = list(dict.fromkeys(each))
        answer = is_there(question.shown, topics, len(nodes))
        named = question.shown in {node.name for node in specification.nodes}
        see = question.shown if named else next(iter(topics), None)
    elif question.kind is not None:
        found = [c for c in read_consequences(evidence.analysis) if c.atom == held]
        answer = holds(question.shown, found[0].message if found else "")
        spans = found[0].spans if found else ()
    else:
        answer = holds(question.shown)

    def trace() -> Trace:
        return evidence.explainer.why([held])[held]

    if question.kind is None and held.name in RELATIONSHIPS:
        spans = tuple(leaf.span for leaf in leaves_of(trace()) if leaf.span is not None)
    return WhyNot(
        subject=question.shown,
        answer=answer,
        evidence=spans,
        present=True,
        choosable=synthesis is not None,
        analysis=evidence.analysis,
        find_trace=trace,
        see=see,
    )


def is_there(shown: str, resolves: Sequence[str], number: int = 1) -> str:
    """Return the sentence that the node `shown` exists, with the consequences that it resolves.

    `number` is the number of nodes of the kind.
    """
    times = {0: "", 1: "", 2: " twice"}.get(number, f" {number} times")
    resolved = f", and resolves {listing(_first_words(resolves))}" if resolves else ""
    return f"{shown} is there{times}{resolved}."


def holds(shown: str, message: str = "") -> str:
    """Return the answer that something holds, with its message."""
    return f"{shown} holds{f': {message}' if message else ''}."


def _is_meant(term: str, held: clingo.Symbol, question: AbsenceQuestion) -> bool:
    """Whether the node with a term is the one in `held`, or another one that matches."""
    if term == node_term(held, question.kind):
        return True
    node = clingo.parse_term(term)
    return question.module is not None and any(fits(each, node) for each in question.patterns)


def node_term(held: clingo.Symbol, kind: str | None) -> str:
    """Return the term of a node, from an atom that represents it at a module."""
    if kind == "arbitration_node" and held.name == "receives":
        return str(clingo.Function("arbiter", held.arguments[1].arguments))
    if held.match("inserted_at", 3):
        return str(held.arguments[2])
    return str(held)


def unrealised_answer(title: str, evidence: Evidence, whole: Analysis) -> WhyNot:
    """Return the answer that nothing realises the configuration, so `title` cannot exist."""
    analysis = evidence.analysis
    against = sorted(analysis.grounding.symbols(UNRESOLVABLE.name, UNRESOLVABLE.arity))
    obstacles = tuple(evidence.explainer.why(against).values())
    leaves = (leaf.span for each in obstacles for leaf in leaves_of(each))
    spans = dict.fromkeys(span for span in leaves if span is not None)
    return WhyNot(
        subject=title,
        answer=f"No {title}: {unrealised(whole)}.",
        evidence=tuple(spans),
        analysis=analysis,
        find_trace=lambda: Absent(title),
        obstacles=obstacles,
    )


def _blame(reasoner: Reasoner, question: AbsenceQuestion, evidence: Evidence) -> Blame:
    project, rulebook = reasoner.project, reasoner.rulebook

    # A cycle that is reported for another module needs no change.
    goes_round = question.kind in _CIRCLES and _goes_round(question, evidence.analysis)

    def gives(revised: Project) -> bool:
        if goes_round:
            return False
        other = Reasoner(revised, rulebook, reasoner.budget)
        resolved = is_resolved(rulebook, signature_of(question.patterns[0]))
        synthesis = other.synthesis if resolved else None
        if resolved and synthesis is None:
            return False
        if question.kind in _CIRCLES:
            return _goes_round(question, other.analysis)
        return _true_atom(question, other.evidence(resolved), synthesis) is not None

    kind, module = question.kind, question.module
    if kind is None:
        kind, module = _meant(question.patterns[0], evidence, reasoner)
    if kind is not None:
        found = blame(project, rulebook, kind, module, gives)
        if found is not None:
            return found
    pattern = question.patterns[0]
    if pattern.match("inserted_at", 3):
        # Any node of the kind would need a pack that introduces it for this module.
        node = _node_of(pattern.arguments[0].name, rulebook)
        pattern = clingo.Function("inserted_for", [node, hole(), pattern.arguments[1]])
    elif pattern.match("spec_node", 2) and not is_hole(pattern.arguments[0]):
        # The term of a node is the atom that decides it.
        pattern = pattern.arguments[0]
    return near_miss(reasoner, pattern, gives)


def _node_of(kind: str, rulebook: Rulebook) -> clingo.Symbol:
    """Return the pattern that matches a pack's nodes of a kind; a hole if their terms differ."""
    called: set[clingo.Symbol] = set()
    for rule in rulebook.of_packs:
        if not rule.derives(_INSERTED):
            continue
        symbol = getattr(getattr(rule.node.head, "atom", None), "symbol", None)
        node, of_kind = (None, kind) if symbol is None else symbol.arguments
        if str(of_kind) == kind:
            name, arguments = getattr(node, "name", ""), getattr(node, "arguments", ())
            holes = [hole() for _ in arguments]
            called.add(clingo.Function(name, holes) if name and holes else hole())
    return called.pop() if len(called) == 1 else hole()


def _meant(
    pattern: clingo.Symbol, evidence: Evidence, reasoner: Reasoner
) -> tuple[str | None, str | None]:
    """Return the kind and module of an absent atom for which `rules/absence` may state the reason.

    Both are None for another atom, or if the module has such a node or consequence.
    """
    if pattern.match("spec_node", 2) and not is_hole(pattern.arguments[0]):
        pattern = pattern.arguments[0]
    kind = _ABOUT.get(pattern.name)
    about = pattern.arguments[0] if pattern.arguments else pattern
    if pattern.match("consequence", 4) and not is_hole(about):
        kind, about = about.name, pattern.arguments[2]
    if about.match("base", 1):
        about = about.arguments[0]
    if kind is None or about.type != clingo.SymbolType.String:
        return None, None
    names = node_names(reasoner.project.configuration.kinds)
    node = next((each for each in names if each == kind), None)
    consequence = clingo.Function("consequence", [clingo.Function(kind), hole(), about, hole()])
    patterns = (consequence,) if node is None else at_module(node, about)
    question = AbsenceQuestion("", patterns, kind, about.string)
    synthesis = None if node is None or not reasoner.is_resolved else reasoner.synthesis
    if node is not None and synthesis is None:
        return None, None
    if _true_atom(question, evidence, synthesis) is not None:
        return None, None
    return kind, about.string


def _goes_round(question: AbsenceQuestion, analysis: Analysis) -> bool:
    """Whether the module of the question is on a cycle of the kind in the question."""
    return (question.kind, question.module) in set(circles(analysis))


def circles(analysis: Analysis) -> Iterator[tuple[str, str]]:
    """Yield kind and module for each module on a cycle."""
    kinds = {relationship: kind for kind, relationship in _CIRCLES.items()}
    for each in analysis.grounding.symbols("entangled", 3):
        if each.arguments[0].name in kinds:
            yield kinds[each.arguments[0].name], each.arguments[2].string


def _of_named_node(reasoner: Reasoner, name: str) -> WhyNot:
    """Return the answer about a node by its name, such as `DataSplitter1`."""
    kind = reasoner.project.configuration.node_kind(name)
    assert kind is not None
    word = node_names(reasoner.project.configuration.kinds)[kind]
    evidence, synthesis = reasoner.evidence(resolved=True), reasoner.synthesis
    if synthesis is None:
        return unrealised_answer(name, evidence, reasoner.analysis)
    specification = synthesis.specification
    for node in specification.nodes:
        if node.name == name:
            term = clingo.parse_term(node.term)
            return _present(AbsenceQuestion(name, (term,), kind), term, evidence, synthesis)
    same = [node.name for node in specification.nodes if node.kind == kind]
    found = blame(reasoner.project, reasoner.rulebook, kind, None, lambda _: False)
    because = "the minimal specification has none" if found is None else found.because
    if same:
        named = _first_words(
            [f"{n} ({listing(_first_words(specification.resolves[n]))})" for n in same]
        )
        words = f"{len(same)} {word}s" if len(same) > 1 else f"one {word}"
        because = f"the minimal specification has {words}: {listing(named)}"
    pattern = at_module(kind, hole())[0]
    return WhyNot(
        subject=name,
        answer=f"No {name}: {because}.",
        to_get=None if found is None else _sentences(found),
        analysis=evidence.analysis,
        find_trace=lambda: Absent(shown_pattern(pattern)),
    )


def _first_words(words: Sequence[str]) -> Sequence[str]:
    """Return the first words and, if there are too many, the number of the further ones."""
    rest = len(words) - _MOST_NAMED
    return [*words[:_MOST_NAMED], f"{rest} more"] if rest > 0 else words


def _cheapest(
    analysis: Analysis, patterns: Sequence[clingo.Symbol], deadline: float | None
) -> tuple[str | None, Mapping[int, int] | None]:
    """Return the cheapest atom that fits a pattern, and its extra cost by level; or Nones."""
    # The atom that decides a node is the first argument of `spec_node`.
    decided = [each.arguments[0] if each.name == "spec_node" else each for each in patterns]
    atoms = [
        atom
        for pattern in decided
        if pattern.type == clingo.SymbolType.Function and not is_hole(pattern)
        for atom, _ in analysis.grounding.atoms(pattern.name, len(pattern.arguments))
        if fits(pattern, atom)
    ]
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
