"""What happened in a run, event by event."""

from collections.abc import Callable
from json import JSONEncoder
from math import isfinite
from typing import Any, NamedTuple, Protocol

from mars_asp.execution.trial import Trial

_json = JSONEncoder(allow_nan=False).encode


class Event(NamedTuple):
    """At a time (ns): `data`, `control`, `holds` or `failed`, on which link or node, with what."""

    at: int
    what: str
    where: str
    value: Any


class Record(Protocol):
    """What writes down a run as it happens, and keeps nothing of it."""

    def observe(self, at: int, what: str, where: str, value: object) -> None:
        """Write an event, which is what an executor tells."""

    def end(self, trial: Trial) -> None:
        """Write what is known at the end."""


class Lines:
    """Writes each event as a line of JSON."""

    def __init__(self, write: Callable[[bytes], object]) -> None:
        self._write = write

    def observe(self, at: int, what: str, where: str, value: object) -> None:
        """Write an event."""
        entries = {"ns": at, "event": what, "where": where, "value": plain(value)}
        self._write(f"{_json(entries)}\n".encode())

    def end(self, trial: Trial) -> None:
        """Write nothing: lines are events."""


def plain(value: Any) -> Any:
    """Return a value as JSON has it: what is not finite becomes null, an object its text."""
    if value is None or isinstance(value, str | int):
        return value
    if isinstance(value, float):
        return value if isfinite(value) else None
    if isinstance(value, list | tuple):
        return [plain(part) for part in value]
    if isinstance(value, dict):
        return {str(key): plain(part) for key, part in value.items()}
    return repr(value)
