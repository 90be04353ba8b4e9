"""`@Done`, `@Reset`, `@Window` and combined commands in runs: the messages that reach clients."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from mars_asp.diagnostic import MarsError
from mars_asp.execution.executor import Behaviour, Executor
from mars_asp.execution.executor.schedule import MILLISECOND
from mars_asp.execution.parts import in_parts
from mars_asp.language import parse_text

CASES = Path(__file__).parent / "annotated"
STEP = 5


class Count:
    def __init__(self) -> None:
        self.total = 0

    def count(self, _: object) -> int:
        self.total += 1
        return self.total

    def restart(self, _: object) -> None:
        self.total = 0

    def full(self) -> str | None:
        return "full" if self.total == 3 else None


def messages(case: str) -> tuple[dict[str, Any], dict[str, Any], Executor]:
    """Return the messages of a run by client, the expected ones, and the finished run."""
    run = json.loads((CASES / f"{case}.run.json").read_text())
    text = (CASES / f"{case}.mars").read_text()
    configuration, modules = in_parts(parse_text(text, "case.mars").configuration, {})
    got: dict[str, list[list[Any]]] = {name: [] for name in run["expected"]}
    running: list[Executor] = []

    def sends(stream: dict[str, Any]) -> Behaviour:
        return Behaviour(
            lambda: stream.get(f"{running[0].schedule.now / MILLISECOND:g}"), STEP * MILLISECOND
        )

    def observe(now: int, kind: str, where: str, value: object) -> None:
        client = got.get(where.rpartition(" -> ")[2])
        if kind not in ("data", "control") or client is None:
            return
        if kind == "control" and client and client[-1][0] == now / MILLISECOND:
            client.pop()
        client.append([now / MILLISECOND, value])

    count = Count()
    functions: dict[str, Callable[..., Any]] = {
        "Count.count": count.count,
        "Count.full": count.full,
        "Bell": lambda full: full,
        "Fuse": lambda *inputs: list(inputs),
    }
    names = [name.text for name in configuration.modules]
    behaviours = {name: Behaviour(functions.get(name, lambda *_: None)) for name in names}
    behaviours["Count"] = Behaviour(lambda: None, reset=count.restart)
    behaviours |= {name: sends(stream) for name, stream in run["streams"].items()}
    running.append(Executor(configuration, modules, behaviours, observe=observe))
    running[0].step_until(1000 * MILLISECOND)
    running[0].finish()
    return got, run["expected"], running[0]


@pytest.mark.parametrize("case", sorted(path.name[:-9] for path in CASES.glob("*.run.json")))
def test_clients_get_the_expected_messages(case: str) -> None:
    got, expected, _ = messages(case)
    assert got == expected


def test_unmatched_messages_are_counted_up_to_the_end() -> None:
    _, _, executor = messages("window-behind-a-lowered-rate")
    dropped = {link.source: dict(link.dropped) for link in executor.links if link.client == "Fuse"}
    # The camera's of 0 and 350; the lidar's of 405, and of 700 at the end.
    assert dropped == {"DataSplitter1": {"unmatched": 2}, "Lidar": {"unmatched": 2}}


CIRCLES = {
    "Bell resets Count, whose completion feeds Bell": (
        "Bell uses_data_from Count.full\nCount is_reset_by Bell",
        "the messages of `Bell`, `Count` and `Count.full` never end within the instant 0.1 s",
    ),
    "the completion of Count resets Count": (
        "Count is_reset_by Count.full\nBell uses_data_from Tick",
        "the messages of `Count` and `Count.full` never end within the instant 0.1 s",
    ),
    "Bell and Fuse feed each other": (
        "Bell.f uses_data_from Tick\nBell.f uses_data_from Fuse\nFuse uses_data_from Bell",
        "the messages of `Bell` and `Fuse` never end within the instant 0.1 s",
    ),
}
BLOCKS = """
@module_start
@module_name Count
@DataOut NotifyWhenReady
Sum count(Num x);
@Reset
void restart();
@Done
Full full();
@module_end

@module_start
@module_name Bell
@DataOut NotifyWhenReady
Ring bell(Full f);
@module_end
"""


@pytest.mark.parametrize("circle", CIRCLES)
def test_messages_that_go_round_in_one_instant_end_the_run(circle: str) -> None:
    lines, message = CIRCLES[circle]
    names = "Tick, Count, Bell, Seen, Fuse"
    text = f"@specification\n@modules {names}\nSeen uses_data_from Count.count\n{lines}\n"
    text += f"Count uses_data_from Tick\n{BLOCKS}"
    configuration, modules = in_parts(parse_text(text, "case.mars").configuration, {})
    ticks = iter([None, 1])
    behaviours = {n.text: Behaviour(lambda *inputs: 1) for n in configuration.modules}
    behaviours["Tick"] = Behaviour(lambda: next(ticks, None), 100 * MILLISECOND)
    executor = Executor(configuration, modules, behaviours)
    executor.step_until(99 * MILLISECOND)
    with pytest.raises(MarsError) as raised:
        executor.step_until(1000 * MILLISECOND)
    assert [each.message for each in raised.value.diagnostics] == [message]
