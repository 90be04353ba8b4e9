"""One node, without resolving the whole: those before it are counted, its own stretch is resolved.

A node's number says how many of its kind are named before it. So the stretches of the file before
its own are grounded with the rules alone that decide how many there are; its own with all.
"""

from collections.abc import Iterable, Mapping, Sequence, Set
from typing import NamedTuple

from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.rules.statements import statements_of
from mars_asp.asp.signature import Signature
from mars_asp.asp.slice.portions import Apart, Portion, kept_apart
from mars_asp.asp.solve.atoms import Fact
from mars_asp.asp.solve.components import Component
from mars_asp.asp.solve.grounding import Resolution
from mars_asp.asp.solve.optimum import Optimum
from mars_asp.model.declarations import NODE_NAMES, node_kind
from mars_asp.reasoning.analysis import Analysis, analyse
from mars_asp.reasoning.facts.vocabulary import vocabulary
from mars_asp.reasoning.findings import CONSEQUENCE, kinds_of
from mars_asp.reasoning.project import project_facts
from mars_asp.reasoning.questions.account import speakers
from mars_asp.reasoning.rules import FOLLOWING
from mars_asp.reasoning.session import Evidence, Reasoner
from mars_asp.reasoning.synthesis import Derived, Draft, Introduced, introduce
from mars_asp.reasoning.synthesis.derived import STAGE, decided_by
from mars_asp.reasoning.synthesis.stretches import Divided, Stretches, stretches
from mars_asp.reasoning.synthesis.synthesise import UNRESOLVABLE, costs_of, is_unresolvable

_STAGES = ("resolve", FOLLOWING["resolve"])


def preceding_evidence(reasoner: Reasoner, name: str) -> Evidence | None:
    """Return what a node needs, with the nodes of its stretch that are decided together with it.

    They are those of the least specification. `None` where there is no such node, where it is not
    sure that there is one least specification, where rules may bring modules together that nothing
    connects, and with rule packs, which could leave no answer.

    Raises:
        MarsError: clingo refuses the rules, or costs are too large to be added up.
    """
    project, rulebook = reasoner.project, reasoner.rulebook
    kind, modules = node_kind(name), project.configuration.modules
    if kind is None or rulebook.packs or any(name == each.text for each in modules):
        return None
    predicate = decided_by(rulebook, kind)
    whole = for_resolution(rulebook)
    # What follows from an answer is read of one stretch, too.
    specifying = f"{whole.text('resolve')}\n{whole.text(STAGE)}"
    apart = kept_apart(whole.text("base"), specifying, vocabulary(rulebook).connected)
    if predicate is None or apart is None:
        return None
    counting = next((each for each in apart.deciding if predicate in each.derived), apart.whole)
    facts = project_facts(project, wanted=names_read(whole))
    found = _own_stretch(name, reasoner, _Question(whole, apart, counting, facts))
    if found is None:
        return None
    analysis, introduced, resolution, derived = found
    # Nothing is resolved on the grounding of the analysis, so all that is decided can be stated.
    analysis.grounding.state(resolution.answer.grounding.decided_predicates())
    return Evidence(whole, analysis.facts, analysis, resolution, introduced, derived)


class _Question(NamedTuple):
    """The rules and facts of a question: all rules, and the portion that decides how many nodes."""

    rulebook: Rulebook
    apart: Apart
    counting: Portion
    facts: tuple[Fact, ...]


def _own_stretch(
    name: str, reasoner: Reasoner, question: _Question
) -> tuple[Analysis, Introduced, Resolution, Derived] | None:
    """Resolve the stretch that a node stands in."""
    project, deadline = reasoner.project, reasoner.budget.deadline()
    rulebook, apart, counting, facts = question
    # Kinds that are decided together are counted together, so they all have their names.
    counted = {
        str(each): decides
        for each in NODE_NAMES
        if (decides := decided_by(rulebook, each)) in counting.derived
    }
    cut = stretches(project.configuration.relationships, facts, vocabulary(rulebook))
    draft = Draft(project)
    known: dict[Component, Optimum] = {}
    number, own = 0, facts
    if len(cut.relationships) > 1:
        passed = _passed_over(name, question, cut, draft, counted, deadline, known)
        if passed is None:
            return None
        number, own = passed, tuple(cut.facts(passed, facts, apart.everywhere))
    analysis = analyse(own, rulebook, project.configuration.span)
    if is_unresolvable(analysis):
        return None
    grounding = Divided(cut, analysis.grounding).ground([number], apart.whole)
    with costs_of(facts):
        resolution = grounding.resolve(rulebook.text("resolve"), deadline, known=known)
    derived = Derived(rulebook, resolution.answer)
    introduced = introduce(draft, derived, cut.relationships[number])
    nodes = tuple(node for node in introduced.nodes if node.kind in counted)
    if not resolution.proven or all(node.name != name for node in nodes):
        return None
    return analysis, Introduced(nodes, introduced.resolves), resolution, derived


def _passed_over(
    name: str,
    question: _Question,
    cut: Stretches,
    draft: Draft,
    counted: Mapping[str, Signature],
    deadline: float | None,
    known: dict[Component, Optimum],
) -> int | None:
    """Let a draft pass over the stretches before that of a node; return the number of its own.

    `None` where nothing realises the whole, or a stretch was not decided in time.
    """
    rulebook, _, counting, facts = question
    counted_by = for_counting(rulebook, counting)
    read = names_read(counted_by).union(each.name for each in reads(counting))
    told = (fact for fact in facts if fact.atom.name in read)
    every = analyse(told, counted_by, draft.span)
    if is_unresolvable(every):
        return None
    before = Divided(cut, every.grounding)
    # The next ones stand last.
    waiting = [*cut.before_last()][::-1]
    while waiting:
        together = waiting.pop()
        grounding = before.ground(together, counting)
        with costs_of(facts):
            resolution = grounding.resolve(counting.text, deadline, known=known)
        if resolution.count is None:
            return None
        counts = {each: resolution.answer.count(decides) for each, decides in counted.items()}
        if draft.pass_over(counts, name):
            continue
        if len(together) == 1:
            return together[0]
        half = len(together) // 2
        waiting += [together[half:], together[:half]]
    return len(cut.relationships) - 1


def for_resolution(rulebook: Rulebook) -> Rulebook:
    """Return the rules that resolve, those that tell of nodes, and what these need of the base.

    That includes what no specification can resolve, which is not theirs to say.
    """
    resolving = tuple(rule for rule in rulebook.rules if rule.stage in _STAGES)
    readers = (*resolving, *speakers(rulebook, NODE_NAMES))
    read = frozenset({UNRESOLVABLE}).union(*(rule.reads for rule in readers))
    base = _behind(rulebook, read, readers)
    texts = ((stage, rulebook.text(stage)) for stage in _STAGES)
    return Rulebook((*base, *readers), (_text(base), *texts), documented=rulebook.documented)


def for_counting(rulebook: Rulebook, counting: Portion) -> Rulebook:
    """Return the rules of the base behind a portion, and behind what nothing can resolve."""
    readers = tuple(
        rule
        for rule in rulebook.rules
        if rule.stage in _STAGES and not counting.derived.isdisjoint(rule.heads | rule.reads)
    )
    base = _behind(rulebook, {UNRESOLVABLE, *reads(counting)}, readers)
    return Rulebook(base, (_text(base),), documented=rulebook.documented)


def reads(portion: Portion) -> frozenset[Signature]:
    """Return what the rules of a portion read and do not derive."""
    return portion.of_all.union(portion.of_parts)


def names_read(rulebook: Rulebook) -> frozenset[str]:
    """Return the names of the predicates that rules read."""
    return frozenset(each.name for rule in rulebook.rules for each in rule.reads)


def _behind(rulebook: Rulebook, read: Set[Signature], readers: Sequence[Rule]) -> tuple[Rule, ...]:
    """Return the rules of the base that derive what is read, however indirectly.

    Of consequences they are those of the kinds that the readers name, or all.
    """
    base = [rule for rule in rulebook.rules if rule.stage == "base"]
    behind: dict[str, Rule] = {}
    new: Sequence[Rule] = readers
    while new:
        kinds = _kinds_read((*behind.values(), *readers))
        new = tuple(
            rule
            for rule in base
            if rule.text not in behind
            and not rule.heads.isdisjoint(read)
            and (kinds is None or _is_read(rule, kinds))
        )
        behind.update((rule.text, rule) for rule in new)
        read = {*read, *(each for rule in new for each in rule.reads)}
    return tuple(rule for rule in base if rule.text in behind)


def _text(base: Iterable[Rule]) -> tuple[str, str]:
    return "base", "\n".join(rule.text for rule in base)


def _kinds_read(rules: Iterable[Rule]) -> frozenset[str] | None:
    """Return the kinds of consequence that rules read by name; `None` where they read any."""
    texts = [rule.text for rule in rules if CONSEQUENCE in rule.reads]
    kinds = {
        literal.terms[0].constant
        for variants in statements_of(texts).values()
        for statement in variants
        for literal in statement.read
        if literal.signature == CONSEQUENCE
    }
    return None if None in kinds else frozenset(kind for kind in kinds if kind is not None)


def _is_read(rule: Rule, kinds: Set[str]) -> bool:
    """Whether a rule derives anything besides consequences of other kinds."""
    named = kinds_of(rule)
    return named is None or not named or not named.isdisjoint(kinds)
