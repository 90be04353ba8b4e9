"""Runs of modules, transformers and effectors."""

from typing import Any

import pytest

from mars_asp.behaviour.command import command_of
from mars_asp.execution.executor import Behaviour, Executor
from tests.support.execute_builders import (
    Inbox,
    control_out,
    counter,
    data_out,
    effector,
    executed,
    ms,
    sensor,
    sink,
)
from tests.support.refusals import refusals


def test_an_algorithm_computes_with_the_latest_of_each_input_once_all_have_arrived() -> None:
    inbox = Inbox()
    executed(
        "D uses_data_from S\nD uses_data_from T\nA uses_data_from D",
        [sensor("S"), sensor("T"), data_out("D"), sink("A")],
        {
            "S": Behaviour(counter(), ms(100)),
            "T": Behaviour(counter(), ms(250), delay=ms(150)),
            "D": lambda s, t: (s, t),
            "A": inbox,
        },
        0.4,
    )
    assert inbox.got == [(150, (1, 0)), (200, (2, 0)), (300, (3, 0)), (400, (4, 1))]


def test_an_algorithm_at_a_frequency_uses_the_input_of_its_instant() -> None:
    inbox = Inbox()
    executed(
        "D uses_data_from S\nA uses_data_from D",
        [
            sensor("S", "NotifyAtFrequency", 50),
            data_out("D", "NotifyAtFrequency", 10),
            sink("A"),
        ],
        {"S": counter(), "D": lambda x: x, "A": inbox},
        0.2,
    )
    assert inbox.got == [(0, 0), (100, 5), (200, 10)]


def test_an_algorithm_in_a_conditional_mode_computes_on_each_input_and_sends_some() -> None:
    inbox, called = Inbox(), []

    def double(x: int) -> int:
        called.append(x)
        return 2 * x

    executed(
        "D uses_data_from S\nA uses_data_from D",
        [sensor("S", "NotifyAtFrequency", 10), data_out("D", "NotifyOnMax(4)"), sink("A")],
        {"S": counter(), "D": double, "A": inbox},
        0.3,
    )
    assert called == [0, 1, 2, 3]
    assert inbox.got == [(200, 4), (300, 6)]


def test_a_controller_computes_on_each_input() -> None:
    inbox = Inbox()
    executed(
        "C uses_data_from S\nC uses_data_from T\nP is_controlled_by C",
        [sensor("S"), sensor("T"), control_out("C"), effector("P", "Trans_Z")],
        {
            "S": Behaviour(counter(), ms(100)),
            "T": Behaviour(counter(), ms(150)),
            "C": lambda s, t: ("Trans_Z", 10 * s + t),
            "P": inbox,
        },
        0.2,
    )
    assert inbox.got == [(at, {"Trans_Z": rate}) for at, rate in ((0, 0), (100, 10), (150, 11))] + [
        (200, {"Trans_Z": 21})
    ]


def test_a_command_that_another_of_its_instant_overtakes_is_counted() -> None:
    inbox = Inbox()
    executor = executed(
        "P is_controlled_by C\nP is_controlled_by D",
        [control_out("C"), control_out("D"), effector("P", "Trans_Z")],
        {
            "C": Behaviour(lambda: ("Trans_Z", 1), ms(100)),
            "D": Behaviour(lambda: ("Trans_Z", 2), ms(50)),
            "P": inbox,
        },
        0.1,
    )
    assert [(at, command["Trans_Z"]) for at, command in inbox.got] == [(0, 2), (50, 2), (100, 2)]
    assert [link.dropped["overtaken"] for link in executor.links] == [2, 0]


def test_a_processing_delay_passes_before_a_result_is_sent() -> None:
    inbox = Inbox()
    executed(
        "D uses_data_from S\nA uses_data_from D",
        [sensor("S", "NotifyAtFrequency", 10), data_out("D"), sink("A")],
        {"S": counter(), "D": Behaviour(lambda x: x, delay=ms(30)), "A": inbox},
        0.2,
    )
    assert inbox.got == [(30, 0), (130, 1)]


def test_nothing_returned_is_nothing_sent() -> None:
    inbox = Inbox()
    executed(
        "D uses_data_from S\nA uses_data_from D",
        [sensor("S", "NotifyAtFrequency", 10), data_out("D"), sink("A")],
        {"S": counter(), "D": lambda x: x if x % 2 else None, "A": inbox},
        0.3,
    )
    assert inbox.values == [1, 3]


def test_an_exception_in_a_converter_drops_the_message_is_counted_and_marks_the_link() -> None:
    inbox = Inbox()
    executor = executed(
        "DataTransformer1 uses_data_from S\nA uses_data_from DataTransformer1",
        [sensor("S", "NotifyAtFrequency", 10), sink("A")],
        {"S": counter(), "DataTransformer1": lambda x: 6 // x, "A": inbox},
        0.3,
    )
    into, out = executor.links
    assert inbox.values == [6, 3, 2]
    assert (out.dropped["failed"], out.faulty, into.faulty) == (1, True, False)
    assert (out.fault.partition(":")[0], into.fault) == ("ZeroDivisionError", "")


def commanded(results: list[Any], seconds: float, **options: Any) -> tuple[Inbox, Executor]:
    inbox = Inbox()
    executor = executed(
        "P is_controlled_by C",
        [control_out("C"), effector("P", "Trans_Z")],
        {"C": Behaviour(iter(results).__next__, ms(100)), "P": inbox},
        seconds,
        **options,
    )
    return inbox, executor


def test_a_controller_without_inputs_computes_at_its_period_and_may_send_nothing() -> None:
    inbox, _ = commanded([("Trans_Z", 5), None, {"Trans_Z": 6}], 0.2)
    assert inbox.got == [(0, {"Trans_Z": 5}), (200, {"Trans_Z": 6})]


@pytest.mark.parametrize(
    "result",
    [{"Trans_Z": 1, "Rotn_Y": 2}, {}, ("Trans_Q", 1), 7, ("Trans_Z", float("nan")), ("Trans_Z",)],
)
def test_a_command_names_one_function(result: Any) -> None:
    with pytest.raises((TypeError, ValueError)):
        command_of(result)
    inbox, executor = commanded([result], 0.0)
    assert (inbox.got, executor.links[0].dropped["failed"]) == ([], 1)


def test_an_effector_holds_the_latest_command_and_rests_after_the_timeout() -> None:
    inbox, _ = commanded([("Trans_Z", 5), *[None] * 20], 1.5)
    assert inbox.got == [(0, {"Trans_Z": 5}), (500, {})]
    shorter, _ = commanded([("Trans_Z", 5), *[None] * 20], 1.5, command_timeout=ms(250))
    assert shorter.got == [(0, {"Trans_Z": 5}), (250, {})]


def test_a_command_in_time_keeps_an_effector_from_resting() -> None:
    inbox, executor = commanded(
        [("Trans_Z", 5), None, None, None, ("Trans_Z", 5), *[None] * 9], 0.8
    )
    assert all(rates for _, _, rates in executor.effectors["P"].applied)
    assert [time for time, _ in inbox.got] == [0, 400]


def test_all_that_is_unbound_or_never_runs_is_reported_at_once() -> None:
    codes = sorted(
        (d.code, d.message.split("`")[1])
        for d in refusals(
            executed,
            "D uses_data_from S\nC uses_data_from D\nP is_controlled_by C\nP is_controlled_by E",
            [sensor("S"), data_out("D"), control_out("C"), control_out("E"), effector("P")],
            {"C": lambda x: None, "E": lambda: None},
            1,
        )
    )
    assert codes == [
        ("never-runs", "E"),
        ("unbound", "D"),
        ("unbound", "P"),
        ("unbound", "S"),
    ]


@pytest.mark.parametrize(
    ("lines", "first", "others"),
    [
        (
            (
                "DataSplitter1 uses_data_from DataSplitter2",
                "DataSplitter2 uses_data_from DataSplitter1",
            ),
            3,
            [4],
        ),
        (
            (
                "Gate1 uses_data_from Gate2",
                "Gate1 is_inhibited_by D 10",
                "Gate2 uses_data_from Gate1",
            ),
            3,
            [5],
        ),
        (
            (
                "ArbitrationNode is_controlled_by C 0",
                "ArbitrationNode is_controlled_by ControlSplitter1 1",
                "ControlSplitter1 is_controlled_by ArbitrationNode",
            ),
            4,
            [5],
        ),
    ],
)
def test_a_circle_of_nodes_is_refused_before_the_run(
    lines: tuple[str, ...], first: int, others: list[int]
) -> None:
    modules = [sensor("S"), data_out("D"), control_out("C"), effector("P")]
    found = refusals(executed, "\n".join(lines), modules, {"S": counter()}, 1)
    (circle,) = (each for each in found if each.code == "circle")
    assert circle.span.line == first
    assert [label.line for label, _ in circle.labels] == others


@pytest.mark.parametrize("mode", ["NotifyOnValue", "NotifyOnValue(of=range)"])
def test_a_missing_value_is_reported_before_the_run(mode: str) -> None:
    places = [
        (each.code, each.span.line)
        for each in refusals(
            executed,
            f"D uses_data_from S\nA uses_data_from D {mode}",
            [sensor("S", mode), data_out("D"), sink("A")],
            {"S": counter(), "D": lambda x: x},
            1,
        )
    ]
    assert places == [("condition", 3), ("condition", 4)]


def test_the_same_run_gives_the_same_trace_to_the_byte() -> None:
    def trace() -> bytes:
        lines: list[str] = []
        executed(
            "DataSplitter1 uses_data_from S\nA uses_data_from DataSplitter1 NotifyAtFrequency 37\n"
            "C uses_data_from DataSplitter1\nP is_controlled_by C",
            [sensor("S", "NotifyAtFrequency", 100), sink("A"), control_out("C"), effector("P")],
            {"S": counter(), "C": lambda x: ("Trans_Z", x), "P": Inbox()},
            2,
            observe=lambda *event: lines.append(repr(event)),
        )
        return "\n".join(lines).encode()

    first = trace()
    assert first == trace()
    assert first.count(b"\n") > 600


def test_an_effector_that_fails_counts_the_command_that_it_failed_at_alone() -> None:
    def stall(command: dict[str, float]) -> None:
        raise OSError("stalled")

    executor = executed(
        "P is_controlled_by C\nP is_controlled_by D",
        [control_out("C"), control_out("D"), effector("P", "Trans_Z")],
        {
            "C": Behaviour(lambda: ("Trans_Z", 1), ms(100)),
            "D": Behaviour(iter([None, None, ("Trans_Z", 2)]).__next__, ms(25)),
            "P": stall,
        },
        0.05,
    )
    assert [link.dropped["failed"] for link in executor.links] == [1, 1]
    assert (executor.failures["P"].count, executor.failures["P"].first) == (2, "OSError: stalled")
