"""The behaviour of a module: its function and its timing."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any


class InjectedError(RuntimeError):
    """An exception that the scenario injects as a fault; it is not counted as a failure."""


@dataclass(frozen=True, slots=True)
class Behaviour:
    """The function that a module runs, and its timing.

    A sensor's `call()` returns a reading; an algorithm's takes the latest of each input; an
    effector's takes a command. `period` (ns) is for sensors whose annotation has no frequency, and
    for other modules that no input triggers. `delay` (ns) passes before a result is sent.
    `position()` returns the values of an effector's motions in degrees and mm; without it, they are
    computed from its commands. `place` is the file and line of the user's function.
    `reset(message)` is called at a reset.
    """

    call: Callable[..., Any]
    period: int | None = None
    delay: int = 0
    position: Callable[[], Mapping[str, float]] | None = None
    place: tuple[str, int] | None = None
    reset: Callable[..., Any] | None = None
