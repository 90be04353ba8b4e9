"""Conditions of launch files as tests of arguments that users may set."""

import re
from collections.abc import Iterator

from mars_asp.diagnostic import Span
from mars_asp.exchange.ros2.actions import UNKNOWN, LaunchArgument, Part, Test, Tests, Text, text_of
from mars_asp.exchange.ros2.python_values import Listed, PythonCall, Value, text_from

#: The part of a number in an expression.
_HELD = "\0{}\0"
_PART = r"['\"]?\s*\0(?P<part>[0-9]+)\0\s*['\"]?"
_TRUTH = re.compile(
    rf"(?P<no>not\s+)?\(?{_PART}\)?(?:\s*==\s*['\"]?(?P<truth>[Tt]rue|[Ff]alse)['\"]?)?"
)
_EQUAL = re.compile(rf"{_PART}\s*(?P<sign>==|!=)\s*['\"](?P<value>[^'\"]*)['\"]")
_EQUAL_TO = re.compile(rf"['\"](?P<value>[^'\"]*)['\"]\s*(?P<sign>==|!=)\s*{_PART}")


def tests_of(condition: Value, span: Span) -> Tests:
    """Return the tests of the condition of an action in Python, none without a condition."""
    if condition is None:
        return ()
    if not isinstance(condition, PythonCall):
        return (Test(UNKNOWN, None, True, span),)
    first = condition.arguments[0] if condition.arguments else None
    at = condition.span
    match condition.name:
        case "IfCondition" | "UnlessCondition":
            given = condition.named.get("predicate_expression", first)
            return tuple(_of_value(given, condition.name == "IfCondition", at))
        case "LaunchConfigurationEquals" | "LaunchConfigurationNotEquals":
            name = text_from(condition.get("launch_configuration_name", 0))
            value = text_from(condition.get("expected_value", 1))
            wanted = condition.name == "LaunchConfigurationEquals"
            if len(name) == 1 and isinstance(name[0], str):
                return (Test((LaunchArgument(name[0]),), value, wanted, at),)
    return (Test(UNKNOWN, None, True, at),)


def _of_value(value: Value, wanted: bool, span: Span) -> Iterator[Test]:
    while isinstance(value, Listed) and len(value.items) == 1:
        [value] = value.items
    if not isinstance(value, PythonCall):
        yield from tests_of_text(text_from(value), wanted, span)
        return
    first = value.arguments[0] if value.arguments else None
    match value.name:
        case "PythonExpression":
            text = text_from(first if first is not None else value.named.get("expression"))
            yield from tests_of_text(text, wanted, span)
        case "NotSubstitution":
            yield from _of_value(first, not wanted, span)
        case "EqualsSubstitution" | "NotEqualsSubstitution" if len(value.arguments) == 2:
            is_equal = value.name == "EqualsSubstitution"
            left, right = map(text_from, value.arguments)
            yield Test(left, right, wanted == is_equal, span)
        case "AndSubstitution" if wanted:
            for each in value.arguments:
                yield from _of_value(each, True, span)
        case _:
            parts = [text_from(each) for each in value.arguments]
            yield Test(text_of(f"{value.name} ", *parts, *UNKNOWN), None, wanted, span)


def tests_of_text(text: Text, wanted: bool, span: Span) -> Iterator[Test]:
    """Yield tests that hold if an expression is true or, if not `wanted`, false."""
    held: list[Part] = [part for part in text if not isinstance(part, str)]
    if not held and wanted and text_of(*text) == ():
        return
    numbers = iter(range(len(held)))
    shown = "".join(part if isinstance(part, str) else _HELD.format(next(numbers)) for part in text)
    pieces = [each.strip() for each in shown.split(" and ")] if wanted else [shown.strip()]
    for piece in pieces:
        truth, equal = (
            _TRUTH.fullmatch(piece),
            _EQUAL.fullmatch(piece) or _EQUAL_TO.fullmatch(piece),
        )
        if truth is not None:
            is_true = (truth["truth"] or "true").lower() == "true"
            yield Test(
                (held[int(truth["part"])],), None, wanted == (is_true != bool(truth["no"])), span
            )
        elif equal is not None:
            value = (equal["value"],) if equal["value"] else ()
            same = equal["sign"] == "=="
            yield Test((held[int(equal["part"])],), value, wanted == same, span)
        elif len(pieces) == 1 and len(held) <= 1 and len(text) == 1:
            yield Test(text, None, wanted, span)
        else:
            parts = [held[int(number)] for number in re.findall(r"\0([0-9]+)\0", piece)]
            yield Test(
                text_of(re.sub(r"\0[0-9]+\0", "_", piece), *parts, *UNKNOWN), None, wanted, span
            )
