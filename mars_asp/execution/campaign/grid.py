"""The runs of a campaign: the product of seeds and values of keys of the scenario."""

import json
import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product
from typing import Any, NamedTuple

from mars_asp.execution.scenario.vary import Axis, Changes

#: Maximal number of runs, because their lines are kept in memory.
MOST_RUNS = 100_000
_RANGE = re.compile(r"(-?\d{1,19})(?:-(-?\d{1,19}))?")
_LEAST_SEED, _GREATEST_SEED = -(2**63), 2**63 - 1


class Run(NamedTuple):
    """One run of a campaign: its seed, and the changed values of the scenario."""

    seed: int
    changes: Changes

    @property
    def vary(self) -> dict[str, Any]:
        """The changed values in alphabetical order of their keys, as in the line of the run."""
        return dict(sorted(self.changes.items()))

    @property
    def name(self) -> str:
        """The name of the run in its campaign, independent of the order of keys."""
        return run_name(self.seed, self.vary)


def run_name(seed: int, vary: Changes) -> str:
    """Return the name of a run, from its seed and its changed values."""
    return json.dumps([seed, vary], sort_keys=True)


@dataclass(frozen=True)
class Grid:
    """Seeds and axes; the first axis changes slowest, seeds change fastest."""

    seeds: tuple[int, ...]
    axes: tuple[Axis, ...] = ()

    def __len__(self) -> int:
        return math.prod((len(self.seeds), *(len(axis.values) for axis in self.axes)))

    def cells(self) -> Iterator[Changes]:
        """Yield each combination of values; {} if there is no axis."""
        keys = [axis.key for axis in self.axes]
        for values in product(*(axis.values for axis in self.axes)):
            yield dict(zip(keys, values, strict=True))

    def runs(self) -> Iterator[Run]:
        """Yield the runs, cell after cell."""
        for cell in self.cells():
            for seed in self.seeds:
                yield Run(seed, cell)


def read_seeds(text: str) -> tuple[int, ...]:
    """Return seeds such as `1-200` or `1,5,9-12`, in this order.

    Raises:
        ValueError: the text is malformed, or has a seed twice or too many seeds.
    """
    seeds: dict[int, None] = {}
    for part in text.split(","):
        match = _RANGE.fullmatch(part.strip())
        if match is None:
            raise ValueError(f"`{part.strip()}` is not a seed or a range of seeds such as 1-200")
        low, high = int(match[1]), int(match[2] or match[1])
        if high < low:
            raise ValueError(f"the range `{part.strip()}` is empty: {high} is below {low}")
        if low < _LEAST_SEED or high > _GREATEST_SEED:
            raise ValueError(f"`{part.strip()}` is out of range: seeds have 64 bits")
        if len(seeds) + high - low >= MOST_RUNS:
            raise ValueError(f"a campaign has at most {MOST_RUNS} runs")
        for seed in range(low, high + 1):
            if seed in seeds:
                raise ValueError(f"seed {seed} is given twice")
            seeds[seed] = None
    return tuple(seeds)
