"""The cost if modules with the same controllers did not share their arbiter.

Arbiters whose inputs have different hold times differ, so a `hold` of its own at each module
prevents the sharing and changes nothing else. The component that control connects with the modules
is resolved once unchanged and once with these holds, each by search.
"""

import time
from collections.abc import Callable, Mapping, Sequence
from itertools import count
from typing import TypeAlias

import clingo

from mars_asp.asp.signature import Signature
from mars_asp.asp.solve.disjoint_sets import DisjointSets
from mars_asp.asp.solve.grounding import Grounding, Resolution
from mars_asp.asp.solve.term_ids import TermId, arguments, as_symbol, as_term, text
from mars_asp.model.declarations import Control
from mars_asp.reasoning.facts.identifiers import numbered
from mars_asp.reasoning.project import Project
from mars_asp.reasoning.rules import NODES
from mars_asp.reasoning.session import Evidence
from mars_asp.reasoning.synthesis import IntroducedNode

#: A node, the number of nodes, the number without sharing, the arbiters and splitters of that.
APART = Signature("apart", 5)
#: Limits of the lines and seconds that are spent on a sentence.
_MOST_LINES, _MOST_SECONDS = 60, 0.1
_CONTROL_INPUT, _WEIGHS, _HOLD = (
    Signature("control_input", 3),
    Signature("weighs", 2),
    Signature("hold", 2),
)
_RECEIVES, _ARCHITECTURE = Signature("receives", 2), Signature("architecture", 1)
_ARBITER, _SPLITTER = Signature("arbiter", 1), Signature("control_splitter", 1)

#: Returns the true atoms of predicates.
Atoms: TypeAlias = Callable[[Sequence[Signature]], Mapping[Signature, Sequence[TermId]]]


def apart(
    project: Project, evidence: Evidence, node: IntroducedNode, atoms_of: Atoms
) -> TermId | None:
    """Return `apart(N, X, Y, K, L)` of a shared arbiter N, or None if it is not computed.

    The component that control connects has X nodes, and Y without sharing: K arbiters, and
    splitters for the controllers in the list L. It is computed if each module receives the
    arbiter's commands unchanged, no command is only inherited, and a short search decides.
    """
    if node.kind != "arbitration_node" or evidence.rulebook.packs:
        return None
    if project.configuration.kind == "specification":
        return None
    signal = as_term(clingo.Function("run", clingo.parse_term(node.term).arguments))
    received = map(arguments, atoms_of([_RECEIVES])[_RECEIVES])
    sharing = [text(module) for module, heard_there in received if heard_there == signal]
    if len(sharing) < 2:
        return None
    heard = _connected(sharing, atoms_of([_CONTROL_INPUT, _WEIGHS, _HOLD, _ARCHITECTURE]))
    if heard is None:
        return None
    deadline = time.monotonic() + _MOST_SECONDS
    rules = evidence.rulebook.fragments("resolve")
    together = Grounding((), heard).resolve(rules, deadline)
    parted = {**heard, _HOLD: _parted(sharing, heard)}
    alone = Grounding((), parted).resolve(rules, deadline)
    if not together.proven or not alone.proven:
        return None
    return as_term(_price(node, project, together, alone))


def _connected(
    modules: Sequence[str], found: Mapping[Signature, Sequence[TermId]]
) -> Mapping[Signature, Sequence[TermId]] | None:
    """Return the atoms about modules that share controllers with `modules`, also indirectly.

    The result is None if they are too many, or if a command is inherited.
    """
    lines = [(text(m), text(c)) for _, m, c in map(arguments, found[_CONTROL_INPUT])]
    components: DisjointSets[str] = DisjointSets()
    for module, controller in lines:
        # A name that controls and is controlled is two vertices.
        components.join((module, f"by {controller}"))
    roots = set(map(components.find, modules))
    heard = [
        atom
        for atom, (module, _) in zip(found[_CONTROL_INPUT], lines, strict=True)
        if components.find(module) in roots
    ]
    if len(heard) > _MOST_LINES or any("inherited(" in text(atom) for atom in heard):
        return None
    relationships = {arguments(atom)[0] for atom in heard}
    declared = {
        signature: [atom for atom in found[signature] if arguments(atom)[0] in relationships]
        for signature in (_WEIGHS, _HOLD)
    }
    return {**declared, _CONTROL_INPUT: heard, _ARCHITECTURE: found[_ARCHITECTURE]}


def _parted(
    sharing: Sequence[str], heard: Mapping[Signature, Sequence[TermId]]
) -> Sequence[TermId]:
    """Return the hold times in `heard`; each of `sharing` but the first gets a new, unique one."""
    declared = {arguments(atom)[0]: atom for atom in heard[_HOLD]}
    taken = {as_symbol(arguments(atom)[1]) for atom in declared.values()}
    free = (each for each in map(clingo.Number, count(1)) if each not in taken)
    for module, hold in zip(sharing[1:], free, strict=False):
        for relationship, hearer, _ in map(arguments, heard[_CONTROL_INPUT]):
            if text(hearer) == module:
                own = clingo.Function(_HOLD.name, [as_symbol(relationship), hold])
                declared[relationship] = as_term(own)
    return tuple(declared.values())


def _price(
    node: IntroducedNode, project: Project, together: Resolution, alone: Resolution
) -> clingo.Symbol:
    true = alone.answer.true_of([_ARBITER, _SPLITTER])
    copied = [as_symbol(arguments(atom)[0]) for atom in true[_SPLITTER]]
    names = {each.arguments[0].string for each in copied if each.match("base", 1)}
    first: dict[str, int] = {}
    for _, each in numbered(project.configuration.relationships):
        if isinstance(each, Control) and each.controller in names:
            line = each.span.line
            first[each.controller] = min(line, first.get(each.controller, line))
    listed: clingo.Symbol = clingo.Number(len(copied) - len(names))
    for name in sorted(names, key=lambda name: first[name], reverse=True):
        listed = clingo.Function("and", [clingo.String(name), listed])
    numbers = [together.cost.get(NODES, 0), alone.cost.get(NODES, 0), len(true[_ARBITER])]
    return clingo.Function(
        APART.name, [clingo.parse_term(node.term), *map(clingo.Number, numbers), listed]
    )
