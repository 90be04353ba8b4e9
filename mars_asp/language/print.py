"""Canonical text of configurations and specifications, as the figures of the paper print them."""

from collections.abc import Iterable, Iterator
from decimal import Decimal

from mars_asp.language.parse import ABSTRACT
from mars_asp.model import Configuration, Control, Conversion, Data, Mount, Relationship

WIDTH = 72


def print_configuration(configuration: Configuration) -> str:
    """Return a configuration or specification as text; module blocks are not part of it."""
    return "".join(f"{line}\n" for line in _lines(configuration))


def print_relationship(relationship: Relationship) -> str:
    """Return the line of a relationship."""
    match relationship:
        case Data(client, source, _, mode, hz):
            words = [client, "uses_data_from", source]
            if mode is not None:
                words.append(mode.text or mode.name)
            if hz is not None:
                words.append(print_number(hz))
        case Control(controlled, controller, _, priority, hold, allocation):
            words = [controlled, "is_controlled_by", controller]
            if priority is not None:
                words.append(str(priority))
            if hold is not None:
                words += ["hold", str(hold)]
            if allocation is not None:
                words += ["allocation", allocation]
        case Mount(mounting, mounted, _, at, on, transformation):
            words = [mounting, *_number(at), "is_mounted_on", mounted, *_number(on)]
            if transformation is not None:
                words.append(transformation.text)
    return " ".join(words)


def print_number(number: Decimal) -> str:
    """Return a number without exponent and trailing zeros."""
    text = format(number, "f")
    return text.rstrip("0").rstrip(".") if "." in text else text


def fill(head: str, parts: Iterable[str]) -> Iterator[str]:
    """Yield the lines of a list, broken behind parts; none begins with `@`, as a block does."""
    line = head
    for part in parts:
        if len(line) + 1 + len(part) > WIDTH and line != head and not part.startswith("@"):
            yield line
            line = part
        else:
            line = f"{line} {part}"
    yield line


def _lines(configuration: Configuration) -> Iterator[str]:
    header = f"@{configuration.kind}"
    if configuration.stated:
        header += f" {configuration.architecture}"
    if configuration.period_ms is not None:
        header += f" period {configuration.period_ms}"
    yield header
    if configuration.sources:
        paths = [name.text for name in configuration.sources]
        yield from fill("@sources", [*(f"{path}," for path in paths[:-1]), *paths[-1:]])
    names = [name.text for name in configuration.modules]
    yield from fill("@modules", [*(f"{name}," for name in names[:-1]), *names[-1:]])
    conversions = {c.transformer: c for c in configuration.conversions}
    for relationship in configuration.relationships:
        if isinstance(relationship, Data) and relationship.client in conversions:
            yield _conversion(conversions[relationship.client])
        yield print_relationship(relationship)


def _conversion(conversion: Conversion) -> str:
    converter = conversion.converter or ABSTRACT
    return f"// {conversion.transformer}: {converter} ({conversion.source} -> {conversion.target})"


def _number(number: int | None) -> tuple[str, ...]:
    return () if number is None else (str(number),)
