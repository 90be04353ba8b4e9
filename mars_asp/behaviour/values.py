"""Messages are values: each receiver has a copy, whose changes no other receiver sees."""

import re
from collections.abc import Callable, Collection
from copy import deepcopy
from dataclasses import fields, is_dataclass
from datetime import date, time, timedelta
from decimal import Decimal
from enum import Enum
from fractions import Fraction
from functools import lru_cache
from itertools import chain
from reprlib import Repr
from typing import Any, Literal, TypeVar

_Value = TypeVar("_Value")
#: Objects of exactly these classes never change.
_ATOMS = frozenset({type(None), bool, int, float, complex, str, bytes, range})
#: Nor do those of classes made from these, unless they have attributes of their own.
_FIXED = (int, float, complex, str, bytes, Fraction, Decimal, date, time, timedelta)
#: As many classes are remembered as a run is likely to have of messages and their members.
_CLASSES = 256
_ADDRESS = re.compile(r" at 0x[0-9A-Fa-f]+")
#: What a class may change of how its objects are copied.
_COPYING = ("__new__", "__reduce__", "__reduce_ex__", "__iter__")


def copied(value: _Value) -> _Value:
    """Return an independent copy of a value, or the value itself if it is immutable.

    Numbers, texts, and tuples and frozen dataclasses of such are shared; mutable objects are copied
    as `copy.deepcopy` does.

    Raises:
        TypeError: a member cannot be copied, such as a generator, a lock or an open file.
    """
    kind = type(value)
    if kind in _ATOMS:
        return value
    if is_constant(value):
        return value
    try:
        return _copier(value)(value)  # type: ignore[no-any-return]
    except Exception as error:  # how a class copies its objects is its author's
        text = f"a message of type `{kind.__name__}` cannot be copied for its receivers"
        raise TypeError(f"{text}: {error}") from error


def is_constant(value: Any) -> bool:
    """Whether neither a value nor anything that it contains can change."""
    kind: Any = type(value)
    if kind in _ATOMS:
        return True
    if kind is tuple:
        return _are_constant(value)
    sort = _sort(kind)
    held = getattr(value, "__dict__", None)
    if sort == "fields":
        if held is None:
            held = {f.name: getattr(value, f.name, None) for f in fields(kind)}
        return all(map(is_constant, held.values()))
    if sort == "members":
        return not held and _are_constant(value)
    return sort == "nothing" and (not held or isinstance(value, Enum))


def _are_constant(members: Collection[Any]) -> bool:
    """Whether none of the members of a message can change."""
    kinds = set(map(type, members))
    if kinds <= _ATOMS:
        return True
    # The usual list of points: looking at all numbers at once takes a fifth of the time.
    if kinds == {tuple} and _ATOMS.issuperset(map(type, chain.from_iterable(members))):
        return True
    return all(map(is_constant, members))


@lru_cache(maxsize=_CLASSES)
def _sort(kind: type) -> Literal["nothing", "members", "fields", "itself"]:
    """Return which parts decide if objects of a class are constant; `itself`: they are mutable."""
    if issubclass(kind, tuple | frozenset):
        return "members"
    if issubclass(kind, list | dict | set | bytearray):
        return "itself"
    if is_dataclass(kind) and kind.__dataclass_params__.frozen:  # type: ignore[attr-defined]
        return "fields"
    return "nothing" if issubclass(kind, (*_FIXED, Enum)) else "itself"


def _copier(value: Any) -> Callable[[Any], Any]:
    """Return a function that copies such a value: a shallow copy if the members are constant."""
    kind: Any = type(value)
    plain = _is_plain(kind) and not getattr(value, "__dict__", None)
    return _outside if plain and _are_constant(value) else deepcopy


def _outside(value: Any) -> Any:
    """Return a shallow copy of a list, with the same class."""
    if type(value) is list:
        return value.copy()
    made = value.__new__(type(value))
    list.extend(made, value)
    return made


@lru_cache(maxsize=_CLASSES)
def _is_plain(kind: type) -> bool:
    """Whether objects of a class are lists without further attributes or special copying."""
    if not issubclass(kind, list) or getattr(kind, "__slots__", None):
        return False
    if hasattr(kind, "__copy__") or hasattr(kind, "__deepcopy__"):
        return False
    return all(getattr(kind, name) == getattr(list, name) for name in _COPYING)


class _Short(Repr):
    """Shortens texts of values, and numbers in them to six digits."""

    def repr_float(self, number: float, _: int) -> str:
        return f"{number:.6g}"


#: Of a class whose text cannot be made, it shows the name.
_SHORT = _Short()
_SHORT.maxlist = _SHORT.maxtuple = 4
_SHORT.maxother = _SHORT.maxstring = _SHORT.maxlong = 60


def shown(value: object) -> str:
    """Return a short text of a value without memory addresses, which differ between runs."""
    return _ADDRESS.sub("", _SHORT.repr(value))
