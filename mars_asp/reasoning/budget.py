"""How long a search may take, and who is told how far it is."""

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

#: Told how many components are solved, and of how many.
Progress: TypeAlias = Callable[[int, int], None]


@dataclass(frozen=True)
class Budget:
    """What each search gets: so many `seconds`, without end where there is no such number.

    >>> load("examples/level0/config.mars", budget=Budget(seconds=30)).specification.proven_minimal
    True
    """

    seconds: float | None = None
    progress: Progress | None = None

    def deadline(self) -> float | None:
        """Return the time of `time.monotonic` at which a search that begins now is over."""
        return None if self.seconds is None else time.monotonic() + self.seconds


ENDLESS = Budget()
