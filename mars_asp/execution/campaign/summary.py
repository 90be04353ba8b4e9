"""What the runs of a campaign show together: shares with their intervals, and the worst worlds."""

import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from math import inf, sqrt
from typing import Any, NamedTuple

PASS, FAIL, NOT_DECIDED = "pass", "fail", "not decided"
#: So many of the runs that did not pass are shown.
MOST_WORST = 5
#: The quantile of the normal distribution that 95 % lie within, on both sides.
_Z = 1.959963984540054
_Result = Mapping[str, Any]


class Share(NamedTuple):
    """In how many of how many runs something held."""

    held: int
    of: int

    @property
    def interval(self) -> tuple[float, float]:
        """The 95 % score interval of the share, as fractions; all of it where there is no run.

        E. B. Wilson, "Probable inference, the law of succession, and statistical inference",
        Journal of the American Statistical Association 22 (1927), 209-212.
        """
        if not self.of:
            return 0.0, 1.0
        share, spread = self.held / self.of, _Z * _Z / self.of
        half = _Z * sqrt(share * (1 - share) / self.of + spread / (4 * self.of))
        low, high = ((share + spread / 2 + side) / (1 + spread) for side in (-half, half))
        # Exact at the ends, where rounding would leave a little.
        return 0.0 if self.held == 0 else low, 1.0 if self.held == self.of else high

    @property
    def text(self) -> str:
        """The share with its interval, as a table shows it."""
        low, high = self.interval
        return f"{self.held} of {self.of} ({100 * low:.1f}-{100 * high:.1f} %)"


class Cell(NamedTuple):
    """The runs with one combination of values: how many passed, and what held in how many.

    `in_control` has in how many a controller was in control at some time.
    """

    vary: Mapping[str, Any]
    passed: Share
    requirements: Mapping[str, Share]
    in_control: Mapping[str, Share]


def share_passed(results: Iterable[_Result]) -> Share:
    """Return in how many runs all requirements held."""
    verdicts = [result["verdict"] for result in results]
    return Share(verdicts.count(PASS), len(verdicts))


def requirement_shares(results: Sequence[_Result]) -> dict[str, Share]:
    """Return in how many runs each requirement held, of those in which it was decided."""
    counts: dict[str, list[int]] = {}
    for result in results:
        for requirement in result["requirements"]:
            count = counts.setdefault(requirement["name"], [0, 0])
            count[0] += requirement["holds"] is True
            count[1] += requirement["holds"] is not None
    return {name: Share(*count) for name, count in counts.items()}


def control_shares(results: Sequence[_Result]) -> dict[str, Share]:
    """Return in how many runs each controller was in control, of those that came to their end."""
    times = [result["control_time"] for result in results if not result.get("error")]
    names = sorted({name for each in times for name in each})
    return {name: Share(sum(each.get(name, 0) > 0 for each in times), len(times)) for name in names}


def cells(results: Iterable[_Result]) -> list[Cell]:
    """Return the runs by what they vary, in the order of their first lines."""
    groups: dict[str, list[_Result]] = {}
    for result in results:
        groups.setdefault(json.dumps(result["vary"], sort_keys=True), []).append(result)
    return [
        Cell(
            group[0]["vary"],
            share_passed(group),
            requirement_shares(group),
            control_shares(group),
        )
        for group in groups.values()
    ]


def fixed_values(groups: Sequence[Cell]) -> dict[str, Any]:
    """Return the values that all cells have."""
    first = groups[0].vary if groups else {}
    return {
        key: value
        for key, value in first.items()
        if all(key in cell.vary and cell.vary[key] == value for cell in groups)
    }


def worst(results: Iterable[_Result]) -> list[_Result]:
    """Return at most five of the runs that did not pass, the worst first.

    A failed run is worse than one that was not decided; then count requirements that were violated,
    collisions, and the least clearance; then the order of the lines.
    """
    return sorted((each for each in results if each["verdict"] != PASS), key=_badness)[:MOST_WORST]


def _badness(result: _Result) -> tuple[bool, int, int, float]:
    violated = sum(each["holds"] is False for each in result["requirements"])
    clearance = result.get("min_clearance_mm")
    return (
        result["verdict"] != FAIL,
        -violated,
        -(result.get("collisions") or 0),
        inf if clearance is None else clearance,
    )


def summary_json(results: Sequence[_Result], command: Callable[[_Result], str]) -> dict[str, Any]:
    """Return the last line of a campaign; `command` is what repeats a run."""
    passed = share_passed(results)
    return {
        "runs": passed.of,
        "passed": passed.held,
        **_interval_json(passed),
        "requirements": _shares_json(requirement_shares(results)),
        "in_control": _shares_json(control_shares(results)),
        "cells": [
            {
                "vary": cell.vary,
                "runs": cell.passed.of,
                "passed": cell.passed.held,
                **_interval_json(cell.passed),
                "requirements": _shares_json(cell.requirements),
                "in_control": _shares_json(cell.in_control),
            }
            for cell in cells(results)
        ],
        "worst": [
            {"seed": each["seed"], "vary": each["vary"], "command": command(each)}
            for each in worst(results)
        ],
    }


def _shares_json(shares: Mapping[str, Share]) -> dict[str, object]:
    return {
        name: {"held": share.held, "of": share.of, **_interval_json(share)}
        for name, share in shares.items()
    }


def _interval_json(share: Share) -> dict[str, float]:
    low, high = share.interval
    return {"low": round(low, 6), "high": round(high, 6)}
