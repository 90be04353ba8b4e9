"""A repeating splitter promises nothing before its first message.

`python -m tests.execution.test_repeating HOW_MANY FIRST_SEED` tries as many as wanted.
"""

import random
import sys
from collections.abc import Iterable
from math import floor
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest

from mars_asp.execution.promises import LinkStats, promises
from mars_asp.execution.trial import Trial
from tests.support.trials import BASE, trial, verdicts

SPECIFICATION = """\
@specification
@modules P, S, A, B, D, DataSplitter1, DataSplitter2
DataSplitter1 uses_data_from S
A uses_data_from DataSplitter1 NotifyAtFrequency {fast}
DataSplitter2 uses_data_from DataSplitter1 NotifyAtFrequency {fast}
B uses_data_from DataSplitter2 NotifyAtFrequency {slow}
D uses_data_from DataSplitter2
@module_start
@module_name S
@Sense NotifyWhenReady
int read();
@module_end
"""
SENSOR = """\
[bindings.S]
python = "s.py:read"
period = {period}
"""
CODE = """\
calls = [0]
def read():
    calls[0] += 1
    return calls[0] if {first} <= calls[0] else None
"""
#: The links that repeat messages, and those downstream of them.
REPEATED = (1, 2, 3, 4)


def ran(folder: Path, *, first: int, period: float, fast: float = 10, slow: float = 4) -> Trial:
    (folder / "s.py").write_text(CODE.format(first=first))
    text = SPECIFICATION.format(fast=fast, slow=slow)
    return trial(BASE + SENSOR.format(period=period), text, folder)


@pytest.mark.parametrize(("first", "promised"), [(1, [30, 30, 12, 30]), (6, [20, 20, 8, 20])])
def test_promises_begin_with_the_first_message(
    first: int, promised: list[int], tmp_path: Path
) -> None:
    made = ran(tmp_path, first=first, period=200)
    found = [*promises(made)]
    assert [found[k].promised for k in REPEATED] == promised
    assert verdicts(made)["services delivered"] is True


def test_without_a_message_nothing_is_promised(tmp_path: Path) -> None:
    made = ran(tmp_path, first=99, period=200)
    assert [each.promised for each in promises(made)] == [None] * 5
    assert verdicts(made)["services delivered"] is True


def undelivered(seeds: Iterable[int], folder: Path) -> list[tuple[int, LinkStats]]:
    """Return the promises that were not kept of random rates and first messages."""
    found = []
    for seed in seeds:
        rng = random.Random(seed)
        fast = rng.choice([3, 7.5, 10, 37, 58.8235])
        slow = floor(1000 * fast / rng.choice([1, 2, 2.5, 3])) / 1000
        period = rng.choice([1, 90, 100, 125, 333.25])
        first = 1 + round(rng.choice([0, rng.uniform(0, 3500)]) / period)
        made = ran(folder, first=first, period=period, fast=fast, slow=slow)
        found += [(seed, each) for each in promises(made) if each.delivered < (each.promised or 0)]
    return found


def test_no_link_of_a_late_source_breaks_a_promise(tmp_path: Path) -> None:
    assert undelivered(range(25), tmp_path) == []


if __name__ == "__main__":
    begin = int(sys.argv[2])
    with TemporaryDirectory() as folder:
        broken = undelivered(range(begin, begin + int(sys.argv[1])), Path(folder))
    print(f"{len(broken)} promises of {sys.argv[1]} runs are broken: {broken[:3]}")
