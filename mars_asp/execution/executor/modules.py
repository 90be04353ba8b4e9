"""Running modules: sensors, algorithms and effectors, with their triggers and results."""

from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import Any

from mars_asp.behaviour.command import command_of
from mars_asp.behaviour.values import copied
from mars_asp.execution.executor.behaviour import Behaviour
from mars_asp.execution.executor.delivery import Offer
from mars_asp.execution.executor.link import Failures, Link, Message, fail, message_of
from mars_asp.execution.executor.schedule import MILLISECOND, SECOND, SENSORS, Schedule

COMMAND_TIMEOUT = 500 * MILLISECOND


class Sensor:
    """Samples its device at a rate, or on request if it has no rate."""

    def __init__(self, name: str, behaviour: Behaviour, hz: Fraction | None, schedule: Schedule):
        self.name, self.schedule = name, schedule
        self.call, self.delay = behaviour.call, behaviour.delay
        self.offers: list[Offer] = []
        self.outputs: list[Link] = []
        self.failures = Failures(place=behaviour.place)
        if hz is None and behaviour.period is not None:
            hz = Fraction(SECOND, behaviour.period)
        self.clocked = hz is not None
        self.runs = 0
        if hz is not None:
            schedule.every(hz, SENSORS, self.sample)

    def sample(self) -> None:
        """Read the device and offer its reading to every output."""
        self.runs += 1
        try:
            reading = copied(self.call())
        except Exception as error:  # a device's fault must not end the run
            fail(self.failures, self.outputs, error, self.schedule.now)
            return
        if reading is None:
            return
        made = self.schedule.now
        message = message_of((reading, made, self.name, None, None))
        if self.delay:
            due = made + self.delay
            self.schedule.at(due, SENSORS, lambda: offer_all(self.offers, message))
        else:
            for offer in self.offers:
                offer(message)


class Algorithm:
    """Runs a behaviour with the latest message of each input, once all inputs have arrived.

    Inputs that arrive in one instant cause one computation. A pulled data input is requested when
    the module runs, and the run waits for the answer. With `commands` the results are commands,
    with `triggered` inputs cause runs, and with `pulls` some inputs are pulled. `rank` is the rank
    of the computations in the schedule.
    """

    def __init__(
        self,
        name: str,
        behaviour: Behaviour,
        schedule: Schedule,
        *,
        commands: bool,
        triggered: bool,
        pulls: bool,
        rank: int,
    ) -> None:
        self.name, self.schedule = name, schedule
        self.call, self.delay = behaviour.call, behaviour.delay
        self.commands, self.triggered = commands, triggered
        self.rank, self.queue = rank, schedule.queue(rank)
        self.offers: list[Offer] = []
        self.outputs: list[Link] = []
        self.failures = Failures(place=behaviour.place)
        self.run = self.ask if pulls else self.compute
        self.latest: list[Any] = []
        self.unheard: set[int] = set()
        #: Inputs whose latest message is not yet used by a computation.
        self.unread: set[int] = set()
        self.pulled: list[tuple[int, Link]] = []
        self.missing: set[int] = set()
        self.waiting = False
        #: Whether a computation is queued in this instant.
        self.queued = False
        self.runs = 0

    def input(self, link: Link, pulled: bool) -> Callable[[Message], None]:
        """Return the receiver of a link's messages; those of a `pulled` link are requested."""
        index, latest, unheard = link.slot, self.latest, self.unheard
        while len(latest) <= index:
            unheard.add(len(latest))
            latest.append(None)
        if pulled:
            self.pulled.append((index, link))
            return lambda message: self.keep_pulled(index, message)
        queue, run, unread, dropped = self.queue, self.run, self.unread, link.dropped

        def keep(message: Message) -> None:
            if index in unread:
                dropped["unread"] += 1
            unread.add(index)
            latest[index] = message[0]
            if unheard:
                unheard.discard(index)

        def trigger(message: Message) -> None:
            keep(message)
            if not self.queued:
                self.queued = True
                queue(run)

        return trigger if self.triggered else keep

    def keep_pulled(self, index: int, message: Message) -> None:
        """Store a pulled message of input `index`; run if all requested ones have arrived."""
        self.latest[index] = message.value
        self.unheard.discard(index)
        self.missing.discard(index)
        if self.waiting and not self.missing:
            self.waiting = False
            self.queue(self.compute)

    def ask(self) -> None:
        """Request a message for each input fed on request; the last answer starts the run."""
        self.queued = False
        if self.waiting:
            return
        self.missing = {index for index, _ in self.pulled}
        self.waiting = True
        for _, link in self.pulled:
            if link.request is not None:
                link.request()

    def compute(self) -> None:
        """Call the behaviour and offer its result, unless that is None."""
        self.queued = False
        if self.unheard:
            return
        self.runs += 1
        self.unread.clear()
        try:
            result = self.call(*map(copied, self.latest))
            if result is not None and self.commands:
                command = command_of(result)
                result = {command.function: command.rate}
            else:
                result = copied(result)
        except Exception as error:  # a module's fault must not end the run
            fail(self.failures, self.outputs, error, self.schedule.now, self.latest)
            return
        if result is None:
            return
        made = self.schedule.now
        message = message_of((result, made, self.name, None, None))
        if self.delay:
            due = made + self.delay
            self.schedule.at(due, self.rank, lambda: offer_all(self.offers, message))
        else:
            for offer in self.offers:
                offer(message)


class Effector:
    """Obeys the latest command while its arbiter holds it in force, then rests.

    Without an arbiter, it rests when no command came for `timeout` ns. It ignores the functions in
    `left`, which an InheritanceNode with the same commands carries out.
    """

    def __init__(
        self,
        name: str,
        behaviour: Behaviour,
        timeout: int,
        schedule: Schedule,
        left: frozenset[str] = frozenset(),
    ) -> None:
        self.name, self.behaviour, self.schedule, self.left = name, behaviour, schedule, left
        self.timeout, self.queue = timeout, schedule.queue(schedule.effectors)
        self.message: Message | None = None
        self.awaited: Link | None = None
        self.failures = Failures(place=behaviour.place)
        self.applied: list[tuple[int, str, dict[str, float]]] = []
        self.ways: dict[str, float] = {}
        self.rates: dict[str, float] = {}
        self.since = 0
        #: The number of received commands.
        self.runs = 0

    def position(self) -> Mapping[str, float]:
        """Return the values of the motions in degrees and mm, measured or else computed."""
        if self.behaviour.position is not None:
            return self.behaviour.position()
        seconds = (self.schedule.now - self.since) / SECOND
        for function, rate in self.rates.items():
            self.ways[function] = self.ways.get(function, 0.0) + rate * seconds
        self.since = self.schedule.now
        return self.ways

    def input(self, link: Link) -> Callable[[Message], None]:
        """Return the receiver of the commands of one link."""
        return lambda message: self.receive(link, message)

    def receive(self, link: Link, message: Message) -> None:
        """Receive a command; it is applied after all other events of the instant."""
        self.runs += 1
        if self.left:
            taken = {f: rate for f, rate in message.value.items() if f not in self.left}
            message = message._replace(value=taken)
        if self.awaited is not None:
            self.awaited.dropped["overtaken"] += 1
        self.message, self.awaited = message, link
        self.queue(lambda: self.apply(message, link))
        if message.value:
            due = self.schedule.now + self.timeout if message.until is None else message.until
            self.schedule.at(due, self.schedule.effectors, lambda: self.expire(message))

    def apply(self, message: Message, link: Link | None) -> None:
        """Carry out a command, unless a later one of the same instant replaced it."""
        if message is not self.message:
            return
        self.awaited = None
        self.position()
        self.rates = message.value
        try:
            self.behaviour.call(message.value.copy())
        except Exception as error:  # a device's fault must not end the run
            links, given = [link] if link else [], [message.value]
            fail(self.failures, links, error, self.schedule.now, given)
        if not self.applied or self.applied[-1][1:] != (message.origin, message.value):
            self.applied.append((self.schedule.now, message.origin, message.value))

    def expire(self, message: Message) -> None:
        """Rest, unless a command came after `message`."""
        if message is self.message:
            self.message = Message({}, self.schedule.now, "")
            self.apply(self.message, None)


def offer_all(offers: list[Offer], message: Message) -> None:
    """Offer a message to every output."""
    for offer in offers:
        offer(message)
