"""Whether a specification realises gates, resets, locks, limits and strategies, from the text.

Clauses 1, 2, 4 and 6 to 8 of modules without a description, so without representations and
delivery modes. Nothing here uses clingo or reads `rules/`.
"""

from collections import Counter
from collections.abc import Iterable, Iterator
from typing import NamedTuple, TypeAlias

from mars_asp.model.declarations import (
    Configuration,
    Control,
    Data,
    Gating,
    Limit,
    Lock,
    Reset,
    Strategy,
    node_kind,
)
from mars_asp.model.ports import input_position
from tests.support.realises import UnsaidError, ViolationError, refuse

SPLITTERS = ("data_splitter", "control_splitter")


class Output(NamedTuple):
    """An output of a module or node: its sort, `data` or `command`, and its port."""

    name: str
    sort: str
    port: str | None = None


#: What triggers a Gate: the sign, the output and the milliseconds.
Triggers: TypeAlias = frozenset[tuple[str, Output, int]]
SideLine: TypeAlias = Gating | Reset | Lock | Limit


class Sorts:
    """Which output the lines of a file mean; `whole` decides about modules."""

    def __init__(self, lines: Iterable[object], whole: "Sorts | None" = None) -> None:
        lines = list(lines)
        self.whole = whole
        self.commanding = {k.controller for k in lines if isinstance(k, Control)}
        self.feeding = {d.source for d in lines if isinstance(d, Data)}
        self.commanded = {k.controlled for k in lines if isinstance(k, Control)}

    def sort(self, name: str) -> str | None:
        kind = None if self.whole is None else node_kind(name)
        if kind == "gate_node":
            return "command" if name in self.commanded else "data"
        if kind is not None:
            return "data" if kind.startswith("data") else "command"
        if self.whole is not None:
            return self.whole.sort(name)
        if name in self.commanding:
            return "command"
        return "data" if name in self.feeding else None

    def trigger(self, line: SideLine) -> Output:
        if isinstance(line, Gating):
            name, port = line.trigger, line.trigger_port
        else:
            name, port = line.source, line.source_port
        if port is not None:
            return Output(name, "data", port)
        other = "command" if isinstance(line, Limit) else "data"
        if isinstance(line, Gating):
            other = "data" if line.port is not None else self.sort(line.gated) or "data"
        return Output(name, self.sort(name) or other)


def weight_of(line: Control) -> int:
    """Return the weight of a controller under `weighted`: its number, or 1."""
    return 1 if line.priority is None or line.listed else line.priority


def choice_of(line: Strategy | None, configuration: Configuration) -> tuple[str, int | None]:
    """Return how an arbiter chooses, by a line or by the file, and the period of its mean."""
    strategy = configuration.architecture if line is None else line.strategy
    if strategy not in ("flat", "weighted"):
        return strategy, None
    own = None if line is None else line.period_ms
    return strategy, own or configuration.period_ms or 100


def gated_end(line: Gating, sorts: Sorts, inputs: set[tuple[str, str]]) -> Output:
    """Return the gated output; that of an input has the sort `input`."""
    if line.port is not None:
        sort = "input" if (line.gated, line.port) in inputs else "data"
        return Output(line.gated, sort, line.port)
    return Output(line.gated, sorts.sort(line.gated) or sorts.trigger(line).sort)


def subsumption_violation(specification: Configuration, configuration: Configuration) -> str | None:
    """Return why a specification does not realise a configuration, `None` where it does.

    Raises:
        UnsaidError: the text does not decide.
    """
    if len(set(specification.relationships)) < len(specification.relationships):
        raise UnsaidError("a line that stands twice")
    try:
        _Judge(specification, configuration).judge()
    except ViolationError as error:
        return str(error)
    return None


class _Judge:
    def __init__(self, specification: Configuration, configuration: Configuration) -> None:
        self.names = {name.text for name in configuration.modules}
        self.lines = specification.relationships
        self.named = {name.text for name in specification.modules}
        declared = configuration.relationships
        self.configuration = configuration
        self.meant = Sorts(declared)
        self.sorts = Sorts(self.lines, self.meant)
        self.declared = declared
        inputs = {(d.client, d.client_port) for d in declared if isinstance(d, Data)}
        outputs = {(d.source, d.source_port) for d in declared if isinstance(d, Data)}
        self.inputs = {(m, p) for m, p in inputs - outputs if p is not None}
        self.gates: dict[Output, Triggers] = {}
        longest: dict[tuple[Output, str, Output], int] = {}
        for line in declared:
            if isinstance(line, Gating):
                key = gated_end(line, self.meant, self.inputs), line.sign, self.meant.trigger(line)
                longest[key] = max(line.ms, longest.get(key, 0))
        for (end, sign, trigger), ms in longest.items():
            self.gates[end] = self.gates.get(end, frozenset()) | {(sign, trigger, ms)}
        self.used: set[str] = set()

    def kind(self, name: str) -> str | None:
        return None if name in self.names else node_kind(name)

    def judge(self) -> None:
        self.structure()
        self.data()
        self.sides()
        self.control()
        ends = {
            name
            for line in self.lines
            if isinstance(line, Data | Control)
            for name in (
                (line.client, line.source)
                if isinstance(line, Data)
                else (line.controlled, line.controller)
            )
        }
        if idle := {name for name in self.named | ends if self.kind(name)} - self.used:
            raise UnsaidError(f"{sorted(idle)} on no way")

    # ---- Structure

    def outputs(self) -> Iterator[Output]:
        """Yield the output that each line takes."""
        for line in self.lines:
            if isinstance(line, Data):
                yield Output(line.source, "data", line.source_port)
            elif isinstance(line, Control):
                yield Output(line.controller, "command")
            elif isinstance(line, SideLine):
                yield self.sorts.trigger(line)

    def structure(self) -> None:
        for output, count in Counter(self.outputs()).items():
            if count > 1 and self.kind(output.name) not in SPLITTERS:
                refuse(1, f"{output} has {count} receivers")
        fed = Counter(d.client for d in self.lines if isinstance(d, Data))
        led = Counter(k.controlled for k in self.lines if isinstance(k, Control))
        for name in fed.keys() | led.keys():
            kind, count = self.kind(name), fed[name] + led[name]
            if kind in ("data_splitter", "data_transformer") and (led[name] or count > 1):
                refuse(1, f"{name} takes {count}")
            if kind == "control_splitter" and (fed[name] or count > 1):
                refuse(1, f"{name} takes {count}")
            if kind == "gate_node" and count != 1:
                refuse(1, f"{name} takes {count}")
            if kind == "arbitration_node" and fed[name]:
                refuse(1, f"{name} takes data")
            if kind is None and led[name] > 1:
                refuse(1, f"{name} has several controllers")
        for line in self.lines:
            if isinstance(line, Gating) and self.kind(line.gated) != "gate_node":
                refuse(6, f"{line.gated} is no Gate")
            if isinstance(line, Lock | Limit | Strategy):
                if self.kind(line.controlled) != "arbitration_node":
                    refuse(7, f"{line.controlled} is no arbiter")

    def back(self, output: Output) -> tuple[Output, list[str]]:
        """Return the output where a line begins, and the nodes on the way, the first one first."""
        way: list[str] = []
        while (kind := self.kind(output.name)) is not None:
            if kind == "arbitration_node" or output.name in way:
                return output, way[::-1]
            way.append(output.name)
            before = [
                Output(line.source, "data", line.source_port)
                if isinstance(line, Data)
                else Output(line.controller, "command")
                for line in self.lines
                if (isinstance(line, Data) and line.client == output.name)
                or (isinstance(line, Control) and line.controlled == output.name)
            ]
            if not before:
                refuse(2, f"{output.name} takes nothing")
            output = before[0]
        return output, way[::-1]

    def check_way(self, origin: Output, way: list[str], into: Output | None, sign: str) -> None:
        """Refuse a way that does not pass the Gates of its origin and of the input `into`."""
        self.used |= set(way)
        if self.kind(origin.name) is not None:
            refuse(6, f"{origin} begins a way")
        gates = [name for name in way if self.kind(name) == "gate_node"]
        wanted = [self.gates[end] for end in (origin, into) if end in self.gates]
        if len(gates) != len(wanted):
            refuse(6, f"{len(gates)} Gates for {len(wanted)} from {origin} to {into}")
        for gate, triggers in zip(gates, wanted, strict=True):
            if self.triggers(gate) != triggers:
                refuse(6, f"{gate} has {self.triggers(gate)}")
        if origin in self.gates and any(
            self.kind(name) in SPLITTERS for name in way[: way.index(gates[0])]
        ):
            refuse(6, f"{gates[0]} behind a splitter")
        for name in way:
            if self.kind(name) == "data_transformer":
                raise UnsaidError(f"a conversion of what is unknown for {sign}")

    def triggers(self, gate: str) -> Triggers:
        found = set()
        for line in self.lines:
            if isinstance(line, Gating) and line.gated == gate:
                origin, _ = self.back(self.sorts.trigger(line))
                found.add((line.sign, origin, line.ms))
        return frozenset(found)

    # ---- Clauses 2, 6 and 8

    def data(self) -> None:
        wanted = {
            (Output(d.source, "data", d.source_port), d.client, d.client_port)
            for d in self.declared
            if isinstance(d, Data)
        }
        found: Counter[tuple[Output, str, str | None]] = Counter()
        for line in self.lines:
            if isinstance(line, Data) and self.kind(line.client) is None:
                origin, way = self.back(Output(line.source, "data", line.source_port))
                if origin.sort != "data":
                    refuse(2, f"commands of {origin} for {line.client}")
                # Inputs of clients that nothing describes may be named by their positions.
                is_open = (origin, line.client, None) in wanted
                port = (
                    None if is_open and input_position(line.client_port or "") else line.client_port
                )
                found[origin, line.client, port] += 1
                if (origin, line.client, port) in wanted:
                    into = Output(line.client, "input", port)
                    self.check_way(origin, way, into, "data")
        if found != Counter(wanted):
            refuse(2, f"{found} for {wanted}")

    def sides(self) -> None:
        """Judge the ways of triggers, resets, locks and limits."""
        for line in self.lines:
            if isinstance(line, SideLine):
                origin, way = self.back(self.sorts.trigger(line))
                self.check_way(origin, way, None, type(line).__name__)
        wanted = {(r.module, self.meant.trigger(r)) for r in self.declared if isinstance(r, Reset)}
        found = [
            (line.module, self.back(self.sorts.trigger(line))[0])
            for line in self.lines
            if isinstance(line, Reset)
        ]
        if Counter(found) != Counter(wanted):
            refuse(8, f"{found} for {wanted}")

    # ---- Clauses 2, 4 and 7

    def control(self) -> None:
        wanted: dict[str, dict[str, tuple[int, object]]] = {}
        for line in self.declared:
            if isinstance(line, Control):
                mine = wanted.setdefault(line.controlled, {})
                if line.controller in mine:
                    raise UnsaidError("a pair is declared twice")
                mine[line.controller] = (line.priority or 0, line.hold_ms)
        led = {k.controlled for k in self.lines if isinstance(k, Control)}
        for module in {name for name in led if self.kind(name) is None} | wanted.keys():
            heads = [k for k in self.lines if isinstance(k, Control) and k.controlled == module]
            if not heads or module not in wanted:
                refuse(2, f"control of {module}")
            ways = list(self.leaves(heads[0], ()))
            if Counter(name for name, _ in ways) != Counter(list(wanted[module])):
                refuse(2, f"{ways} for {wanted[module]} at {module}")
            self.bounds(module, wanted[module], dict(ways))

    def leaves(
        self, line: Control, trail: tuple[Control, ...]
    ) -> Iterator[tuple[str, tuple[Control, ...]]]:
        """Yield each controller with the lines into arbiters on its way, from the module on."""
        origin, way = self.back(Output(line.controller, "command"))
        if self.kind(origin.name) is None:
            if origin.sort != "command":
                refuse(2, f"data of {origin} as commands")
            self.check_way(origin, way, None, "commands")
            yield origin.name, (*trail, *(() if trail else (line,)))
            return
        self.used |= {origin.name, *way}
        if any(self.kind(name) == "gate_node" for name in way):
            refuse(6, f"a Gate behind {origin.name}")
        if any(each.controlled == origin.name for each in trail):
            refuse(2, f"a circle through {origin.name}")
        for inner in self.lines:
            if isinstance(inner, Control) and inner.controlled == origin.name:
                yield from self.leaves(inner, (*trail, inner))

    def bounds(
        self,
        module: str,
        wanted: dict[str, tuple[int, object]],
        ways: dict[str, tuple[Control, ...]],
    ) -> None:
        locks = {
            (self.meant.trigger(line), line.priority, line.hold_ms)
            for line in self.declared
            if isinstance(line, Lock) and line.controlled == module
        }
        limits = {
            (self.meant.trigger(line), line.hold_ms)
            for line in self.declared
            if isinstance(line, Limit) and line.controlled == module
        }
        strategies = {
            choice_of(line, self.configuration)
            for line in self.declared
            if isinstance(line, Strategy) and line.controlled == module
        }
        pairs = [(origin, "lock") for origin, _, _ in locks]
        if len(strategies) > 1 or len(pairs) != len(set(pairs)):
            raise UnsaidError(f"several lines of one sort for {module}")
        inside = {
            name: [k for k in way if self.kind(k.controlled) == "arbitration_node"]
            for name, way in ways.items()
        }
        needs_one = len(wanted) > 1 or locks or limits or strategies
        lasts = {way[0].controlled if way else None for way in inside.values()}
        if len(lasts) > 1 or (needs_one and None in lasts):
            refuse(7, f"{lasts} before {module}")
        (last,) = lasts
        choice = next(iter(strategies), choice_of(None, self.configuration))
        strategy = choice[0]
        if last is None:
            if {way[0].hold_ms for way in ways.values()} != {hold for _, hold in wanted.values()}:
                raise UnsaidError(f"a hold where nothing arbitrates for {module}")
            return
        self.at_arbiter(last, locks, limits, choice)
        for name, way in inside.items():
            holds = [k.hold_ms for k in way]
            if any(hold is not None for hold in holds[:-1]):
                raise UnsaidError("a hold behind an arbiter")
            if holds[-1] != wanted[name][1]:
                refuse(2, f"the hold of {name} at {module}")
            if strategy != "hierarchical" and len(way) > 1:
                refuse(7, f"{name} reaches {module} through {way}")
            self.at_runs(way[1:], choice)
            if not needs_one and len(way) > 1:
                raise UnsaidError("an arbiter of one controller")
        if strategy == "weighted":
            weights = {
                line.controller: weight_of(line)
                for line in self.declared
                if isinstance(line, Control) and line.controlled == module
            }
            for name, way in inside.items():
                if weight_of(way[0]) != weights[name]:
                    refuse(7, f"{name} weighs {weight_of(way[0])} at {module}")
        if strategy == "hierarchical":
            self.in_order(module, wanted, inside)
            for _, priority, _ in locks:
                self.lock(module, priority, wanted, inside)

    def at_arbiter(
        self,
        last: str,
        locks: set[tuple[Output, int | None, int | None]],
        limits: set[tuple[Output, int | None]],
        choice: tuple[str, int | None],
    ) -> None:
        """Compare the bounds and strategy that an arbiter has with the wanted ones."""
        mine = [line for line in self.lines if getattr(line, "controlled", None) == last]
        has_locks = Counter(
            (self.back(self.sorts.trigger(line))[0], line.priority, line.hold_ms)
            for line in mine
            if isinstance(line, Lock)
        )
        has_limits = Counter(
            (self.back(self.sorts.trigger(line))[0], line.hold_ms)
            for line in mine
            if isinstance(line, Limit)
        )
        if (has_locks, has_limits) != (Counter(locks), Counter(limits)):
            refuse(7, f"{last} has {has_locks} {has_limits}")
        if self.choice_at(last) != choice:
            refuse(7, f"{last} chooses by {self.choice_at(last)}")

    def at_runs(self, way: list[Control], choice: tuple[str, int | None]) -> None:
        """Refuse a run that chooses otherwise than the last arbiter, or has bounds."""
        for run in (line.controlled for line in way):
            if self.choice_at(run) != choice:
                refuse(7, f"{run} chooses by {self.choice_at(run)}")
            if any(isinstance(s, Lock | Limit) and s.controlled == run for s in self.lines):
                refuse(7, f"{run} bounds what it hands on")

    def choice_at(self, arbiter: str) -> tuple[str, int | None]:
        lines = [s for s in self.lines if isinstance(s, Strategy) and s.controlled == arbiter]
        choices = {choice_of(each, self.configuration) for each in lines}
        choices |= set() if lines else {choice_of(None, self.configuration)}
        if len(choices) > 1:
            raise UnsaidError(f"several strategies of {arbiter}")
        return choices.pop()

    def in_order(
        self,
        module: str,
        wanted: dict[str, tuple[int, object]],
        ways: dict[str, list[Control]],
    ) -> None:
        for one, way in ways.items():
            for other, beside in ways.items():
                if one >= other:
                    continue
                a, b = next((k, o) for k, o in zip(way, beside, strict=False) if k is not o)
                declared = wanted[one][0] - wanted[other][0]
                entered = (a.priority or 0) - (b.priority or 0)
                if (declared > 0) - (declared < 0) != (entered > 0) - (entered < 0):
                    refuse(4, f"{one} and {other} at {module}")

    def lock(
        self,
        module: str,
        priority: int | None,
        wanted: dict[str, tuple[int, object]],
        ways: dict[str, list[Control]],
    ) -> None:
        """Refuse a run that a lock parts, and inputs on the wrong side of it."""
        if priority is None:
            return
        below: dict[Control, set[bool]] = {}
        for name, way in ways.items():
            below.setdefault(way[0], set()).add(wanted[name][0] < priority)
        for line, sides in below.items():
            if len(sides) > 1:
                refuse(7, f"the lock below {priority} of {module} parts {line.controller}")
            if sides != {(line.priority or 0) < priority}:
                refuse(7, f"{line.controller} is on another side of {priority} at {module}")
