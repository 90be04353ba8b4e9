"""Whether a module changes how many worlds are passed: `python benchmarks/sign_test.py RUNS KEY`.

RUNS is the file of a campaign that varies KEY, such as `modules.Collide`, with two values. Runs of
one world are compared with each other, for each combination of the other keys: only worlds in which
the verdicts differ count, and if KEY made no difference, either verdict would be as likely. The
probability is that of a difference as great as this or greater, on either side (McNemar's test with
the exact binomial distribution).
"""

import json
import sys
from collections import Counter, defaultdict
from math import comb
from pathlib import Path


def probability(one: int, other: int) -> float:
    """Return how likely fair coins are to fall as unevenly as `one` to `other`."""
    count = one + other
    tail = sum(comb(count, k) for k in range(min(one, other) + 1))
    return min(1.0, 2 * tail * 0.5**count)


def main() -> None:
    key = sys.argv[2]
    worlds: defaultdict[str, dict[int, dict[str, bool]]] = defaultdict(dict)
    for line in Path(sys.argv[1]).read_text(encoding="utf-8").splitlines():
        run = json.loads(line)
        if "seed" not in run:
            continue
        value = str(run["vary"].pop(key))
        cell = ", ".join(f"{name}={each}" for name, each in sorted(run["vary"].items()))
        worlds[cell].setdefault(run["seed"], {})[value] = run["verdict"] == "pass"
    for cell, seeds in worlds.items():
        first, second = sorted({value for passed in seeds.values() for value in passed})[::-1]
        pairs = Counter((p[first], p[second]) for p in seeds.values() if len(p) == 2)
        one, other = pairs[True, False], pairs[False, True]
        print(f"{cell or 'all'}: of {pairs.total()} worlds")
        print(
            f"  {pairs[True, True]} passed with both, {one} only with {first}, "
            f"{other} only with {second}, p = {probability(one, other):.2g}"
        )


if __name__ == "__main__":
    main()
