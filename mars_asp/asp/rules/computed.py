"""Further rules that tell with what values a rule computes, so that Python can compute it, too.

Clingo's integers wrap at 32 bits without a word. What a rule computes is told wherever the other
literals hold that do not themselves depend on it.
"""

from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

from clingo import ast

from mars_asp.asp.cache import memoized
from mars_asp.asp.rules import binding, statements
from mars_asp.asp.rules.binding import AGGREGATES, Conjunct, conjunct, outer, unbound, written
from mars_asp.asp.rules.statements import (
    ArithmeticReader,
    Operand,
    Operation,
    Place,
    rule_operands,
    variants,
)
from mars_asp.asp.rules.trees import SyntaxNode, names_in

_TYPE = ast.ASTType
#: What never leaves 32 bits where its operands do not.
_FITS = frozenset({"&", "?", "^", "~", "/", "\\", ""})
_SUMS = (ast.AggregateFunction.Sum, ast.AggregateFunction.SumPlus)


class Computed(NamedTuple):
    """An operation of a rule, and the body behind which its `leaves` have their values."""

    operation: Operation
    leaves: tuple[str, ...]
    body: str


class Summed(NamedTuple):
    """An element of a sum, and the body behind which it counts.

    Elements of one sum in one rule, at one `place`, are added for each of the values of `shared`,
    those that are `negative` if that is said.
    """

    place: Place
    negative: bool
    terms: tuple[str, ...]
    shared: tuple[str, ...]
    body: str


class _Site(NamedTuple):
    """A tree, the literals that hold beside it, and the one that it is part of, if it can bind."""

    node: SyntaxNode
    beside: tuple[Conjunct, ...]
    own: tuple[Conjunct, ...] = ()


def computations(texts: Iterable[str]) -> dict[str, tuple[Computed | Summed, ...]]:
    """Return the operations of each of some rules that could leave 32 bits."""
    files = map(Path, (__file__, binding.__file__, statements.__file__, ast.__file__))
    # Most rules compute nothing.
    asked = (text for text in texts if "#sum" in text or any(map(_is_open, rule_operands(text))))
    return memoized("computations", files, asked, _computations)


def _is_open(operand: Operand) -> bool:
    """Whether an operation has values that only grounding tells, and may not fit."""
    return isinstance(operand, Operation) and bool(leaves(operand)) and not _fits(operand)


def _fits(operand: Operand) -> bool:
    if isinstance(operand, Operation):
        return operand.sign in _FITS and all(map(_fits, operand.operands))
    return True


def leaves(operand: Operand) -> tuple[str, ...]:
    """Return the operands of an operation besides numbers, each once."""
    if isinstance(operand, Operation):
        found = (leaf for inner in operand.operands for leaf in leaves(inner))
        return tuple(dict.fromkeys(found))
    return (operand,) if isinstance(operand, str) else ()


def _computations(text: str) -> tuple[Computed | Summed, ...]:
    found: dict[Computed | Summed, None] = {}
    reader = ArithmeticReader(text)
    for rule in variants(text):
        beside = _beside(rule)
        for site in _sites(rule, beside):
            for operation in reader.outermost(site.node):
                if isinstance(operation, Operation) and _is_open(operation):
                    result = leaves(operation)
                    body = _body(result, site)
                    if body is not None:
                        found[Computed(operation, result, written(body))] = None
        found.update((summed, None) for summed in _sums(rule, beside, reader))
    return tuple(found)


def _sites(rule: SyntaxNode, beside: tuple[Conjunct, ...]) -> Iterator[_Site]:
    """Yield the parts of a rule that hold apart from others, each where these do."""
    yield from _head_sites(rule.head, beside)
    for number, literal in enumerate(rule.body):
        rest = (*beside[:number], *beside[number + 1 :])
        atom = literal.atom if literal.ast_type == _TYPE.Literal else literal
        if atom.ast_type in AGGREGATES:
            yield from _aggregate_sites(atom, rest)
        elif literal.ast_type == _TYPE.ConditionalLiteral:
            yield from _element_sites((literal.literal,), literal.condition, rest)
        else:
            yield _Site(literal, rest, (conjunct(literal),))


def _beside(rule: SyntaxNode) -> tuple[Conjunct, ...]:
    """Return the body of a rule with other names for what its elements have for themselves.

    So they can stand beside an element that has taken its place among them.
    """
    known = names_in(rule)
    body = tuple(map(conjunct, rule.body))
    shared = frozenset[str]().union(*map(outer, (rule.head, *rule.body)))
    if known == shared:
        return body
    suffix = "_"
    while any(f"{name}{suffix}" in known for name in known):
        suffix += "_"
    apart = {name: f"{name}{suffix}" for name in known - shared}
    return tuple(literal.renamed(apart) for literal in body)


def _head_sites(head: SyntaxNode, body: tuple[Conjunct, ...]) -> Iterator[_Site]:
    match head.ast_type:
        case _TYPE.Aggregate | _TYPE.HeadAggregate:
            yield from _aggregate_sites(head, body)
        case _TYPE.Disjunction:
            for element in head.elements:
                yield from _element_sites((element.literal,), element.condition, body)
        case _:
            yield _Site(head, body)


def _aggregate_sites(aggregate: SyntaxNode, rest: tuple[Conjunct, ...]) -> Iterator[_Site]:
    for guard in (aggregate.left_guard, aggregate.right_guard):
        if guard is not None:
            yield _Site(guard, rest)
    for element in aggregate.elements:
        match aggregate.ast_type:
            case _TYPE.Aggregate:
                yield from _element_sites((element.literal,), element.condition, rest)
            case _TYPE.BodyAggregate:
                yield from _element_sites(element.terms, element.condition, rest)
            case _:
                entries = (*element.terms, element.condition.literal)
                yield from _element_sites(entries, element.condition.condition, rest)


def _element_sites(
    told: Iterable[SyntaxNode], condition: Iterable[SyntaxNode], rest: tuple[Conjunct, ...]
) -> Iterator[_Site]:
    nodes = tuple(condition)
    literals = tuple(map(conjunct, nodes))
    for node in told:
        yield _Site(node, (*rest, *literals))
    for number, node in enumerate(nodes):
        others = (*literals[:number], *literals[number + 1 :])
        yield _Site(node, (*rest, *others), (literals[number],))


def _sums(
    rule: SyntaxNode, beside: tuple[Conjunct, ...], reader: ArithmeticReader
) -> Iterator[Summed]:
    aggregates = [(rule.head, beside)]
    for number, literal in enumerate(rule.body):
        if literal.ast_type == _TYPE.Literal:
            aggregates.append((literal.atom, (*beside[:number], *beside[number + 1 :])))
    for aggregate, rest in aggregates:
        if aggregate.ast_type not in AGGREGATES or aggregate.ast_type == _TYPE.Aggregate:
            continue
        if aggregate.function not in _SUMS:
            continue
        names, outside = sorted(names_in(aggregate)), frozenset(rest)
        # An element without a term weighs nothing.
        for element in filter(lambda each: each.terms, aggregate.elements):
            condition = element.condition
            if aggregate.ast_type == _TYPE.HeadAggregate:
                condition = condition.condition
            terms = tuple(map(str, element.terms))
            kept = _body(terms, _Site(aggregate, (*rest, *map(conjunct, condition))))
            if kept is not None:
                varying = unbound(names, [each for each in kept if each in outside])
                shared = tuple(name for name in names if name not in varying)
                negative = aggregate.function == ast.AggregateFunction.Sum
                yield Summed(reader.place(aggregate), negative, terms, shared, written(kept))


def _body(values: Sequence[str], site: _Site) -> tuple[Conjunct, ...] | None:
    """Return literals beside a tree that bind all values, or None if none do.

    Left out are those with a variable that nothing else binds than what is computed.
    """
    kept = site.beside
    for own in ((), site.own):
        while missing := unbound(values, (*kept, *own)):
            bound = tuple(literal for literal in kept if not literal.names & missing)
            if len(bound) == len(kept):
                break
            kept = bound
        else:
            return (*kept, *own)
    whole = (*site.beside, *site.own)
    return None if unbound(values, whole) else whole
