"""How many random or sampled inputs a test tries: few in the suite, many in `make campaigns`."""

import os
from collections.abc import Sequence
from typing import TypeVar

_Input = TypeVar("_Input")
#: Whether the longer campaigns are run.
IS_CAMPAIGN = "MARS_ASP_CAMPAIGNS" in os.environ


def examples(few: int, many: int) -> int:
    """Return how many random examples are tried, `few` in the suite and `many` in campaigns."""
    return many if IS_CAMPAIGN else few


def seeds(few: int, many: int) -> range:
    """Return the seeds from 0 on, `few` in the suite and `many` in campaigns."""
    return range(examples(few, many))


def sample(inputs: Sequence[_Input], step: int, first: int = 0) -> Sequence[_Input]:
    """Return each `step`-th input from the first on in the suite, and all in campaigns."""
    return inputs if IS_CAMPAIGN else inputs[first::step]
