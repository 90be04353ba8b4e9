"""The cost of a minimal specification by exhaustive search, from the text of the reference alone.

Nothing here uses clingo or reads `rules/`: every tree of DataSplitters and DataTransformers and
every choice of shared ArbitrationNodes is built, and the cheapest are kept. It is exponential, so
it is for small configurations. The inputs and outputs of InheritanceNodes follow from mounts.

`python -m tests.reasoning.synthesis.test_exhaustive HOW_MANY` compares it with `synthesise`
on random configurations.
"""

import itertools
from collections.abc import Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TypeAlias

from mars_asp.model.declarations import (
    Configuration,
    Control,
    Data,
    Hold,
    Mode,
    Module,
    Mount,
    Service,
)
from tests.support.motions import least_supports
from tests.support.readings import inputs_of, readings

#: (nodes, conversion cost, relationships).
Cost: TypeAlias = tuple[int, int, int]
#: Prefix of the name of an InheritanceNode, before the name of the module that it represents.
STANDS_FOR = "what stands for "
#: The cost of the cheapest wirings, and these wirings up to the names of nodes.
Answers: TypeAlias = tuple[Cost, frozenset[Hashable]]
NOTHING: Cost = (0, 0, 0)


def add(*costs: Cost) -> Cost:
    return (sum(c[0] for c in costs), sum(c[1] for c in costs), sum(c[2] for c in costs))


def cheapest(every: Iterable[tuple[Cost, Hashable]]) -> Answers | None:
    best: Cost | None = None
    wirings: set[Hashable] = set()
    for cost, wiring in every:
        if best is None or cost < best:
            best, wirings = cost, set()
        if cost == best:
            wirings.add(wiring)
    return None if best is None else (best, frozenset(wirings))


def minimal(configuration: Configuration, modules: Mapping[str, Module]) -> tuple[Cost, int] | None:
    """Return the least cost and the number of optima; `None` where nothing realises it.

    Raises:
        UnclearError: floating point cannot decide which modules provide a function.
    """
    known = {**modules, **{module.name: module for module in configuration.declared}}
    parts: list[Answers | None] = []
    # Each output is a source of its own.
    data: dict[tuple[str, str | None], list[Data]] = {}
    # Of two lines for the same relationship, the one that names its input determines the end.
    meant = readings(configuration, known)
    lines = (line for line in configuration.relationships if isinstance(line, Data))
    for line in sorted(lines, key=lambda line: line.client_port is None):
        voice = speaking(line, known)
        port = line.source_port if voice is None else voice.port or voice.function
        mine = data.setdefault((line.source, port), [])
        if all(
            written_value(line, known, meant) != written_value(other, known, meant)
            for other in mine
        ):
            mine.append(line)
    parts += [resolve_data(lines, known, meant) for lines in data.values()]
    hierarchical = configuration.architecture == "hierarchical"
    nodes = inheritance(configuration, known)
    heard = hearing(configuration, nodes)
    parts += [resolve_control(group, hierarchical) for group in groups(heard)]
    total, count = (len(nodes), 0, 0), 1
    for part in parts:
        if part is None:
            return None
        total, count = add(total, part[0]), count * len(part[1])
    return total, count


# ---- Ports: section 3 ----------------------------------------------------------------------------


def speaking(line: Data, known: Mapping[str, Module]) -> Service | None:
    """Return the service that delivers the data of a relationship: the named or the only one."""
    services = known[line.source].services if line.source in known else ()
    voices = [each for each in services if each.kind in ("Sense", "DataOut")]
    if line.source_port is not None:
        voices = [each for each in voices if line.source_port == (each.port or each.function)]
    return voices[0] if len(voices) == 1 else None


def taking(
    line: Data, known: Mapping[str, Module], meant: Mapping[int, tuple[str, ...]] | None = None
) -> list[tuple[str | None, str | None]]:
    """Return the inputs that a line may feed, with their representations.

    `meant` has the inputs of each line, by `id`; a line that is left open may feed any.
    """
    entries = list(inputs_of(known[line.client]).items()) if line.client in known else []
    own = (meant or {}).get(id(line))
    return [e for e in entries if (e[0] in own if own else line.client_port in (None, e[0]))]


def written_value(
    line: Data, known: Mapping[str, Module], meant: Mapping[int, tuple[str, ...]]
) -> Hashable:
    """Return the client, the input and the service of a line."""
    own = meant.get(id(line), ())
    return line.client, own[0] if len(own) == 1 else line.client_port, line.mode, line.hz


# ---- Services: the table of section 6 ------------------------------------------------------------

Offer: TypeAlias = tuple[Mode, Fraction | None]
PERIODIC, READY, REQUEST = "NotifyAtFrequency", "NotifyWhenReady", "RequestWhenReady"


def serve(need: Data, first: Offer, carried: Offer) -> str | None:
    """Return `direct`, `split` (by a splitter anywhere), `filter` (after conversion) or `None`."""
    (mode, hz) = first if need.mode is None else (need.mode, need.hz)
    (given, rate) = carried
    conditional = mode.name not in (PERIODIC, READY, REQUEST)
    if mode == given:
        if mode.name != PERIODIC or hz is None or rate is None or hz == rate:
            return "direct"
        return "split" if hz < rate else None
    if mode.name in (REQUEST, PERIODIC):
        return "split"
    if mode.name == READY:
        return "split" if given.name == PERIODIC else None
    return "filter" if conditional and given.name in (READY, PERIODIC) else None


# ---- Data: every tree from one source ------------------------------------------------------------


@dataclass(frozen=True)
class Client:
    """A client of one source, with the types it accepts (`None`: all) and its service."""

    name: str
    number: int
    accepts: frozenset[str] | None
    service: str
    orphan: bool


def resolve_data(
    lines: Sequence[Data], known: Mapping[str, Module], meant: Mapping[int, tuple[str, ...]]
) -> Answers | None:
    """Search the lines of one output."""
    voice = speaking(lines[0], known)
    delivered = voice.output if voice else None
    offers = [(m, voice.hz if m.name == PERIODIC else None) for m in voice.modes] if voice else []
    converters = [
        (str(s.inputs[0]), str(s.output), s.cost, (module.name, index))
        for module in known.values()
        for index, s in enumerate(module.services)
        if s.kind == "Converts"
    ]
    ways: list[tuple[Cost, Hashable]] = []
    links: Sequence[Offer | None] = offers or (None,)
    for carried in links:
        clients = []
        for number, line in enumerate(lines):
            service = "direct" if carried is None else serve(line, offers[0], carried)
            if service is None:
                break
            inputs = [taken for _, taken in taking(line, known, meant)]
            accepts = None if not inputs or None in inputs else frozenset(map(str, inputs))
            orphan = (
                delivered is not None
                and accepts is not None
                and not accepts & reach(delivered, converters)
            )
            clients.append(Client(line.client, number, accepts, service, orphan))
        else:
            found = _Tree(delivered, converters).cheapest(tuple(clients))
            if found is not None:
                ways += [(found[0], wiring) for wiring in found[1]]
    return cheapest(ways)


Converter: TypeAlias = tuple[str, str, int, Hashable]


def reach(start: str, converters: Sequence[Converter]) -> set[str]:
    found = {start}
    while more := {q for p, q, _, _ in converters if p in found} - found:
        found |= more
    return found


class _Tree:
    """Every tree below one link of a source; each (state, clients) is searched once."""

    def __init__(self, delivered: str | None, converters: Sequence[Converter]) -> None:
        self.delivered = delivered
        self.converters = converters
        self.known: dict[Hashable, Answers | None] = {}

    def cheapest(self, clients: tuple[Client, ...]) -> Answers | None:
        return self.link(self.delivered, "own", False, False, clients, frozenset(), False)

    def link(
        self,
        representation: str | None,
        made: str,
        split: bool,
        filtered: bool,
        clients: tuple[Client, ...],
        passed: frozenset[str],
        from_splitter: bool,
    ) -> Answers | None:
        """Return the cheapest ways to go on with a link to these clients.

        `made` is own, converted or abstract; `split`: a splitter is upstream; `filtered`: one is
        downstream of the last conversion; `passed` are the representations on the path.
        """
        key = (representation, made, split, filtered, clients, passed, from_splitter)
        if key not in self.known:
            self.known[key] = cheapest(self.ways(*key))
        return self.known[key]

    def converted(
        self, representation: str, split: bool, clients: tuple[Client, ...], passed: frozenset[str]
    ) -> Iterator[tuple[Cost, Hashable]]:
        for given, result, price, name in self.converters:
            if given != representation or result in passed or result == representation:
                continue
            below = self.link(result, "converted", split, False, clients, passed | {given}, False)
            if below is not None:
                for wiring in below[1]:
                    yield add((1, price, 1), below[0]), ("transformer", name, wiring)

    def ways(
        self,
        representation: str | None,
        made: str,
        split: bool,
        filtered: bool,
        clients: tuple[Client, ...],
        passed: frozenset[str],
        from_splitter: bool,
    ) -> Iterator[tuple[Cost, Hashable]]:
        if len(clients) == 1:
            (client,) = clients
            reached = {"direct": True, "split": split, "filter": filtered}[client.service]
            if reached and self.takes(client, representation, made):
                yield (0, 0, 1), ("client", client.number)
        # A splitter whose only input is a splitter is one splitter, so it is not tried.
        if not from_splitter:
            for blocks in partitions(clients):
                parts = [
                    self.link(representation, made, True, True, block, passed, True)
                    for block in blocks
                ]
                if all(part is not None for part in parts):
                    known = [part for part in parts if part is not None]
                    cost = add((1, 0, 1), *(part[0] for part in known))
                    for wirings in itertools.product(*(part[1] for part in known)):
                        yield cost, ("splitter", frozenset(wirings))
        if made != "abstract" and representation is not None:
            yield from self.converted(representation, split, clients, passed)
        if made == "own" and all(client.orphan for client in clients):
            for result in sorted(set().union(*(client.accepts or set() for client in clients))):
                below = self.link(result, "abstract", split, False, clients, passed, False)
                if below is not None:
                    for wiring in below[1]:
                        yield add((1, 0, 1), below[0]), ("transformer", result, wiring)

    def takes(self, client: Client, representation: str | None, made: str) -> bool:
        if client.accepts is None or self.delivered is None:
            return made == "own"
        return representation in client.accepts


def partitions(clients: tuple[Client, ...]) -> Iterator[list[tuple[Client, ...]]]:
    """Yield every way to part clients into blocks."""
    if not clients:
        yield []
        return
    first, rest = clients[0], clients[1:]
    for size in range(len(rest) + 1):
        for others in itertools.combinations(rest, size):
            left = tuple(client for client in rest if client not in others)
            for blocks in partitions(left):
                yield [(first, *others), *blocks]


# ---- Control: InheritanceNodes -----------------------------------------------------------------


@dataclass(frozen=True)
class Inheriting:
    """The InheritanceNode of a module that is commanded in functions which it only inherits.

    `lines` are the relationships that it represents; of these, `direct` also command own
    functions of the module.
    """

    lines: tuple[Control, ...]
    direct: tuple[Control, ...]
    providers: frozenset[str]

    @property
    def rank(self) -> int:
        return max(line.priority or 0 for line in self.lines)


def inheritance(
    configuration: Configuration, modules: Mapping[str, Module]
) -> dict[str, Inheriting]:
    """Return the InheritanceNode of each module that is commanded in inherited functions.

    Raises:
        UnclearError: floating point cannot decide which modules provide a function.
    """
    mounts = {m.mounting: m for m in configuration.relationships if isinstance(m, Mount)}
    found: dict[str, Inheriting] = {}
    control = [line for line in configuration.relationships if isinstance(line, Control)]
    for name in dict.fromkeys(line.controlled for line in control if line.controlled in mounts):
        supports = least_supports(name, mounts, modules)
        own = {f.name for f in modules[name].functions} if name in modules else set()
        inherited = supports.keys() - own
        lines, direct = [], []
        providers: set[str] = set()
        for line in control:
            if line.controlled != name:
                continue
            wanted = commands(modules.get(line.controller)) or own or set(inherited)
            if wanted & inherited:
                lines.append(line)
                providers.update(*(supports[function] for function in wanted & inherited))
                if wanted & own:
                    direct.append(line)
        if lines:
            found[name] = Inheriting(tuple(lines), tuple(direct), frozenset(providers))
    return found


def commands(controller: Module | None) -> set[str]:
    """Return the functions that a controller declares that it commands."""
    return {f for s in (controller.services if controller else ()) for f in s.commands}


def hearing(configuration: Configuration, nodes: Mapping[str, Inheriting]) -> list[Control]:
    """Return the control relationships after InheritanceNodes are introduced.

    The hold of the only controller of a node also applies to the outputs of the node.
    """
    heard: list[Control] = []
    for line in configuration.relationships:
        if not isinstance(line, Control):
            continue
        node = nodes.get(line.controlled)
        if node is None or line not in node.lines or line in node.direct:
            heard.append(line)
    for name, node in nodes.items():
        controller = STANDS_FOR + name
        heard += [replace(line, controlled=controller) for line in node.lines]
        hold = node.lines[0].hold_ms if len(node.lines) == 1 else None
        heard += [
            Control(provider, controller, line.span, node.rank, hold)
            for provider in sorted(node.providers)
            for line in node.lines[:1]
        ]
    return heard


# ---- Control: every choice of arbiters -----------------------------------------------------------

#: A controller and its hold.
Voice: TypeAlias = tuple[str, Hold | None]
#: What an arbiter hears: levels of priority from the lowest, each a set of equals.
Order: TypeAlias = tuple[frozenset[Voice], ...]


def groups(lines: Sequence[Control]) -> list[list[Control]]:
    """Part control lines into groups that share no controller and no controlled module."""
    found: list[list[Control]] = []
    for line in lines:
        ends = {("out", line.controller), ("in", line.controlled)}
        near = [
            group
            for group in found
            if any(ends & {("out", o.controller), ("in", o.controlled)} for o in group)
        ]
        found = [group for group in found if group not in near]
        found.append([*itertools.chain(*near), line])
    return found


def resolve_control(lines: Sequence[Control], hierarchical: bool) -> Answers | None:
    """Search the control lines of one group.

    Two arbiters with the same inputs in the same order are never minimal: one of them followed by a
    ControlSplitter has no more nodes and fewer lines. So inputs identify an arbiter.
    """
    orders: dict[str, Order] = {}
    for module in {line.controlled for line in lines}:
        levels: dict[int, set[Voice]] = {}
        for line in lines:
            if line.controlled == module:
                rank = (line.priority or 0) if hierarchical else 0
                levels.setdefault(rank, set()).add((line.controller, line.hold_ms))
        orders[module] = tuple(frozenset(levels[rank]) for rank in sorted(levels))
    needed = {order for order in orders.values() if len(voices(order)) > 1}
    shareable = needed if hierarchical else set()
    optional = {part for order in shareable for part in parts(order)} - needed
    best: Answers | None = None
    for size in range(len(optional) + 1):
        # Every arbiter is a node, so more of them than the best answer has nodes cannot be less.
        if best is not None and len(needed) + size > best[0][0]:
            break
        for chosen in itertools.combinations(sorted(optional, key=repr), size):
            arbiters = sorted(needed | set(chosen), key=repr)
            found = cheapest(wire(arbiters, orders, hierarchical))
            ways = [(answer[0], w) for answer in (best, found) if answer for w in answer[1]]
            best = cheapest(ways)
    return best


def voices(order: Order) -> frozenset[Voice]:
    return frozenset().union(*order)


def parts(order: Order) -> Iterator[Order]:
    """Yield the subsets that can be arbitrated separately: their members rank alike to all others.

    That is whole neighbouring levels, or some of one level.
    """
    for start in range(len(order)):
        for end in range(start + 1, len(order) + 1):
            if len(voices(order[start:end])) > 1 and end - start < len(order):
                yield order[start:end]
    for level in order:
        for size in range(2, len(level) + 1):
            for some in itertools.combinations(sorted(level, key=repr), size):
                if (frozenset(some),) != order:
                    yield (frozenset(some),)


def wire(
    arbiters: Sequence[Order], orders: Mapping[str, Order], hierarchical: bool
) -> Iterator[tuple[Cost, Hashable]]:
    """Yield every way to feed arbiters, each from controllers and from other arbiters."""
    choices = []
    for order in arbiters:
        inner = [other for other in arbiters if other in set(parts(order))] if hierarchical else []
        sets = [
            taken
            for size in range(len(inner) + 1)
            for taken in itertools.combinations(inner, size)
            if sum(len(voices(t)) for t in taken) == len(frozenset().union(*map(voices, taken)))
        ]
        choices.append(sets)
    for nesting in itertools.product(*choices):
        receivers: dict[Hashable, int] = {}
        lines = 0
        for order in orders.values():
            signal: Hashable = order
            if len(voices(order)) == 1:
                ((name, _),) = voices(order)
                signal = name
            receivers[signal] = receivers.get(signal, 0) + 1
            lines += 1
        for order, taken in zip(arbiters, nesting, strict=True):
            covered = frozenset().union(*map(voices, taken))
            singles = [name for name, _ in voices(order) - covered]
            for heard in (*taken, *singles):
                receivers[heard] = receivers.get(heard, 0) + 1
                lines += 1
        splitters = sum(
            1
            for signal, count in receivers.items()
            if count > 1 and not (isinstance(signal, str) and signal.startswith(STANDS_FOR))
        )
        unused = any(order not in receivers for order in arbiters)
        if not unused:
            wiring = frozenset(zip(arbiters, map(frozenset, nesting), strict=True))
            yield (len(arbiters) + splitters, 0, lines + splitters), wiring
