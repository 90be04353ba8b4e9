"""What links promised to deliver in the time that passed, and what they delivered."""

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from math import ceil, floor, inf

from mars_asp.execution.executor import Link
from mars_asp.execution.executor.schedule import MILLISECOND, SECOND, tick_time
from mars_asp.execution.trial import Trial


@dataclass(frozen=True, slots=True)
class LinkStats:
    """A data link: how many messages it promised, how many came, and how often (Hz) that is.

    Both are counted over whole periods, from when stated delays let the first message through, and
    where messages are repeated, from the first one. `promised` is None where no rate is required,
    or no message came that could be repeated.
    """

    number: int
    link: Link
    promised: int | None
    delivered: int
    hz: float


def promises(trial: Trial) -> Iterator[LinkStats]:
    """Yield the promise of each data link, in the order of the specification."""
    plan, now, begins = trial.executor.plan, trial.executor.schedule.now, _begins(trial)
    for number, link in enumerate(trial.executor.links):
        if link.kind != "data":
            continue
        mode, hz = plan.carried(link)
        begin, promised, end = 0, None, Fraction(now)
        if mode.name == "NotifyAtFrequency" and hz is not None and begins[link] < inf:
            begin = min(round(begins[link]), now)
            promised = floor(Fraction(now - begin) * hz / SECOND)
            end = begin + promised * SECOND / hz
        # A message at the very end belongs to the period that begins there.
        count = link.before(end)
        seconds = float(end - begin) / SECOND
        yield LinkStats(number, link, promised, count, count / seconds if seconds else 0.0)


def _begins(trial: Trial) -> dict[Link, float]:
    """Return the instant (ns) from which each link can deliver what it promises, inf if never.

    Delays that the scenario states hold back the results of a module, and a splitter that repeats
    has no message before the first.
    """
    plan = trial.executor.plan
    begins: dict[Link, float] = {}
    #: The instants of the first deliveries.
    first: dict[Link, float] = {}
    for name in sorted(plan.names, key=lambda name: plan.data_depth[name]):
        delay = round(float(trial.scenario.bindings.get(name, {}).get("delay", 0.0)) * MILLISECOND)
        ready = delay + max((first.get(link, 0) for link in plan.data_in[name]), default=0)
        for link in plan.data_out[name]:
            begins[link] = first[link] = ready
            hz = plan.carried(link)[1]
            if link.begun is None:
                begins[link] = first[link] = inf
            elif link.begun > ready and hz is not None:
                begins[link] = link.begun
                first[link] = tick_time(ceil(link.begun * hz / SECOND), hz)
    return begins
