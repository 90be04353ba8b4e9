"""Messages, and the links that carry and count them."""

from collections import Counter, deque
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import partial
from typing import Any, Literal, NamedTuple, TypeAlias

from mars_asp.behaviour.imports import place_of
from mars_asp.behaviour.values import shown
from mars_asp.diagnostic import Span
from mars_asp.execution.executor.behaviour import AskedError
from mars_asp.execution.executor.schedule import Schedule
from mars_asp.model.declarations import Mode


class Message(NamedTuple):
    """A value on its way: when (ns) and by which module it was made.

    A command that an arbiter hands on also carries until when (ns) it is in force and the
    arrival number by which the latest among equals is known.
    """

    value: Any
    time: int
    origin: str
    until: int | None = None
    arrival: int | None = None


#: Makes a message of a tuple of all its fields, at half the cost of calling the class.
message_of: Callable[[tuple[Any, int, str, int | None, int | None]], Message] = partial(
    tuple.__new__, Message
)


#: Told of every delivery, holding and fault: time, what happened, where, and with what.
Observer: TypeAlias = Callable[[int, str, str, object], None]


@dataclass(slots=True)
class Failures:
    """How many exceptions were raised that the scenario did not ask for, and the first of them.

    `first` is its text, `at` (ns) when it was raised, `raised` its file and line in the code of the
    user, where it has one, else the `place` of the function, and `inputs` what that was given.
    """

    place: tuple[str, int] | None = None
    count: int = 0
    first: str = ""
    at: int = 0
    raised: tuple[str, int] | None = None
    inputs: tuple[str, ...] = ()

    def note(self, error: Exception, now: int, inputs: Sequence[object] = ()) -> None:
        """Count an exception, unless it was asked for."""
        if isinstance(error, AskedError):
            return
        self.count += 1
        if self.count == 1:
            self.first, self.at, self.raised = _text_of(error), now, place_of(error) or self.place
            self.inputs = tuple(shown(value) for value in inputs)


def _text_of(error: Exception) -> str:
    """Return the kind and the text of an exception; a text may itself raise."""
    name = type(error).__name__
    try:
        return f"{name}: {error}"
    except Exception:  # the class of a user's exception may be wrong in any way
        return name


@dataclass(slots=True, eq=False)
class Link:
    """One relationship of the specification, and what has passed over it.

    `dropped` counts by reason: `lowered` (a rate that was to be lowered), `unread` (overtaken
    before it was requested), `overtaken` (by another command of the instant), `failed` (an
    exception; `fault` says which was the first). `failures` are those of the link itself, which
    cannot do with messages what it is to do. `hold` and ages are in ns.
    """

    kind: Literal["data", "control"]
    source: str
    client: str
    span: Span
    mode: Mode | None = None
    hz: Fraction | None = None
    priority: int = 0
    hold: int | None = None
    allocation: str | None = None
    client_port: str | None = None
    #: The number of the input of its client that it feeds; several links may feed one.
    slot: int = 0
    receive: Callable[[Message], None] = lambda message: None
    request: Callable[[], None] | None = None
    delivered: int = 0
    #: When (ns) the last few were delivered.
    latest: deque[int] = field(default_factory=lambda: deque(maxlen=8))
    #: Since when (ns) there was a message to repeat, or None before; 0 where none is repeated.
    begun: int | None = 0
    stale: int = 0
    dropped: Counter[str] = field(default_factory=Counter)
    fault: str = ""
    failures: Failures = field(default_factory=Failures)
    oldest: int = 0
    schedule: Schedule = field(default_factory=Schedule)
    observe: Observer | None = None

    @property
    def faulty(self) -> bool:
        """Whether an exception dropped a message."""
        return bool(self.fault)

    def before(self, time: Fraction) -> int:
        """Return how many messages were delivered before a time (ns) of the last few."""
        return self.delivered - sum(at >= time for at in self.latest)

    def send(self, message: Message) -> None:
        """Deliver at once."""
        now = self.schedule.now
        self.delivered += 1
        self.latest.append(now)
        if message[1] != now:
            self.oldest = max(self.oldest, now - message[1])
        if self.observe is not None:
            self.observe(now, self.kind, f"{self.source} -> {self.client}", message.value)
        self.receive(message)

    def fail(self, error: Exception, message: Message) -> None:
        """Count a message that the link itself cannot deal with."""
        self.failures.note(error, self.schedule.now, (message.value,))
        self.drop(error)

    def drop(self, error: Exception) -> None:
        """Count a message that an exception dropped; the link is faulty from now on."""
        self.dropped["failed"] += 1
        self.fault = self.fault or _text_of(error)
        if self.observe is not None:
            name = type(error).__name__
            self.observe(self.schedule.now, "failed", f"{self.source} -> {self.client}", name)


def fail(
    failures: Failures,
    links: Iterable[Link],
    error: Exception,
    now: int,
    inputs: Sequence[object] = (),
) -> None:
    """Count an exception, and on every link the message that is lost by it."""
    failures.note(error, now, inputs)
    for link in links:
        link.drop(error)
