"""Nodes that exchange topics, as a configuration: what ROS launch files and graph dumps have alike.

A node is a module and each of its topics a port. A topic of a command type, from A to B, is
`B is_controlled_by A`; every other one is `B uses_data_from A`. Topics that every node has for its
own administration are left out and counted.
"""

import re
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import chain
from typing import NamedTuple

from mars_asp.annotations.types import representation
from mars_asp.diagnostic import Span, point
from mars_asp.exchange import ports
from mars_asp.exchange.unread import Unread
from mars_asp.model.declarations import (
    Configuration,
    Control,
    Data,
    Engine,
    Hold,
    Module,
    Muxed,
    Name,
    Service,
)

#: Messages that tell somebody to move; a joystick's are none, as no base obeys them.
COMMANDS = frozenset(
    {"Twist", "TwistStamped", "AckermannDrive", "AckermannDriveStamped", "JointTrajectory"}
)
#: The last words of topics that belong to the middleware, not to the robot.
_MIDDLEWARE = frozenset(
    "rosout rosout_agg clock parameter_events parameter_descriptions parameter_updates tf"
    " tf_static diagnostics diagnostics_agg diagnostics_toplevel_state statistics bond"
    " transition_event".split()
)
_DEBUG = re.compile(r"(?:^|[/_])debug(?:[/_]|$)", re.IGNORECASE)
#: What dumps write where a type is not known.
_NO_TYPES = frozenset({"", "*", "any", "unknown", "unknown type"})


@dataclass(frozen=True, slots=True)
class Endpoint:
    """An end of a topic at a node.

    `topic` is its full name, all renaming done; `type` is the message's as it is written, if it is
    known; `span` is what an owner would change; `hz` is how often it is published, if that is
    known; `optional` is whether a node that hears it works as well without.
    """

    topic: str
    type: str | None
    span: Span
    hz: Fraction | None = None
    optional: bool = False


@dataclass(frozen=True, slots=True)
class Node:
    """A node by its full name; `guard` is the place that makes it a guard, if it is one.

    `relays` is whether it publishes what it hears, whatever the type of that.
    """

    name: str
    span: Span
    published: tuple[Endpoint, ...] = ()
    subscribed: tuple[Endpoint, ...] = ()
    guard: Span | None = None
    relays: bool = False


@dataclass(frozen=True, slots=True)
class MuxInput:
    """A topic that a mux listens to, with the name that the mux has for it."""

    name: str
    topic: str
    span: Span
    priority: int
    hold_ms: Hold | None


@dataclass(frozen=True, slots=True)
class Mux:
    """A node that hands on, of several topics, the one with the highest priority to `output`."""

    name: str
    engine: Engine
    span: Span
    output: str
    inputs: tuple[MuxInput, ...]


@dataclass(frozen=True, slots=True)
class Graph:
    """Nodes, muxes and how they are wired; a mux is not among the nodes.

    `observed` is whether it is all of a robot that ran, so that what nobody hears is loose;
    elsewhere the base may hear it that is no node.
    """

    path: str
    nodes: tuple[Node, ...]
    muxes: tuple[Mux, ...] = ()
    observed: bool = False


class Mapped(NamedTuple):
    """A configuration, and what of the graph is not in it."""

    configuration: Configuration
    unread: tuple[Unread, ...]


class _End(NamedTuple):
    """A node's name and its end of a topic."""

    node: str
    end: Endpoint


def joined(graphs: Sequence[Graph]) -> Graph:
    """Return several graphs, at least one, as that of one robot: nodes of one name are one."""
    nodes: dict[str, Node] = {}
    for node in chain.from_iterable(graph.nodes for graph in graphs):
        known = nodes.get(node.name)
        nodes[node.name] = node if known is None else _united(known, node)
    muxes = {mux.name: mux for mux in chain.from_iterable(graph.muxes for graph in graphs)}
    kept = tuple(node for node in nodes.values() if node.name not in muxes)
    observed = any(graph.observed for graph in graphs)
    return Graph(graphs[0].path, kept, tuple(muxes.values()), observed)


def _united(first: Node, second: Node) -> Node:
    """Return what two sources of knowledge say of one node; the first one's places stay."""
    return replace(
        first,
        published=_once((*first.published, *second.published)),
        subscribed=_once((*first.subscribed, *second.subscribed)),
        guard=first.guard or second.guard,
    )


def _once(ends: Iterable[Endpoint]) -> tuple[Endpoint, ...]:
    """Return ends with each topic once: its first place, and the first type and rate known."""
    found: dict[str, Endpoint] = {}
    for end in ends:
        known = found.setdefault(end.topic, end)
        if known is not end:
            type_ = end.type if represented(known.type) is None else known.type
            found[end.topic] = replace(known, type=type_, hz=known.hz or end.hz)
    return tuple(found.values())


def represented(written: str | None) -> str | None:
    """Return the representation of a message's type, `None` where it is not known."""
    if written is None or written.strip().lower() in _NO_TYPES:
        return None
    # ROS 1 names C++ templates `Image_`.
    return representation(written.strip().rstrip("_")) or None


def is_command(written: str | None) -> bool:
    """Whether a message of a type tells somebody to move."""
    known = represented(written)
    return known is not None and known.rpartition("::")[2] in COMMANDS


def end_of(topic: str) -> str:
    """Return the module that obeys a topic where no node does: its name without the slash.

    So no node is it, whose names begin with one.
    """
    return topic.lstrip("/") or topic


def configuration_of(graph: Graph) -> Mapped:
    """Return the configuration of a graph: hierarchical, its known nodes described.

    What listens to a command topic is controlled by what publishes on it; where nothing listens, a
    module that is named like the topic is. A mux is contracted into the priorities of what it
    controls, unless something goes past it; then it is a module.
    """
    unread: list[Unread] = []
    sent = {end.topic for node in graph.nodes for end in node.published}
    sent |= {mux.output for mux in graph.muxes}
    nodes = tuple(_without_dropped(node, sent, unread) for node in _typed(graph.nodes))
    if graph.observed:
        nodes = tuple(_taking_part(nodes, unread))
    wiring = _Wiring(nodes, graph.muxes, graph.observed)
    controls, muxed, ends = _commands(wiring)
    modules: dict[str, Name] = {node.name: Name(node.name, node.span) for node in nodes}
    for name in chain(ends, (Name(c.controller, c.span) for c in controls)):
        modules.setdefault(name.text, name)
    loose = _loose_commands(wiring)
    described = (_described(node, wiring, loose) for node in nodes)
    configuration = Configuration(
        graph.path,
        point(graph.path, 1, 1),
        architecture="hierarchical",
        stated=True,
        modules=tuple(modules.values()),
        relationships=(*controls, *_wires(wiring, nodes)),
        declared=tuple(module for module in described if module is not None),
        muxes=muxed,
    )
    return Mapped(configuration, tuple(unread))


class _Wiring:
    """Who publishes and who hears each topic, and which topics are commands."""

    def __init__(self, nodes: Sequence[Node], muxes: Sequence[Mux], observed: bool) -> None:
        self.muxes = muxes
        self.observed = observed
        self.published: dict[str, list[_End]] = {}
        self.subscribed: dict[str, list[_End]] = {}
        for node in nodes:
            for end in node.published:
                self.published.setdefault(end.topic, []).append(_End(node.name, end))
            for end in node.subscribed:
                self.subscribed.setdefault(end.topic, []).append(_End(node.name, end))
        self.heard = {each.topic for mux in muxes for each in mux.inputs}
        self.outputs: dict[str, list[Mux]] = {}
        for mux in muxes:
            self.outputs.setdefault(mux.output, []).append(mux)
        ends = chain.from_iterable((*self.published.values(), *self.subscribed.values()))
        typed = {each.end.topic for each in ends if is_command(each.end.type)}
        self.commands = typed | self.heard | self.outputs.keys()

    def controlled(self, topic: str) -> tuple[str, ...]:
        """Return what obeys the commands on a topic: nodes, or else a module named like it."""
        hearing = tuple(each.node for each in self.subscribed.get(topic, ()))
        if hearing or topic in self.heard or (self.observed and topic not in self.outputs):
            return hearing
        return (end_of(topic),)

    def is_contracted(self, mux: Mux) -> bool:
        """Whether a mux is all that commands one module, which can have its priorities then."""
        return (
            len(self.controlled(mux.output)) == 1
            and mux.output not in self.heard
            and mux.output not in self.published
            and len(self.outputs[mux.output]) == 1
        )


def _typed(nodes: Sequence[Node]) -> tuple[Node, ...]:
    """Return nodes with the types of what is relayed, as far as another node knows them."""
    relays = [node for node in nodes if node.relays]
    types: dict[str, str] = {}
    for node in nodes if relays else ():
        for end in (*node.published, *node.subscribed):
            if end.type is not None and represented(end.type) is not None:
                types.setdefault(end.topic, end.type)
    # A chain of relays hands a type on by one relay each time.
    for _ in relays:
        known = len(types)
        for node in relays:
            ends = (*node.published, *node.subscribed)
            for kind in [types[end.topic] for end in ends if end.topic in types][:1]:
                types |= {end.topic: kind for end in ends if end.topic not in types}
        if len(types) == known:
            break

    def with_types(ends: Iterable[Endpoint]) -> tuple[Endpoint, ...]:
        return tuple(replace(end, type=types.get(end.topic, end.type)) for end in ends)

    return tuple(
        replace(node, published=with_types(node.published), subscribed=with_types(node.subscribed))
        if node.relays
        else node
        for node in nodes
    )


def _without_dropped(node: Node, sent: Collection[str], unread: list[Unread]) -> Node:
    """Return a node without the topics that no robot is about, each of which is noted once.

    Nor does it hear optional ones that nobody has `sent`.
    """
    noted = {each.name for each in unread}

    def kept(ends: Iterable[Endpoint]) -> Iterator[Endpoint]:
        for end in ends:
            sort = _dropped(end.topic)
            if sort is None:
                if not end.optional or end.topic in sent:
                    yield end
            elif end.topic not in noted:
                noted.add(end.topic)
                unread.append(Unread(sort, end.topic, end.span))

    published, subscribed = _once(kept(node.published)), _once(kept(node.subscribed))
    return replace(node, published=published, subscribed=subscribed)


def _taking_part(nodes: Iterable[Node], unread: list[Unread]) -> Iterator[Node]:
    """Yield the nodes that have a topic, and note the others."""
    for node in nodes:
        if node.published or node.subscribed:
            yield node
        else:
            unread.append(Unread("nodes without other topics", node.name, node.span))


def _dropped(topic: str) -> str | None:
    """Return as what sort of topic one is left out, if it is."""
    if "_action" in topic.split("/") or topic.endswith("/action_topics"):
        return "topics of actions"
    if topic.rpartition("/")[2] in _MIDDLEWARE:
        return "topics of the middleware"
    return "debug topics" if _DEBUG.search(topic) else None


def _commands(wiring: _Wiring) -> tuple[list[Control], tuple[Muxed, ...], list[Name]]:
    """Return who commands whom, the muxes on the way, and the modules that no node is."""
    found: dict[tuple[str, str, int], Control] = {}
    muxed: list[Muxed] = []
    ends: list[Name] = []

    def command(controlled: str, line: Control) -> None:
        if controlled != line.controller:
            key = controlled, line.controller, line.priority or 0
            found.setdefault(key, replace(line, controlled=controlled))

    for topic in sorted(wiring.commands):
        publishers = wiring.published.get(topic, ())
        for controlled in wiring.controlled(topic):
            direct = [Control("", p.node, p.end.span, 0) for p in publishers]
            for mux in wiring.outputs.get(topic, ()):
                if wiring.is_contracted(mux):
                    muxed.append(Muxed(controlled, mux.engine, mux.span))
                    direct += _inputs(wiring, mux)
                else:
                    direct.append(Control("", mux.name, mux.span, 0))
            if direct and topic not in wiring.subscribed:
                ends.append(Name(controlled, direct[0].span))
            for line in direct:
                command(controlled, line)
    for mux in wiring.muxes:
        if not wiring.is_contracted(mux):
            muxed.append(Muxed(mux.name, mux.engine, mux.span))
            ends.append(Name(mux.name, mux.span))
            for line in _inputs(wiring, mux):
                command(mux.name, line)
    return list(found.values()), tuple(muxed), ends


def _inputs(wiring: _Wiring, mux: Mux) -> Iterator[Control]:
    """Yield a control of each input of a mux: by what is behind it, or else by its own name.

    One publisher stands where the mux ranks it; of several each stands where it publishes.
    """
    for each in mux.inputs:
        behind = [(p.node, p.end.span) for p in wiring.published.get(each.topic, ())]
        behind += [
            (other.name, other.span)
            for other in wiring.outputs.get(each.topic, ())
            if other is not mux
        ]
        if not behind:
            behind = [(each.name, each.span)]
        for name, span in behind:
            at = each.span if len(behind) == 1 else span
            yield Control("", name, at, each.priority, each.hold_ms)


def _wires(wiring: _Wiring, nodes: Sequence[Node]) -> Iterator[Data]:
    """Yield a relationship for each topic that carries data from one node to another."""
    for node in nodes:
        for end in node.subscribed:
            if end.topic in wiring.commands:
                continue
            port = end.topic
            sources = wiring.published.get(port, ())
            for source in sources:
                # What ran took its own data, too; it would be missing otherwise.
                if source.node != node.name or wiring.observed:
                    # Where several publish, each is to be told from the others.
                    span = (source.end if len(sources) > 1 else end).span
                    yield Data(node.name, source.node, span, client_port=port, source_port=port)


class _Loose(NamedTuple):
    """Command topics that only one side knows: what listens in vain, and what is not heard."""

    inputs: frozenset[str]
    outputs: frozenset[str]


def _loose_commands(wiring: _Wiring) -> _Loose:
    """Return the command topics of an observed graph that lead nowhere or come from nowhere."""
    if not wiring.observed:
        return _Loose(frozenset(), frozenset())
    sent = wiring.published.keys() | wiring.outputs.keys()
    taken = wiring.subscribed.keys() | wiring.heard
    return _Loose(
        frozenset((wiring.commands & wiring.subscribed.keys()) - sent),
        frozenset((wiring.commands & wiring.published.keys()) - taken),
    )


def _described(node: Node, wiring: _Wiring, loose: _Loose) -> Module | None:
    """Return the module that a node is, as far as it exchanges data or sends commands.

    What only obeys stays undescribed, as no graph says how it moves.
    """
    services: list[Service] = []
    commanding = [end for end in node.published if end.topic in wiring.commands]
    obeying = [end for end in node.subscribed if end.topic in wiring.commands]
    for end in node.published:
        if end.topic not in wiring.commands or end.topic in loose.outputs:
            services.append(ports.output(end.topic, represented(end.type), end.span, end.hz))
    for end in node.subscribed:
        if end.topic not in wiring.commands or end.topic in loose.inputs:
            services.append(ports.taken(end.topic, represented(end.type), end.span))
    if commanding or (obeying and services):
        at = (*commanding, *obeying)[0]
        services.append(ports.commands(at.topic, at.span))
    if not services and node.guard is None:
        return None
    return Module(node.name, node.span, tuple(services), named=node.span, guard=node.guard)
