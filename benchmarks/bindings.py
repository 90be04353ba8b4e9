"""Runs random clients of several inputs and compares each parameter with a reading of the text.

    python benchmarks/bindings.py [COUNT [FIRST]]

The suite judges few seeds, this as many as are requested (1,000 without COUNT).
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from tests.execution.test_bindings import assert_bound_as_written, assert_order_of_clients_is_free


def main(count: int = 1000, first: int = 0) -> None:
    """Judge the seeds from the first on."""
    for seed in range(first, first + count):
        assert_bound_as_written(seed)
        if seed % 4 == 0:
            assert_order_of_clients_is_free(seed)
    print(f"{count} configurations are run as they are written")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
