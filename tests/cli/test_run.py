"""The command `run`: its output, files and status."""

import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

from mars_asp.cli import run_command, run_here
from tests.support.documents import ROOT
from tests.support.fixtures import Captured, Patch
from tests.support.trials import BASE, DRIVE, HAND

LEVEL0 = ROOT / "examples" / "level0"


def test_blocks_of_a_configuration_describe_its_modules(tmp_path: Path, capsys: Captured) -> None:
    blocks = {
        "Eye": "@Sense NotifyAtFrequency 20, RequestWhenReady\nScan look();",
        "Log": "@DataIn\nvoid log(Scan scan);",
        "Hand": "@ControlOut\nCommand lead();",
        "Base": "@Trans_Z _ _ 800\n@Rotn_Y",
        "Arm": "@Grasp 0 80",
    }
    written = "".join(
        f"@module_start\n@module_name {name}\n{block}\n@module_end\n"
        for name, block in blocks.items()
    )
    (tmp_path / "robot.mars").write_text(
        "@configuration flat\n@modules Eye, Log, Screen, Hand, Base, Arm\n"
        "Arm is_mounted_on Base (y, 90, _, _, 0, 0, 0)\nLog uses_data_from Eye\n"
        "Screen uses_data_from Eye NotifyAtFrequency 5\n"
        "Arm is_controlled_by Hand\n" + written.replace("@ControlOut", "@ControlOut Rotn_Y, Grasp"),
    )
    (tmp_path / "lead.py").write_text(
        "count = 0\nprint('read')\ndef lead():\n    global count\n    count += 1\n"
        "    print('led')\n"
        "    return ('Rotn_Y', 9) if count % 2 else ('Grasp', 40)\n"
    )
    (tmp_path / "s.toml").write_text(
        "duration = 2\n[robot]\nmodule = 'Base'\n[devices]\nEye.kind = 'sonar'\n"
        "Arm.kind = 'gripper'\n[bindings]\nHand = { python = 'lead.py:lead', period = 100 }\n"
    )
    words = ["run", str(tmp_path / "robot.mars"), "--scenario", str(tmp_path / "s.toml")]
    assert run_here([*words, "--format", "json"]) == 0
    printed, output = capsys.readouterr()
    assert output.startswith("read\nled\n")
    found = json.loads(printed)
    rates = {(link["source"], link["client"]): link["asked_hz"] for link in found["links"]}
    assert rates["Eye", "DataSplitter1"] == 20
    assert rates["DataSplitter1", "Screen"] == 5
    assert found["verdict"] == "pass"


def test_dropped_messages_are_shown(capfd: Captured, tmp_path: Path) -> None:
    (tmp_path / "c.mars").write_text(
        "@specification\n@modules P, C, D\nP is_controlled_by C\nP is_controlled_by D\n"
    )
    hands = "".join(HAND.replace(".C]", f".{name}]") for name in "CD")
    (tmp_path / "s.toml").write_text(BASE + hands)
    words = ["run", str(tmp_path / "c.mars"), "--scenario", str(tmp_path / "s.toml")]
    assert run_command(words) == 1
    output = capfd.readouterr().out
    assert re.search(r"C -> P +10\.00 +0 +31 overtaken", output)
    # No link asks for a rate.
    assert re.search(r"(?m)^link +got Hz +oldest ms +dropped$", output)
    assert not re.search(r"(?m) $", output)
    assert run_command([*words, "--format", "json"]) == 1
    links = json.loads(capfd.readouterr().out)["links"]
    assert [link["dropped"] for link in links] == [{"overtaken": 31}, {}]


def test_analysis_runs_no_behaviour(capfd: Captured, tmp_path: Path) -> None:
    """A source is text to analysis; only a run imports it."""
    ran = tmp_path / "ran"
    (tmp_path / "b.py").write_text(
        f"open({str(ran)!r}, 'w')\n# @module_start\n# @module_name C\n# @ControlOut Trans_Z\n"
        "def go() -> tuple[str, float]:\n    return 'Trans_Z', 100\n# @module_end\n"
    )
    config = tmp_path / "c.mars"
    config.write_text("@configuration\n@sources b.py\n@modules P, C\nP is_controlled_by C\n")
    (tmp_path / "s.toml").write_text(BASE + "[bindings.C]\nperiod = 100\n")
    for verb in ("check", "analyse", "synthesise", "explain"):
        assert run_command([verb, str(config)]) == 0
        assert not ran.exists()
    assert run_command(["run", str(config), "--scenario", str(tmp_path / "s.toml")]) == 0
    assert ran.exists()
    assert "100.0 %" in capfd.readouterr().out


def test_the_first_failure_is_printed(tmp_path: Path, capsys: Captured) -> None:
    (tmp_path / "b.py").write_text("def go():\n    raise ValueError('no\\x1b[31m map')\n")
    text = BASE + '[bindings.C]\npython = "b.py:go"\nperiod = 100\n'
    (tmp_path / "s.toml").write_text(text)
    (tmp_path / "d.mars").write_text(DRIVE)
    run_here(["run", str(tmp_path / "d.mars"), "--scenario", str(tmp_path / "s.toml")])
    output = capsys.readouterr().out
    assert "failed   C -> P  first by ValueError: no\\x1b[31m map\n" in output


def test_a_run_cut_short_warns_of_faults_that_it_does_not_come_to(
    tmp_path: Path, capsys: Captured
) -> None:
    (tmp_path / "s.toml").write_text(f"{BASE}{HAND}[faults.C]\nfrom = 2\n")
    (tmp_path / "d.mars").write_text(DRIVE)
    words = ["run", str(tmp_path / "d.mars"), "--scenario", str(tmp_path / "s.toml")]
    for duration, count in (("1", 1), ("2.5", 0)):
        assert run_here([*words, "--duration", duration, "--quiet"]) == 0
        output = " ".join(capsys.readouterr().err.split())
        assert (
            output.count("warning: the fault of `C` begins at 2 s, after the end of this") == count
        )


def _run(*words: str) -> int:
    return run_command(
        ["run", str(LEVEL0 / "config.mars"), "--scenario", str(LEVEL0 / "scenario.toml"), *words]
    )


def test_level_0_runs_and_same_seed_is_same_trace_to_the_byte(
    capfd: Captured, tmp_path: Path
) -> None:
    traces = []
    for name in ("a", "b"):
        out, svg = tmp_path / f"{name}.jsonl", tmp_path / f"{name}.svg"
        words = ["--duration", "5", "--format", "json", "--record", str(out), "--plot", str(svg)]
        status = _run(*words)
        result = json.loads(capfd.readouterr().out)
        assert (status, result["verdict"], result["collisions"]) == (0, "pass", 0)
        assert set(result["control_time"]) == {"Turn", "Forward", "Collide"}
        assert result["control_time"]["Collide"] == 0  # never in control, and listed
        traces.append(out.read_bytes() + svg.read_bytes())
    assert traces[0] == traces[1]
    assert len(traces[0]) > 10_000


def test_each_winner_of_an_arbiter_is_listed_with_instant_and_reason(
    capfd: Captured,
) -> None:
    assert _run("--duration", "5", "--why") == 0
    output = capfd.readouterr().out.split("\nArbitrationNode\n")[1].splitlines()
    assert output[0].split(maxsplit=3)[1:3] == ["s", "Turn"]
    assert output[0].endswith("  alone in force")
    instants = [float(line.split()[0]) for line in output]
    assert instants == sorted(instants)


def test_a_violated_requirement_is_status_1(capfd: Captured, tmp_path: Path) -> None:
    text = (LEVEL0 / "scenario.toml").read_text() + "clearance = 3000\n"
    text = text.replace('"sources/', f'"{LEVEL0.as_posix()}/sources/')
    (tmp_path / "s.toml").write_text(text)
    words = ["run", str(LEVEL0 / "config.mars"), "--scenario", str(tmp_path / "s.toml")]
    words += ["--duration", "1", "--explain"]
    assert run_command(words) == 1
    out = " ".join(capfd.readouterr().out.split())
    assert "VIOLATED clearance" in out
    assert "mm, and 3 m is required [run/clearance]" in out
    assert f"s.toml:{len(text.splitlines())} clearance = 3000" in out
    assert run_command([*words, "--format", "json"]) == 1
    trace, *_ = json.loads(capfd.readouterr().out)["traces"]
    assert trace["rule"]["id"] == "run/clearance"
    rates, observed = trace["premises"]
    assert (rates["atom"], rates["kind"]) == ("asked(clearance)", "given")
    assert (observed["kind"], observed["at_s"], observed["location"]) == ("observed", 0.0, None)
    assert observed["message"].endswith(" mm, and 3 m was asked for")


def test_annotated_functions_run_without_another_line_of_glue(
    capfd: Captured, tmp_path: Path
) -> None:
    text = (LEVEL0 / "scenario.toml").read_text()
    bare = text[: text.index("[bindings]")] + text[text.index("[requirements]") :]
    (tmp_path / "s.toml").write_text(bare)
    words = ["run", str(LEVEL0 / "config.mars"), "--duration", "3", "--format", "json"]
    entries = []
    for scenario, sources in (
        (LEVEL0 / "scenario.toml", []),
        (tmp_path / "s.toml", ["--sources", str(LEVEL0 / "sources")]),
    ):
        assert run_command([*words, "--scenario", str(scenario), *sources]) == 0
        result = json.loads(capfd.readouterr().out)
        entries.append((result["events"], result["driven_mm"], result["control_time"]))
    assert entries[0] == entries[1]
    assert entries[0][0] > 100


def test_a_closed_output_ends_a_run_quietly() -> None:
    scenario = str(LEVEL0 / "scenario.toml")
    words = ("run", str(LEVEL0 / "config.mars"), "--scenario", scenario, "--duration", "1")
    command = [sys.executable, "-m", "mars_asp", *words]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as running:
        assert running.stdout is not None and running.stderr is not None
        running.stdout.close()
        assert running.stderr.read() == b""
    assert running.returncode == 141


def test_a_plan_of_a_scenario_for_another_robot_is_refused(
    capsys: Captured,
) -> None:
    scenario = str(ROOT / "examples" / "patrol" / "scenario.toml")
    words = ["run", f"{LEVEL0}/config.mars", "--scenario", scenario, "--dry-run"]
    assert run_here(words) == 2
    output = capsys.readouterr()
    assert "`Base` is not a module of the specification" in " ".join(output.err.split())
    assert output.out.endswith("nothing was run\n")


ROBOT = """\
@configuration hierarchical
@modules Sonar, Cruise, Avoid, Joy, Base, Mast
Sonar is_mounted_on Mast
Mast is_mounted_on Base
Cruise uses_data_from Sonar
Avoid uses_data_from Sonar
Base is_controlled_by Cruise 1
Base is_controlled_by Avoid 2
Base is_controlled_by Joy 3
Cruise is_suppressed_by Avoid 50
"""
WORLD = """\
duration = 2
robot = { module = "Base" }
world.walls = [[[-2000, -2000], [2000, -2000], [2000, 2000], [-2000, 2000], [-2000, -2000]]]
devices.Sonar = { kind = "sonar", beams = 12 }
devices.Joy = { kind = "joystick", script = [[0, "Rotn_Y", -45], [1, "release"]] }
bindings.Cruise.python = "b.py:cruise"
"""


@pytest.fixture
def suppressed(tmp_path: Path, monkeypatch: Patch) -> Path:
    """Return the folder of a robot, and of a scenario that does not bind `Avoid`."""
    monkeypatch.chdir(tmp_path)
    Path("r.mars").write_text(ROBOT)
    Path("s.toml").write_text(WORLD)
    Path("b.py").write_text(
        "def cruise(r): return ('Trans_Z', 100)\ndef avoid(r): return ('Rotn_Y', 60)\n"
    )
    return tmp_path


def test_a_suppressor_reaches_an_arbiter_where_another_may_win(
    suppressed: Path, capsys: Captured
) -> None:
    """Another controller may win there; a mast that nothing commands is not idle."""
    with (suppressed / "s.toml").open("a") as scenario:
        scenario.write('bindings.Avoid.python = "b.py:avoid"\n')
    assert run_here(["run", "r.mars", "--scenario", "s.toml", "--why", "-q"]) == 0
    shown = " ".join(capsys.readouterr().out.split())
    assert "`ArbitrationNode` got a message of `Avoid` at 0 s" in shown
    assert "`Base` got a message" not in shown
    assert "priority 2 outranks its line through Gate1 (1)" in shown
    assert "Mast" not in shown


def test_a_dry_run_names_unbound_modules(suppressed: Path, capsys: Captured) -> None:
    assert run_here(["run", "r.mars", "--scenario", "s.toml", "--dry-run"]) == 2
    error = " ".join(capsys.readouterr().err.split())
    assert "`Avoid` is not bound (control out)" in error
    assert "bind `Avoid` to a Python function in the scenario" in error
    # A run refuses the same: a module with functions that nothing moves, among others.
    arm = ROBOT.replace("Mast", "Arm").replace("50\n", "50\nArm is_controlled_by Cruise\n", 1)
    (suppressed / "r.mars").write_text(arm)
    refused = []
    for option in ("--dry-run", "--quiet"):
        assert run_here(["run", "r.mars", "--scenario", "s.toml", option]) == 2
        refused.append(sorted(re.findall(r"`(\w+)` is not bound", capsys.readouterr().err)))
    assert refused[0] == refused[1] == ["Arm", "Avoid"]


def test_a_comment_hides_a_warning_of_a_run(suppressed: Path, capsys: Captured) -> None:
    (suppressed / "r.mars").write_text(
        ROBOT.replace("50\n", "300  // mars: ignore[never_released] subsumption\n")
        + "@module_start\n@module_name Sonar\n@Sense NotifyAtFrequency 10\nRanges scan();\n"
        + "@module_end\n"
    )
    run_here(["run", "r.mars", "--scenario", "s.toml", "-q"])
    assert "never_released" not in capsys.readouterr().err
