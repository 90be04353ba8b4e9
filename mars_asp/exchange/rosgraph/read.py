"""Dumps of a graph as a configuration: nodes as modules, topics as their ports."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

from mars_asp.diagnostic import Diagnostic, MarsError, whole_file
from mars_asp.exchange.graph import is_command, joined
from mars_asp.exchange.recognise import dump_of, recognised
from mars_asp.exchange.rosgraph.caret import read_caret
from mars_asp.exchange.rosgraph.dot import read_dot
from mars_asp.exchange.rosgraph.dump import Dump
from mars_asp.exchange.rosgraph.node_info import read_node_info
from mars_asp.exchange.rosgraph.rosdiscover import read_rosdiscover
from mars_asp.exchange.rosgraph.topic_info import read_topic_info
from mars_asp.exchange.topics import configuration_of
from mars_asp.exchange.twist_mux.document import read_documents
from mars_asp.exchange.unread import Unread, notes
from mars_asp.language import Parsed
from mars_asp.model.graph import Graph, GraphNode, Mux

#: The help on an unknown file.
_KNOWN = (
    "give one of ROSDiscover, CARET, rqt_graph (.dot), `ros2 node info` or `ros2 topic info -v`"
)
_READERS: Mapping[str, Callable[[str, str], Dump]] = {
    "rosdiscover": read_rosdiscover,
    "caret": read_caret,
    "dot": read_dot,
    "node_info": read_node_info,
    "topic_info": read_topic_info,
}


def import_rosgraph(files: Sequence[tuple[str, str]]) -> Parsed:
    """Return the configuration of dumps of one robot, each a text and its path.

    Files with the parameters of muxes give priorities to the inputs of nodes in the dumps. Notes
    list skipped contents.

    Raises:
        MarsError: all errors of the files.
    """
    graphs: list[Graph] = []
    problems: list[Diagnostic] = []
    unread: list[Unread] = []
    warnings: list[Diagnostic] = []
    of_muxes: list[tuple[str, str]] = []
    for text, path in files:
        try:
            kind = dump_of(text)
            if kind is None and recognised(text) == "twist_mux":
                of_muxes.append((text, path))
                continue
            if kind is None:
                message, span = "this is not a known kind of graph dump", whole_file(path)
                raise MarsError((Diagnostic("rosgraph", "error", message, span, help=_KNOWN),))
            dump = _READERS[kind](text, path)
        except MarsError as error:
            problems += error.diagnostics
            continue
        graphs.append(dump.graph(path))
        problems += dump.problems
        unread += dump.unread
    muxes: list[Mux] = []
    try:
        for document in read_documents(of_muxes):
            muxes += document.muxes
            unread += document.unread
            warnings += document.warnings
    except MarsError as error:
        problems += error.diagnostics
    if not problems and not any(graph.nodes for graph in graphs):
        problems.append(_empty(files[0][1]))
    if problems:
        raise MarsError(problems)
    graph = joined(graphs)
    bound = replace(graph, nodes=(), muxes=tuple(_mux(mux, _node_of(mux, graph)) for mux in muxes))
    configuration, further = configuration_of(joined((graph, bound)))
    if not configuration.modules:
        raise MarsError((_empty(files[0][1]),))
    first: dict[tuple[str, str], Unread] = {}
    for each in (*unread, *further):
        first.setdefault((each.sort, each.name), each)
    return Parsed(configuration, (*warnings, *notes(first.values())))


def _empty(path: str) -> Diagnostic:
    message = "no node has a topic that is read"
    help_text = "give the dump of a running robot"
    return Diagnostic("rosgraph", "error", message, whole_file(path), help=help_text)


# ---- Muxes with parameter files ------------------------------------------------------------------


def _node_of(mux: Mux, graph: Graph) -> GraphNode | None:
    """Return the node that subscribes to an input of a mux and has its name if any, or None."""
    called = mux.name.rpartition("/")[2]
    for node in graph.nodes:
        hears = any(_heard(each.topic, node) for each in mux.inputs)
        if hears and (not called or node.name.rpartition("/")[2] == called):
            return node
    return None


def _heard(topic: str, node: GraphNode) -> str | None:
    """Return the full name of the subscribed topic that parameters call `topic`, or None."""
    wanted = "/" + topic.lstrip("/")
    names = [end.topic for end in node.subscribed]
    return next((name for name in names if name == wanted or name.endswith(wanted)), None)


def _mux(mux: Mux, node: GraphNode | None) -> Mux:
    """Return a mux with full names; its output is the node's only command topic, if it has one."""
    sent = [] if node is None else [end.topic for end in node.published if is_command(end.type)]
    inputs, locks = (
        tuple(
            replace(each, topic=(node and _heard(each.topic, node)) or "/" + each.topic.lstrip("/"))
            for each in found
        )
        for found in (mux.inputs, mux.locks)
    )
    name = f"/{mux.name or 'twist_mux'}" if node is None else node.name
    output = sent[0] if len(sent) == 1 else "/" + mux.output.lstrip("/")
    return replace(mux, name=name, output=output, inputs=inputs, locks=locks)
