"""The event loop: times in integer ns, timers in a heap, events of one instant in queues."""

import heapq
from collections import deque
from collections.abc import Callable
from fractions import Fraction
from typing import TypeAlias

SECOND = 1_000_000_000
MILLISECOND = 1_000_000
MICROSECOND = 1_000
SENSORS, DATA = 0, 1
#: More events than an instant of a small robot has, unless messages go round without end.
MOST_EVENTS = 100_000
Action: TypeAlias = Callable[[], object]


def tick_time(k: int, hz: Fraction) -> int:
    """Return the time of tick `k` of a rate in ns: round(k * 1e9 / hz), exactly."""
    # Equal to `round(Fraction(...))`, but ten times as fast.
    whole, rest = divmod(k * SECOND * hz.denominator, hz.numerator)
    return whole + (2 * rest > hz.numerator or (2 * rest == hz.numerator and whole % 2))


class Clock:
    """The actions at the ticks of one rate, from tick 0 on, which share a timer."""

    def __init__(self, hz: Fraction) -> None:
        self.hz, self.ticks = hz, 0
        self.actions: list[Action] = []


class EndlessError(Exception):
    """An instant has more than the maximal number of events."""


class Schedule:
    """Events by time, then by rank, then by sequence.

    The ranks: sensors; data that arrives; joins of data and the clocks of data modules and
    splitters, in `clocks` ranks, so that in one instant modules nearer to a source run first;
    control; arbiters and commanded controllers, one rank for each depth of cascade, so that an
    inner one decides before the one that it feeds; effectors.
    """

    def __init__(self, clocks: int = 1, arbiters: int = 1) -> None:
        self.now = 0
        self.events, self.most_events = 0, MOST_EVENTS
        self.control = DATA + 1 + clocks
        self.effectors = self.control + 1 + arbiters
        self._queues: tuple[deque[Action], ...] = tuple(deque() for _ in range(self.effectors + 1))
        self._timers: list[tuple[int, int, int, Action | Clock]] = []
        self._clocks: dict[tuple[Fraction, int], Clock] = {}
        self._sequence = 0
        self._arrivals = 0

    def next_arrival(self) -> int:
        """Return the next arrival number, greater than all before."""
        self._arrivals += 1
        return self._arrivals

    def queue(self, rank: int) -> Callable[[Action], None]:
        """Return a function that adds an event of a rank to the present instant."""
        return self._queues[rank].append

    def at(self, time: int, rank: int, action: Action) -> None:
        """Run an action at a time (ns), or in this instant if it has passed, in order of rank."""
        if time <= self.now:
            self._queues[rank].append(action)
            return
        self._sequence += 1
        heapq.heappush(self._timers, (time, rank, self._sequence, action))

    def every(self, hz: Fraction, rank: int, action: Action) -> None:
        """Run an action at every tick of a rate in Hertz; call this before the first event."""
        clock = self._clocks.get((hz, rank))
        if clock is None:
            clock = self._clocks[hz, rank] = Clock(hz)
            self._sequence += 1
            heapq.heappush(self._timers, (0, rank, self._sequence, clock))
        clock.actions.append(action)

    def step_until(self, time: int) -> None:
        """Run every event up to and including `time`, then set the clock to it."""
        timers = self._timers
        self._settle()
        while timers and timers[0][0] <= time:
            self.now = timers[0][0]
            while timers and timers[0][0] == self.now:
                self._ring()
            self._settle()
        self.now = max(self.now, time)

    def _ring(self) -> None:
        """Queue the actions of the earliest timer."""
        _, rank, _, due = heapq.heappop(self._timers)
        if isinstance(due, Clock):
            self._queues[rank].extend(due.actions)
            due.ticks += 1
            self._sequence += 1
            entry = (tick_time(due.ticks, due.hz), rank, self._sequence, due)
            heapq.heappush(self._timers, entry)
        else:
            self._queues[rank].append(due)

    def _settle(self) -> None:
        """Run the events of the present instant by rank until none is left.

        Raises:
            EndlessError: there are more than `most_events`.
        """
        rank, most = 0, self.events + self.most_events
        while rank < len(self._queues):
            queue = self._queues[rank]
            if not queue:
                rank += 1
                continue
            while queue:
                actions = tuple(queue)
                queue.clear()
                for action in actions:
                    action()
                self.events += len(actions)
                if self.events > most:
                    raise EndlessError
            rank = 0
