"""Link statistics: the promised and the delivered messages of each data link in a run."""

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from math import ceil, floor, inf

from mars_asp.execution.executor import Link
from mars_asp.execution.executor.gate import Gate
from mars_asp.execution.executor.schedule import MILLISECOND, SECOND, tick_time
from mars_asp.execution.trial import Trial


@dataclass(frozen=True, slots=True)
class LinkStats:
    """A data link with its promised and delivered messages and the delivered rate `hz`.

    Messages are counted over whole periods. These begin when stated delays allow the first message,
    or with the first message if messages are repeated. `promised` is None if no rate is required,
    or if no message came that could be repeated. Faults of links are counted off: a link promises
    no message that it or a link before it lost, and it is judged where it begins.
    """

    number: int
    link: Link
    promised: int | None
    delivered: int
    hz: float


def promises(trial: Trial) -> Iterator[LinkStats]:
    """Yield the statistics of each data link, in the order of the specification."""
    plan, now, begins = trial.executor.plan, trial.executor.schedule.now, _begins(trial)
    for number, link in enumerate(trial.executor.links):
        if link.kind != "data":
            continue
        mode, hz = plan.carried(link)
        begin, promised, end = 0, None, Fraction(now)
        # A Gate lets pass what it may, so no rate is promised after it, unless one is made there.
        made = plan.made(link.source)[0].name
        gated = made == "NotifyAtFrequency" and plan.is_gated(link.source)
        if mode.name == "NotifyAtFrequency" and hz and begins[link] < inf and not gated:
            begin = min(round(begins[link]), now)
            promised = floor(Fraction(now - begin) * hz / SECOND)
            end = begin + promised * SECOND / hz
        # A message exactly at the end belongs to the next period.
        count = link.before(end)
        if link.channel is not None:
            lost = link.channel.lost_before(end)
            count = max(0, link.channel.sent_before(end) - lost)
            promised = None if promised is None else promised - lost or None
        if (
            promised
            and hz is not None
            and (missing := _missing_before(trial, link, hz)) is not None
        ):
            # Late messages may come in the period that is not whole.
            count = max(count, min(promised, link.delivered))
            promised = max(0, promised - missing) or None
        seconds = float(end - begin) / SECOND
        yield LinkStats(number, link, promised, count, count / seconds if seconds else 0.0)


def _missing_before(trial: Trial, link: Link, hz: Fraction) -> int | None:
    """Return how many messages at a rate faults kept from a link's source; None without faults."""
    plan, waiting, seen, missing = trial.executor.plan, [link.source], set[str](), None
    for name in waiting:  # the loop appends to it
        if name in seen:
            continue
        seen.add(name)
        for each in plan.data_in[name]:
            if not plan.is_node(name) and plan.carried(each)[0].name != "RequestWhenReady":
                continue
            waiting.append(each.source)
            if each.channel is not None:
                under_way = each.channel.in_flight * hz / (plan.carried(each)[1] or hz)
                missing = (missing or 0) + each.dropped["lost"] + ceil(under_way)
    return missing


def _begins(trial: Trial) -> dict[Link, float]:
    """Return the time (ns) from which each link can deliver at the promised rate; inf if never.

    Stated delays of the scenario delay the results of a module; a splitter that repeats messages
    has to receive one first.
    """
    plan = trial.executor.plan
    begins: dict[Link, float] = {}
    #: The times of the first deliveries.
    first: dict[Link, float] = {}
    for name in sorted(plan.names, key=lambda name: plan.data_depth[name]):
        delay = round(float(trial.scenario.bindings.get(name, {}).get("delay", 0.0)) * MILLISECOND)
        ready = delay + max((first.get(link, 0) for link in plan.data_in[name]), default=0)
        gate = trial.executor.elements[name]
        if isinstance(gate, Gate):
            ready = max(ready, inf if gate.first is None else gate.first)
        for link in plan.data_out[name]:
            begins[link] = first[link] = ready
            hz = plan.carried(link)[1]
            if link.begun is None:
                begins[link] = first[link] = inf
            elif link.begun > ready and hz is not None:
                begins[link] = link.begun
                first[link] = tick_time(ceil(link.begun * hz / SECOND), hz)
            if link.channel is not None and not plan.is_node(link.client):
                first[link] = inf if link.channel.first is None else link.channel.first
    return begins
