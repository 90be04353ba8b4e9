"""Modules by the ports that somebody else's file gives them, each a service of its own."""

import re
from collections.abc import Iterable, Iterator
from fractions import Fraction

from mars_asp.diagnostic import Span
from mars_asp.model.declarations import Configuration, Mode, Service
from mars_asp.model.names import read_name, written

_OTHER = re.compile(r"\W+", re.ASCII)


def output(name: str, representation: str | None, span: Span, hz: Fraction | None) -> Service:
    """Return the output of a module; with a rate it delivers at that, else when it has data."""
    mode = "NotifyWhenReady" if hz is None else "NotifyAtFrequency"
    return Service(
        "DataOut",
        span,
        function=_function("send", name),
        output=representation,
        modes=(Mode(mode, text=mode),),
        hz=hz,
        port=name,
    )


def taken(name: str, representation: str | None, span: Span) -> Service:
    """Return the input of a module."""
    return Service(
        "DataIn",
        span,
        function=_function("take", name),
        inputs=(representation,),
        parameters=(name,),
    )


def commands(name: str, span: Span) -> Service:
    """Return what makes a module one that commands flow through."""
    return Service("ControlOut", span, function=_function("command", name))


def _function(verb: str, name: str) -> str:
    """Return a function's name; the verb keeps it from being a word of C++."""
    return f"{verb}_{_OTHER.sub('_', name).strip('_')}"


def unwritable(names: Iterable[str]) -> Iterator[str]:
    """Yield the names that no configuration can write: empty ones, and those of several lines."""
    return (name for name in names if read_name(written(name)) is None)


def names_of(configuration: Configuration) -> frozenset[str]:
    """Return the names of the modules of a configuration."""
    return frozenset(name.text for name in configuration.modules)
