"""Commands: the valid ones, and the errors of others."""

from collections import UserDict
from types import MappingProxyType
from typing import Any

import numpy as np
import pytest

from mars_asp.behaviour import Command
from mars_asp.behaviour.command import command_of, commanded


@pytest.mark.parametrize(
    ("function", "rate", "message"),
    [
        ("Rotn_y", 3, "'Rotn_y' is not a function of an effector: did you mean `Rotn_Y`?"),
        ("drive", 3, "'drive' is not a function of an effector: one of Rotn_X, Rotn_Y,"),
        (None, 3, "None is not a function of an effector"),
        ("Trans_Z", float("nan"), "the rate of `Trans_Z` must be finite, not nan"),
        ("Trans_Z", float("-inf"), "the rate of `Trans_Z` must be finite, not -inf"),
        ("Trans_Z", "5", "the rate of `Trans_Z` must be a number, not '5'"),
        ("Trans_Z", True, "the rate of `Trans_Z` must be a number, not True"),
        ("Trans_Z", None, "the rate of `Trans_Z` must be a number, not None"),
    ],
)
def test_an_invalid_command_is_reported_where_it_is_made(
    function: Any, rate: Any, message: str
) -> None:
    with pytest.raises((ValueError, TypeError)) as raised:
        Command(function, rate)
    assert str(raised.value).startswith(message)
    with pytest.raises((ValueError, TypeError)):
        command_of((function, rate))


def test_a_rate_is_any_number() -> None:
    rates = [3, 3.0, np.float32(3), np.int64(3)]
    assert {Command("Trans_Z", rate) for rate in rates} == {Command("Trans_Z", 3.0)}  # type: ignore[arg-type]
    assert isinstance(Command("Trans_Z", 3).rate, float)


def test_a_message_is_the_same_in_every_run() -> None:
    with pytest.raises(ValueError, match=r"or None, not <object object>$"):
        command_of(object())


def test_pairs_and_mappings_are_commands() -> None:
    same = [Command("Grasp", 40), ("Grasp", 40), {"Grasp": 40}]
    assert {command_of(each) for each in same} == {Command("Grasp", 40)}
    for wrong in ({}, {"Grasp": 1, "Trans_Z": 2}, ("Grasp",), 7, "Trans_Z", [("Grasp", 1)]):
        with pytest.raises(ValueError, match="a controller returns one"):
            command_of(wrong)


def test_only_listed_functions_are_commanded_together() -> None:
    listed = ("Trans_Z", "Rotn_Y")
    assert commanded({"Trans_Z": 100, "Rotn_Y": 5}, listed) == {"Trans_Z": 100.0, "Rotn_Y": 5.0}
    assert commanded(("Rotn_Y", 5), listed) == {"Rotn_Y": 5.0}
    assert commanded(MappingProxyType({"Trans_Z": 1, "Rotn_Y": 5}), listed)["Rotn_Y"] == 5
    assert commanded(UserDict(Trans_Z=1), ()) == commanded({"Trans_Z": 1}, ("Trans_Z",))
    assert commanded({"Rotn_X": 5}, ()) == {"Rotn_X": 5.0}
    with pytest.raises(
        ValueError, match="`Rotn_X` is not in the annotation, which lists `Trans_Z`"
    ):
        commanded({"Rotn_X": 5}, ("Trans_Z",))
    with pytest.raises(ValueError, match=r"or a mapping of functions to rates, or None, not \{\}"):
        commanded({}, listed)
    with pytest.raises(ValueError, match="`Rotn_X` is not in the annotation"):
        commanded({"Trans_Z": 1, "Rotn_X": 5}, listed)
    for one in (("Trans_Z",), ()):
        with pytest.raises(ValueError, match="one `Command"):
            commanded({"Trans_Z": 1, "Rotn_Y": 5}, one)
