"""The control lines of a specification, at the place of the first relationship they replace."""

from collections.abc import Sequence
from typing import NamedTuple, TypeAlias

from clingo import Function, String, Symbol, SymbolType

from mars_asp.model.declarations import Control, node_kind
from mars_asp.reasoning.synthesis.draft import Draft

#: What a controller or an arbiter says: base(Controller) or run(List), as the rules write it.
Signal: TypeAlias = Symbol


class _Feed(NamedTuple):
    """One receiver of a signal and whose line it is.

    `receiver` is a module's name, inherited(Module) or an arbiter's signal; `number` the
    relationship that gives priority and hold, where there is one.
    """

    place: int
    signal: Signal
    receiver: Symbol
    number: int | None


class ControlLines:
    """Writes the line of each receiver once."""

    def __init__(self, draft: Draft) -> None:
        """Index what feeds what."""
        self._draft = draft
        self._splitters = {signal for (signal,) in draft.rows("control_splitter", 1)}
        self._arbiters = {Function("run", [run]): run for (run,) in draft.rows("arbiter", 1)}
        self._full = {module: signal for module, signal in draft.rows("receives", 2)}
        self._into: dict[Symbol, list[_Feed]] = {}
        self._out_of: dict[Signal, list[_Feed]] = {}
        self._providers: dict[Symbol, list[Symbol]] = {}
        self._index()
        self._allocation = {
            Function("inherited", [module]): self._stated(number.number).allocation
            for number, module in draft.rows("leads", 2)
        }
        # A specification that is read again has its InheritanceNodes already.
        self._allocation |= {
            String(stated.controlled): stated.allocation
            for stated in draft.relationships.values()
            if isinstance(stated, Control) and node_kind(stated.controlled) == "inheritance_node"
        }
        self._named: dict[Signal, str] = {}
        self._written: set[_Feed] = set()
        self._opened: set[Symbol] = set()

    def _index(self) -> None:
        draft = self._draft
        moved = {(number.number, module) for number, module in draft.rows("moved_hold", 2)}
        heard: dict[tuple[int, Symbol], Symbol] = {}
        for number, module, controller in sorted(draft.rows("hears", 3), key=self._by_row):
            place = draft.place[number.number]
            heard[number.number, module] = controller
            if _is_inherited(controller):
                self._providers.setdefault(controller, []).append(module)
            signal = self._full.get(module)
            if signal in self._arbiters:
                if module not in self._into:
                    self._add(_Feed(place, signal, module, None))
                continue
            # What an arbiter of its provider states, the line into an InheritanceNode does not.
            silent = _is_inherited(controller) or (number.number, module) in moved
            stated = None if silent else number.number
            self._add(_Feed(place, _base(controller), module, stated))
        for run, module, _, number in draft.rows("arbitrates", 4):
            signal = _base(heard[number.number, module])
            self._join(Function("run", [run]), number.number, signal)
        for run, inner, number in draft.rows("stands_for", 3):
            self._join(Function("run", [run]), number.number, Function("run", [inner]))

    def _by_row(self, row: Sequence[Symbol]) -> tuple[int, Symbol]:
        return self._draft.place[row[0].number], row[1]

    def _join(self, run: Signal, number: int, signal: Signal) -> None:
        self._add(_Feed(self._draft.place[number], signal, run, number))

    def _add(self, feed: _Feed) -> None:
        self._into.setdefault(feed.receiver, []).append(feed)
        self._out_of.setdefault(feed.signal, []).append(feed)

    def write(self, control: Control) -> None:
        """Write the lines into a relationship's module, and all that leads there.

        Where an InheritanceNode stands for the module, its providers' lines follow its input.
        """
        module = String(control.controlled)
        inherited = Function("inherited", [module])
        for receiver in (module, inherited, *self._providers.get(inherited, ())):
            self._write_into(receiver)

    def _write_into(self, receiver: Symbol) -> None:
        stack = sorted(self._into.pop(receiver, ()), reverse=True, key=_by_place)
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
        receiver = self._name(feed.receiver)
        priority = hold = None
        if feed.number is not None:
            stated = self._stated(feed.number)
            ignored = stated.listed and draft.architecture == "flat"
            priority = None if ignored else stated.priority
            hold = None if self._is_arbitrated(feed.signal) else stated.hold_ms
        allocation = self._allocation.get(feed.receiver)
        draft.lines.append(Control(receiver, feeder, draft.span, priority, hold, allocation))

    def _stated(self, number: int) -> Control:
        stated = self._draft.relationships[number]
        assert isinstance(stated, Control)
        return stated

    def _is_arbitrated(self, signal: Signal) -> bool:
        """Say whether an arbiter speaks in a signal: then its inputs have the holds."""
        if signal in self._arbiters:
            return True
        return self._full.get(signal.arguments[0]) in self._arbiters and _is_inherited(
            signal.arguments[0]
        )

    def _name(self, receiver: Symbol) -> str:
        if receiver in self._arbiters:
            return self._arbiter(receiver)
        return self._module(receiver)

    def _module(self, module: Symbol) -> str:
        """Return the name of a module, or of the node that stands for what it inherits."""
        if _is_inherited(module):
            (stands_for,) = module.arguments
            term = f"inheritance_node({stands_for})"
            return self._draft.node("inheritance_node", term, stands_for=stands_for.string)
        return module.string

    def _arbiter(self, signal: Signal) -> str:
        # The text of a run is as long as the run, and each of its lines asks.
        known = self._named.get(signal)
        if known is None:
            term = f"arbiter({self._arbiters[signal]})"
            known = self._named[signal] = self._draft.node("arbitration_node", term)
        return known

    def _producer(self, signal: Signal) -> str:
        if signal in self._arbiters:
            return self._arbiter(signal)
        return self._module(signal.arguments[0])


def _by_place(feed: _Feed) -> int:
    return feed.place


def _base(controller: Symbol) -> Signal:
    return Function("base", [controller])


def _is_inherited(module: Symbol) -> bool:
    return module.type == SymbolType.Function
