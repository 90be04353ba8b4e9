"""Nodes that forward data and control: splitters, DataTransformers, InheritanceNodes."""

from collections import deque
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

from mars_asp.behaviour.values import copied
from mars_asp.execution.executor.behaviour import Behaviour
from mars_asp.execution.executor.delivery import Offer
from mars_asp.execution.executor.link import Failures, Link, Message, fail
from mars_asp.execution.executor.schedule import Schedule
from mars_asp.model.declarations import GRASP, TAKING

if TYPE_CHECKING:
    from mars_asp.kinematics.sharing import Carrying


class DataSplitter:
    """Forwards each message to every output in the same instant, in the specification's order."""

    def __init__(self) -> None:
        self.offers: list[Offer] = []

    def receive(self, message: Message) -> None:
        """Offer a message to every output."""
        for offer in self.offers:
            offer(message)


class DataTransformer:
    """Applies a converter to each message; an exception drops it and marks the outputs faulty."""

    def __init__(self, converter: Behaviour, outputs: list[Link], schedule: Schedule) -> None:
        self.convert, self.outputs, self.schedule = converter.call, outputs, schedule
        self.failures = Failures(place=converter.place)
        self.offers: list[Offer] = []

    def receive(self, message: Message) -> None:
        """Convert a message and offer it to every output."""
        try:
            value = copied(self.convert(copied(message.value)))
        except Exception as error:  # a converter's fault must not end the run
            fail(self.failures, self.outputs, error, self.schedule.now, (message.value,))
            return
        for offer in self.offers:
            offer(message._replace(value=value))


class ControlSplitter:
    """Forwards each command to every output.

    In a circle of Gates, a command that is forwarded can lead to another one, or to its withdrawal,
    which waits until the command has left by every output.
    """

    def __init__(self, outputs: list[Link]) -> None:
        self.outputs = outputs
        self.waiting: deque[Callable[[Link], None]] = deque()

    def receive(self, message: Message) -> None:
        """Send a command to every output."""
        self._forward(lambda link: link.send(message))

    def withdraw(self) -> None:
        """Withdraw the last command from every output."""
        self._forward(lambda link: link.withdrawn())

    def _forward(self, action: Callable[[Link], None]) -> None:
        self.waiting.append(action)
        if len(self.waiting) > 1:
            return
        while self.waiting:
            for link in self.outputs:
                self.waiting[0](link)
            self.waiting.popleft()


class InheritanceNode:
    """Divides a command among the effectors that provide its functions, in their frames.

    `providers` are its outputs, nearest first, and `functions` the own ones of each provider. Among
    similar providers the nearest takes a function, with the allocation `root` the farthest, with
    `split` each an equal share. A function of no single provider is composed by a minimal set of
    providers at the present posture. Missing functions are zero: a stop reaches all providers, and
    a provider that a command no longer needs is stopped. The `own` functions of the commanded
    module are ignored.
    """

    def __init__(
        self,
        providers: Mapping[str, Link],
        functions: Mapping[str, frozenset[str]],
        carrying: "Carrying | None",
        allocation: str | None = None,
        own: frozenset[str] = frozenset(),
    ) -> None:
        self.providers, self.functions, self.carrying = providers, functions, carrying
        self.own = own
        self.allocation = allocation
        self.moving: set[str] = set()

    def receive(self, message: Message) -> None:
        """Send each provider its share of a command."""
        commands: dict[str, dict[str, float]] = {name: {} for name in self.providers}
        lacking = []
        for function, rate in message.value.items():
            if function in self.own:
                continue
            shares = self.shares(function)
            for name, native, share in shares:
                commands[name][native] = commands[name].get(native, 0.0) + share * rate
            if not shares:
                lacking.append(function)
        for name, link in self.providers.items():
            if commands[name] or not message.value or name in self.moving:
                link.send(message._replace(value=commands[name]))
            (self.moving.add if commands[name] else self.moving.discard)(name)
        if lacking:
            names = ", ".join(sorted(lacking))
            for link in list(self.providers.values())[:1]:
                link.fail(LookupError(f"nothing provides {names} at this posture"), message)

    def withdraw(self) -> None:
        """Withdraw the last command from every provider."""
        self.moving.clear()
        for link in self.providers.values():
            link.withdrawn()

    def shares(self, function: str) -> list[tuple[str, str, float]]:
        """Return the shares in one unit of a function: (provider, native function, rate).

        A grasp needs no transformation between frames.
        """
        if self.carrying is not None and function != GRASP:
            return self.carrying.shares(function, self.allocation)
        able = [name for name in self.providers if function in self.functions[name]]
        taking = able[TAKING[self.allocation]]
        return [(name, function, 1 / len(taking)) for name in taking]
