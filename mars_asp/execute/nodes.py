"""Nodes that carry data and control on: splitters, transformers, inheritance."""

from collections.abc import Callable, Sequence
from typing import Any

from mars_asp.execute.delivery import Offer
from mars_asp.execute.link import Failures, Link, Message
from mars_asp.execute.rotations import Rotation, map_function


class DataSplitter:
    """Copies each message to every output in the same instant, in the specification's order."""

    def __init__(self) -> None:
        self.offers: list[Offer] = []

    def receive(self, message: Message) -> None:
        """Offer a message to every output."""
        for offer in self.offers:
            offer(message)


class DataTransformer:
    """Applies its converter; an exception drops the message and marks the output faulty."""

    def __init__(self, convert: Callable[[Any], Any], outputs: list[Link]) -> None:
        self.convert, self.outputs = convert, outputs
        self.failures = Failures()
        self.offers: list[Offer] = []

    def receive(self, message: Message) -> None:
        """Convert a message and hand it on."""
        try:
            value = self.convert(message.value)
        except Exception as error:  # a converter's fault must not end the run
            self.failures.note(error)
            for link in self.outputs:
                link.drop(error)
            return
        for offer in self.offers:
            offer(message._replace(value=value))


class ControlSplitter:
    """Copies each command to every output."""

    def __init__(self, outputs: list[Link]) -> None:
        self.outputs = outputs

    def receive(self, message: Message) -> None:
        """Send a command to every output."""
        for link in self.outputs:
            link.send(message)


class InheritanceNode:
    """Maps a command into the frames of the effectors that provide its functions.

    `providers` are, nearest first, an output, its rotation and the functions it has. Among
    similar providers the nearest takes a function, with the allocation `root` the farthest, with
    `split` each an equal share. Functions that are not named are zero: a stop reaches all, and who
    has no part in a command any more gets one. What the commanded module does itself, its `own`,
    is left to it.
    """

    def __init__(
        self,
        providers: Sequence[tuple[Link, Rotation, frozenset[str]]],
        allocation: str | None = None,
        own: frozenset[str] = frozenset(),
    ) -> None:
        self.providers, self.own = providers, own
        self.taking = {None: slice(1), "root": slice(-1, None), "split": slice(None)}[allocation]
        self.moving: set[int] = set()

    def receive(self, message: Message) -> None:
        """Send each provider what falls to it."""
        commands: list[dict[str, float]] = [{} for _ in self.providers]
        lacking = []
        for function, rate in message.value.items():
            if function in self.own:
                continue
            able = [
                (command, mapped)
                for command, (_, rotation, functions) in zip(commands, self.providers, strict=True)
                if (mapped := map_function(function, rate, rotation)).keys() <= functions
            ]
            taking = able[self.taking]
            for command, mapped in taking:
                for name, part in mapped.items():
                    command[name] = command.get(name, 0.0) + part / len(taking)
            if not able:
                lacking.append(function)
        for index, (command, (link, _, _)) in enumerate(zip(commands, self.providers, strict=True)):
            if command or not message.value or index in self.moving:
                link.send(message._replace(value=command))
            (self.moving.add if command else self.moving.discard)(index)
        if lacking:
            names = ", ".join(sorted(lacking))
            for link, _, _ in self.providers[:1]:
                link.fail(LookupError(f"nothing provides {names}"))
