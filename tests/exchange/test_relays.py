"""Relays, throttles and muxes of topic_tools: forwarded topics, and their relationships."""

from fractions import Fraction

import pytest

from mars_asp.exchange.lift import lifted
from mars_asp.exchange.ros2.glue import Forward, handed_on
from mars_asp.exchange.ros2.launch_markup import read_markup
from mars_asp.exchange.ros2.parameters import GivenParameter, values_for
from mars_asp.exchange.ros2.programs import RosProgram
from mars_asp.exchange.topics import configuration_of
from mars_asp.exchange.yaml_document import read_yaml
from mars_asp.language.print import print_relationship
from mars_asp.model.graph import Endpoint, Graph, GraphNode, Mux, Relay
from mars_asp.model.rates import Rate
from tests.exchange.test_topics import TWIST, at, mux, node
from tests.support.processes import takes_at_most


def relay(source: str, target: str, hz: str | None = None) -> Relay:
    name = f"/{source}_{target}"
    return Relay(name, at(80), f"/{source}", f"/{target}", None if hz is None else Fraction(hz))


def lines(*parts: GraphNode | Mux | Relay, observed: bool = False, lift: bool = False) -> list[str]:
    graph = Graph(
        "x",
        tuple(part for part in parts if isinstance(part, GraphNode)),
        tuple(part for part in parts if isinstance(part, Mux)),
        observed,
        relays=tuple(part for part in parts if isinstance(part, Relay)),
    )
    found = configuration_of(graph)[0]
    shape = lifted(found) if lift else found
    return [print_relationship(line) for line in shape.relationships]


A, B = node("a", "s"), node("b", "", "t")
CONTRACTED = [
    # Data pass a relay, and a throttle at its rate.
    ((A, B, relay("s", "t")), ["/b./t uses_data_from /a./s"]),
    ((A, B, relay("s", "t", "5")), ["/b./t uses_data_from /a./s NotifyAtFrequency 5"]),
    ((A, B, relay("s", "u"), relay("u", "t")), ["/b./t uses_data_from /a./s"]),
    (
        (A, B, relay("s", "u", "5"), relay("u", "t", "9")),
        ["/b./t uses_data_from /a./s NotifyAtFrequency 5"],
    ),
    # A way in a circle leads nowhere twice.
    ((A, B, relay("s", "t"), relay("t", "s")), ["/b./t uses_data_from /a./s"]),
    (
        (A, B, node("c", "t"), relay("s", "t")),
        ["/b./t uses_data_from /c./t", "/b./t uses_data_from /a./s"],
    ),
    # One that hears nothing, or that nothing hears, stays a node.
    ((B, relay("s", "t")), ["/b./t uses_data_from /s_t./t"]),
    ((A, relay("s", "t")), ["/s_t./s uses_data_from /a./s"]),
    # Commands pass as commands, to what obeys them.
    ((node("a", "c"), node("b", "", "cc"), relay("c", "cc")), ["/b is_controlled_by /a 0"]),
    ((node("a", "c"), relay("c", "cc")), ["cc is_controlled_by /a 0"]),
    (
        (node("a", "c"), node("b", "", "cc"), node("d", "", "c"), relay("c", "cc", "3")),
        ["/d is_controlled_by /a 0", "/b is_controlled_by /a 0"],
    ),
    # Before a mux a relay is a link, after a mux it is a renaming.
    (
        (node("a", "c"), mux("m", "cm", ("cc", 7)), relay("c", "cc")),
        ["cm is_controlled_by /a 7 hold 500"],
    ),
    (
        (node("a", "c"), node("b", "", "cb"), mux("m", "cm", ("c", 7)), relay("cm", "cb")),
        ["/b is_controlled_by /a 7 hold 500"],
    ),
    # What goes past the mux by a relay is found.
    (
        (
            node("a", "c"),
            node("n", "cn"),
            node("b", "", "cm"),
            mux("m", "cm", ("c", 7)),
            relay("cn", "cm"),
        ),
        [
            "/b is_controlled_by /n 0",
            "/b is_controlled_by /m 0",
            "/m is_controlled_by /a 7 hold 500",
        ],
    ),
    # A mux that reaches two ends is a module, as they share its decision.
    (
        (
            node("a", "c"),
            node("b", "", "cm"),
            node("d", "", "cd"),
            mux("m", "cm", ("c", 7)),
            relay("cm", "cd"),
        ),
        [
            "/d is_controlled_by /m 0",
            "/b is_controlled_by /m 0",
            "/m is_controlled_by /a 7 hold 500",
        ],
    ),
]  # fmt: skip


@pytest.mark.parametrize(("parts", "expected"), CONTRACTED)
def test_relays_are_contracted_into_edges(
    parts: tuple[GraphNode | Mux | Relay, ...], expected: list[str]
) -> None:
    assert sorted(lines(*parts)) == sorted(expected)


def test_a_throttle_that_is_faster_than_its_source_lowers_nothing() -> None:
    slow = GraphNode("/a", at(1), (Endpoint("/s", "x/msg/Y", at(1), Fraction(2)),))
    assert lines(slow, B, relay("s", "t", "5")) == ["/b./t uses_data_from /a./s"]


def test_a_relay_and_a_throttle_are_outputs_of_one_splitter() -> None:
    parts = (A, B, node("d", "", "s"), node("e", "", "u"), relay("s", "t"), relay("s", "u", "5"))
    assert lines(*parts, lift=True) == [
        "DataSplitter1 uses_data_from /a./s",
        "/b./t uses_data_from DataSplitter1",
        "/d./s uses_data_from DataSplitter1",
        "/e./u uses_data_from DataSplitter1 NotifyAtFrequency 5",
    ]
    assert lines(A, B, relay("s", "t"), lift=True) == ["/b./t uses_data_from /a./s"]
    assert lines(A, B, relay("s", "t", "5"), lift=True) == [
        "DataSplitter1 uses_data_from /a./s",
        "/b./t uses_data_from DataSplitter1 NotifyAtFrequency 5",
    ]


def test_the_type_after_a_relay_makes_its_input_a_command() -> None:
    unknown = GraphNode("/a", at(1), (Endpoint("/go", None, at(1)),))
    obeys = GraphNode("/b", at(2), (), (Endpoint("/wheels", TWIST, at(2)),))
    assert lines(unknown, obeys, relay("go", "wheels")) == ["/b is_controlled_by /a 0"]


def test_chains_of_relays_are_walked_within_seconds() -> None:
    chain = [relay(f"s{n}", f"s{n + 1}") for n in range(2000)]
    found = lines(node("a", "s0"), node("b", "", "s2000"), *chain)
    assert found == ["/b./s2000 uses_data_from /a./s0"]


def values(text: str) -> dict[str, GivenParameter]:
    return values_for(read_yaml(text, "x"), "/n")


SELECT = "topics that a mux of topic_tools can select later"
AMOUNT = "amounts that are delayed, dropped or limited in bytes"
#: What is called with which words and parameters, and what it hands on.
CALLED = [
    ("relay", "a", "{}", Forward("a", "a_relay")),
    ("relay", "a b", "{}", Forward("a", "b")),
    ("relay", "", "{input_topic: a}", Forward("a", "a_relay")),
    ("relay", "a b", "{input_topic: c, output_topic: d}", Forward("c", "d")),
    ("relay", "", "{}", None),
    ("throttle", "messages a 2.5", "{}", Forward("a", "a_throttle", Rate(Fraction("2.5")))),
    ("throttle", "messages a 2 b", "{}", Forward("a", "b", Rate(Fraction(2)))),
    (
        "throttle",
        "messages a fast b",
        "{}",
        Forward("a", "b", None, (("rates of throttles", "b"),)),
    ),
    ("throttle", "bytes a 1024 1.0 b", "{}", Forward("a", "b", None, ((AMOUNT, "b"),))),
    (
        "throttle",
        "",
        "{input_topic: a, throttle_type: messages, msgs_per_sec: 4.0}",
        Forward("a", "a_throttle", Rate(Fraction(4))),
    ),
    ("drop", "a 1 2", "{}", Forward("a", "a_drop", None, ((AMOUNT, "a_drop"),))),
    ("delay", "a 0.5 b", "{}", Forward("a", "b", None, ((AMOUNT, "b"),))),
    ("mux", "o a b", "{}", Forward("a", "o", None, ((SELECT, "b"),))),
    ("mux", "o a b", "{initial_topic: b}", Forward("b", "o", None, ((SELECT, "a"),))),
    ("mux", "o a b", "{initial_topic: __none}", None),
    ("mux", "", "{input_topics: [a, b]}", Forward("a", "~/selected", None, ((SELECT, "b"),))),
    ("demux", "a o p", "{}", Forward("a", "o", None, ((SELECT, "p"),))),
    ("transform", "a b", "{}", None),
]  # fmt: skip


@pytest.mark.parametrize(("executable", "words", "parameters", "expected"), CALLED)
def test_arguments_decide_the_topics_that_a_tool_forwards(
    executable: str, words: str, parameters: str, expected: Forward | None
) -> None:
    program = RosProgram("topic_tools", executable, False)
    assert handed_on(program, words.split(), values(parameters)) == expected


def test_components_and_the_relay_of_a_joystick_are_known() -> None:
    given = values("{input_topic: a}")
    component = RosProgram("topic_tools", "topic_tools::RelayNode", True)
    assert handed_on(component, (), given) == Forward("a", "a_relay")
    joystick = handed_on(RosProgram("twist_mux", "joystick_relay.py", False), (), {})
    assert joystick is not None
    assert (joystick.source, joystick.target) == ("joy_vel_in", "joy_vel_out")


def test_parameters_within_an_element_have_their_own_locations() -> None:
    text = '<launch>\n  <node pkg="p" type="t" name="n">\n    <rosparam>\n      a: {b: [1, 2]}\n'
    [start] = read_markup(f"{text}    </rosparam>\n  </node>\n</launch>", "x.launch")
    [parameter] = start.parameters  # type: ignore[union-attr]
    places = [(span.line, span.column) for _, span in parameter.keys]
    assert places == [(4, 7), (4, 11)]


def test_many_written_parameters_on_a_line_are_read_in_seconds() -> None:
    many = "<rosparam>a: 1</rosparam>" * 3000
    node = f'<node pkg="p" type="t" name="n">{many}</node>'
    with takes_at_most(5):
        [start] = read_markup(f"<launch>{chr(10) * 400_000}{node}</launch>", "x.launch")
    assert len(start.parameters) == 3000  # type: ignore[union-attr]
