"""Two states of the source tree, command by command: which one costs more processor time.

    python benchmarks/paired.py BEFORE AFTER [PAIRS]

`BEFORE` and `AFTER` are folders that hold a checkout each. Every command runs in both, one after
the other, so that what else the machine does concerns both alike; the processor time is that of
the command with all its processes. Prints the medians, and the median of the ratios of the pairs.
"""

import os
import random
import resource
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from growth import robot_lines

HERE = Path(__file__).parent.parent
MODULES = 1000


def processor_seconds(checkout: Path, words: Sequence[str]) -> float:
    """Return the processor time that a command takes with all its processes."""
    environment = {**os.environ, "PYTHONPATH": str(checkout), "PYTHONDONTWRITEBYTECODE": ""}
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    command = [sys.executable, "-m", "mars_asp", *words]
    subprocess.run(command, cwd=checkout, env=environment, capture_output=True, check=False)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main() -> None:
    """Run what the command line says."""
    before, after = (Path(each).resolve() for each in sys.argv[1:3])
    pairs = int((*sys.argv, "11")[3])
    with tempfile.TemporaryDirectory() as folder:
        large = Path(folder) / f"{MODULES}-modules.mars"
        lines = robot_lines(MODULES, random.Random(1))
        large.write_text("\n".join(lines) + "\n", encoding="utf-8")
        level0, level1 = (str(HERE / f"examples/level{n}/config.mars") for n in (0, 1))
        for words in (
            ("--version",),
            ("check", level0),
            ("synthesise", level1),
            ("explain", level1, "ArbitrationNode"),
            ("check", str(large)),
            ("synthesise", str(large)),
            ("explain", str(large), "DataSplitter1"),
        ):
            # The first ones write what is kept.
            for checkout in (before, after):
                processor_seconds(checkout, words)
            taken = [
                (processor_seconds(before, words), processor_seconds(after, words))
                for _ in range(pairs)
            ]
            old, new = (statistics.median(each) for each in zip(*taken, strict=True))
            ratio = statistics.median(second / first for first, second in taken)
            shown = " ".join(Path(word).name if "/" in word else word for word in words)
            print(f"{shown:<44} {old:7.3f} {new:7.3f} s {ratio:6.3f}", flush=True)


if __name__ == "__main__":
    main()
