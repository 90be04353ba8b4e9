"""JSON text of values that may be nested more deeply than the standard library can encode."""

import json


class _Written(str):
    """Text that is JSON already."""

    __slots__ = ()


def encoded(value: object) -> str:
    """Return a value of dictionaries, lists and plain values as JSON; traces may be very deep."""
    try:
        return json.dumps(value)
    except RecursionError:
        return "".join(_encoded_parts(value))


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
