"""Messages are values: neither sender nor other receivers see changes by one receiver."""

import json
from collections.abc import Callable
from typing import Any

import pytest

from mars_asp.execution.executor import Behaviour
from mars_asp.execution.recording.record import Lines
from tests.support.execute_builders import (
    control_out,
    data_out,
    effector,
    executed,
    ms,
    sensor,
    sink,
)


def spoil(value: list[Any]) -> None:
    value.append("spoilt")


class Box:
    """A sink that keeps how each message looked, and then spoils it."""

    def __init__(self) -> None:
        self.seen: list[str] = []

    def __call__(self, value: Any) -> None:
        self.seen.append(repr(value))
        value.append("spoilt")


#: Lines from a sensor that always delivers the same list to one or two sinks.
WAYS = [
    "A uses_data_from S",
    "A uses_data_from S\nB uses_data_from S",
    "DataSplitter1 uses_data_from S\nA uses_data_from DataSplitter1\n"
    "B uses_data_from DataSplitter1",
    "DataSplitter1 uses_data_from S\nA uses_data_from DataSplitter1 NotifyAtFrequency 20\n"
    "B uses_data_from DataSplitter1",
    "DataTransformer1 uses_data_from S\nA uses_data_from DataTransformer1",
    "D uses_data_from S\nA uses_data_from D\nB uses_data_from S",
    "DataSplitter1 uses_data_from S\nDataTransformer1 uses_data_from DataSplitter1\n"
    "A uses_data_from DataTransformer1\nB uses_data_from DataSplitter1",
]


@pytest.mark.parametrize("lines", WAYS)
def test_no_receiver_sees_the_changes_of_another(lines: str) -> None:
    first, second, result, kept = Box(), Box(), list[bytes](), [1, [2]]

    def passing(value: list[Any]) -> list[Any]:
        made = [value[0], [*value[1]]]
        value[1].append("passed")
        return made

    modules = [sensor("S"), sink("A"), sink("B"), data_out("D")]
    behaviours = {"S": Behaviour(lambda: kept, ms(100)), "A": first, "B": second, "D": passing}
    behaviours["DataTransformer1"] = passing
    executor = executed(lines, modules, behaviours, 0.5, observe=Lines(result.append).observe)
    assert first.seen == ["[1, [2]]"] * len(first.seen)
    assert len(first.seen) >= 6
    assert second.seen == ["[1, [2]]"] * len(second.seen)
    assert {repr(json.loads(each)["value"]) for each in result} == {"[1, [2]]"}
    assert not executor.failures


def test_a_sent_list_is_unchanged_by_later_changes_of_its_sender() -> None:
    kept: list[int] = []
    seen: list[tuple[list[int], int]] = []

    def grow() -> list[int]:
        kept.append(len(kept))
        return kept

    def take(value: list[int], other: int) -> None:
        seen.append((value, other))

    # A gets what S made 250 ms ago, and keeps all of it.
    modules = [sensor("S"), sensor("T"), sink("A")]
    late = Behaviour(grow, ms(100), delay=ms(250))
    clock = Behaviour(lambda: 0, ms(1000))
    lines = "A uses_data_from S\nA uses_data_from T"
    executed(lines, modules, {"S": late, "T": clock, "A": take}, 0.6)
    assert [value for value, _ in seen] == [[0], [0, 1], [0, 1, 2], [0, 1, 2, 3]]


@pytest.mark.parametrize("sender", ["S", "D", "DataTransformer1"])
def test_a_value_kept_by_its_sender_changes_no_message(sender: str) -> None:
    kept: list[int] = [0]
    seen: list[int] = []

    def tick() -> int:
        kept.append(0)
        return 0

    def send(*_: Any) -> list[int]:
        del kept[1:]
        return kept

    modules = [sensor("S"), sensor("T"), data_out("D"), sink("A")]
    behaviours: dict[str, Any] = {
        "S": Behaviour(send, ms(1000)),
        "T": Behaviour(tick, ms(100)),
        "D": send,
        "DataTransformer1": send,
        "A": lambda slow, _: seen.append(len(slow)),
    }
    lines = f"A uses_data_from {sender}\nA uses_data_from T"
    if sender != "S":
        lines += f"\n{sender} uses_data_from S"
    executed(lines, modules, behaviours, 0.5)
    assert set(seen[1:]) == {1}  # of the first instant, `T` ticks before or after


def test_the_latest_of_an_input_is_as_it_was_sent_at_each_computation() -> None:
    seen: list[int] = []

    def take(slow: list[int], _: int) -> None:
        seen.append(len(slow))
        spoil(slow)

    modules = [sensor("S"), sensor("T"), sink("A")]
    behaviours = {"S": Behaviour(lambda: [0], ms(1000)), "T": Behaviour(lambda: 0, ms(100))}
    executed("A uses_data_from S\nA uses_data_from T", modules, {**behaviours, "A": take}, 0.5)
    assert set(seen) == {1}


def test_the_answer_to_a_request_is_unchanged() -> None:
    kept, seen = [0], []
    modules = [sensor("S"), control_out("C"), effector("P", "Trans_Z")]

    def take(value: list[int]) -> tuple[str, float]:
        seen.append(list(value))
        spoil(value)
        return "Trans_Z", 1

    def read() -> list[int]:
        kept[0] += 1
        return kept

    behaviours = {"S": Behaviour(read, ms(100)), "C": Behaviour(take, ms(250)), "P": lambda c: None}
    lines = "C uses_data_from S RequestWhenReady\nP is_controlled_by C"
    executed(lines, modules, behaviours, 0.6)
    assert seen == [[1], [3], [6]]


def test_a_command_is_a_value_as_well() -> None:
    seen: list[dict[str, float]] = []

    def obey(command: dict[str, float]) -> None:
        seen.append(dict(command))
        command.clear()

    lines = (
        "ControlSplitter1 is_controlled_by C\nP is_controlled_by ControlSplitter1\n"
        "Q is_controlled_by ControlSplitter1"
    )
    modules = [control_out("C"), effector("P", "Trans_Z"), effector("Q", "Trans_Z")]
    behaviours = {"C": Behaviour(lambda: ("Trans_Z", 5), ms(100)), "P": obey, "Q": obey}
    executor = executed(lines, modules, behaviours, 0.2)
    assert seen == [{"Trans_Z": 5}] * 6
    assert [each.applied for each in executor.effectors.values()] == [
        [(0, "C", {"Trans_Z": 5})]
    ] * 2


def test_inputs_of_a_failure_are_shown_as_they_were_given() -> None:
    def raises(value: list[Any]) -> None:
        spoil(value)
        raise ValueError("no")

    behaviours: dict[str, Any] = {"S": Behaviour(lambda: [1], ms(100)), "A": raises}
    executor = executed("A uses_data_from S", [sensor("S"), sink("A")], behaviours, 0.1)
    assert executor.failures["A"].inputs == ("[1]",)


@pytest.mark.parametrize("made", [lambda: (n for n in [1]), lambda: open(__file__)])  # noqa: PTH123, SIM115
def test_a_value_that_cannot_be_copied_fails_at_its_sender(made: Callable[[], Any]) -> None:
    seen: list[Any] = []
    place = "b.py", 3
    behaviours: dict[str, Any] = {"S": Behaviour(made, ms(100), place=place), "A": seen.append}
    executor = executed("A uses_data_from S", [sensor("S"), sink("A")], behaviours, 0.1)
    failure = executor.failures["S"]
    assert (failure.count, failure.raised, seen) == (2, place, [])
    assert "cannot be copied for its receivers" in failure.first
