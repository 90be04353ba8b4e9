"""What reaches each client and effector with gates, locks, limits and strategies, from the text.

It looks at the lines of a configuration, never at the nodes of a specification, and at each whole
millisecond. Each controller states its hold. No two controllers send in one instant.
"""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, TypeAlias

from mars_asp.model.declarations import (
    Configuration,
    Control,
    Data,
    Gating,
    Limit,
    Lock,
    Strategy,
)
from tests.support.subsumes import Output, Sorts, gated_end

#: What modules send, by time in ms: a value, or rates by function.
Scripts: TypeAlias = Mapping[str, Mapping[int, Any]]
#: What a client or effector is given, with the time; {} is a stop.
Got: TypeAlias = list[tuple[int, Any]]
WINDOW = 100


@dataclass
class Message:
    """A command: its sender, rates, time, the time until which it is in force, and its turn.

    Of two messages of one instant the one with the greater turn comes later.
    """

    sender: str
    rates: Any
    sent: int
    until: float = float("inf")
    turn: int = 0


class Closing:
    """Until when each gate line keeps its line closed."""

    def __init__(self, line: Gating, trigger: Output) -> None:
        self.line, self.trigger = line, trigger
        self.until = 0

    def hear(self, value: Any, now: int) -> bool:
        """Note a message; return whether it closes the line."""
        if self.line.sign == "inhibit" and isinstance(value, bool) and not value:
            self.until = 0
            return False
        self.until = now + self.line.ms
        return True


class Timeline:
    """The lines of a configuration, and what its modules send."""

    def __init__(self, configuration: Configuration, scripts: Scripts) -> None:
        self.scripts = scripts
        lines = configuration.relationships
        self.sorts = Sorts(lines)
        self.data = [line for line in lines if isinstance(line, Data)]
        outputs = {(d.source, d.source_port) for d in self.data}
        ends = {(d.client, d.client_port) for d in self.data}
        inputs = {(m, p) for m, p in ends - outputs if p is not None}
        self.gates: dict[Output, list[Closing]] = {}
        for line in lines:
            if isinstance(line, Gating):
                end = gated_end(line, self.sorts, inputs)
                self.add_gate(end, Closing(line, self.sorts.trigger(line)))
        self.clients: dict[str, Got] = {line.client: [] for line in self.data}
        self.arbiters: dict[str, _Arbiter] = {}
        flat = configuration.architecture == "flat"
        for name in dict.fromkeys(k.controlled for k in lines if isinstance(k, Control)):
            mine = [line for line in lines if getattr(line, "controlled", None) == name]
            window = configuration.period_ms or WINDOW
            turns = {k.controller: self.turn(k.controller) for k in mine if isinstance(k, Control)}
            self.arbiters[name] = _Arbiter(mine, self.sorts, flat, window, turns)

    def add_gate(self, end: Output, added: Closing) -> None:
        """Add a gate line; of those with the same ends and sign the longest counts."""
        closings = self.gates.setdefault(end, [])
        for closing in closings:
            if (closing.line.sign, closing.trigger) == (added.line.sign, added.trigger):
                longer = max(closing, added, key=lambda each: each.line.ms)
                closing.line = longer.line
                return
        closings.append(added)

    def run(self, end: int) -> None:
        """Fill `clients` and the `got` of `arbiters` up to an instant."""
        for now in range(end + 1):
            data = self.pass_data(now)
            commands, withdrawn = self.pass_commands(now, data)
            for arbiter in self.arbiters.values():
                arbiter.step(now, data, commands, withdrawn)

    def turn(self, name: str) -> int:
        """Return the number of Gates that the commands of a controller wait for in an instant."""
        closings = self.gates.get(Output(name, "command"), [])
        waits = [self.turn(c.trigger.name) for c in closings if c.trigger.sort == "command"]
        return 1 + max(waits, default=0) if closings else 0

    def scripted(self, name: str, now: int) -> list[Any]:
        script = self.scripts.get(name, {})
        return [script[now]] if now in script else []

    def pass_data(self, now: int) -> dict[Output, list[Any]]:
        """Return the messages of each output and gated input at an instant."""
        passed: dict[Output, list[Any]] = {}

        def leaving(output: Output) -> list[Any]:
            if output not in passed:
                own = self.scripted(output.name, now)
                passed[output] = self.through(output, own, leaving, now)
            return passed[output]

        for line in self.data:
            source = Output(line.source, "data", line.source_port)
            entry = Output(line.client, "input", line.client_port)
            arrived = self.through(entry, leaving(source), leaving, now)
            self.clients[line.client] += [(now, value) for value in arrived]
        for closings in self.gates.values():
            for closing in closings:
                if closing.trigger.sort == "data":
                    leaving(closing.trigger)
        for arbiter in self.arbiters.values():
            for output in arbiter.lock_outputs():
                leaving(output)
        return passed

    def through(self, end: Output, own: list[Any], leaving: Any, now: int) -> list[Any]:
        """Return the messages that pass the Gate of an end, those of suppressors first."""
        given: list[Any] = []
        for closing in self.gates.get(end, ()):
            if closing.trigger.sort == "data":
                for value in leaving(closing.trigger):
                    closing.hear(value, now)
                    given += [value] if closing.line.sign == "suppress" else []
        is_open = all(now >= closing.until for closing in self.gates.get(end, ()))
        return [*given, *(own if is_open else ())]

    def pass_commands(
        self, now: int, data: Mapping[Output, list[Any]]
    ) -> tuple[dict[str, list[Message]], set[str]]:
        """Return the commands that leave each controller, and those whose own are withdrawn."""
        passed: dict[str, list[Message]] = {}
        withdrawn: set[str] = set()

        def leaving(name: str) -> list[Message]:
            if name in passed:
                return passed[name]
            given: list[Message] = []
            closings = self.gates.get(Output(name, "command"), [])
            for closing in closings:
                by_data = closing.trigger.sort == "data"
                heard: Iterable[Message] = (
                    [Message("", value, now) for value in data.get(closing.trigger, [])]
                    if by_data
                    else leaving(closing.trigger.name)
                )
                for message in heard:
                    closed = closing.hear(message.rates, now)
                    if closing.line.sign == "suppress":
                        given.append(message)
                    elif closed:
                        withdrawn.add(name)
            is_open = all(now >= closing.until for closing in closings)
            own = [Message(name, rates, now) for rates in self.scripted(name, now)]
            passed[name] = [*given, *(own if is_open else ())]
            return passed[name]

        for arbiter in self.arbiters.values():
            for name in arbiter.sources():
                leaving(name)
        for end, closings in self.gates.items():
            for closing in closings:
                if closing.trigger.sort == "command":
                    messages = leaving(closing.trigger.name)
                    if end.sort != "command":
                        # It acts from the next instant's messages on.
                        for message in messages:
                            closing.hear(message.rates, now)
        return passed, withdrawn


class _Arbiter:
    """All that arbitrates the commands of one module."""

    def __init__(
        self, lines: list[Any], sorts: Sorts, flat: bool, window: int, turns: Mapping[str, int]
    ) -> None:
        self.turns = turns
        self.control = [line for line in lines if isinstance(line, Control)]
        self.locks = [(line, sorts.trigger(line)) for line in lines if isinstance(line, Lock)]
        self.limits = [(line, sorts.trigger(line)) for line in lines if isinstance(line, Limit)]
        strategy_lines = [line for line in lines if isinstance(line, Strategy)]
        several = len(self.control) > 1
        self.strategy = "flat" if flat and several else "hierarchical"
        self.window = window
        if strategy_lines:
            self.strategy = strategy_lines[0].strategy
            self.window = strategy_lines[0].period_ms or window
        self.own_strategy = self.strategy
        # One controller is handed on at once.
        self.strategy = self.strategy if several else "hierarchical"
        self.arbitrates = several or bool(self.locks or self.limits or strategy_lines)
        self.in_force: dict[str, Message] = {}
        self.heard: list[tuple[str, Message]] = []
        self.last_lock: dict[int, tuple[int, Any]] = {}
        self.last_limit: dict[int, tuple[int, Mapping[str, Any]]] = {}
        self.obeyed: tuple[Message, Mapping[str, Any]] | None = None
        #: The lock of one with a hold is closed before the run, as no message came.
        self.was_locked = any(line.hold_ms is not None for line, _ in self.locks)
        self.got: Got = []

    def lock_outputs(self) -> Iterator[Output]:
        return (output for _, output in self.locks)

    def sources(self) -> Iterator[str]:
        yield from (line.controller for line in self.control)
        yield from (output.name for _, output in self.limits)

    def step(
        self,
        now: int,
        data: Mapping[Output, list[Any]],
        commands: Mapping[str, list[Message]],
        withdrawn: set[str],
    ) -> None:
        for number, (_, output) in enumerate(self.locks):
            for value in data.get(output, []):
                self.last_lock[number] = (now, value)
        for number, (_, output) in enumerate(self.limits):
            for message in commands.get(output.name, []):
                self.last_limit[number] = (now, message.rates)
        for line in self.control:
            name = line.controller
            kept = self.in_force.get(name)
            if kept is not None and kept.sender in withdrawn:
                del self.in_force[name]
            for message in commands.get(name, []):
                hold = line.hold_ms if self.arbitrates else None
                until = now + hold if isinstance(hold, int) else float("inf")
                heard = Message(message.sender, message.rates, now, until, self.turns[name])
                self.in_force[name] = heard
                if not self.passed_over(line, now):
                    self.heard.append((name, heard))
        if self.strategy in ("flat", "weighted"):
            self.average(now)
        else:
            self.select(now)

    # ---- Locks and limits

    def locked(self, now: int) -> list[Lock]:
        """Return the locks that are locked at an instant."""
        found = []
        for number, (line, _) in enumerate(self.locks):
            when, value = self.last_lock.get(number, (None, False))
            silent = line.hold_ms is not None and (when is None or when <= now - line.hold_ms)
            if value or silent:
                found.append(line)
        return found

    def passed_over(self, line: Control, now: int) -> bool:
        return any(
            lock.priority is None
            or self.own_strategy != "hierarchical"
            or (line.priority or 0) < lock.priority
            for lock in self.locked(now)
        )

    def bounded(self, rates: Mapping[str, Any], now: int) -> Mapping[str, Any]:
        factor: Fraction | float = 1
        for number, (line, _) in enumerate(self.limits):
            when, bounds = self.last_limit.get(number, (None, {}))
            if line.hold_ms is not None and (when is None or when <= now - line.hold_ms):
                factor = 0
            for function in bounds.keys() & rates.keys():
                if rates[function]:
                    factor = min(factor, abs(bounds[function]) / abs(rates[function]))
        return {function: rate * factor for function, rate in rates.items()}

    # ---- Strategies

    def select(self, now: int) -> None:
        best: tuple[int, int, int, Message] | None = None
        for line in self.control:
            message = self.in_force.get(line.controller)
            if message is None or message.until <= now or self.passed_over(line, now):
                continue
            rank = (line.priority or 0) if self.strategy == "hierarchical" else 0
            key = rank, message.sent, message.turn, message
            best = key if best is None or key[:3] > best[:3] else best
        if best is None:
            if self.obeyed is not None:
                self.got.append((now, {}))
            self.obeyed = None
            return
        message = best[3]
        rates = self.bounded(message.rates, now)
        if self.obeyed is None or self.obeyed[0] is not message or self.obeyed[1] != rates:
            self.got.append((now, rates))
        self.obeyed = message, rates

    def average(self, now: int) -> None:
        is_locked = bool(self.locked(now))
        if is_locked and not self.was_locked:
            self.got.append((now, {}))
            self.obeyed = None
        self.was_locked = is_locked
        if self.obeyed is not None:
            message, sent = self.obeyed
            if (again := self.bounded(message.rates, now)) != sent:
                self.got.append((now, again))
                self.obeyed = message, again
        if now == 0 or now % self.window:
            return
        heard, self.heard = self.heard, []
        if is_locked:
            return
        rates = self.mean(heard)
        if rates:
            sent = self.bounded(rates, now)
            self.got.append((now, sent))
            self.obeyed = Message("mean", rates, now), sent

    def mean(self, heard: list[tuple[str, Message]]) -> Mapping[str, Any]:
        weights = {line.controller: line.priority for line in self.control}
        if self.strategy == "weighted":
            latest = dict(heard)
            pairs = [
                (1 if (weight := weights[name]) is None else weight, message)
                for name, message in latest.items()
            ]
        else:
            pairs = [(1, message) for _, message in heard]
        rates = {}
        for function in dict.fromkeys(f for _, message in pairs for f in message.rates):
            naming = [(w, m.rates[function]) for w, m in pairs if function in m.rates]
            total = sum(weight for weight, _ in naming)
            if total:
                rates[function] = sum(weight * rate for weight, rate in naming) / total
        return rates
