"""Gates, locks, limits and strategies: the messages that reach clients from given streams.

Each `NAME.spec.mars` of `subsumption` has a `NAME.run.json`: `streams` are the messages by ms of
the modules without inputs, `expected` the messages at clients, of commands the last of an instant.
"""

import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import pytest

from mars_asp.diagnostic import MarsError
from mars_asp.execution.executor import Behaviour, Executor
from mars_asp.execution.executor.schedule import MILLISECOND
from mars_asp.language import parse_text

CASES = Path(__file__).parent / "subsumption"
#: All times of the streams are multiples of it (ms).
STEP = 5


def streamed(
    text: str,
    streams: dict[str, dict[str, Any]],
    seconds: float,
    functions: Mapping[str, Callable[..., Any]] = {},
) -> dict[str, Any]:
    """Return the messages to each client, as [ms, value], of a run of a specification."""
    configuration = parse_text(text, "case.mars").configuration
    clients = {n.text for n in configuration.modules if configuration.node_kind(n.text) is None}
    got: dict[str, list[list[Any]]] = {name: [] for name in sorted(clients - streams.keys())}
    running: list[Executor] = []

    def sends(stream: dict[str, Any]) -> Behaviour:
        return Behaviour(
            lambda: stream.get(f"{running[0].schedule.now / MILLISECOND:g}"), STEP * MILLISECOND
        )

    def observe(now: int, kind: str, where: str, value: object) -> None:
        client = got.get(where.rpartition(" -> ")[2], [])
        if kind == "control" and client and client[-1][0] == now / MILLISECOND:
            client.pop()
        client.append([now / MILLISECOND, value])

    behaviours = {name: Behaviour(lambda value: None) for name in got}
    behaviours |= {name: Behaviour(function) for name, function in functions.items()}
    behaviours |= {name: sends(stream) for name, stream in streams.items()}
    running.append(Executor(configuration, {}, behaviours, observe=observe))
    running[0].step_until(round(seconds * 1000) * MILLISECOND)
    return got


@pytest.mark.parametrize("case", sorted(path.name[:-9] for path in CASES.glob("*.run.json")))
def test_clients_get_the_expected_messages(case: str) -> None:
    run = json.loads((CASES / f"{case}.run.json").read_text())
    got = streamed((CASES / f"{case}.spec.mars").read_text(), run["streams"], 1.5)
    assert got == run["expected"]


FEEDBACK = """\
@specification
@modules Map, Answer, View, Gate1, DataSplitter1
Gate1 uses_data_from Map
Gate1 is_suppressed_by Answer 50
DataSplitter1 uses_data_from Gate1
View uses_data_from DataSplitter1
Answer uses_data_from DataSplitter1
"""


def test_each_answer_of_a_suppressor_in_one_instant_passes() -> None:
    answer = {"Answer": lambda x: x - 1 if x > 0 else None}
    got = streamed(FEEDBACK, {"Map": {"0": 3, "20": 9, "50": 0}}, 0.1, answer)
    assert got["View"] == [[0, 3], [0, 2], [0, 1], [0, 0], [50, 0]]


def test_a_suppressor_that_answers_itself_without_end_ends_the_run() -> None:
    with pytest.raises(
        MarsError, match="the messages of `Answer` never end within the instant 0 s"
    ):
        streamed(FEEDBACK, {"Map": {"0": 3}}, 0.1, {"Answer": lambda x: x + 1})


def test_a_false_is_recorded_where_it_opens_a_gate() -> None:
    lines = "Gate1 uses_data_from Map\nGate1 is_inhibited_by Quiet 100\nView uses_data_from Gate1"
    text = f"@specification\n@modules Map, Quiet, View, Gate1\n{lines}\n"
    truths = iter([False, True, False, False])
    behaviours = {name: Behaviour(lambda *_: None) for name in ("Map", "View")}
    behaviours["Quiet"] = Behaviour(lambda: next(truths, None), 50 * MILLISECOND)
    events: list[object] = []

    def observe(now: int, kind: str, where: str, value: object) -> None:
        if kind == "gate":
            events.append([now // MILLISECOND, value])

    configuration = parse_text(text, "case.mars").configuration
    Executor(configuration, {}, behaviours, observe=observe).step_until(500 * MILLISECOND)
    assert events == [
        [50, ["closed", "Quiet", 150 * MILLISECOND]],
        [100, ["opened", "Quiet", 100 * MILLISECOND]],
    ]
