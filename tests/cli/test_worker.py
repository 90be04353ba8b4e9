"""The command and its worker: their ends, and the files written at each."""

import json
import os
import pty
import signal
import subprocess
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

import pytest

from tests.support.campaigns import sample, seeds
from tests.support.documents import ROOT
from tests.support.processes import (
    HANGING,
    await_true,
    ended_children_time,
    processes_where,
    processor_time,
)
from tests.support.runaways import PACKS, contained
from tests.support.signals import end_at_random

LEVEL0 = "examples/level0/config.mars"
MARS = (sys.executable, "-m", "mars_asp")
#: A rule that grounds without end: nothing interrupts clingo while it does.
RUNAWAY = "p(1).\np(X + 1) :- p(X).\n"


def start(*words: str, environment: dict[str, str] | None = None) -> subprocess.Popen[bytes]:
    return subprocess.Popen(
        [*MARS, *words],
        cwd=ROOT,
        env={**os.environ, **(environment or {})},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )


def workers_of(marker: str) -> list[int]:
    """Return the running processes whose command line holds a marker."""

    def holds(entry: Path) -> bool:
        held = marker.encode() in (entry / "cmdline").read_bytes()
        return held and " Z " not in (entry / "stat").read_text()

    return processes_where(holds)


@pytest.fixture
def pack(tmp_path: Path) -> Iterator[Path]:
    path = tmp_path / "runaway.lp"
    path.write_text(RUNAWAY)
    yield path
    for left in workers_of(str(path)):
        os.kill(left, signal.SIGKILL)


def wait_for_worker(marker: str) -> None:
    """Wait until a command has its worker, and this has grounded for a while."""

    def grounds() -> bool:
        found = workers_of(marker)
        return len(found) == 2 and processor_time(max(found)) > 0.3

    await_true(grounds, "a command without a worker")


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT])
def test_a_signal_ends_a_command_that_grounds(number: signal.Signals, pack: Path) -> None:
    command = start("synthesise", LEVEL0, "--rules", str(pack), "-o", str(pack.parent / "out"))
    wait_for_worker(str(pack))
    before = ended_children_time() + sum(map(processor_time, workers_of(str(pack))))
    command.send_signal(number)
    output, result = command.communicate(timeout=HANGING)
    # A rule that grounds without end takes all the time until it is ended.
    assert ended_children_time() - before < 1
    assert (command.returncode, output, result) == (128 + number, b"", b"")
    assert workers_of(str(pack)) == []
    assert list(pack.parent.iterdir()) == [pack]


def test_a_command_that_is_killed_takes_its_worker_along(pack: Path) -> None:
    command = start("analyse", LEVEL0, "--rules", str(pack))
    wait_for_worker(str(pack))
    command.kill()
    command.wait()
    await_true(lambda: workers_of(str(pack)) == [], "a worker without its command")


@pytest.mark.parametrize("unbuffered", ["", "1"])
@pytest.mark.parametrize("words", [("--version",), ("--help",), ("analyse", LEVEL0)])
@pytest.mark.parametrize("redirection", [">/dev/full", ">&-"])
def test_output_that_cannot_be_written_is_an_error(
    redirection: str, words: Sequence[str], unbuffered: str
) -> None:
    command = " ".join([*MARS, *words])
    done = subprocess.run(
        ["/bin/sh", "-c", f"{command} {redirection}"],
        cwd=ROOT,
        env={**os.environ, "PYTHONUNBUFFERED": unbuffered},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 2
    assert done.stderr.startswith("mars-asp: error: standard output: ")
    assert len(done.stderr.splitlines()) == 1


def test_a_closed_output_ends_the_command_quietly() -> None:
    command = start("explain", "examples/level1/config.mars", "--format", "json")
    assert command.stdout is not None
    command.stdout.close()
    assert command.wait(timeout=HANGING) == 141
    assert command.stderr is not None
    assert command.stderr.read() == b""


def test_all_streams_may_be_closed() -> None:
    command = " ".join([*MARS, "analyse", LEVEL0])
    done = subprocess.run(["/bin/sh", "-c", f"{command} <&- >&- 2>&-"], cwd=ROOT, check=False)
    assert done.returncode == 2


SCENARIO = """\
duration = 1
up = "y"
[robot]
module = "Base"
radius = 100
start = [0, 0, 0]
[bindings]
Drive = { python = "drive.py:go", period = 100 }
"""
ROBOT = "@configuration\n@modules Base, Drive\nBase is_controlled_by Drive\n"


def run_in(folder: Path) -> tuple[str, ...]:
    """Write a scenario and a robot beside `drive.py`; return the command that runs them."""
    scenario, robot = folder / "s.toml", folder / "c.mars"
    scenario.write_text(SCENARIO)
    robot.write_text(ROBOT)
    return "run", str(robot), "--scenario", str(scenario)


@pytest.mark.parametrize(
    ("body", "status", "mentions"),
    [
        ("import os\ndef go(): os._exit(0)\n", 1, "called `exit(0)`"),
        ("import sys\ndef go(): sys.exit(0)\n", 1, "called `exit(0)`"),
        ("import sys\ndef go(): sys.stdout.close()\n", 1, "belongs to the command"),
        ("import os\ndef go(): os.closerange(0, 64)\n", 1, "drive.py"),
        ("import os\ndef go(): os.kill(os.getpid(), 9)\n", 1, "drive.py"),
        ("import os\nos.closerange(0, 64)\ndef go(): ...\n", 1, "drive.py"),
        ("import os\nos._exit(0)\n", 2, "drive.py"),
        (
            "import os\ndef go():\n    for n in range(3, 30):\n"
            "        try: os.write(n, b'x' * 99)\n        except OSError: ...\n",
            1,
            "drive.py",
        ),
    ],
)
def test_a_behaviour_that_ends_the_program_fails_the_run(
    body: str, status: int, mentions: str, tmp_path: Path
) -> None:
    (tmp_path / "drive.py").write_text(body)
    words = run_in(tmp_path)
    command = start(*words, "--record", str(tmp_path / "r.jsonl"))
    output, result = command.communicate(timeout=HANGING)
    assert command.returncode == status, result
    assert mentions in (output + result).decode()
    assert_whole_or_absent(tmp_path / "r.jsonl")


def assert_whole_or_absent(record: Path) -> None:
    """Check that a record ends with its last event, and that no part of one is beside it."""
    assert not list(record.parent.glob(".mars-asp.*"))
    if record.exists():
        lines = record.read_text().splitlines()
        assert json.loads(lines[-1])["ns"] in (900_000_000, 1_000_000_000)


@pytest.mark.parametrize(
    ("how", "status"), [("os.kill(os.getpid(), 9)", 1), ("os.closerange(0, 64)", 1)]
)
def test_a_record_of_which_much_was_written_is_dropped_with_its_run(
    how: str, status: int, tmp_path: Path
) -> None:
    (tmp_path / "drive.py").write_text(
        "import os\nfrom pathlib import Path\ncalls = 0\ndef go():\n    global calls\n"
        "    calls += 1\n    if calls == 5000:\n"
        f"        beside = list(Path({str(tmp_path)!r}).glob('.mars-asp.*'))\n"
        f"        Path({str(tmp_path / 'seen')!r}).write_text(str(len(beside)))\n"
        f"        {how}\n"
        "    return 'Trans_Z', 1.0\n"
    )
    (tmp_path / "s.toml").write_text(SCENARIO.replace("= 1\n", "= 9\n").replace("= 100 }", "= 1 }"))
    (tmp_path / "c.mars").write_text(ROBOT)
    (tmp_path / "r.jsonl").write_text("as it was")
    words = ("run", str(tmp_path / "c.mars"), "--scenario", str(tmp_path / "s.toml"))
    command = start(*words, "--record", str(tmp_path / "r.jsonl"))
    output, result = command.communicate(timeout=HANGING)
    assert (command.returncode, output) == (status, b""), result
    # Events were on the disk while the run went on.
    assert (tmp_path / "seen").read_text() == "1"
    assert (tmp_path / "r.jsonl").read_text() == "as it was"
    assert not list(tmp_path.glob(".mars-asp.*"))


def test_a_crash_of_the_reasoner_has_its_own_message(tmp_path: Path) -> None:
    pack = tmp_path / "pack.lp"
    pack.write_text("p(-2147483647 - 1).\nd(-1).\nq(X / Y) :- p(X), d(Y).\n")
    command = start("check", "examples/level0/config.mars", "--rules", str(pack))
    output, result = command.communicate(timeout=HANGING)
    assert command.returncode == 2
    # Other processors wrap, so that the rule is found as others that compute what does not fit.
    assert (
        output == b"" and b"(SIGFPE), so there is no result: does a rule divide" in result
    ) or b"pack.lp:3" in output


@pytest.mark.skipif(not hasattr(os, "pidfd_open"), reason="Linux alone tells of an end")
def test_a_forked_child_of_a_behaviour_does_not_delay_the_command(tmp_path: Path) -> None:
    (tmp_path / "drive.py").write_text(
        "import os, signal, time\ndef go():\n    if not (child := os.fork()):\n"
        "        os.setsid()\n        time.sleep(1000)\n"
        f"    with open({str(tmp_path / 'child')!r}, 'w') as file:\n"
        "        file.write(str(child))\n"
        "    os.kill(os.getpid(), signal.SIGSEGV)\n"
    )
    command = start(*run_in(tmp_path))
    assert command.wait(timeout=HANGING) == 1
    os.kill(int((tmp_path / "child").read_text()), signal.SIGKILL)


def test_a_forked_child_of_a_behaviour_may_end(tmp_path: Path) -> None:
    (tmp_path / "drive.py").write_text(
        "import os\ndef go():\n    child = os.fork()\n    if not child: os._exit(3)\n"
        "    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 3\n"
        "    if not os.fork():\n        print('heard by nobody' * 9999, flush=True)\n"
        "        os._exit(0)\n"
    )
    words = run_in(tmp_path)
    command = start(*words)
    output, result = command.communicate(timeout=HANGING)
    assert command.returncode == 0, output + result


def test_the_time_limit_counts_until_the_worker_has_ended(tmp_path: Path) -> None:
    (tmp_path / "drive.py").write_text(
        "import sys, time\nclass Slow:\n    def write(self, text): return len(text)\n"
        "    def flush(self): time.sleep(1000)\nsys.stderr = Slow()\ndef go(): pass\n"
    )
    words = run_in(tmp_path)
    command = start(*words, "--time-limit", "5")
    output, result = command.communicate(timeout=HANGING)
    assert (command.returncode, output) == (3, b"")
    assert "the time limit of 5 s ended this" in result.decode()


@pytest.mark.parametrize(
    ("words", "mentions"),
    [
        (("--time-limit", "1"), "the time limit of 1 s ended this"),
        (("--memory-limit", "300"), "the memory limit of 300 MB ended this"),
    ],
)
def test_a_limit_ends_a_runaway(words: tuple[str, ...], mentions: str, pack: Path) -> None:
    before = ended_children_time()
    command = start("analyse", LEVEL0, "--rules", str(pack), *words)
    output, result = command.communicate(timeout=HANGING)
    assert (command.returncode, output) == (3, b"")
    assert mentions in result.decode()
    if words[0] == "--time-limit":
        assert ended_children_time() - before < 2.5


def at_terminal(*words: str) -> tuple[int, int]:
    """Start a command at a terminal of its own; return its number and the terminal."""
    number, terminal = pty.fork()
    if not number:
        os.chdir(ROOT)
        os.execv(sys.executable, [*MARS, *words])
    return number, terminal


def printed_at(terminal: int) -> str:
    text = b""
    try:
        while more := os.read(terminal, 4096):
            text += more
    except OSError:  # no process has the terminal open any more
        pass
    os.close(terminal)
    return text.decode()


def test_a_terminal_is_read_though_the_worker_has_a_group_of_its_own() -> None:
    number, terminal = at_terminal("analyse", "-")
    os.write(terminal, b"@configuration\n@modules A, B\nA uses_data_from B\n\x04")
    result = printed_at(terminal)
    assert "nothing to resolve" in result
    assert os.waitstatus_to_exitcode(os.waitpid(number, 0)[1]) == 0


def test_ctrl_z_pauses_the_worker_too_and_ctrl_c_ends_both(pack: Path) -> None:
    def states() -> list[str]:
        return [
            Path(f"/proc/{number}/stat").read_text().rpartition(")")[2].split()[0]
            for number in workers_of(str(pack))
        ]

    number, terminal = at_terminal("analyse", LEVEL0, "--rules", str(pack), "--time-limit", "300")
    wait_for_worker(str(pack))
    os.write(terminal, b"\x1a")
    await_true(lambda: states() == ["T", "T"], "a pause")
    os.killpg(number, signal.SIGCONT)
    await_true(lambda: "T" not in states(), "a command that goes on")
    os.write(terminal, b"\x03")
    printed_at(terminal)
    assert os.waitstatus_to_exitcode(os.waitpid(number, 0)[1]) == 128 + signal.SIGINT
    assert workers_of(str(pack)) == []


def test_a_dry_run_lists_the_code_and_imports_none(tmp_path: Path) -> None:
    (tmp_path / "drive.py").write_text("raise SystemExit(7)\n")
    words = (*run_in(tmp_path), "--dry-run")
    output, result = start(*words, "--format", "json").communicate(timeout=HANGING)
    found = json.loads(output)
    file = str(tmp_path / "drive.py")
    assert found["imports"] == [{"path": file, "functions": {"Drive": "go"}}]
    (tmp_path / "drive.py").unlink()
    command = start(*words)
    output, result = command.communicate(timeout=HANGING)
    assert command.returncode == 2
    assert result.decode() == f"mars-asp: error: `{file}`, which this run imports, is not a file\n"


@pytest.mark.parametrize(
    "body",
    ["import os\ndef go(): os.kill(os.getpid(), 11)\n", "import ctypes\nctypes.string_at(0)\n"],
)
def test_a_crash_has_a_message_of_its_own(body: str, tmp_path: Path) -> None:
    (tmp_path / "drive.py").write_text(body)
    words = run_in(tmp_path)
    command = start(*words)
    _, result = command.communicate(timeout=HANGING)
    assert command.returncode == 1
    assert "drive.py" in result.decode()
    assert "limit" not in result.decode()


@pytest.mark.parametrize("seed", [1008 + each for each in seeds(7, 10)])
def test_a_command_that_is_ended_at_random_leaves_nothing(seed: int) -> None:
    assert end_at_random(seed) == []


@pytest.mark.parametrize("name", sample(sorted(PACKS), 3))
def test_runaways_are_contained(name: str) -> None:
    options = ("--time-limit", "1", "--memory-limit", "400")
    _, wrong = contained(name, options, "the time limit of 1 s ended this", 4.0)
    assert wrong == ""
