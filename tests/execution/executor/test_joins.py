"""Inputs of one instant make one computation, with the latest of each (section 7).

`python -m tests.execution.executor.test_joins HOW_MANY FIRST_SEED` tries as many as wanted.
"""

import random
import sys
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any, TypeAlias

import pytest

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
    specification,
)

END = 240


#: When (ms) each module computed which value.
Computations: TypeAlias = dict[str, list[tuple[int, int]]]


def combine(name: str, number: int, *inputs: int) -> int:
    """Return the value of a computation: of a sensor its number, else of inputs in any order."""
    return (
        hash((len(name), int(name[-1:] == "1"), tuple(sorted(inputs)))) % 999_983
        if inputs
        else number
    )


@dataclass
class Graph:
    """Modules in an order of the data: sensors S, joins D, some with a clock, controllers C."""

    sources: dict[str, list[str]] = field(default_factory=dict)
    period: dict[str, int] = field(default_factory=dict)
    delay: dict[str, int] = field(default_factory=dict)


def drawn(seed: int) -> Graph:
    rng = random.Random(seed)
    graph = Graph()
    for k in range(rng.randint(1, 3)):
        graph.sources[f"S{k}"], graph.period[f"S{k}"] = [], rng.choice([10, 20, 30])
    for k in range(rng.randint(1, 5)):
        known = [*graph.sources]
        graph.sources[f"D{k}"] = rng.sample(known, min(len(known), rng.randint(1, 3)))
        if rng.random() < 0.3:
            graph.period[f"D{k}"] = rng.choice([10, 20, 40])
    for name in [*graph.sources]:
        if rng.random() < 0.2:
            graph.delay[name] = rng.choice([10, 15])
    known = [*graph.sources]
    graph.sources["C"] = rng.sample(known, min(len(known), rng.randint(1, 3)))
    used = {source for sources in graph.sources.values() for source in sources}
    graph.sources = {n: s for n, s in graph.sources.items() if s or n in used}
    return graph


def reading(graph: Graph) -> Computations:
    """Return when (ms) each module computes which value, as section 7 reads."""
    latest: dict[str, dict[str, int]] = {name: {} for name in graph.sources}
    due: dict[tuple[int, str], int] = {}
    found: Computations = {name: [] for name in graph.sources}
    for now in range(0, END + 1, 5):
        arrived: set[str] = set()

        def deliver(source: str, value: int, arrived: set[str] = arrived) -> None:
            for client, sources in graph.sources.items():
                if source in sources:
                    latest[client][source] = value
                    arrived.add(client)

        for name in graph.sources:
            if (now, name) in due:
                deliver(name, due[now, name])
        for name, sources in graph.sources.items():  # in the order of the data
            runs = now % graph.period[name] == 0 if name in graph.period else name in arrived
            if not runs or len(latest[name]) < len(sources):
                continue
            value = combine(name, len(found[name]), *latest[name].values())
            found[name].append((now, value))
            if name in graph.delay:
                due[now + graph.delay[name], name] = value
            else:
                deliver(name, value)
    return found


def computed(graph: Graph, seed: int) -> Computations:
    """Return when (ms) each module computes which value in a run, lines in any order."""
    lines = [f"{c} uses_data_from {s}" for c, sources in graph.sources.items() for s in sources]
    random.Random(seed).shuffle(lines)
    found: Computations = {name: [] for name in graph.sources}
    running: list[Executor] = []

    def behaviour(name: str) -> Behaviour:
        def call(*inputs: int) -> Any:
            value = combine(name, len(found[name]), *inputs)
            found[name].append((running[0].schedule.now // ms(1), value))
            return ("Trans_Z", value) if name == "C" else value

        period = graph.period.get(name)
        interval = None if period is None else ms(period)
        return Behaviour(call, interval, ms(graph.delay.get(name, 0)))

    modules = {"P": effector("P", "Trans_Z"), "C": control_out("C")}
    for name, sources in graph.sources.items():
        if name != "C":
            modules[name] = data_out(name) if sources else sensor(name)
    behaviours = {name: behaviour(name) for name in graph.sources}
    behaviours["P"] = Behaviour(lambda command: None)
    text = "\n".join([*lines, "P is_controlled_by C"])
    running.append(Executor(specification(text), modules, behaviours))
    running[0].step_until(ms(END))
    return found


def differing(seeds: Iterable[int]) -> list[int]:
    return [seed for seed in seeds if computed(drawn(seed), seed) != reading(drawn(seed))]


def test_a_join_computes_once_in_each_instant() -> None:
    assert differing(range(60)) == []


LINES = ["D uses_data_from S", "J uses_data_from S", "J uses_data_from D"]


@pytest.mark.parametrize("lines", [LINES, [LINES[1], LINES[0], LINES[2]]])
def test_a_join_waits_for_longer_paths_of_the_instant(lines: list[str]) -> None:
    """`J` takes `S` directly and through `D`: at 100 ms it has the second message of both."""
    inbox = Inbox()
    executor = executed(
        "\n".join([*lines, "A uses_data_from J"]),
        [sensor("S", "NotifyAtFrequency", 10), data_out("D"), data_out("J"), sink("A")],
        {"S": counter(), "D": lambda x: x, "J": lambda x, y: (x, y), "A": inbox},
        0.2,
    )
    assert inbox.got == [(0, (0, 0)), (100, (1, 1)), (200, (2, 2))]
    assert [sum(link.dropped.values()) for link in executor.links] == [0, 0, 0, 0]


def test_a_commanded_controller_waits_for_the_command_of_the_instant() -> None:
    inbox = Inbox()
    executed(
        "C uses_data_from S\nB uses_data_from S\nC is_controlled_by B\nP is_controlled_by C",
        [sensor("S", "NotifyAtFrequency", 10), control_out("B"), control_out("C"), effector("P")],
        {
            "S": counter(),
            "B": lambda x: ("Trans_Z", x),
            "C": lambda x, command: ("Trans_Z", 10 * x + command["Trans_Z"]),
            "P": inbox,
        },
        0.2,
    )
    assert inbox.got == [(at, {"Trans_Z": rate}) for at, rate in ((0, 0), (100, 11), (200, 22))]


if __name__ == "__main__":
    first = int(sys.argv[2])
    wrong = differing(range(first, first + int(sys.argv[1])))
    print(f"{len(wrong)} of {sys.argv[1]} runs differ: {wrong[:9]}")
