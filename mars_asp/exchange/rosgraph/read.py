"""Dumps of a graph as a configuration: nodes as modules, topics as their ports."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import NamedTuple

from mars_asp.diagnostic import Diagnostic, MarsError, Span, point
from mars_asp.exchange import ports
from mars_asp.exchange.recognise import dump_of
from mars_asp.exchange.rosgraph.caret import read_caret
from mars_asp.exchange.rosgraph.dot import read_dot
from mars_asp.exchange.rosgraph.graph import End, Graph, united
from mars_asp.exchange.rosgraph.node_info import read_node_info
from mars_asp.exchange.rosgraph.rosdiscover import read_rosdiscover
from mars_asp.exchange.rosgraph.topic_info import read_topic_info
from mars_asp.exchange.unread import Unread, notes
from mars_asp.language import Parsed
from mars_asp.language.print import print_module
from mars_asp.model.declarations import (
    Configuration,
    Control,
    Data,
    Module,
    Name,
    Relationship,
    Service,
)

#: The types by which one node commands another.
COMMANDS = frozenset(
    "Twist TwistStamped AckermannDrive AckermannDriveStamped JointTrajectory".split()
)
_READERS: Mapping[str, Callable[[str, str], Graph]] = {
    "rosdiscover": read_rosdiscover,
    "caret": read_caret,
    "dot": read_dot,
    "node_info": read_node_info,
    "topic_info": read_topic_info,
}


class _Topic(NamedTuple):
    """A topic: who publishes it and who subscribes to it."""

    publishers: list[End]
    subscribers: list[End]

    def commands(self) -> bool:
        """Whether one node commands another by it, whichever of its ends tells the type."""
        types = {end.type for end in (*self.publishers, *self.subscribers)} - {None}
        if len(types) != 1:
            return False
        (only,) = types
        return str(only).rpartition("::")[2] in COMMANDS and any(True for _ in self.pairs())

    def pairs(self) -> Iterator[tuple[End, End]]:
        """Yield each subscriber with each publisher that is another node."""
        for subscriber in self.subscribers:
            for publisher in self.publishers:
                if publisher.node != subscriber.node:
                    yield subscriber, publisher


def import_rosgraph(files: Sequence[tuple[str, str]]) -> Parsed:
    """Return the configuration of dumps of one robot, each a text and its path.

    A topic of a command type makes its publishers controllers of its subscribers, all with priority
    0; any other makes its subscribers clients of its publishers. Notes list what was not read.

    Raises:
        MarsError: all that is wrong with the dumps.
    """
    graphs: list[Graph] = []
    problems: list[Diagnostic] = []
    for text, path in files:
        try:
            graphs.append(_READERS[_kind(text, path)](text, path))
        except MarsError as error:
            problems += error.diagnostics
    graph = united(graphs)
    problems += graph.problems
    problems += _badly_named(graph)
    if problems:
        raise MarsError(problems)
    configuration = _configuration(graph, files[0][1])
    return Parsed(
        configuration, tuple(notes(graph.unread)), tuple(map(print_module, configuration.declared))
    )


def _kind(text: str, path: str) -> str:
    """Return which kind of dump a text is.

    Raises:
        MarsError: it is none.
    """
    kind = dump_of(text)
    if kind is None:
        message = "this is no dump of a graph that is known"
        help_text = (
            "give one of ROSDiscover, CARET, rqt_graph (.dot), `ros2 node info` or"
            " `ros2 topic info -v`"
        )
        found = Diagnostic("rosgraph", "error", message, point(path, 1, 1), help=help_text)
        raise MarsError((found,))
    return kind


def _badly_named(graph: Graph) -> Iterator[Diagnostic]:
    """Yield an error for each name that no configuration can write."""
    named = [*graph.nodes.items(), *((end.topic, end.span) for end in graph.ends)]
    bad = set(ports.unwritable({name for name, _ in named}))
    for name, span in named:
        if name in bad:
            message = f"`{name[:40]}` cannot be a name"
            yield Diagnostic("rosgraph", "error", message, span, help="write a name of one line")


def _configuration(graph: Graph, path: str) -> Configuration:
    """Return the configuration of a graph; nodes without any topic are noted in it."""
    topics: dict[str, _Topic] = {}
    for end in graph.ends:
        topic = topics.setdefault(end.topic, _Topic([], []))
        (topic.publishers if end.out else topic.subscribers).append(end)
    commanding = {name for name, topic in topics.items() if topic.commands()}
    taking_part = {end.node for end in graph.ends}
    for name, span in graph.nodes.items():
        if name not in taking_part:
            graph.unread.append(Unread("nodes without other topics", name, span))
    named = tuple(Name(name, span) for name, span in graph.nodes.items() if name in taking_part)
    if not named:
        message = "no node has a topic that is read"
        help_text = "give the dump of a running robot"
        problem = Diagnostic("rosgraph", "error", message, point(path, 1, 1), help=help_text)
        raise MarsError((problem,))
    return Configuration(
        path,
        point(path, 1, 1),
        architecture="hierarchical",
        stated=True,
        modules=named,
        relationships=tuple(_relationships(topics, commanding)),
        declared=tuple(_modules(named, graph.ends, commanding)),
    )


def _relationships(
    topics: Mapping[str, _Topic], commanding: frozenset[str] | set[str]
) -> Iterator[Relationship]:
    """Yield who takes data from whom, and who commands whom, each pair once."""
    commanded: set[tuple[str, str]] = set()
    for name, topic in topics.items():
        if name in commanding:
            for subscriber, publisher in topic.pairs():
                pair = subscriber.node, publisher.node
                if pair not in commanded:
                    commanded.add(pair)
                    yield Control(*pair, publisher.span, priority=0)
            continue
        for subscriber in topic.subscribers:
            for publisher in topic.publishers:
                # Where several publish, each is to be told from the others.
                span = (publisher if len(topic.publishers) > 1 else subscriber).span
                yield Data(
                    subscriber.node,
                    publisher.node,
                    span,
                    client_port=name,
                    source_port=name,
                )


def _modules(
    named: Iterable[Name], ends: Iterable[End], commanding: frozenset[str] | set[str]
) -> Iterator[Module]:
    """Yield a description of each node but those of which only commands are known.

    A node that is commanded hands commands on to what is no node: no graph says that it moves.
    """
    by_node: dict[str, list[End]] = {}
    for end in ends:
        by_node.setdefault(end.node, []).append(end)
    for name in named:
        own = by_node[name.text]
        if all(end.topic in commanding and not end.out for end in own):
            continue
        services = tuple(_services(own, commanding))
        yield Module(name.text, name.span, services, named=name.span)


def _services(own: Iterable[End], commanding: frozenset[str] | set[str]) -> Iterator[Service]:
    """Yield the ports of a node, and one service for all that it commands."""
    through: Span | None = None
    for end in own:
        if end.topic in commanding:
            if through is None:
                through = end.span
                yield ports.commands(end.topic, end.span)
        elif end.out:
            yield ports.output(end.topic, end.type, end.span, end.hz)
        else:
            yield ports.taken(end.topic, end.type, end.span)
