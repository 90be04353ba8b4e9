"""Results as lines or as JSON, which may be nested too deeply for the standard library."""

import argparse
import json
from collections.abc import Callable, Iterable


class _Written(str):
    """Text that is already encoded as JSON."""

    __slots__ = ()


def encoded(value: object) -> str:
    """Return a value as JSON text; it may be nested very deeply."""
    try:
        return json.dumps(value)
    except RecursionError:
        return "".join(_encoded_parts(value))


def print_result(
    arguments: argparse.Namespace, document: Callable[[], object], lines: Iterable[str]
) -> None:
    """Print the document of a result if the format is JSON, else its lines."""
    if arguments.format == "json":
        print(encoded(document()))
    else:
        for line in lines:
            print(line)


def _encoded_parts(value: object) -> list[str]:
    parts: list[str] = []
    stack: list[object] = [value]
    while stack:
        item = stack.pop()
        inside: list[object] = []
        match item:
            case _Written():
                parts.append(item)
                continue
            case dict():
                for key, held in item.items():
                    inside += [_Written(f"{', ' if inside else ''}{json.dumps(key)}: "), held]
                inside = [_Written("{"), *inside, _Written("}")]
            case list() | tuple():
                for held in item:
                    inside += [_Written(", "), held] if inside else [held]
                inside = [_Written("["), *inside, _Written("]")]
            case _:
                inside = [_Written(json.dumps(item))]
        stack += reversed(inside)
    return parts
