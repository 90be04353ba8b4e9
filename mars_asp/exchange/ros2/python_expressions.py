"""Values of expressions in Python that is not run.

The names are of a scope, whose type is that of a subclass: the variables of a launch file as it
goes, or the location in the source of a node.
"""

import ast
from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from fractions import Fraction
from functools import cache
from itertools import zip_longest
from math import isfinite
from typing import Generic, TypeVar

from mars_asp.diagnostic import Span
from mars_asp.exchange.ros2.actions import UNKNOWN, Text, text_of
from mars_asp.exchange.ros2.python_values import (
    MOST_BITS,
    MOST_ITEMS,
    Listed,
    MappedValue,
    Names,
    NoneValue,
    Plain,
    Value,
    combined,
    filled,
    inserted,
    items_of,
    picked,
    text_from,
)

Scope = TypeVar("Scope")

_ARITHMETIC = (ast.Add, ast.Mult, ast.Div)
#: To copy so many items counts as one step.
ITEMS_A_STEP = 20


class ExpressionEvaluator(ABC, Generic[Scope]):
    """Evaluates expressions up to the depth `deepest`, and up to `most_steps` in total."""

    most_steps: int
    deepest: int

    def __init__(self) -> None:
        """Begin to count steps."""
        self.steps = 0
        self.constant = cache(self.literal_value)

    @abstractmethod
    def span(self, node: ast.expr | ast.stmt) -> Span:
        """Return the location of an expression."""

    @abstractmethod
    def variable_value(self, node: ast.Name | ast.Attribute, scope: Scope, depth: int) -> Value:
        """Return the value of a variable or an attribute; None if unknown."""

    @abstractmethod
    def call_value(self, node: ast.Call, scope: Scope, depth: int) -> Value:
        """Return the value of a call; None if unknown."""

    @abstractmethod
    def alternative(self, node: ast.IfExp, scope: Scope) -> int | None:
        """Return 0 to evaluate the first value of `a if c else b`, 1 the other, None neither."""

    def value(self, node: ast.expr, scope: Scope, depth: int = 0) -> Value:
        """Return the value of an expression, or None if it is not known without a run."""
        self.steps += 1
        if self.steps > self.most_steps or depth > self.deepest:
            return None
        match node:
            # The most frequent come first.
            case ast.Constant():
                return self.constant(node)
            case ast.Call():
                return self.call_value(node, scope, depth)
            case ast.Name() | ast.Attribute():
                return self.variable_value(node, scope, depth)
            case ast.List(elts=items) | ast.Tuple(elts=items) | ast.Set(elts=items):
                return Listed(list(self.elements(items, scope, depth)), self.span(node))
            case ast.Dict(keys=keys, values=values):
                return self.mapped(keys, values, scope, depth)
            case ast.JoinedStr(values=values):
                parts = [self.formatted(value, scope, depth) for value in values]
                return Plain(text_of(*parts), self.span(node))
            case ast.BinOp(op=ast.Mod()):
                form = text_from(self.value(node.left, scope, depth + 1))
                given = self.value(node.right, scope, depth + 1)
                holes = items_of(given) if isinstance(node.right, ast.Tuple) else [given]
                return Plain(filled(form, holes, {}, by_percent=True), self.span(node))
            case ast.BinOp(op=ast.Add() | ast.Mult() | ast.Div()):
                return self.binary(node, scope, depth)
            case ast.IfExp(body=body, orelse=orelse):
                chosen = self.alternative(node, scope)
                if chosen is None:
                    return None
                return self.value((body, orelse)[chosen], scope, depth + 1)
            case ast.Subscript():
                return self.item(node, scope, depth)
            case ast.Starred(value=value):
                return self.value(value, scope, depth + 1)
            case _:
                return self.other_value(node, scope, depth)

    def other_value(self, node: ast.expr, scope: Scope, depth: int) -> Value:
        """Return the value of an expression that only a subclass can read; here None."""
        return None

    def item(self, node: ast.Subscript, scope: Scope, depth: int) -> Value:
        """Return an item of a list or dictionary; None if unknown."""
        owner = self.value(node.value, scope, depth + 1)
        return picked(owner, self.value(node.slice, scope, depth + 1))

    def literal_value(self, node: ast.Constant) -> Value:
        """Return the value of a literal; None for one that is not needed."""
        match node.value:
            case bool() as truth:
                return Plain((str(truth),), self.span(node))
            case int() | float() as number if not isinstance(number, int) or (
                number.bit_length() <= MOST_BITS
            ):
                exact = Fraction(repr(number)) if isfinite(number) else None
                return Plain((repr(number),), self.span(node), exact)
            case str() as text:
                return Plain(text_of(text), self.span(node))
            case None:
                return NoneValue()
            case _:
                return None

    def elements(self, items: Sequence[ast.expr], scope: Scope, depth: int) -> Iterator[Value]:
        """Yield the values of list elements; `*x` is unpacked, up to `MOST_ITEMS`."""
        left = MOST_ITEMS
        for item in items:
            found = self.value(item, scope, depth + 1)
            if isinstance(item, ast.Starred):
                starred = items_of(found)[: max(left, 0)]
                left -= len(starred)
                # A list that doubles is copied each time.
                self.steps += len(starred) // ITEMS_A_STEP
                yield from starred
            elif found is None:
                yield Plain(UNKNOWN, self.span(item))
            else:
                yield found

    def mapped(
        self,
        keys: Sequence[ast.expr | None],
        values: Sequence[ast.expr],
        scope: Scope,
        depth: int,
    ) -> MappedValue:
        """Return the value of a dictionary; a key of None unpacks another dictionary (`**x`)."""
        pairs: list[tuple[Value, Value]] = []
        for key, value in zip(keys, values, strict=True):
            found = self.value(value, scope, depth + 1)
            if key is None:
                inner = found.pairs if isinstance(found, MappedValue) else ()
                pairs += inner[: max(MOST_ITEMS - len(pairs), 0)]
                self.steps += len(inner) // ITEMS_A_STEP
            else:
                pairs.append((self.value(key, scope, depth + 1), found))
        return MappedValue(tuple(pairs))

    def formatted(self, node: ast.expr, scope: Scope, depth: int) -> Text:
        """Return the text of one element of an f-string."""
        if not isinstance(node, ast.FormattedValue):
            return text_from(self.value(node, scope, depth + 1))
        found = inserted(self.value(node.value, scope, depth + 1))
        return UNKNOWN if node.format_spec else found

    def binary(self, node: ast.BinOp, scope: Scope, depth: int) -> Value:
        """Return a sum, product or path (`a / b`); iterates over chains such as `a + b + c`."""
        left = node.left
        chain = [(node.op, node.right)]
        while isinstance(left, ast.BinOp) and isinstance(left.op, _ARITHMETIC):
            chain.append((left.op, left.right))
            left = left.left
        found = self.value(left, scope, depth + 1)
        self.steps += len(items_of(found)) // ITEMS_A_STEP
        for sign, operand in reversed(chain):
            added = self.value(operand, scope, depth + 1)
            found = combined(sign, found, added, self.span(node))
        return found

    def given(
        self, node: ast.Call, scope: Scope, depth: int
    ) -> tuple[tuple[Value, ...], dict[str, Value]]:
        """Return the evaluated positional and named arguments of a call."""
        named: dict[str, Value] = {}
        arguments = tuple(self.elements(node.args, scope, depth + 1))
        for keyword in node.keywords:
            found = self.value(keyword.value, scope, depth + 1)
            if keyword.arg is not None:
                named[keyword.arg] = found
            elif isinstance(found, MappedValue):
                for key, value in found.pairs:
                    named["".join(p for p in text_from(key) if isinstance(p, str))] = value
        return arguments, named


def bind(target: ast.expr, value: Value, names: Names) -> None:
    """Assign a value to a name in `names`, or its items to several."""
    match target:
        case ast.Name(id=name):
            names[name] = value
        case ast.Tuple(elts=targets) | ast.List(elts=targets):
            for each, item in zip_longest(targets, items_of(value)[: len(targets)]):
                bind(each, item, names)
