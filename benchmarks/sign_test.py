"""Whether two robots pass as many worlds: `python benchmarks/sign_test.py RUNS KEY|OTHER.jsonl`.

RUNS is the file of a campaign. Its runs with one value of KEY, such as `modules.Collide`, are
compared with those of the same world and another value, for each combination of the other keys; or
with those of the same seeds and keys in another file. Only worlds in which the verdicts differ
count: if there were no difference, either verdict would be as likely. The probability p is that of
a difference as great as this or greater, on either side (McNemar's test with the exact binomial
distribution).
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


def compared(path: Path, with_what: str) -> Passed:
    """Return the runs of a file by the values of a key, or those of two files by their names."""
    found: Passed = {}
    two = with_what.endswith(".jsonl")
    for file in (path, Path(with_what)) if two else (path,):
        for run in runs(file):
            value = file.stem if two else f"{run['vary'][with_what]}"
            others = tuple(f"{k}={v}" for k, v in run["vary"].items() if two or k != with_what)
            found.setdefault(value, {})[others, run["seed"]] = run["verdict"] == "pass"
    return found


def lines(passed: Passed) -> Iterator[str]:
    """Yield what each value shows against the next, for each combination of other keys."""
    cells = list(dict.fromkeys(cell for worlds in passed.values() for cell, _ in worlds))
    for one, other in pairwise(passed):
        for cell in cells:
            pairs = Counter(
                (passed[one][world], passed[other][world])
                for world in passed[one]
                if world[0] == cell and world in passed[other]
            )
            if not pairs:
                continue
            shown = ", ".join(each for each in cell if any(each not in c for c in cells))
            first, second = pairs[True, False], pairs[False, True]
            yield f"{shown or 'all'}: of {pairs.total()} worlds"
            yield (
                f"  {pairs[True, True]} passed with both, {first} only with {one}, "
                f"{second} only with {other}, p = {probability(first, second):.2g}"
            )


if __name__ == "__main__":
    print(*lines(compared(Path(sys.argv[1]), sys.argv[2])), sep="\n")
