"""What happened in a run, event by event."""

import json
from math import isfinite
from typing import Any, NamedTuple


class Event(NamedTuple):
    """At a time (ns): `data`, `control`, `holds` or `failed`, on which link or node, with what."""

    at: int
    what: str
    where: str
    value: Any


class Record:
    """Every event of a run, in order; its `observe` is what an executor is to tell."""

    def __init__(self) -> None:
        self.events: list[Event] = []

    def observe(self, at: int, what: str, where: str, value: object) -> None:
        """Keep an event; its value may change afterwards, so a copy is kept."""
        self.events.append(Event(at, what, where, _plain(value)))

    def lines(self) -> str:
        """Return the events as JSON, one a line."""
        told = (
            json.dumps({"ns": at, "event": what, "where": where, "value": value}, allow_nan=False)
            for at, what, where, value in self.events
        )
        return "".join(f"{line}\n" for line in told)


def _plain(value: Any) -> Any:
    """Return a value as JSON has it: what is not finite becomes null, an object its text."""
    if value is None or isinstance(value, str | int):
        return value
    if isinstance(value, float):
        return value if isfinite(value) else None
    if isinstance(value, list | tuple):
        return [_plain(part) for part in value]
    if isinstance(value, dict):
        return {str(key): _plain(part) for key, part in value.items()}
    return repr(value)
