"""Delivery modes: the times at which a source or a splitter sends messages over a link."""

import math
from collections.abc import Callable, Sequence
from decimal import Decimal
from fractions import Fraction
from typing import Any, TypeAlias

from mars_asp.execution.executor.link import Link, Message
from mars_asp.execution.executor.schedule import Schedule
from mars_asp.model.declarations import Mode

WHEN_READY, AT_FREQUENCY, ON_REQUEST = "NotifyWhenReady", "NotifyAtFrequency", "RequestWhenReady"
_ON_VALUE = "NotifyOnValue"

#: The entry of a link: takes a message, and sends it now, later or never.
Offer: TypeAlias = Callable[[Message], None]


class Condition:
    """Sends those messages that fulfil the condition of a delivery mode."""

    def __init__(self, link: Link, mode: Mode) -> None:
        self.link, self.mode, self.of = link, mode, mode.of
        link.renew = self.renew
        self.renew()

    def renew(self) -> None:
        """Forget the messages before, as at the start."""
        self.fulfilled = condition(self.mode)

    def offer(self, message: Message) -> None:
        """Send a message if it fulfils the condition."""
        try:
            wanted = self.fulfilled(number_of(message.value, self.of))
        except (TypeError, ValueError, KeyError, AttributeError) as error:
            self.link.fail(error, message)
            return
        if wanted:
            self.link.send(message)


class TimeGrid:
    """Sends the latest message at each tick of a rate, including one that arrives at the tick.

    With `again`, a message without a successor is repeated and counted as stale. Ticks lower 25 Hz
    to 10 Hz exactly; a minimal gap between messages would give 8.3 Hz.
    """

    def __init__(
        self, link: Link, hz: Fraction, schedule: Schedule, rank: int, *, again: bool
    ) -> None:
        self.link, self.again, self.fresh = link, again, False
        self.latest: Message | None = None
        self.schedule = schedule
        if again:
            link.begun = None
        schedule.every(hz, rank, self.tick)

    def offer(self, message: Message) -> None:
        """Store a message for the next tick."""
        if self.link.begun is None:
            self.link.begun = self.schedule.now
        if self.fresh:
            self.link.dropped["lowered"] += 1
        self.latest, self.fresh = message, True

    def tick(self) -> None:
        """Send the latest message, if it is new or repeated."""
        if self.latest is None or not (self.fresh or self.again):
            return
        self.link.stale += not self.fresh
        self.fresh = False
        self.link.send(self.latest)


class LatestBuffer:
    """Answers requests with the latest unread message, or else with the next one.

    `upstream` requests a message from a source that makes messages only on request.
    """

    def __init__(self, link: Link, upstream: Callable[[], None] | None) -> None:
        self.link, self.upstream = link, upstream
        self.unread: Message | None = None
        self.outstanding = False
        link.request, link.forget = self.request, self.forget

    def offer(self, message: Message) -> None:
        """Answer an outstanding request with a message, or store the message."""
        if self.outstanding:
            self.outstanding = False
            self.link.send(message)
            return
        if self.unread is not None:
            self.link.dropped["unread"] += 1
        self.unread = message

    def request(self) -> None:
        """Send the unread message, or else the next one that is offered."""
        if self.unread is not None:
            message, self.unread = self.unread, None
            self.link.send(message)
            return
        self.outstanding = True
        if self.upstream is not None:
            self.upstream()

    def forget(self) -> bool:
        """Forget an outstanding request; return whether there was one."""
        outstanding, self.outstanding = self.outstanding, False
        return outstanding


def open_link(
    link: Link,
    mode: Mode,
    made: tuple[Mode, Fraction | None],
    schedule: Schedule,
    rank: int,
    upstream: Callable[[], None] | None,
) -> Offer:
    """Return the function to which a link's messages are offered, delivering in `mode`.

    The source makes messages in the mode and rate (Hz) `made`. `rank` is the rank of the link's
    clock in the schedule; `upstream` requests a message.
    """
    carried, rate = made
    if mode.name == ON_REQUEST:
        return LatestBuffer(link, upstream if carried.name == ON_REQUEST else None).offer
    if mode.name == AT_FREQUENCY:
        hz = link.hz or rate
        if carried.name == ON_REQUEST and hz is not None and upstream is not None:
            # A message is requested at each tick from a source that answers requests.
            kept = LatestBuffer(link, upstream)
            link.request, link.forget = None, lambda: False
            schedule.every(hz, rank, kept.request)
            return kept.offer
        if hz is None or (carried.name == AT_FREQUENCY and hz == rate):
            return link.send
        return TimeGrid(link, hz, schedule, rank, again=carried.name != AT_FREQUENCY).offer
    if mode.name == WHEN_READY or mode == carried:
        return link.send
    return Condition(link, mode).offer


def number_of(value: Any, field: str | None) -> float:
    """Return the number that a condition tests: a message, or its field or entry `field`."""
    for part in field.split(".") if field else ():
        value = value[part] if isinstance(value, dict) else getattr(value, part)
    return float(value)


def lacks_value(mode: Mode) -> bool:
    """Whether a mode is `NotifyOnValue` without a value, which cannot be tested."""
    return mode.name == _ON_VALUE and not mode.arguments


def condition(mode: Mode) -> Callable[[float], bool]:
    """Return the test of a conditional mode, which depends on the numbers tested before.

    NaN fulfils no condition and has no effect on later tests.

    Raises:
        ValueError: the mode has no condition, or `NotifyOnValue` has no value.
    """
    test = _test(mode)
    return lambda x: not math.isnan(x) and test(x)


def _test(mode: Mode) -> Callable[[float], bool]:
    arguments = mode.arguments
    if mode.name == "NotifyOnMax":
        return _beyond(arguments, 1.0)
    if mode.name == "NotifyOnMin":
        return _beyond(arguments, -1.0)
    if mode.name == _ON_VALUE and arguments:
        return _entering(arguments[0], arguments[1] if len(arguments) > 1 else Decimal(0))
    if mode.name == "NotifyOnChange":
        return _changing(arguments[0] if arguments else Decimal(0))
    raise ValueError(f"`{mode.text or mode.name}` states no condition")


def _beyond(arguments: Sequence[Decimal], sign: float) -> Callable[[float], bool]:
    if arguments:
        limit = sign * float(arguments[0])
        return lambda x: sign * x >= limit
    best: float | None = None

    def exceeds(x: float) -> bool:
        nonlocal best
        if best is not None and sign * x <= sign * best:
            return False
        best = x
        return True

    return exceeds


def _entering(value: Decimal, tolerance: Decimal) -> Callable[[float], bool]:
    # Exact decimals: 30.1 is within 30 ± 0.1, though 30.1 - 30 in floats is more.
    least, most = float(value - tolerance), float(value + tolerance)
    inside = False

    def enters(x: float) -> bool:
        nonlocal inside
        before, inside = inside, least <= x <= most
        return inside and not before

    return enters


def _changing(least: Decimal) -> Callable[[float], bool]:
    delivered: float | None = None

    def differs(x: float) -> bool:
        nonlocal delivered
        # Compared with the last delivered number: with the last tested one, drift would be lost.
        # A sonar without a hit reads infinity, and infinity - infinity is NaN.
        if delivered is not None and (
            x == delivered or abs(Decimal(repr(x)) - Decimal(repr(delivered))) <= least
        ):
            return False
        delivered = x
        return True

    return differs
