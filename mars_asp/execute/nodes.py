"""Nodes that carry data and control on: splitters, transformers, inheritance."""

from collections.abc import Callable, Sequence
from typing import Any

from mars_asp.execute.delivery import Offer
from mars_asp.execute.link import Failures, Link, Message
from mars_asp.model import GRASP

#: Rows of a rotation that takes vectors of the commanding frame into the provider's.
Rotation = Sequence[Sequence[float]]


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
    `split` each an equal share; a stop reaches them all.
    """

    def __init__(
        self,
        providers: Sequence[tuple[Link, Rotation, frozenset[str]]],
        allocation: str | None = None,
    ) -> None:
        self.providers = providers
        self.taking = {None: slice(1), "root": slice(-1, None), "split": slice(None)}[allocation]

    def receive(self, message: Message) -> None:
        """Send each provider what falls to it."""
        commands: list[dict[str, float]] = [{} for _ in self.providers]
        lacking = []
        for function, rate in message.value.items():
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
        for command, (link, _, _) in zip(commands, self.providers, strict=True):
            if command or not message.value:
                link.send(message._replace(value=command))
        if lacking:
            names = ", ".join(sorted(lacking))
            for link, _, _ in self.providers[:1]:
                link.fail(LookupError(f"nothing provides {names}"))


def map_function(function: str, rate: float, rotation: Rotation) -> dict[str, float]:
    """Return what a function and its rate are in another frame; a grasp has no direction."""
    if function == GRASP:
        return {function: rate}
    kind, axis = function.split("_")
    column = "XYZ".index(axis)
    parts = {f"{kind}_{name}": row[column] for name, row in zip("XYZ", rotation, strict=True)}
    return {name: part * rate for name, part in parts.items() if abs(part) > 1e-9}
