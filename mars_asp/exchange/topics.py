"""Turn a graph of nodes and topics, of ROS launch files or graph dumps, into a configuration.

A node is a module and each of its topics a port. A topic of a command type, from A to B, is
`B is_controlled_by A`; every other one is `B uses_data_from A`. Topics that every node has for its
own administration are left out and counted.
"""

import re
from collections.abc import Collection, Container, Iterable, Iterator, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import chain
from typing import NamedTuple

from mars_asp.diagnostic import Span, whole_file
from mars_asp.exchange import ports
from mars_asp.exchange.cascades import merged
from mars_asp.exchange.graph import each_once, is_command, represented, typed
from mars_asp.exchange.locks import lock_line, lock_names
from mars_asp.exchange.relays import Passage, contracted, reached
from mars_asp.exchange.unread import Unread
from mars_asp.model.declarations import (
    Configuration,
    Control,
    Data,
    Lock,
    Mode,
    Module,
    Muxed,
    Name,
    Service,
)
from mars_asp.model.graph import Endpoint, Graph, GraphNode, Mux, MuxInput

#: The last words of topics that belong to the middleware, not to the robot.
_MIDDLEWARE = frozenset(
    "rosout rosout_agg clock parameter_events parameter_descriptions parameter_updates tf"
    " tf_static diagnostics diagnostics_agg diagnostics_toplevel_state statistics bond"
    " transition_event".split()
)
_PERIODIC = Mode("NotifyAtFrequency", text="NotifyAtFrequency")
#: So deep muxes may feed each other.
_MOST_CASCADED = 16
_DEBUG = re.compile(r"(?:^|[/_])debug(?:[/_]|$)", re.IGNORECASE)


class _End(NamedTuple):
    """A publication or subscription of a node, and the passage (relays) that extends it, if any."""

    node: str
    end: Endpoint
    passage: Passage | None = None

    @property
    def span(self) -> Span:
        """The location that a user would edit to connect this end to another topic."""
        return self.end.span if self.passage is None else self.passage.span

    def lowered(self) -> Fraction | None:
        """Return the rate to which the relays lower the publication, None if they do not."""
        if self.passage is None or self.passage.hz is None:
            return None
        slower = self.end.hz is not None and self.end.hz <= self.passage.hz
        return None if slower else self.passage.hz


def end_of(topic: str) -> str:
    """Return the name of the module that obeys a topic without subscriber: without the slash.

    It differs from all nodes, whose names begin with a slash.
    """
    return topic.lstrip("/") or topic


def configuration_of(graph: Graph) -> tuple[Configuration, Sequence[Unread]]:
    """Return the configuration of a graph, and the contents of the graph that are not in it.

    It is hierarchical, and its known nodes are described.

    The subscribers of a command topic are controlled by its publishers; without subscribers, a
    module with the name of the topic is. A mux is contracted into priorities of the module that it
    controls, unless another command bypasses it; then it is a module. Relays are contracted into
    relationships.

    Raises:
        MarsError: there are more paths over relays than a robot has.
    """
    unread: list[Unread] = []
    graph, passages, relays = contracted(graph)
    sent = {end.topic for node in graph.nodes for end in node.published}
    sent |= {mux.output for mux in graph.muxes} | {passage.target for passage in passages}
    nodes = tuple(_without_dropped(node, sent, unread) for node in typed(graph.nodes))
    if graph.observed:
        alone = (node for node in nodes if not (node.published or node.subscribed))
        unread += (Unread("nodes without other topics", node.name, node.span) for node in alone)
        nodes = tuple(node for node in nodes if node.published or node.subscribed)
    wiring = _Wiring(nodes, graph.muxes, passages, graph.observed)
    wiring = _cascaded(wiring, nodes, passages, unread)
    unread += (
        Unread("rates of throttled commands", relay.name, relay.span)
        for relay in relays
        if relay.hz is not None and relay.source in wiring.commands
    )
    controls, muxed, ends = _control_lines(wiring)
    modules: dict[str, Name] = {node.name: Name(node.name, node.span) for node in nodes}
    for name in chain(ends, (Name(c.controller, c.span) for c in controls)):
        modules.setdefault(name.text, name)
    locks = list(_locks(wiring, muxed, modules))
    for lock in locks:
        modules.setdefault(lock.source, Name(lock.source, lock.span))
    described = (_module_of_node(node, wiring) for node in nodes)
    configuration = Configuration(
        graph.path,
        whole_file(graph.path),
        architecture="hierarchical",
        declares_architecture=True,
        modules=tuple(modules.values()),
        relationships=(*controls, *locks, *_wires(wiring, nodes)),
        declared=tuple(module for module in described if module is not None),
        muxes=muxed,
        relays=tuple(relay.span for relay in relays),
        opaque=tuple(Name(node.name, node.span) for node in nodes if node.unread or node.listens),
    )
    return configuration, unread


def _cascaded(
    wiring: "_Wiring", nodes: Sequence[GraphNode], passages: Sequence[Passage], unread: list[Unread]
) -> "_Wiring":
    """Return a wiring in which a mux that only feeds an input of another is merged into that."""
    for _ in range(_MOST_CASCADED):
        feeding = {mux.name: found for mux in wiring.muxes if (found := wiring.fed_by(mux))}
        feeding = {
            mux.name: feeding[mux.name]
            for mux in wiring.muxes
            if mux.name in feeding and merged(*feeding[mux.name], mux) is not None
        }
        # The innermost first: their numbers are those of what they feed.
        fed = {outer.name for outer, _ in feeding.values()}
        muxes = {mux.name: mux for mux in wiring.muxes}
        for name in [each for each in feeding if each not in fed]:
            outer, slot = feeding[name]
            current = muxes[outer.name]
            now = next(each for each in current.inputs if each.topic == slot.topic)
            whole = merged(current, now, muxes[name])
            if whole is not None:
                unread.append(Unread("timeouts of inputs that a mux feeds", slot.name, slot.span))
                muxes[outer.name] = whole
                del muxes[name]
        if len(muxes) == len(wiring.muxes):
            break
        wiring = _Wiring(nodes, tuple(muxes.values()), passages, wiring.observed)
    return wiring


class _Wiring:
    """The publishers and subscribers of each topic, and which topics are commands."""

    def __init__(
        self,
        nodes: Sequence[GraphNode],
        muxes: Sequence[Mux],
        passages: Sequence[Passage],
        observed: bool,
    ) -> None:
        self.muxes = muxes
        self.observed = observed
        self.published: dict[str, list[_End]] = {}
        self.subscribed: dict[str, list[_End]] = {}
        for node in nodes:
            for end in node.published:
                self.published.setdefault(end.topic, []).append(_End(node.name, end))
            for end in node.subscribed:
                self.subscribed.setdefault(end.topic, []).append(_End(node.name, end))
        self.hearing: dict[str, list[tuple[Mux, MuxInput]]] = {}
        for mux in muxes:
            for each in mux.inputs:
                self.hearing.setdefault(each.topic, []).append((mux, each))
        self.heard = self.hearing.keys()
        self.outputs: dict[str, list[Mux]] = {}
        for mux in muxes:
            self.outputs.setdefault(mux.output, []).append(mux)
        self.passed = {passage.source for passage in passages}
        self._pass_on(passages)
        ends = [*chain.from_iterable((*self.published.values(), *self.subscribed.values()))]
        typed = {each.end.topic for each in ends if is_command(each.end.type)}
        typed -= {each.end.topic for each in ends if each.end.measured}
        ways: dict[str, list[str]] = {}
        for source, target, *_ in passages:
            ways.setdefault(source, []).append(target)
            ways.setdefault(target, []).append(source)
        self.commands = reached(typed | self.heard | self.outputs.keys(), ways)

    def _pass_on(self, passages: Sequence[Passage]) -> None:
        """Add the publishers and muxes of each topic to the topics at the ends of its passages."""
        sent = {
            passage.source: tuple(self.published.get(passage.source, ())) for passage in passages
        }
        muxed = {
            passage.source: tuple(self.outputs.get(passage.source, ())) for passage in passages
        }
        self.ways: dict[str, list[str]] = {mux.output: [mux.output] for mux in self.muxes}
        for passage in passages:
            ends = [_End(node, end, passage) for node, end, _ in sent[passage.source]]
            if ends:
                self.published.setdefault(passage.target, []).extend(ends)
            if muxed[passage.source]:
                self.outputs.setdefault(passage.target, []).extend(muxed[passage.source])
                self.ways[passage.source].append(passage.target)

    def controlled(self, topic: str) -> tuple[str, ...]:
        """Return the nodes that obey the commands on a topic, else a module named like it."""
        hearing = tuple(each.node for each in self.subscribed.get(topic, ()))
        is_on_the_way = topic in self.heard or topic in self.passed
        if hearing or is_on_the_way or (self.observed and topic not in self.outputs):
            return hearing
        return (end_of(topic),)

    def is_command(self, topic: str, *opposite: Container[str]) -> bool:
        """Whether a topic carries commands; in a dump, one of `opposite` must contain it too."""
        is_met = not self.observed or any(topic in each for each in opposite)
        return is_met and topic in self.commands

    def fed_by(self, mux: Mux) -> tuple[Mux, MuxInput] | None:
        """Return the other mux and its input, if `mux` alone feeds it and nothing else, or None."""
        heard = self.heard & set(self.ways[mux.output])
        if len(heard) != 1 or any(map(self.controlled, self.ways[mux.output])):
            return None
        [topic] = heard
        if topic in self.published or len(self.outputs[topic]) > 1:
            return None
        found = self.hearing[topic]
        return found[0] if len(found) == 1 and found[0][0] is not mux else None

    def is_contracted(self, mux: Mux) -> bool:
        """Whether a mux is the only source of commands of one module, which gets its priorities.

        A module that is also a source of the mux would control itself.
        """
        ends = [each for each in self.ways[mux.output] if self.controlled(each)]
        sources = {p.node for each in mux.inputs for p in self.published.get(each.topic, ())}
        return (
            len(ends) == 1
            and len(self.controlled(ends[0])) == 1
            and sources.isdisjoint(self.controlled(ends[0]))
            and not self.heard & set(self.ways[mux.output])
            and ends[0] not in self.published
            and len(self.outputs[ends[0]]) == 1
        )


def _without_dropped(node: GraphNode, sent: Collection[str], unread: list[Unread]) -> GraphNode:
    """Return a node without debug and administrative topics; add each to `unread` once.

    Optional subscriptions to topics that are not in `sent` are left out without a note.
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

    published, subscribed = each_once(kept(node.published)), each_once(kept(node.subscribed))
    return replace(node, published=published, subscribed=subscribed)


def _dropped(topic: str) -> str | None:
    """Return the sort of a topic that is left out (in the plural), or None if it is kept."""
    if "_action" in topic.split("/") or topic.endswith("/action_topics"):
        return "topics of actions"
    if topic.rpartition("/")[2] in _MIDDLEWARE:
        return "topics of the middleware"
    return "topics for debugging" if _DEBUG.search(topic) else None


def _control_lines(wiring: _Wiring) -> tuple[list[Control], tuple[Muxed, ...], list[Name]]:
    """Return the controls between modules, their muxes, and the modules that are not nodes."""
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
            direct = [Control("", p.node, p.span, 0, topic=topic) for p in publishers]
            for mux in wiring.outputs.get(topic, ()):
                if wiring.is_contracted(mux):
                    muxed.append(_muxed(controlled, mux, topic))
                    direct += _mux_controls(wiring, mux)
                else:
                    direct.append(Control("", mux.name, mux.span, 0, topic=topic))
            if direct and topic not in wiring.subscribed:
                ends.append(Name(controlled, direct[0].span))
            for line in direct:
                command(controlled, line)
    for mux in wiring.muxes:
        if not wiring.is_contracted(mux):
            muxed.append(_muxed(mux.name, mux, mux.output))
            ends.append(Name(mux.name, mux.span))
            for line in _mux_controls(wiring, mux):
                command(mux.name, line)
    return list(found.values()), tuple(muxed), ends


def _locks(wiring: _Wiring, muxed: Iterable[Muxed], taken: Collection[str]) -> Iterator[Lock]:
    """Yield the locks of muxes: by the publishers of their topics, else by their names.

    Names in `taken` belong to other modules.
    """
    modules = {each.name: each.module for each in muxed}
    for mux in wiring.muxes:
        unheard = tuple(each for each in mux.locks if not wiring.published.get(each.topic))
        names = lock_names(replace(mux, locks=unheard), "", {*taken, *(i.name for i in mux.inputs)})
        for lock in mux.locks:
            ends = wiring.published.get(lock.topic, ())
            for node, end, _ in ends:
                span = lock.span if len(ends) == 1 else end.span
                yield lock_line(modules[mux.name], node, lock, span, end.topic)
            if not ends:
                yield lock_line(modules[mux.name], names[lock], lock)


def _muxed(module: str, mux: Mux, topic: str) -> Muxed:
    return Muxed(module, mux.engine, mux.span, mux.numbers, mux.inner, mux.name, topic)


def _mux_controls(wiring: _Wiring, mux: Mux) -> Iterator[Control]:
    """Yield the controls of each input of a mux: by its publishers, else by the input's name.

    The location is the input of the mux or, of several publishers, where each publishes.
    """
    for each in mux.inputs:
        after = [(p.node, p.span) for p in wiring.published.get(each.topic, ())]
        after += [
            (other.name, other.span)
            for other in wiring.outputs.get(each.topic, ())
            if other is not mux
        ]
        if not after:
            after = [(each.name, each.span)]
        for name, span in after:
            at = each.span if len(after) == 1 else span
            yield Control("", name, at, each.priority, each.hold_ms, topic=each.topic)


def _wires(wiring: _Wiring, nodes: Sequence[GraphNode]) -> Iterator[Data]:
    """Yield a relationship for each topic that carries data from one node to another."""
    for node in nodes:
        for end in node.subscribed:
            if end.topic in wiring.commands:
                continue
            port = end.topic
            sources = wiring.published.get(port, ())
            for source in sources:
                # An observed node did receive its own data: without this they would be missing.
                if source.node != node.name or wiring.observed:
                    # The locations of several publishers have to differ.
                    hz = source.lowered()
                    yield Data(
                        node.name,
                        source.node,
                        source.span if len(sources) > 1 or source.passage else end.span,
                        None if hz is None else _PERIODIC,
                        hz,
                        client_port=port,
                        source_port=source.end.topic,
                    )


def _module_of_node(node: GraphNode, wiring: _Wiring) -> Module | None:
    """Return the module of a node, or None if it neither exchanges data nor sends commands.

    A node that only obeys commands has no description, as no graph states how it moves. In an
    observed graph, commands without a subscriber or without a publisher are data.
    """
    services: list[Service] = []
    commanding = [end for end in node.published if end.topic in wiring.commands]
    obeying = [end for end in node.subscribed if end.topic in wiring.commands]
    for end in node.published:
        if not wiring.is_command(end.topic, wiring.subscribed, wiring.heard, wiring.passed):
            services.append(ports.output(end.topic, represented(end.type), end.span, end.hz))
    for end in node.subscribed:
        if not wiring.is_command(end.topic, wiring.published, wiring.outputs):
            services.append(ports.taken(end.topic, represented(end.type), end.span))
    guard = None
    if commanding or (obeying and (services or node.guard)):
        at = (*commanding, *obeying)[0]
        services.append(ports.commands(at.topic, at.span))
        guard = node.guard
    if not services:
        return None
    return Module(node.name, node.span, tuple(services), named=node.span, guard=guard)
