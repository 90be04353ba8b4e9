"""Python functions that a scenario names: how they are found, and that each run has its own."""

from pathlib import Path

import pytest

from mars_asp.cli import run_here
from mars_asp.diagnostic import MarsError
from tests.support.documents import ROOT
from tests.support.fixtures import Captured
from tests.support.refusals import refusals
from tests.support.trials import BASE, trial


def test_module_state_does_not_leak_from_one_run_into_the_next(tmp_path: Path) -> None:
    (tmp_path / "b.py").write_text(
        "count = [0]\ndef go():\n    count[0] += 1\n    return 'Trans_Z', count[0]\n"
    )
    text = BASE + '[bindings.C]\npython = "b.py:go"\nperiod = 100\n'
    driven = {trial(text, folder=tmp_path).bodies[0].driven for _ in range(2)}
    assert len(driven) == 1


@pytest.mark.parametrize(
    ("body", "failed"), [("def go():\n    exit(3)\n", 30), ("exit(3)\ndef go(): ...\n", None)]
)
def test_a_behaviour_cannot_end_the_program(body: str, failed: int | None, tmp_path: Path) -> None:
    (tmp_path / "b.py").write_text(body)
    text = BASE + '[bindings.C]\npython = "b.py:go"\nperiod = 100\n'
    if failed is None:
        with pytest.raises(MarsError, match="SystemExit: 3"):
            trial(text, folder=tmp_path)
    else:
        (link,) = trial(text, folder=tmp_path).executor.links
        assert abs(link.dropped["failed"] - failed) <= 1
        assert link.fault == "RuntimeError: it called `exit(3)`"


@pytest.mark.parametrize(
    ("binding", "place"),
    [
        ('[bindings.C]\nperiod = 9\npython = "b.py:go"\n', (6, 11)),
        ('[bindings]\nP = { period = 9 }\nC = { python = "b.py:go" }\n', (8, 1)),
        ('[bindings]\nC.python = "b.py:go"\n', (7, 1)),
        ('[devices.P]\nkind = "platform"\n[bindings."C"]\npython = "b.py:go"\n', (8, 11)),
    ],
)
def test_a_binding_to_a_missing_function_is_reported_at_its_line(
    binding: str, place: tuple[int, int], tmp_path: Path
) -> None:
    (tmp_path / "b.py").write_text("")
    text = f"seed = 0\n\n{BASE}{binding}"
    found = refusals(trial, text, folder=tmp_path)[0]
    assert found.message.endswith("b.py` defines no function `go`")
    assert (found.span.line, found.span.column) == place


TWO_ARMS = """\
@configuration
@modules Base, Arm, Drive, Reach
Base is_controlled_by Drive
Arm is_controlled_by Reach

@module_start
@module_name Base
@Trans_X
void go(Twist twist);
@module_end
@module_start
@module_name Arm
@Rotn_Y
void turn(Twist twist);
@module_end
@module_start
@module_name Drive
@ControlOut
Twist drive();
@module_end
@module_start
@module_name Reach
@ControlOut
Twist reach();
@module_end
"""


def test_a_kind_of_a_pack_is_bound_for_all_its_nodes(tmp_path: Path, capsys: Captured) -> None:
    robot, scenario = tmp_path / "robot.mars", tmp_path / "s.toml"
    robot.write_text(TWO_ARMS)
    (tmp_path / "w.py").write_text("def step(command):\n    return command\n\n\nspare = step\n")
    text = (
        'duration = 1\nup = "z"\n[robot]\nmodule = "Base"\n[bindings]\nDrive.python = "w.py:step"\n'
    )
    text += 'Reach.python = "w.py:step"\nwatchdog.python = "w.py:step"\n'
    words = ["run", str(robot), "--scenario", str(scenario), "--dry-run", "--quiet"]
    words += ["--rules", str(ROOT / "examples" / "packs" / "watchdog")]
    scenario.write_text(text)
    run_here(words)
    shown = capsys.readouterr().out
    assert "Watchdog1" in shown and "Watchdog2" in shown
    assert shown.count("spare") == 0
    scenario.write_text(f'{text}Watchdog2.python = "w.py:spare"\n')
    run_here(words)
    assert capsys.readouterr().out.count("spare") == 1
