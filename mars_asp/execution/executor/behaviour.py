"""What a module does, as far as the executor needs to know."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import isfinite
from typing import Any

from mars_asp.model.declarations import GRASP, MOTION_FUNCTIONS


class AskedError(RuntimeError):
    """What a module raises because somebody asked for that, to see what comes of it."""


@dataclass(frozen=True, slots=True)
class Behaviour:
    """A module's function, and when it runs.

    A sensor's `call()` returns a reading; an algorithm's takes the latest of each input; an
    effector's takes a command. `period` (ns) is a sensor's where its annotation has no frequency,
    and any other module's that nothing triggers. `delay` (ns) passes before a result is sent.
    `position()` tells how far an effector's motions have come, in degrees and mm; without it, that
    is reckoned from its commands.
    """

    call: Callable[..., Any]
    period: int | None = None
    delay: int = 0
    position: Callable[[], Mapping[str, float]] | None = None


def single_command(result: object) -> dict[str, float]:
    """Return what a ControlOutAlgorithm returned as a command that names one function.

    Accepts a mapping with one entry, or a pair (function, rate).

    Raises:
        ValueError: it names several functions, an unknown one, or a rate that is not a number.
    """
    pairs = list(result.items()) if isinstance(result, dict) else [result]
    if len(pairs) != 1 or not isinstance(pairs[0], tuple) or len(pairs[0]) != 2:
        raise ValueError(f"a command names one function, not {result!r}")
    name, rate = pairs[0]
    if name != GRASP and name not in MOTION_FUNCTIONS:
        raise ValueError(f"{name!r} is not a motion or grasp function")
    rate = float(rate)
    if not isfinite(rate):
        raise ValueError(f"{rate} is not a rate")
    return {name: rate}
