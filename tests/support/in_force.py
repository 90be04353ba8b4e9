"""The winning controller of each module at each instant, from section 7 of the reference alone.

It looks at declared priorities and holds, never at a specification's nodes. Times are whole
milliseconds; no two controllers send in one instant under hierarchical control.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import TypeAlias

from mars_asp.model.declarations import FOREVER, Configuration, Control, Module
from tests.support.exhaustive import STANDS_FOR, hearing, inheritance

#: The values that a controller sends for its one function, by time.
Script: TypeAlias = Mapping[int, float]
#: The commands of an effector, with their times; `None` is a stop.
Commands: TypeAlias = list[tuple[float, float | None]]
FOR_EVER = 10**9
WINDOW = 100


@dataclass(frozen=True)
class Command:
    """A message: its sender, its time, and the time until which it is in force."""

    controller: str
    sent: int
    until: Fraction


class Reading:
    """A configuration, the messages of its controllers, and their periods in ms."""

    def __init__(
        self,
        configuration: Configuration,
        scripts: Mapping[str, Script],
        periods: Mapping[str, int],
    ) -> None:
        modules: dict[str, Module] = {module.name: module for module in configuration.declared}
        self.scripts, self.periods = scripts, periods
        self.hierarchical = configuration.architecture == "hierarchical"
        self.window = configuration.period_ms or WINDOW
        self.heard: dict[str, list[Control]] = {}
        for line in hearing(configuration, inheritance(configuration, modules)):
            self.heard.setdefault(line.controlled, []).append(line)

    def commands_until(self, name: str, end: int) -> Commands:
        """Return the commands of a module up to an instant."""
        if not self.hierarchical:
            return [(time, value) for time, value in self.messages_to(name, end) if time <= end]
        entries: Commands = []
        last: Command | None = None
        for now in range(end + 1):
            winner = self.winner(name, now)
            if winner is not None and (last is None or winner.sent != last.sent):
                entries.append((now, self.scripts[winner.controller][winner.sent]))
            elif winner is None and last is not None:
                entries.append((now, None))
            last = winner
        return entries

    # ---- hierarchical ----

    def winner(self, name: str, now: int) -> Command | None:
        """Return the message of the highest priority in force, among equals the latest."""
        lines = self.heard[name]
        best: tuple[int, int, Command] | None = None
        for line in lines:
            declared = FOR_EVER if line.hold_ms == FOREVER else line.hold_ms
            hold = declared if self.arbitrated(name) else FOR_EVER
            command = self.latest(line.controller, hold, now)
            if command is not None and command.until > now:
                key = (line.priority or 0, command.sent, command)
                best = key if best is None or key[:2] > best[:2] else best
        return best[2] if best else None

    def arbitrated(self, name: str) -> bool:
        return len(self.heard[name]) > 1

    def latest(self, controller: str, hold: int | None, now: int) -> Command | None:
        """Return the last message of a controller, or the one that an InheritanceNode forwards."""
        if controller.startswith(STANDS_FOR):
            if self.arbitrated(controller):
                return self.winner(controller, now)
            (line,) = self.heard[controller]
            return self.latest(line.controller, hold, now)
        sent = max((time for time in self.scripts[controller] if time <= now), default=None)
        if sent is None:
            return None
        default = Fraction(5, 2) * self.periods[controller]
        return Command(controller, sent, sent + (default if hold is None else Fraction(hold)))

    # ---- flat ----

    def messages_to(self, name: str, end: int) -> list[tuple[float, float]]:
        """Return the messages that reach a module: those of a single controller, or means."""
        entries: list[tuple[float, float]] = [
            message
            for line in self.heard[name]
            for message in (
                self.messages_to(line.controller, end)
                if line.controller.startswith(STANDS_FOR)
                else self.scripts[line.controller].items()
            )
        ]
        if not self.arbitrated(name):
            return sorted(entries)
        means: list[tuple[float, float]] = []
        for close in range(self.window, end + 1, self.window):
            values = [
                value
                for time, value in entries
                if close - self.window < time <= close or (time == 0 and close == self.window)
            ]
            if values:
                means.append((close, sum(values) / len(values)))
        return means
