"""Whole processes: start-up and one explanation, as a ratio to a bare Python that imports clingo.

python benchmarks/startup.py [PYTHON]

PYTHON is that of an installation to measure instead of this one.
"""

import statistics
import subprocess
import sys
import time

RUNS = 7


def seconds(*command: str) -> float:
    """Return the median wall time of a command."""
    times = []
    for _ in range(RUNS):
        started = time.perf_counter()
        subprocess.run(command, capture_output=True, check=True)
        times.append(time.perf_counter() - started)
    return statistics.median(times)


def main() -> None:
    python = sys.argv[1] if len(sys.argv) > 1 else sys.executable
    floor = seconds(python, "-c", "import clingo")
    print(f"bare Python that imports clingo: {floor:.3f} s")
    for words in (
        ("--version",),
        ("check", "examples/level0/config.mars"),
        ("analyse", "examples/level0/config.mars"),
        ("synthesise", "examples/level0/config.mars"),
        ("explain", "examples/level0/config.mars"),
    ):
        taken = seconds(python, "-P", "-m", "mars_asp", *words)  # -P: not from this folder
        print(f"mars-asp {' '.join(words)}: {taken:.3f} s, {taken / floor:.1f} times the floor")


if __name__ == "__main__":
    main()
