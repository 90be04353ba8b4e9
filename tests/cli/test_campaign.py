"""The verb `campaign`: lines that do not depend on workers, and a file that survives any end."""

import json
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import jsonschema_rs
import pytest

from mars_asp.cli import run_command, run_here
from mars_asp.cli.campaign import Progress
from mars_asp.cli.schemas import schema_text
from mars_asp.cli.suggested_commands import way_to_install
from mars_asp.execution.campaign.grid import Grid, Run
from mars_asp.execution.campaign.journal import ended_run
from tests.support.documents import ROOT
from tests.support.fixtures import Captured, Patch
from tests.support.processes import HANGING, PLAIN, children_of, processes_where
from tests.support.processes import await_true as await_in_time
from tests.support.trials import DRIVE

SCENARIO = """\
duration = 1
[robot]
module = "P"
[world]
scatter = { count = 3, within = 900, free = 300 }
[bindings.C]
python = "b.py:go"
period = 100
[requirements]
no_collision = true
"""
#: Some seeds do what no behaviour should; each run that begins adds a letter to a file.
BEHAVIOUR = """\
import os, time
with open({log!r}, "a") as log:
    log.write("x")
DOES = {{97: "exit", 98: "hang", 99: "kill"}}.get(SEED)
def go():
    if DOES == "exit":
        os._exit(3)
    if DOES == "hang":
        time.sleep(1000)
    if DOES == "kill":
        os.kill(os.getpid(), 9)
    time.sleep({pause})
    return "Trans_Z", 400
"""


_OF_LINE = jsonschema_rs.validator_for(json.loads(schema_text("campaign")))


class Campaign:
    """A robot and a scenario in a folder of their own."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.out, self.log = folder / "o.jsonl", folder / "log"
        (folder / "robot.mars").write_text(DRIVE)
        (folder / "s.toml").write_text(SCENARIO)
        self.behave(0)

    def behave(self, pause: float) -> None:
        """Let a run take eleven times so long, in seconds; a remark keeps its hash the same."""
        text = BEHAVIOUR.format(log=str(self.log), pause="float(open('pause').read())")
        (self.folder / "b.py").write_text(text)
        (self.folder / "pause").write_text(str(pause))

    def words(self, *words: str, verb: str = "campaign") -> list[str]:
        return [verb, "robot.mars", "--scenario", "s.toml", *words]

    def process(self, *words: str) -> "subprocess.Popen[str]":
        return subprocess.Popen(
            [sys.executable, "-m", "mars_asp", *self.words(*words, "-o", str(self.out))],
            cwd=self.folder,
            env={**os.environ, **PLAIN, "PYTHONPATH": str(ROOT)},
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )

    def lines(self) -> list[dict[str, Any]]:
        """Return the whole lines of the file, which are all that it has."""
        raw = self.out.read_bytes() if self.out.exists() else b""
        assert not raw or raw.endswith(b"\n")
        found = [json.loads(line) for line in raw.splitlines()]
        assert [error.message for line in found for error in _OF_LINE.iter_errors(line)] == []
        return found


@pytest.fixture
def campaign(tmp_path: Path, monkeypatch: Patch) -> Campaign:
    monkeypatch.chdir(tmp_path)
    return Campaign(tmp_path)


def test_lines_are_those_of_single_runs(campaign: Campaign, capsys: Captured) -> None:
    vary = ["--vary", "robot.radius=100,300", "--vary", "modules.C=on,off"]
    status = run_here(campaign.words("--seeds", "1-3", *vary))
    first, *lines, last = map(json.loads, capsys.readouterr().out.splitlines())
    assert (first["format"], first["version"]) == ("mars-campaign", 1)
    assert [(line["seed"], *line["vary"].values()) for line in lines] == [
        (seed, switch, radius)
        for radius in (100, 300)
        for switch in ("on", "off")
        for seed in (1, 2, 3)
    ]
    for line in lines:
        changes = line.pop("vary")
        declared = [f"{key}={value}" for key, value in changes.items()]
        words = [word for each in declared for word in ("--vary", each)]
        run_here(
            campaign.words("--seed", str(line["seed"]), *words, "--format", "json", verb="run")
        )
        assert json.loads(capsys.readouterr().out) == line
        assert bool(line["messages"]) == (changes["modules.C"] == "on")
    passed = [line["verdict"] == "pass" for line in lines]
    assert (last["runs"], last["passed"], status) == (12, sum(passed), int(not all(passed)))
    held = [
        r["holds"] for line in lines for r in line["requirements"] if r["name"] == "no_collision"
    ]
    assert last["requirements"]["no_collision"]["held"] == sum(held)
    assert not all(held)
    for each in last["worst"]:
        verb, *words = each["command"].split()[1:]
        assert run_here([verb, *words, "--quiet"]) == 1
        assert "VIOLATED no_collision" in capsys.readouterr().out


def test_quantiles_and_warnings_are_in_lines_and_table(
    campaign: Campaign, capsys: Captured
) -> None:
    reach = "[requirements]\nreach = { at = [900, 0], radius = 600 }\n"
    Path("s.toml").write_text(SCENARIO.replace("[requirements]\n", reach))
    vary = ["--vary", "modules.C=on,off", "--workers", "2", "-o", "o.jsonl"]
    assert run_here(campaign.words("--seeds", "1-2", *vary)) == 1
    _, *lines, summary = campaign.lines()
    off = [line for line in lines if line["vary"]["modules.C"] == "off"]
    for line in off:
        kinds = {f"{each['kind']}({each['subject']})" for each in line["warnings"]}
        assert kinds == {"module_never_ran(P)", "requirement_in_vain(no_collision)"}
    assert summary["warnings"] == {
        "module_never_ran(P)": 2, "requirement_in_vain(no_collision)": 2
    }  # fmt: skip
    table = capsys.readouterr().out
    assert re.search(r"(?m)^time to reach +5 % 0\.\d s, 50 % 0\.\d s, 95 % never$", table)
    assert re.search(r"(?m)^distance to place +5 % \d+ mm, ", table)
    assert "warnings in 2 of 4: module_never_ran(P)," in table


def test_a_run_cannot_hang_or_end_a_campaign(campaign: Campaign, capsys: Captured) -> None:
    words = campaign.words("--seeds", "1,97-99,2", "--run-limit", "1", "-o", "o.jsonl")
    assert run_here(words) == 1
    _, one, raised, hung, killed, two, last = campaign.lines()
    assert one["events"] and two["events"]
    assert (raised["verdict"], raised["failures"][0]["count"]) == ("fail", 11)
    assert (hung["verdict"], hung["requirements"]) == ("not decided", [])
    assert hung["error"] == "the run took longer than 1 s, so it was ended"
    assert killed["verdict"] == "fail"
    assert killed["error"] == "the code of a behaviour ended the run (SIGKILL)"
    assert {*hung} == {*killed} and {*hung} - {"error"} < {*one}
    assert last["requirements"]["no module failed"] == {
        **last["requirements"]["no module failed"], "held": 2, "of": 3
    }  # fmt: skip
    output = capsys.readouterr().out
    assert "  seed 98: the run took longer than 1 s, so it was ended\n" in output
    assert "mars-asp run robot.mars --scenario s.toml --seed 99\n" in output


def test_finished_runs_are_not_run_again(campaign: Campaign, capsys: Captured) -> None:
    run_here(campaign.words("--seeds", "1-3", "-o", "o.jsonl"))
    first = campaign.out.read_bytes()
    run_here(campaign.words("--seeds", "1-3", "-o", "o.jsonl"))
    assert campaign.out.read_bytes() == first
    assert campaign.log.read_text() == "xxx"
    # Torn in its third run: that one is run again, and one seed is new.
    campaign.out.write_bytes(b"\n".join(first.split(b"\n")[:4])[:-9])
    run_here(campaign.words("--seeds", "4,1-3", "-o", "o.jsonl"))
    assert campaign.log.read_text() == "xxxxx"
    assert [line.get("seed") for line in campaign.lines()] == [None, 4, 1, 2, 3, None]
    assert campaign.out.read_bytes().split(b"\n")[2:5] == first.split(b"\n")[1:4]


@pytest.mark.parametrize(
    ("file", "what"),
    [("robot.mars", "another configuration"), ("s.toml", "another scenario"), ("b.py", "another")],
)
def test_another_campaign_is_refused(
    campaign: Campaign, capsys: Captured, file: str, what: str
) -> None:
    run_here(campaign.words("--seeds", "1", "-o", "o.jsonl"))
    before = campaign.out.read_bytes()
    remark = "//" if file == "robot.mars" else "#"
    with Path(file).open("a") as changed:
        changed.write(f"{remark} a remark\n")
    assert run_here(campaign.words("--seeds", "1", "-o", "o.jsonl")) == 2
    assert what in capsys.readouterr().err
    assert campaign.out.read_bytes() == before
    assert run_here(campaign.words("--seeds", "1", "-o", "o.jsonl", "--fresh")) == 0
    assert campaign.out.read_bytes().split(b"\n")[1:] == before.split(b"\n")[1:]


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--seeds", "1", "--vary", "robot.raduis=1"], "unknown key `raduis`"),
        (["--seeds", "1", "--vary", "modules.D=off"], "`D` is not a module of the specification"),
        (["--seeds", "1", "--vary", "modules.P=off"], "`P` is not run by a Python function"),
        (["--seeds", "1", "--vary", "bindings.CC.period=9"], "did you mean `C`?"),
        (["--seeds", "1", "--plot", "x.svg"], "there is no key with several values"),
        (["--seeds", "1", "--fresh"], "there is no file to begin anew"),
        (["--seeds", "1", "--workers", "2", "--cluster", "tcp://x:1"], "workers of its own"),
        (["--seeds", "1", "-o", "s.toml"], "this is not the file of a campaign"),
        (["--seeds", "1", "-o", "/dev/null"], "this is not a regular file"),
        (["--seeds", "1-100000", "--vary", "robot.radius=1,2"], "these are 200000 runs"),
        (["--seeds", "1", "--vary", 'bindings.C.python="no.py:go"'], "no.py"),
    ],
)
def test_impossible_options_are_refused_before_any_run(
    campaign: Campaign, capsys: Captured, words: list[str], message: str
) -> None:
    assert run_here(campaign.words(*words)) == 2
    assert message in " ".join(capsys.readouterr().err.split())
    assert not campaign.log.exists()
    assert not campaign.out.exists()


def test_warnings_of_a_scenario_are_printed_once_before_the_runs(
    campaign: Campaign, capsys: Captured
) -> None:
    reach = "[requirements]\nreach = { at = [9, 0], radius = 1, within = 60 }\n"
    Path("s.toml").write_text(SCENARIO.replace("[requirements]\n", reach))
    text = "the run ends at 1 s"
    for seeds in ("1-2", "1-3"):
        assert run_here(campaign.words("--seeds", seeds, "-o", "o.jsonl")) == 1
        assert " ".join(capsys.readouterr().err.split()).count(text) == 1
    varied = ["--seeds", "1", "--vary", "requirements.reach.within=1,60,70"]
    run_here(campaign.words(*varied, "--format", "json"))
    warnings = [json.loads(line) for line in capsys.readouterr().err.splitlines()]
    assert [each["severity"] for each in warnings] == ["warning", "warning"]


def test_a_run_that_cannot_begin_ends_the_campaign_and_is_named(
    campaign: Campaign, capsys: Captured
) -> None:
    Path("b.py").write_text("if SEED == 2: raise ImportError('no maps')\ndef go(): pass")
    assert run_here(campaign.words("--seeds", "1-3", "-o", "o.jsonl")) == 2
    output = capsys.readouterr().err
    assert "ImportError: no maps" in " ".join(output.split())
    assert "The run with seed 2 cannot begin." in output
    assert [line["seed"] for line in campaign.lines()[1:]] == [1]


def test_a_cluster_needs_dask_and_several_workers_do_not(
    campaign: Campaign, capsys: Captured, monkeypatch: Patch
) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    monkeypatch.setattr("mars_asp.cli.campaign_dask.find_spec", lambda name: None)
    assert run_here(campaign.words("--seeds", "1", "--cluster", "tcp://127.0.0.1:1")) == 2
    assert f"`{way_to_install('campaign')}`" in " ".join(capsys.readouterr().err.split())
    written = []
    for workers in "13":
        run_here(campaign.words("--seeds", "1-7", "--workers", workers))
        written.append(capsys.readouterr().out)
    assert written[0] == written[1]


def test_a_grid_is_drawn_and_shown_by_cell(campaign: Campaign, capsys: Captured) -> None:
    vary = ["--vary", "robot.radius=100,299", "--plot", "p.svg", "-o", "o.jsonl"]
    run_here(campaign.words("--seeds", "1-4", *vary))
    output = capsys.readouterr().out
    assert re.search(r"(?m)^passed +\d of 8 \([\d.]+-[\d.]+ %\)$", output)
    assert re.search(r"(?m)^ +robot.radius=100 +\d of 4 ", output)
    assert re.search(r"(?m)^passed in every run \(8 of 8\): ", output)
    assert Path("p.svg").read_text().count('r="4"') == 2
    assert run_here(campaign.words("--seeds", "1-4", *vary, "--format", "json")) == 1
    _, *lines, summary = campaign.lines()
    assert json.loads(capsys.readouterr().out) == summary
    assert summary["in_control"]
    for name, share in summary["in_control"].items():
        assert re.search(rf"(?m)^{name} in control |^in control in .* run: .*{name}", output)
        assert share["held"] == sum(line["control_time"][name] > 0 for line in lines)


def left(folder: Path) -> list[int]:
    """Return the other processes that work in a folder, or below it."""
    found = processes_where(lambda each: (each / "cwd").readlink().is_relative_to(folder))
    return [each for each in found if each != os.getpid()]


def await_true(holds: Callable[[], bool], command: "subprocess.Popen[str]") -> None:
    """Wait until something is the case, while a command runs."""
    while not holds():
        assert command.poll() is None, command.communicate()
        time.sleep(0.02)


def await_none_left(campaign: Campaign) -> None:
    await_in_time(lambda: not left(campaign.folder), "processes of the command")


@pytest.mark.skipif(sys.platform != "linux", reason="it looks into /proc")
@pytest.mark.parametrize(
    ("number", "workers"), [(signal.SIGTERM, 1), (signal.SIGINT, 2), (signal.SIGKILL, 2)]
)
def test_nothing_goes_on_when_the_command_is_ended(
    campaign: Campaign, number: signal.Signals, workers: int
) -> None:
    campaign.behave(1000)
    with campaign.process("--seeds", "1-3", "--workers", str(workers)) as command:
        await_true(
            lambda: campaign.log.exists() and len(campaign.log.read_text()) == workers, command
        )
        os.chdir(ROOT)
        command.send_signal(number)
        assert command.wait(HANGING) == (-number if number == signal.SIGKILL else 128 + number)
    await_none_left(campaign)
    assert len(campaign.lines()) == 1


@pytest.mark.skipif(sys.platform != "linux", reason="it looks into /proc")
def test_several_workers_lose_and_repeat_nothing(campaign: Campaign, capsys: Captured) -> None:
    """The process of a run and then the command are killed; the file is that of one worker."""
    campaign.behave(0.02)
    with campaign.process("--seeds", "1-24", "--workers", "2") as command:
        await_true(lambda: len(campaign.lines()) > 2, command)
        (verb,) = children_of(command.pid)
        runs: list[int] = []

        def are_two_running() -> bool:
            runs[:] = children_of(verb)
            return len(runs) == 2

        await_true(are_two_running, command)
        os.kill(runs[0], signal.SIGKILL)
        await_true(lambda: len(campaign.lines()) > 6, command)
        command.kill()
    os.chdir(ROOT)
    await_none_left(campaign)
    os.chdir(campaign.folder)
    before = campaign.lines()[1:]
    assert 6 <= len(before) < 24
    started = len(campaign.log.read_text())
    # Beyond those that ended, one run was lost with its process, and two with the command.
    assert started <= len(before) + 4
    campaign.behave(0)
    run_here(campaign.words("--seeds", "1-24", "-o", "o.jsonl"))
    assert len(campaign.log.read_text()) == started + 24 - len(before)
    run_here(campaign.words("--seeds", "1-24", "-o", "again.jsonl"))
    assert Path("again.jsonl").read_bytes() == campaign.out.read_bytes()


def test_the_line_shows_how_many_passed_and_how_long_it_will_take() -> None:
    before = ended_run(Run(1, {}), {"verdict": "fail", "requirements": []})
    passed = ended_run(Run(2, {}), {"verdict": "pass", "requirements": []})
    progress = Progress(Grid((1, 2, 3, 4)), {Run(1, {}).name: before}, 3)
    assert progress.line(0) == "1 of 4 runs  passed 0 of 1 (0.0-79.3 %)"
    progress.take(passed)
    assert progress.line(60) == "2 of 4 runs  passed 1 of 2 (9.5-90.5 %)"
    progress.take(passed)
    assert progress.line(130) == "3 of 4 runs  passed 2 of 3 (20.8-93.9 %)  1 min 10 s left"


@pytest.mark.parametrize("example", ["fleet/config", "level1/config"])
def test_each_key_of_a_line_is_in_the_schema(example: str, capsys: Captured) -> None:
    folder = ROOT / "examples" / example
    words = [f"{folder}.mars", "--scenario", str(folder.parent / "scenario.toml")]
    run_here(["campaign", *words, "--seeds", "1", "--vary", "duration=2"])
    lines = list(map(json.loads, capsys.readouterr().out.splitlines()))
    assert len(lines) == 3
    for line in lines:
        assert [error.message for error in _OF_LINE.iter_errors(line)] == []
        assert not _OF_LINE.is_valid({**line, "another": 1})
        for key in line:
            assert not _OF_LINE.is_valid({k: value for k, value in line.items() if k != key})


@pytest.mark.parametrize("verb", [("run",), ("campaign", "--seeds", "1")], ids=["run", "campaign"])
@pytest.mark.parametrize("limit", ["60", "200"])
def test_too_little_memory_for_numpy_is_reported(
    verb: tuple[str, ...], limit: str, tmp_path: Path
) -> None:
    (tmp_path / "robot.mars").write_text(DRIVE)
    (tmp_path / "s.toml").write_text('duration = 1\n[robot]\nmodule = "P"\n')
    words = [verb[0], "robot.mars", "--scenario", "s.toml", *verb[1:], "--memory-limit", limit]
    command = [sys.executable, "-m", "mars_asp", *words]
    env = {**os.environ, **PLAIN, "PYTHONPATH": str(ROOT)}
    ended = subprocess.run(
        command, cwd=tmp_path, env=env, capture_output=True, text=True, check=False
    )
    assert (ended.returncode, ended.stdout) == (3, "")
    assert ended.stderr == f"mars-asp: the memory limit of {limit} MB ended this\n"


def test_the_schema_is_printed_without_a_file(capsys: Captured) -> None:
    assert run_command(["campaign", "--schema"]) == 0
    assert capsys.readouterr().out == schema_text("campaign")
