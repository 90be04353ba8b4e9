"""A rate that changes no faster than it may: a staircase of one step for each millisecond."""

from dataclasses import dataclass
from math import ceil, copysign, inf

#: Steps a second.
_STEPS = 1000
#: A time (s) that is nearer than this to a whole millisecond is one.
_SAME = 1e-9


@dataclass(slots=True)
class Ramp:
    """A rate that grows by at most `up` a second and shrinks by at most `down`.

    It changes linearly between whole milliseconds. In each of them the motion has the constant rate
    that is the mean of its ends, so that it comes as far. A command that comes between two counts
    from the next on.
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
        """Return until when (s) the rate holds; inf where that is as long as it is wanted."""
        return self._until if self._until > -inf else inf

    def at(self, seconds: float, wanted: float) -> float:
        """Return the rate from a time on; it holds up to `until`."""
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
        """Return the rate a millisecond later; it passes zero at the end of a step."""
        slower = self.rate and (wanted * self.rate <= 0 or abs(wanted) < abs(self.rate))
        goal = 0.0 if slower and wanted * self.rate < 0 else wanted
        most = (self.down if slower else self.up) / _STEPS
        gone = goal - self.rate
        return goal if abs(gone) <= most else self.rate + copysign(most, gone)
