"""The least cost of a specification with gates, locks, limits and resets, by exhaustive search.

From the text alone: every representation that passes a Gate, every sharing of the Gates of inputs,
every tree of splitters and transformers and every choice of arbiters is tried. It is exponential,
so it is for small configurations, of modules that inherit nothing and ask for no delivery mode.
"""

import itertools
from collections import Counter
from collections.abc import Hashable, Iterator, Mapping, Sequence
from typing import NamedTuple, TypeAlias

from mars_asp.model.declarations import (
    Configuration,
    Control,
    Data,
    Gating,
    Limit,
    Lock,
    Module,
    Reset,
    Strategy,
)
from tests.support.exhaustive import (
    NOTHING,
    Client,
    Converter,
    Cost,
    Order,
    Voice,
    _Tree,
    add,
    partitions,
    parts,
    reach,
    voices,
)
from tests.support.subsumes import Output, Sorts, Triggers, choice_of, gated_end

BOOL = "bool"


class Needs(NamedTuple):
    """What a receiver accepts (`None`: all), and whether an abstract transformer may make it."""

    accepts: frozenset[str] | None
    abstract: bool = True


class Signal(NamedTuple):
    """What a module obeys: its controllers in order, and the bounds of its last arbiter.

    `below` has for each lock the controllers that it stops; `bounds` is None without any.
    """

    order: Order
    below: tuple[frozenset[Voice], ...] = ()
    bounds: Hashable = None
    ordered: bool = True


#: A Gate before inputs: its source, its triggers, and the links after it.
Entry: TypeAlias = tuple[Output, Triggers, tuple[int, ...]]


def least_cost_with_sides(
    configuration: Configuration, modules: Mapping[str, Module]
) -> Cost | None:
    """Return the least cost; None where nothing realises the configuration."""
    search = _Search(configuration, modules)
    found = list(search.costs())
    return min(found) if found else None


class _Search:
    def __init__(self, configuration: Configuration, modules: Mapping[str, Module]) -> None:
        known = {**modules, **{m.name: m for m in configuration.declared}}
        self.lines = list(dict.fromkeys(configuration.relationships))
        self.sorts = Sorts(self.lines)
        self.configuration = configuration
        self.flat = configuration.architecture == "flat"
        self.known = known
        self.converters: list[Converter] = [
            (str(s.inputs[0]), str(s.output), s.cost, (module.name, index))
            for module in known.values()
            for index, s in enumerate(module.services)
            if s.kind == "Converts"
        ]
        links = {
            (Output(d.source, "data", d.source_port), d.client, d.client_port): d
            for d in self.lines
            if isinstance(d, Data)
        }
        self.links = list(links)
        clients = {(client, port) for _, client, port in self.links}
        outputs = {(source.name, source.port) for source, _, _ in self.links}
        inputs = {(m, p) for m, p in clients - outputs if p is not None}
        longest: dict[tuple[Output, str, Output], int] = {}
        for line in self.lines:
            if isinstance(line, Gating):
                key = gated_end(line, self.sorts, inputs), line.sign, self.sorts.trigger(line)
                longest[key] = max(line.ms, longest.get(key, 0))
        self.gates: dict[Output, Triggers] = {}
        for (end, sign, trigger), ms in longest.items():
            self.gates[end] = self.gates.get(end, frozenset()) | {(sign, trigger, ms)}

    def delivered(self, output: Output) -> str | None:
        services = self.known[output.name].services if output.name in self.known else ()
        given = [s.output for s in services if s.kind in ("Sense", "DataOut")]
        return given[0] if len(given) == 1 else None

    def accepted(self, client: str) -> frozenset[str] | None:
        services = self.known[client].services if client in self.known else ()
        taken = [each for s in services if s.kind != "Converts" for each in s.inputs]
        return None if not taken or None in taken else frozenset(map(str, taken))

    def costs(self) -> Iterator[Cost]:
        """Yield the cost of the cheapest wiring for each choice about Gates."""
        signals = self.signals()
        groups: dict[tuple[Output, Triggers], list[int]] = {}
        for number, (source, client, port) in enumerate(self.links):
            end = Output(client, "input", port)
            if end in self.gates:
                groups.setdefault((source, self.gates[end]), []).append(number)
        shared = [
            [
                [(source, triggers, tuple(c.number for c in block)) for block in blocks]
                for blocks in partitions(tuple(_numbered(numbers)))
            ]
            for (source, triggers), numbers in groups.items()
        ]
        for choice in itertools.product(*shared):
            entries = [each for some in choice for each in some]
            lines: list[tuple[Output | Entry, Output]] = [
                *((end, end) for end in self.gates if end.sort == "data"),
                *((each, each[0]) for each in entries),
            ]
            options = [self.passing(source) for _, source in lines]
            for passed in itertools.product(*options):
                chosen = {key: p for (key, _), p in zip(lines, passed, strict=True)}
                cost = self.cost(entries, chosen, signals)
                if cost is not None:
                    yield cost

    def passing(self, source: Output) -> Sequence[str | None]:
        own = self.delivered(source)
        return [None] if own is None else sorted(reach(own, self.converters))

    def cost(
        self,
        entries: Sequence[Entry],
        passed: Mapping[Output | Entry, str | None],
        signals: Mapping[str, Signal],
    ) -> Cost | None:
        receivers = self.receivers(entries, passed, signals)
        heard = {o.name: len(needs) for o, needs in receivers.items() if o.sort == "command"}
        gated = sum(1 for end in self.gates if end.sort == "command")
        costs: list[Cost | None] = [least_control(signals, heard), (gated, 0, gated)]
        for entry in entries:
            needs = [Needs(self.accepted(self.links[number][1])) for number in entry[2]]
            costs += [(1, 0, 0), self.tree(passed[entry], needs)]
        for output in receivers.keys() | {end for end in self.gates if end.sort == "data"}:
            if output.sort == "command":
                continue
            root = self.delivered(output)
            if output in self.gates:
                into = Needs(_exactly(passed[output]), abstract=False)
                costs += [(1, 0, 0), self.tree(root, [into])]
                root = passed[output]
            costs.append(self.tree(root, receivers.get(output, [])))
        known = [cost for cost in costs if cost is not None]
        return add(*known) if len(known) == len(costs) else None

    def receivers(
        self,
        entries: Sequence[Entry],
        passed: Mapping[Output | Entry, str | None],
        signals: Mapping[str, Signal],
    ) -> dict[Output, list[Needs]]:
        """Return the receivers of each output: clients, Gates and side lines."""
        found: dict[Output, list[Needs]] = {}

        def trigger(triggers: Triggers, representation: str | None) -> None:
            for sign, output, _ in triggers:
                wanted = _exactly(representation) if sign == "suppress" else None
                found.setdefault(output, []).append(Needs(wanted))

        after_gates = {number for _, _, numbers in entries for number in numbers}
        for number, (source, client, _) in enumerate(self.links):
            if number not in after_gates:
                found.setdefault(source, []).append(Needs(self.accepted(client)))
        for entry in entries:
            source, triggers, _ = entry
            found.setdefault(source, []).append(Needs(_exactly(passed[entry]), abstract=False))
            trigger(triggers, passed[entry])
        for end, triggers in self.gates.items():
            if end.sort != "input":
                trigger(triggers, passed.get(end))
        for line in self.lines:
            if isinstance(line, Reset):
                found.setdefault(self.sorts.trigger(line), []).append(Needs(None))
        for signal in set(signals.values()):
            module = next(name for name, each in signals.items() if each == signal)
            for bound in self.bounds_of(module):
                wanted = frozenset({BOOL}) if isinstance(bound, Lock) else None
                found.setdefault(self.sorts.trigger(bound), []).append(Needs(wanted))
        return found

    def tree(self, representation: str | None, needs: Sequence[Needs]) -> Cost | None:
        if not needs:
            return NOTHING
        clients = []
        for number, each in enumerate(needs):
            far = (
                representation is not None
                and each.accepts is not None
                and not each.accepts & reach(representation, self.converters)
            )
            accepts = each.accepts
            if far and not each.abstract:
                return None
            clients.append(Client(str(number), number, accepts, "direct", far))
        found = _Tree(representation, self.converters).cheapest(tuple(clients))
        return None if found is None else found[0]

    # ---- Control

    def bounds_of(self, module: str) -> list[Lock | Limit]:
        found: dict[Hashable, Lock | Limit] = {}
        for line in self.lines:
            if isinstance(line, Lock | Limit) and line.controlled == module:
                found[type(line), self.sorts.trigger(line)] = line
        return list(found.values())

    def signals(self) -> dict[str, Signal]:
        """Return the signal that each controlled module obeys."""
        found: dict[str, Signal] = {}
        control: dict[str, dict[str, Control]] = {}
        for line in self.lines:
            if isinstance(line, Control):
                control.setdefault(line.controlled, {})[line.controller] = line
        for module, lines in control.items():
            strategy_lines = [
                s for s in self.lines if isinstance(s, Strategy) and s.controlled == module
            ]
            named = strategy_lines[0].strategy if strategy_lines else None
            strategy = named or ("flat" if self.flat else "hierarchical")
            ordered = strategy == "hierarchical"
            default = choice_of(None, self.configuration)
            choices = [choice_of(each, self.configuration) for each in strategy_lines]
            levels: dict[int, set[Voice]] = {}
            ranks: dict[Voice, int] = {}
            for line in lines.values():
                voice = line.controller, line.hold_ms
                ranks[voice] = line.priority or 0
                levels.setdefault(ranks[voice] if ordered else 0, set()).add(voice)
            order = tuple(frozenset(levels[rank]) for rank in sorted(levels))
            bounds: list[Hashable] = []
            below = []
            for line in self.bounds_of(module):
                bounds.append(
                    (type(line), self.sorts.trigger(line), line.hold_ms)
                    + ((line.priority,) if isinstance(line, Lock) else ())
                )
                if isinstance(line, Lock) and line.priority is not None and ordered:
                    below.append(frozenset(v for v, r in ranks.items() if r < line.priority))
            # An order is known by its levels, the strategy of the file by no line.
            bounds += [choice for choice in choices if choice != default and not ordered]
            if strategy == "weighted":
                bounds.append(frozenset(ranks.items()))
            lone = bool(strategy_lines) and len(ranks) == 1
            key = frozenset(bounds) if bounds or lone else None
            found[module] = Signal(order, tuple(sorted(below, key=repr)), key, ordered)
        return found


def _exactly(representation: str | None) -> frozenset[str] | None:
    return None if representation is None else frozenset({representation})


def _numbered(numbers: Sequence[int]) -> Iterator[Client]:
    return (Client(str(n), n, None, "direct", False) for n in numbers)


def least_control(signals: Mapping[str, Signal], heard: Mapping[str, int]) -> Cost:
    """Return the least cost of all arbiters; `heard` counts the side lines of controllers."""
    needed = {s for s in signals.values() if len(voices(s.order)) > 1 or s.bounds is not None}
    inner = {Signal(part) for signal in needed for part in inner_parts(signal)} - needed
    best: Cost | None = None
    for size in range(len(inner) + 1):
        if best is not None and len(needed) + size > best[0]:
            break
        for chosen in itertools.combinations(sorted(inner, key=repr), size):
            arbiters = sorted(needed | set(chosen), key=repr)
            for cost in wired(arbiters, signals, heard):
                best = cost if best is None or cost < best else best
    assert best is not None
    return best


def inner_parts(signal: Signal) -> Iterator[Order]:
    """Yield the runs that may be arbitrated before the last arbiter of a module."""
    if not signal.ordered:
        return
    every = list(parts(signal.order))
    if signal.bounds is not None and len(voices(signal.order)) > 1:
        every.append(signal.order)
    for part in every:
        inside = voices(part)
        if all(inside <= low or not inside & low for low in signal.below):
            yield part


def wired(
    arbiters: Sequence[Signal], signals: Mapping[str, Signal], heard: Mapping[str, int]
) -> Iterator[Cost]:
    """Yield the cost of every way to feed arbiters from controllers and from each other."""
    choices = []
    for signal in arbiters:
        allowed = set(inner_parts(signal))
        inner = [
            a
            for a in arbiters
            if a.ordered and a.bounds is None and a != signal and a.order in allowed
        ]
        choices.append(
            [
                taken
                for size in range(len(inner) + 1)
                for taken in itertools.combinations(inner, size)
                if sum(len(voices(t.order)) for t in taken)
                == len(frozenset().union(*(voices(t.order) for t in taken)))
            ]
        )
    for nesting in itertools.product(*choices):
        receivers: Counter[Hashable] = Counter(heard)
        lines = sum(heard.values())
        for signal in signals.values():
            only = len(voices(signal.order)) == 1 and signal.bounds is None
            receivers[next(iter(voices(signal.order)))[0] if only else signal] += 1
            lines += 1
        for signal, taken in zip(arbiters, nesting, strict=True):
            covered = frozenset().union(*(voices(t.order) for t in taken))
            for each in (*taken, *(name for name, _ in voices(signal.order) - covered)):
                receivers[each] += 1
                lines += 1
        if any(arbiter not in receivers for arbiter in arbiters):
            continue
        splitters = sum(count > 1 for count in receivers.values())
        yield (len(arbiters) + splitters, 0, lines + splitters)
