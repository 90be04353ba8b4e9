"""The time limit of a search, and the callback that reports its progress."""

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

#: Called with the number of solved components, and the number of all components.
Progress: TypeAlias = Callable[[int, int], None]


@dataclass(frozen=True)
class Budget:
    """The limits of each search: the time in `seconds`, unlimited if None, and a callback.

    >>> load("examples/level0/config.mars", budget=Budget(seconds=30)).specification.proven_minimal
    True
    """

    seconds: float | None = None
    progress: Progress | None = None

    def deadline(self) -> float | None:
        """Return the end of a search that begins now, on the clock of `time.monotonic`, or None."""
        return None if self.seconds is None else time.monotonic() + self.seconds


ENDLESS = Budget()
