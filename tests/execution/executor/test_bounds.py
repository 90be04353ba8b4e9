"""Truths of locks and inhibitions, and the scaling of rates by limits."""

from decimal import Decimal
from random import Random
from typing import Any

import numpy as np
import pytest

from mars_asp.diagnostic import point
from mars_asp.execution.executor.bounds import Bounds, is_true
from mars_asp.execution.executor.link import Link, Message
from mars_asp.execution.executor.schedule import Schedule


@pytest.mark.parametrize(
    "value", [False, 0, 0.0, -0.0, Decimal(0), None, np.bool_(False), np.int64(0), np.array(0)]
)
def test_false_zero_and_none_do_not_lock(value: Any) -> None:
    assert is_true(value) is False


@pytest.mark.parametrize(
    "value", [True, 2, -0.1, "", [], {}, "0", np.bool_(True), np.float32(1), np.zeros(3)]
)
def test_everything_else_locks(value: Any) -> None:
    assert is_true(value) is True


def scaled(command: dict[str, float], *limits: dict[str, float]) -> dict[str, float]:
    bounds = Bounds(Schedule(), 0, lambda: None, ranks=True)
    for number, limit in enumerate(limits):
        link = Link("limit", f"L{number}", "A", point("test", 1, 1))
        bounds.input(link)(Message(limit, 0, link.source))
    return bounds.scaled(command)


def test_a_scaled_rate_keeps_its_bound() -> None:
    assert scaled({"Trans_Z": 10.0, "Rotn_Y": -4.0}, {"Trans_Z": 5}) == {
        "Trans_Z": 5.0,
        "Rotn_Y": -2.0,
    }
    assert str(scaled({"Trans_Z": -3.0}, {"Trans_Z": 0})) == "{'Trans_Z': 0.0}"
    random = Random(0)
    for _ in range(2000):
        rate, bound = random.uniform(-900, 900), random.uniform(0, 300)
        result = scaled({"Trans_Z": rate}, {"Trans_Z": bound}, {"Rotn_Y": 1})["Trans_Z"]
        assert result == pytest.approx(max(-bound, min(bound, rate)))
        assert abs(result) <= bound
