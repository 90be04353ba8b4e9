"""The commands of controllers to effectors: functions with rates."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from math import isfinite
from typing import Literal, TypeAlias

from mars_asp.behaviour.values import shown
from mars_asp.model.declarations import GRASP, MOTION_FUNCTIONS
from mars_asp.spelling import nearest

#: The functions of effectors: turn about an axis, move along one, or open the gripper.
FunctionName: TypeAlias = Literal[
    "Rotn_X", "Rotn_Y", "Rotn_Z", "Trans_X", "Trans_Y", "Trans_Z", "Grasp"
]
_FUNCTIONS = (*MOTION_FUNCTIONS, GRASP)
_COMBINED = "a `Command(function, rate)` or a mapping of functions to rates"


@dataclass(frozen=True, slots=True)
class Command:
    """One function and its rate: degrees/s of `Rotn_`, mm/s of `Trans_`; of `Grasp` a width in mm.

    Raises:
        ValueError: the function is unknown, or the rate is nan or infinite.
        TypeError: the rate is not a number.
    """

    function: FunctionName
    rate: float

    def __post_init__(self) -> None:
        if self.function not in _FUNCTIONS:
            near = nearest(self.function, _FUNCTIONS) if isinstance(self.function, str) else None
            hint = f"did you mean `{near}`?" if near else f"one of {', '.join(_FUNCTIONS)}"
            raise ValueError(f"{shown(self.function)} is not a function of an effector: {hint}")
        if isinstance(self.rate, bool) or not hasattr(self.rate, "__float__"):
            raise TypeError(
                f"the rate of `{self.function}` must be a number, not {shown(self.rate)}"
            )
        if not isfinite(rate := float(self.rate)):
            raise ValueError(f"the rate of `{self.function}` must be finite, not {rate}")
        object.__setattr__(self, "rate", rate)


def commanded(result: object, listed: Collection[str]) -> dict[str, float]:
    """Return the result of a controller as a rate for each function that it names.

    A controller whose annotation lists functions, `listed`, may name these alone. If it lists
    several, it may return a mapping with several of them.

    Raises:
        ValueError, TypeError: the result names functions that are not listed, or is not a command.
    """
    if len(listed) < 2:
        commands = [command_of(result)]
    elif isinstance(result, Mapping) and result:
        commands = [command_of(pair) for pair in result.items()]
    else:
        commands = [command_of(result, _COMBINED)]
    for command in commands:
        if listed and command.function not in listed:
            names = ", ".join(f"`{name}`" for name in listed)
            raise ValueError(f"`{command.function}` is not in the annotation, which lists {names}")
    return {command.function: command.rate for command in commands}


def command_of(result: object, expected: str = "one `Command(function, rate)`") -> Command:
    """Return the result of a controller as a command.

    A result may also be a pair (function, rate), or a mapping with one entry. `expected` is the
    text of messages about other results.

    Raises:
        ValueError, TypeError: the result names several functions, or is not a command.
    """
    if isinstance(result, Command):
        return result
    pairs = list(result.items()) if isinstance(result, Mapping) else [result]
    if len(pairs) != 1 or not isinstance(pairs[0], tuple) or len(pairs[0]) != 2:
        raise ValueError(f"a controller returns {expected}, or None, not {shown(result)}")
    return Command(*pairs[0])
