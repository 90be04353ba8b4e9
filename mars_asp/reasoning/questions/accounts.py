"""Which accounts are told of consequences and nodes, from what evidence."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.signature import Signature
from mars_asp.asp.solve.term_ids import TermId, atoms
from mars_asp.diagnostic import Span
from mars_asp.model.described import described_modules
from mars_asp.reasoning.account import Account, Cited, Key, Names, Told, speakers, told
from mars_asp.reasoning.analysis import Consequence
from mars_asp.reasoning.facts.identifiers import numbered, numbered_annotations
from mars_asp.reasoning.project import Project
from mars_asp.reasoning.session import Evidence
from mars_asp.reasoning.synthesis import Node
from mars_asp.reasoning.synthesis.derived import decided_by

#: What a node has for the case of a consequence.
_NODE = "node"


def key_of(thing: Consequence | Node) -> Key:
    """Return by what an account is found of a consequence or node."""
    if isinstance(thing, Node):
        return thing.kind, thing.term, _NODE
    kind, _, subject, case = thing.atom.arguments
    return str(kind), str(subject), str(case)


def told_of(
    project: Project,
    evidence: Evidence,
    nodes: Iterable[Node],
    things: Sequence[Consequence | Node],
) -> Mapping[Key, tuple[Account, str | None]]:
    """Return the accounts of consequences and nodes, and the rule that gives each.

    `nodes` are all that have names.

    A consequence of which no rule tells has its message and places. No rule is named for a node
    that several rules or none could have given: it was chosen.

    Raises:
        MarsError: clingo refuses a rule.
    """
    if not things:
        return {}
    kinds = {thing.kind for thing in things}
    rules, deciding = speakers(evidence.rulebook, kinds), _deciding(evidence.rulebook, kinds)
    names = _names(project, nodes)
    found = told(rules, deciding, lambda read: _true(evidence, read), names)
    return {key_of(thing): _told(thing, found, names) for thing in things}


def _told(thing: Consequence | Node, found: Told, names: Names) -> tuple[Account, str | None]:
    account = found.accounts.get(key_of(thing), Account(None, (), ()))
    if isinstance(thing, Node):
        return account, found.rules.get(thing.term)
    cites = account.cites or tuple(Cited(span, names.where(span), "") for span in thing.spans)
    return replace(account, answer=account.answer or thing.message, cites=cites), thing.rule.id


def _deciding(rulebook: Rulebook, kinds: Iterable[str]) -> tuple[Rule, ...]:
    """Return the rules with a message that force nodes of some kinds."""
    predicates = {decided_by(rulebook, kind) for kind in kinds} - {None}
    return tuple(
        rule
        for rule in rulebook.rules
        if rule.because is not None
        and rule.stage == "resolve"
        and not rule.is_choice
        and not predicates.isdisjoint(rule.heads)
    )


def _true(
    evidence: Evidence, read: Sequence[Signature]
) -> Mapping[Signature, Sequence[TermId]]:
    """Return the true atoms of predicates: what follows from an answer, the answer, or facts."""
    control = evidence.analysis.grounding.control
    derived = evidence.derived
    opened = {} if evidence.resolution is None else evidence.resolution.answer.true
    found: dict[Signature, Sequence[TermId]] = {}
    for signature in read:
        if derived is not None and signature in derived.predicates:
            found[signature] = derived.atoms(signature)
        else:
            found[signature] = opened.get(signature) or atoms(control, *signature)
    return found


def _names(project: Project, nodes: Iterable[Node]) -> Names:
    configuration = project.configuration
    described = described_modules(configuration, project.modules)
    places: dict[int | str, Span] = {name: module.span for name, module in described.items()}
    places |= {name.text: name.span for name in configuration.modules}
    places |= {number: each.span for number, each in numbered(configuration.relationships)}
    places |= {
        number: annotation.span
        for number, _, annotation in numbered_annotations(configuration, described)
    }
    order = {name.text: place for place, name in enumerate(configuration.modules)}
    return Names(places, configuration.span, {node.term: node.name for node in nodes}, order)
