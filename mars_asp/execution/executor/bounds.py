"""The bounds of arbiters: locks, under which commands are passed over, and limits of rates."""

from bisect import bisect_right
from collections.abc import Callable, Iterator, Mapping
from itertools import islice
from math import inf
from typing import Any, Generic, TypeVar

from mars_asp.execution.executor.link import Link, Message
from mars_asp.execution.executor.schedule import Schedule

_Value = TypeVar("_Value")


def is_true(value: object) -> bool:
    """Whether a message is a truth: anything but false, 0 of any type of numbers, and None.

    An empty text or container is a truth.
    """
    if value is None:
        return False
    try:
        is_zero = value == 0
        # The comparison of an array has no single result.
        return getattr(is_zero, "shape", ()) != () or not is_zero
    except Exception:  # the class of a user's message may be wrong in any way
        return True


class History(Generic[_Value]):
    """The values of one link by time, which hold until the next one or for the link's `hold`."""

    def __init__(self, link: Link) -> None:
        self.link = link
        self.times: list[int] = []
        self.values: list[_Value] = []

    def add(self, time: int, value: _Value) -> None:
        """Add a value that came at a time (ns), not before those that came earlier."""
        self.times.append(time)
        self.values.append(value)

    def silent(self, time: int) -> bool:
        """Whether no value came within the hold before a time (ns), this instant included."""
        if self.link.hold is None:
            return False
        number = bisect_right(self.times, time)
        return not number or time - self.times[number - 1] >= self.link.hold

    def at(self, time: int) -> _Value | None:
        """Return the last value that came until a time (ns), or None."""
        number = bisect_right(self.times, time)
        return self.values[number - 1] if number else None


class Bounds:
    """The locks and limits of an arbiter.

    `changed` is called, at `rank` of the instant, after each of their messages and when a hold
    runs out. Without `ranks`, a lock stops all controllers.
    """

    def __init__(
        self, schedule: Schedule, rank: int, changed: Callable[[], None], *, ranks: bool
    ) -> None:
        self.schedule, self.rank, self.changed, self.ranks = schedule, rank, changed, ranks
        self.locks: list[History[bool]] = []
        self.limits: list[History[Mapping[str, float]]] = []
        #: The times (ns) at which a lock took away what was obeyed, with the lock.
        self.stops: list[tuple[int, History[bool]]] = []
        #: The limit that lowered the last command sent in each instant (ns), and whether to 0.
        self.scalings: dict[int, tuple[History[Mapping[str, float]] | None, bool]] = {}
        #: The commands that a lock held back: the times (ns), with the lock and the link of each.
        self.refused: list[tuple[int, History[bool], Link]] = []

    def input(self, link: Link) -> Callable[[Message], None]:
        """Return the receiver of the messages of a lock or a limit."""
        if link.kind == "lock":
            lock = History[bool](link)
            self.locks.append(lock)
            return lambda message: self._receive(lock, is_true(message.value))
        limit = History[Mapping[str, float]](link)
        self.limits.append(limit)

        def receive(message: Message) -> None:
            try:
                bounds = {name: abs(bound) for name, bound in message.value.items()}
            except (AttributeError, TypeError) as error:
                link.fail(error, message)
                return
            self._receive(limit, bounds)

        return receive

    def _receive(self, history: History[Any], value: Any) -> None:
        now = self.schedule.now
        history.add(now, value)
        self.schedule.at(now, self.rank, self.changed)
        if history.link.hold is not None:
            self.schedule.at(now + history.link.hold, self.rank, self.changed)

    def locking(self, time: int, priority: int = 0) -> Iterator[History[bool]]:
        """Yield the locks under which a controller of a priority is passed over at a time (ns)."""
        for lock in self.locks:
            level = lock.link.declared if self.ranks else None
            if (level is None or priority < level) and (lock.silent(time) or lock.at(time)):
                yield lock

    def stop(self, priority: int = 0) -> None:
        """Note that a lock takes away what a controller of a priority commands."""
        now = self.schedule.now
        self.stops.append((now, next(self.locking(now, priority))))

    def refuse(self, link: Link, time: int, priority: int = 0) -> None:
        """Note that a lock, if any, holds back a command of a link that came at a time (ns)."""
        self.refused += ((time, lock, link) for lock in islice(self.locking(time, priority), 1))

    def is_locked(self, time: int, priority: int = 0) -> bool:
        """Whether a controller of a priority is passed over at a time (ns)."""
        return any(True for _ in self.locking(time, priority))

    def scaled(self, command: dict[str, float], *, sent: bool = False) -> dict[str, float]:
        """Return a command with all rates multiplied by the factor of the limits.

        If it is `sent`, the limit that lowered it is noted.
        """
        now, factor = self.schedule.now, 1.0
        lowest: History[Mapping[str, float]] | None = None
        least: dict[str, float] = {}
        for limit in self.limits:
            if limit.silent(now):
                factor, lowest = 0.0, limit
                continue
            for function, bound in (limit.at(now) or {}).items():
                least[function] = min(bound, least.get(function, bound))
                rate = abs(command.get(function, 0.0))
                if rate > bound and bound / rate < factor:
                    factor, lowest = bound / rate, limit
        if sent and self.limits:
            self.scalings[now] = lowest if any(command.values()) else None, not factor
        if factor == 1.0:
            return command
        # A product may be rounded to more than the bound.
        sizes = {f: min(abs(rate) * factor, least.get(f, inf)) for f, rate in command.items()}
        return {f: -sizes[f] if rate < 0 < sizes[f] else sizes[f] for f, rate in command.items()}
