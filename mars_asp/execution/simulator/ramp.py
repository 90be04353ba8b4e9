"""A rate with bounded acceleration: a staircase with one step in each millisecond."""

from dataclasses import dataclass
from math import ceil, copysign, inf

#: Steps in a second.
_STEPS = 1000
#: Rounding error, in seconds, of a time at a whole millisecond.
_SAME = 1e-9


@dataclass(slots=True)
class Ramp:
    """A rate that grows by at most `up` a second and shrinks by at most `down`.

    The rate changes linearly between whole milliseconds. Each millisecond is simulated with the
    mean rate, which gives the same distance. A command between two milliseconds takes effect at the
    next one.
    """

    up: float
    down: float
    #: The rate at the end of the step.
    rate: float = 0.0
    #: The rate of the step.
    mean: float = 0.0
    _until: float = -inf

    @property
    def until(self) -> float:
        """Return the end of the current rate in seconds; inf if it is the wanted rate."""
        return self._until if self._until > -inf else inf

    def at(self, seconds: float, wanted: float) -> float:
        """Return the mean rate up to `until`; a call from then on begins the step to `wanted`."""
        if seconds < self._until - _SAME:
            return self.mean
        self.mean, self._until = self.rate, -inf
        if self.rate != wanted:
            step = ceil((seconds - _SAME) * _STEPS)
            if abs(step / _STEPS - seconds) <= _SAME:
                after = self._after(wanted)
                self.mean, self.rate, step = (self.rate + after) / 2, after, step + 1
            self._until = step / _STEPS
        return self.mean

    def _after(self, wanted: float) -> float:
        """Return the rate one millisecond later; a change of sign stops at zero first."""
        slower = self.rate and (wanted * self.rate <= 0 or abs(wanted) < abs(self.rate))
        goal = 0.0 if slower and wanted * self.rate < 0 else wanted
        most = (self.down if slower else self.up) / _STEPS
        gone = goal - self.rate
        return goal if abs(gone) <= most else self.rate + copysign(most, gone)
