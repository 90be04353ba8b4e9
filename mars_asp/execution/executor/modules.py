"""Running modules: sensors, algorithms and effectors, with their triggers and results."""

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from typing import Any

from mars_asp.behaviour.command import commanded
from mars_asp.behaviour.values import copied
from mars_asp.execution.executor.behaviour import Behaviour
from mars_asp.execution.executor.delivery import Offer
from mars_asp.execution.executor.link import Failures, Link, Message, fail, message_of
from mars_asp.execution.executor.schedule import DATA, MILLISECOND, SECOND, SENSORS, Schedule

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
        self.completion: Completion | None = None
        self.epoch = 0
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
        finish(self, reading, SENSORS)

    def forget(self) -> None:
        """Drop delayed results."""
        self.epoch += 1


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
        #: Whether its commands limit others, so that it may name no function.
        self.bounds_others = False
        #: Whether a computation is queued in this instant.
        self.queued = False
        self.runs = 0
        #: The functions of its annotation.
        self.functions: Sequence[str] = ()
        self.completion: Completion | None = None
        #: The number of resets.
        self.epoch = 0
        #: How far apart (ns) its inputs may be sent; the delays of results, by origin.
        self.window: int | None = None
        self.delays: Mapping[str, int] = {}
        #: With resets or a window: the link, arrival and sending (ns) of each unread message.
        self.held: dict[int, tuple[Link, int, int]] | None = None

    def input(self, link: Link, pulled: bool) -> Callable[[Message], None]:
        """Return the receiver of a link's messages; those of a `pulled` link are requested."""
        index, latest, unheard = link.slot, self.latest, self.unheard
        while len(latest) <= index:
            unheard.add(len(latest))
            latest.append(None)
        if pulled:
            self.pulled.append((index, link))
            return lambda message: self.keep_pulled(index, link, message)
        queue, run, unread, dropped = self.queue, self.run, self.unread, link.dropped

        def keep(message: Message) -> None:
            if index in unread:
                dropped["unread" if self.window is None else "unmatched"] += 1
            unread.add(index)
            if self.held is not None:
                self.hold(self.held, link, message)
            latest[index] = message[0]
            if unheard:
                unheard.discard(index)

        def trigger(message: Message) -> None:
            keep(message)
            if not self.queued:
                self.queued = True
                queue(run)

        return trigger if self.triggered else keep

    def hold(self, held: dict[int, tuple[Link, int, int]], link: Link, message: Message) -> None:
        """Add a message to those that no computation used."""
        sent = message.time + self.delays.get(message.origin, 0)
        held[link.slot] = link, self.schedule.now, sent

    def keep_pulled(self, index: int, link: Link, message: Message) -> None:
        """Store a pulled message of input `index`; run if all requested ones have arrived."""
        if self.held is not None:
            if index in self.held and self.window is not None:
                link.dropped["unmatched"] += 1
            self.hold(self.held, link, message)
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
        if self.unheard or (self.window is not None and not self.fits(self.window)):
            return
        self.runs += 1
        self.unread.clear()
        if self.held is not None:
            self.held.clear()
        try:
            result = self.call(*map(copied, self.latest))
            if result == {} and self.bounds_others:
                result = {}  # no bounds
            elif result is not None and self.commands:
                result = commanded(result, self.functions)
            else:
                result = copied(result)
        except Exception as error:  # a module's fault must not end the run
            fail(self.failures, self.outputs, error, self.schedule.now, self.latest)
            return
        finish(self, result, self.rank)

    def fits(self, window: int) -> bool:
        """Whether all inputs have a message, and all were sent within the window (ns)."""
        sent = [at for _, _, at in (self.held or {}).values()]
        return len(sent) == len(self.latest) and max(sent) - min(sent) <= window

    def finish(self) -> None:
        """Count the messages for which a window never had others."""
        if self.window is not None:
            for link, _, _ in (self.held or {}).values():
                link.dropped["unmatched"] += 1

    def forget(self) -> None:
        """Drop the inputs of earlier instants that no computation used, and delayed results."""
        self.epoch += 1
        for index, (link, arrival, _) in tuple((self.held or {}).items()):
            if self.held and arrival < self.schedule.now:
                del self.held[index]
                self.unread.discard(index)
                self.unheard.add(index)
                self.latest[index] = None
                link.dropped["reset"] += 1


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
        #: The link of the last command that is not a stop, and its end (ns).
        self.through: Link | None = None
        self.due = 0
        self.failures = Failures(place=behaviour.place)
        self.applied: list[tuple[int, str, dict[str, float]]] = []
        self.ways: dict[str, float] = {}
        self.rates: dict[str, float] = {}
        self.since = 0
        #: The number of received commands.
        self.runs = 0
        self.completion: Completion | None = None

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
        link.withdrawn = lambda: self.withdraw(link)
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
            self.due, self.through = due, link
            self.schedule.at(due, self.schedule.effectors, lambda: self.expire(message))

    def withdraw(self, link: Link) -> None:
        """Deliver a stop of a link if its last command is in force."""
        now = self.schedule.now
        if self.message is not None and self.message.value and self.through is link:
            if self.due > now:
                # The link has delayed the withdrawal already.
                link.deliver(Message({}, now, "", until=now))

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
        if self.completion is not None:
            self.completion.ask()

    def expire(self, message: Message) -> None:
        """Rest, unless a command came after `message`."""
        if message is self.message:
            self.message = Message({}, self.schedule.now, "")
            self.apply(self.message, None)


def finish(module: Sensor | Algorithm, result: Any, rank: int) -> None:
    """Offer the result of a computation, unless it is None; then ask for completion."""
    if result is None and module.completion is None:
        return
    made, epoch = module.schedule.now, module.epoch
    message = message_of((result, made, module.name, None, None))
    if module.delay:
        module.schedule.at(made + module.delay, rank, lambda: offer_all(module, message, epoch))
    else:
        offer_all(module, message, epoch)


def offer_all(module: Sensor | Algorithm, message: Message, epoch: int) -> None:
    """Offer a message to every output, unless a reset after `epoch` dropped it."""
    if module.epoch != epoch:
        for link in module.outputs if message.value is not None else ():
            link.dropped["reset"] += 1
        return
    if message.value is not None:
        for offer in module.offers:
            offer(message)
    if module.completion is not None:
        module.completion.ask()


class Completion:
    """The outputs `@Done` of a module, which may send after its computations and resets."""

    def __init__(self, name: str, behaviour: Behaviour, schedule: Schedule) -> None:
        self.name, self.call, self.schedule = name, behaviour.call, schedule
        self.offers: list[Offer] = []
        self.outputs: list[Link] = []
        self.failures = Failures(place=behaviour.place)
        #: A further completion of the same module.
        self.following: Completion | None = None

    def ask(self) -> None:
        """Call the function, and offer its result unless that is None."""
        now = self.schedule.now
        try:
            result = copied(self.call())
        except Exception as error:  # a module's fault must not end the run
            fail(self.failures, self.outputs, error, now)
            result = None
        if result is not None:
            message = message_of((result, now, self.name, None, None))
            for offer in self.offers:
                offer(message)
        if self.following is not None:
            self.following.ask()


class Resetting:
    """Resets a module: calls its function, and each of its parts forgets what it holds."""

    def __init__(
        self,
        behaviour: Behaviour | None,
        parts: Sequence[Any],
        renew: Callable[[], None],
        completion: Completion | None,
        failures: Failures,
        schedule: Schedule,
    ) -> None:
        self.call = None if behaviour is None else behaviour.reset
        self.parts, self.renew, self.completion = parts, renew, completion
        self.failures, self.schedule = failures, schedule
        self.resetting = False

    def receive(self, message: Message) -> None:
        """Reset the module, then ask for its completion; this may reset it again, afterwards."""
        if self.resetting:
            self.schedule.at(self.schedule.now, DATA, lambda: self.receive(message))
            return
        self.resetting = True
        try:
            if self.call is not None:
                self.call(copied(message.value))
        except Exception as error:  # a module's fault must not end the run
            self.failures.note(error, self.schedule.now, (message.value,))
        for part in self.parts:
            part.forget()
        self.renew()
        if self.completion is not None:
            self.completion.ask()
        self.resetting = False
