"""Glue that a robot has already, as nodes of a specification."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from itertools import count

from mars_asp.diagnostic import Span
from mars_asp.language.print import print_configuration, print_module
from mars_asp.model.declarations import NODE_NAMES, Configuration, Control, Name, Relationship
from mars_asp.output import visible


def lifted(configuration: Configuration) -> Configuration:
    """Return the specification that a configuration with muxes is: each an ArbitrationNode."""
    taken = {name.text for name in configuration.modules}
    free = (name for name in _arbiters() if name not in taken)
    arbiters = {mux.module: Name(next(free), mux.span) for mux in configuration.muxes}
    to_arbiters = (
        Control(mux.module, arbiters[mux.module].text, mux.span) for mux in configuration.muxes
    )
    inputs = (_led_to(arbiters, line) for line in configuration.relationships)
    return replace(
        configuration,
        kind="specification",
        modules=(*configuration.modules, *arbiters.values()),
        relationships=(*to_arbiters, *inputs),
        muxes=(),
    )


def _led_to(arbiters: Mapping[str, Name], line: Relationship) -> Relationship:
    """Return a relationship, its controlled end an arbiter where there is one before it."""
    if isinstance(line, Control) and line.controlled in arbiters:
        return replace(line, controlled=arbiters[line.controlled].text)
    return line


def _arbiters() -> Iterator[str]:
    stem = NODE_NAMES["arbitration_node"]
    yield stem
    yield from (f"{stem}{number}" for number in count(2))


def with_origins(configuration: Configuration) -> str:
    """Return a configuration as it is printed, each relationship and block with where it is from.

    Relationships are printed last of the body, each on a line of its own.
    """
    printed = print_configuration(replace(configuration, declared=()))
    lines = printed.splitlines()
    first = len(lines) - len(configuration.relationships)
    told = [
        f"{line}  {_origin(related.span)}"
        for line, related in zip(lines[first:], configuration.relationships, strict=True)
    ]
    described = [f"\n{_origin(m.span)}\n{print_module(m)}" for m in configuration.declared]
    return "\n".join((*lines[:first], *told, *described, ""))


def _origin(span: Span) -> str:
    return f"// from {visible(span.path)}:{span.line}"
