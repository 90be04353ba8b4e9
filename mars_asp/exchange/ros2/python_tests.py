"""Conditions of statements in launch files in Python, as tests of launch arguments."""

import ast
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

from mars_asp.diagnostic import Span
from mars_asp.exchange.ros2.actions import LaunchArgument, Test, Text, plain
from mars_asp.exchange.ros2.conditions import tests_of
from mars_asp.exchange.ros2.python_values import (
    Listed,
    MappedValue,
    NoneValue,
    Plain,
    PythonCall,
    Value,
)

#: Texts that mean true or false, lower case.
_TRUE, _FALSE = frozenset({"true", "1"}), frozenset({"false", "0"})
#: Texts of literals that need not be texts, so that their truth is unknown.
_AMBIGUOUS = frozenset({"True", "False", "0", "0.0"})
#: Methods after which an argument is compared by the same value.
_SAME = frozenset({"perform", "lower", "strip"})
_MOST_PARTS = 20

#: The value of an expression, and of a name.
Evaluate = Callable[[ast.expr], Value]


class Tested(NamedTuple):
    """The tests that a condition implies; `is_complete` if they imply the condition as well."""

    tests: tuple[Test, ...] = ()
    is_complete: bool = False


def tested(node: ast.expr, value: Evaluate, span: Span) -> Tested:
    """Return the condition of a statement as tests of launch arguments.

    `value` evaluates an expression, `span` is the location of the tests.
    """
    match node:
        case ast.BoolOp(op=ast.And(), values=parts):
            each = [tested(part, value, span) for part in parts[:_MOST_PARTS]]
            is_complete = len(parts) == len(each) and all(part.is_complete for part in each)
            return Tested(tuple(test for part in each for test in part.tests), is_complete)
        case ast.UnaryOp(op=ast.Not(), operand=inner):
            tests, is_complete = tested(inner, value, span)
            if not is_complete or len(tests) != 1:
                return Tested()
            return Tested((replace(tests[0], wanted=not tests[0].wanted),), True)
        case ast.Compare(left=left, ops=[operator], comparators=[ast.Constant() as right]) if (
            isinstance(operator, ast.Is | ast.IsNot | ast.Eq | ast.NotEq)
            and (right.value is None or _is_none(left, value))
        ):
            is_same = isinstance(operator, ast.Is | ast.Eq)
            if _is_none(left, value):
                return _literal((right.value is None) == is_same, span)
            is_known = isinstance(left, ast.Name) and isinstance(value(left), Plain)
            return _literal(not is_same, span) if is_known else Tested()
        case ast.Name() if _is_none(node, value):
            return _literal(False, span)
        case ast.Compare(left=left, ops=[operator], comparators=[right]):
            text = _tested_text(left, value)
            if isinstance(left, ast.Constant) and isinstance(right, ast.Name):
                text = (str(left.value),)
            return _comparison(text, operator, _items(right, value), span)
        case ast.Call(
            func=ast.Attribute(
                value=ast.Call(func=ast.Name(id="IfCondition" | "UnlessCondition")) as made,
                attr="evaluate",
            )
        ):
            condition = value(made)
            tests = tests_of(condition, span) if isinstance(condition, PythonCall) else ()
            tests = tuple(replace(test, span=span) for test in tests)
            return Tested(tests, len(tests) == 1)
        case _:
            text = _tested_text(node, value)
            if text is None or plain(text) in _AMBIGUOUS:
                return Tested()
            # A text is true if it is not empty.
            return Tested((Test(text, (), False, span),), True)


def _literal(holds: bool, span: Span) -> Tested:
    """Return the test that always holds, or never if `holds` is false, at `span`."""
    return Tested((Test(("true",), None, holds, span),), True)


def _items(node: ast.expr, value: Evaluate) -> Sequence[str | None] | str | None:
    """Return the literal on the right of a comparison, or the items or keys of a value there.

    None is a value that is not known.
    """
    match node:
        case ast.Constant(value=literal):
            return str(literal)
        case ast.Tuple(elts=items) | ast.List(elts=items) | ast.Set(elts=items):
            return [str(each.value) if isinstance(each, ast.Constant) else None for each in items]
        case ast.Name():
            found = value(node)
            if isinstance(found, MappedValue):
                found = Listed([key for key, _ in found.pairs])
            if isinstance(found, Listed):
                return [
                    plain(each.text) if isinstance(each, Plain) else None for each in found.items
                ]
    return None


def _comparison(
    text: Text | None,
    operator: ast.cmpop,
    right: Sequence[str | None] | str | None,
    span: Span,
) -> Tested:
    """Return the test of a comparison with a literal or the items of a list."""
    is_list = isinstance(operator, ast.In | ast.NotIn)
    items = [right] if right is None or isinstance(right, str) else right
    values = [each for each in items if each is not None and each != "None"]
    if text is None or len(values) < len(items) or is_list == isinstance(right, str):
        return Tested()
    wanted = isinstance(operator, ast.Eq | ast.In | ast.Is)
    if not wanted and not isinstance(operator, ast.NotEq | ast.NotIn | ast.IsNot):
        return Tested()
    if is_list and (known := plain(text)) is not None:
        return _literal((known in values) == wanted, span)
    lower = {each.lower() for each in values}
    for truths, is_true in ((_TRUE, True), (_FALSE, False)):
        if lower <= truths and lower & {"true", "false"}:
            return Tested((Test(text, None, wanted == is_true, span),), True)
    if len(values) != 1:
        return Tested()
    written = (values[0],) if values[0] else ()
    return Tested((Test(text, written, wanted, span),), True)


def _is_none(node: ast.expr, value: Evaluate) -> bool:
    return isinstance(node, ast.Name) and isinstance(value(node), NoneValue)


def _tested_text(node: ast.expr, value: Evaluate) -> Text | None:
    """Return the text if an expression is a known text or one launch argument, else None."""
    for _ in range(_MOST_PARTS):
        match node:
            case ast.Call(func=ast.Attribute(attr="perform_substitution"), args=[inner, *_]):
                node = inner
            case ast.Call(func=ast.Attribute(value=inner, attr=attr)) if attr in _SAME:
                node = inner
            case _:
                break
    found = None if isinstance(node, ast.Constant) else value(node)
    if not isinstance(found, Plain):
        return None
    text = found.text
    is_argument = len(text) == 1 and isinstance(text[0], LaunchArgument)
    return text if is_argument or plain(text) is not None else None


def truth(node: ast.expr, value: Value) -> bool | None:
    """Return whether the value of an expression is true, or None if only a run knows it."""
    match value:
        case _ if isinstance(node, ast.Constant):
            return bool(node.value)
        case Listed(items=parts) | MappedValue(pairs=parts):
            return len(parts) > 0
        case Plain(text=text):
            written = plain(text)
            return None if written is None or written in _AMBIGUOUS else written != ""
        case _:
            # A call that was not evaluated may return anything.
            is_open = value is None or isinstance(value, PythonCall)
            return None if is_open else not isinstance(value, NoneValue)


def is_configurations(node: ast.expr) -> bool:
    """Whether an expression is `context.launch_configurations`."""
    return isinstance(node, ast.Attribute) and node.attr == "launch_configurations"


def decision(tests: Tested) -> bool | None:
    """Return whether a condition of constants holds, or None if it depends on an argument."""
    results = [
        plain(test.text) == plain(test.value)
        if test.value is not None
        else (plain(test.text) or "").lower() in _TRUE
        for test in tests.tests
        if plain(test.text) is not None
    ]
    if not tests.is_complete or len(results) < len(tests.tests) or not results:
        return None
    wanted = [test.wanted for test in tests.tests]
    return all(result == each for result, each in zip(results, wanted, strict=True))


def branch_tests(tests: Tested, name: str, choice: int, span: Span) -> Iterator[Test]:
    """Yield the tests for branch `choice` (0: true) of a condition, which is called `name`."""
    is_single = tests.is_complete and len(tests.tests) == 1
    if choice == 0:
        yield from tests.tests
    elif is_single:
        yield replace(tests.tests[0], wanted=not tests.tests[0].wanted)
    if not is_single:
        is_implied = choice == 0 and tests.is_complete
        yield Test((name,), ("true",), choice == 0, span, branch=True, implied=is_implied)
