"""A campaign on Dask while all parts are killed: `python -m tests.support.killed_campaigns [RUNS]`.

A scheduler and two workers are started by hand. The process of a worker, its nanny, the command and
the scheduler are killed in turn; no line may be lost, no process may go on without its command, and
no finished run may be run again.
"""

import json
import os
import signal
import socket
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from tests.support.documents import ROOT
from tests.support.processes import children_of
from tests.support.trials import DRIVE

SCENARIO = """\
duration = 1
[robot]
module = "P"
[bindings.C]
python = "b.py:go"
period = 100
"""
BEHAVIOUR = """\
import time
with open({log!r}, "a") as log:
    log.write("x")
time.sleep(0.3)
def go():
    return "Trans_Z", 400
"""
Process = subprocess.Popen[bytes]


class Cluster:
    """A scheduler on a port of its own, and two workers."""

    def __init__(self, folder: Path) -> None:
        with socket.create_server(("127.0.0.1", 0)) as free:
            port = free.getsockname()[1]
        self.address = f"tcp://127.0.0.1:{port}"
        place = ("--host", "127.0.0.1", "--port", str(port))
        self.scheduler = _start(folder, "distributed.cli.dask_scheduler", *place)
        worker = ("distributed.cli.dask_worker", self.address, "--nthreads", "1")
        self.nannies = [_start(folder, *worker) for _ in range(2)]

    def kill_worker(self) -> None:
        """Kill the process of a worker, which its nanny then starts again."""
        for each in children_of(self.nannies[0].pid):
            if "spawn_main" in Path(f"/proc/{each}/cmdline").read_text():
                os.kill(each, signal.SIGKILL)

    def end(self) -> None:
        """End all of it."""
        for process in (*self.nannies, self.scheduler):
            process.kill()
            process.wait()


def _start(folder: Path, module: str, *words: str) -> Process:
    return subprocess.Popen(
        [sys.executable, "-m", module, *words, "--no-dashboard"],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )


class Campaign:
    """A campaign of some runs, whose file and log are in a folder."""

    def __init__(self, folder: Path, runs: int) -> None:
        self.folder, self.runs = folder, runs
        self.out, self.log = folder / "o.jsonl", folder / "log"
        (folder / "robot.mars").write_text(DRIVE)
        (folder / "s.toml").write_text(SCENARIO)
        (folder / "b.py").write_text(BEHAVIOUR.format(log=str(self.log)))

    def start(self, address: str) -> Process:
        words = ("robot.mars", "--scenario", "s.toml", "--seeds", f"1-{self.runs}", "-o", "o.jsonl")
        return subprocess.Popen(
            [sys.executable, "-m", "mars_asp", "campaign", *words, "--cluster", address],
            cwd=self.folder,
            env={**os.environ, "PYTHONPATH": str(ROOT)},
            stdout=subprocess.DEVNULL,
        )

    @property
    def ended(self) -> list[int]:
        """The seeds of whole lines, in their order."""
        raw = self.out.read_bytes() if self.out.exists() else b""
        lines = map(json.loads, raw.split(b"\n")[1:-1])
        return [line["seed"] for line in lines if "seed" in line]

    def await_ended(self, count: int, command: Process) -> None:
        while len(self.ended) < count:
            assert command.poll() is None, "the command ended"
            time.sleep(0.05)

    @property
    def begun(self) -> int:
        return len(self.log.read_text())


def check(folder: Path, runs: int) -> None:
    """Carry out a campaign that all parts of are killed once."""
    campaign, cluster = Campaign(folder, runs), Cluster(folder)
    try:
        command = campaign.start(cluster.address)
        campaign.await_ended(runs // 6, command)
        cluster.kill_worker()
        campaign.await_ended(2 * runs // 6, command)
        cluster.nannies[0].kill()
        campaign.await_ended(3 * runs // 6, command)
        command.kill()
        command.wait()
        first = campaign.ended
        time.sleep(1)
        begun = campaign.begun
        time.sleep(2)
        assert campaign.begun == begun, "runs go on without their command"
        command = campaign.start(cluster.address)
        campaign.await_ended(4 * runs // 6, command)
        cluster.scheduler.kill()
        assert command.wait(30) == 2
        second = campaign.ended
        assert second[: len(first)] == first, "a line was lost"
    finally:
        cluster.end()
    cluster = Cluster(folder)
    try:
        assert campaign.start(cluster.address).wait() == 0
    finally:
        cluster.end()
    assert campaign.ended == [*range(1, runs + 1)], "a line was lost"
    print(f"{runs} runs, {campaign.begun} begun")
    # Two workers: each kill ends what they have in progress, and the scheduler's all of it.
    assert campaign.begun <= runs + 6, "what has ended was run again"


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as made:
        check(Path(made), int(sys.argv[1]) if len(sys.argv) > 1 else 60)
