"""ArbitrationNodes: flat averages, hierarchical priorities with holds."""

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from mars_asp.execution.executor.bounds import Bounds, History
from mars_asp.execution.executor.link import Link, Message, Observer
from mars_asp.execution.executor.schedule import SECOND, Schedule
from mars_asp.output import listing

#: The origin of a stop, which no module commanded.
NOBODY = ""


@dataclass(frozen=True, slots=True)
class Holding:
    """The holder of control at a node from `since` (ns) on: a module or `NOBODY`, with the reason.

    `through` is the controller of the node that forwarded the holder's message.
    """

    node: str
    holder: str
    since: int
    why: str
    through: str = NOBODY


class FlatArbitration:
    """Sends, at the end of each period, the mean of its commands for each function.

    With `weighted`, the latest command of each controller counts, with the controller's priority as
    its weight. A mean is in force for `timeout` ns at an effector.
    """

    def __init__(
        self,
        name: str,
        period: int,
        schedule: Schedule,
        rank: int,
        outputs: Sequence[Link],
        *,
        weighted: bool = False,
        timeout: int = 0,
    ) -> None:
        self.name, self.period, self.schedule, self.rank = name, period, schedule, rank
        self.outputs, self.weighted, self.timeout = outputs, weighted, timeout
        self.arrived: list[tuple[int, Link, Message]] = []
        self.ends = 0
        self.holdings: list[Holding] = []
        self.bounds = Bounds(schedule, rank, self.reconsider, ranks=False)
        #: The last mean, before limits and after them, until it is not in force.
        self.mean: Message | None = None
        self.sent: dict[str, float] = {}
        self.was_locked: bool | None = None
        schedule.at(period, rank, self.end_period)

    def input(self, link: Link) -> Callable[[Message], None]:
        """Return the function that receives the commands of one controller."""
        arrived, schedule = self.arrived, self.schedule
        return lambda message: arrived.append((schedule.now, link, message))

    def end_period(self) -> None:
        """Send the mean of the messages of the period, if there were any."""
        self.ends += 1
        self.schedule.at((self.ends + 1) * self.period, self.rank, self.end_period)
        if not self.arrived:
            return
        locked, now = self.bounds.is_locked, self.schedule.now
        taken = [(link, message) for at, link, message in self.arrived if not locked(at)]
        for at, link, _ in self.arrived:
            self.bounds.refuse(link, at)
        # Cleared in place, because the receivers append to it.
        self.arrived.clear()
        if self.weighted:
            latest = {link: message for link, message in taken if link.declared != 0}
            taken = list(latest.items())
        if not taken or locked(now):
            return
        origins = sorted({message.origin for _, message in taken})
        declared = (link.declared if self.weighted else None for link, _ in taken)
        weights = (1 if priority is None else priority for priority in declared)
        values = (message.value for _, message in taken)
        mean = weighted_mean(list(zip(weights, values, strict=True)))
        self.mean = Message(mean, now, "+".join(origins))
        self._send(self.mean)

    def _send(self, message: Message) -> None:
        self.sent = self.bounds.scaled(message.value, sent=True)
        for link in self.outputs:
            link.send(message._replace(value=self.sent))

    def reconsider(self) -> None:
        """Send one stop when a lock closes; send the mean in force again if a limit changes it."""
        now = self.schedule.now
        before = self.bounds.is_locked(-1) if self.was_locked is None else self.was_locked
        self.was_locked = self.bounds.is_locked(now)
        if self.was_locked:
            if not before:
                self.mean = None
                self.bounds.stop()
                # One stop, which also ends the commands in force at later arbiters.
                for link in self.outputs:
                    link.send(Message({}, now, NOBODY, until=now))
                    link.withdrawn()
            return
        mean = self.mean
        if mean is None or now >= mean.time + self.timeout:
            return
        if self.bounds.scaled(mean.value) != self.sent:
            self._send(mean._replace(until=mean.time + self.timeout))


def weighted_mean(commands: Sequence[tuple[int, dict[str, float]]]) -> dict[str, float]:
    """Return the weighted mean rate of each function over the commands with this function."""
    named: dict[str, list[tuple[int, float]]] = {}
    for weight, command in commands:
        for function, rate in command.items():
            named.setdefault(function, []).append((weight, rate))
    return {
        function: sum(weight * rate for weight, rate in rates) / sum(weight for weight, _ in rates)
        for function, rates in sorted(named.items())
    }


@dataclass(slots=True)
class _Input:
    link: Link
    hold: int
    priority: int
    message: Message | None = None
    until: int = -1
    arrival: int = -1
    in_force: list[tuple[int, int]] = field(default_factory=list)

    @property
    def name(self) -> str:
        """The module whose command came last, through any nodes."""
        return self.message.origin if self.message else self.link.source


class HierarchicalArbitration:
    """Forwards the command with the highest priority in force, until its hold ends.

    With `stops`, a stop is sent when no message is in force; an arbiter that feeds only other
    arbiters leaves this to them. `suppressed` counts, by origin, the messages that were not
    forwarded because of a higher priority.
    """

    def __init__(
        self,
        name: str,
        schedule: Schedule,
        rank: int,
        outputs: Sequence[Link],
        *,
        stops: bool,
        equal: bool = False,
        observe: Observer | None = None,
    ) -> None:
        self.name, self.schedule, self.rank = name, schedule, rank
        self.outputs, self.stops, self.observe = outputs, stops, observe
        self.equal = equal
        self.bounds = Bounds(schedule, rank, self.reconsider, ranks=not equal)
        #: The last command as it was forwarded, and the end of its validity.
        self.sent: dict[str, float] = {}
        self.until = 0
        self.inputs: list[_Input] = []
        self.winner: _Input | None = None
        self.holdings: list[Holding] = []
        self.suppressed: Counter[str] = Counter()

    def input(self, link: Link, hold: int) -> Callable[[Message], None]:
        """Return the function that receives one controller's commands, held for `hold` ns."""
        source = _Input(link, hold, 0 if self.equal else link.priority)
        self.inputs.append(source)
        link.withdrawn = lambda: self.withdraw(source)
        return lambda message: self.receive(source, message)

    @property
    def in_force(self) -> tuple[tuple[Link, Sequence[tuple[int, int]]], ...]:
        """Return each input with begin and end (ns) of the periods in which it was in force."""
        return tuple((source.link, source.in_force) for source in self.inputs)

    def receive(self, source: _Input, message: Message) -> None:
        """Store a message of an input; forward it at once if it has the highest priority."""
        now = self.schedule.now
        until = now + source.hold if message.until is None else message.until
        if until <= now:
            return
        source.message, source.until = message, until
        # Arrival numbers are common to all arbiters, so they order messages through cascades.
        arrival = self.schedule.next_arrival() if message.arrival is None else message.arrival
        source.arrival = arrival
        since = now
        if source.in_force and now <= source.in_force[-1][1]:
            # A later message replaces the one before.
            since, _ = source.in_force.pop()
        source.in_force.append((since, until))
        self.schedule.at(until, self.rank, lambda: self.expire(source))
        best = self.best()
        if best is source:
            self.forward(source)
            return
        self.suppressed[message.origin] += 1
        self.bounds.refuse(source.link, now, source.priority)
        if best is None and self.winner is None:
            self._hold(NOBODY, self._rest_text)
        if best is not None and source is self.winner and self._may_pass(source):
            # The arbiter that feeds this input fell back to an older message.
            self.forward(best, f"{source.name} fell back to an older message; ")

    def best(self) -> _Input | None:
        """Return the input in force with the highest priority (the latest of equals), or None.

        Inputs that a lock passes over are left out.
        """
        now = self.schedule.now
        alive = [source for source in self.inputs if source.until > now and self._may_pass(source)]
        return max(alive, key=lambda s: (s.priority, s.arrival), default=None)

    def _may_pass(self, source: _Input) -> bool:
        return not self.bounds.is_locked(self.schedule.now, source.priority)

    def forward(self, source: _Input, before: str = "") -> None:
        """Forward an input's message, with the end of its validity.

        `before` is the reason why the input won, if that was not a message of its own.
        """
        message = source.message
        if message is None:
            return
        self.winner = source
        self._hold(message.origin, lambda: before + self._rank_text(source), source.link.source)
        self.sent, self.until = self.bounds.scaled(message.value, sent=True), source.until
        sent = message._replace(value=self.sent, until=source.until, arrival=source.arrival)
        for link in self.outputs:
            link.send(sent)

    def expire(self, source: _Input) -> None:
        """If the winner's hold has run out, resume the next input, or else send one stop."""
        if source is not self.winner or source.until > self.schedule.now:
            return
        following = self.best()
        early = self.until > self.schedule.now
        if following is not None:
            of = "command" if early else "hold"
            end = "was withdrawn" if early else "ran out"
            self.forward(following, f"the {of} of {source.name} {end}; ")
            return
        self._rest(early=early)

    def _rest(self, *, early: bool) -> None:
        """Send one stop; if it is `early`, withdraw the command from later arbiters as well."""
        self.winner = None
        self._hold(NOBODY, self._rest_text)
        if self.stops:
            now = self.schedule.now
            for link in self.outputs:
                link.send(Message({}, now, NOBODY, until=now))
        if early:
            for link in self.outputs:
                link.withdrawn()

    def withdraw(self, source: _Input) -> None:
        """Take the message of an input as run out now."""
        now = self.schedule.now
        if source.until > now:
            source.until = now
            source.in_force[-1] = source.in_force[-1][0], now
            self.schedule.at(now, self.rank, lambda: self.expire(source))

    def reconsider(self) -> None:
        """Obey the locks and limits of this instant."""
        best, winner, now = self.best(), self.winner, self.schedule.now
        if best is None:
            if winner is not None and winner.until > now:
                self.bounds.stop(winner.priority)
                self._rest(early=True)
        elif best is not winner:
            before = ""
            if winner is not None and winner.until > now and not self._may_pass(winner):
                before = f"{self._lock_text(next(self.bounds.locking(now, winner.priority)))}; "
            self.forward(best, before)
        elif best.message is not None and self.bounds.scaled(best.message.value) != self.sent:
            self.forward(best)

    def _rest_text(self) -> str:
        """Return the reason why no command is forwarded: a lock, or that none is in force."""
        now = self.schedule.now
        highest = max((each.priority for each in self.inputs if each.until > now), default=None)
        if highest is None:
            return "nothing is in force"
        return self._lock_text(next(self.bounds.locking(now, highest)))

    def _lock_text(self, lock: History[bool]) -> str:
        """Return the reason for which a lock is closed."""
        now = self.schedule.now
        name, level, hold = lock.link.source, lock.link.declared, lock.link.hold
        below = "" if level is None or self.equal else f", which locks below {level},"
        if lock.at(now):
            return f"{name}{below} is true"
        silence = (
            f"had been silent for {(hold or 0) / SECOND:g} s" if lock.times else "had not spoken"
        )
        return f"{name}{below} {silence}"

    def _rank_text(self, winner: _Input) -> str:
        """Return the reason why an input wins over the others in force."""
        now, own = self.schedule.now, winner.priority
        others = [i for i in self.inputs if i is not winner and i.until > now]
        # A suppressor takes the place of another controller, also of one that it outranks itself.
        lower = [
            f"{i.name if i.name != winner.name else f'its line through {i.link.source}'} "
            f"({i.link.priority})"
            for i in others
            if i.priority < own
        ]
        equal = [i.name for i in others if i.priority == own]
        lines = [f"priority {own} outranks {listing(lower)}"] if lower else []
        same = "" if self.equal else f" of the same priority {own}"
        lines += [f"later than {listing(equal)}{same}"] if equal else []
        return ", ".join(lines) or "alone in force"

    def _hold(self, holder: str, why: Callable[[], str], through: str = NOBODY) -> None:
        last = self.holdings[-1] if self.holdings else None
        if last is not None and (last.holder, last.through) == (holder, through):
            if holder or last.why == why():
                return
        now, reason = self.schedule.now, why()
        self.holdings.append(Holding(self.name, holder, now, reason, through))
        if self.observe is not None:
            self.observe(now, "holds", self.name, [holder, reason])
