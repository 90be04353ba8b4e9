"""Faults of links: messages that are lost, late, or late by chance."""

from math import inf
from pathlib import Path
from typing import Any

import pytest

from mars_asp.execution.executor import Behaviour, Executor
from mars_asp.execution.executor.channel import LinkFault
from mars_asp.execution.executor.schedule import MILLISECOND, SECOND
from mars_asp.execution.promises import promises
from mars_asp.execution.trial import Trial
from tests.support.execute_builders import (
    Inbox,
    control_out,
    counter,
    data_out,
    effector,
    executed,
    sensor,
    sink,
)
from tests.support.refusals import refusals
from tests.support.trials import BASE, HAND, trial, verdicts

LINE, FAST = "A uses_data_from S", "NotifyAtFrequency"


def fault(ends: str, *, loss: float = 0, delay: int = 0, jitter: int = 0, **times: float) -> Any:
    source, client = ends.split()
    since, until = times.get("since", 0), times.get("until", inf)
    part = delay * MILLISECOND, jitter * 1000, round(since * SECOND), until * SECOND
    return LinkFault(source, client, loss, *part)


def got(
    *faults: LinkFault, text: str = LINE, seed: int = 0, seconds: float = 1
) -> tuple[Executor, list[tuple[float, Any]]]:
    """Return a run, and the messages at A of a sensor that counts every 100 ms."""
    inbox = Inbox()
    modules = [sensor("S", FAST, 10), sink("A"), sink("B")]
    behaviours = {"S": counter(), "A": inbox, "B": Inbox()}
    made = executed(text, modules, behaviours, seconds, faults=faults, seed=seed)
    return made, inbox.got


def test_a_link_loses_its_share_from_since_until_before_until() -> None:
    made, found = got(fault("S A", loss=1, since=0.2, until=0.5))
    assert [at for at, _ in found] == [0, 100, 500, 600, 700, 800, 900, 1000]
    assert made.links[0].dropped == {"lost": 3} and made.links[0].delivered == 8
    made, _ = got(fault("S A", loss=0.3), seconds=1000)
    assert 2800 < made.links[0].dropped["lost"] < 3200


def test_delays_keep_the_order_and_count_as_age() -> None:
    made, found = got(fault("S A", delay=250, until=0.3))
    # What was sent at 300 and 400 arrives with what was sent at 200.
    assert found == [(250, 0), (350, 1), (450, 4), *((100 * k, k) for k in range(5, 11))]
    assert made.links[0].dropped == {"unread": 2} and made.links[0].oldest == 250 * MILLISECOND
    _, found = got(fault("S A", jitter=300), seconds=200)
    late = [at - 100 * value for at, value in found]
    assert all(0 <= each <= 300 for each in late) and max(late) > 290
    assert [value for _, value in found] == sorted({value for _, value in found})


def test_draws_depend_on_the_seed_and_the_two_names_alone() -> None:
    text = "DataSplitter1 uses_data_from S\nA uses_data_from DataSplitter1"
    own = fault("DataSplitter1 A", loss=0.5)
    _, found = got(own, text=text, seconds=9)
    more = f"{text}\nB uses_data_from DataSplitter1"
    others = fault("S DataSplitter1", loss=0), fault("DataSplitter1 B", loss=0.5)
    made, same = got(*others, own, text=more, seconds=9)
    assert same == found != got(own, text=text, seconds=9, seed=1)[1]
    assert made.links[1].delivered != made.links[2].delivered
    # Jitter loses the same messages.
    _, late = got(fault("DataSplitter1 A", loss=0.5, jitter=50), text=text, seconds=9)
    assert [value for _, value in late] == [value for _, value in found][: len(late)]


@pytest.mark.parametrize("chain", [False, True])
def test_a_lost_answer_ends_the_wait_for_it(chain: bool) -> None:
    text = "A uses_data_from {0} RequestWhenReady\nB uses_data_from A"
    text = f"DataSplitter1 uses_data_from S\n{text}" if chain else text
    ends = "S DataSplitter1" if chain else "S A"
    modules = [sensor("S", "RequestWhenReady"), data_out("A", FAST, 10), sink("B")]
    inbox = Inbox()
    behaviours = {"S": counter(), "A": Behaviour(lambda value: value), "B": inbox}
    lost = fault(ends, loss=1, since=0.15, until=0.35)
    executed(
        text.format("DataSplitter1" if chain else "S"), modules, behaviours, 0.6, faults=[lost]
    )
    assert inbox.got == [(0, 0), (100, 1), (400, 4), (500, 5), (600, 6)]


def commanded(*faults: LinkFault, ends: float = 0.25) -> list[tuple[float, Any]]:
    """Return the changes of W, which C commands at 0 and 100 ms through an arbiter that holds."""
    text = "W is_controlled_by ArbitrationNode\nArbitrationNode is_controlled_by C 1 hold 200"
    inbox = Inbox()
    call = iter([{"Trans_Z": 1.0}, {"Trans_Z": 2.0}])
    behaviours = {"C": Behaviour(lambda: next(call, None), 100 * MILLISECOND), "W": inbox}
    modules = [control_out("C", "Trans_Z"), effector("W", "Trans_Z")]
    executed(text, modules, behaviours, 1, faults=faults)
    return [(at, value.get("Trans_Z", 0)) for at, value in inbox.got]


def test_commands_and_the_end_of_their_hold_are_delayed_alike() -> None:
    assert commanded() == [(0, 1), (100, 2), (300, 0)]
    late = [(at + 300, rate) for at, rate in commanded()]
    assert commanded(fault("ArbitrationNode W", delay=300)) == late
    assert commanded(fault("C ArbitrationNode", delay=300)) == late
    # Without the arbiter's stop, the effector rests when the command has run out.
    lost = fault("ArbitrationNode W", loss=1, since=0.2)
    assert commanded(lost)[-1] == (300, 0)


def withdrawn(*faults: LinkFault) -> list[tuple[float, Any]]:
    """Return the changes of W, whose command of 100 ms an inhibition withdraws at 200 ms."""
    text = "W is_controlled_by Gate1\nGate1 is_controlled_by C\nGate1 is_inhibited_by S 50"
    inbox = Inbox()
    commands, readings = iter([None, {"Trans_Z": 1.0}]), iter([None, None, 1])
    behaviours = {
        "C": Behaviour(lambda: next(commands, None), 100 * MILLISECOND),
        "S": Behaviour(lambda: next(readings, None), 100 * MILLISECOND),
        "W": inbox,
    }
    modules = [control_out("C", "Trans_Z"), effector("W", "Trans_Z"), sensor("S")]
    executed(text, modules, behaviours, 1, faults=faults)
    return [(at, value.get("Trans_Z", 0)) for at, value in inbox.got]


def test_a_withdrawal_is_late_and_lost_as_messages_are() -> None:
    assert withdrawn() == [(100, 1), (200, 0)]
    assert withdrawn(fault("Gate1 W", delay=50)) == [(150, 1), (250, 0)]
    # The effector's timeout of 500 ms ends the command.
    assert withdrawn(fault("Gate1 W", loss=1, since=0.2)) == [(100, 1), (600, 0)]


ROBOT = """\
@specification
@modules P, S, A, B, DataSplitter1
DataSplitter1 uses_data_from S NotifyAtFrequency 10
A uses_data_from DataSplitter1 NotifyAtFrequency 10
B uses_data_from DataSplitter1 NotifyAtFrequency 5
@module_start
@module_name S
@Sense NotifyAtFrequency 10
int read();
@module_end
"""


def promised(folder: Path, faults: str, code: str = "return 1") -> Trial:
    """Return a run of 3 s in which S reads by `code` and links have faults."""
    (folder / "s.py").write_text(
        f"from itertools import count\nn = count()\ndef read():\n    {code}"
    )
    return trial(f'{BASE}[bindings.S]\npython = "s.py:read"\n{faults}', ROBOT, folder)


def entry(source: str, client: str, more: str = "") -> str:
    return f'[[links]]\nfrom = "{source}"\nto = "{client}"\n{more}\n'


@pytest.mark.parametrize("ends", [("S", "DataSplitter1"), ("DataSplitter1", "A")])
@pytest.mark.parametrize("more", ["loss = 0.4", "loss = 1", "delay = 950", "jitter = 450"])
def test_a_fault_of_a_link_breaks_no_promise(
    ends: tuple[str, str], more: str, tmp_path: Path
) -> None:
    made = promised(tmp_path, entry(*ends, more))
    late = ends[0] == "S" and more.startswith("jitter")
    found = [each for each in promises(made) if each.link.client != "B"] if late else promises(made)
    # Jitter before a splitter may leave one of its ticks without a message.
    assert all((each.promised or 0) <= each.delivered for each in found)
    assert late or verdicts(made)["services delivered"] is True


def test_a_promise_is_broken_beyond_lost_messages(tmp_path: Path) -> None:
    code = "return None if next(n) == 7 else 1"
    made = promised(tmp_path, entry("S", "DataSplitter1", "loss = 0.4\nsince = 1"), code)
    lost = made.executor.links[0].dropped["lost"]
    assert lost and verdicts(made)["services delivered"] is False
    first = next(promises(made))
    assert (first.promised, first.delivered) == (30 - lost, 29 - lost)


@pytest.mark.parametrize(
    ("faults", "line", "message", "help_text"),
    [
        (entry("C", "P", "loss = 2"), 10, "`2` is out of range for `loss`", "from 0 to 1"),
        (entry("C", "P", "los = 1"), 10, "unknown key `los`", "did you mean `loss`?"),
        ('[[links]]\nto = "P"\n', 7, "`links` has no `from`", None),
        (
            entry("C", "P", "since = 2\nuntil = 2"),
            11,
            "the fault of `C -> P` ends at 2 s, and begins at 2 s",
            "let it end later",
        ),
        (
            entry("C", "P", "since = 3"),
            10,
            "the fault of `C -> P` begins at 3 s, and the run ends at 3 s",
            "let it begin earlier",
        ),
        (
            entry("C", "P", "until = 2") + entry("C", "P", "since = 1.5"),
            11,
            "two faults of `C -> P` are there at 1.5 s",
            "state one for each period, by `since` and `until`",
        ),
        (entry("C", "Pp"), 9, "there is no link `C -> Pp`", "did you mean `P`?"),
        (entry("c", "P"), 8, "there is no link `c -> P`", "did you mean `C`?"),
    ],
)
def test_wrong_faults_are_refused_at_their_places(
    faults: str, line: int, message: str, help_text: str | None
) -> None:
    (found, *more) = refusals(trial, BASE + HAND + faults)
    assert (found.span.line, found.message, found.help) == (line, message, help_text) and not more


def test_faults_one_after_the_other_do_not_overlap() -> None:
    faults = entry("C", "P", "until = 1\nloss = 1") + entry("C", "P", "since = 1\nloss = 0.5")
    assert trial(BASE + HAND + faults).executor.links[0].dropped["lost"] > 10
