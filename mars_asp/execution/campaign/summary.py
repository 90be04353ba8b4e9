"""The summary of a campaign: shares with intervals, quantiles, warnings, the worst runs."""

import json
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import chain, zip_longest
from math import ceil, inf, sqrt
from typing import Any, NamedTuple

PASS, FAIL, NOT_DECIDED = "pass", "fail", "not decided"
#: Maximal number of shown runs that did not pass.
MOST_WORST = 5
#: The two-sided 95 % quantile of the normal distribution.
_Z = 1.959963984540054
_Result = Mapping[str, Any]


class Share(NamedTuple):
    """A share of runs: `held` of `of` runs have a property."""

    held: int
    of: int

    @property
    def interval(self) -> tuple[float, float]:
        """The 95 % score interval of the share, as fractions; (0, 1) if there is no run.

        E. B. Wilson, "Probable inference, the law of succession, and statistical inference",
        Journal of the American Statistical Association 22 (1927), 209-212.
        """
        if not self.of:
            return 0.0, 1.0
        share, spread = self.held / self.of, _Z * _Z / self.of
        half = _Z * sqrt(share * (1 - share) / self.of + spread / (4 * self.of))
        low, high = ((share + spread / 2 + side) / (1 + spread) for side in (-half, half))
        # Exact at the ends, without rounding errors.
        return 0.0 if self.held == 0 else low, 1.0 if self.held == self.of else high

    @property
    def text(self) -> str:
        """The share with its interval as the text of a table."""
        low, high = self.interval
        return f"{self.held} of {self.of} ({100 * low:.1f}-{100 * high:.1f} %)"


#: The percentages of the quantiles.
QUANTILES = (5, 25, 50, 75, 95)


class Spread(NamedTuple):
    """Quantiles of a quantity over the `of` runs that have it; inf for a goal never reached."""

    of: int
    values: tuple[float, ...]


class Cell(NamedTuple):
    """The runs with one combination of values: shares of passed runs and held requirements.

    `in_control` has the share of runs in which each controller was in control at some time,
    `warnings` the number of runs with each warning.
    """

    vary: Mapping[str, Any]
    passed: Share
    requirements: Mapping[str, Share]
    in_control: Mapping[str, Share]
    spreads: Mapping[str, Spread]
    warnings: Mapping[str, int]


def share_passed(results: Iterable[_Result]) -> Share:
    """Return how many of the runs passed, and the number of runs."""
    verdicts = [result["verdict"] for result in results]
    return Share(verdicts.count(PASS), len(verdicts))


def _requirement_shares(results: Sequence[_Result]) -> dict[str, Share]:
    """Return for each requirement the share of runs in which it held, where it was decided."""
    counts: dict[str, list[int]] = {}
    for result in results:
        for requirement in result["requirements"]:
            count = counts.setdefault(requirement["name"], [0, 0])
            count[0] += requirement["holds"] is True
            count[1] += requirement["holds"] is not None
    return {name: Share(*count) for name, count in counts.items()}


def _control_shares(results: Sequence[_Result]) -> dict[str, Share]:
    """Return for each controller the share of the runs without error in which it had control."""
    times = [result["control_time"] for result in results if not result.get("error")]
    names = sorted({name for each in times for name in each})
    return {name: Share(sum(each.get(name, 0) > 0 for each in times), len(times)) for name in names}


def cells(results: Iterable[_Result]) -> list[Cell]:
    """Return the runs grouped by their varied values, in the order of first occurrence."""
    groups: dict[str, list[_Result]] = {}
    for result in results:
        groups.setdefault(json.dumps(result["vary"], sort_keys=True), []).append(result)
    return [cell_of(group[0]["vary"], group) for group in groups.values()]


def are_equal(results: Iterable[_Result]) -> bool:
    """Whether the runs with the same varied values differ in their seeds alone, some at least."""
    groups: dict[str, list[str]] = {}
    for result in results:
        rest = {key: value for key, value in result.items() if key != "seed"}
        cell = json.dumps(result["vary"], sort_keys=True)
        groups.setdefault(cell, []).append(json.dumps(rest, sort_keys=True))
    several = [group for group in groups.values() if len(group) > 1]
    return bool(several) and all(len(set(group)) == 1 for group in several)


def cell_of(vary: Mapping[str, Any], results: Sequence[_Result]) -> Cell:
    """Return the shares, quantiles and warnings of the runs with the values `vary`."""
    return Cell(
        vary,
        share_passed(results),
        _requirement_shares(results),
        _control_shares(results),
        _spreads(results),
        _warning_counts(results),
    )


def fixed_values(groups: Sequence[Cell]) -> dict[str, Any]:
    """Return the keys that have one value in all cells, with this value."""
    first = groups[0].vary if groups else {}
    return {
        key: value
        for key, value in first.items()
        if all(key in cell.vary and cell.vary[key] == value for cell in groups)
    }


def _spreads(results: Iterable[_Result]) -> dict[str, Spread]:
    """Return the quantiles of clearance, and of the times and distances of `reach` goals.

    With several goals, each robot has its own quantiles. A goal that was not reached has time inf.
    """
    values: dict[str, list[float]] = {}
    for result in results:
        if result.get("min_clearance_mm") is not None:
            values.setdefault("min_clearance_mm", []).append(result["min_clearance_mm"])
        places = result.get("places") or {}
        for name, (reached, nearest) in places.items():
            before = f"{name}." if len(places) > 1 else ""
            seconds = inf if reached is None else reached
            values.setdefault(f"{before}reached_s", []).append(seconds)
            values.setdefault(f"{before}nearest_to_place_mm", []).append(nearest)
    found = {}
    for name, each in values.items():
        each.sort()
        ranks = (max(1, ceil(percent * len(each) / 100)) for percent in QUANTILES)
        found[name] = Spread(len(each), tuple(each[rank - 1] for rank in ranks))
    return found


def _warning_counts(results: Iterable[_Result]) -> dict[str, int]:
    """Return the number of runs with each warning, the most frequent first."""
    found = Counter(chain.from_iterable(result.get("warnings") or () for result in results))
    return dict(sorted(found.items(), key=lambda each: (-each[1], each[0])))


def worst(results: Iterable[_Result]) -> list[_Result]:
    """Return at most five of the runs that did not pass: the worst of each requirement in turn.

    Runs that failed without an end come first, then the requirement that failed most often; runs
    that were not decided follow. The worst run of a requirement is the worst by its measure:
    contacts, clearance, or the distance to the place.
    """
    unpassed = [each for each in results if each["verdict"] != PASS]
    found: dict[str, _Result] = {}
    for verdict, holds in ((FAIL, False), (NOT_DECIDED, None)):
        groups: dict[str, list[_Result]] = {}
        for result in (each for each in unpassed if each["verdict"] == verdict):
            missed = [each["name"] for each in result["requirements"] if each["holds"] is holds]
            for name in missed or [""]:
                groups.setdefault(name, []).append(result)
        ranked = sorted(groups.items(), key=lambda group: (group[0] != "", -len(group[1])))
        columns = [sorted(group, key=lambda each: _badness(name, each)) for name, group in ranked]
        for result in chain.from_iterable(zip_longest(*columns)):
            if result is not None:
                found.setdefault(json.dumps([result["seed"], result["vary"]]), result)
    return list(found.values())[:MOST_WORST]


def _badness(requirement: str, result: _Result) -> tuple[float, ...]:
    """Return a sort key of runs, lower for worse ones, first by the measure of a requirement."""
    clearance, contacts = result.get("min_clearance_mm"), result.get("collisions") or 0
    near = inf if clearance is None else clearance
    places = (result.get("places") or {}).values()
    measures = {
        "no_collision": -contacts,
        "clearance": near,
        "reach": -max((far for reached, far in places if reached is None), default=0),
        "exclusive": -(result.get("turn_while_driving_s") or 0),
    }
    violated = sum(each["holds"] is False for each in result["requirements"])
    return measures.get(requirement, 0), -violated, -contacts, near


def summary_json(results: Sequence[_Result], command: Callable[[_Result], str]) -> dict[str, Any]:
    """Return the summary line of a campaign; `command` returns the command that repeats a run."""
    return {
        **_cell_json(cell_of({}, results)),
        "cells": [{"vary": cell.vary, **_cell_json(cell)} for cell in cells(results)],
        "worst": [
            {"seed": each["seed"], "vary": each["vary"], "command": command(each)}
            for each in worst(results)
        ],
    }


def _cell_json(cell: Cell) -> dict[str, object]:
    return {
        "runs": cell.passed.of,
        "passed": cell.passed.held,
        **_interval_json(cell.passed),
        "requirements": _shares_json(cell.requirements),
        "in_control": _shares_json(cell.in_control),
        "quantiles": {name: _spread_json(spread) for name, spread in cell.spreads.items()},
        "warnings": cell.warnings,
    }


def _shares_json(shares: Mapping[str, Share]) -> dict[str, object]:
    return {
        name: {"held": share.held, "of": share.of, **_interval_json(share)}
        for name, share in shares.items()
    }


def _spread_json(spread: Spread) -> dict[str, object]:
    """Return quantiles by their percentages; null for a goal that was not reached."""
    values = zip(QUANTILES, spread.values, strict=True)
    shown = {str(percent): None if value == inf else value for percent, value in values}
    return {"of": spread.of, **shown}


def _interval_json(share: Share) -> dict[str, float]:
    low, high = share.interval
    return {"low": round(low, 6), "high": round(high, 6)}
