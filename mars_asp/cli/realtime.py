"""Carry out a run, as fast as possible or limited by the clock, and show it in a page."""

import argparse
import time
from collections.abc import Iterator
from contextlib import AbstractContextManager, nullcontext
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mars_asp.cli.watch import Stage
    from mars_asp.execution.trial import Trial

#: Simulated seconds between two stages of a run.
_GLANCE = 0.5
#: Seconds between two stages of a paced run.
_FRAME = 0.1


def live_view(arguments: argparse.Namespace, title: str) -> "AbstractContextManager[Stage | None]":
    """Return a context with the page that shows a paced run; with None if not paced or quiet."""
    if arguments.speed is None or arguments.quiet:
        return nullcontext()
    from mars_asp.cli.watch import watched

    return watched(title)


def run_realtime(trial: "Trial", speed: float | None) -> Iterator[None]:
    """Run a trial to its end, at most `speed` times as fast as real time; yield between stages.

    The motion is computed at the same instants at any speed, so a run does not depend on it.
    """
    from mars_asp.execution.executor.schedule import SECOND

    duration, at, started = trial.scenario.duration, 0.0, time.monotonic()
    while at < duration:
        following = min(duration, at + _GLANCE)
        if speed is not None:
            while (at := at + _FRAME * speed) < following:
                _wait_until(started + at / speed)
                trial.executor.step_until(round(at * SECOND))
                yield
            _wait_until(started + following / speed)
        at = following
        trial.run_until(at)
        yield


def _wait_until(instant: float) -> None:
    time.sleep(max(0.0, instant - time.monotonic()))
