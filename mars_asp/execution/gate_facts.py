"""The facts about Gates and locks in a run that `rules/run/gates.lp` reads."""

from bisect import bisect_left, bisect_right
from collections.abc import Iterator, Mapping
from itertools import pairwise

from mars_asp.asp.solve.atoms import Atom, Fact, fact_at
from mars_asp.execution.executor.arbitration import FlatArbitration, HierarchicalArbitration
from mars_asp.execution.executor.bounds import History
from mars_asp.execution.executor.gate import Gate, Trigger
from mars_asp.execution.executor.link import Link
from mars_asp.execution.executor.schedule import MILLISECOND
from mars_asp.execution.observed import MOST, milliseconds, seen
from mars_asp.execution.trial import Trial


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
        out = plan.data_out[gate.name] or plan.control_out[gate.name]
        targets = dict.fromkeys(name for link in out for name in plan.targets_of(link))
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
    if not losses:
        for arbiter in trial.executor.arbiters.values():
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
        ends = (milliseconds(time) for time in (first_at, last_at))
        spoke = milliseconds(since), milliseconds(until)
        yield seen("kept_from", number, client, *spoke, len(dropped), *ends)


def _stops(
    trial: Trial,
    arbiter: FlatArbitration | HierarchicalArbitration,
    numbers: Mapping[Link, int],
) -> Iterator[Fact]:
    plan = trial.executor.plan
    links = plan.control_out[arbiter.name]
    stopped = " and ".join(dict.fromkeys(n for link in links for n in plan.targets_of(link)))
    for at, lock in arbiter.bounds.stops:
        number, instant = numbers[lock.link], milliseconds(at)
        yield seen("stopped_by", number, stopped, instant)
        if not lock.at(at):
            silent = at - lock.times[bisect_right(lock.times, at) - 1]
            yield seen("silence", number, stopped, instant, milliseconds(silent))


def _gates(trial: Trial) -> Iterator[Gate]:
    return (each for each in trial.executor.elements.values() if isinstance(each, Gate))


def _numbers(trial: Trial) -> Mapping[Link, int]:
    return {link: number for number, link in enumerate(trial.executor.links)}
