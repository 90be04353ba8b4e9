"""Memory and time of an hour, recorded and not: `python benchmarks/recording.py`.

Memory is the peak of the process that runs, and that of the command, which writes.
"""

import subprocess
import sys
import tempfile
from pathlib import Path

LEVEL0 = ("examples/level0/config.mars", "--scenario", "examples/level0/scenario.toml")
HOUR = ("--duration", "3600", "--format", "json")
#: Prints the peak (KB) of the command itself and of what it waited for, and the processor time (s).
_MEASURED = """
import resource, sys
from mars_asp.__main__ import main
try:
    main()
except SystemExit:
    pass
own, waited = (resource.getrusage(k) for k in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
spent = sum(each.ru_utime + each.ru_stime for each in (own, waited))
print(own.ru_maxrss, waited.ru_maxrss, spent, file=sys.stderr)
"""


def measured(*words: str) -> tuple[float, float, float]:
    """Return MB of the command, MB of the process that runs, and seconds of processor time."""
    done = subprocess.run(
        [sys.executable, "-c", _MEASURED, "run", *LEVEL0, *HOUR, *words],
        check=True,
        capture_output=True,
        text=True,
    )
    own, run, spent = map(float, done.stderr.split()[-3:])
    return own / 1024, run / 1024, spent


def main() -> None:
    with tempfile.TemporaryDirectory() as folder:
        for ending in ("", ".jsonl", ".mcap"):
            out = Path(folder) / f"hour{ending}"
            own, run, spent = measured(*(["--record", str(out)] if ending else []))
            size = f", {out.stat().st_size / 1e6:.0f} MB on disk" if ending else ""
            told = ending.removeprefix(".") or "not recorded"
            print(
                f"{told}: command {own:.0f} MB, run {run:.0f} MB, {spent:.0f} s{size}", flush=True
            )


if __name__ == "__main__":
    main()
