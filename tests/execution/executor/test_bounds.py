"""Truths of locks and inhibitions, and the scaling of rates by limits."""

from decimal import Decimal
from typing import Any

import numpy as np
import pytest

from mars_asp.execution.executor.bounds import is_true


@pytest.mark.parametrize(
    "value", [False, 0, 0.0, -0.0, Decimal(0), None, np.bool_(False), np.int64(0), np.array(0)]
)
def test_false_zero_and_none_are_no_truths(value: Any) -> None:
    assert is_true(value) is False


@pytest.mark.parametrize(
    "value", [True, 2, -0.1, "", [], {}, "0", np.bool_(True), np.float32(1), np.zeros(3)]
)
def test_everything_else_is_a_truth(value: Any) -> None:
    assert is_true(value) is True
