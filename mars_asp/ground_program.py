"""The undecided part of a ground program, cut into independent components.

Atoms are clingo's integers; a negative one in a body is a negated atom. Two atoms belong together
when a rule names both, so components can be solved apart and their costs add up.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TypeAlias

import clingo

Weighted: TypeAlias = tuple[tuple[int, int], ...]


@dataclass(frozen=True, slots=True)
class GroundRule:
    """A ground rule; `bound` and `weighted` replace `body` in a rule with a weight body."""

    choice: bool
    head: tuple[int, ...]
    body: tuple[int, ...]
    bound: int | None = None
    weighted: Weighted = ()

    def atoms(self) -> tuple[int, ...]:
        """Return every atom that the rule names."""
        return (*self.head, *map(abs, self.body), *(abs(literal) for literal, _ in self.weighted))

    def renamed(self, names: Mapping[int, int]) -> "GroundRule":
        """Return the rule with other atoms."""

        def rename(literal: int) -> int:
            return names[literal] if literal > 0 else -names[-literal]

        return GroundRule(
            self.choice,
            tuple(sorted(map(rename, self.head))),
            tuple(sorted(map(rename, self.body))),
            self.bound,
            tuple(sorted((rename(literal), weight) for literal, weight in self.weighted)),
        )


@dataclass(frozen=True, slots=True)
class Component:
    """Rules over atoms 1..`size`; costs are (level, weight, literal); `projected` are counted."""

    size: int
    rules: tuple[GroundRule, ...]
    costs: tuple[tuple[int, int, int], ...]
    projected: tuple[int, ...]


@dataclass
class Recorder(clingo.Observer):
    """Notes what clingo grounds from the moment it is registered."""

    rules: list[GroundRule] = field(default_factory=list)
    facts: set[int] = field(default_factory=set)
    costs: list[tuple[int, int, int]] = field(default_factory=list)
    projected: set[int] = field(default_factory=set)

    def rule(self, choice: bool, head: Sequence[int], body: Sequence[int]) -> None:
        """Note a rule or a fact."""
        if not body and len(head) == 1 and not choice:
            self.facts.add(head[0])
        else:
            self.rules.append(GroundRule(choice, tuple(head), tuple(body)))

    def weight_rule(
        self, choice: bool, head: Sequence[int], lower_bound: int, body: Sequence[tuple[int, int]]
    ) -> None:
        """Note a rule with a weight body."""
        self.rules.append(GroundRule(choice, tuple(head), (), lower_bound, tuple(body)))

    def minimize(self, priority: int, literals: Sequence[tuple[int, int]]) -> None:
        """Note what is minimised."""
        self.costs += [(priority, weight, literal) for literal, weight in literals]

    def project(self, atoms: Sequence[int]) -> None:
        """Note the atoms that tell answers apart."""
        self.projected.update(atoms)


@dataclass(frozen=True, slots=True)
class Partition:
    """Components with their own numbering, each with the ground atoms that its numbers stand for.

    `constant` is the cost, level by level, of what is decided already; `facts` are its atoms.
    """

    components: tuple[tuple[Component, tuple[int, ...]], ...]
    constant: Mapping[int, int]
    facts: frozenset[int]


def partition(recorder: Recorder, rank: Callable[[int], object]) -> Partition:
    """Cut the recorded program into components.

    Equal components come out equal: their atoms are numbered by `rank`, a sort key of the name of
    a ground atom (clingo's own auxiliary atoms follow in their order).
    """
    facts = frozenset(recorder.facts)
    rules = [rule for rule in map(_without(facts), recorder.rules) if rule is not None]
    groups = _Groups()
    for rule in rules:
        groups.join(rule.atoms())
    constant: dict[int, int] = {}
    open_costs = []
    known = groups.parent
    for level, weight, literal in recorder.costs:
        constant.setdefault(level, 0)
        if literal in facts or (literal < 0 and -literal not in known and -literal not in facts):
            constant[level] += weight
        elif abs(literal) in known:
            open_costs.append((level, weight, literal))
    rules_of: dict[int, list[GroundRule]] = {}
    costs_of: dict[int, list[tuple[int, int, int]]] = {}
    for rule in rules:
        atoms = rule.atoms()
        if atoms:
            rules_of.setdefault(groups.find(atoms[0]), []).append(rule)
    for cost in open_costs:
        costs_of.setdefault(groups.find(abs(cost[2])), []).append(cost)
    components = []
    for root, members in groups.members().items():
        ordered = tuple(sorted(members, key=lambda atom: (rank(atom), atom)))
        names = {atom: number for number, atom in enumerate(ordered, 1)}
        part = Component(
            len(ordered),
            tuple(sorted((r.renamed(names) for r in rules_of.get(root, ())), key=_rule_key)),
            tuple(
                sorted(
                    (level, weight, names[lit] if lit > 0 else -names[-lit])
                    for level, weight, lit in costs_of.get(root, ())
                )
            ),
            tuple(sorted(names[atom] for atom in ordered if atom in recorder.projected)),
        )
        components.append((part, ordered))
    return Partition(tuple(components), constant, facts)


def _rule_key(rule: GroundRule) -> tuple[object, ...]:
    return (rule.choice, rule.head, rule.body, rule.bound or 0, rule.weighted)


def _without(facts: frozenset[int]) -> Callable[[GroundRule], GroundRule | None]:
    """Return a function that takes facts out of a rule, or the rule away where it is settled."""

    def simplify(rule: GroundRule) -> GroundRule | None:
        if not rule.choice and any(atom in facts for atom in rule.head):
            return None
        if any(-literal in facts for literal in rule.body):
            return None
        body = tuple(literal for literal in rule.body if literal not in facts)
        head = tuple(atom for atom in rule.head if atom not in facts)
        if rule.choice and not head:
            return None
        if rule.bound is None:
            return GroundRule(rule.choice, head, body)
        held = sum(weight for literal, weight in rule.weighted if literal in facts)
        weighted = tuple(
            (literal, weight) for literal, weight in rule.weighted if abs(literal) not in facts
        )
        bound = rule.bound - held
        if bound <= 0:
            return GroundRule(rule.choice, head, ())
        return GroundRule(rule.choice, head, (), bound, weighted)

    return simplify


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
