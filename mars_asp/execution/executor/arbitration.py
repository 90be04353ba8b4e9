"""ArbitrationNodes: flat averages, hierarchical priorities with holds."""

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from mars_asp.execution.executor.link import Link, Message, Observer
from mars_asp.execution.executor.schedule import Schedule
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
    """Sends, at the end of each period, the mean of its commands for each function."""

    def __init__(
        self, name: str, period: int, schedule: Schedule, rank: int, outputs: Sequence[Link]
    ) -> None:
        self.name, self.period, self.schedule, self.rank = name, period, schedule, rank
        self.outputs = outputs
        self.arrived: list[Message] = []
        self.ends = 0
        self.holdings: list[Holding] = []
        schedule.at(period, rank, self.end_period)

    def input(self, link: Link) -> Callable[[Message], None]:
        """Return the function that receives the commands of one controller."""
        return self.arrived.append

    def end_period(self) -> None:
        """Send the mean of the messages of the period, if there were any."""
        self.ends += 1
        self.schedule.at((self.ends + 1) * self.period, self.rank, self.end_period)
        if not self.arrived:
            return
        origins = sorted({message.origin for message in self.arrived})
        mean = mean_command([message.value for message in self.arrived])
        # Cleared in place, because the receivers are the list's `append`.
        self.arrived.clear()
        now = self.schedule.now
        for link in self.outputs:
            link.send(Message(mean, now, "+".join(origins)))


def mean_command(commands: Sequence[dict[str, float]]) -> dict[str, float]:
    """Return the mean rate of each function over the commands with this function."""
    named: dict[str, list[float]] = {}
    for command in commands:
        for function, rate in command.items():
            named.setdefault(function, []).append(rate)
    return {function: sum(rates) / len(rates) for function, rates in sorted(named.items())}


@dataclass(slots=True)
class _Input:
    link: Link
    hold: int
    message: Message | None = None
    until: int = -1
    arrival: int = -1
    in_force: list[tuple[int, int]] = field(default_factory=list)


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
        observe: Observer | None = None,
    ) -> None:
        self.name, self.schedule, self.rank = name, schedule, rank
        self.outputs, self.stops, self.observe = outputs, stops, observe
        self.inputs: list[_Input] = []
        self.winner: _Input | None = None
        self.holdings: list[Holding] = []
        self.suppressed: Counter[str] = Counter()

    def input(self, link: Link, hold: int) -> Callable[[Message], None]:
        """Return the function that receives one controller's commands, held for `hold` ns."""
        source = _Input(link, hold)
        self.inputs.append(source)
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
        if best is not None and source is self.winner:
            # The arbiter that feeds this input fell back to an older message.
            self.forward(best, f"{source.link.source} fell back to an older message; ")

    def best(self) -> _Input | None:
        """Return the input in force with the highest priority (the latest of equals), or None."""
        now = self.schedule.now
        alive = [source for source in self.inputs if source.until > now]
        return max(alive, key=lambda s: (s.link.priority, s.arrival), default=None)

    def forward(self, source: _Input, before: str = "") -> None:
        """Forward an input's message, with the end of its validity.

        `before` is the reason why the input won, if that was not a message of its own.
        """
        message = source.message
        if message is None:
            return
        self.winner = source
        self._hold(message.origin, lambda: before + self._rank_text(source), source.link.source)
        sent = message._replace(until=source.until, arrival=source.arrival)
        for link in self.outputs:
            link.send(sent)

    def expire(self, source: _Input) -> None:
        """If the winner's hold has run out, resume the next input, or else send one stop."""
        if source is not self.winner or source.until > self.schedule.now:
            return
        following = self.best()
        if following is not None:
            self.forward(following, f"the hold of {source.link.source} ran out; ")
            return
        self.winner = None
        self._hold(NOBODY, lambda: "nothing is in force")
        if self.stops:
            now = self.schedule.now
            for link in self.outputs:
                link.send(Message({}, now, NOBODY, until=now))

    def _rank_text(self, winner: _Input) -> str:
        """Return the reason why an input wins over the others in force."""
        now, own = self.schedule.now, winner.link.priority
        others = [i for i in self.inputs if i is not winner and i.until > now]
        lower = [f"{i.link.source} ({i.link.priority})" for i in others if i.link.priority < own]
        equal = [i.link.source for i in others if i.link.priority == own]
        lines = [f"priority {own} outranks {listing(lower)}"] if lower else []
        lines += [f"later than {listing(equal)} of the same priority {own}"] if equal else []
        return ", ".join(lines) or "alone in force"

    def _hold(self, holder: str, why: Callable[[], str], through: str = NOBODY) -> None:
        last = self.holdings[-1] if self.holdings else None
        if last is not None and (last.holder, last.through) == (holder, through):
            return
        now, reason = self.schedule.now, why()
        self.holdings.append(Holding(self.name, holder, now, reason, through))
        if self.observe is not None:
            self.observe(now, "holds", self.name, [holder, reason])
