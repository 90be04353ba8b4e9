"""Nodes and topics, and the relationships made of them."""

from dataclasses import replace

import pytest

from mars_asp.diagnostic import Span
from mars_asp.exchange.graph import is_command, joined, represented
from mars_asp.exchange.lift import lifted
from mars_asp.exchange.topics import configuration_of
from mars_asp.language.print import print_relationship
from mars_asp.model.graph import Endpoint, Graph, GraphNode, Mux, MuxInput, Relay

TWIST, SCAN = "geometry_msgs/msg/Twist", "sensor_msgs/msg/LaserScan"


def at(line: int) -> Span:
    return Span("x", line, 1, line, 2)


def node(name: str, out: str = "", taken: str = "", line: int = 1) -> GraphNode:
    """A node with topics in words, those that begin with `c` of commands."""

    def ends(topics: str) -> tuple[Endpoint, ...]:
        kinds = ((f"/{topic}", TWIST if topic[0] == "c" else SCAN) for topic in topics.split())
        return tuple(Endpoint(topic, kind, at(line)) for topic, kind in kinds)

    return GraphNode(f"/{name}", at(line), ends(out), ends(taken))


def mux(name: str, output: str, *inputs: tuple[str, int]) -> Mux:
    heard = tuple(MuxInput(topic, f"/{topic}", at(90), rank, 500) for topic, rank in inputs)
    return Mux(f"/{name}", "twist_mux", at(90), f"/{output}", heard)


def lines(*nodes: GraphNode, muxes: tuple[Mux, ...] = ()) -> list[str]:
    found = configuration_of(Graph("x", nodes, muxes))[0]
    return [print_relationship(line) for line in found.relationships]


WIRED = [
    ((node("a", "s"), node("b", "", "s")), ["/b./s uses_data_from /a./s"]),
    ((node("a", "s", "s"),), []),
    ((node("a", "c"), node("b", "", "c")), ["/b is_controlled_by /a 0"]),
    ((node("a", "c", "c"),), []),
    ((node("a", "c"), node("b", "c")), ["c is_controlled_by /a 0", "c is_controlled_by /b 0"]),
    ((node("a", "c cc"), node("b", "", "c cc")), ["/b is_controlled_by /a 0"]),
    ((node("a", "tf s/debug clock"), node("b", "", "tf s/debug clock")), []),
    ((node("a", "", "c"),), []),
]


@pytest.mark.parametrize(("nodes", "expected"), WIRED)
def test_topics_are_wires(nodes: tuple[GraphNode, ...], expected: list[str]) -> None:
    assert lines(*nodes) == expected


@pytest.mark.parametrize(
    ("nodes", "relays", "source"),
    [
        ((), (), "stop"),
        ((node("ca"),), (), "stop"),
        ((node("pad", "ca s"), node("log", "", "s")), (), "/pad./s"),
        ((node("pad", "far"),), (Relay("/r", at(5), "/far", "/s"),), "/pad./far"),
    ],
)
def test_a_lock_is_the_publisher_of_its_topic(
    nodes: tuple[GraphNode, ...], relays: tuple[Relay, ...], source: str
) -> None:
    lock = MuxInput("stop", "/s", at(91), 50, 300)
    locked = replace(mux("m", "cout", ("ca", 10)), locks=(lock,))
    found = configuration_of(Graph("x", nodes, (locked,), relays=relays))[0]
    assert f"cout is_locked_by {source} 50 hold 300" in map(print_relationship, found.relationships)
    assert source.partition(".")[0] in [name.text for name in found.modules]
    shape = lifted(found)
    splitter = "DataSplitter1" if len(nodes) == 2 else source
    line = f"ArbitrationNode is_locked_by {splitter} 50 hold 300"
    assert line in map(print_relationship, shape.relationships)


def test_muxes_with_locks_are_not_merged() -> None:
    outer, inner = mux("m", "cout", ("ca", 10), ("cb", 5)), mux("n", "ca", ("cc", 3))
    lock = MuxInput("stop", "/s", at(91), 4, "forever")
    assert "/m is_locked_by stop 4" not in lines(muxes=(outer, inner))
    found = lines(muxes=(outer, replace(inner, locks=(lock,))))
    assert {"cout is_controlled_by /n 10 hold 500", "/n is_locked_by stop 4"} <= {*found}


def test_a_mux_is_contracted_into_the_node_that_it_controls() -> None:
    found = lines(
        node("a", "ca"),
        node("b", "cb"),
        node("d", "cb"),
        node("base", "", "c"),
        muxes=(mux("m", "c", ("ca", 9), ("cb", 5), ("no", 1)),),
    )
    assert found == [
        "/base is_controlled_by /a 9 hold 500",
        "/base is_controlled_by /b 5 hold 500",
        "/base is_controlled_by /d 5 hold 500",
        "/base is_controlled_by no 1 hold 500",
    ]


def test_a_publisher_that_bypasses_a_mux_is_listed_beside_it() -> None:
    assert lines(node("a", "ca"), node("b", "c"), muxes=(mux("m", "c", ("ca", 9)),)) == [
        "c is_controlled_by /b 0",
        "c is_controlled_by /m 0",
        "/m is_controlled_by /a 9 hold 500",
    ]


def test_two_muxes_with_one_output_and_a_chain_of_muxes_are_seen() -> None:
    assert lines(muxes=(mux("m", "c", ("ca", 9)), mux("n", "c", ("cb", 9)))) == [
        "c is_controlled_by /m 0",
        "c is_controlled_by /n 0",
        "/m is_controlled_by ca 9 hold 500",
        "/n is_controlled_by cb 9 hold 500",
    ]
    assert lines(muxes=(mux("m", "cn", ("ca", 9)), mux("n", "c", ("cn", 8)))) == [
        "c is_controlled_by ca 9 hold 500",
    ]


def test_relays_have_the_types_of_their_messages() -> None:
    def relay(name: str, taken: str, out: str) -> GraphNode:
        sent, heard = (Endpoint(topic, "any", at(1)) for topic in (out, taken))
        return GraphNode(name, at(1), (sent,), (heard,), relays=True)

    assert lines(relay("/r", "/x", "/y"), relay("/q", "/ca", "/x"), node("a", "ca")) == [
        "/q is_controlled_by /a 0",
        "/r is_controlled_by /q 0",
        "y is_controlled_by /r 0",
    ]


def test_optional_topics_are_read_if_they_are_published() -> None:
    wanting = node("b", "", "s")
    optional = replace(wanting, subscribed=(replace(wanting.subscribed[0], optional=True),))
    assert configuration_of(Graph("x", (optional,)))[0].declared == ()
    assert lines(node("a", "s"), optional) == ["/b./s uses_data_from /a./s"]


def test_each_of_several_publishers_has_its_own_line() -> None:
    graph = Graph("x", (node("a", "s", line=2), node("b", "s", line=3), node("d", "", "s", line=4)))
    found = configuration_of(graph)[0]
    assert [line.span.line for line in found.relationships] == [2, 3]


def test_nodes_of_one_name_are_one() -> None:
    graph = joined((Graph("x", (node("a", "s"),)), Graph("y", (node("a", "s t", "u", line=7),))))
    [both] = graph.nodes
    assert [(end.topic, end.span.line) for end in both.published] == [("/s", 1), ("/t", 7)]


def test_types_as_they_are_written() -> None:
    assert represented("geometry_msgs/msg/Twist") == represented("geometry_msgs::Twist")
    assert represented("any") is represented("unknown type") is represented(None) is None
    assert is_command("geometry_msgs::msg::TwistStamped")
    assert not is_command("sensor_msgs/msg/Joy")
