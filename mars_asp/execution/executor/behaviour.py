"""What a module does, as far as the executor needs to know."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any


class AskedError(RuntimeError):
    """What a module raises because somebody asked for that, to see what comes of it."""


@dataclass(frozen=True, slots=True)
class Behaviour:
    """A module's function, and when it runs.

    A sensor's `call()` returns a reading; an algorithm's takes the latest of each input; an
    effector's takes a command. `period` (ns) is a sensor's where its annotation has no frequency,
    and any other module's that nothing triggers. `delay` (ns) passes before a result is sent.
    `position()` tells how far an effector's motions have come, in degrees and mm; without it, that
    is reckoned from its commands. `place` is the file and line where a user defined the function.
    """

    call: Callable[..., Any]
    period: int | None = None
    delay: int = 0
    position: Callable[[], Mapping[str, float]] | None = None
    place: tuple[str, int] | None = None
