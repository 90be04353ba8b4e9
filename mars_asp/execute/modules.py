"""Modules at work: what triggers them, and what becomes of their results."""

from collections.abc import Callable
from fractions import Fraction
from typing import Any

from mars_asp.execute.behaviour import Behaviour, single_command
from mars_asp.execute.delivery import Port, start_clock
from mars_asp.execute.link import Link, Message
from mars_asp.execute.schedule import CONTROL, MILLISECOND, SECOND, SENSORS, Schedule

COMMAND_TIMEOUT = 500 * MILLISECOND


class Sensor:
    """Samples its device at a rate, or, without one, when it is asked."""

    def __init__(self, name: str, behaviour: Behaviour, hz: Fraction | None, schedule: Schedule):
        self.name, self.behaviour, self.schedule = name, behaviour, schedule
        self.ports: list[Port] = []
        self.outputs: list[Link] = []
        if hz is None and behaviour.period is not None:
            hz = Fraction(SECOND, behaviour.period)
        self.clocked = hz is not None
        if hz is not None:
            start_clock(schedule, hz, SENSORS, self.sample)

    def sample(self) -> None:
        """Read the device and offer what it says to every output."""
        emit(self.schedule, self.behaviour, (), SENSORS, accept=self.accept, outputs=self.outputs)

    def accept(self, reading: Any, made: int) -> None:
        """Offer a reading that was made at an instant (ns); none is nothing to deliver."""
        if reading is None:
            return
        message = Message(reading, made, self.name)
        for port in self.ports:
            port.offer(message)


class Algorithm:
    """Computes with the latest of each input, once all have arrived.

    A data input that is pulled is asked when the module runs, and the run waits for the answer.
    `rank` is the schedule's for data or for control; `triggered` says that inputs make it run.
    """

    def __init__(
        self, name: str, behaviour: Behaviour, rank: int, triggered: bool, schedule: Schedule
    ) -> None:
        self.name, self.behaviour, self.rank = name, behaviour, rank
        self.triggered, self.schedule = triggered, schedule
        self.ports: list[Port] = []
        self.outputs: list[Link] = []
        self.latest: list[Message | None] = []
        self.pulled: list[tuple[int, Link]] = []
        self.missing: set[int] = set()
        self.waiting = False

    def input(self, link: Link, pulled: bool) -> Callable[[Message], None]:
        """Return what takes the messages of one link; inputs keep the order of their links."""
        index = len(self.latest)
        self.latest.append(None)
        if pulled:
            self.pulled.append((index, link))
        return lambda message: self.receive(index, message, pulled)

    def receive(self, index: int, message: Message, pulled: bool) -> None:
        """Keep a message; run on it where inputs trigger, or go on with a run that waited."""
        self.latest[index] = message
        self.missing.discard(index)
        if pulled:
            if self.waiting and not self.missing:
                self.waiting = False
                self.schedule.soon(self.rank, self.compute)
        elif self.triggered:
            self.schedule.soon(self.rank, self.run)

    def run(self) -> None:
        """Ask for what is pulled; compute when it is there."""
        if not self.pulled:
            self.compute()
            return
        if self.waiting:
            return
        self.missing = {index for index, _ in self.pulled}
        self.waiting = True
        for _, link in self.pulled:
            if link.request is not None:
                link.request()

    def compute(self) -> None:
        """Call the behaviour and offer its result, unless it returns nothing."""
        inputs = tuple(message.value for message in self.latest if message is not None)
        if len(inputs) == len(self.latest):
            emit(
                self.schedule,
                self.behaviour,
                inputs,
                self.rank,
                accept=self.accept,
                outputs=self.outputs,
            )

    def accept(self, result: Any, made: int) -> None:
        """Offer a result to every output."""
        if result is None:
            return
        if self.rank == CONTROL:
            try:
                result = single_command(result)
            except (TypeError, ValueError) as error:
                fail(self.outputs, error)
                return
        message = Message(result, made, self.name)
        for port in self.ports:
            port.offer(message)


class Effector:
    """Holds the latest command; rests when none came for `timeout` ns."""

    def __init__(self, name: str, behaviour: Behaviour, timeout: int, schedule: Schedule) -> None:
        self.name, self.behaviour, self.schedule = name, behaviour, schedule
        self.timeout = timeout
        self.message: Message | None = None
        self.inputs: list[Link] = []
        self.applied: list[tuple[int, str, dict[str, float]]] = []
        self.timeouts = 0

    def input(self, link: Link) -> Callable[[Message], None]:
        """Return what takes the commands of one link."""
        self.inputs.append(link)
        return self.receive

    def receive(self, message: Message) -> None:
        """Take a command; it is applied when everything else of the instant is done."""
        self.message = message
        self.schedule.soon(self.schedule.effectors, lambda: self.apply(message))
        if message.value:
            due = self.schedule.now + self.timeout
            self.schedule.at(due, self.schedule.effectors, lambda: self.expire(message))

    def apply(self, message: Message) -> None:
        """Carry a command out, unless a later one of the same instant took its place."""
        if message is not self.message:
            return
        try:
            self.behaviour.call(message.value)
        except Exception as error:  # a device's fault must not end the run
            fail(self.inputs, error)
        if not self.applied or self.applied[-1][1:] != (message.origin, message.value):
            self.applied.append((self.schedule.now, message.origin, message.value))

    def expire(self, message: Message) -> None:
        """Rest, if no command has come since."""
        if message is self.message:
            self.timeouts += 1
            self.message = Message({}, self.schedule.now, "")
            self.apply(self.message)


def emit(
    schedule: Schedule,
    behaviour: Behaviour,
    inputs: tuple[Any, ...],
    rank: int,
    *,
    accept: Callable[[Any, int], None],
    outputs: list[Link],
) -> None:
    """Call a behaviour; hand its result on after its delay; an exception drops the message."""
    made = schedule.now
    try:
        result = behaviour.call(*inputs)
    except Exception as error:  # a module's fault must not end the run
        fail(outputs, error)
        return
    if behaviour.delay:
        schedule.at(made + behaviour.delay, rank, lambda: accept(result, made))
    else:
        accept(result, made)


def fail(links: list[Link], error: Exception) -> None:
    """Count on every link the message that it did not get."""
    for link in links:
        link.fail(error)
