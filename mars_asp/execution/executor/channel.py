"""Links with faults: messages that are lost or late, drawn from the seed and the link's names."""

from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from random import Random

from mars_asp.execution.executor.link import Link, Message
from mars_asp.execution.executor.schedule import MICROSECOND


@dataclass(frozen=True, slots=True)
class LinkFault:
    """A fault of the link `source -> client` from `since` until `until`.

    `loss` is the probability that a message is lost; `delay` and the times are in ns, `jitter` is
    the maximal further delay in us.
    """

    source: str
    client: str
    loss: float
    delay: int
    jitter: int
    since: int
    until: float

    @property
    def ends(self) -> tuple[str, str]:
        """Return the two names of the link."""
        return self.source, self.client


class Draws:
    """The two random sequences of a link, one number of each for every message.

    Losses and delays are independent: another `jitter` loses the same messages.
    """

    def __init__(self, seed: int, source: str, client: str) -> None:
        self.loss, self.jitter = (
            Random(f"{seed}/links/{source} -> {client}/{part}").random
            for part in ("loss", "jitter")
        )


class Channel:
    """Loses and delays the messages of a link, in their order.

    `rank` is the rank of arrivals in the schedule; `cancel` ends the wait for a lost answer.
    """

    def __init__(
        self,
        link: Link,
        faults: Sequence[LinkFault],
        draws: Draws,
        rank: int,
        cancel: Callable[[], None],
    ) -> None:
        self.link, self.faults, self.draws = link, faults, draws
        self.rank, self.cancel = rank, cancel
        self.withdraw_now: Callable[[], None] = lambda: None
        self.sent = self.in_flight = self.due = 0
        #: The times (ns) of the last messages sent, and of the last ones lost.
        self.sendings: deque[int] = deque(maxlen=8)
        self.losses: deque[int] = deque(maxlen=8)
        #: The time (ns) of the first arrival.
        self.first: int | None = None
        link.channel, link.send = self, self.send

    def sent_before(self, time: Fraction) -> int:
        """Return the number of messages sent before a time (ns), which must be recent."""
        return self.sent - sum(at >= time for at in self.sendings)

    def lost_before(self, time: Fraction) -> int:
        """Return the number of messages lost before a time (ns), which must be recent."""
        return self.link.dropped["lost"] - sum(at >= time for at in self.losses)

    def send(self, message: Message) -> None:
        """Lose a message, deliver it at once, or let it arrive later."""
        now = self.link.schedule.now
        self.sent += 1
        self.sendings.append(now)
        self._carry(lambda: self._deliver(message, now))

    def delay_withdrawal(self) -> None:
        """Let withdrawals of the link's commands, which its receiver has set up, be delayed too."""
        self.withdraw_now, self.link.withdrawn = self.link.withdrawn, self.withdraw

    def withdraw(self) -> None:
        """Withdraw the last command; this is lost and late as messages are."""
        self._carry(self.withdraw_now)

    def _carry(self, action: Callable[[], None]) -> None:
        """Act when a message that is sent now arrives, unless it is lost."""
        now = self.link.schedule.now
        fault = next((each for each in self.faults if each.since <= now < each.until), None)
        chance, share = self.draws.loss(), self.draws.jitter()
        if fault is not None and chance < fault.loss:
            self.link.dropped["lost"] += 1
            self.losses.append(now)
            self.cancel()
            return
        late = 0 if fault is None else fault.delay + int(share * (fault.jitter + 1)) * MICROSECOND
        self.due = max(now + late, self.due)
        if self.due == now and not self.in_flight:
            action()
            return

        def arrive() -> None:
            self.in_flight -= 1
            action()

        self.in_flight += 1
        self.link.schedule.at(self.due, self.rank, arrive)

    def _deliver(self, message: Message, sent: int) -> None:
        now = self.link.schedule.now
        if self.first is None:
            self.first = now
        if message.until is not None and now > sent:
            # An arbiter's command is in force for as long as it would be without the delay.
            message = message._replace(until=message.until + now - sent)
        self.link.deliver(message)
