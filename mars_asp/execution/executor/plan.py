"""The links of a specification, their modes and rates, and the kinds of its modules."""

from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence
from fractions import Fraction
from operator import itemgetter
from typing import TYPE_CHECKING, NamedTuple

from mars_asp.execution.executor.behaviour import Behaviour
from mars_asp.execution.executor.delivery import AT_FREQUENCY, ON_REQUEST, WHEN_READY
from mars_asp.execution.executor.link import Link, SideKind, Stream
from mars_asp.execution.executor.schedule import MILLISECOND, SECOND
from mars_asp.model.declarations import (
    MOTION_FUNCTIONS,
    Configuration,
    Control,
    Data,
    Gating,
    Limit,
    Lock,
    Mode,
    Module,
    Mount,
    Relationship,
    Reset,
    Service,
    Strategy,
    ends_of,
)
from mars_asp.model.ports import DELIVERING, free_positions, input_position, inputs
from mars_asp.reasoning.synthesis.inheritance_nodes import InheritanceNodes

if TYPE_CHECKING:
    from mars_asp.kinematics.sharing import Carrying

DEFAULT_HOLD = 200 * MILLISECOND
#: Longer (ns) than any run.
ENDLESS = 2**62
#: The kinds of modules and nodes that send commands; a Gate sends what its line carries.
_COMMANDING = ("control_out", "arbitration_node", "control_splitter", "inheritance_node")
_SIDE_KINDS: Mapping[type[Relationship], SideKind] = {Reset: "reset", Lock: "lock", Limit: "limit"}
#: The kinds of nodes that forward data in the mode of their input.
FORWARDING = ("data_splitter", "data_transformer", "gate_node")


class Slot(NamedTuple):
    """An input of a module: its name and its position, or None if unknown, and its links."""

    name: str | None
    place: int | None
    links: list[Link]


class Plan:
    """The links of a specification, by their ends, and the properties of modules and links."""

    def __init__(
        self,
        configuration: Configuration,
        modules: Mapping[str, Module],
        behaviours: Mapping[str, Behaviour],
    ) -> None:
        self.configuration = configuration
        self.modules = configuration.with_declared(modules)
        self.behaviours = behaviours
        self.conversions = {each.transformer: each for each in reversed(configuration.conversions)}
        self.links: list[Link] = []
        self.data_in: defaultdict[str, list[Link]] = defaultdict(list)
        self.data_out: defaultdict[str, list[Link]] = defaultdict(list)
        self.control_in: defaultdict[str, list[Link]] = defaultdict(list)
        self.control_out: defaultdict[str, list[Link]] = defaultdict(list)
        #: The links that end at the side of a Gate (triggers), an arbiter or a module.
        self.side_in: defaultdict[str, list[Link]] = defaultdict(list)
        self.strategies: dict[str, Strategy] = {}
        self.inheriting = InheritanceNodes(configuration, self.modules)
        for relationship in configuration.relationships:
            self._add(relationship)
        self._join_sides()
        #: The inputs of each module, in the order of the arguments of its function.
        self.slots = {name: self._slots(name) for name in {**self.data_in, **self.control_in}}
        ends = (end for link in self.links for end in (link.source, link.client))
        self.names = tuple(dict.fromkeys([*(n.text for n in configuration.modules), *ends]))
        #: The links within modules, from resets and to completions, by their sources.
        self.inner: defaultdict[str, list[Link]] = defaultdict(list)
        self._join_parts()
        self.data_depth = self._data_depths()
        #: With lines to sides: the depth of each name among commands, -1 for data, and its circle.
        self.stages: dict[str, int] = {}
        self.circles: dict[str, int] = {}
        if self.sided or self.inner:
            self._order_sides()

    def _add(self, relationship: Relationship) -> None:
        span = relationship.span
        match relationship:
            case Data():
                hz = None if relationship.hz is None else Fraction(relationship.hz)
                ends = relationship.source, relationship.client
                link = Link("data", *ends, span, relationship.mode, hz)
                link.client_port = relationship.client_port
                self.data_in[link.client].append(link)
                self.data_out[link.source].append(link)
            case Control():
                hold = relationship.hold_ms
                ends = relationship.controller, relationship.controlled
                link = Link("control", *ends, span, stream="control")
                link.declared, link.priority = relationship.priority, relationship.priority or 0
                link.hold = ENDLESS if isinstance(hold, str) else _nanoseconds(hold)
                link.allocation = relationship.allocation
                self.control_in[link.client].append(link)
                self.control_out[link.source].append(link)
            case Strategy():
                self.strategies[relationship.controlled] = relationship
                return
            case Mount():
                return
            case _:
                link = _side_link(relationship)
                self.side_in[link.client].append(link)
        self.links.append(link)

    def _join_sides(self) -> None:
        """Add the links to sides to what their sources send, in the order of the relationships.

        The stream of an undescribed source that sends nothing else is that of the other end.
        """
        place = {link: number for number, link in enumerate(self.links)}
        for link in self.links:
            if link.kind in ("data", "control"):
                continue
            sends = self.data_out[link.source] or self.control_out[link.source]
            if self.is_node(link.source) or link.source in self.modules or sends:
                link.stream = self.stream(link.source)
            elif link.kind == "limit":
                link.stream = "control"
            elif link.kind in ("suppress", "inhibit"):
                link.stream = self.stream(link.client)
            out = self.control_out if link.stream == "control" else self.data_out
            out[link.source].append(link)
            out[link.source].sort(key=lambda each: place[each])

    def _join_parts(self) -> None:
        """Add how the resets and computations of a module reach its other parts."""
        resets = [name for name in self.names if self.is_reset(name)]
        for name in resets:
            self._join_inner(name, [each for each in self.parts(name) if each != name])
        for done in (name for name in self.names if self.kind(name) == "completion"):
            for part in self.parts(done.rpartition(".")[0]):
                if self.kind(part) != "completion" and part not in resets:
                    self._join_inner(part, [done])

    def _join_inner(self, source: str, clients: Sequence[str]) -> None:
        for client in clients:
            link = Link("data", source, client, self.modules[client].span)
            self.inner[client].append(link)

    @property
    def sided(self) -> bool:
        """Whether lines end at the sides of Gates, arbiters or modules."""
        return any(self.side_in.values())

    def is_reset(self, name: str) -> bool:
        """Whether lines reset a module."""
        return any(link.kind == "reset" for link in self.side_in[name])

    def parts(self, owner: str) -> Sequence[str]:
        """Return the parts of a module that run, itself included, in their order."""
        span = self.modules[owner].span if owner in self.modules else None
        return [
            name
            for name in self.names
            if name == owner or (name.startswith(f"{owner}.") and self.modules[name].span == span)
        ]

    def _reaching(self, name: str) -> Sequence[Link]:
        return (
            *(*self.data_in[name], *self.control_in[name]),
            *(*self.side_in[name], *self.inner.get(name, ())),
        )

    def stream(self, name: str) -> Stream:
        """Return the stream that a module or node sends."""
        kind = self.kind(name)
        commands = bool(self.control_in[name]) if kind == "gate_node" else kind in _COMMANDING
        return "control" if commands else "data"

    def _slots(self, name: str) -> tuple[Slot, ...]:
        """Return the inputs of a module that links feed, and set the `slot` of each link."""
        found: dict[tuple[bool, int, str], Slot] = {}
        declared = self._declared_inputs(name)
        data = self.data_in[name]
        free = free_positions(link.client_port for link in data)
        for link in data:
            port = self.input_name(link)
            if port in declared:
                place: int | None = declared.index(port)
            else:
                place = (next(free) if port is None else input_position(port) or 0) - 1
                place = None if place < 0 else place
            # Inputs without a position are ordered by name, not by lines.
            key = place is None, place or 0, "" if place is not None else port or ""
            found.setdefault(key, Slot(port, place, [])).links.append(link)
        port = self._input_of_commands(name)
        commands = [Slot(port, None, [link]) for link in self.control_in[name]]
        if port is not None and commands:
            found[False, declared.index(port), ""] = commands.pop(0)
        slots = [slot for _, slot in sorted(found.items(), key=itemgetter(0))] + commands
        for number, slot in enumerate(slots):
            for link in slot.links:
                link.slot = number
        return tuple(slots)

    def left_open(self, link: Link) -> Sequence[str]:
        """Return the inputs that an ambiguous link may mean; () for other links.

        A reset ends in a module, not in an input.
        """
        known = () if link.kind == "reset" else self._declared_inputs(link.client)
        if link.kind == "control" and self._input_of_commands(link.client) is not None:
            return ()
        return known if link.client_port is None and len(known) > 1 else ()

    def _input_of_commands(self, name: str) -> str | None:
        """Return the only one of several inputs that no data link means, None without one.

        Commands for the module go there, as the rule for `input_fed` has it.
        """
        declared = self._declared_inputs(name)
        meant = {self.input_name(link) for link in self.data_in[name]}
        left = [port for port in declared if port not in meant]
        return left[0] if len(declared) > 1 and len(left) == 1 and None not in meant else None

    def _declared_inputs(self, name: str) -> Sequence[str]:
        return tuple(inputs(self.modules[name])) if name in self.modules else ()

    def _data_depths(self) -> dict[str, int]:
        """Return the length of the longest path of data links to each name, ignoring cycles."""
        left = {name: len(self.data_in[name]) for name in self.names}
        depths = dict.fromkeys(self.names, 0)
        ready = [name for name in self.names if not left[name]]
        for name in ready:  # the loop appends to it
            for link in self.data_out[name]:
                depths[link.client] = max(depths[link.client], depths[name] + 1)
                left[link.client] -= 1
                if not left[link.client]:
                    ready.append(link.client)
        return depths

    def _order_sides(self) -> None:
        """Set the depths of all names so that all that can reach a trigger has a lower one.

        The names of a circle have one depth.
        """
        import networkx as nx  # noqa: PLC0415 -- used by few files

        graph = nx.DiGraph()
        graph.add_nodes_from(self.names)
        graph.add_edges_from((link.source, link.client) for link in self.links)
        inner = (link for links in self.inner.values() for link in links)
        graph.add_edges_from((link.source, link.client) for link in inner)
        circles = nx.condensation(graph)
        self.circles = circles.graph["mapping"]
        for number in nx.topological_sort(circles):
            members = circles.nodes[number]["members"]
            depth, stage = 0, -1
            for name in members:
                for link in self._reaching(name):
                    if self.in_circle(link) or self.acts_late(link):
                        continue
                    if link.stream == "data":
                        depth = max(depth, self.data_depth[link.source] + 1)
                    stage = max(stage, self.stages[link.source])
            for name in members:
                self.data_depth[name] = depth
                self.stages[name] = stage + self._adds_stage(name, stage)

    def _adds_stage(self, name: str, stage: int) -> int:
        """Return by how much a name is deeper among commands than its sources."""
        kind = self.kind(name)
        if kind == "gate_node":
            return 1 + (stage < 0) if self.control_in[name] else int(stage >= 0)
        if kind == "arbitration_node" or (kind == "control_out" and self.control_in[name]):
            return 1 + (stage < 0)
        return int(kind == "control_out" and stage < 0)

    def acts_late(self, link: Link) -> bool:
        """Whether a command triggers a Gate of data: it acts from the next instant on."""
        is_gate = link.kind in ("suppress", "inhibit")
        return is_gate and link.stream == "control" and self.stream(link.client) == "data"

    def in_circle(self, link: Link) -> bool:
        """Whether the messages of a link can come back to its source."""
        return self.circles[link.source] == self.circles[link.client]

    def returns(self, link: Link) -> bool:
        """Whether messages that pass a Gate reach its trigger `link` through nodes alone."""
        sources = [link.source]
        for name in sources:  # the loop appends to it
            if self.is_node(name):
                sources += {each.source for each in self._reaching(name)} - {*sources}
        return link.client in sources

    def is_gated(self, name: str) -> bool:
        """Whether a node forwards the messages of a Gate, through nodes only."""
        return any(self.kind(each) == "gate_node" for each in self._upstream(name))

    def _upstream(self, name: str) -> Iterator[str]:
        """Yield a name and the sources before it, through the first inputs of nodes, each once."""
        seen = set[str]()
        while name not in seen:
            yield name
            seen.add(name)
            if self.kind(name) not in FORWARDING or not self.data_in[name]:
                return
            name = self.data_in[name][0].source

    def bounds_others(self, name: str) -> bool:
        """Whether the commands of a module limit others, through any nodes."""
        links = list(self.control_out[name])
        for link in links:  # the loop appends to it
            if link.kind == "control" and self.is_node(link.client):
                links += (each for each in self.control_out[link.client] if each not in links)
        return any(link.kind == "limit" for link in links)

    def lacks_node(self, link: Link) -> bool:
        """Whether the end of a link has no side at which the link could end."""
        kind = self.kind(link.client)
        gate, bound = link.kind in ("suppress", "inhibit"), link.kind in ("lock", "limit")
        return (gate and kind != "gate_node") or (bound and kind != "arbitration_node")

    def is_boolean(self, link: Link) -> bool | None:
        """Whether the messages of a link are truths, or None if that is unknown."""
        for name in self._upstream(link.source):
            if name in self.conversions:
                return _is_boolean(self.conversions[name].target)
        outputs = [s.output for s in self.services(name) if s.kind in DELIVERING]
        return None if not outputs or outputs[0] is None else _is_boolean(outputs[0])

    def input_name(self, link: Link) -> str | None:
        """Return the name of the input that a data link feeds, or None if it is unknown."""
        known = self._declared_inputs(link.client) if link.kind == "data" else ()
        return link.client_port or (known[0] if len(known) == 1 else None)

    def origin_of(self, link: Link) -> str:
        """Return, as text, the modules from which a link's messages come, through any nodes."""
        if link.stream == "control":
            return " or ".join(dict.fromkeys(self._commanders(link.source)))
        source, seen = link.source, set[str]()
        while self.is_node(source) and source not in seen and self.data_in[source]:
            seen.add(source)
            source = self.data_in[source][0].source
        return source

    def targets_of(self, link: Link, seen: frozenset[str] = frozenset()) -> list[str]:
        """Return the modules or inputs that a link's messages reach, through any nodes."""
        name = link.client
        if not self.is_node(name):
            port = link.client_port
            return [name if port is None else f"{name}.{port}"]
        following = self.data_out[name] if link.stream == "data" else self.control_out[name]
        if name in seen or link.kind not in ("data", "control"):
            return []
        found = (target for each in following for target in self.targets_of(each, seen | {name}))
        return list(dict.fromkeys(found))

    def converter_of(self, transformer: str) -> str | None:
        """Return the declared converter of a DataTransformer, or None."""
        found = self.conversions.get(transformer)
        return None if found is None else found.converter

    def is_node(self, name: str) -> bool:
        """Whether a name is an introduced node, not a module."""
        return name not in self.modules and self.configuration.node_kind(name) is not None

    def link_title(self, link: Link) -> str:
        """Return the title of a link: the modules that it connects, through any nodes."""
        return f"{self.origin_of(link)} -> {' and '.join(self.targets_of(link)) or link.client}"

    def topic_of(self, link: Link) -> str | None:
        """Return the topic of a link in recordings, or None for a link between two nodes."""
        origin, targets = self.origin_of(link), self.targets_of(link)
        if link.kind not in ("data", "control"):
            return None if self.is_node(link.source) else f"/{origin}/{link.client}"
        if self.is_node(link.source):
            if self.is_node(link.client):
                return None
            if link.kind == "control":
                return f"/{link.client}/received"
        elif self.is_node(link.client) and (link.kind == "data" or len(targets) != 1):
            return f"/{link.source}/sent"
        return f"/{origin}/{targets[0] if targets else link.client}"

    def kind(self, name: str) -> str:
        """Return the kind of a node or module: sensor, data_out, control_out, sink or effector."""
        brought = None if name in self.modules else self.configuration.pack_kind(name)
        if brought is not None:
            carries_data = brought.carries == "data"
            if brought.behaves or name in self.behaviours:
                return "data_out" if carries_data else "control_out"
            # Without behaviour, it forwards its input unchanged.
            return "data_splitter" if carries_data else "control_splitter"
        node = None if name in self.modules else self.configuration.node_kind(name)
        if node is not None:
            return node
        kinds = {service.kind for service in self.services(name)}
        for kind, called in (
            ("Sense", "sensor"),
            ("DataOut", "data_out"),
            ("ControlOut", "control_out"),
            ("DataIn", "sink"),
            ("Done", "completion"),
        ):
            if kind in kinds:
                return called
        if name in self.modules and self.modules[name].functions:
            return "effector"
        if "Reset" in kinds:
            return "reset"
        return self._guess(name)

    def _guess(self, name: str) -> str:
        """Return the kind of an undescribed module, by its relationships."""
        if self.control_out[name]:
            return "control_out"
        if self.data_out[name]:
            return "data_out" if self.data_in[name] else "sensor"
        return "sink" if self.data_in[name] and not self.control_in[name] else "effector"

    def services(self, name: str) -> tuple[Service, ...]:
        """Return the services of a module; () for a node or an undescribed module."""
        return self.modules[name].services if name in self.modules else ()

    def offered(self, name: str) -> tuple[Mode, Fraction | None]:
        """Return the mode in which a module makes data, and its rate in Hertz or None.

        Of several offered modes, the one that its single link states is used, or else the first.
        """
        service = next((s for s in self.services(name) if s.kind in DELIVERING), None)
        if service is None or not service.modes:
            return Mode(WHEN_READY), None
        requested = [link.mode for link in self.data_out[name] if link.mode is not None]
        named = [mode for mode in service.modes if len(requested) == 1 and mode == requested[0]]
        mode = (named or list(service.modes))[0]
        hz = None if service.hz is None else Fraction(service.hz)
        return mode, hz if mode.name == AT_FREQUENCY else None

    def carried(self, link: Link) -> tuple[Mode, Fraction | None]:
        """Return the mode and rate of a link: stated, or else those of its source."""
        return self._carried(link, self.made(link.source))

    def _carried(
        self, link: Link, made: tuple[Mode, Fraction | None]
    ) -> tuple[Mode, Fraction | None]:
        mode, hz = link.mode, link.hz
        if mode is None or (mode.name == AT_FREQUENCY and hz is None):
            fed, rate = made
            is_node = self.kind(link.source) in FORWARDING
            mode = mode or (fed if is_node else self.offered(link.source)[0])
            hz = rate if mode.name == AT_FREQUENCY else None
        return mode, hz

    def made(self, name: str) -> tuple[Mode, Fraction | None]:
        """Return the mode and rate of the messages of a module, or of the input of a node."""
        names = list(self._upstream(name))
        made = self._made(names[-1])
        for node in reversed(names):
            if self.kind(node) in FORWARDING and self.data_in[node]:
                made = self._carried(self.data_in[node][0], made)
        return made

    def _made(self, name: str) -> tuple[Mode, Fraction | None]:
        """Return the mode and rate of the messages of a module; of a node, those without input."""
        if self.kind(name) in FORWARDING:
            return Mode(WHEN_READY), None
        mode, hz = self.offered(name)
        if mode.name not in (AT_FREQUENCY, ON_REQUEST):
            # The module sends each message; the link applies the condition of the mode.
            return Mode(WHEN_READY), None
        return mode, hz

    def rate(self, name: str, seen: frozenset[str] = frozenset()) -> Fraction | None:
        """Return the rate in Hertz at which a module makes messages, or None if unknown."""
        if name in seen:
            return None
        _, hz = self.offered(name)
        behaviour = self.behaviours.get(name)
        if hz is None and behaviour is not None and behaviour.period is not None:
            hz = Fraction(SECOND, behaviour.period)
        if hz is not None:
            return hz
        feeding = self.data_in[name]
        if len(feeding) != 1:
            return None
        mode, declared = self.carried(feeding[0])
        if mode.name not in (AT_FREQUENCY, WHEN_READY):
            return None
        return declared or self.rate(feeding[0].source, seen | {name})

    def hold(self, link: Link) -> int:
        """Return how long (ns) a message of a link to an arbiter is in force."""
        if link.hold is not None:
            return link.hold
        # Nodes do not change rates, so the rate is that of the only commander.
        commanders = self._commanders(link.source)
        hz = self.rate(commanders[0]) if len(commanders) == 1 else None
        return DEFAULT_HOLD if hz is None else round(Fraction(5 * SECOND, 2) / hz)

    def depth(self, name: str, seen: frozenset[str] = frozenset()) -> int:
        """Return how many arbiters and commanded controllers a path to `name` has at most.

        With lines to sides, Gates count as well, and -1 is the depth of data.
        """
        if self.stages:
            return self.stages[name]
        if name in seen:
            return 0
        kind = self.kind(name)
        own = kind == "arbitration_node" or (kind == "control_out" and bool(self.control_in[name]))
        after = [self.depth(link.source, seen | {name}) for link in self.control_in[name]]
        return own + max(after, default=0)

    def reaches_effector(self, name: str, seen: frozenset[str] = frozenset()) -> bool:
        """Whether commands of a node can reach an effector without another arbiter."""
        if name in seen:
            return False
        return any(
            self.kind(link.client) != "arbitration_node"
            and (
                not self._leads_on(link.client) or self.reaches_effector(link.client, seen | {name})
            )
            for link in self.control_out[name]
        )

    def providers(self, node: str) -> dict[str, Link]:
        """Return an InheritanceNode's outputs by provider, nearest to its module first."""
        links = self._provider_links(node)
        way = self.inheriting.way_down(node)
        return {name: links[name] for name in way if name in links}

    def carrying(
        self, node: str, position: Callable[[str], Mapping[str, float]]
    ) -> "Carrying | None":
        """Return how an InheritanceNode's providers move its module, or None without mounts.

        `position` returns the present values of a module's motions in degrees and mm.
        """
        way = self.inheriting.way_down(node)
        return (
            self.inheriting.carrying(way[0], list(self.providers(node)), position) if way else None
        )

    def unknown_providers(self, node: str) -> list[str]:
        """Return the undescribed providers of a node; they prevent a choice among several."""
        providers = self._provider_links(node)
        return [n for n in providers if n not in self.modules] if len(providers) > 1 else []

    def led_by_both(self, node: str) -> str | None:
        """Return the module that a node represents if a controller commands both, else None.

        The commands then have functions of the module and functions that it inherits.
        """
        through = self.inheriting.commanders(node)
        for name in self.inheriting.stands_for(node)[:1]:
            if not set(through).isdisjoint(self.inheriting.commanders(name)):
                return name
        return None

    def left_to_providers(self) -> dict[str, frozenset[str]]:
        """Return, by module, the functions that InheritanceNodes take over from it."""
        left: dict[str, frozenset[str]] = {}
        for node in self.names:
            name = self.led_by_both(node) if self.kind(node) == "inheritance_node" else None
            if name is None:
                continue
            carrying = self.carrying(node, lambda _: {})
            given = {
                function
                for function in MOTION_FUNCTIONS
                if carrying is not None
                and (carrying.support(function) or carrying.anyone(function))
            }
            left[name] = left.get(name, frozenset()) | given - self.inheriting.functions(name)
        return left

    def _provider_links(self, node: str) -> dict[str, Link]:
        return {
            effector: link
            for link in self.control_out[node]
            for effector in self.inheriting.reached(link.client)
        }

    def _leads_on(self, name: str) -> bool:
        """Whether a name is that of a node that forwards commands."""
        return self.inheriting.hands_on(name) or self.kind(name) == "inheritance_node"

    def _commanders(self, name: str, seen: frozenset[str] = frozenset()) -> list[str]:
        """Return the modules whose commands reach a name, through any nodes."""
        if name in seen:
            return []
        if not self._leads_on(name):
            return [name]
        return [
            commander
            for link in self.control_in[name]
            for commander in self._commanders(link.source, seen | {name})
        ]


def _side_link(line: Gating | Reset | Lock | Limit) -> Link:
    """Return the link of a relationship that ends at the side of a Gate, arbiter or module."""
    client, source = ends_of(line)
    kind = line.sign if isinstance(line, Gating) else _SIDE_KINDS[type(line)]
    link = Link(kind, source, client, line.span)
    if isinstance(line, Gating):
        link.time = line.ms * MILLISECOND
    elif not isinstance(line, Reset):
        link.hold = _nanoseconds(line.hold_ms)
    if isinstance(line, Lock):
        link.declared = line.priority
    return link


def _is_boolean(representation: str) -> bool:
    return representation.lower().endswith("bool")


def _nanoseconds(milliseconds: int | None) -> int | None:
    return None if milliseconds is None else milliseconds * MILLISECOND
