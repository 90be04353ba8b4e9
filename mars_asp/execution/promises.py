"""What links promised to deliver in the time that passed, and what they delivered."""

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from math import floor

from mars_asp.execution.executor import Link
from mars_asp.execution.executor.schedule import MILLISECOND, SECOND
from mars_asp.execution.trial import Trial


@dataclass(frozen=True, slots=True)
class Promise:
    """A data link: how many messages it promised, how many came, and how often (Hz) that is.

    Both are counted over whole periods, from when stated delays let the first message through;
    `promised` is `None` where no rate was asked for.
    """

    number: int
    link: Link
    promised: int | None
    delivered: int
    hz: float


def promises(trial: Trial) -> Iterator[Promise]:
    """Yield the promise of each data link, in the order of the specification."""
    plan, now, held = trial.executor.plan, trial.executor.schedule.now, _held_back(trial)
    for number, link in enumerate(trial.executor.links):
        if link.kind != "data":
            continue
        mode, hz = plan.carried(link)
        begin, promised, end = 0, None, Fraction(now)
        if mode.name == "NotifyAtFrequency" and hz is not None:
            begin = min(held[link.source], now)
            promised = floor(Fraction(now - begin) * hz / SECOND)
            end = begin + promised * SECOND / hz
        # A message at the very end belongs to the period that begins there.
        count = link.before(end)
        seconds = float(end - begin) / SECOND
        yield Promise(number, link, promised, count, count / seconds if seconds else 0.0)


def _held_back(trial: Trial) -> dict[str, int]:
    """Return for how long (ns) delays that the scenario states hold back what each source sends."""
    plan, held = trial.executor.plan, dict[str, int]()
    for name in sorted(plan.names, key=lambda name: plan.data_depth[name]):
        stated = float(trial.scenario.bindings.get(name, {}).get("delay", 0.0))
        before = (held.get(link.source, 0) for link in plan.data_in[name])
        held[name] = round(stated * MILLISECOND) + max(before, default=0)
    return held
