"""Explanations of the consequences, nodes and atoms of a configuration.

>>> reasoner = Reasoner(load_project("config.mars"), load_rulebook())
>>> for topic in explain(reasoner).topics:
...     print(topic.title)
"""

import contextlib
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal, TypeAlias

import clingo

from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.rules.symbols import symbol_in
from mars_asp.asp.signature import plain, signature_of
from mars_asp.asp.solve.term_ids import as_term
from mars_asp.asp.trace.tree import Trace, Unexplained
from mars_asp.diagnostic import MarsError, Severity
from mars_asp.output import brief_repr
from mars_asp.reasoning.analysis import Analysis, Consequence, read_consequences
from mars_asp.reasoning.findings import consequence_kinds
from mars_asp.reasoning.project import Project, port_names
from mars_asp.reasoning.questions.account import Account, explanations_of
from mars_asp.reasoning.questions.subject import (
    absent_subject,
    quoted,
    spaced_subjects,
    unapplied,
    unconcerned,
    wrong_subject,
)
from mars_asp.reasoning.questions.unrealised import unrealised
from mars_asp.reasoning.session import Evidence, Reasoner
from mars_asp.reasoning.synthesis import IntroducedNode, Specification
from mars_asp.reasoning.synthesis.synthesise import (
    Synthesis,
    is_resolved,
)
from mars_asp.spelling import suggestion

#: The sort of things to which an explanation can be limited.
Sort: TypeAlias = Literal["consequences", "nodes"]
_UNTRACED = Unexplained("", "no trace was asked for")


@dataclass(frozen=True, slots=True, repr=False)
class Topic:
    """One explained thing, named `name`: a node, a consequence or an atom.

    `account` is a short explanation, `trace` the complete one, `Unexplained` unless requested; an
    atom has only a trace. `rule` is the id of the deriving rule, if known without the trace. A node
    `resolves` consequences; a consequence is an `atom`.

    >>> topic = load("examples/level0/config.mars").explain("DataSplitter1").topics[0]
    >>> topic.sort, topic.resolves
    ('node', ('data_divergence(SonarMap)',))
    """

    __repr__ = brief_repr

    title: str
    name: str
    sort: Literal["consequence", "node", "atom"]
    severity: Severity | None = None
    rule: str | None = None
    resolves: tuple[str, ...] = ()
    account: Account | None = None
    trace: Trace = _UNTRACED
    atom: clingo.Symbol | None = None


@dataclass(frozen=True, repr=False)
class Explanation:
    """The answer to a question; `synthesis` is `None` if it was not needed or is impossible.

    >>> reasoner = Reasoner(load_project("examples/level0/config.mars"))
    >>> len(explain(reasoner).topics)
    6
    """

    __repr__ = brief_repr

    subject: str | None
    topics: tuple[Topic, ...]
    analysis: Analysis
    synthesis: Synthesis | None


#: A topic before its account and trace are made, with its thing and the atom to be traced.
_Subject: TypeAlias = tuple[Topic, Consequence | IntroducedNode | None, clingo.Symbol | None]


def explain(
    reasoner: Reasoner,
    subject: str | None = None,
    every: bool = False,
    only: Sort | None = None,
    traced: bool = True,
) -> Explanation:
    """Return explanations of everything, or of one module, node, consequence kind or atom.

    Traces are made if `traced`, and always for atoms. With `every`, each step of a trace also has
    the `others` derivations of its atom. `only` limits the topics to one sort, of everything or of
    a module. No specification is searched for consequences.

    Raises:
        MarsError: the subject cannot be explained, or does not hold.
        TimeoutError: no specification was found in time.

    >>> reasoner = Reasoner(load_project("examples/level0/config.mars"))
    >>> explain(reasoner, "ArbitrationNode").topics[0].resolves
    ('control_convergence(MobilePlatform)',)
    """
    *others, subject = [None] if subject is None else spaced_subjects(subject, reasoner.rulebook)
    for each in others:
        # A pack's predicate of the same name is explained if the built-in one does not hold.
        with contextlib.suppress(MarsError):
            return _explained(reasoner, each, every, only, traced)
    return _explained(reasoner, subject, every, only, traced)


def _explained(
    reasoner: Reasoner, subject: str | None, every: bool, only: Sort | None, traced: bool
) -> Explanation:
    project = reasoner.project
    if subject is not None and only is not None:
        names = [name.text for name in project.configuration.modules]
        if subject not in names:
            others = "only a module has both consequences and nodes"
            message = f"`{subject}` is not a module, and {others}"
            help_text = suggestion(subject, names, f"leave out `--only {only}`")
            raise wrong_subject(project, message, help_text)
    evidence = reasoner.evidence(resolved=False)
    chosen = _consequences(evidence, project, subject, only)
    if subject is not None and not chosen and _is_consequence(subject, reasoner.rulebook):
        raise absent_subject(subject, project, reasoner.rulebook, ())
    is_kind = all(subject in (c.kind, f"{c.kind}({c.subject})") for c in chosen)
    resolving = only != "consequences" and not (chosen and is_kind)
    if resolving:
        evidence = reasoner.evidence(resolved=True)
    synthesis = reasoner.synthesis if resolving else None
    found = _things_named(project, evidence, synthesis, subject, only, chosen, traced)
    # Of thousands of consequences no more is needed, and their traces take as much memory.
    del chosen
    nodes = () if synthesis is None else synthesis.specification.nodes
    topics = _topics(project, evidence, nodes, found, every, traced)
    return Explanation(subject, topics, evidence.analysis, synthesis)


def _things_named(
    project: Project,
    evidence: Evidence,
    synthesis: Synthesis | None,
    subject: str | None,
    only: Sort | None,
    chosen: Sequence[Consequence],
    traced: bool,
) -> list[_Subject]:
    """Return the topics that a subject names: consequences, nodes, or an atom.

    Consequences are those `chosen`, nodes those of the `synthesis`. A node has no atom unless
    `traced`.

    Raises:
        MarsError: it names nothing.
    """
    specification = None if synthesis is None else synthesis.specification
    found: list[_Subject] = []
    for each in chosen if only != "nodes" else ():
        title = f"{each.kind}({each.subject})"
        topic = Topic(title, title, "consequence", each.severity, atom=each.atom)
        found.append((topic, each, each.atom))
    if only != "consequences" and specification is not None:
        for node in _nodes(specification, subject, chosen):
            resolves = tuple(specification.resolves[node.name])
            title = f"{node.name} resolves {', '.join(resolves)}" if resolves else node.name
            atom = _node_atom(node, evidence, synthesis) if traced else None
            topic = Topic(title, node.name, "node", resolves=resolves)
            found.append((topic, node, atom))
    if not found and subject is not None:
        if only is not None:
            raise _nothing_of(subject, project, bool(chosen), synthesis, evidence.analysis)
        name, atom = _true_atom(subject, project, evidence, synthesis)
        found = [(Topic(plain(name), plain(name), "atom"), None, atom)]
    return found


def _topics(
    project: Project,
    evidence: Evidence,
    nodes: Sequence[IntroducedNode],
    found: Sequence[_Subject],
    every: bool,
    traced: bool,
) -> tuple[Topic, ...]:
    """Return topics with accounts; also traces if `traced`, with `every` derivation if set."""
    # Only consequences and nodes have an account, so other atoms have None for their thing.
    accounts = iter(
        explanations_of(
            project, evidence, nodes, [thing for _, thing, _ in found if thing is not None]
        )
    )
    atoms = dict.fromkeys(
        atom for _, thing, atom in found if atom is not None and (traced or thing is None)
    )
    traces = evidence.explainer.why(atoms, every) if atoms else {}
    topics = []
    for topic, thing, atom in found:
        account, rule = (None, None) if thing is None else next(accounts)
        untraced = replace(_UNTRACED, atom=topic.title)
        trace = untraced if atom is None else traces.get(atom, untraced)
        topics.append(replace(topic, rule=rule, account=account, trace=trace))
    return tuple(topics)


def _is_consequence(subject: str, rulebook: Rulebook) -> bool:
    """Whether a subject is `KIND(NAME)` of a consequence, existing or not, and not an atom."""
    kind, bracket, _ = subject.partition("(")
    heads = (head.name for rule in rulebook.rules for head in rule.heads)
    known = {*heads, *(each.name for each in rulebook.declarations)}
    return bool(bracket) and kind in consequence_kinds(rulebook) and kind not in known


def _is_node(subject: str | None, project: Project) -> bool:
    named = {name.text for name in project.configuration.modules}
    kind = None if subject is None else project.configuration.node_kind(subject)
    return kind is not None and subject not in named


def _nothing_of(
    subject: str,
    project: Project,
    concerned: bool,
    synthesis: Synthesis | None,
    analysis: Analysis,
) -> MarsError:
    """Return the error that a module has no consequence (unless `concerned`) or no node."""
    if not concerned:
        return unconcerned(subject, project)
    if synthesis is None:
        message = f"no node resolves what concerns `{subject}`: {unrealised(analysis)}"
        help_text = "`mars-asp check` shows how to resolve it"
    else:
        message = f"no node resolves what concerns `{subject}`"
        help_text = "leave out `--only nodes` to see what that is"
    return wrong_subject(project, message, help_text)


def _consequences(
    evidence: Evidence, project: Project, subject: str | None, only: Sort | None
) -> tuple[Consequence, ...]:
    # To read the consequences takes longer than to trace a node.
    if only == "nodes" if subject is None else _is_node(subject, project):
        return ()
    if subject is None:
        return read_consequences(evidence.analysis, participants=False)
    # What concerns a port concerns its module.
    names = {subject, *port_names(project, subject)}
    return tuple(
        c
        for c in read_consequences(evidence.analysis)
        if not names.isdisjoint((c.subject, *c.participants))
        or subject in (c.kind, f"{c.kind}({c.subject})", str(c.atom))
    )


def _nodes(
    specification: Specification, subject: str | None, chosen: Sequence[Consequence]
) -> tuple[IntroducedNode, ...]:
    if subject is None:
        return specification.nodes
    named = tuple(
        node
        for node in specification.nodes
        if subject in (node.name, node.conversion and node.conversion.converter)
    )
    if named:
        return named
    reasons = {f"{c.kind}({c.subject})" for c in chosen}
    return tuple(n for n in specification.nodes if reasons & set(specification.resolves[n.name]))


def _node_atom(
    node: IntroducedNode, evidence: Evidence, synthesis: Synthesis | None
) -> clingo.Symbol:
    """Return the atom that decides that there is a node: the term of the node, if it is an atom."""
    term, grounding = clingo.parse_term(node.term), evidence.analysis.grounding
    if synthesis is None or grounding.control.symbolic_atoms[term] is not None:
        return term
    synthesis.derived.hand_to(grounding)
    return clingo.Function("spec_node", [term, clingo.Function(node.kind)])


def _true_atom(
    subject: str,
    project: Project,
    evidence: Evidence,
    synthesis: Synthesis | None,
) -> tuple[str, clingo.Symbol]:
    """Return the text and the symbol of the true atom that a subject names.

    Raises:
        MarsError: it names none.
    """
    analysis, rulebook = evidence.analysis, evidence.rulebook
    names = {name.text for name in project.configuration.modules}
    symbol = symbol_in(quoted(subject, names))
    if symbol is not None and symbol.type == clingo.SymbolType.Function:
        taken = frozenset() if synthesis is None else synthesis.resolution.taken
        derived = frozenset() if synthesis is None else synthesis.derived.predicates
        if synthesis is not None and signature_of(symbol) in derived:
            synthesis.derived.hand_to(analysis.grounding)
        atom = analysis.grounding.control.symbolic_atoms[symbol]
        if synthesis is None and is_resolved(rulebook, signature_of(symbol)):
            raise _unrealised(subject, project, analysis)
        if atom is not None and (atom.is_fact or as_term(symbol) in taken):
            return subject, symbol
    if synthesis is None and _is_node(subject, project):
        raise _unrealised(subject, project, analysis)
    if subject in names:
        raise unconcerned(subject, project)
    if synthesis is not None and subject in project.described:
        raise unapplied(subject, project)
    known = [*names, *sorted(consequence_kinds(rulebook))]
    if synthesis is not None:
        known += [node.name for node in synthesis.specification.nodes]
    raise absent_subject(subject, project, rulebook, known)


def _unrealised(subject: str, project: Project, analysis: Analysis) -> MarsError:
    message = f"there is no `{subject}`, because {unrealised(analysis)}"
    return wrong_subject(project, message, "`mars-asp check` shows how to resolve it")
