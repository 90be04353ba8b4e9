"""Gates: the messages of triggers close a line for a time, and those of suppressors pass."""

from collections.abc import Callable
from dataclasses import dataclass, field

from mars_asp.execution.executor.bounds import is_true
from mars_asp.execution.executor.delivery import Offer
from mars_asp.execution.executor.link import Link, Message, Observer
from mars_asp.execution.executor.schedule import Schedule


@dataclass(slots=True)
class Trigger:
    """A trigger of a Gate, which keeps the line closed in [since, until) (ns).

    `boolean` is whether its messages are truths, or None if unknown; a false one ends the closing.
    A `late` trigger closes from the next instant on. A trigger is `in_circle` if messages that pass
    the Gate can reach it: the messages of the line do not wait for it. It `returns` them if only
    nodes are between. `heard` are the times of its messages, with whether they close and when they
    were made; `passed` is the number of those that passed.
    """

    link: Link
    boolean: bool | None
    late: bool
    in_circle: bool
    returns: bool
    since: int = 0
    until: int = 0
    waiting: list[Message] = field(default_factory=list)
    heard: list[tuple[int, bool, int]] = field(default_factory=list)
    passed: int = 0

    def hear(self, message: Message, now: int) -> None:
        """Close the line for the time of the trigger, or end that by a false truth."""
        boolean = self.boolean
        if boolean is None:
            # numpy's is `bool_` or `bool`.
            boolean = type(message.value).__name__ in ("bool", "bool_")
        closes = self.link.kind == "suppress" or not boolean or is_true(message.value)
        self.heard.append((now, closes, message.time))
        if not closes:
            self.until = now
            return
        if self.until <= now:
            self.since = now + self.late
        self.until = now + self.link.time


class Gate:
    """Passes the messages of one line while no trigger keeps it closed, and those of suppressors.

    Messages wait until no other message of the instant can reach a trigger, which is so at `rank`.
    `verdicts` are the times of the line's messages, each with the trigger that kept the
    line closed, or None, and whether the message passed.
    """

    def __init__(
        self, name: str, schedule: Schedule, rank: int, observe: Observer | None = None
    ) -> None:
        self.name, self.schedule, self.observe = name, schedule, observe
        self.queue = schedule.queue(rank)
        self.outputs: list[Link] = []
        self.offers: list[Offer] = []
        self.triggers: list[Trigger] = []
        self.verdicts: list[tuple[int, Trigger | None, bool]] = []
        #: The number of messages that passed.
        self.departed = 0
        #: The line's messages of this instant, each with the trigger in circle that closes it.
        self.waiting: list[tuple[Link, Message, Trigger | None]] = []
        self.queued = False
        #: The link by which the last message that passed came, if it is not withdrawn.
        self.last: Link | None = None
        #: The time of the first message that passed.
        self.first: int | None = None
        self.inhibited = False
        #: The messages that passed in the instant `now`, by origin and time.
        self.passed: set[tuple[str, int]] = set()
        self.now = -1

    def input(self, link: Link) -> Callable[[Message], None]:
        """Return the receiver of the line's messages."""
        link.withdrawn = lambda: self.withdraw(link)
        return lambda message: self.receive(link, message)

    def receive(self, link: Link, message: Message) -> None:
        """Take a message of the line, which waits for the triggers of the instant."""
        self.waiting.append((link, message, self.closer(in_circle=True)))
        self._wait()

    def trigger(self, trigger: Trigger) -> Callable[[Message], None]:
        """Return the receiver of the messages of a trigger."""
        self.triggers.append(trigger)
        trigger.link.withdrawn = lambda: self.withdraw(trigger.link)
        return lambda message: self.close(trigger, message)

    def close(self, trigger: Trigger, message: Message) -> None:
        """Close the line from now on; the message of a suppressor passes."""
        now, link = self.schedule.now, trigger.link
        passed = self.passed if self.now == now and link.kind == "suppress" else ()
        if trigger.returns and (message.origin, message.time) in passed:
            # It would go round without end.
            link.dropped["suppressed"] += 1
            return
        before = trigger.until
        trigger.hear(message, now)
        if self.observe is not None and (trigger.until > now or before > now):
            event = "closed" if trigger.until > now else "opened"
            self.observe(now, "gate", self.name, [event, link.source, trigger.until])
        if link.kind == "suppress":
            trigger.waiting.append(message)
        elif trigger.until > now:
            self.inhibited = True
        self._wait()

    def _wait(self) -> None:
        if all(trigger.in_circle for trigger in self.triggers):
            self.settle()
        elif not self.queued:
            self.queued = True
            self.queue(self.settle)

    def closer(self, *, in_circle: bool) -> Trigger | None:
        """Return the first trigger, in circle or not, that keeps the line closed now, or None."""
        now = self.schedule.now
        return next(
            (
                each
                for each in self.triggers
                if each.in_circle is in_circle and each.since <= now < each.until
            ),
            None,
        )

    def settle(self) -> None:
        """Pass the messages of suppressors, then those of the line if it is open."""
        self.queued = False
        for trigger in self.triggers:
            messages, trigger.waiting = trigger.waiting, []
            for message in messages:
                departed = self.departed
                self._pass(trigger.link, message)
                trigger.passed += self.departed > departed
        if self.inhibited:
            self.inhibited = False
            if self.last is not None and self.last.kind == "control":
                self.withdraw(self.last)
        taken, self.waiting = self.waiting, []
        for link, message, closed in taken:
            closer, departed = closed or self.closer(in_circle=False), self.departed
            if closer is None:
                self._pass(link, message)
            else:
                link.dropped["suppressed" if closer.link.kind == "suppress" else "inhibited"] += 1
            self.verdicts.append((self.schedule.now, closer, self.departed > departed))

    def _pass(self, link: Link, message: Message) -> None:
        if self.now != self.schedule.now:
            self.now = self.schedule.now
            self.passed.clear()
        self.first = self.now if self.first is None else self.first
        self.passed.add((message.origin, message.time))
        self.last = link
        self.departed += 1
        for offer in self.offers:
            offer(message)

    def withdraw(self, link: Link) -> None:
        """Withdraw the command that passed last, if it came by `link`."""
        if link is self.last:
            self.last = None
            for output in self.outputs:
                output.withdrawn()
