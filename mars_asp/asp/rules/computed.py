"""Further rules that tell with what values a rule computes, so that Python can compute it, too.

Clingo's integers wrap at 32 bits without a word. What a rule computes is told wherever the other
literals hold that do not themselves depend on it.
"""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import clingo
from clingo import ast

from mars_asp.asp.cache import made_of
from mars_asp.asp.rules import statements
from mars_asp.asp.rules.statements import (
    ArithmeticReader,
    Operand,
    Operation,
    Place,
    masked,
    rule_operands,
    sign_and_function,
    variables,
    variants,
)
from mars_asp.asp.rules.trees import Node, below, plain

_TYPE = ast.ASTType
_NAME = re.compile(r"_*[A-Z]\w*'*")
_UNSAFE = re.compile(r"note: '(\w+'*)' is unsafe")
#: What never leaves 32 bits where its operands do not.
_FITS = frozenset({"&", "?", "^", "~", "/", "\\", ""})
_AGGREGATES = (_TYPE.Aggregate, _TYPE.BodyAggregate, _TYPE.HeadAggregate)
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

    node: Node
    beside: tuple[Node, ...]
    own: tuple[Node, ...] = ()


def computations(texts: Iterable[str]) -> dict[str, tuple[Computed | Summed, ...]]:
    """Return what each of some rules computes that could leave 32 bits."""
    files = map(Path, (__file__, statements.__file__, ast.__file__))
    # Most rules compute nothing.
    asked = (text for text in texts if "#sum" in text or any(map(_is_open, rule_operands(text))))
    return made_of("computations", files, asked, _computations)


def _is_open(operand: Operand) -> bool:
    """Whether an operation has values that only grounding tells, and may not fit."""
    return isinstance(operand, Operation) and bool(leaves(operand)) and not _fits(operand)


def _fits(operand: Operand) -> bool:
    if isinstance(operand, Operation):
        return operand.sign in _FITS and all(map(_fits, operand.operands))
    return True


def leaves(operand: Operand) -> tuple[str, ...]:
    """Return what an operation is made of besides numbers, each once."""
    if isinstance(operand, Operation):
        found = (leaf for inner in operand.operands for leaf in leaves(inner))
        return tuple(dict.fromkeys(found))
    return (operand,) if isinstance(operand, str) else ()


def _computations(text: str) -> tuple[Computed | Summed, ...]:
    found: dict[Computed | Summed, None] = {}
    reader = ArithmeticReader(text)
    for rule in variants(text):
        for site in _sites(rule):
            for operation in reader.outermost(site.node):
                if isinstance(operation, Operation) and _is_open(operation):
                    told = leaves(operation)
                    body = _body(told, site)
                    if body is not None:
                        found[Computed(operation, told, _text(body))] = None
        found.update((summed, None) for summed in _sums(rule, reader))
    return tuple(found)


def _sites(rule: Node) -> Iterator[_Site]:
    """Yield the parts of a rule that hold apart from others, each where these do."""
    body = tuple(rule.body)
    beside = _beside(rule)
    yield from _head_sites(rule.head, beside)
    for number, literal in enumerate(body):
        rest = (*beside[:number], *beside[number + 1 :])
        atom = literal.atom if literal.ast_type == _TYPE.Literal else literal
        if atom.ast_type in _AGGREGATES:
            yield from _aggregate_sites(atom, rest)
        elif literal.ast_type == _TYPE.ConditionalLiteral:
            yield from _element_sites((literal.literal,), literal.condition, rest)
        else:
            yield _Site(literal, rest, (literal,))


def _beside(rule: Node) -> tuple[Node, ...]:
    """Return the body of a rule with other names for what its elements have for themselves.

    So they can stand beside an element that has taken its place among them.
    """
    known = variables(rule)
    body: tuple[Node, ...] = rule.body
    shared = frozenset[str]().union(*map(_shared, (rule.head, *rule.body)))
    if known == shared:
        return body
    suffix = "_"
    while any(f"{name}{suffix}" in known for name in known):
        suffix += "_"
    apart = _Renaming({name: f"{name}{suffix}" for name in known - shared})
    return tuple(plain(apart(literal.tree)) for literal in body)


def _shared(literal: Node) -> frozenset[str]:
    """Return the variables of a literal, or head, outside of its elements."""
    atom = literal.atom if literal.ast_type == _TYPE.Literal else literal
    if atom.ast_type in _AGGREGATES:
        guards = (guard for guard in (atom.left_guard, atom.right_guard) if guard is not None)
        return frozenset[str]().union(*map(variables, guards))
    if atom.ast_type in (_TYPE.ConditionalLiteral, _TYPE.Disjunction):
        return frozenset()
    return variables(literal)


class _Renaming(ast.Transformer):
    """Gives variables other names."""

    def __init__(self, names: Mapping[str, str]) -> None:
        self._names = names

    def visit_Variable(self, node: ast.AST) -> ast.AST:  # noqa: N802 -- clingo's own name
        name = self._names.get(node.name)
        return node if name is None else node.update(name=name)


def _head_sites(head: Node, body: tuple[Node, ...]) -> Iterator[_Site]:
    match head.ast_type:
        case _TYPE.Aggregate | _TYPE.HeadAggregate:
            yield from _aggregate_sites(head, body)
        case _TYPE.Disjunction:
            for element in head.elements:
                yield from _element_sites((element.literal,), element.condition, body)
        case _:
            yield _Site(head, body)


def _aggregate_sites(aggregate: Node, rest: tuple[Node, ...]) -> Iterator[_Site]:
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
                told = (*element.terms, element.condition.literal)
                yield from _element_sites(told, element.condition.condition, rest)


def _element_sites(
    told: Iterable[Node], condition: Sequence[Node], rest: tuple[Node, ...]
) -> Iterator[_Site]:
    condition = tuple(condition)
    for node in told:
        yield _Site(node, (*rest, *condition))
    for number, literal in enumerate(condition):
        others = (*condition[:number], *condition[number + 1 :])
        yield _Site(literal, (*rest, *others), (literal,))


def _sums(rule: Node, reader: ArithmeticReader) -> Iterator[Summed]:
    beside = _beside(rule)
    aggregates = [(rule.head, beside)]
    for number, literal in enumerate(rule.body):
        if literal.ast_type == _TYPE.Literal:
            aggregates.append((literal.atom, (*beside[:number], *beside[number + 1 :])))
    for aggregate, rest in aggregates:
        if aggregate.ast_type not in _AGGREGATES or aggregate.ast_type == _TYPE.Aggregate:
            continue
        if aggregate.function not in _SUMS:
            continue
        names, texts = sorted(variables(aggregate)), set(map(str, rest))
        # An element without a term weighs nothing.
        for element in filter(lambda each: each.terms, aggregate.elements):
            condition = element.condition
            if aggregate.ast_type == _TYPE.HeadAggregate:
                condition = condition.condition
            terms = tuple(map(str, element.terms))
            kept = _body(terms, _Site(aggregate, (*rest, *condition)))
            if kept is not None:
                outside = tuple(literal for literal in kept if str(literal) in texts)
                shared = tuple(name for name in names if name not in _unbound((name,), outside))
                negative = aggregate.function == ast.AggregateFunction.Sum
                yield Summed(reader.place(aggregate), negative, terms, shared, _text(kept))


def _body(values: Sequence[str], site: _Site) -> tuple[Node, ...] | None:
    """Return literals beside a tree that bind all values; `None` where none do.

    Left out are those with a variable that nothing else binds than what is computed.
    """
    kept = site.beside
    for own in ((), site.own):
        while unbound := _unbound(values, (*kept, *own)):
            bound = tuple(literal for literal in kept if not variables(literal) & unbound)
            if len(bound) == len(kept):
                break
            kept = bound
        else:
            return (*kept, *own)
    whole = (*site.beside, *site.own)
    return None if _unbound(values, whole) else whole


def _unbound(values: Sequence[str], literals: Iterable[Node]) -> frozenset[str]:
    """Return the variables that clingo would say nothing binds."""
    literals = tuple(literals)
    if _are_plain(literals) and {*_named_in(values), *_used(literals)} <= _bound(literals):
        return frozenset()
    said: list[str] = []
    control = clingo.Control(["--warn=none"], lambda _, note: said.append(note))
    try:
        rule = f"_computed({','.join(values)}) :- {_text(literals)}."
        control.add("base", [], masked(rule))
        control.ground([("nothing", [])])
    except RuntimeError:
        # What is anonymous can be bound by nothing else.
        return frozenset({"_"}.union(*map(_UNSAFE.findall, said)))
    return frozenset()


def _are_plain(literals: Iterable[Node]) -> bool:
    """Whether literals are such of which it shows which variables they bind."""
    for literal in literals:
        if literal.ast_type is not _TYPE.Literal:
            return False
        kind = literal.atom.ast_type
        if kind is _TYPE.Comparison and any(_is_anonymous(each) for each in below(literal)):
            return False
        if kind not in (_TYPE.SymbolicAtom, _TYPE.Comparison):
            return False
    return True


def _is_anonymous(node: Node) -> bool:
    return node.ast_type is _TYPE.Variable and node.name == "_"


def _named_in(values: Iterable[str]) -> Iterator[str]:
    """Yield the variables among values; of one that is more than a name, what nothing binds."""
    return (value if _NAME.fullmatch(value) else "" for value in values)


def _used(literals: Iterable[Node]) -> frozenset[str]:
    return frozenset[str]().union(*map(variables, literals))


def _bound(literals: Iterable[Node]) -> frozenset[str]:
    """Return the variables that positive atoms bind by arguments that only take values apart."""
    found: set[str] = set()
    for literal in literals:
        if literal.atom.ast_type is _TYPE.SymbolicAtom and literal.sign == ast.Sign.NoSign:
            rest = list(sign_and_function(literal.atom.symbol)[1].arguments)
            while rest:
                term = rest.pop()
                if term.ast_type is _TYPE.Function and not term.external:
                    rest += term.arguments
                elif term.ast_type is _TYPE.Variable:
                    found.add(term.name)
    return frozenset(found)


def _text(literals: Iterable[Node]) -> str:
    return "; ".join(map(str, literals)) or "#true"
