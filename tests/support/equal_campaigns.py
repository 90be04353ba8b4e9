"""A campaign on two workers beside single runs: `python -m tests.support.equal_campaigns [SEEDS]`.

Each line of the campaign equals the output of `run` with its seed, in a process with separate
state, and the whole file equals that of a campaign on one worker, to the byte.
"""

import io
import json
import sys
import tempfile
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path

from mars_asp.cli import run_here
from tests.support.documents import ROOT

LEVEL1 = ROOT / "examples" / "level1"
WORDS = [str(LEVEL1 / "config.mars"), "--scenario", str(LEVEL1 / "scenario.toml")]
VARY = ["--vary", "duration=5", "--vary", "world.scatter.moving=12"]


def printed(words: list[str]) -> str:
    """Return the standard output of a command."""
    with redirect_stdout(io.StringIO()) as out, redirect_stderr(io.StringIO()):
        run_here(words)
    return out.getvalue()


def check(folder: Path, seeds: int) -> None:
    """Compare a campaign of so many seeds with single runs, and with one worker."""
    files = [folder / f"{workers}.jsonl" for workers in (1, 2)]
    for workers, file in enumerate(files, 1):
        given = ["--seeds", f"1-{seeds}", "--workers", str(workers), "-o", str(file)]
        printed(["campaign", *WORDS, *VARY, *given])
    assert files[0].read_bytes() == files[1].read_bytes(), "the files differ"
    lines = [json.loads(line) for line in files[1].read_bytes().splitlines()[1:-1]]
    assert [line["seed"] for line in lines] == [*range(1, seeds + 1)]
    for line in lines:
        single = json.loads(
            printed(["run", *WORDS, *VARY, "--seed", str(line["seed"]), "--format", "json"])
        )
        assert {"vary": line["vary"], **single} == line, f"seed {line['seed']} differs"
    failed = sum(line["verdict"] != "pass" for line in lines)
    print(f"{seeds} seeds, of which {failed} failed: all equal")


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as made:
        check(Path(made), int(sys.argv[1]) if len(sys.argv) > 1 else 200)
