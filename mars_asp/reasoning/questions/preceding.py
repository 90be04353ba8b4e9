"""One node, without resolving the whole: those before it are counted, its own stretch is resolved.

A node's number says how many of its kind are named before it. So what stands before its own stretch
of the file is grounded with the rules alone that decide how many there are, once of all that is
alike; its own with all rules.
"""

import re
from collections.abc import Mapping, Sequence
from typing import NamedTuple

from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.signature import Signature
from mars_asp.asp.slice.portions import Apart, Portion, kept_apart
from mars_asp.asp.solve.grounding import Grounding, Resolution
from mars_asp.asp.solve.term_ids import TermId, arguments, atoms
from mars_asp.model.declarations import NODE_NAMES, node_kind
from mars_asp.reasoning.analysis import Analysis, analyse
from mars_asp.reasoning.facts.vocabulary import vocabulary
from mars_asp.reasoning.project import project_parts
from mars_asp.reasoning.questions.behind import (
    for_counting,
    for_resolution,
    for_unresolvable,
    names_read,
)
from mars_asp.reasoning.questions.counted import Counter, Owner, Told, is_realisable
from mars_asp.reasoning.questions.islands import Island, Map
from mars_asp.reasoning.session import Evidence, Reasoner
from mars_asp.reasoning.synthesis import Derived, Draft, Introduced, introduce
from mars_asp.reasoning.synthesis.derived import STAGE, decided_by
from mars_asp.reasoning.synthesis.synthesise import costs_of, is_unresolvable

_NUMBER = re.compile(r"\D")


def preceding_evidence(reasoner: Reasoner, name: str) -> Evidence | None:
    """Return what a node needs, with the nodes of its stretch that are decided together with it.

    They are those of the least specification. `None` where there is no such node, where it is not
    sure that there is one least specification, where rules may bring modules together that nothing
    connects, and with rule packs, which could leave no answer.

    Raises:
        MarsError: clingo refuses the rules, or costs are too large to be added up.
    """
    kind, modules = node_kind(name), reasoner.project.configuration.modules
    if kind is None or any(name == each.text for each in modules):
        return None
    predicate = decided_by(reasoner.rulebook, kind)
    question = None if predicate is None else _question(reasoner)
    if question is None:
        return None
    whole, apart, _ = question
    counting = next((each for each in apart.deciding if predicate in each.derived), apart.whole)
    found = _own_stretch(name, reasoner, question, counting)
    if found is None:
        return None
    analysis, introduced, resolution, derived = found
    # Nothing is resolved on the grounding of the analysis, so all that is decided can be stated.
    analysis.grounding.state(resolution.answer.grounding.decided_predicates())
    return Evidence(whole, analysis.facts, analysis, resolution, introduced, derived)


def is_realised(reasoner: Reasoner) -> bool | None:
    """Whether nothing stands against every specification of a project.

    `None` where that is not told of parts alone, as with rule packs.

    Raises:
        MarsError: clingo refuses the rules.
    """
    question = _question(reasoner)
    return question and is_realisable(question.told, for_unresolvable(question.rulebook))


class _Question(NamedTuple):
    """What resolves a project, how it keeps parts apart, and who tells their facts."""

    rulebook: Rulebook
    apart: Apart
    told: Told


def _question(reasoner: Reasoner) -> _Question | None:
    """Return what tells of parts; `None` where rules may bring together what nothing connects."""
    project, rulebook = reasoner.project, reasoner.rulebook
    if rulebook.packs:
        return None
    whole = for_resolution(rulebook)
    # What follows from an answer is read of one stretch, too.
    specifying = f"{whole.text('resolve')}\n{whole.text(STAGE)}"
    connected = vocabulary(rulebook)
    apart = kept_apart(whole.text("base"), specifying, connected.connected)
    if apart is None:
        return None
    parts = project_parts(project, names_read(whole), connected, apart.everywhere)
    return _Question(whole, apart, Told(parts, Map(project.configuration, parts.numbered)))


def _own_stretch(
    name: str, reasoner: Reasoner, question: _Question, counting: Portion
) -> tuple[Analysis, Introduced, Resolution, Derived] | None:
    """Resolve the stretch that a node stands in; a portion decides how many of its kind there are.

    `None` as in `preceding_evidence`.
    """
    project, deadline = reasoner.project, reasoner.budget.deadline()
    rulebook, apart, told = question
    # Kinds that are decided together are counted together, so they all have their names.
    counted = {
        str(each): decides
        for each in NODE_NAMES
        if (decides := decided_by(rulebook, each)) in counting.derived
    }
    stretches = told.map.stretches()
    if not stretches:
        return None
    own, draft = stretches[0], Draft(project)
    if len(stretches) > 1:
        base = for_counting(rulebook, counting)
        sought = node_kind(name) or "", int(_NUMBER.sub("", name) or 1)
        counter = Counter(told, base, counting, counted, deadline, sought)
        if not is_realisable(told, for_unresolvable(rulebook)):
            return None
        passed = _passed_over(name, draft, counter, stretches)
        if passed is None:
            return None
        own = passed
    facts = told.facts([own], names_read(rulebook))
    analysis = analyse(facts, rulebook, project.configuration.span)
    if is_unresolvable(analysis):
        return None
    grounding = Grounding((), _about(Owner(told, [own]), analysis, apart.whole))
    with costs_of(analysis.facts):
        resolution = grounding.resolve(rulebook.fragments("resolve"), deadline)
    derived = Derived(rulebook, resolution.answer)
    introduced = introduce(draft, derived, map(told.map.line.__getitem__, own.lines))
    nodes = tuple(node for node in introduced.nodes if node.kind in counted)
    if not resolution.proven or all(node.name != name for node in nodes):
        return None
    return analysis, Introduced(nodes, introduced.resolves), resolution, derived


def _passed_over(
    name: str, draft: Draft, counter: Counter, stretches: Sequence[Island]
) -> Island | None:
    """Let a draft pass over the stretches before that of a node; return its own.

    `None` where a stretch was not decided in time.
    """
    begun = {each.lines[0]: number for number, each in enumerate(counter.islands)}
    for stretch in stretches[:-1]:
        counts = dict.fromkeys(counter.kinds, 0)
        for number in (begun[line] for line in stretch.lines if line in begun):
            found = counter.of(number)
            if found is None:
                return None
            for kind, count in found.items():
                counts[kind] += count
        if not draft.pass_over(counts, name):
            return stretch
    return stretches[-1]


def _about(
    own: Owner, analysis: Analysis, portion: Portion
) -> Mapping[Signature, Sequence[TermId]]:
    """Return what a portion reads about one island; of others, not all is told."""
    control = analysis.grounding.control
    found = {
        signature: [
            atom for atom in atoms(control, *signature) if own.called(arguments(atom)[at]) == 0
        ]
        for signature, at in portion.of_parts.items()
    }
    return found | {signature: atoms(control, *signature) for signature in portion.of_all}
