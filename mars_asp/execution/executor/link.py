"""Messages, and the links that carry and count them."""

from collections import Counter, deque
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import partial
from typing import Any, Literal, NamedTuple, Protocol, TypeAlias

from mars_asp.behaviour.imports import place_of
from mars_asp.behaviour.values import shown
from mars_asp.diagnostic import Span
from mars_asp.execution.executor.behaviour import InjectedError
from mars_asp.execution.executor.schedule import Schedule
from mars_asp.model.declarations import Mode


class Message(NamedTuple):
    """A value with the time (ns) and the module of its origin.

    A command that an arbiter forwards also has the end (ns) of its validity, and its arrival
    number, by which an arbiter finds the latest among equal priorities.
    """

    value: Any
    time: int
    origin: str
    until: int | None = None
    arrival: int | None = None


#: Makes a message from a tuple of all fields, at half the cost of calling the class.
message_of: Callable[[tuple[Any, int, str, int | None, int | None]], Message] = partial(
    tuple.__new__, Message
)


#: Whether a link carries data or commands.
Stream: TypeAlias = Literal["data", "control"]
#: The kinds of links that end at the side of a Gate, an arbiter or a module.
SideKind: TypeAlias = Literal["suppress", "inhibit", "lock", "limit", "reset"]

#: Called with the time, kind, location and value of every delivery, holding, closing and fault.
Observer: TypeAlias = Callable[[int, str, str, object], None]


@dataclass(slots=True)
class Failures:
    """The number of exceptions that no scenario injected, and the first of them.

    `first` is its text, `at` its time (ns), `raised` its file and line in the user's code, or else
    the `place` of the function, and `inputs` the arguments of the function.
    """

    place: tuple[str, int] | None = None
    count: int = 0
    first: str = ""
    at: int = 0
    raised: tuple[str, int] | None = None
    inputs: tuple[str, ...] = ()

    def note(self, error: Exception, now: int, inputs: Sequence[object] = ()) -> None:
        """Count an exception at time `now` (ns), unless the scenario injected it."""
        if isinstance(error, InjectedError):
            return
        self.count += 1
        if self.count == 1:
            self.first, self.at, self.raised = _text_of(error), now, place_of(error) or self.place
            self.inputs = tuple(shown(value) for value in inputs)


def _text_of(error: Exception) -> str:
    """Return class and text of an exception, or the class if its `__str__` raises."""
    name = type(error).__name__
    try:
        return f"{name}: {error}"
    except Exception:  # the class of a user's exception may be wrong in any way
        return name


class FaultyChannel(Protocol):
    """The counts of a link with faults: messages sent, lost and under way."""

    in_flight: int
    #: The time (ns) of the first arrival.
    first: int | None

    def sent_before(self, time: Fraction) -> int:
        """Return the number of messages sent before a time (ns), which must be recent."""

    def lost_before(self, time: Fraction) -> int:
        """Return the number of messages lost before a time (ns), which must be recent."""


@dataclass(slots=True, eq=False)
class Link:
    """One relationship of the specification, with the counts of its messages.

    `dropped` counts by reason: `lowered` (for a lower rate), `unread` (overtaken before it was
    requested), `overtaken` (by another command of the instant), `suppressed` and `inhibited` (by a
    closed Gate), `lost` (by a fault of the link), `failed` (an exception; `fault` is the first).
    `failures` are exceptions of the link itself, for example of its condition. `declared` is
    the priority as written; `hold`, the `time` for which a trigger closes, and ages are in ns.
    `stream` is the stream that a link of another kind carries. `withdrawn` is called when the last
    command of the link is withdrawn, `forget` when the answer to its request is lost, `renew` when
    a conditional mode starts anew.
    """

    kind: Stream | SideKind
    source: str
    client: str
    span: Span
    mode: Mode | None = None
    hz: Fraction | None = None
    priority: int = 0
    declared: int | None = None
    hold: int | None = None
    time: int = 0
    stream: Stream = "data"
    allocation: str | None = None
    client_port: str | None = None
    #: The index of the input that the link feeds; several links may feed one input.
    slot: int = 0
    receive: Callable[[Message], None] = lambda message: None
    request: Callable[[], None] | None = None
    forget: Callable[[], bool] = lambda: False
    withdrawn: Callable[[], None] = lambda: None
    renew: Callable[[], None] = lambda: None
    delivered: int = 0
    #: The times (ns) of the last deliveries.
    latest: deque[int] = field(default_factory=lambda: deque(maxlen=8))
    #: The time (ns) of the first message to repeat, or None before; 0 if none is repeated.
    begun: int | None = 0
    stale: int = 0
    dropped: Counter[str] = field(default_factory=Counter)
    fault: str = ""
    failures: Failures = field(default_factory=Failures)
    oldest: int = 0
    schedule: Schedule = field(default_factory=Schedule)
    observe: Observer | None = None
    #: The faults of the link, or None if it has none.
    channel: FaultyChannel | None = None
    send: Callable[[Message], None] = field(init=False)

    def __post_init__(self) -> None:
        self.send = self.deliver

    @property
    def faulty(self) -> bool:
        """Whether an exception dropped a message of the link."""
        return bool(self.fault)

    def before(self, time: Fraction) -> int:
        """Return the number of messages delivered before a time (ns), which must be recent."""
        return self.delivered - sum(at >= time for at in self.latest)

    def deliver(self, message: Message) -> None:
        """Deliver a message at once."""
        now = self.schedule.now
        self.delivered += 1
        self.latest.append(now)
        if message[1] != now:
            self.oldest = max(self.oldest, now - message[1])
        if self.observe is not None:
            self.observe(now, self.kind, f"{self.source} -> {self.client}", message.value)
        self.receive(message)

    def fail(self, error: Exception, message: Message) -> None:
        """Count an exception of the link itself, and the message that it drops."""
        self.failures.note(error, self.schedule.now, (message.value,))
        self.drop(error)

    def drop(self, error: Exception) -> None:
        """Count a message that an exception dropped; the link is then faulty."""
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
    """Count an exception at time `now` (ns), and on each of `links` a dropped message."""
    failures.note(error, now, inputs)
    for link in links:
        link.drop(error)
