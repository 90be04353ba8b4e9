"""The undecided rules of a ground program, divided into independent components.

Atoms are clingo's integers; a negative one in a body is a negated atom. Only rules are kept on
which a choice, a constraint or a cost depends; all other atoms follow from the decisions. Two atoms
are in one component if a rule names both, so components can be solved separately and their costs
added.
"""

from array import array
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass
from typing import NamedTuple, TypeAlias

from mars_asp.asp.solve.disjoint_sets import DisjointSets
from mars_asp.asp.solve.observer import Recorded
from mars_asp.asp.solve.term_ids import TermId, text

Weighted: TypeAlias = tuple[tuple[int, int], ...]

#: A recorded rule: `_FIXED` numbers, then head and body.
Flat: TypeAlias = "array[int]"
_FIXED = 4


class GroundRule(NamedTuple):
    """A ground rule; a positive `bound` and `weighted` replace `body`."""

    choice: bool
    head: tuple[int, ...]
    body: tuple[int, ...]
    bound: int = 0
    weighted: Weighted = ()


@dataclass(frozen=True, slots=True)
class Component:
    """Rules over atoms 1..`size`; costs are (level, weight, literal); `projected` are counted."""

    size: int
    rules: tuple[GroundRule, ...]
    costs: tuple[tuple[int, int, int], ...]
    projected: tuple[int, ...]


class Partition(NamedTuple):
    """Components with their own numbers for atoms, each with the ground atoms for these numbers.

    `constant` is the cost of decided atoms, level by level.
    """

    components: tuple[tuple[Component, tuple[int, ...]], ...]
    constant: Mapping[int, int]


def partition(
    program: Recorded, names: Mapping[int, TermId], requested: Iterable[int] = ()
) -> Partition:
    """Divide a program into components.

    Components of the same form become equal values. For this, projected atoms are numbered first,
    in the order of their `names`; all others, and without names these as well, in the order in
    which clingo grounded them. Rules on which `requested` atoms depend are kept besides those for
    choices, constraints and costs.
    """
    facts = frozenset(program.facts)
    rules: list[Flat] = []
    groups: DisjointSets[int] = DisjointSets()
    for rule, atoms in _relevant(program, facts, requested):
        rules.append(rule)
        groups.join(atoms)
    members = groups.members(sorted(groups.parent))
    root_of = {atom: root for root, atoms in members.items() for atom in atoms}
    constant: dict[int, int] = {}
    costs_of: dict[int, list[tuple[int, int, int]]] = {}
    for level, weight, literal in program.costs:
        constant.setdefault(level, 0)
        if abs(literal) in root_of:
            costs_of.setdefault(root_of[abs(literal)], []).append((level, weight, literal))
        elif (literal in facts) if literal > 0 else (-literal not in facts):
            constant[level] += weight
    rules_of: dict[int, list[Flat]] = {}
    for rule in rules:
        if len(rule) > _FIXED:
            rules_of.setdefault(root_of[abs(rule[_FIXED])], []).append(rule)
    del rules, groups, root_of
    components = []
    shared: dict[Component, Component] = {}
    for root, atoms in members.items():
        ordered = _ordered(atoms, program.projected, names)
        renaming = {atom: number for number, atom in enumerate(ordered, 1)}
        renaming.update([(-atom, -number) for atom, number in renaming.items()])
        part = Component(
            len(ordered),
            tuple(sorted([_renamed(rule, renaming) for rule in rules_of.pop(root)])),
            tuple(sorted([(at, w, renaming[lit]) for at, w, lit in costs_of.pop(root, ())])),
            tuple(range(1, 1 + sum(atom in program.projected for atom in ordered))),
        )
        components.append((shared.setdefault(part, part), ordered))
    return Partition(tuple(components), constant)


def _ordered(
    members: Sequence[int], projected: set[int], names: Mapping[int, TermId]
) -> tuple[int, ...]:
    """Return the atoms of a component in their new order: `projected` ones first, by name."""
    entries = [atom for atom in members if atom in projected]
    if names:
        entries.sort(key=lambda atom: text(names[atom]))
    return (*entries, *(atom for atom in members if atom not in projected))


def _relevant(
    program: Recorded, facts: Set[int], requested: Iterable[int]
) -> Iterator[tuple[Flat, Sequence[int]]]:
    """Yield the rules on which a choice, a constraint, a cost or an atom of `requested` depends.

    Facts and underivable atoms are removed from them. Each rule comes with its atoms.
    """
    numbers = program.rules
    by_head: defaultdict[int, list[int]] = defaultdict(list)
    offered: set[int] = set()
    waiting = []
    at = 0
    while at < len(numbers):
        choice, heads, bodies, _ = numbers[at : at + _FIXED]
        head = numbers[at + _FIXED : at + _FIXED + heads]
        if choice or not heads:
            waiting.append(at)
            offered.update(head)
        else:
            for atom in head:
                by_head[atom].append(at)
        at += _FIXED + heads + bodies
    unsettled = (offered | by_head.keys()) - facts
    reached = {*requested, *program.projected, *(abs(literal) for _, _, literal in program.costs)}
    for atom in reached:
        waiting += by_head.pop(atom, ())
    seen = set()
    while waiting:
        at = waiting.pop()
        if at in seen:
            continue
        seen.add(at)
        _, heads, bodies, _ = numbers[at : at + _FIXED]
        rule = numbers[at : at + _FIXED + heads + bodies]
        atoms = _atoms(rule)
        if not unsettled.issuperset(atoms):
            simplified = _simplified(rule, facts, unsettled)
            if simplified is None:
                continue
            rule, atoms = simplified, _atoms(simplified)
        yield rule, atoms
        for atom in atoms:
            if atom not in reached:
                reached.add(atom)
                waiting += by_head.pop(atom, ())


def _atoms(rule: Flat) -> list[int]:
    """Return every atom that a rule names."""
    _, heads, _, bound = rule[:_FIXED]
    if bound:
        return [*rule[_FIXED : _FIXED + heads], *map(abs, rule[_FIXED + heads :: 2])]
    return [*map(abs, rule[_FIXED:])]


def _simplified(rule: Flat, facts: Set[int], unsettled: Set[int]) -> "Flat | None":
    """Return a rule without decided literals, or None if these satisfy or disable the rule.

    An atom that is neither a fact nor unsettled is false.
    """
    choice, heads, _, bound = rule[:_FIXED]
    head, body = rule[_FIXED : _FIXED + heads], rule[_FIXED + heads :]
    head_left = [atom for atom in head if atom not in facts]
    if len(head_left) < heads and not (choice and head_left):
        return None
    if not bound:
        left = [literal for literal in body if abs(literal) in unsettled]
        if len(left) < len(body) and any(
            abs(literal) not in unsettled and (abs(literal) in facts) == (literal < 0)
            for literal in body
        ):
            return None
    else:
        weighted = list(zip(body[::2], body[1::2], strict=True))
        open_ones = [pair for pair in weighted if abs(pair[0]) in unsettled]
        bound -= sum(
            weight
            for literal, weight in weighted
            if abs(literal) not in unsettled and (abs(literal) in facts) == (literal > 0)
        )
        if sum(weight for _, weight in open_ones) < bound:
            return None
        left = [number for pair in open_ones if bound > 0 for number in pair]
    return array("i", (choice, len(head_left), len(left), max(bound, 0), *head_left, *left))


def _renamed(rule: Flat, names: Mapping[int, int]) -> GroundRule:
    """Return a rule with renumbered atoms; `names` maps each literal to the new one."""
    choice, heads, _, bound = rule[:_FIXED]
    head = tuple(sorted([names[atom] for atom in rule[_FIXED : _FIXED + heads]]))
    body = rule[_FIXED + heads :]
    if not bound:
        return GroundRule(choice > 0, head, tuple(sorted([names[literal] for literal in body])))
    pairs = zip(body[::2], body[1::2], strict=True)
    weighted = tuple(sorted([(names[literal], weight) for literal, weight in pairs]))
    return GroundRule(choice > 0, head, (), bound, weighted)
