"""The line on standard error that shows how far a verb is, where a person is watching."""

import argparse
import os
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, TypeVar

from mars_asp.output import visible

if TYPE_CHECKING:
    from mars_asp.execution.trial import Trial

#: Seconds between two lines: more often is not read, and a terminal takes time.
_PATIENCE = 0.1


_T = TypeVar("_T")


@contextmanager
def live_line(
    arguments: argparse.Namespace, line_of: Callable[[_T, float], str]
) -> Iterator[Callable[[_T], None]]:
    """Yield a function that shows the progress; its line is removed at the end.

    `line_of` returns the line, of what is shown and the seconds that it took until now.
    """
    if arguments.quiet or not sys.stderr.isatty():
        yield lambda at: None
        return
    columns, started, shown = _columns(), time.monotonic(), -_PATIENCE

    def show(at: _T) -> None:
        nonlocal shown
        wall = time.monotonic() - started
        if wall - shown >= _PATIENCE:
            shown = wall
            write(visible(line_of(at, wall))[:columns])

    def write(line: str) -> None:
        # A line that fills the last column, or is longer, would stay when it is to be replaced.
        print(f"\r{line.ljust(columns)}\r{line}", end="", file=sys.stderr, flush=True)

    try:
        yield show
    finally:
        write("")


def _columns() -> int:
    try:
        columns = os.get_terminal_size(sys.stderr.fileno()).columns
    except (OSError, ValueError):
        columns = 0
    # A terminal that does not know its size says 0.
    return (columns or 80) - 1


def run_line(trial: "Trial", wall: float) -> str:
    """Return where a run stands after `wall` seconds of computing."""
    effectors = [trial.executor.effectors.get(each.module) for each in trial.scenario.robots]
    holders = (each.message.origin or "nobody" for each in effectors if each and each.message)
    dropped = sum(link.dropped.total() for link in trial.executor.links)
    seconds = trial.bodies[0].seconds
    return (
        f"{seconds:6.1f} of {trial.scenario.duration:g} s  {seconds / max(wall, 1e-9):5.0f}x  "
        f"least clearance {trial.clearance:6.0f} mm  dropped {dropped}  "
        f"in control: {', '.join(holders) or 'nobody'}"
    )
