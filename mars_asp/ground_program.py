"""The undecided part of a ground program, cut into independent components.

Atoms are clingo's integers; a negative one in a body is a negated atom. Only rules on which a
choice, a constraint or a cost depends are kept, because all else follows from the decisions. Two
atoms belong together when a rule names both, so components can be solved apart and their costs add
up.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple, TypeAlias

from mars_asp.recorder import Recorded

Weighted: TypeAlias = tuple[tuple[int, int], ...]


class GroundRule(NamedTuple):
    """A ground rule; where `bound` is positive, it and `weighted` replace `body`."""

    choice: bool
    head: tuple[int, ...]
    body: tuple[int, ...]
    bound: int = 0
    weighted: Weighted = ()

    def atoms(self) -> tuple[int, ...]:
        """Return every atom that the rule names."""
        if self.bound:
            return (*self.head, *(abs(literal) for literal, _ in self.weighted))
        return (*self.head, *map(abs, self.body))

    def renamed(self, names: Mapping[int, int]) -> "GroundRule":
        """Return the rule with other literals; `names` maps each literal."""
        return GroundRule(
            self.choice,
            tuple(sorted([names[atom] for atom in self.head])),
            tuple(sorted([names[literal] for literal in self.body])),
            self.bound,
            tuple(sorted([(names[literal], weight) for literal, weight in self.weighted])),
        )


@dataclass(frozen=True, slots=True)
class Component:
    """Rules over atoms 1..`size`; costs are (level, weight, literal); `projected` are counted."""

    size: int
    rules: tuple[GroundRule, ...]
    costs: tuple[tuple[int, int, int], ...]
    projected: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Partition:
    """Components with their own numbering, each with the ground atoms that its numbers stand for.

    `constant` is the cost, level by level, of what is decided already.
    """

    components: tuple[tuple[Component, tuple[int, ...]], ...]
    constant: Mapping[int, int]


def partition(program: Recorded, names: Mapping[int, str], asked: Iterable[int] = ()) -> Partition:
    """Cut a program into components.

    Equal components come out equal: the atoms that tell answers apart are numbered first, in the
    order of their names, all others in the order in which clingo grounded them. Rules on which
    `asked` atoms depend are kept besides those on which choices, constraints and costs do.
    """
    rules = _relevant(program, asked)
    mentioned = {atom for rule in rules for atom in rule.atoms()}
    mentioned.update(abs(literal) for _, _, literal in program.costs)
    facts = mentioned.intersection(program.facts)
    if facts:
        rules = [kept for rule in rules if (kept := _simplified(rule, facts)) is not None]
    groups = _Groups()
    for rule in rules:
        groups.join(rule.atoms())
    constant: dict[int, int] = {}
    known = groups.parent
    costs_of: dict[int, list[tuple[int, int, int]]] = {}
    for level, weight, literal in program.costs:
        constant.setdefault(level, 0)
        if abs(literal) in known:
            costs_of.setdefault(groups.find(abs(literal)), []).append((level, weight, literal))
        elif (literal in facts) if literal > 0 else (-literal not in facts):
            constant[level] += weight
    rules_of: dict[int, list[GroundRule]] = {}
    for rule in rules:
        for atom in rule.atoms()[:1]:
            rules_of.setdefault(groups.find(atom), []).append(rule)
    del rules
    components = []
    for root, members in groups.members().items():
        ordered = _ordered(members, program.projected, names)
        renaming = {atom: number for number, atom in enumerate(ordered, 1)}
        renaming.update([(-atom, -number) for atom, number in renaming.items()])
        part = Component(
            len(ordered),
            tuple(sorted([rule.renamed(renaming) for rule in rules_of.pop(root)])),
            tuple(sorted([(at, w, renaming[lit]) for at, w, lit in costs_of.pop(root, ())])),
            tuple(range(1, 1 + sum(atom in program.projected for atom in ordered))),
        )
        components.append((part, ordered))
    return Partition(tuple(components), constant)


def _ordered(
    members: Sequence[int], projected: set[int], names: Mapping[int, str]
) -> tuple[int, ...]:
    """Return atoms, given in clingo's order, as a component numbers them."""
    told = sorted((atom for atom in members if atom in projected), key=names.__getitem__)
    return (*told, *(atom for atom in members if atom not in projected))


def _relevant(program: Recorded, asked: Iterable[int]) -> list[GroundRule]:
    """Return the rules on which a choice, a constraint, a cost or an asked atom depends."""
    rules = list(_rules(program.rules))
    by_head: dict[int, list[int]] = {}
    keep = bytearray(len(rules))
    open_rules = []
    for index, rule in enumerate(rules):
        if rule.choice or not rule.head:
            keep[index] = 1
            open_rules.append(index)
        else:
            for atom in rule.head:
                by_head.setdefault(atom, []).append(index)
    reached = {*asked, *program.projected, *(abs(literal) for _, _, literal in program.costs)}
    for atom in reached:
        open_rules += by_head.get(atom, ())
    while open_rules:
        index = open_rules.pop()
        keep[index] = 1
        for atom in rules[index].atoms():
            if atom not in reached:
                reached.add(atom)
                open_rules += by_head.get(atom, ())
    return [rule for rule, kept in zip(rules, keep, strict=True) if kept]


def _rules(numbers: Sequence[int]) -> Iterator[GroundRule]:
    """Yield recorded rules in the order in which they were grounded."""
    at = 0
    while at < len(numbers):
        choice, heads, bodies, bound = numbers[at : at + 4]
        middle = at + 4 + heads
        head, at = tuple(numbers[at + 4 : middle]), middle + bodies
        body = tuple(numbers[middle:at])
        if bound:
            pairs = tuple(zip(body[::2], body[1::2], strict=True))
            yield GroundRule(bool(choice), head, (), bound, pairs)
        else:
            yield GroundRule(bool(choice), head, body)


def _simplified(rule: GroundRule, facts: set[int]) -> GroundRule | None:
    """Return a rule without facts, or nothing where they settle it."""
    if facts.isdisjoint(rule.atoms()):
        return rule
    if not rule.choice and not facts.isdisjoint(rule.head):
        return None
    if any(-literal in facts for literal in rule.body):
        return None
    head = tuple(atom for atom in rule.head if atom not in facts)
    if rule.choice and not head:
        return None
    if not rule.bound:
        return GroundRule(rule.choice, head, tuple(lit for lit in rule.body if lit not in facts))
    bound = rule.bound - sum(weight for literal, weight in rule.weighted if literal in facts)
    if bound <= 0:
        return GroundRule(rule.choice, head, ())
    weighted = tuple((lit, weight) for lit, weight in rule.weighted if abs(lit) not in facts)
    return GroundRule(rule.choice, head, (), bound, weighted)


class _Groups:
    """Disjoint sets with path halving (Tarjan and van Leeuwen 1984)."""

    def __init__(self) -> None:
        self.parent: dict[int, int] = {}

    def find(self, atom: int) -> int:
        parent = self.parent
        while parent.setdefault(atom, atom) != atom:
            parent[atom] = parent[parent[atom]]
            atom = parent[atom]
        return atom

    def join(self, atoms: Sequence[int]) -> None:
        if not atoms:
            return
        root = self.find(atoms[0])
        for atom in atoms[1:]:
            self.parent[self.find(atom)] = root

    def members(self) -> dict[int, list[int]]:
        groups: dict[int, list[int]] = {}
        for atom in sorted(self.parent):
            groups.setdefault(self.find(atom), []).append(atom)
        return groups
