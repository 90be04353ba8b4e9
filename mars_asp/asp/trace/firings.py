"""Firings, read from the atoms of explanation rules."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple, TypeAlias

import clingo

from mars_asp.asp.solve import term_ids
from mars_asp.asp.solve.term_ids import TermId, as_symbol

Terms: TypeAlias = tuple[TermId, ...]


class AggregateElement(NamedTuple):
    """A true element of an aggregate or conditional literal.

    `tuple` is the counted tuple, `premises` are its reasons, `conditions` are true without being
    reasons, and `absent` are the atoms whose absence it requires.
    """

    tuple: TermId
    premises: Terms
    conditions: Terms
    absent: Terms


@dataclass(frozen=True, slots=True, eq=False)
class Counted:
    """The true elements of an aggregate or conditional literal, shared by firings.

    `function` is the aggregate's, `all` where all elements are needed, or `none`.
    """

    function: str
    elements: Sequence[AggregateElement]


@dataclass(frozen=True, slots=True, eq=False)
class AggregateGroup:
    """The elements that a firing needs: so many that their function reaches `bound`.

    If `strict`, it must exceed the bound. Firings with the same need share the group.
    """

    counted: Counted
    strict: bool
    bound: clingo.Symbol


class Firing(NamedTuple):
    """One use of a rule: the true atoms that it needs, and the groups that it needs in part.

    Absent atoms and values of variables are decoded at their first use. Firings and elements are
    many, and tuples are made in a third of the time of dataclasses.
    """

    rule: int
    head: TermId
    premises: Terms
    #: The atoms on whose absence the firing rests, `a(q(1),...)`.
    without: TermId
    #: The values of the variables, `v(n("X",...),1,...)`.
    values: TermId
    groups: tuple[AggregateGroup, ...] = ()
    #: The term `near(...)` with the missing part of a near miss; `None` for a real firing.
    lacks: clingo.Symbol | None = None

    @property
    def absent(self) -> Terms:
        """Return the atoms that must be false for the firing, such as those after `not`."""
        return _distinct(term_ids.arguments(self.without))


def read_firings(control: clingo.Control, question: int) -> list[Firing]:
    """Return the firings that the explanation rules of a question found."""
    elements: dict[TermId, list[AggregateElement]] = {}
    for atom in _atoms(control, f"_e{question}_"):
        key, counted_tuple, *parts = term_ids.arguments(atom)
        inside = elements.setdefault(key, [])
        inside.append(
            AggregateElement(counted_tuple, *(tuple(term_ids.arguments(part)) for part in parts))
        )
    counted: dict[TermId, Counted] = {}
    groups: dict[TermId, AggregateGroup] = {}
    found = []
    rules: dict[TermId, tuple[int, clingo.Symbol | None]] = {}
    for atom in _atoms(control, f"_s{question}_"):
        tag, head, premises, absent, values, *needed = term_ids.arguments(atom)
        if tag not in rules:
            of = as_symbol(tag)
            is_whole = of.type == clingo.SymbolType.Number
            rules[tag] = (of.number, None) if is_whole else (of.arguments[0].number, of)
        rule, lacks = rules[tag]
        for need in needed:
            if need not in groups:
                function, relation, bound, key = term_ids.arguments(need)
                if key not in counted:
                    counted[key] = _counted(as_symbol(function).name, elements.get(key, ()))
                strict = as_symbol(relation).name in ("gt", "lt")
                groups[need] = AggregateGroup(counted[key], strict, as_symbol(bound))
        found.append(
            Firing(
                rule,
                head,
                _distinct(term_ids.arguments(premises)),
                absent,
                values,
                tuple(map(groups.__getitem__, needed)),
                lacks,
            )
        )
    return found


def _distinct(terms: Sequence[TermId]) -> Terms:
    return tuple(dict.fromkeys(terms) if len(terms) > 1 else terms)


def _counted(function: str, elements: Sequence[AggregateElement]) -> Counted:
    # With a negative weight more elements can mean a smaller sum.
    if function == "sum" and any(number_of(weight_of(element.tuple)) < 0 for element in elements):
        function = "all"
    return Counted(function, elements)


def _atoms(control: clingo.Control, prefix: str) -> Iterator[TermId]:
    """Yield the atoms of all predicates whose names begin with `prefix`."""
    for name, arity, positive in control.symbolic_atoms.signatures:
        if name.startswith(prefix):
            yield from term_ids.atoms(control, name, arity, positive)


def firing_order(firing: Firing) -> tuple[int, clingo.Symbol, list[clingo.Symbol]]:
    """Return a sort key: the number of the rule, then values and premises."""
    return firing.rule, as_symbol(firing.values), [as_symbol(atom) for atom in firing.premises]


def weight_of(counted_tuple: TermId) -> clingo.Symbol:
    """Return the weight in the tuple of an element: its first term."""
    inside = term_ids.arguments(counted_tuple)
    return as_symbol(inside[0]) if inside else clingo.Number(0)


def number_of(weight: clingo.Symbol) -> int:
    """Return the number that a weight adds to a sum: 0 unless it is a number."""
    return weight.number if weight.type == clingo.SymbolType.Number else 0
