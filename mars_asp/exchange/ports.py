"""Services of modules that are read from foreign files: one for each port."""

import re
from fractions import Fraction

from mars_asp.diagnostic import Diagnostic, MarsError, Span
from mars_asp.model.declarations import Mode, Service
from mars_asp.model.names import read_name, written

#: How many inputs and outputs the modules of a file may have: ten times those of a large robot.
MOST = 50_000
_OTHER = re.compile(r"\W+", re.ASCII)


def output(name: str, representation: str | None, span: Span, hz: Fraction | None) -> Service:
    """Return the service of an output `name`: periodic at `hz`, or when it has data if None."""
    mode = "NotifyWhenReady" if hz is None else "NotifyAtFrequency"
    return Service(
        "DataOut",
        span,
        function=_function_name("send", name),
        output=representation,
        modes=(Mode(mode, text=mode),),
        hz=hz,
        port=name,
    )


def taken(name: str, representation: str | None, span: Span) -> Service:
    """Return the service of an input `name`."""
    return Service(
        "DataIn",
        span,
        function=_function_name("take", name),
        inputs=(representation,),
        parameters=(name,),
    )


def commands(name: str, span: Span) -> Service:
    """Return the `ControlOut` service of a module through which commands flow."""
    return Service("ControlOut", span, function=_function_name("command", name))


def _function_name(verb: str, name: str) -> str:
    """Return a function's name made of a verb and a name, to avoid keywords of C++."""
    return f"{verb}_{_OTHER.sub('_', name).strip('_')}"


def too_many(span: Span) -> MarsError:
    """Return the error that a file has more ports than any robot; `span` is the first in excess."""
    message = f"there are more than {MOST} inputs and outputs, which no robot has"
    help_text = "give the file of one robot alone"
    return MarsError((Diagnostic("ports", "error", message, span, help=help_text),))


def is_writable(name: str) -> bool:
    """Whether a configuration can write a name: one of one line, not empty, that can be seen."""
    return read_name(written(name)) is not None
