"""A run with a Gate and a lock: its verdict, links, events and explanations."""

import json
from pathlib import Path

import pytest

from mars_asp.cli import run_here
from tests.support.fixtures import Captured, Patch

SPECIFICATION = """\
@specification hierarchical
@modules Map, Over, Quiet, Pause, View, EStop, Go, Base, Gate1, ArbitrationNode
Gate1 uses_data_from Map
Gate1 is_suppressed_by Over 200
Gate1 is_inhibited_by Quiet 150
Gate1 is_inhibited_by Pause 500
View uses_data_from Gate1
Base is_controlled_by ArbitrationNode
ArbitrationNode is_controlled_by Go 3 hold 300
ArbitrationNode is_locked_by EStop 200 hold 500
"""
BLOCKS = {
    "Map": "@Sense NotifyAtFrequency 20\nNum f();",
    "Over": "@Sense NotifyWhenReady\nNum f();",
    "Quiet": "@Sense NotifyWhenReady\nTick f();",
    "View": "@DataIn\nvoid f(Num x);",
    "Pause": "@Sense NotifyWhenReady\nIsBool f();",
    "EStop": "@Sense NotifyWhenReady\nIsBool f();",
    "Go": "@ControlOut Trans_Z\nCommand f();",
    "Base": "@Trans_Z\nvoid f();",
}
SCENARIO = """\
duration = 2.0
robot.module = "Base"
[bindings]
Map = { python = "f.py:Map" }
Over = { python = "f.py:Over", period = 50 }
Quiet = { python = "f.py:Quiet", period = 50 }
Pause = { python = "f.py:Pause", period = 50 }
EStop = { python = "f.py:EStop", period = 50 }
Go = { python = "f.py:Go", period = 100 }
View = { python = "f.py:view" }
"""
FUNCTIONS = """\
def every(step, at):
    class Sends:
        def __init__(self): self.t = -step
        def __call__(self):
            self.t += step
            return at(self.t)
    return Sends
Map = every(50, lambda t: t)
Over = every(50, lambda t: -1 if t in (150, 350) else None)
Quiet = every(50, lambda t: 1 if t in (600, 700) else None)
Pause = every(50, lambda t: t == 1000 if t in (1000, 1100) else None)
EStop = every(50, lambda t: False if t <= 900 else None)
Go = every(100, lambda t: ("Trans_Z", 100))
def view(x): pass
"""


def test_a_gate_and_a_lock_are_judged_listed_recorded_and_explained(
    tmp_path: Path, monkeypatch: Patch, capsys: Captured
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "200")
    blocks = (f"@module_start\n@module_name {n}\n{b}\n@module_end\n" for n, b in BLOCKS.items())
    Path("r.mars").write_text("\n".join([SPECIFICATION, *blocks]))
    Path("f.py").write_text(FUNCTIONS)
    Path("s.toml").write_text(SCENARIO)
    command = ["run", "r.mars", "--scenario", "s.toml", "--record", "r.jsonl"]
    assert run_here([*command, "--why", "--why-not"]) == 0
    output = " ".join(capsys.readouterr().out.split())
    for line in (
        "holds gates respected",
        "1.400 s none EStop, which locks below 200, had been silent for 0.5 s",
        "`View` got a message of `Over` at 0.15 s: `Over` spoke at 0.15 s and suppresses `Map` for"
        " 200 ms [run/gates/suppressor] r.mars:4",
        "`Base` stopped at 1.4 s: `EStop`, which locks below 200, had been silent for 0.5 s"
        " [run/gates/silent] r.mars:10",
        "`View` did not get 4 of `Map` from 0.35 s to 0.5 s: `Over` spoke at 0.35 s and suppresses"
        " `Map` for 200 ms [run/gates/closed] r.mars:4",
        "`View` did not get 2 of `Map` from 1 s to 1.05 s: `Pause` spoke at 1 s and inhibits `Map`,"
        " until its `false` ended that at 1.1 s [run/gates/ended] r.mars:6",
        "`View` did not get 5 of `Map` from 0.6 s to 0.8 s: `Quiet` spoke from 0.6 s to 0.7 s, and"
        " each time inhibits `Map` for 150 ms [run/gates/closed-repeatedly] r.mars:5",
    ):
        assert line in output
    events = [json.loads(line) for line in Path("r.jsonl").read_text().splitlines()]
    closings = [(e["ns"], e["where"], e["value"]) for e in events if e["event"] == "gate"]
    assert closings == [
        (150_000_000, "Gate1", ["closed", "Over", 350_000_000]),
        (350_000_000, "Gate1", ["closed", "Over", 550_000_000]),
        (600_000_000, "Gate1", ["closed", "Quiet", 750_000_000]),
        (700_000_000, "Gate1", ["closed", "Quiet", 850_000_000]),
        (1_000_000_000, "Gate1", ["closed", "Pause", 1_500_000_000]),
        (1_100_000_000, "Gate1", ["opened", "Pause", 1_100_000_000]),
    ]
    kinds = {e["where"]: e["event"] for e in events if " -> " in e["where"]}
    assert run_here([*command, "--format", "json"]) == 0
    links = json.loads(capsys.readouterr().out)["links"]
    assert {f"{link['source']} -> {link['client']}": link["kind"] for link in links} == kinds
    assert links[0]["dropped"] == {"suppressed": 8, "inhibited": 7}


DRIVEN = """\
@configuration hierarchical
@modules A, B, Base
Base is_controlled_by A 1
"""
CONTROLS = """\
duration = 2
robot.module = "Base"
[bindings]
A = { python = "g.py:a", period = 100 }
B = { python = "g.py:b", period = 100 }
"""
HELD = "`Base` did not get {} of `A` from 0 s to {} s: `B`, which locks it, {} [run/gates/held]"


@pytest.mark.parametrize(
    ("lines", "b", "expected"),
    [
        (
            "Base is_locked_by B",
            "ctx.now < 1",
            [
                "0.000 s none B is true 1.000 s A alone in force",
                HELD.format(10, 0.9, "was true"),
                "`Base` did not start at 0 s: `B`, which locks it, was true [run/gates/stopped]",
            ],
        ),
        (
            "Base is_locked_by B hold 500",
            "None",
            [
                "`Base` never moved: `B`, which locks it, held back its commands",
                "B had not spoken",
                "`Base` did not start at 0 s: `B`, which locks it, had not spoken",
                HELD.format(21, 2, "had not spoken"),
            ],
        ),
        (
            "Base is_limited_by B hold 300",
            "{'Trans_Z': 50} if ctx.now < 1 else None",
            [
                "`B`, which limits `Base`, lowered 12 of the commands for it from 0 s to 1.1 s",
                "`Base` stopped at 1.2 s: `B`, which limits it, had been silent for 0.3 s",
            ],
        ),
        (
            "Base is_limited_by B hold 300",
            "None",
            ["`Base` did not start at 0 s: `B`, which limits it, had not spoken"],
        ),
        (
            "Base is_controlled_by B 2\nBase is_arbitrated_by weighted period 50",
            "('Trans_Z', 1)",
            ["weighted: sends the weighted mean of each 50 ms; no controller wins"],
        ),
    ],
)
def test_locks_limits_and_means_are_explained_from_the_start(
    lines: str, b: str, expected: list[str], tmp_path: Path, monkeypatch: Patch, capsys: Captured
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "200")
    Path("r.mars").write_text(f"{DRIVEN}{lines}\n")
    Path("s.toml").write_text(CONTROLS)
    Path("g.py").write_text(f"def a(): return 'Trans_Z', 200\ndef b(ctx): return {b}\n")
    run_here(["run", "r.mars", "--scenario", "s.toml", "--why", "--why-not"])
    output = " ".join(capsys.readouterr().out.split())
    for line in expected:
        assert line in output, output
