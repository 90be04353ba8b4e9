"""A cache of the last result of a function, by the identity of its arguments."""

from collections.abc import Callable
from functools import wraps
from operator import is_
from typing import TypeVar, TypeVarTuple

_Arguments = TypeVarTuple("_Arguments")
_Result = TypeVar("_Result")


def remembered(function: Callable[[*_Arguments], _Result]) -> Callable[[*_Arguments], _Result]:
    """Return a function that keeps its last result, and reuses it for the same argument objects.

    Neither the arguments nor the result may be changed.
    """
    last: list[tuple[tuple[object, ...], _Result]] = []

    @wraps(function)
    def remembering(*arguments: *_Arguments) -> _Result:
        given: tuple[object, ...] = arguments
        for known, result in last:
            if len(known) == len(given) and all(map(is_, known, given)):
                return result
        result = function(*arguments)
        last[:] = [(given, result)]
        return result

    return remembering
