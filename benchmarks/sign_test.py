"""Whether two robots pass as many worlds.

`python benchmarks/sign_test.py RUNS KEY|OTHER.jsonl [REQUIREMENT ...]`

RUNS is the file of a campaign. Its runs with one value of KEY, such as `modules.Collide`, are
compared with those of the same world and another value, for each combination of the other keys; or
with those of another file that have the same seed and the same values of the keys of both files.
A run passes where its verdict is `pass`, or where a REQUIREMENT such as `no_collision` holds. Only
worlds in which the verdicts differ count: if there were no difference, either verdict would be as
likely. The probability p is that of a difference as great as this or greater, on either side
(McNemar's test with the exact binomial distribution).
"""

import json
import sys
from collections import Counter
from collections.abc import Iterator, Mapping
from itertools import pairwise
from math import comb
from pathlib import Path
from typing import Any, TypeAlias

#: What a run varies, without what is compared, and its seed.
World: TypeAlias = tuple[tuple[str, ...], int]
#: Whether the runs passed that are compared, by what differs between them.
Passed: TypeAlias = dict[str, dict[World, bool]]


def probability(one: int, other: int) -> float:
    """Return how likely fair coins are to fall as unevenly as `one` to `other`."""
    count = one + other
    tail = sum(comb(count, k) for k in range(min(one, other) + 1))
    return min(1.0, 2 * tail / (1 << count))


def runs(path: Path) -> Iterator[Mapping[str, Any]]:
    """Yield the runs of a campaign."""
    with path.open(encoding="utf-8") as lines:
        yield from (run for run in map(json.loads, lines) if "seed" in run)


def passes(run: Mapping[str, Any], requirement: str) -> bool:
    """Return whether a requirement holds in a run; the empty one is its verdict."""
    if not requirement:
        return bool(run["verdict"] == "pass")
    return next(bool(each["holds"]) for each in run["requirements"] if each["name"] == requirement)


def compared(path: Path, with_what: str, requirement: str = "") -> Passed:
    """Return the runs of a file by the values of a key, or those of two files by their names."""
    two = with_what.endswith(".jsonl")
    files = {file: [*runs(file)] for file in ([path, Path(with_what)] if two else [path])}
    common = set.intersection(*(set(run["vary"]) for each in files.values() for run in each))
    found: Passed = {}
    for file, run in ((file, run) for file, each in files.items() for run in each):
        value = file.stem if two else f"{run['vary'][with_what]}"
        keys = common - {with_what}
        others = tuple(f"{key}={run['vary'][key]}" for key in run["vary"] if key in keys)
        found.setdefault(value, {})[others, run["seed"]] = passes(run, requirement)
    return found


def lines(tables: Mapping[str, Passed]) -> Iterator[str]:
    """Yield a comparison of each value with the next, for each combination of other keys.

    `tables` has the runs of each requirement.
    """
    first = next(iter(tables.values()))
    cells = list(dict.fromkeys(cell for worlds in first.values() for cell, _ in worlds))
    for one, other in pairwise(first):
        for cell in cells:
            worlds = [world for world in first[one] if world[0] == cell and world in first[other]]
            if not worlds:
                continue
            shown = ", ".join(each for each in cell if any(each not in c for c in cells))
            yield f"{shown or 'all'}: of {len(worlds)} worlds"
            for name, passed in tables.items():
                pairs = Counter((passed[one][world], passed[other][world]) for world in worlds)
                left, right = pairs[True, False], pairs[False, True]
                yield (
                    f"  {name + ': ' if name else ''}{pairs[True, True]} passed with both, "
                    f"{left} only with {one}, {right} only with {other}, "
                    f"p = {probability(left, right):.2g}"
                )


def main(path: str, with_what: str, *requirements: str) -> None:
    tables = {name: compared(Path(path), with_what, name) for name in requirements or ("",)}
    print(*lines(tables), sep="\n")


if __name__ == "__main__":
    main(*sys.argv[1:])
