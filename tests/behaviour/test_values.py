"""Messages are values: mutable ones are copied, immutable ones are shared."""

import threading
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field
from enum import Enum
from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mars_asp.behaviour.values import copied
from tests.support.campaigns import examples
from tests.support.strategies import few


class Colour(Enum):
    RED = 1


class Force(NamedTuple):
    bearing: float
    strength: float


@dataclass(frozen=True)
class Fixed:
    ranges: tuple[float, ...]
    colour: Colour = Colour.RED


@dataclass(frozen=True, slots=True)
class Slotted:
    ranges: tuple[float, ...] = (1.0,)


@dataclass(frozen=True)
class Holding:
    ranges: list[float] = field(default_factory=lambda: [1.0])


@dataclass
class Open:
    ranges: list[float] = field(default_factory=lambda: [1.0])


class Ranges(list[Any]):
    pass


class Named(list[Any]):
    def __init__(self, *values: Any) -> None:
        super().__init__(values)
        self.names = ["a"]


class Slots(list[Any]):
    __slots__ = ("names",)

    def __init__(self) -> None:
        super().__init__()
        self.names = ["a"]


class Labelled(str):
    labels: list[str]


SHARED = [3, 2.5, "a", b"a", None, True, Fraction(1, 3), (1, ("a", 2.0)), frozenset({1}), range(3)]
SHARED += [Colour.RED, Force(1.0, 2.0), Fixed((1.0,)), Slotted(), (Fixed(()), Force(0, 1)), 1j]


@pytest.mark.parametrize("value", SHARED, ids=repr)
def test_immutable_values_are_shared(value: object) -> None:
    assert copied(value) is value


def labelled() -> Labelled:
    made = Labelled("a")
    made.labels = ["b"]
    return made


CHANGES: list[tuple[Any, Callable[[Any], object]]] = [
    ([1.0, 2.0], lambda v: v.append(3)),
    ([[1.0], [2.0]], lambda v: v[0].append(3)),
    (([1.0],), lambda v: v[0].append(3)),
    ({"a": [1.0]}, lambda v: v["a"].append(3)),
    ({1, 2}, lambda v: v.add(3)),
    (deque([1]), lambda v: v.append(2)),
    (bytearray(b"a"), lambda v: v.append(2)),
    (np.zeros(2), lambda v: v.__setitem__(0, 9)),
    ((np.zeros(2), 1), lambda v: v[0].__setitem__(0, 9)),
    (Open(), lambda v: v.ranges.append(2)),
    (Holding(), lambda v: v.ranges.append(2)),
    (Force([1], 2), lambda v: v.bearing.append(2)),  # type: ignore[arg-type]
    (Ranges([(1.0, 2.0)]), lambda v: v.append(3)),
    (Ranges([[1.0]]), lambda v: v[0].append(3)),
    (Named(1), lambda v: v.names.append("b")),
    (Slots(), lambda v: v.names.append("b")),
    (labelled(), lambda v: v.labels.append("b")),
]


@pytest.mark.parametrize(("value", "change"), CHANGES, ids=lambda value: type(value).__name__)
def test_mutable_values_are_copied(value: Any, change: Callable[[Any], object]) -> None:
    seen = repr(value), repr(getattr(value, "names", None)), repr(getattr(value, "labels", None))
    other = copied(value)
    assert type(other) is type(value)
    assert repr(other) == repr(value)
    change(other)
    after = repr(value), repr(getattr(value, "names", None)), repr(getattr(value, "labels", None))
    assert after == seen


def test_a_copied_message_keeps_shared_values_shared() -> None:
    inner = [1.0]
    first, second = copied([inner, inner])
    assert first is second
    assert first is not inner


@pytest.mark.parametrize(
    "value",
    [(n for n in [1]), threading.Lock(), [threading.Lock()]],
    ids=["generator", "lock", "list"],
)
def test_a_value_that_cannot_be_copied_is_an_error_that_names_its_type(value: object) -> None:
    with pytest.raises(TypeError, match=f"a message of type `{type(value).__name__}` cannot be"):
        copied(value)


LEAVES = st.integers() | st.floats(allow_nan=False) | st.text(max_size=3) | st.none()
VALUES = st.recursive(
    LEAVES,
    lambda inner: (
        st.lists(inner, max_size=3)
        | st.lists(inner, max_size=3).map(tuple)
        | st.dictionaries(st.text(max_size=2), inner, max_size=3)
    ),
    max_leaves=8,
)


def spoil(value: Any) -> None:
    """Change every list and dictionary of a value."""
    for each in value.values() if isinstance(value, dict) else value:
        if isinstance(each, list | tuple | dict):
            spoil(each)
    if isinstance(value, list):
        value.append("spoilt")
    if isinstance(value, dict):
        value["spoilt"] = 1


@settings(few, max_examples=examples(30, 100))
@given(VALUES)
def test_no_change_of_a_copy_is_seen_in_the_original(value: Any) -> None:
    before, other = repr(value), copied(value)
    assert other == value
    if isinstance(other, list | tuple | dict):
        spoil(other)
    assert repr(value) == before
