"""Explanations of a configuration: which question, which atoms, whose traces.

>>> reasoner = Reasoner(load_project("config.mars"), load_rulebook())
>>> for topic in explain(reasoner).topics:
...     print(topic.title)
"""

import contextlib
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias

import clingo

from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.rules.symbols import symbol_in
from mars_asp.asp.signature import signature_of
from mars_asp.asp.solve.term_ids import as_term
from mars_asp.asp.trace import Explainer, Trace
from mars_asp.diagnostic import MarsError
from mars_asp.model.declarations import node_kind
from mars_asp.reasoning.analysis import Analysis, Consequence, analyse, read_consequences
from mars_asp.reasoning.facts.vocabulary import vocabulary
from mars_asp.reasoning.project import Project, project_facts, project_lookup
from mars_asp.reasoning.questions.evidence import Slice, slice_for, slice_for_resolution
from mars_asp.reasoning.questions.subject import absent_subject, quoted, unconcerned, wrong_subject
from mars_asp.reasoning.session import Reasoner, explainer_for
from mars_asp.reasoning.synthesis import Introduced, Node
from mars_asp.reasoning.synthesis.synthesise import (
    Synthesis,
    introduced_with,
    is_resolved,
)
from mars_asp.spelling import nearest

#: What of a configuration or module is explained alone.
Sort: TypeAlias = Literal["consequences", "nodes"]


@dataclass(frozen=True, slots=True)
class Topic:
    """One thing that is explained: a node, a consequence or an atom."""

    title: str
    trace: Trace


@dataclass(frozen=True)
class Explanation:
    """The answer to a question; `synthesis` is `None` where not all was or could be resolved."""

    subject: str | None
    topics: tuple[Topic, ...]
    analysis: Analysis
    synthesis: Synthesis | None


def explain(
    reasoner: Reasoner, subject: str | None = None, every: bool = False, only: Sort | None = None
) -> Explanation:
    """Explain everything, or a module, node, consequence kind or atom.

    With `every` each step of a trace has all `others` derivations of its atom, too. With `only`
    topics of one sort are explained, of everything or of a module; for consequences nothing is
    resolved.

    Raises:
        MarsError: the subject is nothing that could be explained, or does not hold.
        TimeoutError: no specification was found in time.
    """
    if subject is not None and only is not None:
        _check_module(subject, reasoner.project, only)
    elif subject is not None and not reasoner.is_resolved:
        answer = _explain_slice(reasoner, subject, every)
        if answer is not None:
            return answer
    return _explain_whole(reasoner, subject, every, only)


def _explain_slice(reasoner: Reasoner, subject: str, every: bool) -> Explanation | None:
    """Explain from what a question needs alone; `None` where that cannot be told apart."""
    project, rulebook = reasoner.project, reasoner.rulebook
    # What a part refuses, the whole says with all that is wrong, if it is.
    with contextlib.suppress(MarsError):
        part = slice_for(
            subject,
            rulebook,
            lambda names: project_facts(project, wanted=names),
            lambda names: project_lookup(project, names, vocabulary(rulebook)),
        )
        answer = None if part is None else _explain_part(project, part, subject, every)
        if answer is not None and answer.topics:
            return answer
        return _explain_node(project, rulebook, subject, reasoner.seconds, every)
    return None


def _explain_whole(
    reasoner: Reasoner, subject: str | None, every: bool, only: Sort | None
) -> Explanation:
    project, rulebook, analysis = reasoner.project, reasoner.rulebook, reasoner.analysis
    # To read the consequences takes longer than to trace a node.
    unread = only == "nodes" if subject is None else _is_node(subject, project)
    chosen = () if unread else _consequences(analysis, project, subject)
    synthesis = None
    resolving = only != "consequences" and (not chosen or not _is_kind(chosen, subject))
    if resolving:
        analysis, synthesis = reasoner.resolved
    nodes = _nodes(synthesis, subject, chosen)
    asked: list[tuple[str, clingo.Symbol]] = []
    if only != "nodes":
        asked += [(f"{c.kind}({c.subject})", c.atom) for c in chosen]
    if synthesis is not None:
        titles = [_node_title(node, synthesis.specification) for node in nodes]
        atoms = (_node_atom(node, analysis, synthesis) for node in nodes)
        asked += zip(titles, atoms, strict=True)
    if not asked and subject is not None:
        if only is not None:
            raise _nothing_of(subject, project, bool(chosen), synthesis)
        asked = [_asked_atom(subject, project, analysis, rulebook, synthesis)]
    # Of thousands of consequences no more is needed, and their traces take as much memory.
    del chosen
    explainer = reasoner.resolution_explainer if resolving else reasoner.explainer
    return Explanation(subject, _topics(explainer, asked, every), analysis, synthesis)


def _explain_part(project: Project, part: Slice, subject: str, every: bool) -> Explanation:
    """Explain what no choice decides from the rules and facts that it needs alone."""
    analysis = analyse(part.facts, part.rulebook, project.configuration.span, subject)
    asked = [(f"{c.kind}({c.subject})", c.atom) for c in analysis.consequences]
    if not asked:
        with contextlib.suppress(MarsError):
            asked = [_asked_atom(subject, project, analysis, part.rulebook, None)]
    explainer = explainer_for(part.rulebook, part.facts, analysis, None)
    return Explanation(subject, _topics(explainer, asked, every), analysis, None)


def _explain_node(
    project: Project, rulebook: Rulebook, subject: str, seconds: float | None, every: bool
) -> Explanation | None:
    """Explain a node from what precedes it in the file; `None` where none was found so."""
    if not _is_node(subject, project):
        return None
    part = slice_for_resolution(rulebook, lambda names: project_facts(project, wanted=names))
    if part is None:
        return None
    configuration, modules = project.configuration, project.modules
    analysis = analyse(part.facts, part.rulebook, configuration.span)
    found = introduced_with(subject, configuration, modules, analysis, part.rulebook, seconds)
    if found is None:
        return None
    introduced, resolution = found
    node = next(node for node in introduced.nodes if node.name == subject)
    # Nothing is resolved on the grounding of the analysis, so all that is decided can be stated.
    analysis.grounding.state(resolution.answer.grounding.decided_predicates())
    asked = [(_node_title(node, introduced), clingo.parse_term(node.term))]
    explainer = explainer_for(part.rulebook, part.facts, analysis, resolution)
    return Explanation(subject, _topics(explainer, asked, every), analysis, None)


def _topics(
    explainer: Explainer, asked: Sequence[tuple[str, clingo.Symbol]], every: bool
) -> tuple[Topic, ...]:
    traces = explainer.why(dict.fromkeys(atom for _, atom in asked), every)
    return tuple(Topic(title, traces[atom]) for title, atom in asked)


def _is_node(subject: str | None, project: Project) -> bool:
    named = {name.text for name in project.configuration.modules}
    return subject is not None and node_kind(subject) is not None and subject not in named


def _check_module(subject: str, project: Project, only: Sort) -> None:
    """Check that a subject is a module, which has consequences and nodes.

    Raises:
        MarsError: it is something else, which is of one sort or of none.
    """
    names = [name.text for name in project.configuration.modules]
    if subject not in names:
        near = nearest(subject, names)
        message = f"`{subject}` is no module, and only a module has both consequences and nodes"
        help_text = f"did you mean `{near}`?" if near else f"leave out `--only {only}`"
        raise wrong_subject(project, message, help_text)


def _nothing_of(
    subject: str, project: Project, concerned: bool, synthesis: Synthesis | None
) -> MarsError:
    """Return the error that a module has nothing of the sort that was asked for."""
    if not concerned:
        return unconcerned(subject, project)
    if synthesis is None:
        message = f"no node resolves what concerns `{subject}`, for no specification realises it"
        help_text = "`mars-asp check` says what stands against it"
    else:
        message = f"no node resolves what concerns `{subject}`"
        help_text = "leave out `--only nodes` to see what that is"
    return wrong_subject(project, message, help_text)


def _is_kind(chosen: Sequence[Consequence], subject: str | None) -> bool:
    return all(subject in (c.kind, f"{c.kind}({c.subject})") for c in chosen)


def _consequences(
    analysis: Analysis, project: Project, subject: str | None
) -> tuple[Consequence, ...]:
    if subject is None:
        return read_consequences(analysis, participants=False)
    return tuple(
        c
        for c in read_consequences(analysis)
        if subject in (c.kind, f"{c.kind}({c.subject})", c.subject, *c.participants, str(c.atom))
    )


def _nodes(
    synthesis: Synthesis | None, subject: str | None, chosen: Sequence[Consequence]
) -> tuple[Node, ...]:
    if synthesis is None:
        return ()
    specification = synthesis.specification
    if subject is None:
        return specification.nodes
    named = tuple(node for node in specification.nodes if node.name == subject)
    if named:
        return named
    reasons = {f"{c.kind}({c.subject})" for c in chosen}
    return tuple(n for n in specification.nodes if reasons & set(specification.resolves[n.name]))


def _node_atom(node: Node, analysis: Analysis, synthesis: Synthesis) -> clingo.Symbol:
    """Return what decides that there is a node: the atom by which it is called, if it is one."""
    term = clingo.parse_term(node.term)
    if analysis.grounding.control.symbolic_atoms[term] is not None:
        return term
    synthesis.derived.hand_to(analysis.grounding)
    return clingo.Function("spec_node", [term, clingo.Function(node.kind)])


def _node_title(node: Node, introduced: Introduced) -> str:
    resolves = introduced.resolves[node.name]
    return f"{node.name} resolves {', '.join(resolves)}" if resolves else node.name


def _asked_atom(
    subject: str,
    project: Project,
    analysis: Analysis,
    rulebook: Rulebook,
    synthesis: Synthesis | None,
) -> tuple[str, clingo.Symbol]:
    """Return the true atom that a subject names.

    Raises:
        MarsError: it names none.
    """
    names = {name.text for name in project.configuration.modules}
    symbol = symbol_in(quoted(subject, names))
    if symbol is not None and symbol.type == clingo.SymbolType.Function:
        taken = frozenset() if synthesis is None else synthesis.resolution.taken
        derived = frozenset() if synthesis is None else synthesis.derived.predicates
        if synthesis is not None and signature_of(symbol) in derived:
            synthesis.derived.hand_to(analysis.grounding)
        atom = analysis.grounding.control.symbolic_atoms[symbol]
        if synthesis is None and is_resolved(rulebook, signature_of(symbol)):
            raise _unrealised(subject, project)
        if atom is not None and (atom.is_fact or as_term(symbol) in taken):
            return subject, symbol
    if synthesis is None and _is_node(subject, project):
        raise _unrealised(subject, project)
    if subject in names:
        raise unconcerned(subject, project)
    known = [*names, *(c.kind for c in analysis.consequences)]
    if synthesis is not None:
        known += [node.name for node in synthesis.specification.nodes]
    raise absent_subject(subject, project, rulebook, known)


def _unrealised(subject: str, project: Project) -> MarsError:
    message = f"there is no `{subject}`, for no specification realises this configuration"
    return wrong_subject(project, message, "`mars-asp check` says what stands against it")
