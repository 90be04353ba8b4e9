"""Relays between topics, contracted: a reader of a relay is connected to the original publisher.

A relay without a publisher or without a reader stays a node, so that its unconnected end is found.
"""

from collections import defaultdict
from collections.abc import Collection, Iterable, Iterator, Mapping, Set
from dataclasses import replace
from fractions import Fraction
from typing import NamedTuple

from mars_asp.diagnostic import Span
from mars_asp.exchange import ports
from mars_asp.exchange.graph import is_command
from mars_asp.model.graph import Endpoint, Graph, GraphNode, Relay


class Passage(NamedTuple):
    """A path over relays from topic `source` to topic `target`.

    `span` is the location of its last relay, `hz` the lowest rate of its relays, None without any.
    """

    source: str
    target: str
    span: Span
    hz: Fraction | None


def contracted(graph: Graph) -> tuple[Graph, tuple[Passage, ...], tuple[Relay, ...]]:
    """Return a graph without its relays, the passages over them, and the contracted relays.

    Relays without a publisher or without a reader become nodes.

    Raises:
        MarsError: the relays make more passages than a robot has topics.
    """
    sent = {end.topic for node in graph.nodes for end in node.published}
    sent |= {mux.output for mux in graph.muxes}
    heard = {end.topic for node in graph.nodes for end in node.subscribed}
    heard |= {each.topic for mux in graph.muxes for each in (*mux.inputs, *mux.locks)}
    # What obeys commands need not be a node.
    ends = (end for node in graph.nodes for end in (*node.published, *node.subscribed))
    obeyed = {end.topic for end in ends if is_command(end.type)}
    obeyed |= {mux.output for mux in graph.muxes}
    forth, back = defaultdict[str, list[str]](list), defaultdict[str, list[str]](list)
    for relay in graph.relays:
        forth[relay.source].append(relay.target)
        back[relay.target].append(relay.source)
    fed = reached(sent, forth)
    taken = reached(heard | obeyed, back) | reached(obeyed, forth)
    used = tuple(each for each in graph.relays if each.source in fed and each.target in taken)
    idle = (_relay_node(each) for each in graph.relays if each not in used)
    plain = replace(graph, nodes=(*graph.nodes, *idle), relays=())
    return plain, tuple(_passages(used, sent)), used


def reached(topics: Set[str], ways: Mapping[str, Iterable[str]]) -> set[str]:
    """Return topics and all that are reachable from them; `ways` has the next ones of each."""
    found, waiting = set(topics), list(topics)
    while waiting:
        further = set(ways.get(waiting.pop(), ())) - found
        found |= further
        waiting += further
    return found


def _relay_node(relay: Relay) -> GraphNode:
    published = (Endpoint(relay.target, None, relay.span),)
    subscribed = (Endpoint(relay.source, None, relay.span),)
    return GraphNode(relay.name, relay.span, published, subscribed, relays=True)


def _passages(relays: Iterable[Relay], sent: Collection[str]) -> Iterator[Passage]:
    """Yield the paths over relays that begin at a topic in `sent`, the published topics."""
    after = defaultdict[str, list[Relay]](list)
    for relay in relays:
        after[relay.source].append(relay)
    made = 0
    for source in [topic for topic in after if topic in sent]:
        seen = {source}
        waiting: list[tuple[str, Fraction | None]] = [(source, None)]
        while waiting:
            topic, hz = waiting.pop()
            for relay in after.get(topic, ()):
                if relay.target in seen:
                    continue
                seen.add(relay.target)
                made += 1
                if made > ports.MOST:
                    raise ports.too_many(relay.span)
                lowest = min((rate for rate in (hz, relay.hz) if rate is not None), default=None)
                yield Passage(source, relay.target, relay.span, lowest)
                waiting.append((relay.target, lowest))
