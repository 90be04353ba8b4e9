"""The events of a run, and their recording as lines of JSON."""

from collections.abc import Callable
from json import JSONEncoder
from math import isfinite
from typing import Any, NamedTuple, Protocol

from mars_asp.execution.trial import Trial

_json = JSONEncoder(allow_nan=False).encode


class Event(NamedTuple):
    """An event at a time (ns) on a link or node.

    It is `data` or `control`, or for lines to sides `suppress`, `inhibit`, `lock`, `limit` or
    `reset`; at nodes it is `holds` or `gate`, and for dropped messages `failed`.
    """

    at: int
    what: str
    where: str
    value: Any


class Record(Protocol):
    """A writer of events during a run, which need not fit into memory."""

    def observe(self, at: int, what: str, where: str, value: object) -> None:
        """Write an event `what` (see `Event`) of the link or node `where` at a time in ns."""

    def end(self, trial: Trial) -> None:
        """Write the data that is complete only at the end of the run."""


class Lines:
    """Writes each event as a line of JSON."""

    def __init__(self, write: Callable[[bytes], object]) -> None:
        self._write = write

    def observe(self, at: int, what: str, where: str, value: object) -> None:
        """Write an event as one line: its time (ns), its kind, its module or link, a value."""
        entries = {"ns": at, "event": what, "where": where, "value": plain(value)}
        self._write(f"{_json(entries)}\n".encode())

    def end(self, trial: Trial) -> None:
        """Do nothing, as all lines are written already."""


def plain(value: Any) -> Any:
    """Return a value as JSON values; infinite numbers become null, objects their `repr`."""
    if value is None or isinstance(value, str | int):
        return value
    if isinstance(value, float):
        return value if isfinite(value) else None
    if isinstance(value, list | tuple):
        return [plain(part) for part in value]
    if isinstance(value, dict):
        return {str(key): plain(part) for key, part in value.items()}
    return repr(value)
