"""The event loop: integer nanoseconds, timers in a heap, deliveries of one instant in queues."""

import heapq
from collections import deque
from collections.abc import Callable
from fractions import Fraction

SECOND = 1_000_000_000
MILLISECOND = 1_000_000
SENSORS, DATA, CONTROL = 0, 1, 2


def tick_time(k: int, hz: Fraction) -> int:
    """Return the instant, in ns, of tick `k` of a rate in Hertz: round(k * 1e9 / hz), exactly."""
    # What `round(Fraction(...))` does, in whole numbers: ten times as fast.
    whole, rest = divmod(k * SECOND * hz.denominator, hz.numerator)
    return whole + (2 * rest > hz.numerator or (2 * rest == hz.numerator and whole % 2))


def last_tick(time: int, hz: Fraction) -> int:
    """Return the greatest k with `tick_time(k, hz) <= time`; -1 before the first."""
    k = time * hz.numerator // (SECOND * hz.denominator) + 1
    while tick_time(k, hz) > time:
        k -= 1
    return k


class Schedule:
    """Events by time, then by rank (sensors, data, control, arbiters, effectors), then sequence.

    Arbiters have a rank for each depth of cascade, so that within one instant an inner one has
    settled before the one it feeds decides. `arbiters` is how many of those ranks there are.
    """

    def __init__(self, arbiters: int = 1) -> None:
        self.now = 0
        self.events = 0
        self.effectors = CONTROL + 1 + arbiters
        self._queues: tuple[deque[Callable[[], object]], ...] = tuple(
            deque() for _ in range(self.effectors + 1)
        )
        self._timers: list[tuple[int, int, int, Callable[[], object]]] = []
        self._sequence = 0
        self._arrivals = 0

    def next_arrival(self) -> int:
        """Return a number greater than any before."""
        self._arrivals += 1
        return self._arrivals

    def soon(self, rank: int, action: Callable[[], object]) -> None:
        """Queue an event of this instant."""
        self._queues[rank].append(action)

    def at(self, time: int, rank: int, action: Callable[[], object]) -> None:
        """Set a timer; a time that has passed means this instant."""
        self._sequence += 1
        heapq.heappush(self._timers, (max(time, self.now), rank, self._sequence, action))

    def step_until(self, time: int) -> None:
        """Run every event up to and including `time`; then it is `time`."""
        timers = self._timers
        self._settle()
        while timers and timers[0][0] <= time:
            self.now = timers[0][0]
            self._settle()
        self.now = max(self.now, time)

    def _settle(self) -> None:
        """Run the events of this instant, the lowest rank first, until none is left."""
        timers, queues = self._timers, self._queues
        while True:
            while timers and timers[0][0] <= self.now:
                _, rank, _, action = heapq.heappop(timers)
                queues[rank].append(action)
            for queue in queues:
                if queue:
                    break
            else:
                return
            self.events += 1
            queue.popleft()()
