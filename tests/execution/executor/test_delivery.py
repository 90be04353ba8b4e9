"""Delivery modes, rates and requests, sentence by sentence."""

import math
from collections.abc import Callable
from fractions import Fraction
from typing import Any

import pytest

from mars_asp.execution.executor import Behaviour, Link, Schedule, tick_time
from mars_asp.execution.executor.schedule import SECOND
from tests.support.execute_builders import (
    Inbox,
    counter,
    data_out,
    executed,
    ms,
    replay,
    sensor,
    sink,
)

SPLIT = "DataSplitter1 uses_data_from S\nA uses_data_from DataSplitter1 {}"


def split(
    offered: str,
    hz: float | None,
    requested: str,
    seconds: float,
    call: Callable[[], Any] | None = None,
    period: int | None = None,
) -> tuple[Inbox, Link]:
    inbox = Inbox()
    executor = executed(
        SPLIT.format(requested),
        [sensor("S", offered, hz), sink("A")],
        {"S": Behaviour(call or counter(), period), "A": inbox},
        seconds,
    )
    return inbox, executor.links[1]


def test_ticks_of_50_and_10_hertz_coincide_in_every_shared_instant() -> None:
    assert all(tick_time(5 * k, Fraction(50)) == tick_time(k, Fraction(10)) for k in range(1000))
    assert tick_time(1, Fraction(3)) == 333_333_333
    rates = [Fraction(n, d) for n in (1, 7, 32, 999) for d in (1, 3, 10**7)]
    assert all(
        tick_time(k, hz) == round(Fraction(k * SECOND) / hz) for hz in rates for k in range(50)
    )
    assert tick_time(3 * 10**6, Fraction(3)) == 10**6 * SECOND


def test_one_instant_is_ordered_by_rank_then_sequence() -> None:
    schedule = Schedule()
    seen: list[str] = []

    def sense() -> None:
        seen.append("sensor")
        schedule.at(5, 1, lambda: seen.append("late"))

    schedule.at(5, schedule.control, lambda: seen.append("control"))
    schedule.at(5, schedule.effectors, lambda: seen.append("effector"))
    schedule.at(5, 1, lambda: seen.append("data"))
    schedule.at(5, 0, sense)
    schedule.step_until(5)
    assert seen == ["sensor", "data", "late", "control", "effector"]


def test_step_until_runs_up_to_and_including_an_instant() -> None:
    schedule = Schedule()
    seen: list[int] = []
    schedule.at(5, 0, lambda: seen.append(5))
    schedule.at(6, 0, lambda: seen.append(6))
    schedule.step_until(5)
    assert (seen, schedule.now) == ([5], 5)
    schedule.step_until(10)
    assert (seen, schedule.now) == ([5, 6], 10)


@pytest.mark.parametrize(
    ("source", "requested"), [(25, 10), (10, 8), (50, 20), (100, 80), (100, 37), (10, 10), (37, 10)]
)
def test_a_splitter_lowers_a_rate_exactly(source: int, requested: int) -> None:
    inbox, link = split("NotifyAtFrequency", source, f"NotifyAtFrequency {requested}", 9.9999999)
    assert len(inbox.got) == 10 * requested
    # The messages after the last deadline wait for the next one.
    waiting = -(-source // requested) - 1
    assert 0 <= 10 * (source - requested) - link.dropped["lowered"] <= waiting
    if source != requested:
        grid = [tick_time(k, Fraction(requested)) / 1e6 for k in range(10 * requested)]
        assert [at for at, _ in inbox.got] == grid


def test_a_lowered_rate_delivers_the_latest_message_at_each_deadline() -> None:
    inbox, _ = split("NotifyAtFrequency", 25, "NotifyAtFrequency 10", 0.4)
    assert inbox.got == [(0, 0), (100, 2), (200, 5), (300, 7), (400, 10)]


def test_a_lowered_rate_repeats_nothing_when_its_source_falls_silent() -> None:
    readings = [*range(10), *[None] * 10]
    inbox, link = split("NotifyAtFrequency", 25, "NotifyAtFrequency 10", 0.7, replay(readings))
    assert inbox.got == [(0, 0), (100, 2), (200, 5), (300, 7), (400, 9)]
    assert link.stale == 0


@pytest.mark.parametrize("hz", [50, 20])
def test_clocks_of_one_instant_tick_in_the_direction_of_the_data(hz: int) -> None:
    inbox = Inbox()
    executed(
        "A uses_data_from E NotifyAtFrequency 10\nE uses_data_from DataSplitter1\n"
        f"DataSplitter1 uses_data_from D NotifyAtFrequency {hz}\nD uses_data_from S",
        [
            sensor("S", "NotifyAtFrequency", 100),
            data_out("D", "NotifyAtFrequency", 100),
            data_out("E", "NotifyAtFrequency", hz),
            sink("A"),
        ],
        {"S": counter(), "D": lambda x: x, "E": lambda x: x, "A": inbox},
        0.3,
    )
    assert inbox.got == [(0, 0), (100, 10), (200, 20), (300, 30)]


def test_a_splitter_repeats_old_notifications_and_counts_them_as_stale() -> None:
    inbox, link = split("NotifyWhenReady", None, "NotifyAtFrequency 10", 0.5, period=ms(250))
    assert inbox.got == [(0, 0), (100, 0), (200, 0), (300, 1), (400, 1), (500, 2)]
    assert link.stale == 3


def test_a_splitter_polls_a_source_that_answers_requests() -> None:
    inbox, _ = split("RequestWhenReady", None, "NotifyAtFrequency 10", 0.3)
    assert inbox.got == [(0, 0), (100, 1), (200, 2), (300, 3)]


@pytest.mark.parametrize(
    ("requested", "readings", "delivered"),
    [
        ("NotifyOnMax(3)", [1, 3, 2, 4, 4], [3, 4, 4]),
        ("NotifyOnMax", [1, 3, 2, 3, 4], [1, 3, 4]),
        ("NotifyOnMin(3)", [4, 3, 5, 1, 1], [3, 1, 1]),
        ("NotifyOnMin", [4, 3, 5, 3, 1], [4, 3, 1]),
        ("NotifyOnMin", [4, 5, 3, 3, 1], [4, 3, 1]),
        ("NotifyOnValue(5, 0.5)", [4, 4.6, 5.4, 6, 5.5], [4.6, 5.5]),
        ("NotifyOnValue(5)", [4, 5, 5, 6, 5], [5, 5]),
        ("NotifyOnChange", [1, 1, 2, 2, 1], [1, 2, 1]),
        ("NotifyOnValue(30, 0.1)", [29, 30.1, 31, 29.9, 29.89, 30], [30.1, 29.9, 30]),
        ("NotifyOnChange(0.5)", [7, 7.5, 7.75, 7.25], [7, 7.75]),
        ("NotifyOnChange(0.2)", [0.6, 0.8, 0.81], [0.6, 0.81]),
        (
            "NotifyOnChange",
            [math.inf, math.inf, 3, math.inf, math.inf, -math.inf],
            [math.inf, 3, math.inf, -math.inf],
        ),
        ("NotifyOnChange(5)", [math.inf, math.inf, 3, math.nan, 4, 9], [math.inf, 3, 9]),
        ("NotifyOnChange", [math.nan, math.nan, 1, math.nan, 1], [1]),
        ("NotifyOnMax", [math.nan, 1, math.nan, 1, 2], [1, 2]),
        ("NotifyOnMin", [3, math.nan, 3, 2, math.inf], [3, 2]),
        ("NotifyOnMin(3)", [math.nan, math.inf, -math.inf], [-math.inf]),
        ("NotifyOnChange(0.5)", [0, 0.2, 0.4, 0.6, 0.8, 1.0, 1.2], [0, 0.6, 1.2]),
    ],
)
def test_conditions_deliver_when_they_hold(
    requested: str, readings: list[float], delivered: list[float]
) -> None:
    seconds = (len(readings) - 1) / 10
    for offered, wanted in (("NotifyWhenReady", requested), (requested, "")):
        inbox, _ = split(offered, None, wanted, seconds, replay(readings), ms(100))
        assert inbox.values == delivered


def test_a_drift_is_reported_at_every_third_step() -> None:
    drift = [round(0.2 * k, 1) for k in range(31)]
    inbox, _ = split("NotifyWhenReady", None, "NotifyOnChange(0.5)", 3, replay(drift), ms(100))
    assert inbox.values == drift[::3]


def test_a_condition_is_about_a_field() -> None:
    readings = [{"nearest": 400}, {"nearest": 200}]
    requested = "NotifyOnMin(300, of=nearest)"
    inbox, _ = split("NotifyWhenReady", None, requested, 0.1, replay(readings), ms(100))
    assert inbox.values == [{"nearest": 200}]


def test_a_message_without_the_field_is_dropped_counted_and_marks_the_link() -> None:
    requested = "NotifyOnMin(300, of=nearest)"
    inbox, link = split("NotifyWhenReady", None, requested, 0.1, replay([{}, {}]), ms(100))
    assert (inbox.got, link.dropped["failed"], link.faulty) == ([], 2, True)


PULL = "D uses_data_from S RequestWhenReady\nA uses_data_from D"


def test_a_client_pulls_when_it_runs_and_gets_the_latest_unread() -> None:
    inbox = Inbox()
    executor = executed(
        PULL,
        [sensor("S", "RequestWhenReady"), data_out("D", "NotifyAtFrequency", 5), sink("A")],
        {"S": Behaviour(counter(), ms(50)), "D": lambda x: x, "A": inbox},
        0.4,
    )
    assert inbox.got == [(0, 0), (200, 4), (400, 8)]
    assert executor.links[0].dropped["unread"] == 6


def test_without_an_unread_message_the_next_one_answers_the_one_outstanding_request() -> None:
    inbox = Inbox()
    executor = executed(
        PULL,
        [sensor("S", "RequestWhenReady"), data_out("D", "NotifyAtFrequency", 20), sink("A")],
        {"S": Behaviour(counter(), ms(120)), "D": lambda x: x, "A": inbox},
        0.3,
    )
    assert inbox.got == [(0, 0), (120, 1), (240, 2)]
    assert executor.links[0].delivered == 3


def test_an_algorithm_on_request_computes_at_each_request() -> None:
    inbox = Inbox()
    calls: list[int] = []

    def recorded(x: int) -> int:
        calls.append(x)
        return x

    executed(
        "M uses_data_from S\nD uses_data_from M\nA uses_data_from D",
        [
            sensor("S", "NotifyAtFrequency", 100),
            data_out("M", "RequestWhenReady"),
            data_out("D", "NotifyAtFrequency", 10),
            sink("A"),
        ],
        {
            "S": counter(),
            "M": recorded,
            "D": lambda x: x,
            "A": inbox,
        },
        0.2,
    )
    assert calls == [0, 10, 20]
    assert inbox.got == [(0, 0), (100, 10), (200, 20)]


def test_a_request_passes_a_splitter_that_keeps_the_latest() -> None:
    inbox = Inbox()
    executed(
        "DataSplitter1 uses_data_from S\nD uses_data_from DataSplitter1 RequestWhenReady\n"
        "A uses_data_from D",
        [
            sensor("S", "NotifyAtFrequency", 100),
            data_out("D", "NotifyAtFrequency", 10),
            sink("A"),
        ],
        {"S": counter(), "D": lambda x: x, "A": inbox},
        0.1,
    )
    assert inbox.got == [(0, 0), (100, 10)]


def test_a_link_delivers_at_once() -> None:
    inbox = Inbox()
    executor = executed(
        "A uses_data_from S",
        [sensor("S", "NotifyAtFrequency", 8), sink("A")],
        {"S": counter(), "A": inbox},
        0.25,
    )
    assert inbox.got == [(0, 0), (125, 1), (250, 2)]
    assert executor.links[0].oldest == 0


def test_a_sensor_without_a_frequency_samples_at_the_period_of_its_device() -> None:
    inbox, _ = split("NotifyWhenReady", None, "", 0.25, period=ms(80))
    assert inbox.got == [(0, 0), (80, 1), (160, 2), (240, 3)]


def test_a_splitter_copies_in_the_order_of_the_specification_and_waits_for_no_slow_client() -> None:
    order: list[str] = []
    inbox = Inbox()

    def noting(name: str) -> Callable[[int], int]:
        def call(value: int) -> int:
            order.append(name)
            return value

        return call

    executed(
        "DataSplitter1 uses_data_from S\nB uses_data_from DataSplitter1\n"
        "D uses_data_from DataSplitter1\nC uses_data_from DataSplitter1\nA uses_data_from D",
        [sensor("S", "NotifyAtFrequency", 10), sink("B"), data_out("D"), sink("C"), sink("A")],
        {
            "S": counter(),
            "B": noting("B"),
            "D": Behaviour(noting("D"), delay=ms(70)),
            "C": noting("C"),
            "A": inbox,
        },
        0.1,
    )
    assert order == ["B", "D", "C"] * 2
    assert inbox.got == [(70, 0)]


def test_a_splitter_copies_in_the_same_instant_and_no_failing_client_holds_up_another() -> None:
    inbox = Inbox()
    order: list[str] = []

    def fails(value: int) -> None:
        order.append("B")
        raise ZeroDivisionError

    executor = executed(
        "DataSplitter1 uses_data_from S\nB uses_data_from DataSplitter1\n"
        "A uses_data_from DataSplitter1",
        [sensor("S", "NotifyAtFrequency", 10), sink("B"), sink("A")],
        {"S": counter(), "B": fails, "A": inbox},
        0.1,
    )
    assert inbox.got == [(0, 0), (100, 1)]
    assert len(order) == 2
    assert [link.delivered for link in executor.links] == [2, 2, 2]
