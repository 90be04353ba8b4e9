"""Delivery modes: when a source or a splitter sends what it has over a link."""

from collections.abc import Callable
from fractions import Fraction
from typing import Any, Protocol

from mars_asp.execute.link import Link, Message
from mars_asp.execute.schedule import DATA, Schedule, last_tick, tick_time
from mars_asp.model import Mode

WHEN_READY, AT_FREQUENCY, ON_REQUEST = "NotifyWhenReady", "NotifyAtFrequency", "RequestWhenReady"


class Port(Protocol):
    """Where messages enter a link."""

    def offer(self, message: Message) -> None:
        """Take a message; send it now, later or never."""


class Forward:
    """Sends each message."""

    def __init__(self, link: Link) -> None:
        self.offer = link.send


class Condition:
    """Sends what fulfils a conditional mode."""

    def __init__(self, link: Link, mode: Mode) -> None:
        self.link, self.fulfilled, self.of = link, condition(mode), mode.of

    def offer(self, message: Message) -> None:
        """Send a message that fulfils the condition."""
        try:
            wanted = self.fulfilled(number_of(message.value, self.of))
        except (TypeError, ValueError, KeyError, AttributeError) as error:
            self.link.fail(error)
            return
        if wanted:
            self.link.send(message)


class Lower:
    """Lowers a rate exactly: the first message at or behind each deadline of the lower rate.

    A least gap between messages would make 8.3 of 25 -> 10 Hz; deadlines make 10.
    """

    def __init__(self, link: Link, hz: Fraction, schedule: Schedule) -> None:
        self.link, self.hz, self.schedule, self.due = link, hz, schedule, 0

    def offer(self, message: Message) -> None:
        """Send the first message behind a deadline."""
        now = self.schedule.now
        if now < self.due:
            self.link.dropped["lowered"] += 1
            return
        self.due = tick_time(last_tick(now, self.hz) + 1, self.hz)
        self.link.send(message)


class Repeat:
    """Sends the latest message at each tick; what was sent before is counted as stale."""

    def __init__(self, link: Link, hz: Fraction, schedule: Schedule) -> None:
        self.link, self.fresh = link, False
        self.latest: Message | None = None
        start_clock(schedule, hz, DATA, self.tick)

    def offer(self, message: Message) -> None:
        """Keep a message for the next tick."""
        if self.fresh:
            self.link.dropped["lowered"] += 1
        self.latest, self.fresh = message, True

    def tick(self) -> None:
        """Send the latest message, if there is one."""
        if self.latest is not None:
            self.link.stale += not self.fresh
            self.fresh = False
            self.link.send(self.latest)


class Keep:
    """Keeps the latest unread message for a request; with none, the next answers it.

    `upstream` is asked for one where the source makes messages only on request.
    """

    def __init__(self, link: Link, upstream: Callable[[], None] | None) -> None:
        self.link, self.upstream = link, upstream
        self.unread: Message | None = None
        self.outstanding = False
        link.request = self.request

    def offer(self, message: Message) -> None:
        """Answer an outstanding request, or keep the message."""
        if self.outstanding:
            self.outstanding = False
            self.link.send(message)
            return
        if self.unread is not None:
            self.link.dropped["unread"] += 1
        self.unread = message

    def request(self) -> None:
        """Answer with the unread message, else with the next."""
        if self.unread is not None:
            message, self.unread = self.unread, None
            self.link.send(message)
            return
        self.outstanding = True
        if self.upstream is not None:
            self.upstream()


class Poll:
    """Asks a source that answers requests at each tick."""

    def __init__(
        self, link: Link, hz: Fraction, schedule: Schedule, upstream: Callable[[], None]
    ) -> None:
        self.kept = Keep(link, upstream)
        link.request = None
        self.offer = self.kept.offer
        start_clock(schedule, hz, DATA, self.kept.request)


def open_port(
    link: Link,
    asked: Mode,
    made: tuple[Mode, Fraction | None],
    schedule: Schedule,
    upstream: Callable[[], None] | None,
) -> Port:
    """Return the port that makes what is asked of `link` from a mode and rate (Hz) that is made."""
    carried, rate = made
    if asked.name == ON_REQUEST:
        return Keep(link, upstream if carried.name == ON_REQUEST else None)
    if asked.name == AT_FREQUENCY:
        hz = link.hz or rate
        if carried.name == ON_REQUEST and hz is not None and upstream is not None:
            return Poll(link, hz, schedule, upstream)
        if carried.name == AT_FREQUENCY or hz is None:
            return Forward(link) if hz is None or hz == rate else Lower(link, hz, schedule)
        return Repeat(link, hz, schedule)
    if asked.name == WHEN_READY or asked == carried:
        return Forward(link)
    return Condition(link, asked)


def start_clock(schedule: Schedule, hz: Fraction, rank: int, action: Callable[[], object]) -> None:
    """Run an action at every tick of a rate, from tick 0 on."""
    count = 0

    def tick() -> None:
        nonlocal count
        count += 1
        schedule.at(tick_time(count, hz), rank, tick)
        action()

    schedule.at(0, rank, tick)


def number_of(value: Any, field: str | None) -> float:
    """Return the number a condition is about: the message, or its field (or entry) by name."""
    for part in field.split(".") if field else ():
        value = value[part] if isinstance(value, dict) else getattr(value, part)
    return float(value)


def condition(mode: Mode) -> Callable[[float], bool]:
    """Return the test of one conditional mode; it remembers what it has seen.

    Raises:
        ValueError: the mode sets no condition, or lacks the value it is about.
    """
    arguments = [float(argument) for argument in mode.arguments]
    if mode.name == "NotifyOnMax":
        return _beyond(arguments, 1.0)
    if mode.name == "NotifyOnMin":
        return _beyond(arguments, -1.0)
    if mode.name == "NotifyOnValue" and arguments:
        return _entering(arguments[0], arguments[1] if len(arguments) > 1 else 0.0)
    if mode.name == "NotifyOnChange":
        return _changing(arguments[0] if arguments else 0.0)
    raise ValueError(f"`{mode.text or mode.name}` sets no condition")


def _beyond(arguments: list[float], sign: float) -> Callable[[float], bool]:
    if arguments:
        return lambda x: sign * x >= sign * arguments[0]
    best: float | None = None

    def exceeds(x: float) -> bool:
        nonlocal best
        if best is not None and sign * x <= sign * best:
            return False
        best = x
        return True

    return exceeds


def _entering(value: float, tolerance: float) -> Callable[[float], bool]:
    inside = False

    def enters(x: float) -> bool:
        nonlocal inside
        before, inside = inside, abs(x - value) <= tolerance
        return inside and not before

    return enters


def _changing(least: float) -> Callable[[float], bool]:
    delivered: float | None = None

    def differs(x: float) -> bool:
        nonlocal delivered
        # From what was last delivered, not last seen: else a slow drift would be lost.
        if delivered is not None and abs(x - delivered) <= least:
            return False
        delivered = x
        return True

    return differs
