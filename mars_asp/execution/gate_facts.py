"""The facts about Gates and locks in a run that `rules/run/gates.lp` reads."""

from bisect import bisect_left, bisect_right
from collections.abc import Iterator, Mapping
from itertools import groupby, pairwise
from math import inf
from operator import itemgetter
from typing import Any

from mars_asp.asp.solve.atoms import Atom, Fact, fact_at
from mars_asp.execution.executor.arbitration import FlatArbitration, HierarchicalArbitration
from mars_asp.execution.executor.bounds import History
from mars_asp.execution.executor.gate import Gate, Trigger
from mars_asp.execution.executor.link import Link
from mars_asp.execution.executor.schedule import MILLISECOND
from mars_asp.execution.observed import MOST, milliseconds, seen
from mars_asp.execution.trial import Trial

_Arbiter = FlatArbitration | HierarchicalArbitration


def gate_facts(trial: Trial) -> Iterator[Fact]:
    """Yield the lines of each Gate and each lock, and the facts by which they are judged."""
    plan, numbers = trial.executor.plan, _numbers(trial)
    for gate in _gates(trial):
        gated = plan.origin_of((plan.data_in[gate.name] or plan.control_in[gate.name])[0])
        for trigger in gate.triggers:
            link, number = trigger.link, numbers[trigger.link]
            ends = gate.name, plan.origin_of(link), gated
            sign = Atom(link.kind), link.time // MILLISECOND
            yield fact_at(link.span, "closes", number, *ends, *sign)
            if link.kind == "suppress":
                yield seen("spoke", number, len(trigger.heard))
                yield seen("let_through", number, trigger.passed)
            yield from _extremes(gate, trigger, number)
    for arbiter in trial.executor.arbiters.values():
        for limit in arbiter.bounds.limits:
            link, number = limit.link, numbers[limit.link]
            yield fact_at(link.span, "limits_line", number, arbiter.name, plan.origin_of(link))
        for _, lock, _ in arbiter.bounds.refused[:1]:
            for name in _effectors(trial, arbiter):
                yield seen("held_back", numbers[lock.link], name)
        for lock in arbiter.bounds.locks:
            link, number = lock.link, numbers[lock.link]
            yield fact_at(link.span, "locks_line", number, arbiter.name, plan.origin_of(link))
            if link.declared is not None and arbiter.bounds.ranks:
                yield fact_at(link.span, "lets_pass", number, link.declared)
            if isinstance(arbiter, HierarchicalArbitration):
                yield from _held(trial, arbiter, lock, number)


def _extremes(gate: Gate, trigger: Trigger, number: int) -> Iterator[Fact]:
    """Yield the shortest time from a trigger to a message that passed, the longest to a loss.

    A message that no trigger kept back and that did not pass is a loss of the first trigger.
    """
    times = [time for time, _, _ in trigger.heard]
    soonest: tuple[int, int] | None = None
    longest: tuple[int, int] | None = None
    for at, closer, passed in gate.verdicts:
        if not passed and (closer or gate.triggers[0]) is not trigger:
            continue
        # Of one instant, triggers count first, but for those that act late or by sequence.
        first = trigger.late or (trigger.in_circle and passed)
        last = (bisect_left(times, at) if first else bisect_right(times, at)) - 1
        closed = last >= 0 and trigger.heard[last][1]
        after = at - times[last] if closed else MOST * MILLISECOND
        if passed and closed:
            soonest = min(soonest or (after, at), (after, at))
        elif not passed:
            longest = max(longest or (after, at), (after, at))
    for name, extreme in (("passed_after", soonest), ("lost_after", longest)):
        if extreme is not None:
            yield seen(name, number, *map(milliseconds, extreme))


def _held(
    trial: Trial, arbiter: HierarchicalArbitration, lock: History[bool], number: int
) -> Iterator[Fact]:
    """Yield the periods in which a controller held an arbiter that a lock had locked."""
    now = trial.executor.schedule.now
    holdings = [(h.since, h.through) for h in arbiter.holdings] + [(now, "")]
    for (since, holder), (until, _) in pairwise(holdings):
        if not holder or until == since:
            continue
        changes = [since, *lock.times[bisect_right(lock.times, since) :], until]
        for begin, end in pairwise(time for time in changes if time <= until):
            silent = end
            if lock.link.hold is not None:
                before = lock.times[: bisect_right(lock.times, begin)]
                silent = max(begin, before[-1] + lock.link.hold if before else 0)
            locked = begin if lock.at(begin) else silent
            if locked < end:
                ends = milliseconds(locked), milliseconds(end)
                yield seen("held_locked", number, holder, *ends)


def reasons(trial: Trial, *, losses: bool) -> Iterator[Fact]:
    """Yield facts for what Gates let pass and locks stopped, or for what Gates kept back."""
    plan, numbers = trial.executor.plan, _numbers(trial)
    for gate in _gates(trial):
        data, commands = plan.data_out[gate.name], plan.control_out[gate.name]
        targets = dict.fromkeys(name for link in data for name in plan.targets_of(link))
        # Of a command only the arbiter is certain: another controller may win there.
        targets |= dict.fromkeys(link.client for link in commands)
        client = " and ".join(targets) or gate.name
        for trigger in gate.triggers:
            number = numbers[trigger.link]
            if losses:
                yield from _losses(gate, trigger, number, client)
            elif trigger.link.kind == "suppress":
                until = -1
                for at, _, made in trigger.heard:
                    if at >= until:
                        yield seen("got", number, client, milliseconds(made), milliseconds(at))
                    until = at + trigger.link.time
    for arbiter in trial.executor.arbiters.values():
        if losses:
            yield from _refusals(trial, arbiter, numbers)
        else:
            yield from _stops(trial, arbiter, numbers)


def _losses(gate: Gate, trigger: Trigger, number: int, client: str) -> Iterator[Fact]:
    """Yield the messages that a trigger kept back, for each period in which it kept closing.

    The trigger's messages are those from the first to the last one that kept back a message.
    """
    times = [time for time, _, _ in trigger.heard]
    lost: dict[int, list[tuple[int, int]]] = {}
    for at, closer, _ in gate.verdicts:
        if closer is trigger:
            own = first = (bisect_left if trigger.late else bisect_right)(times, at) - 1
            while (
                first
                and trigger.heard[first - 1][1]
                and times[first] - times[first - 1] < trigger.link.time
            ):
                first -= 1
            lost.setdefault(first, []).append((times[own], at))
    for dropped in lost.values():
        (since, first_at), (until, last_at) = dropped[0], dropped[-1]
        ends = milliseconds(first_at), milliseconds(last_at)
        spoke = milliseconds(since), milliseconds(until)
        yield seen("kept_from", number, client, *spoke, len(dropped), *ends)
        following = trigger.heard[bisect_right(times, until) :]
        if following and not following[0][1] and following[0][0] < until + trigger.link.time:
            yield seen("ended", number, client, ends[0], milliseconds(following[0][0]))


def _refusals(trial: Trial, arbiter: _Arbiter, numbers: Mapping[Link, int]) -> Iterator[Fact]:
    """Yield the commands that a lock held back, for each controller and period of locking."""
    plan, (effector, _) = trial.executor.plan, _commanded(trial, arbiter)
    opened = {
        lock: [time for time, closes in zip(lock.times, lock.values, strict=True) if not closes]
        for lock in arbiter.bounds.locks
    }
    periods: dict[tuple[History[bool], Link, int], list[int]] = {}
    for at, lock, link in arbiter.bounds.refused:
        periods.setdefault((lock, link, bisect_right(opened[lock], at)), []).append(at)
    for (lock, link, _), times in periods.items():
        ends = milliseconds(times[0]), milliseconds(times[-1])
        number, controller = numbers[lock.link], plan.origin_of(link)
        yield seen("held_from", number, effector, controller, len(times), *ends)
        yield from _silence(lock, number, effector, times[0])


def _stops(trial: Trial, arbiter: _Arbiter, numbers: Mapping[Link, int]) -> Iterator[Fact]:
    """Yield the stops by locks and limits, and the commands that a limit lowered."""
    bounds, (effector, started) = arbiter.bounds, _commanded(trial, arbiter)
    stops: list[tuple[int, History[Any]]] = [*bounds.stops]
    if bounds.refused and bounds.refused[0][0] < min([started, *(at for at, _ in stops)]):
        stops.append(bounds.refused[0][:2])
    for (limit, is_stop), scalings in groupby(bounds.scalings.items(), itemgetter(1)):
        times = [at for at, _ in scalings]
        if limit is not None and is_stop:
            stops.append((times[0], limit))
        elif limit is not None:
            ends = milliseconds(times[0]), milliseconds(times[-1])
            yield seen("lowered", numbers[limit.link], effector, len(times), *ends)
    for at, history in stops:
        number = numbers[history.link]
        yield seen("stopped_by", number, effector, milliseconds(at))
        if started < at:
            yield seen("had_started", effector, milliseconds(at))
        yield from _silence(history, number, effector, at)


def _effectors(trial: Trial, arbiter: _Arbiter) -> list[str]:
    plan = trial.executor.plan
    links = plan.control_out[arbiter.name]
    return list(dict.fromkeys(name for link in links for name in plan.targets_of(link)))


def _commanded(trial: Trial, arbiter: _Arbiter) -> tuple[str, float]:
    """Return the effectors of an arbiter, and the time (ns) of their first motion or infinity."""
    names, effectors = _effectors(trial, arbiter), trial.executor.effectors
    applied = (each for name in names if name in effectors for each in effectors[name].applied)
    starts = (at for at, _, rates in applied if any(rates.values()))
    return " and ".join(names), min(starts, default=inf)


def _silence(history: History[Any], number: int, effector: str, at: int) -> Iterator[Fact]:
    """Yield for how long a lock or limit had been silent, unless it is a lock that was true."""
    is_true = history.link.kind == "lock" and history.at(at)
    if is_true or not history.silent(at):
        return
    heard, instant = bisect_right(history.times, at), milliseconds(at)
    if not heard:
        yield seen("had_not_spoken", number, effector, instant)
    else:
        silent = milliseconds(at - history.times[heard - 1])
        yield seen("silence", number, effector, instant, silent)


def _gates(trial: Trial) -> Iterator[Gate]:
    return (each for each in trial.executor.elements.values() if isinstance(each, Gate))


def _numbers(trial: Trial) -> Mapping[Link, int]:
    return {link: number for number, link in enumerate(trial.executor.links)}
