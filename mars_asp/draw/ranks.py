"""Ranks of boxes, so that links go down."""

from collections import defaultdict
from collections.abc import Sequence


def rank_boxes(
    count: int, arcs: Sequence[tuple[int, int]]
) -> tuple[list[int], list[tuple[int, int]]]:
    """Return the rank of each box, from 0, and the arcs, turned to lead to higher ranks.

    Arcs that close a cycle in a depth-first search are turned round.
    """
    finished = _search(count, arcs)
    downward = [(u, v) if finished[u] > finished[v] else (v, u) for u, v in arcs]
    below, above = defaultdict(list), defaultdict(list)
    for upper, lower in downward:
        below[upper].append(lower)
        above[lower].append(upper)
    sequence = sorted(range(count), key=lambda box: -finished[box])
    ranks = [0] * count
    for box in sequence:
        ranks[box] = max((ranks[other] + 1 for other in above[box]), default=0)
    # A box with more arcs downwards than upwards is moved down, close to its targets.
    for box in reversed(sequence):
        if len(below[box]) > len(above[box]):
            ranks[box] = min(ranks[other] for other in below[box]) - 1
    return ranks, downward


def _search(count: int, arcs: Sequence[tuple[int, int]]) -> list[int]:
    """Return the finishing number of each box in a depth-first search that begins at sources."""
    following = defaultdict(list)
    for u, v in arcs:
        following[u].append(v)
    led_to = {v for _, v in arcs}
    finished = [0] * count
    seen = [False] * count
    clock = 0
    for first in sorted(range(count), key=lambda box: (box in led_to, box)):
        if seen[first]:
            continue
        seen[first] = True
        stack = [(first, iter(following[first]))]
        while stack:
            box, rest = stack[-1]
            other = next((v for v in rest if not seen[v]), None)
            if other is None:
                clock += 1
                finished[box] = clock
                stack.pop()
            else:
                seen[other] = True
                stack.append((other, iter(following[other])))
    return finished
