"""The control lines of a specification, at the place of the first relationship they replace."""

from typing import NamedTuple, TypeAlias

from clingo import Function, String, Symbol

from mars_asp.model import Control
from mars_asp.synthesis.draft import Draft

#: What a controller or an arbiter says: base(Controller) or run(List), as the rules write it.
Signal: TypeAlias = Symbol


class _Feed(NamedTuple):
    """One receiver of a signal: a module's name or an arbiter's run, and whose line it is.

    `number` is the relationship that gives priority and hold, where there is one.
    """

    place: int
    signal: Signal
    receiver: str | Symbol
    number: int | None


class ControlLines:
    """Writes the line of each receiver once."""

    def __init__(self, draft: Draft) -> None:
        """Index what feeds what."""
        self._draft = draft
        self._splitters = {signal for (signal,) in draft.rows("control_splitter", 1)}
        self._arbiters = {Function("run", [run]): run for (run,) in draft.rows("arbiter", 1)}
        self._into: dict[str | Symbol, list[_Feed]] = {}
        self._out_of: dict[Signal, list[_Feed]] = {}
        self._index_modules()
        for run, _, _, number in draft.rows("arbitrates", 4):
            self._join(Function("run", [run]), number.number, None)
        for run, inner, number in draft.rows("stands_for", 3):
            self._join(Function("run", [run]), number.number, Function("run", [inner]))
        self._written: set[_Feed] = set()
        self._opened: set[Signal] = set()

    def _index_modules(self) -> None:
        draft = self._draft
        signals = {module.string: signal for module, signal in draft.rows("full", 2)}
        # What repeats an earlier relationship says nothing new.
        repeated = {number.number for number, _ in draft.rows("repeats_command", 2)}
        for number, place in sorted(draft.place.items(), key=lambda item: item[1]):
            control = draft.relationships[number]
            if not isinstance(control, Control) or number in repeated:
                continue
            module = control.controlled
            signal = signals.get(module)
            if signal in self._arbiters:
                if module not in self._into:
                    self._add(_Feed(place, signal, module, None))
            else:
                self._add(_Feed(place, _base(control.controller), module, number))

    def _join(self, run: Signal, number: int, inner: Signal | None) -> None:
        control = self._draft.relationships[number]
        assert isinstance(control, Control)
        signal = inner or _base(control.controller)
        self._add(_Feed(self._draft.place[number], signal, run, number))

    def _add(self, feed: _Feed) -> None:
        self._into.setdefault(feed.receiver, []).append(feed)
        self._out_of.setdefault(feed.signal, []).append(feed)

    def write(self, control: Control) -> None:
        """Write the lines into a relationship's module, and all that leads there."""
        stack = sorted(self._into.pop(control.controlled, ()), reverse=True, key=_by_place)
        while stack:
            feed = stack.pop()
            if feed.signal in self._splitters:
                self._write_split(feed.signal)
            else:
                self._write_feed(feed)
            if feed.signal in self._arbiters and feed.signal not in self._opened:
                self._opened.add(feed.signal)
                stack += sorted(self._into[feed.signal], reverse=True, key=_by_place)

    def _write_split(self, signal: Signal) -> None:
        """Write a splitter's input and then all its outputs."""
        feeds = sorted(self._out_of[signal], key=_by_place)
        if feeds[0] in self._written:
            return
        draft = self._draft
        name = draft.node("control_splitter", f"control_splitter({signal})")
        draft.lines.append(Control(name, self._producer(signal), draft.span))
        for feed in feeds:
            self._write_feed(feed)

    def _write_feed(self, feed: _Feed) -> None:
        """Write one line; priority and hold are those of the relationship it stands for."""
        if feed in self._written:
            return
        self._written.add(feed)
        draft = self._draft
        feeder = (
            draft.node("control_splitter", f"control_splitter({feed.signal})")
            if feed.signal in self._splitters
            else self._producer(feed.signal)
        )
        receiver = feed.receiver if isinstance(feed.receiver, str) else self._arbiter(feed.receiver)
        priority = hold = None
        if feed.number is not None:
            stated = draft.relationships[feed.number]
            assert isinstance(stated, Control)
            priority = stated.priority
            hold = None if feed.signal in self._arbiters else stated.hold_ms
        draft.lines.append(Control(receiver, feeder, draft.span, priority, hold))

    def _arbiter(self, signal: Signal) -> str:
        return self._draft.node("arbitration_node", f"arbiter({self._arbiters[signal]})")

    def _producer(self, signal: Signal) -> str:
        if signal in self._arbiters:
            return self._arbiter(signal)
        return signal.arguments[0].string


def _by_place(feed: _Feed) -> int:
    return feed.place


def _base(controller: str) -> Signal:
    return Function("base", [String(controller)])
