"""Which variables the literals of a body bind, so far as that shows without clingo."""

import re
from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

import clingo
from clingo import ast

from mars_asp.asp.rules.statements import masked, sign_and_function
from mars_asp.asp.rules.trees import SyntaxNode, below, names_in

_TYPE = ast.ASTType
#: What has elements with variables of their own.
AGGREGATES = (_TYPE.Aggregate, _TYPE.BodyAggregate, _TYPE.HeadAggregate)
#: A string, or a name; of a variable, after `_` and primes, the first letter is large.
_WORD = re.compile(r""""(?:[^"\\]|\\.)*"|(?<![\w'])[\w']+""")
_UNSAFE = re.compile(r"note: '(\w+'*)' is unsafe")
_EQUAL = ast.ComparisonOperator.Equal
_NONE: frozenset[str] = frozenset()


class _Inner(NamedTuple):
    """An element or condition of a literal: its variables, and those that it binds for itself."""

    names: frozenset[str]
    bound: frozenset[str]


class Conjunct(NamedTuple):
    """A literal as clingo writes it, and what it says of its variables.

    Those `used` have to be bound in the rule. It binds those `bound`, and each in `equal` once all
    that it is made of is bound, of what else the rule has to bind. `is_seen` is whether it shows
    what has to be bound in it, `is_all` whether it binds nothing else.
    """

    text: str
    names: frozenset[str]
    used: frozenset[str] = frozenset()
    bound: frozenset[str] = frozenset()
    equal: tuple[tuple[str, frozenset[str]], ...] = ()
    inner: tuple[_Inner, ...] = ()
    is_seen: bool = True
    is_all: bool = True

    def renamed(self, names: Mapping[str, str]) -> "Conjunct":
        """Return it with other names for variables of its elements and conditions."""
        if self.names.isdisjoint(names):
            return self
        return self._replace(
            text=_WORD.sub(lambda found: names.get(found[0], found[0]), self.text),
            names=_with_names(self.names, names),
            inner=tuple(_Inner(*(_with_names(each, names) for each in one)) for one in self.inner),
        )


def written(literals: Iterable[Conjunct]) -> str:
    """Return a body of literals."""
    return "; ".join(literal.text for literal in literals) or "#true"


def unbound(values: Sequence[str], literals: Sequence[Conjunct]) -> frozenset[str]:
    """Return the variables that clingo would say nothing binds."""
    seen = _seen_unbound(values, literals)
    return _told_unbound(values, literals) if seen is None else seen


def _seen_unbound(values: Sequence[str], literals: Sequence[Conjunct]) -> frozenset[str] | None:
    """Return what `unbound` does, or None if it does not show."""
    if not all(literal.is_seen for literal in literals):
        return None
    words = (word for value in values for word in _WORD.findall(value))
    named = {word for word in words if word == "_" or word.lstrip("_'")[:1].isupper()}
    used = named.union(*(literal.used for literal in literals))
    bound = _NONE.union(*(literal.bound for literal in literals))
    equal = [each for literal in literals for each in literal.equal]
    while given := {name for name, parts in equal if parts & used <= bound} - bound:
        bound |= given
    missing = frozenset(used - bound)
    inner = (each for literal in literals for each in literal.inner)
    if not all(each.names <= each.bound | bound | missing for each in inner):
        return None
    return missing if not missing or all(literal.is_all for literal in literals) else None


def _told_unbound(values: Sequence[str], literals: Sequence[Conjunct]) -> frozenset[str]:
    """Return what `unbound` does, asking clingo."""
    entries: list[str] = []
    control = clingo.Control(["--warn=none"], lambda _, note: entries.append(note))
    try:
        rule = f"_computed({','.join(values)}) :- {written(literals)}."
        control.add("base", [], masked(rule))
        control.ground([("nothing", [])])
    except RuntimeError:
        # What is anonymous can be bound by nothing else.
        return frozenset({"_"}.union(*map(_UNSAFE.findall, entries)))
    return frozenset()


def conjunct(node: SyntaxNode) -> Conjunct:
    """Return a literal of a body or condition with what shows of its variables."""
    kind = node.atom.ast_type if node.ast_type is _TYPE.Literal else node.ast_type
    if kind is _TYPE.SymbolicAtom:
        return _atom_conjunct(node)
    if kind is _TYPE.Comparison:
        guards = [(each.comparison, each.term) for each in node.atom.guards]
        return _compared_conjunct(node, [node.atom.term], guards, [])
    if kind is _TYPE.BodyAggregate:
        inside = [_inner(each.terms, each.condition) for each in node.atom.elements]
        return _compared_conjunct(node, [], _guards(node.atom), inside)
    if kind is _TYPE.Aggregate:
        inside = [_inner((each.literal,), each.condition) for each in node.atom.elements]
        return _compared_conjunct(node, [], _guards(node.atom), inside)
    if kind is _TYPE.ConditionalLiteral:
        return _compared_conjunct(node, [], [], [_inner((node.literal,), node.condition)])
    return Conjunct(str(node), names_in(node), is_seen=kind is _TYPE.BooleanConstant)


def _atom_conjunct(node: SyntaxNode) -> Conjunct:
    names = names_in(node)
    if node.sign != ast.Sign.NoSign:
        return Conjunct(str(node), names, names)
    bound = _taken_apart(node)
    return Conjunct(str(node), names, names, bound, is_all=bound == names)


def _compared_conjunct(
    node: SyntaxNode,
    terms: Sequence[SyntaxNode],
    guards: Sequence[tuple[int, SyntaxNode]],
    inside: Sequence[tuple[_Inner, bool]],
) -> Conjunct:
    """Return terms, or what is inside an aggregate or condition, compared with others."""
    sides = [*terms, *(term for _, term in guards)]
    is_plain = node.ast_type is _TYPE.ConditionalLiteral or node.sign == ast.Sign.NoSign
    signs = [sign for sign, _ in guards]
    made = [names_in(each) for each in terms] + [each.names for each, _ in inside]
    equal: list[tuple[str, frozenset[str]]] = []
    if is_plain and signs == [_EQUAL]:
        equal = [(each, _NONE.union(*made)) for each in _variable_names(sides[-1])]
        equal += [(each, names_in(sides[-1])) for term in terms for each in _variable_names(term)]
    return Conjunct(
        str(node),
        names_in(node),
        _NONE.union(*map(names_in, sides)),
        equal=tuple(equal),
        inner=tuple(each for each, _ in inside),
        is_seen=all(seen for _, seen in inside) and not any(map(_is_anonymous, sides)),
        is_all=is_plain and _EQUAL not in signs,
    )


def _guards(aggregate: SyntaxNode) -> list[tuple[int, SyntaxNode]]:
    found = (aggregate.left_guard, aggregate.right_guard)
    return [(guard.comparison, guard.term) for guard in found if guard is not None]


def _variable_names(term: SyntaxNode) -> tuple[str, ...]:
    return (term.name,) if term.ast_type is _TYPE.Variable else ()


def _inner(told: Iterable[SyntaxNode], condition: Iterable[SyntaxNode]) -> tuple[_Inner, bool]:
    """Return an element with its condition, and whether all that is bound in it shows."""
    nodes, literals = tuple(told), tuple(map(conjunct, condition))
    names = _NONE.union(*map(names_in, nodes), *(each.names for each in literals))
    bound = _NONE.union(*(each.bound for each in literals))
    is_seen = all(each.is_seen for each in literals) and not any(map(_is_anonymous, nodes))
    return _Inner(names, bound), is_seen


def _is_anonymous(node: SyntaxNode) -> bool:
    """Whether a tree holds a variable without a name."""
    return any(each.ast_type is _TYPE.Variable and each.name == "_" for each in below(node))


def _taken_apart(literal: SyntaxNode) -> frozenset[str]:
    """Return the variables that an atom binds by arguments that only take values apart."""
    found: set[str] = set()
    rest = list(sign_and_function(literal.atom.symbol)[1].arguments)
    while rest:
        term = rest.pop()
        if term.ast_type is _TYPE.Function and not term.external:
            rest += term.arguments
        elif term.ast_type is _TYPE.Variable and term.name != "_":
            found.add(term.name)
    return frozenset(found)


def _with_names(known: frozenset[str], names: Mapping[str, str]) -> frozenset[str]:
    return frozenset(names.get(each, each) for each in known)


def outer(literal: SyntaxNode) -> frozenset[str]:
    """Return the variables of a literal, or head, outside of its elements."""
    atom = literal.atom if literal.ast_type == _TYPE.Literal else literal
    if atom.ast_type in AGGREGATES:
        guards = (guard for guard in (atom.left_guard, atom.right_guard) if guard is not None)
        return _NONE.union(*map(names_in, guards))
    if atom.ast_type in (_TYPE.ConditionalLiteral, _TYPE.Disjunction):
        return frozenset()
    return names_in(literal)
