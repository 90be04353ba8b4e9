"""Glue that a robot has already, as nodes of a specification."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from itertools import count

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


def with_origins(printed: str, configuration: Configuration) -> str:
    """Return a configuration as it is printed, each relationship with where it is from.

    Relationships are printed last, each on a line of its own.
    """
    spans = [line.span for line in configuration.relationships]
    lines = printed.splitlines()
    heads, related = lines[: -len(spans)], lines[-len(spans) :]
    told = [
        f"{line}  // from {visible(s.path)}:{s.line}"
        for line, s in zip(related, spans, strict=True)
    ]
    return "\n".join((*heads, *told, ""))
